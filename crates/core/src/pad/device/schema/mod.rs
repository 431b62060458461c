//! Every number of the device file, once: its key, unit and range, where [`Device`] holds it, and what it changes.
//!
//! Reading, writing, [`super::parameter::Parameter`] and the fingerprint all follow these lists.
//!
//! The ranges are narrow on purpose. From the lowest to the highest value it is less than a factor of 1,000, so
//! that a length in metres or micrometres, or a modulus in gigapascals, is never taken for one in the file's unit.

use std::slice;

use super::unit::Unit;
use super::{Device, Direction, Gauge, Module, Reported, Side};
use crate::quantity::CHANNELS;

/// Part of the pad that a number changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// The influence field: microvolts per newton, and where they are known.
    Field,
    /// Gains and offsets of the field's signals.
    Readout,
    /// What comes and goes in time, and what the measuring rig adds: see [`Behaviour`](super::behaviour::Behaviour).
    Behaviour,
    /// The pad's mass, and with it its natural frequencies; nothing at rest.
    Dynamics,
    /// Nothing that is computed.
    Nothing,
}

/// A number, or a list of numbers, in a table that describes a `T`.
pub(super) struct Key<T: 'static> {
    /// As the file writes it.
    pub(super) name: &'static str,
    /// How parameters name the list's numbers; one empty name where the key holds a single number.
    pub(super) elements: &'static [&'static str],
    pub(super) unit: Unit,
    /// The least and the greatest value.
    pub(super) range: (f64, f64),
    pub(super) effect: Effect,
    /// Whether a file may leave it out.
    pub(super) optional: bool,
    pub(super) access: Access<T>,
    /// For people, so that "write …" goes before it.
    pub(super) meaning: &'static str,
}

/// Where a `T` holds the numbers of a key, one for each of its elements.
pub(super) struct Access<T: 'static> {
    pub(super) get: fn(&T) -> &[f64],
    pub(super) get_mut: fn(&mut T) -> &mut [f64],
}

/// A table that stands once in a file and describes a `T`.
pub(super) struct Table<T: 'static> {
    /// Its header.
    pub(super) path: &'static str,
    /// What it holds beside numbers of the `T`.
    pub(super) words: &'static [&'static str],
    pub(super) keys: &'static [Key<T>],
}

/// The schema that is read and written.
pub(super) const SCHEMA: &str = "sstid-device/1";

/// The directions of gauges, as the file writes them.
pub(super) const DIRECTIONS: [(&str, Direction); 2] = [("x", Direction::X), ("y", Direction::Y)];

/// The sides of a frame, as the file writes them.
pub(super) const SIDES: [(&str, Side); 4] =
    [named(Side::PlusX), named(Side::MinusX), named(Side::PlusY), named(Side::MinusY)];

const fn named(side: Side) -> (&'static str, Side) {
    (side.name(), side)
}

const SINGLE: [&str; 1] = [""];
const MODULE_NUMBERS: [&str; 3] = ["0", "1", "2"];
const AXES: [&str; 3] = ["x", "y", "z"];

const MM: Unit = Unit::Millimetre;
const DEG: Unit = Unit::Degree;
const MPA: Unit = Unit::Megapascal;
const VOLT: Unit = Unit::Volt;
const UV: Unit = Unit::Microvolt;
const NEWTON: Unit = Unit::Newton;
const RATIO: Unit = Unit::One;
const DENSITY: Unit = Unit::KilogramPerCubicMetre;

/// Poisson's ratios: 0.5 is no material that elements of finite stiffness can stand for.
const NU: (f64, f64) = (-0.95, 0.49);
/// From foam to the densest metal.
const DENSITY_KG_M3: (f64, f64) = (100.0, 25_000.0);
/// Layers of the film.
const LAYER_MM: (f64, f64) = (0.002, 1.0);
/// What is small in a module.
const PART_MM: (f64, f64) = (0.05, 20.0);
const PLACE_MM: (f64, f64) = (-50.0, 50.0);
const SHIFT_MM: (f64, f64) = (-10.0, 10.0);
const TILT_DEG: (f64, f64) = (-10.0, 10.0);
const STIFFNESS: (f64, f64) = (0.01, 10.0);

