//! Creep: the part of a channel's reading that follows a load late, µV: adhesive and polyimide give way slowly.
//!
//! A channel reads s = e + c u, where e is the strain of a sudden load and u that strain low-passed with a relaxation time:
//! the first term of a Prony series.
//!
//! Source: J. D. Ferry, Viscoelastic Properties of Polymers (1980), chapter 1.

use crate::quantity::CHANNELS;
use tactpad_numeric::memory::{Relaxation, relaxed};

/// How far a pad has crept.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CreepState {
    /// The strains, low-passed.
    pub state_uv: [f64; CHANNELS],
}

impl CreepState {
    /// These strains were held for so long. Without a relaxation time they are crept to at once.
    pub fn hold(&mut self, uv: &[f64; CHANNELS], held_s: f64, creep: &Relaxation) {
        let left = creep.left(held_s);
        self.state_uv.iter_mut().zip(uv).for_each(|(state, uv)| *state = relaxed(*state, *uv, left));
    }

    /// Creep of the channels, µV.
    pub fn added_uv(&self, creep: &Relaxation) -> [f64; CHANNELS] {
        self.state_uv.map(|uv| creep.added(uv))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_load_is_crept_to_however_its_time_is_cut() {
        let creep = Relaxation { time_s: 8.0, share: 0.01 };
        let (mut whole, mut cut) = (CreepState::default(), CreepState::default());
        whole.hold(&[1000.0; CHANNELS], 8.0, &creep);
        (0..8000).for_each(|_| cut.hold(&[1000.0; CHANNELS], 1e-3, &creep));
        let wanted_uv = 1000.0 * (1.0 - (-1.0_f64).exp());
        assert!((whole.state_uv[0] - wanted_uv).abs() < 1e-9);
        assert!((cut.state_uv[8] - wanted_uv).abs() < 1e-6);
        let added_uv = whole.added_uv(&creep);
        assert!((added_uv[4] - 0.01 * wanted_uv).abs() < 1e-9);
        whole.hold(&[0.0; CHANNELS], 1e9, &creep);
        assert_eq!(whole, CreepState::default(), "all is forgotten in the end");
        assert_eq!(cut.added_uv(&Relaxation::NONE), [0.0; CHANNELS]);
    }
}
