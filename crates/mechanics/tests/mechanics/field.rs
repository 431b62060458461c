//! The shipped field is what the simulator makes of the shipped device.
//!
//! With `TACTPAD_WRITE_FIELD` set, it is written anew: `TACTPAD_WRITE_FIELD=1 cargo test --release --test mechanics field::`.

use std::path::Path;

use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::{ForceMaps, PadField};
use tactpad_core::pad::influence::InfluenceField;
use tactpad_core::quantity::CHANNELS;
use tactpad_mechanics::simulator::PLATE_DEGREE;
use tactpad_numeric::zernike::jets;

use crate::standard::SIMULATOR;

fn shipped() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/sstid.field")
}

#[test]
fn the_shipped_field_is_the_simulators() {
    let device = Device::nominal();
    let mut simulator = SIMULATOR.lock().unwrap();
    let made = simulator.field(&device).unwrap();
    assert_splines_follow(&made.signals, &simulator.pad(&device).unwrap().signals());
    drop(simulator);
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

/// Values and slopes are the polynomials', up to the farthest contact. Over the edges of the posts these reach
/// 2,400 µV/N and 200 µV/N per mm.
fn assert_splines_follow(splines: &InfluenceField, maps: &[ForceMaps; CHANNELS]) {
    for (ring, place) in (0..=58).flat_map(|ring| (0..24).map(move |place| (ring, place))) {
        let (sin, cos) = (f64::from(place) * 15.0).to_radians().sin_cos();
        let [x, y] = [cos, sin].map(|share| f64::from(ring) / 2.0 * share);
        let jets = jets(PLATE_DEGREE, [x, y].map(|mm| mm / 30.0));
        let gains = splines.gains(x as f32, y as f32);
        for (channel, axis) in (0..CHANNELS).flat_map(|channel| (0..3).map(move |axis| (channel, axis))) {
            let wanted = maps[channel][axis].jet(&jets);
            let off_uv = gains.value[channel][axis] - wanted.value;
            let slopes =
                [gains.dx[channel][axis] - wanted.dx / 30.0, gains.dy[channel][axis] - wanted.dy / 30.0];
            assert!(off_uv.abs() < 0.1, "{channel} {axis} at {x}, {y}: {off_uv} µV/N");
            assert!(slopes[0].hypot(slopes[1]) < 0.5, "{channel} {axis} at {x}, {y}: {slopes:?} µV/N per mm");
        }
    }
}
