//! The shipped field is what the simulator makes of the shipped device.
//!
//! With `TACTPAD_WRITE_FIELD` set, it is written anew: `TACTPAD_WRITE_FIELD=1 cargo test --release --test field`.

#![cfg(feature = "simulator")]

use std::path::Path;

use tactpad::device::Device;
use tactpad::field::PadField;
use tactpad::mechanics::mesh::Fineness;
use tactpad::mechanics::simulator::Simulator;

fn shipped() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("models/sstid.field")
}

#[test]
fn the_shipped_field_is_the_simulators() {
    let device = Device::nominal();
    let made = Simulator::new(Fineness::STANDARD).field(&device).unwrap();
    if std::env::var_os("TACTPAD_WRITE_FIELD").is_some() {
        std::fs::write(shipped(), made.to_bytes(&device)).unwrap();
    }
    let kept = PadField::from_bytes(&std::fs::read(shipped()).unwrap(), &device).unwrap();
    // Another processor may round otherwise, and sensitivities are kept to 16 bits.
    for (kept, made) in [(&kept.signals, &made.signals), (&kept.sums, &made.sums)] {
        let pairs = kept.coefficients().into_iter().zip(made.coefficients());
        let worst = pairs.map(|(kept, made)| (kept - made).abs()).fold(0.0, f32::max);
        assert!(worst < 0.01, "{worst} µV/N");
    }
    assert_eq!(kept.sensitivities.len(), made.sensitivities.len());
    for (kept, made) in kept.sensitivities.iter().zip(&made.sensitivities) {
        assert_eq!(kept.parameter, made.parameter);
        for (kept, made) in kept.maps.iter().flatten().zip(made.maps.iter().flatten()) {
            let largest = made.coefficients.iter().fold(0.0_f64, |largest, c| largest.max(c.abs()));
            for (kept, made) in kept.coefficients.iter().zip(&made.coefficients) {
                assert!((kept - made).abs() <= 1e-4 * largest);
            }
        }
    }
}
