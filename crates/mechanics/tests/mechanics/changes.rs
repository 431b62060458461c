//! The shipped changes by a module's flaws are what the simulator makes of the shipped device.
//!
//! With `TACTPAD_WRITE_FIELD` set, they are written anew: `TACTPAD_WRITE_FIELD=1 cargo test --release --test mechanics changes:: -- --ignored`.
#![allow(clippy::unwrap_used, reason = "a test may stop at what it did not expect")]

use std::path::{Path, PathBuf};

use tactpad_core::pad::changes::{FieldChange, FieldChanges, Flaw};
use tactpad_core::pad::device::Device;

use crate::standard::SIMULATOR;

fn shipped() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/sstid.changes")
}

/// As they are in the file, in its order.
fn kept() -> Vec<FieldChange> {
    FieldChanges::from_bytes(&std::fs::read(shipped()).unwrap(), &Device::nominal()).unwrap().0
}

fn made(flaws: impl Iterator<Item = Flaw>) -> Vec<FieldChange> {
    let device = Device::nominal();
    let mut simulator = SIMULATOR.lock().unwrap();
    let whole = simulator.pad(&device).unwrap().signals();
    flaws.map(|flaw| simulator.change(&device, &whole, flaw).unwrap()).collect()
}

/// They are kept to 16 bits, and another processor may round otherwise.
fn assert_near(kept: &FieldChange, made: &FieldChange) {
    assert_eq!(kept.flaw, made.flaw);
    for (kept, made) in kept.maps.iter().flatten().zip(made.maps.iter().flatten()) {
        let largest = made.coefficients.iter().fold(0.0_f64, |largest, c| largest.max(c.abs()));
        for (kept, made) in kept.coefficients.iter().zip(&made.coefficients) {
            assert!((kept - made).abs() <= 1e-4 * largest);
        }
    }
}

#[test]
#[ignore = "proof: 50 s: the field is solved for with every flaw"]
fn the_shipped_changes_are_the_simulators() {
    let made = made(Flaw::all());
    if std::env::var_os("TACTPAD_WRITE_FIELD").is_some() {
        std::fs::write(shipped(), FieldChanges(made.clone()).to_bytes(&Device::nominal())).unwrap();
    }
    let kept = kept();
    assert_eq!(kept.len(), made.len());
    kept.iter().zip(&made).for_each(|(kept, made)| assert_near(kept, made));
}
