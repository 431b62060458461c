//! The nominal pad of `models/sstid.toml`, written out: goes when the program reads device files.

use super::Direction::{X, Y};
use super::{
    Circuit, Device, Direction, GAUGES, Gauge, GaugeLaw, Material, Materials, Module, Patch, Plate, Sites,
    Stack,
};
use crate::quantity::MODULES;

const STACK: Stack = Stack {
    film_length_x_mm: 9.8,
    film_width_y_mm: 5.4,
    frame_width_mm: 0.8,
    frame_thickness_mm: 0.2,
    pi_thickness_mm: 0.125,
    adh_thickness_mm: 0.05,
    fpc_thickness_mm: 0.13,
    post_length_x_mm: 2.0,
    post_width_y_mm: 1.4,
    post_height_mm: 1.2,
    bond_thickness_mm: 0.1,
};

const MATERIALS: Materials = Materials {
    plate: Material { e_mpa: 193_000.0, nu: 0.29 },
    pick: Material { e_mpa: 19_000.0, nu: 0.3 },
    fpc: Material { e_mpa: 4_100.0, nu: 0.33 },
    adh: Material { e_mpa: 600.0, nu: 0.4 },
    pi: Material { e_mpa: 5_000.0, nu: 0.34 },
    epoxy: Material { e_mpa: 250.0, nu: 0.35 },
    gauge: Material { e_mpa: 90_000.0, nu: 0.33 },
};

const R1_TO_R7: [Gauge; GAUGES] = [
    gauge([-3.3, 0.0], 1.2, X, 1.0),
    gauge([3.3, 0.0], 1.2, X, 1.0),
    gauge([0.0, -1.0], 0.6, Y, 1.0),
    gauge([0.0, 1.0], 0.6, Y, 1.0),
    gauge([-1.1, 0.0], 0.8, X, 0.5),
    gauge([1.1, 0.0], 0.8, X, 0.5),
    gauge([0.0, 0.0], 0.8, X, 1.0),
];

const fn gauge([x_mm, y_mm]: [f64; 2], length_mm: f64, direction: Direction, resistance_ratio: f64) -> Gauge {
    Gauge { x_mm, y_mm, length_mm, width_mm: 0.8, direction, resistance_ratio }
}

impl Device {
    /// The nominal pad.
    pub fn nominal() -> Self {
        Self {
            name: "SSTID nominal".into(),
            plate: Plate { diameter_mm: 60.0, thickness_mm: 1.0 },
            sites: Sites { angles_deg: [0.0, 120.0, 240.0], centre_radius_mm: 20.0 },
            stack: STACK,
            material: MATERIALS,
            gauge_law: GaugeLaw { gauge_factor: 2.0, transverse_ratio: 5.4 / 9.8 },
            gauges: R1_TO_R7,
            circuit: Circuit { excitation_v: 2.8, bridge_nonlinearity: false },
            contact: Patch { patch_radius_mm: 1.0, max_centre_radius_mm: 29.0, full_scale_n: 5.0 },
            modules: [Module::NOMINAL; MODULES],
        }
    }
}
