//! The pad as a device file describes it: geometry, materials, gauges, circuit, and how each module differs.
//!
//! Every number of the simulator comes from here. Lengths are in millimetres, moduli in megapascals (N/mm²), forces
//! in newtons, bridge signals in microvolts. Frames are those of the device file: the pad frame has its origin at
//! the centre of the plate's top surface; a module's frame has x along the tangent (counter-clockwise), y along the
//! radius (outwards) and the pad's z, which makes it left-handed.
//!
//! A file's text becomes a [`Device`] in `reading` → `imperfection` → `possible` → `read`; each of these uses only
//! those before it, and all follow the list of numbers in [`schema`]. `write` is the way back.

use self::behaviour::Behaviour;
use crate::quantity::MODULES;

pub mod behaviour;
pub(crate) mod fingerprint;
mod imperfection;
mod lines;
pub mod parameter;
pub mod pose;
mod possible;
mod read;
mod reading;
pub mod schema;
pub mod unit;
mod write;

/// Gauges under each module's film.
pub const GAUGES: usize = 7;

/// A pad: three modules between a rigid base and a round plate.
#[derive(Clone, Debug, PartialEq)]
pub struct Device {
    /// What the file calls it.
    pub name: String,
    /// The plate that is touched.
    pub plate: Plate,
    /// Where the modules stand.
    pub sites: Sites,
    /// The layers of every module.
    pub stack: Stack,
    /// Their elastic constants and densities.
    pub material: Materials,
    /// How a gauge turns strain into resistance.
    pub gauge_law: GaugeLaw,
    /// The gauges R1 … R7 of every module.
    pub gauges: [Gauge; GAUGES],
    /// The bridges.
    pub circuit: Circuit,
    /// Patch of a contact.
    pub contact: Patch,
    /// What was measured on the hardware that it describes, where the file says so.
    pub reported: Option<Reported>,
    /// How each module differs from the nominal one.
    pub modules: [Module; MODULES],
    /// Behaviour beyond its mechanics.
    pub behaviour: Behaviour,
}

/// A round plate of even thickness; its top surface is z = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plate {
    /// Diameter.
    pub diameter_mm: f64,
    /// Thickness.
    pub thickness_mm: f64,
}

impl Plate {
    /// How far the rim is from the centre. No place in a table lies farther out along x or y.
    pub fn radius_mm(&self) -> f64 {
        self.diameter_mm / 2.0
    }
}

/// The nominal places of the module centres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sites {
    /// Angles of the modules, counter-clockwise from +x.
    pub angles_deg: [f64; MODULES],
    /// Their distance from the pad's axis.
    pub centre_radius_mm: f64,
}

/// The layers of a module from bottom to top: frame, PI, ADH, FPC, post (pick), bond. All are rectangular blocks,
/// centred on the module's centre. The frame is a ring along the film's outline, fixed to the rigid base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stack {
    /// Film along x (tangential).
    pub film_length_x_mm: f64,
    /// Film along y (radial).
    pub film_width_y_mm: f64,
    /// Width of the frame's ring.
    pub frame_width_mm: f64,
    /// Height of the frame.
    pub frame_thickness_mm: f64,
    /// Polyimide, with the gauges on its underside.
    pub pi_thickness_mm: f64,
    /// Adhesive.
    pub adh_thickness_mm: f64,
    /// Flexible printed circuit.
    pub fpc_thickness_mm: f64,
    /// Post (and bond) along x.
    pub post_length_x_mm: f64,
    /// Post (and bond) along y.
    pub post_width_y_mm: f64,
    /// Height of the post.
    pub post_height_mm: f64,
    /// Glue between post and plate.
    pub bond_thickness_mm: f64,
}

/// An isotropic, linear elastic material, and what it weighs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Young's modulus, N/mm².
    pub e_mpa: f64,
    /// Poisson's ratio.
    pub nu: f64,
    /// Density, kg/m³.
    pub density_kg_m3: f64,
}

/// The materials of the pad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Materials {
    /// The plate.
    pub plate: Material,
    /// The posts.
    pub pick: Material,
    /// Flexible printed circuit.
    pub fpc: Material,
    /// Adhesive in the film.
    pub adh: Material,
    /// Polyimide.
    pub pi: Material,
    /// Frame and bond.
    pub epoxy: Material,
    /// Gauge foil; listed for completeness, not used as stiffness.
    pub gauge: Material,
}

