//! What a module's finite elements cost, and how time and memory grow with the mesh: `cargo bench --bench mechanics`.
#![allow(clippy::unwrap_used, reason = "a bench that cannot set its scene fails")]

use std::time::Duration;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use tactpad::mechanics::mesh::Fineness;
use tactpad::mechanics::superelement::Solution;
use tactpad::pad::device::{Device, Module};

/// Sizes of the elements in units of the program's.
const LADDER: [f64; 4] = [2.8, 2.0, 1.4, 1.0];

/// Mesh, assembly, factorisation and superelement. Each name says the unknowns and the factor's entries, of 8 bytes.
fn modules(criterion: &mut Criterion) {
    let device = Device::nominal();
    let mut group = criterion.benchmark_group("one module solved");
    group.sample_size(10).measurement_time(Duration::from_secs(1));
    for factor in LADDER {
        let solve = || Solution::of(&device, &Module::NOMINAL, Fineness::STANDARD.scaled(factor)).unwrap();
        let (unknowns, entries) = {
            let solution = solve();
            (solution.unknowns(), solution.factor_entries())
        };
        let name = format!("{unknowns} unknowns, {:.1} million entries", entries as f64 / 1e6);
        group.bench_function(BenchmarkId::new(format!("sizes times {factor}"), name), |bencher| {
            bencher.iter(|| solve().superelement());
        });
    }
    group.finish();
}

/// All derivatives by moduli and thicknesses of a module that is solved already.
fn derivatives(criterion: &mut Criterion) {
    let device = Device::nominal();
    let solution = Solution::of(&device, &Module::NOMINAL, Fineness::STANDARD).unwrap();
    let mut group = criterion.benchmark_group("a solved module");
    group.sample_size(10).measurement_time(Duration::from_secs(1));
    group.bench_function("derivatives by all layers", |bencher| {
        bencher.iter(|| solution.derivatives().unwrap());
    });
    group.finish();
}

criterion_group!(benches, modules, derivatives);
criterion_main!(benches);
