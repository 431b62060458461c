//! What one decode costs, for each decoder: `cargo bench --bench decoders`.
//!
//! Beside the network stands a plain loop over layers of the same sizes: what its arithmetic costs by itself. With
//! `--features foreign-onnx` tract runs the same network, too.

#[path = "../support/decoders.rs"]
mod decoders;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use tactpad::field::PadField;
use tactpad::quantity::{CHANNELS, Contact};

/// Neurons of the shipped network.
const WIDTHS: [usize; 5] = [CHANNELS, 128, 128, 64, 5];

/// From each input to all neurons, one input behind the other; and the biases.
struct Layer {
    weights: Vec<f32>,
    biases: Vec<f32>,
}

fn layers() -> Vec<Layer> {
    let numbers = |count: usize| (0..count).map(|k| (k % 7) as f32 * 0.02 - 0.06).collect();
    let layer = |pair: &[usize]| Layer { weights: numbers(pair[0] * pair[1]), biases: numbers(pair[1]) };
    WIDTHS.windows(2).map(layer).collect()
}

fn plain(layers: &[Layer], channels: &[f32; CHANNELS]) -> [f32; 5] {
    let [mut from, mut into] = [[0.0_f32; 128]; 2];
    from[..CHANNELS].copy_from_slice(channels);
    for (index, Layer { weights, biases }) in layers.iter().enumerate() {
        let into = &mut into[..biases.len()];
        into.copy_from_slice(biases);
        for (value, weights) in from.iter().zip(weights.chunks_exact(into.len())) {
            into.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += value * weight);
        }
        let least = if index + 1 < layers.len() { 0.0 } else { f32::NEG_INFINITY };
        from.iter_mut().zip(into).for_each(|(from, value)| *from = value.max(least));
    }
    std::array::from_fn(|k| from[k])
}

fn decode(criterion: &mut Criterion) {
    let field = PadField::nominal().signals;
    let strain = field.strain_uv(&Contact { x_mm: 11.3, y_mm: -7.9, fx_n: 0.4, fy_n: -0.2, fz_n: 2.0 });
    let mut group = criterion.benchmark_group("decode");
    for (name, decoder) in decoders::each() {
        group.bench_function(name, |bencher| bencher.iter(|| decoder.decode(black_box(&strain))));
    }
    let layers = layers();
    group.bench_function("plain loop", |bencher| bencher.iter(|| plain(&layers, black_box(&strain.uv))));
    #[cfg(feature = "foreign-onnx")]
    {
        use tactpad::network::foreign::Foreign;
        let network = tactpad::shipped::bytes("scdf").and_then(|bytes| Foreign::read(&bytes).ok());
        let Some(network) = network else { panic!("tract runs the shipped network") };
        group.bench_function("tract", |bencher| bencher.iter(|| network.decode(black_box(&strain.uv))));
    }
    group.finish();
}

criterion_group!(benches, decode);
criterion_main!(benches);
