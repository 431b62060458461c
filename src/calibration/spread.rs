//! How much pads differ from what is thought of them, by kind of number: how carefully they are built.
//!
//! Before any contact it is what hands and parts are known to do. A pad that was built better shows it, as its numbers then
//! lie closer to what was thought: their size is found by the evidence (D. J. C. MacKay, Neural Computation 4 (1992) 415).

use crate::device::parameter::Parameter;
use crate::device::unit::Unit;

/// Kinds of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Of a module, mm.
    Shift,
    /// Of a module, degrees.
    Turn,
    /// Of a module, as a share.
    Stiffness,
    /// Of another channel's microvolts.
    Crosstalk,
    /// What is left of a zero that was taken off, µV.
    Zero,
    /// By which a channel's share of friction is another than the mean.
    OwnFriction,
}

const KINDS: usize = 6;
/// Standard deviations before anything is measured. Modules are assembled by hand; stiffness is that of a modulus.
const SHIFT_MM: f64 = 0.3;
const TURN_DEG: f64 = 2.0;
const STIFFNESS: f64 = 0.3;
const CROSSTALK: f64 = 0.02;
const ZERO_UV: f64 = 20.0;
const FRICTION_OWN: f64 = 0.02;
/// They are known as well as so many numbers of that size tell.
const KNOWN: f64 = 4.0;

/// Standard deviations, by kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spread([f64; KINDS]);

impl Kind {
    /// The kind of a module's number.
    pub(super) fn of(parameter: Parameter) -> Self {
        match parameter.unit() {
            Unit::Millimetre => Self::Shift,
            Unit::Degree => Self::Turn,
            _ => Self::Stiffness,
        }
    }
}

impl Spread {
    /// Before any measurement.
    pub(super) const BEFORE: Self = Self([SHIFT_MM, TURN_DEG, STIFFNESS, CROSSTALK, ZERO_UV, FRICTION_OWN]);

    /// The standard deviation of a kind.
    pub(super) const fn of(&self, kind: Kind) -> f64 {
        self.0[kind as usize]
    }

    /// The spread that these numbers have: kind, difference from what was thought, variance that is left.
    pub(super) fn seen(&self, numbers: impl Iterator<Item = (Kind, f64, f64)>) -> Self {
        let mut squares = Self::BEFORE.0.map(|deviation| KNOWN * deviation * deviation);
        let mut counts = [KNOWN; KINDS];
        for (kind, difference, variance) in numbers {
            squares[kind as usize] += difference * difference;
            counts[kind as usize] += (1.0 - variance / self.of(kind).powi(2)).clamp(0.0, 1.0);
        }
        Self(std::array::from_fn(|kind| (squares[kind] / counts[kind]).sqrt()))
    }
}
