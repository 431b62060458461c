//! What a sample costs: `cargo bench --bench live`.

use std::hint::black_box;

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use firmware_proto::ENCODED_MAX;
use firmware_proto::frame::Message;
use firmware_proto::link::encode_message;
use firmware_proto::sample::{Sample, Status};
use tactpad::pad::field::PadField;
use tactpad::pipeline::mapping::read::check::{self, OutputChoice};
use tactpad::pipeline::mapping::read::shipped;
use tactpad::pipeline::{NoProbe, Pipeline};
use tactpad::quantity::Contact;
use tactpad::time::HostInstant;

const SAMPLES: u32 = 1_000;

/// A second of play: rest, then presses on the right that come and go every 100 ms.
fn frames(from: u32) -> Vec<Vec<u8>> {
    let field = PadField::nominal().signals;
    let pressed = field.strain_uv(&Contact { x_mm: 20.0, fz_n: 1.0, ..Contact::default() }).uv;
    (from..from + SAMPLES)
        .map(|sequence| {
            let down = from > 0 && sequence / 100 % 2 == 0;
            let counts = pressed.map(|uv| if down { (uv * 100.0) as i32 } else { 0 });
            let time_us = u64::from(sequence) * 1_000;
            let sample = Sample { sequence, time_us, counts, temperature_centi_c: 2_500, status: Status::OK };
            let mut frame = [0; ENCODED_MAX];
            let length = encode_message(&Message::Sample(sample), &mut frame);
            frame.get(..length).unwrap_or_default().to_vec()
        })
        .collect()
}

fn feed(pipeline: &mut Pipeline, frames: &[Vec<u8>]) -> usize {
    let mut events = 0;
    for (ms, frame) in frames.iter().enumerate() {
        let now = HostInstant::default().plus_us(1_000 * ms as u64);
        let mut rest = &frame[..];
        while !rest.is_empty() {
            let taken = pipeline.handle_bytes(now, rest, &mut NoProbe);
            events += pipeline.events().len();
            rest = rest.get(taken..).unwrap_or_default();
        }
    }
    events
}

fn rested() -> Pipeline {
    let profile = shipped::text("super-mario").and_then(|text| check::read(text, OutputChoice::AsWritten).0);
    let Some(profile) = profile else { panic!("super-mario is in order") };
    let mut pipeline = Pipeline::new(tactpad::pipeline::shipped::decoder(), profile);
    feed(&mut pipeline, &frames(0));
    pipeline
}

fn live(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("live");
    group.throughput(Throughput::Elements(u64::from(SAMPLES)));
    let frames = frames(SAMPLES);
    group.bench_function("bytes to events, 1000 samples", |bencher| {
        bencher.iter_batched_ref(
            rested,
            |pipeline| feed(pipeline, black_box(&frames)),
            BatchSize::SmallInput,
        );
    });
    group.finish();
    let field = PadField::nominal().signals;
    let contact = Contact { x_mm: 11.3, y_mm: -7.9, fx_n: 0.4, fy_n: -0.2, fz_n: 2.0 };
    criterion
        .bench_function("influence field", |bencher| bencher.iter(|| field.strain_uv(black_box(&contact))));
}

criterion_group!(benches, live);
criterion_main!(benches);