macro_rules! one {
    ($($field:tt)+) => {
        Access {
            get: |record| slice::from_ref(&record.$($field)+),
            get_mut: |record| slice::from_mut(&mut record.$($field)+),
        }
    };
}

macro_rules! list {
    ($($field:tt)+) => {
        Access { get: |record| &record.$($field)+, get_mut: |record| &mut record.$($field)+ }
    };
}

macro_rules! material {
    ($name:ident, $e_mpa:expr, $effect:ident, $of_mass:ident, $meaning:literal) => {
        Table {
            path: concat!("material.", stringify!($name)),
            words: &[],
            keys: &[
                Key::<Device>::new(
                    "e_mpa",
                    MPA,
                    $e_mpa,
                    one!(material.$name.e_mpa),
                    concat!("Young's modulus of ", $meaning),
                )
                .with(Effect::$effect),
                Key::<Device>::new(
                    "nu",
                    RATIO,
                    NU,
                    one!(material.$name.nu),
                    concat!("Poisson's ratio of ", $meaning),
                )
                .with(Effect::$effect),
                Key::<Device>::new(
                    "density_kg_m3",
                    DENSITY,
                    DENSITY_KG_M3,
                    one!(material.$name.density_kg_m3),
                    concat!("the density of ", $meaning),
                )
                .with(Effect::$of_mass)
                .optional(),
            ],
        }
    };
}

impl<T> Key<T> {
    const fn new(
        name: &'static str,
        unit: Unit,
        range: (f64, f64),
        access: Access<T>,
        meaning: &'static str,
    ) -> Self {
        Self { name, elements: &SINGLE, unit, range, effect: Effect::Field, optional: false, access, meaning }
    }

    const fn with(mut self, effect: Effect) -> Self {
        self.effect = effect;
        self
    }

    const fn optional(mut self) -> Self {
        self.optional = true;
        self
    }

    const fn listed(mut self, elements: &'static [&'static str]) -> Self {
        self.elements = elements;
        self
    }

    /// Whether a single number may stand for the whole list: for all channels.
    pub(super) const fn takes_one_for_all(&self) -> bool {
        self.elements.len() == CHANNELS
    }
}

pub(super) mod behaviour;

/// The tables that stand once in the file and hold numbers, without the materials.
pub(super) static TABLES: [Table<Device>; 6] = [
    Table {
        path: "plate",
        words: &[],
        keys: &[
            Key::new("diameter_mm", MM, (10.0, 500.0), one!(plate.diameter_mm), "the plate's diameter"),
            Key::new("thickness_mm", MM, (0.1, 10.0), one!(plate.thickness_mm), "the plate's thickness"),
        ],
    },
    Table {
        path: "modules",
        words: &["count"],
        keys: &[
            Key::<Device>::new(
                "angles_deg",
                DEG,
                (-360.0, 360.0),
                list!(sites.angles_deg),
                "the angles of modules 0, 1, 2, counter-clockwise from +x",
            )
            .listed(&MODULE_NUMBERS),
            Key::new(
                "centre_radius_mm",
                MM,
                (1.0, 200.0),
                one!(sites.centre_radius_mm),
                "the distance of the modules' centres from the pad's axis",
            ),
        ],
    },
    Table { path: "stack", words: &[], keys: &STACK },
    Table {
        path: "gauge_law",
        words: &[],
        keys: &[
            Key::new(
                "gauge_factor",
                RATIO,
                (0.5, 250.0),
                one!(gauge_law.gauge_factor),
                "the relative change of resistance per strain along the grid",
            ),
            Key::new(
                "transverse_ratio",
                RATIO,
                (-1.0, 1.0),
                one!(gauge_law.transverse_ratio),
                "the sensitivity across the grid as a share of that along it",
            ),
        ],
    },
    Table {
        path: "circuit",
        words: &["channel_order", "bridge_nonlinearity"],
        keys: &[Key::new(
            "excitation_v",
            VOLT,
            (0.1, 30.0),
            one!(circuit.excitation_v),
            "the bridges' excitation",
        )],
    },
    Table {
        path: "contact",
        words: &[],
        keys: &[
            PATCH_RADIUS,
            Key::new(
                "max_centre_radius_mm",
                MM,
                (1.0, 250.0),
                one!(contact.max_centre_radius_mm),
                "the farthest contact's distance from the pad's axis",
            ),
            Key::<Device>::new(
                "full_scale_n",
                NEWTON,
                (0.1, 90.0),
                one!(contact.full_scale_n),
                "the full scale of each force",
            )
            .with(Effect::Nothing),
        ],
    },
];

