//! What an epoch of the paper's stage I costs: `cargo bench --bench network`. (A decode is in `tests/bench/decoders.rs`.)

use criterion::{Criterion, criterion_group, criterion_main};
use tactpad::lab::scdf::{BATCH, HIDDEN, simulation};
use tactpad::network::training::{Schedule, split, train};
use tactpad::network::{Network, Zero};
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;

fn network(criterion: &mut Criterion) {
    let examples = simulation::examples(&Device::nominal(), &PadField::nominal(), 1);
    let [held, training] = split(examples, 5, 1);
    let start = Network::untrained(HIDDEN, Zero::Tared, &training, 1);
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
