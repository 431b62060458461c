//! A load that rests on the pad: means of a tenth of a second, until enough of them agree.

use arrayvec::ArrayVec;

use crate::pipeline::contact::Decoder;
use crate::quantity::{CHANNELS, Contact, Strain};
use crate::time::StreamInstant;

/// Window of the mean: whole periods of 50 and of 60 Hz mains.
const MEAN_US: u64 = 100_000;

/// So many means in a row agree if a load rests, 1.8 s: a weight that is left alone for two seconds has them, whenever they
/// begin.
pub const MEANS: usize = 18;

/// A mean agrees with those before it if its force differs by no more than the larger of these,
const FORCE_SHARE: f64 = 0.02;
const FORCE_N: f64 = 0.03;
/// and its place by no more than this. A finger that presses as evenly as it can does not come near to it for so long.
const PLACE_MM: f64 = 1.0;

/// Nothing is known of a gap: what came before it does not count.
const GAP_US: u64 = 50_000;

/// A mean of readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanReading {
    /// The channels, as a decoder takes them.
    pub strain: Strain,
    /// What it makes of them.
    pub contact: Contact,
}

impl MeanReading {
    /// Decoded contact of these channels.
    pub fn of(strain: Strain, decoder: &Decoder) -> Self {
        Self { strain, contact: decoder.decode(&strain) }
    }
}

/// A load that has rested for long enough.
pub type SettledLoad = ArrayVec<MeanReading, MEANS>;

/// Waits for a load to rest, sample by sample.
#[derive(Clone, Debug, Default)]
pub struct SettlingDetector {
    begins: StreamInstant,
    last_at: StreamInstant,
    sum_uv: [f64; CHANNELS],
    samples: u32,
    agreed: SettledLoad,
}

impl SettlingDetector {
    /// Whether a load is there that rests so far.
    pub fn is_begun(&self) -> bool {
        self.agreed.len() > 1
    }

    /// Nothing lies on the pad, or nothing that can be believed.
    pub fn break_off(&mut self) {
        self.samples = 0;
        self.agreed.clear();
    }

    /// Takes the sample at `at` of a touched pad. The load, once it has rested for long enough; then it begins anew.
    pub fn push(&mut self, at: StreamInstant, strain: &Strain, decoder: &Decoder) -> Option<SettledLoad> {
        if at.us_since(self.last_at) > GAP_US {
            self.break_off();
        }
        self.last_at = at;
        let rested =
            if self.samples > 0 && at.us_since(self.begins) >= MEAN_US { self.close(decoder) } else { None };
        if self.samples == 0 {
            (self.begins, self.sum_uv) = (at, [0.0; CHANNELS]);
        }
        self.samples += 1;
        self.sum_uv.iter_mut().zip(strain.uv).for_each(|(sum, uv)| *sum += f64::from(uv));
        rested
    }

    fn close(&mut self, decoder: &Decoder) -> Option<SettledLoad> {
        let samples = f64::from(std::mem::take(&mut self.samples));
        let reading = MeanReading::of(Strain { uv: self.sum_uv.map(|sum| (sum / samples) as f32) }, decoder);
        if !agrees(&self.agreed, &reading.contact) {
            self.agreed.clear();
        }
        self.agreed.push(reading);
        self.agreed.is_full().then(|| std::mem::take(&mut self.agreed))
    }
}

/// Whether a contact is the one that was there before, at rest.
fn agrees(before: &[MeanReading], contact: &Contact) -> bool {
    let count = before.len().max(1) as f64;
    let mean =
        |of: fn(&Contact) -> f32| before.iter().map(|it| f64::from(of(&it.contact))).sum::<f64>() / count;
    let [x_mm, y_mm, fz_n] = [mean(|it| it.x_mm), mean(|it| it.y_mm), mean(|it| it.fz_n)];
    let off_mm = libm::hypot(f64::from(contact.x_mm) - x_mm, f64::from(contact.y_mm) - y_mm);
    let off_n = (f64::from(contact.fz_n) - fz_n).abs();
    off_mm <= PLACE_MM && off_n <= FORCE_N.max(FORCE_SHARE * fz_n)
}
