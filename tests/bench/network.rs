//! What the paper's network costs: one decode, and one epoch of stage I: `cargo bench --bench network`.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use tactpad::device::Device;
use tactpad::field::PadField;
use tactpad::network::training::{Schedule, split, train};
use tactpad::network::{Network, Zero};
use tactpad::scdf::{BATCH, HIDDEN, simulation};

fn network(criterion: &mut Criterion) {
    let examples = simulation::examples(&Device::nominal(), &PadField::nominal(), 1);
    let [held, training] = split(examples, 5, 1);
    let start = Network::untrained(HIDDEN, Zero::Tared, &training, 1);
    let Some(example) = held.first() else { panic!("there are contacts") };
    criterion.bench_function("network", |bencher| bencher.iter(|| start.decode(black_box(&example.uv))));
    let schedule = Schedule { rate: 1e-3, batch: BATCH, epochs_max: 1, patience: 1, beta: 0.0, seed: 1 };
    let mut group = criterion.benchmark_group("stage I");
    group.sample_size(10);
    group.bench_function("an epoch of 11,520 contacts", |bencher| {
        bencher.iter(|| train(&start, &training, &held, &schedule, |_| ()));
    });
    group.finish();
}

criterion_group!(benches, network);
criterion_main!(benches);
