//! Decoders that are linear in the channels.
//!
//! *Linear*: all five numbers of a contact as linear functions of the channels. It fails in the place, which is a ratio.
//! *Wrench*: Fx, Fy, Fz, x Fz and y Fz as linear functions, and the place by division: the simplest decoder that respects
//! the physics, since shear apart the moments about the plate's axes are what the modules' loads add up to.

use crate::network::Zero;
use crate::pipeline::contact::statics::FORCE_RESOLUTION_N;
use crate::quantity::{CHANNELS, Contact, Strain};

/// Terms of each function: nine channels and a constant.
pub const TERMS: usize = CHANNELS + 1;

/// Target of the five functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// x, y, Fx, Fy, Fz.
    Contact,
    /// x Fz, y Fz, Fx, Fy, Fz.
    Wrench,
}

/// Five linear functions of the channels.
#[derive(Clone, Debug, PartialEq)]
pub struct Regression {
    /// Zero of the channels.
    pub zero: Zero,
    /// Target of the functions.
    pub target: Target,
    /// Factors of the channels in µV, then the constant; mm, N·mm and N.
    pub functions: [[f64; TERMS]; 5],
    /// No contact is farther from the axis.
    pub reach_mm: f64,
}

impl Regression {
    /// The contact. Strain that is not finite is no contact; a wrench without force is in the middle.
    pub fn decode(&self, strain: &Strain) -> Contact {
        let value = |function: &[f64; TERMS]| {
            let channels = function.iter().zip(&strain.uv).map(|(factor, uv)| factor * f64::from(*uv));
            channels.sum::<f64>() + function[CHANNELS]
        };
        let [first, second, fx, fy, fz] = self.functions.each_ref().map(value);
        let place = match self.target {
            Target::Contact => [first, second],
            Target::Wrench if fz.abs() < f64::from(FORCE_RESOLUTION_N) => [0.0; 2],
            Target::Wrench => [first / fz, second / fz],
        };
        let share = (self.reach_mm / libm::hypot(place[0], place[1])).min(1.0);
        let [x_mm, y_mm] = place.map(|mm| (share * mm) as f32);
        let contact = Contact { x_mm, y_mm, fx_n: fx as f32, fy_n: fy as f32, fz_n: fz as f32 };
        let is_finite =
            [x_mm, y_mm, contact.fx_n, contact.fy_n, contact.fz_n].iter().all(|it| it.is_finite());
        if is_finite { contact } else { Contact::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn regression(target: Target) -> Regression {
        let mut functions = [[0.0; TERMS]; 5];
        (functions[0][0], functions[1][1], functions[4][2]) = (0.1, 0.2, 0.001);
        functions[3][CHANNELS] = 0.5;
        Regression { zero: Zero::Tared, target, functions, reach_mm: 29.0 }
    }

    #[test]
    fn a_wrench_divides_and_a_contact_does_not() {
        let mut strain = Strain::default();
        (strain.uv[0], strain.uv[1], strain.uv[2]) = (100.0, -20.0, 2000.0);
        let place = |target| {
            let Contact { x_mm, y_mm, fx_n, fy_n, fz_n } = regression(target).decode(&strain);
            assert_eq!((fx_n, fy_n, fz_n), (0.0, 0.5, 2.0));
            (x_mm, y_mm)
        };
        assert_eq!(place(Target::Contact), (10.0, -4.0));
        assert_eq!(place(Target::Wrench), (5.0, -2.0));
    }

    #[test]
    fn nothing_leaves_the_plate_or_the_numbers() {
        let mut strain = Strain::default();
        assert_eq!(regression(Target::Wrench).decode(&strain).x_mm, 0.0);
        strain.uv[0] = 1e6;
        assert_eq!(regression(Target::Contact).decode(&strain).x_mm, 29.0);
        strain.uv[2] = f32::NAN;
        assert_eq!(regression(Target::Wrench).decode(&strain), Contact::default());
    }
}
