//! The cases: what is not as the program thinks, what the errors should be, and what they may be.

use std::sync::LazyLock;

use super::memory::Memory;
use crate::effects::mechanical::OPEN_SHARE;
use crate::fields::{MOVED, NOMINAL, OPEN_FRAME, SOFT_FRAME, THICK_PLATE, TURNED, Table};
use crate::truth::Truth;

/// A cause by effect and target, with its parameters.
type Cause = (&'static str, &'static str, &'static [(&'static str, f64)]);

/// One case.
#[derive(Debug)]
pub(super) struct Case {
    pub(super) name: &'static str,
    pub(super) table: &'static LazyLock<Table>,
    /// What the table changes of the nominal pad.
    field: Option<Cause>,
    /// The same in the numbers of the program's device file, as differences from it.
    numbers: &'static [(&'static str, f64)],
    pub(super) memory: Memory,
    rig: Option<Cause>,
    pub(super) gate: Gate,
}

/// Mean errors of place and force, over those of the nominal pad of the same seed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gate {
    /// What they should be at most, where that is known.
    pub(super) expected: Option<f64>,
    /// What they may be.
    pub(super) most: [f64; 2],
}

const NO_CASE: Case = Case {
    name: "nominal",
    table: &NOMINAL,
    field: None,
    numbers: &[],
    memory: Memory::Nothing,
    rig: None,
    gate: Gate { expected: None, most: [1.0; 2] },
};

/// A changed field may cost 15 % at most. Where that is met, it is the gate.
const EXPECTED: f64 = 1.15;
const CHANGED: Gate = Gate { expected: Some(EXPECTED), most: [EXPECTED; 2] };

/// Nobody has said what a decoder can do there, so the gate is a tenth above what the program came to.
const fn open(most: [f64; 2]) -> Gate {
    Gate { expected: None, most }
}

/// So many of the cases are the six fields; they come first.
pub(super) const FIELDS: usize = 6;

/// The fields, memories that are not of the program's kind, and rigs with a fault.
pub(super) static CASES: [Case; 13] = [
    NO_CASE,
    Case {
        name: "plate_1p15",
        table: &THICK_PLATE,
        field: Some(("plate_stiffness", "pad", &[("factor", 1.520_875)])),
        numbers: &[("plate.thickness_mm", 0.15)],
        gate: CHANGED,
        ..NO_CASE
    },
    Case {
        name: "m0_moved",
        table: &MOVED,
        field: Some(("module_displaced", "module0", &[("radial_mm", -0.7), ("tangential_mm", 0.9)])),
        numbers: &[("module.0.radial_mm", -0.7), ("module.0.tangential_mm", 0.9)],
        gate: CHANGED,
        ..NO_CASE
    },
    Case {
        name: "m1_turned",
        table: &TURNED,
        field: Some(("module_rotated", "module1", &[("deg", -5.0)])),
        numbers: &[("module.1.rotation_deg", -5.0)],
        gate: CHANGED,
        ..NO_CASE
    },
    Case {
        name: "m2_soft_frame",
        table: &SOFT_FRAME,
        field: Some(("module_stiffness", "module2", &[("factor", 0.6)])),
        numbers: &[("module.2.frame_e_factor", -0.4)],
        gate: CHANGED,
        ..NO_CASE
    },
    Case {
        name: "m0_open_frame",
        table: &OPEN_FRAME,
        field: Some(("module_frame_open", "module0", &[("area_share", OPEN_SHARE)])),
        // A frame that is open has no modulus of its own.
        numbers: &[("module.0.frame_e_factor", f64::NAN)],
        gate: CHANGED,
        ..NO_CASE
    },
    Case { name: "12 plays", memory: Memory::Plays, gate: open([1.72, 1.62]), ..NO_CASE },
    Case { name: "Bouc and Wen", memory: Memory::BoucWen, gate: open([2.09, 1.74]), ..NO_CASE },
    Case { name: "log creep", memory: Memory::LogCreep, gate: open([1.20, 1.14]), ..NO_CASE },
    Case {
        name: "stage 0.5 mm off",
        rig: Some(("stage_offset", "rig", &[("x_mm", 0.4), ("y_mm", -0.3)])),
        gate: open([1.42, 1.10]),
        ..NO_CASE
    },
    Case {
        name: "stage turned 1°",
        rig: Some(("stage_rotation", "rig", &[("deg", 1.0)])),
        gate: open([1.10, 1.10]),
        ..NO_CASE
    },
    Case {
        name: "reference tilted 2°",
        rig: Some(("reference_tilt", "rig", &[("x_deg", 2.0), ("y_deg", 0.0)])),
        gate: open([1.10, 1.10]),
        ..NO_CASE
    },
    Case {
        name: "reference 1.02",
        rig: Some(("reference_gain", "rig", &[("gain", 1.02)])),
        gate: open([1.10, 2.08]),
        ..NO_CASE
    },
];

fn truth((effect, target, parameters): Cause) -> Truth {
    Truth::new(effect, target, parameters)
}

impl Case {
    /// What the rig does wrong.
    pub(super) fn rig(&self) -> Vec<Truth> {
        self.rig.map(truth).into_iter().collect()
    }

    /// What is hidden beside the pad's wiring, in the program's words.
    pub(super) fn hidden(&self) -> Vec<Truth> {
        let memory = match self.memory {
            Memory::Nothing => None,
            Memory::Plays | Memory::BoucWen => Some(Truth::new("hysteresis", "pad", &[])),
            Memory::LogCreep => Some(Truth::new("creep", "pad", &[])),
        };
        self.field.map(truth).into_iter().chain(memory).chain(self.rig()).collect()
    }

    /// The true change of a number of the device file, or of the rig as `stage_offset.x_mm`; none where there is no such
    /// thing.
    pub(super) fn change(&self, name: &str) -> Option<f64> {
        let known = self.numbers.iter().find(|(own, _)| *own == name).map(|known| known.1);
        let of_rig = || {
            let (effect, parameter) = name.split_once('.')?;
            let (_, _, parameters) = self.rig.filter(|(of, ..)| *of == effect)?;
            let (_, value) = parameters.iter().find(|(of, _)| *of == parameter)?;
            // What is 1 of a rig without a fault differs from that.
            Some(if matches!(parameter, "gain" | "scale") { value - 1.0 } else { *value })
        };
        Some(known.or_else(of_rig).unwrap_or(0.0)).filter(|change| change.is_finite())
    }

    /// Whether the table is another pad than the nominal one, or that itself, on a perfect rig and without memory.
    pub(super) fn is_of_a_field(&self) -> bool {
        self.memory == Memory::Nothing && self.rig.is_none()
    }
}
