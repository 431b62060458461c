//! Contacts by the readings alone, and how the channels must be wired that they fit together.
//!
//! Nine channels against five unknowns leave four equations without any label. They hold for every contact, however its label is meant, and do
//! not where channels are exchanged or reversed. So the wiring is what makes the median of what the equations miss least.

use rayon::prelude::*;

use tactpad_core::pad::field::PadField;
use tactpad_core::pad::wiring::permutation::SignedPermutation;
use tactpad_core::pipeline::contact::inverse::Inverse;
use tactpad_core::pipeline::contact::uncertainty::{Estimate, Noise};
use tactpad_core::quantity::{CHANNELS, Strain};
use tactpad_numeric::statistics::{median, rms};

/// Pads of a kind differ from the nominal one by this share of a reading, and by this much of the readings' size.
const SHARE: f64 = 0.15;
const ADDITIVE: f64 = 0.04;
/// Readings are brought to this size: in which unit they are is a question for later.
const SIZE_UV: f64 = 300.0;
/// Contacts whose readings are a smaller part than this of the median ones tell nothing.
const LIGHT: f64 = 0.25;
/// Contacts by which the wiring is judged.
const ROWS_OF_WIRING: usize = 120;
/// What the four equations miss, by the deviations above: with less than this nobody looks for a mistake in the wiring …
const PERFECT: f64 = 3.0;
/// … and no pad whose wiring is known misses more.
const SOUND: f64 = 14.0;
/// A mistake is taken to be there if mending it divides what is missed by this.
const BETTER_BY: f64 = 2.0;
/// No more mistakes in the wiring are looked for.
const MISTAKES_MAX: usize = 6;

/// A contact as the readings alone tell it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DecodedContact {
    pub(crate) place_mm: [f64; 2],
    pub(crate) force_n: [f64; 3],
    /// What the four equations miss.
    pub(crate) missed: f64,
}

impl DecodedContact {
    /// x, y, Fx, Fy, Fz.
    pub(crate) const fn numbers(&self) -> [f64; 5] {
        let ([x_mm, y_mm], [fx_n, fy_n, fz_n]) = (self.place_mm, self.force_n);
        [x_mm, y_mm, fx_n, fy_n, fz_n]
    }

    /// The magnitude of the force.
    pub(crate) fn resultant_n(&self) -> f64 {
        let [fx_n, fy_n, fz_n] = self.force_n;
        libm::hypot(libm::hypot(fx_n, fy_n), fz_n)
    }
}

/// Decodes readings by the nominal field.
pub(crate) struct Decoding {
    inverse: Inverse,
    /// By what the readings are multiplied before.
    scale: f64,
}

impl Decoding {
    /// For readings of this size; `None` where they are none.
    pub(crate) fn new(field: &PadField, readings: &[[f64; CHANNELS]]) -> Option<Self> {
        let size = median(readings.iter().map(|uv| rms(uv.iter().copied())))?;
        let noise = Noise::of_channels([ADDITIVE * SIZE_UV; CHANNELS], [SHARE; CHANNELS]);
        (size > 0.0 && size.is_finite())
            .then(|| Self { inverse: Inverse::new(field.signals.clone(), noise), scale: SIZE_UV / size })
    }

    /// Whether readings are of a contact that is strong enough to tell anything.
    pub(crate) fn is_loaded(&self, readings: &[f64; CHANNELS]) -> bool {
        self.scale * rms(readings.iter().copied()) > LIGHT * SIZE_UV
    }

    /// What the four equations miss at most where one finger touches, of contacts that miss so much.
    pub(crate) fn sound(missed: impl Iterator<Item = f64>) -> f64 {
        median(missed).map_or(SOUND, |middle| SOUND.max(BETTER_BY * middle))
    }

    fn strain(&self, channels: &[f64; CHANNELS]) -> Strain {
        Strain { uv: channels.map(|uv| (self.scale * uv) as f32) }
    }

    /// The contact of the pad's channels.
    pub(crate) fn contact(&self, channels: &[f64; CHANNELS]) -> Option<DecodedContact> {
        let Estimate { contact, misfit, .. } = self.inverse.estimate(&self.strain(channels))?;
        Some(DecodedContact {
            place_mm: [contact.x_mm, contact.y_mm].map(f64::from),
            force_n: [contact.fx_n, contact.fy_n, contact.fz_n].map(|n| f64::from(n) / self.scale),
            missed: misfit,
        })
    }

    /// The median of what the four equations miss.
    fn missed(&self, wiring: &SignedPermutation, readings: &[[f64; CHANNELS]]) -> f64 {
        let missed = |readings: &[f64; CHANNELS]| {
            self.inverse.estimate(&self.strain(&wiring.of(readings))).map_or(f64::INFINITY, |it| it.misfit)
        };
        median(readings.iter().map(missed)).unwrap_or(f64::INFINITY)
    }

    /// The wiring that makes the contacts' channels fit together; `None` where none does.
    pub(crate) fn wiring(&self, readings: &[[f64; CHANNELS]]) -> Option<SignedPermutation> {
        let count = readings.len().min(ROWS_OF_WIRING);
        let some: Vec<[f64; CHANNELS]> = (0..count).map(|at| readings[at * readings.len() / count]).collect();
        let mut best = SignedPermutation::IDENTITY;
        let mut missed = self.missed(&best, &some);
        let mistakes = SignedPermutation::single_mistakes();
        for _ in 0..MISTAKES_MAX {
            if missed <= PERFECT {
                break;
            }
            let tried = mistakes.par_iter().map(|mistake| {
                let next = mistake.after(&best);
                (self.missed(&next, &some), next)
            });
            let tried: Vec<(f64, SignedPermutation)> = tried.collect();
            let next = tried.into_iter().min_by(|one, other| one.0.total_cmp(&other.0))?;
            if next.0 * BETTER_BY > missed {
                break;
            }
            (missed, best) = next;
        }
        (missed <= BETTER_BY * SOUND).then_some(best)
    }
}
