//! The shipped changes by a module's flaws are what the simulator makes of the shipped device.
//!
//! With `TACTPAD_WRITE_FIELD` set, they are written anew: `TACTPAD_WRITE_FIELD=1 cargo test --release --test mechanics changes::`.

use std::path::Path;

use tactpad_core::pad::changes::{FieldChange, FieldChanges, Flaw};
use tactpad_core::pad::device::Device;

use crate::standard::SIMULATOR;

#[test]
fn the_shipped_changes_are_the_simulators() {
    let device = Device::nominal();
    let mut simulator = SIMULATOR.lock().unwrap();
    let whole = simulator.pad(&device).unwrap().signals();
    let made: Vec<FieldChange> =
        Flaw::all().map(|flaw| simulator.change(&device, &whole, flaw).unwrap()).collect();
    drop(simulator);
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/sstid.changes");
    if std::env::var_os("TACTPAD_WRITE_FIELD").is_some() {
        std::fs::write(&shipped, FieldChanges(made.clone()).to_bytes(&device)).unwrap();
    }
    let kept = FieldChanges::from_bytes(&std::fs::read(shipped).unwrap(), &device).unwrap().0;
    assert_eq!(kept.len(), made.len());
    for (kept, made) in kept.iter().zip(&made) {
        assert_eq!(kept.flaw, made.flaw);
        // They are kept to 16 bits, and another processor may round otherwise.
        for (kept, made) in kept.maps.iter().flatten().zip(made.maps.iter().flatten()) {
            let largest = made.coefficients.iter().fold(0.0_f64, |largest, c| largest.max(c.abs()));
            for (kept, made) in kept.coefficients.iter().zip(&made.coefficients) {
                assert!((kept - made).abs() <= 1e-4 * largest);
            }
        }
    }
}
