//! What one decode costs, for each decoder: `cargo bench --bench decoders`.
//!
//! Beside the network stands a plain loop over layers of the same sizes: what its arithmetic costs by itself. With
//! `--features foreign-onnx` tract runs the same network, too.

#[path = "../support/decoders.rs"]
mod decoders;

use std::hint::black_box;

use criterion::{Bencher, Criterion, criterion_group, criterion_main};
use firmware_proto::sample::{Sample, Status};
use tactpad::numeric::memory::{PlayOperator, Relaxation};
use tactpad::pad::field::PadField;
use tactpad::pad::influence::InfluenceField;
use tactpad::pipeline::compensation::Compensation;
use tactpad::pipeline::compensation::hysteresis::PLAYS;
use tactpad::pipeline::compensation::memory::Memory;
use tactpad::pipeline::compensation::thermal::Thermal;
use tactpad::pipeline::compensation::thermometer::Thermometer;
use tactpad::pipeline::contact::inverse::Inverse;
use tactpad::pipeline::contact::uncertainty::Noise;
use tactpad::pipeline::contact::watch::Watch;
use tactpad::pipeline::health::Health;
use tactpad::quantity::{CHANNELS, Contact, Strain};
use tactpad::time::StreamInstant;

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

/// What the pipeline does with the inverse decoder's channels, all of it, while a finger presses.
fn live(bencher: &mut Bencher<'_>, field: &InfluenceField, strain: &Strain) {
    let plays = [PlayOperator { threshold: 800.0, share: 0.03 }; CHANNELS];
    let noise = Noise::of_channels([5.0; CHANNELS], [0.01; CHANNELS]);
    let inverse = Inverse::new(field.clone(), noise);
    let creep = Relaxation { time_s: 8.0, share: 0.01 };
    let thermal =
        Thermal { reference_c: 20.0, zero_uv_per_c: [50.0; CHANNELS], gain_per_c: [-5e-4; CHANNELS] };
    let compensation =
        Compensation { zero_uv: None, thermal: Some(thermal), creep, hysteresis: [plays; PLAYS] };
    let (mut memory, mut watch) = (Memory::of(&compensation), Watch::new(Some(&inverse)));
    let mut thermometer = Thermometer::of(compensation.thermal);
    let sample = Sample {
        sequence: 0,
        time_us: 0,
        counts: [0; CHANNELS],
        temperature_centi_c: 2_500,
        status: Status::OK,
    };
    let (mut health, mut at) = (Health::default(), StreamInstant::default());
    bencher.iter(|| {
        at = at.plus_us(1_000);
        thermometer.follow(at, black_box(&sample), true);
        black_box(thermometer.added_uv());
        let free = memory.freed(&thermometer.at_reference(black_box(strain)));
        let explained = inverse.explain(&free);
        memory.follow(at, Some(&free));
        if let Some(explained) = &explained {
            watch.see(at, &free, explained, true, &inverse, &mut health);
        }
        (explained, memory.rest())
    });
}

fn decode(criterion: &mut Criterion) {
    let field = PadField::nominal().signals;
    let strain = field.strain_uv(&Contact { x_mm: 11.3, y_mm: -7.9, fx_n: 0.4, fy_n: -0.2, fz_n: 2.0 });
    let mut group = criterion.benchmark_group("decode");
    for (name, decoder) in decoders::each() {
        group.bench_function(name, |bencher| bencher.iter(|| decoder.decode(black_box(&strain))));
        if let Some(inverse) = decoder.inverse() {
            let name = format!("{name}, with its uncertainty");
            group.bench_function(name, |bencher| bencher.iter(|| inverse.estimate(black_box(&strain))));
        }
    }
    group.bench_function("inverse, all of the live path", |bencher| live(bencher, &field, &strain));
    let layers = layers();
    group.bench_function("plain loop", |bencher| bencher.iter(|| plain(&layers, black_box(&strain.uv))));
    #[cfg(feature = "foreign-onnx")]
    {
        use tactpad::network::foreign::Foreign;
        let network = tactpad::pipeline::shipped::bytes("scdf").and_then(|bytes| Foreign::read(&bytes).ok());
        let Some(network) = network else { panic!("tract runs the shipped network") };
        group.bench_function("tract", |bencher| bencher.iter(|| network.decode(black_box(&strain.uv))));
    }
    group.finish();
}

criterion_group!(benches, decode);
criterion_main!(benches);
