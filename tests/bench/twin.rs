//! The twin: a second of stream at 1 kHz, with everything that it can get wrong. Real time would be a second.
#![expect(clippy::expect_used, reason = "a benchmark may stop at what it did not expect")]

use criterion::{Criterion, criterion_group, criterion_main};
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;
use tactpad::pad::twin::hand::Hand;
use tactpad::pad::twin::pad::{Circumstances, TwinPad};
use tactpad::quantity::Contact;

const EVERYTHING: &str = include_str!("../../models/imperfections/paper.toml");

fn stream(criterion: &mut Criterion) {
    let device = Device::nominal().with_imperfections(EVERYTHING).0.expect("the file fits");
    let mut pad = TwinPad::new(&device, &PadField::nominal(), 1);
    let mut hand = Hand::new(device.behaviour.finger, 1);
    let around = Circumstances { temperature_c: 30.0, cycles: 100.0 };
    let press = Contact { x_mm: 5.0, y_mm: 3.0, fx_n: 0.1, fy_n: -0.2, fz_n: 2.0 };
    criterion.bench_function("a second of stream at 1 kHz", |bencher| {
        bencher.iter(|| {
            for _ in 0..1000 {
                let contact = hand.hold(1e-3, &press);
                pad.read(1e-3, &contact, &around);
            }
        });
    });
}

criterion_group!(benches, stream);
criterion_main!(benches);