const PATCH_RADIUS: Key<Device> = Key::new(
    "patch_radius_mm",
    MM,
    (0.05, 20.0),
    one!(contact.patch_radius_mm),
    "the radius of the disc on which a contact presses evenly",
);

/// The number of `[contact]` that `[finger]` may write, too: a finger is a contact.
pub(super) static PATCH: [Key<Device>; 1] = [PATCH_RADIUS];

static STACK: [Key<Device>; 11] = [
    Key::new(
        "film_length_x_mm",
        MM,
        (0.5, 100.0),
        one!(stack.film_length_x_mm),
        "the film's size along x (tangential)",
    ),
    Key::new(
        "film_width_y_mm",
        MM,
        (0.5, 100.0),
        one!(stack.film_width_y_mm),
        "the film's size along y (radial)",
    ),
    Key::new("frame_width_mm", MM, PART_MM, one!(stack.frame_width_mm), "the width of the frame's ring"),
    Key::new("frame_thickness_mm", MM, (0.01, 5.0), one!(stack.frame_thickness_mm), "the frame's height"),
    Key::new("pi_thickness_mm", MM, LAYER_MM, one!(stack.pi_thickness_mm), "the polyimide's thickness"),
    Key::new("adh_thickness_mm", MM, LAYER_MM, one!(stack.adh_thickness_mm), "the adhesive's thickness"),
    Key::new(
        "fpc_thickness_mm",
        MM,
        LAYER_MM,
        one!(stack.fpc_thickness_mm),
        "the flexible circuit's thickness",
    ),
    Key::new(
        "post_length_x_mm",
        MM,
        PART_MM,
        one!(stack.post_length_x_mm),
        "the post's size along x (tangential)",
    ),
    Key::new("post_width_y_mm", MM, PART_MM, one!(stack.post_width_y_mm), "the post's size along y (radial)"),
    Key::new("post_height_mm", MM, PART_MM, one!(stack.post_height_mm), "the post's height"),
    Key::new(
        "bond_thickness_mm",
        MM,
        (0.005, 2.0),
        one!(stack.bond_thickness_mm),
        "the thickness of the glue between post and plate",
    ),
];

/// The entries of `[material]`.
pub(super) static MATERIALS: [Table<Device>; 7] = [
    material!(plate, (1_200.0, 1e6), Field, Dynamics, "the plate"),
    material!(pick, (500.0, 400_000.0), Field, Dynamics, "the posts"),
    material!(fpc, (100.0, 50_000.0), Field, Dynamics, "the flexible circuit"),
    material!(adh, (10.0, 9_000.0), Field, Dynamics, "the adhesive"),
    material!(pi, (100.0, 50_000.0), Field, Dynamics, "the polyimide"),
    material!(epoxy, (10.0, 9_000.0), Field, Dynamics, "frame and bond"),
    material!(gauge, (1_200.0, 1e6), Nothing, Nothing, "the gauges' foil"),
];

/// The names of the gauges, in the order of [`Device::gauges`].
pub(super) const GAUGE_NAMES: [&str; super::GAUGES] = ["R1", "R2", "R3", "R4", "R5", "R6", "R7"];