/// ΔR/R = `gauge_factor` · (ε along + `transverse_ratio` · ε across), each strain averaged over the gauge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaugeLaw {
    /// Relative resistance change per strain along the grid.
    pub gauge_factor: f64,
    /// Sensitivity across the grid as a share of that along it.
    pub transverse_ratio: f64,
}

/// A direction in a module's plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Tangential.
    X,
    /// Radial.
    Y,
}

/// A rectangular gauge on the film's underside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gauge {
    /// Centre in the module's frame.
    pub x_mm: f64,
    /// Centre in the module's frame.
    pub y_mm: f64,
    /// Size along the grid.
    pub length_mm: f64,
    /// Size across the grid.
    pub width_mm: f64,
    /// The grid's direction.
    pub direction: Direction,
    /// Its resistance as a share of the bridge's R.
    pub resistance_ratio: f64,
}

/// The half-bridges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circuit {
    /// Excitation, volts.
    pub excitation_v: f64,
    /// Whether the signals are the bridges' exact voltages instead of their linear part.
    pub bridge_nonlinearity: bool,
}

/// A contact: even traction over a disc on the plate's top surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Radius of the disc.
    pub patch_radius_mm: f64,
    /// Farthest centre from the pad's axis.
    pub max_centre_radius_mm: f64,
    /// Full scale of each force.
    pub full_scale_n: f64,
}

/// Figures that somebody measured on hardware, for orientation: nothing is computed from them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reported {
    /// The smallest force that was told apart.
    pub force_resolution_n: f64,
    /// Drift of each channel over 10 K.
    pub thermal_drift_uv_per_10k: f64,
    /// Repeatability in percent of the full scale's output.
    pub repeatability_percent_fso: f64,
    /// Hysteresis in percent of the full scale's output.
    pub hysteresis_percent_fso: f64,
}

/// A side of a module's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Towards +x, counter-clockwise.
    PlusX,
    /// Towards −x, clockwise.
    MinusX,
    /// Towards +y, outwards.
    PlusY,
    /// Towards −y, inwards.
    MinusY,
}

impl Side {
    /// All four.
    pub const ALL: [Self; 4] = [Self::PlusX, Self::MinusX, Self::PlusY, Self::MinusY];

    /// As device files write it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::PlusX => "+x",
            Self::MinusX => "-x",
            Self::PlusY => "+y",
            Self::MinusY => "-y",
        }
    }
}

/// How one module differs from the nominal one: a `[[module]]` table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Module {
    /// Displacement outwards.
    pub radial_mm: f64,
    /// Displacement counter-clockwise.
    pub tangential_mm: f64,
    /// Turn about its own z axis, counter-clockwise seen from above.
    pub rotation_deg: f64,
    /// Turn about its tangential axis, right-handed about the vector +x: its outer side moves down.
    pub tilt_tangential_deg: f64,
    /// Turn about its radial axis, right-handed about the vector +y: its counter-clockwise side moves up.
    pub tilt_radial_deg: f64,
    /// Factor of the frame's modulus.
    pub frame_e_factor: f64,
    /// Factor of the bond's modulus.
    pub bond_e_factor: f64,
    /// Factor of the moduli of PI, ADH and FPC.
    pub film_e_factor: f64,
    /// The side on which the frame is missing.
    pub frame_open: Option<Side>,
    /// Share of the bond's area that has come off, from `debonded_side` inwards.
    pub debonded_share: f64,
    /// Where the bond has come off; in a device that was read, there is a side exactly if there is a share.
    pub debonded_side: Option<Side>,
    /// Factors of the three signals x, y, z.
    pub gain: [f64; 3],
    /// Added to the three signals.
    pub offset_uv: [f64; 3],
}

impl Module {
    /// A module as drawn.
    pub const NOMINAL: Self = Self {
        radial_mm: 0.0,
        tangential_mm: 0.0,
        rotation_deg: 0.0,
        tilt_tangential_deg: 0.0,
        tilt_radial_deg: 0.0,
        frame_e_factor: 1.0,
        bond_e_factor: 1.0,
        film_e_factor: 1.0,
        frame_open: None,
        debonded_share: 0.0,
        debonded_side: None,
        gain: [1.0; 3],
        offset_uv: [0.0; 3],
    };

    /// Where its bond has come off, and over which share of the bond's area; `None` where it is whole.
    pub fn debonded(&self) -> Option<(Side, f64)> {
        self.debonded_side.map(|side| (side, self.debonded_share)).filter(|(_, share)| *share > 0.0)
    }
}
