//! Units of forces and moments.

use crate::quantity::WEIGHT_N_PER_G;
use crate::toml_text::diag::Findings;
use crate::toml_text::section::{Bounds, Section};

const PER_COUNT: Bounds<f64> = Bounds { low: -1e6, high: 1e6, default: 1.0 };

/// A unit of forces: newtons, or what `n_per_count` says.
#[derive(Clone, Copy)]
pub(super) enum ForceUnit {
    Newtons(f64),
    Count,
}

pub(super) const FORCE_UNITS: [(&str, ForceUnit); 5] = [
    ("g", ForceUnit::Newtons(WEIGHT_N_PER_G)),
    ("kg", ForceUnit::Newtons(1e3 * WEIGHT_N_PER_G)),
    ("lb", ForceUnit::Newtons(453.592_37 * WEIGHT_N_PER_G)),
    ("N", ForceUnit::Newtons(1.0)),
    ("count", ForceUnit::Count),
];

/// A unit of moments: N mm, or what `nmm_per_count` says.
#[derive(Clone, Copy)]
pub(super) enum MomentUnit {
    NewtonMillimetres(f64),
    Count,
}

pub(super) const MOMENT_UNITS: [(&str, MomentUnit); 3] = [
    ("Nmm", MomentUnit::NewtonMillimetres(1.0)),
    ("Nm", MomentUnit::NewtonMillimetres(1e3)),
    ("count", MomentUnit::Count),
];
/// What a count is worth, where the unit is counts and only there.
pub(super) fn per_count(
    table: &Section<'_>,
    key: &'static str,
    is_count: bool,
    findings: &mut Findings<'_>,
) -> Option<f64> {
    match (is_count, table.place_of(key)) {
        (true, _) => {
            table.require(
                key,
                "put a known weight on the pad, and divide its force by what is counted",
                findings,
            );
            let number = table.number(key, PER_COUNT, findings)?;
            if number.value == 0.0 {
                findings.error(number.at, format!("\"{key}\" must not be 0"), "");
            }
            Some(number.value)
        }
        (false, Some(at)) => {
            findings.error(
                at,
                format!("\"{key}\" is for numbers in counts"),
                "take it out, or write \"count\" as the unit",
            );
            None
        }
        (false, None) => None,
    }
}
