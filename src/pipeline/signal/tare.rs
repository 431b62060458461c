//! The zero of the nine channels: measured when the pad lies still, then followed slowly while nothing touches it.

use crate::quantity::CHANNELS;
use crate::time::StreamInstant;

/// The zero is the mean over this many blocks that agree; together with half a block of waiting under 0.5 s.
const BLOCKS: usize = 3;

/// Length of a block of stream time: five periods of 50 Hz mains, six of 60 Hz.
const BLOCK_US: u64 = 100_000;

/// Blocks of a pad at rest agree within this; a finger of 0.03 N that comes or goes does not.
const REST_UV: f64 = 40.0;

/// While idle the zero follows with this time constant. Long, so that a press that grows at 0.01 N/s is still seen
/// as a press; short against warming up, which drifts by about 30 µV per kelvin (Sensors 2026, 26, 1378, Figure 8).
const FOLLOW_S: f64 = 20.0;

/// Where the zero was taken of a pad whose hysteresis was not known, and now it is known, the zero is found within about
/// this time instead. Long against a period of the mains.
const SETTLE_S: f64 = 0.3;

/// A zero that is known as well as this is settled: less than a tenth of a pad's noise.
const SETTLED_UV: f64 = 1.0;

/// A gap in the stream counts as no longer than this: the period of the slowest pad.
const FOLLOW_GAP_MAX_US: u64 = 10_000;

/// What the untouched pad reads beside its zero: what earlier presses left behind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// For each channel, as far as it is known.
    pub uv: [f64; CHANNELS],
    /// How far off that may be.
    pub doubt_uv: [f64; CHANNELS],
}

impl Rest {
    /// Of a pad that remembers nothing.
    pub const NONE: Self = Self { uv: [0.0; CHANNELS], doubt_uv: [0.0; CHANNELS] };
}

/// The zero of the pad, once known.
#[derive(Clone, Debug)]
pub struct Tare {
    zero_uv: Option<[f64; CHANNELS]>,
    /// How far off the zero may be, as the rest was not known.
    doubt_uv: [f64; CHANNELS],
    followed_at: StreamInstant,
    block_began: Option<StreamInstant>,
    block_sums: [f64; CHANNELS],
    block_samples: u32,
    block_means: [Option<[f64; CHANNELS]>; BLOCKS],
}

impl Default for Tare {
    fn default() -> Self {
        Self::new()
    }
}

impl Tare {
    /// No zero yet.
    pub const fn new() -> Self {
        Self {
            zero_uv: None,
            doubt_uv: [0.0; CHANNELS],
            followed_at: StreamInstant::from_us(0),
            block_began: None,
            block_sums: [0.0; CHANNELS],
            block_samples: 0,
            block_means: [None; BLOCKS],
        }
    }

    /// Whether the zero has been measured.
    pub const fn is_known(&self) -> bool {
        self.zero_uv.is_some()
    }

    /// Takes a raw sample (µV) towards the first zero. Samples until the pad has lain still for three blocks. True if
    /// the blocks so far show that it did not.
    pub fn measure(&mut self, at: StreamInstant, raw_uv: &[f64; CHANNELS], rest: &Rest) -> bool {
        let began = *self.block_began.get_or_insert(at);
        for (sum, raw) in self.block_sums.iter_mut().zip(raw_uv) {
            *sum += raw;
        }
        self.block_samples += 1;
        let closes = at.us_since(began) >= BLOCK_US;
        if closes {
            self.close_block(at, rest);
        }
        closes && self.zero_uv.is_none() && self.block_means.iter().all(Option::is_some)
    }

    /// Raw microvolts relative to the zero. Follows the zero if nothing touches the pad, which then reads `rest`.
    pub fn apply(
        &mut self,
        at: StreamInstant,
        raw_uv: &[f64; CHANNELS],
        touched: bool,
        rest: &Rest,
    ) -> [f32; CHANNELS] {
        // Nothing is known of a gap: a finger may have come meanwhile.
        let elapsed_s = at.us_since(self.followed_at).min(FOLLOW_GAP_MAX_US) as f64 * 1e-6;
        self.followed_at = at;
        if !touched {
            self.follow(elapsed_s, raw_uv, rest);
        }
        let zero_uv = self.zero_uv.unwrap_or(*raw_uv);
        std::array::from_fn(|k| (raw_uv[k] - zero_uv[k]) as f32)
    }

    fn follow(&mut self, elapsed_s: f64, raw_uv: &[f64; CHANNELS], rest: &Rest) {
        // z ← z + (Δt / τ) (r − rest − z), and the doubt of z goes to that of the rest as fast.
        let Some(zero_uv) = &mut self.zero_uv else { return };
        for (k, (zero, doubt)) in zero_uv.iter_mut().zip(&mut self.doubt_uv).enumerate() {
            let is_settled = *doubt - rest.doubt_uv[k] < SETTLED_UV;
            let share = (elapsed_s / if is_settled { FOLLOW_S } else { SETTLE_S }).min(1.0);
            *zero += (raw_uv[k] - rest.uv[k] - *zero) * share;
            *doubt += (rest.doubt_uv[k] - *doubt) * share;
        }
    }