/// The numbers of a `[[gauge]]` table.
pub(super) static GAUGE: [Key<Gauge>; 5] = [
    Key::new("x", MM, PLACE_MM, one!(x_mm), "its centre's x (tangential)"),
    Key::new("y", MM, PLACE_MM, one!(y_mm), "its centre's y (radial)"),
    Key::new("length_mm", MM, PART_MM, one!(length_mm), "its size along the grid"),
    Key::new("width_mm", MM, PART_MM, one!(width_mm), "its size across the grid"),
    Key::new(
        "resistance_ratio",
        Unit::BridgeR,
        (0.1, 10.0),
        one!(resistance_ratio),
        "its resistance as a share of the bridge's R, not ohms",
    ),
];

/// The numbers of `[reported]`: what the paper measured on its own hardware. No parameters: nothing follows from
/// them.
pub(super) static REPORTED: [Key<Reported>; 4] = [
    Key::new(
        "force_resolution_n",
        NEWTON,
        (1e-6, 1.0),
        one!(force_resolution_n),
        "the smallest force that was told apart",
    ),
    Key::new(
        "thermal_drift_uv_per_10k",
        UV,
        (-1e5, 1e5),
        one!(thermal_drift_uv_per_10k),
        "the drift of each channel over 10 K",
    ),
    Key::new(
        "repeatability_percent_fso",
        RATIO,
        (0.0, 100.0),
        one!(repeatability_percent_fso),
        "the repeatability in percent of the full scale's output",
    ),
    Key::new(
        "hysteresis_percent_fso",
        RATIO,
        (0.0, 100.0),
        one!(hysteresis_percent_fso),
        "the hysteresis in percent of the full scale's output",
    ),
];

/// The numbers of a `[[module]]` table; each may be absent.
pub(super) static MODULE: [Key<Module>; 11] = [
    Key::new("radial_mm", MM, SHIFT_MM, one!(radial_mm), "its displacement outwards"),
    Key::new("tangential_mm", MM, SHIFT_MM, one!(tangential_mm), "its displacement counter-clockwise"),
    Key::new(
        "rotation_deg",
        DEG,
        (-180.0, 180.0),
        one!(rotation_deg),
        "its turn about z, counter-clockwise seen from above",
    ),
    Key::new(
        "tilt_tangential_deg",
        DEG,
        TILT_DEG,
        one!(tilt_tangential_deg),
        "its turn about its tangential axis: the outer side moves down",
    ),
    Key::new(
        "tilt_radial_deg",
        DEG,
        TILT_DEG,
        one!(tilt_radial_deg),
        "its turn about its radial axis: the counter-clockwise side moves up",
    ),
    Key::new("frame_e_factor", RATIO, STIFFNESS, one!(frame_e_factor), "the factor of its frame's modulus"),
    Key::new("bond_e_factor", RATIO, STIFFNESS, one!(bond_e_factor), "the factor of its bond's modulus"),
    Key::new(
        "film_e_factor",
        RATIO,
        STIFFNESS,
        one!(film_e_factor),
        "the factor of its PI's, ADH's and FPC's moduli",
    ),
    Key::new(
        "debonded_share",
        RATIO,
        (0.0, 0.9),
        one!(debonded_share),
        "the share of its bond's area that has come off",
    ),
    Key::<Module>::new("gain", RATIO, (-10.0, 10.0), list!(gain), "the factors of its signals x, y, z")
        .listed(&AXES)
        .with(Effect::Readout),
    Key::<Module>::new(
        "offset_uv",
        UV,
        (-1e5, 1e5),
        list!(offset_uv),
        "what is added to its signals x, y, z",
    )
    .listed(&AXES)
    .with(Effect::Readout),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_range_holds_a_number_in_two_units() {
        for table in TABLES.iter().chain(&MATERIALS) {
            for Key { name, unit, range: (low, high), .. } in table.keys {
                let wide = low * 1_000.0 <= *high;
                let exempt = [Unit::Degree, Unit::One].contains(unit);
                assert!(exempt || (*low > 0.0 && !wide), "{} {name}", table.path);
            }
        }
    }
}
