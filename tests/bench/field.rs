//! What a pad's field costs to make, to read and to ask: `cargo bench --bench field`.
//!
//! What takes seconds is done once and printed with its time; criterion repeats the rest. (All of the paper's 14,400
//! contacts through the program are `tests/bench/simulate.rs`.)

use std::f64::consts::PI;
use std::hint::black_box;
use std::io::Write;
use std::time::{Duration, Instant};

use criterion::{Criterion, SamplingMode, criterion_group, criterion_main};
use tactpad::mechanics::mesh::Fineness;
use tactpad::mechanics::simulator::Simulator;
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;

const NOMINAL: &[u8] = include_bytes!("../../models/sstid.field");
const CONTACTS: u32 = 14_400;

/// Does something that takes long, and prints how long.
#[expect(clippy::disallowed_methods, reason = "a bench measures time")]
fn once<T, E: std::fmt::Display>(name: &str, limit: Duration, work: impl FnOnce() -> Result<T, E>) -> T {
    let start = Instant::now();
    let done = work();
    let (took, limit) = (start.elapsed().as_secs_f64(), limit.as_secs_f64());
    let told = writeln!(std::io::stdout(), "{name:<44} once: {took:.2} s (at most {limit} s)");
    match (done, told) {
        (Ok(done), Ok(())) => done,
        (Err(error), _) => panic!("{name}: {error}"),
        (_, Err(error)) => panic!("{error}"),
    }
}

/// Places spread evenly over the disc of contacts.
fn places(radius_mm: f64) -> Vec<[f32; 2]> {
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    let place = |k: u32| {
        let radius = radius_mm * ((f64::from(k) + 0.5) / f64::from(CONTACTS)).sqrt();
        let (sin, cos) = (f64::from(k) * golden).sin_cos();
        [radius * cos, radius * sin].map(|mm| mm as f32)
    };
    (0..CONTACTS).map(place).collect()
}

fn kept(criterion: &mut Criterion) {
    let device = Device::nominal();
    criterion.bench_function("field from its file", |bencher| {
        bencher.iter(|| PadField::from_bytes(black_box(NOMINAL), &device).is_ok());
    });
    let field = PadField::nominal().signals;
    criterion.bench_function("G(x, y) with slopes", |bencher| {
        bencher.iter(|| field.gains(black_box(11.3), black_box(-7.9)));
    });
    let places = places(field.radius_mm().into());
    criterion.bench_function("G(x, y) at 14,400 places", |bencher| {
        bencher.iter(|| places.iter().map(|[x, y]| field.gains(*x, *y).value[0][2]).sum::<f64>());
    });
}

fn made(criterion: &mut Criterion) {
    let (device, seconds) = (Device::nominal(), Duration::from_secs);
    let mut simulator = Simulator::new(Fineness::STANDARD);
    once("device to field, from nothing", seconds(30), || simulator.field(&device));
    let mut from_nothing = Simulator::new(Fineness::STANDARD);
    once("all sensitivities, from nothing", seconds(60), || from_nothing.sensitivities(&device));
    let mut softer = device.clone();
    softer.modules[1].frame_e_factor = 0.8;
    once("pad with one changed module", seconds(30), || simulator.pad(&softer));
    let mut moved = softer.clone();
    (moved.modules[2].radial_mm, moved.modules[2].rotation_deg) = (0.7, 5.0);
    let mut group = criterion.benchmark_group("modules that are known");
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    group.bench_function("pad with a moved module", |bencher| bencher.iter(|| simulator.pad(&moved).is_ok()));
    group.bench_function("all sensitivities", |bencher| {
        bencher.iter(|| simulator.sensitivities(&device).is_ok());
    });
    group.finish();
}

criterion_group!(benches, kept, made);
criterion_main!(benches);