    fn close_block(&mut self, at: StreamInstant, rest: &Rest) {
        let samples = f64::from(self.block_samples);
        self.block_means.rotate_left(1);
        if let Some(newest) = self.block_means.last_mut() {
            *newest = Some(self.block_sums.map(|sum| sum / samples));
        }
        self.block_sums = [0.0; CHANNELS];
        self.block_samples = 0;
        self.block_began = Some(at);
        self.zero_uv = rest_mean(&self.block_means).map(|mean| std::array::from_fn(|k| mean[k] - rest.uv[k]));
        self.doubt_uv = rest.doubt_uv;
        self.followed_at = at;
    }
}

/// The mean of the blocks if all are there and every channel agrees within [`REST_UV`].
fn rest_mean(blocks: &[Option<[f64; CHANNELS]>; BLOCKS]) -> Option<[f64; CHANNELS]> {
    let mut mean_uv = [0.0; CHANNELS];
    for (k, mean) in mean_uv.iter_mut().enumerate() {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for block in blocks {
            let value = *block.as_ref()?.get(k)?;
            (low, high) = (low.min(value), high.max(value));
            *mean += value / BLOCKS as f64;
        }
        if high - low > REST_UV {
            return None;
        }
    }
    Some(mean_uv)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Feeds `raw_uv(t_ms)` in all channels every millisecond; the time at which the zero was known, in ms.
    fn known_at_ms(tare: &mut Tare, raw_uv: impl Fn(u64) -> f64) -> Option<u64> {
        (0..5_000).find(|&ms| {
            tare.measure(StreamInstant::from_us(ms * 1_000), &[raw_uv(ms); CHANNELS], &Rest::NONE);
            tare.is_known()
        })
    }

    #[test]
    fn a_pad_at_rest_is_tared_within_half_a_second() {
        let mut tare = Tare::new();
        assert!(
            known_at_ms(&mut tare, |ms| 1_500.0 + if ms % 2 == 0 { 30.0 } else { -30.0 }).unwrap() <= 400
        );
        let strain_uv = tare.apply(StreamInstant::from_us(500_000), &[1_600.0; CHANNELS], true, &Rest::NONE);
        assert!(strain_uv.iter().all(|uv| (uv - 100.0).abs() < 1.0));
    }

    #[test]
    fn a_finger_that_comes_keeps_the_zero_unknown_until_it_lies_still() {
        let ramp = |ms: u64| if ms < 2_000 { 400.0 * ms as f64 * 1e-3 } else { 0.0 };
        let known_at_ms = known_at_ms(&mut Tare::new(), ramp).unwrap();
        assert!((2_300..2_500).contains(&known_at_ms), "{known_at_ms} ms");
    }

    #[test]
    fn the_zero_follows_drift_while_idle_and_stands_still_under_a_finger() {
        for (touched, expected_uv) in [(false, 36.8), (true, 100.0)] {
            let mut tare = Tare::new();
            known_at_ms(&mut tare, |_| 0.0);
            let strain_uv = (0..20_000).map(|ms| {
                tare.apply(
                    StreamInstant::from_us(500_000 + ms * 1_000),
                    &[100.0; CHANNELS],
                    touched,
                    &Rest::NONE,
                )[0]
            });
            let last_uv = strain_uv.last().unwrap();
            assert!((last_uv - expected_uv).abs() < 2.0, "{last_uv} µV is not {expected_uv} µV");
        }
    }

    #[test]
    fn a_load_that_came_during_a_gap_is_no_drift() {
        let mut tare = Tare::new();
        known_at_ms(&mut tare, |_| 0.0);
        let strain_uv =
            tare.apply(StreamInstant::from_us(60_000_000), &[1_000.0; CHANNELS], false, &Rest::NONE);
        assert!(strain_uv[0] > 999.0, "{} µV", strain_uv[0]);
    }

    #[test]
    fn a_slow_pad_is_tared_too() {
        let mut tare = Tare::new();
        let known = (0..50).find(|&i| {
            tare.measure(StreamInstant::from_us(i * 10_000), &[7.0; CHANNELS], &Rest::NONE);
            tare.is_known()
        });
        assert!(known.unwrap() * 10 <= 500);
    }

    #[test]
    fn what_is_left_behind_is_not_taken_for_the_zero_and_what_was_is_mended_soon() {
        let rest = |uv, doubt_uv| Rest { uv: [uv; CHANNELS], doubt_uv: [doubt_uv; CHANNELS] };
        let mut tare = Tare::new();
        // A pad with 30 µV of hysteresis, of which nothing is known yet.
        for ms in 0..500 {
            tare.measure(StreamInstant::from_us(ms * 1_000), &[130.0; CHANNELS], &rest(0.0, 50.0));
        }
        let mut reads_uv = |ms: std::ops::Range<u64>, rest: Rest| {
            let mut uv = 0.0;
            for ms in ms {
                uv = tare.apply(StreamInstant::from_us(ms * 1_000), &[130.0; CHANNELS], false, &rest)[4];
            }
            uv
        };
        assert!(reads_uv(500..1_500, rest(0.0, 50.0)).abs() < 1e-3, "nothing new");
        assert!((reads_uv(1_500..3_000, rest(30.0, 0.0)) - 30.0).abs() < 1.0, "now it is known");
        assert!((reads_uv(3_000..20_000, rest(30.0, 0.0)) - 30.0).abs() < 1.0, "and stays");
    }
}
