//! Creep: the part of a channel's reading that follows a load late, µV: adhesive and polyimide give way slowly.
//!
//! A channel reads s = e + w c, where e is the strain of a sudden load and c that strain low-passed with a relaxation time:
//! the first term of a Prony series.
//!
//! Source: J. D. Ferry, Viscoelastic Properties of Polymers (1980), chapter 1.

use crate::quantity::CHANNELS;

/// How all channels creep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Creep {
    /// Relaxation time.
    pub time_s: f64,
    /// Final share c of creep in a load, dimensionless.
    pub share: f64,
}

/// A pad that does not creep.
pub const NO_CREEP: Creep = Creep { time_s: 0.0, share: 0.0 };

impl Creep {
    /// Creep of a channel, µV: c u, with the share c and the state u.
    pub const fn added_uv(&self, crept_uv: f64) -> f64 {
        self.share * crept_uv
    }
}

/// How far a pad has crept.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CreepState {
    /// The strains, low-passed.
    pub state_uv: [f64; CHANNELS],
}

impl CreepState {
    /// These strains were held for so long. Without a relaxation time they are crept to at once.
    pub fn hold(&mut self, uv: &[f64; CHANNELS], held_s: f64, time_s: f64) {
        let left = left(held_s, time_s);
        self.state_uv.iter_mut().zip(uv).for_each(|(state, uv)| *state = held_uv(*state, *uv, left));
    }

    /// Creep of the channels, µV.
    pub fn added_uv(&self, creep: &Creep) -> [f64; CHANNELS] {
        self.state_uv.map(|uv| creep.added_uv(uv))
    }
}

/// The share of a channel's distance from a strain that is left when that was held for so long.
pub fn left(held_s: f64, time_s: f64) -> f64 {
    if held_s > 0.0 { libm::exp(-held_s / time_s) } else { 1.0 }
}

/// How far one channel has crept when a strain was held until this share of its distance was left.
pub const fn held_uv(crept_uv: f64, uv: f64, left: f64) -> f64 {
    // τ ċ = e − c with e held: c ← e + (c − e) exp(−Δt / τ).
    uv + left * (crept_uv - uv)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_load_is_crept_to_however_its_time_is_cut() {
        let (mut whole, mut cut) = (CreepState::default(), CreepState::default());
        whole.hold(&[1000.0; CHANNELS], 8.0, 8.0);
        (0..8000).for_each(|_| cut.hold(&[1000.0; CHANNELS], 1e-3, 8.0));
        let wanted_uv = 1000.0 * (1.0 - (-1.0_f64).exp());
        assert!((whole.state_uv[0] - wanted_uv).abs() < 1e-9);
        assert!((cut.state_uv[8] - wanted_uv).abs() < 1e-6);
        let added_uv = whole.added_uv(&Creep { time_s: 8.0, share: 0.01 });
        assert!((added_uv[4] - 0.01 * wanted_uv).abs() < 1e-9);
        whole.hold(&[0.0; CHANNELS], 1e9, 8.0);
        assert_eq!(whole, CreepState::default(), "all is forgotten in the end");
        assert_eq!(cut.added_uv(&NO_CREEP), [0.0; CHANNELS]);
    }
}
