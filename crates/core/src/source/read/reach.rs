//! How the area and the force of a described pad map onto the plate.

use super::measures::{Drafted, FULL_N};
use super::units::{FORCE_UNITS, ForceUnit, per_count};
use crate::source::Reach;
use crate::toml_text::diag::Findings;
use crate::toml_text::section::{Bounds, Section};

pub(super) const AREA_KEYS: [&str; 2] = ["half_width_mm", "half_height_mm"];
pub(super) const FORCE_KEYS: [&str; 5] = ["unit", "n_per_count", "full_n", "noise_n", "standing_n"];

const HALF_MM: Bounds<f64> = Bounds { low: 5.0, high: 1_000.0, default: 100.0 };
const NOISE_N: Bounds<f64> = Bounds { low: 0.0, high: 100.0, default: 0.05 };
const STANDING_N: Bounds<f64> = Bounds { low: 0.5, high: 4.0, default: 2.0 };

/// Says that a device that tells contacts has no area and no force of its own.
pub(super) fn refuse_reach(root: &Section<'_>, findings: &mut Findings<'_>) {
    for key in ["area", "force"] {
        if let Some(at) = root.place_of(key) {
            let help = "the whole range of its axes is the plate; forces stand in [contact]";
            findings.error(at, format!("[{key}] is for channels"), help);
        }
    }
}

pub(super) fn read_reach(
    root: &Section<'_>,
    drafted: Option<&Drafted>,
    findings: &mut Findings<'_>,
) -> Option<Reach> {
    root.require("area", "write [area] with half_width_mm and half_height_mm", findings);
    root.require("force", "write [force] with unit and full_n", findings);
    let area = root.table("area", "[area]".into(), &AREA_KEYS, findings);
    let half_mm = area.and_then(|area| {
        for key in AREA_KEYS {
            area.require(key, "from the middle to the edge of what is touched, in mm", findings);
        }
        let [width, height] = AREA_KEYS.map(|key| area.number(key, HALF_MM, findings));
        Some([width?.value, height?.value])
    });
    let force = root.table("force", "[force]".into(), &FORCE_KEYS, findings)?;
    force.require("unit", "write unit = \"g\", \"kg\", \"lb\", \"N\" or \"count\"", findings);
    force.require("full_n", "write the force, in N, that is as much as a finger's firm press", findings);
    let full_n = force.number("full_n", FULL_N, findings);
    let noise_n = force.number("noise_n", NOISE_N, findings);
    let is_stood_on = force.place_of("standing_n").is_some();
    let standing_n = force.number("standing_n", STANDING_N, findings);
    let unit = force.word("unit", &FORCE_UNITS, findings)?;
    let is_count = matches!(unit.value, ForceUnit::Count);
    let per_count = per_count(&force, "n_per_count", is_count, findings);
    if (root.place_of("wire").is_some() || root.place_of("evdev").is_some()) && !is_count {
        findings.error(unit.at, "its numbers are counts", "write unit = \"count\", and n_per_count");
    }
    if matches!(drafted, Some(Drafted::Wrench(_, true))) && !is_count {
        findings.error(
            unit.at,
            "moments are counts and forces are not",
            "give both in units, or both in counts",
        );
    }
    let n_per_unit = match unit.value {
        ForceUnit::Newtons(n) => n,
        ForceUnit::Count => per_count?,
    };
    let standing_n = is_stood_on.then_some(standing_n?.value);
    Some(Reach { half_mm: half_mm?, n_per_unit, full_n: full_n?.value, noise_n: noise_n?.value, standing_n })
}
