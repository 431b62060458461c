//! What a person is asked to do on the pad, and how exactly a hand does it.

use tactpad_core::pad::device::Device;
use tactpad_core::quantity::{Contact, MODULES};

/// Deviation of a finger from the place that was asked for, along each axis.
pub(super) const PLACE_MM: f64 = 5.0;
/// Deviation of the force along the plate from what was asked for, as a share of the normal force.
pub(super) const SHEAR_SHARE: f64 = 0.25;
/// The force along the plate that a push has, as a share of the normal force.
const PUSH_SHARE: f64 = 0.5;

/// Something to do on the pad.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Deed {
    /// Press straight down above a module.
    Press {
        /// Its index.
        module: usize,
    },
    /// Press in the middle and push along the plate, without sliding.
    Push {
        /// Towards +x or +y.
        axis: PlateAxis,
    },
}

/// An axis of the plate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlateAxis {
    /// To the right.
    X,
    /// Up, as the pad lies before you.
    Y,
}

impl Deed {
    /// All of them, in the order in which they are asked for.
    pub const ALL: [Self; MODULES + 2] = [
        Self::Press { module: 0 },
        Self::Press { module: 1 },
        Self::Press { module: 2 },
        Self::Push { axis: PlateAxis::X },
        Self::Push { axis: PlateAxis::Y },
    ];

    /// The contact that is meant, with 1 N into the plate.
    pub fn meant(self, device: &Device) -> Contact {
        match self {
            Self::Press { module } => {
                let [x_mm, y_mm] = device.poses()[module].centre_mm.map(|mm| mm as f32);
                Contact { x_mm, y_mm, fz_n: 1.0, ..Contact::default() }
            }
            Self::Push { axis } => {
                let along = |is_so: bool| if is_so { PUSH_SHARE as f32 } else { 0.0 };
                let [fx_n, fy_n] = [PlateAxis::X, PlateAxis::Y].map(|it| along(it == axis));
                Contact { fx_n, fy_n, fz_n: 1.0, ..Contact::default() }
            }
        }
    }
}
