//! The pad's temperature in play, and what it does to the channels.
//!
//! The zero that was taken holds whatever the temperature was then; only how the temperature changes counts. So changes are
//! followed, not readings, and a reading that cannot be a change is not followed: no thermometer that fails, comes back or
//! was never there moves the zero. Gains need the temperature itself; while a finger is on the pad they follow changes, too.
//!
//! Readings are smoothed. A step of 0.01 °C is half a microvolt, but thermometers on boards resolve 0.06 °C and scatter as
//! much; that is a few microvolts in all channels at once, which no filter of the channels takes for noise. A pad takes many
//! seconds to change by a degree, so a second costs nothing.

use firmware_proto::sample::Sample;

use super::memory::SILENCE_US;
use super::thermal::{SENSIBLE_C, Thermal};
use crate::quantity::{CHANNELS, Strain};
use crate::time::StreamInstant;

/// Readings are smoothed with this time constant.
const SMOOTH_S: f64 = 1.0;

/// No pad warms or cools faster; a hand brings it some tenths of a degree in a second at most.
const FASTEST_C_PER_S: f64 = 1.0;

/// Readings that stay away for so long do not come back: from there on their changes are followed.
const AWAY_US: u64 = 1_000_000;

/// After a silence readings that agree for so long are taken: contacts are not believed before 50 ms anyway.
const AWAKE_US: u64 = 40_000;

/// Of an untouched pad the zero follows its readings. After so long without a temperature it has done so without us.
const ZERO_FOLLOWS_US: u64 = 3_000_000;

/// Followed sample by sample.
#[derive(Clone, Copy, Debug)]
pub struct Thermometer {
    /// `None` for a decoder that does not know how its pad follows the temperature: nothing is done then.
    thermal: Option<Thermal>,
    /// `None` before the first sensible reading.
    smooth_c: Option<f64>,
    /// Change of temperature followed since the beginning, °C.
    followed_c: f64,
    /// The temperature of the gains; `None` before the pad lay untouched with a known one.
    gains_at_c: Option<f64>,
    at: StreamInstant,
    /// When a reading was last taken, and what has passed since then: without samples, and untouched.
    near_at: StreamInstant,
    silent_us: u64,
    untold_us: u64,
    /// Readings far from what is followed, and since when.
    away: Option<(f64, StreamInstant)>,
}

impl Thermometer {
    /// Of a pad that has told nothing yet.
    pub const fn of(thermal: Option<Thermal>) -> Self {
        let start = StreamInstant::from_us(0);
        Self {
            thermal,
            smooth_c: None,
            followed_c: 0.0,
            gains_at_c: None,
            at: start,
            near_at: start,
            silent_us: 0,
            untold_us: 0,
            away: None,
        }
    }

    /// Takes the temperature of the sample at `at`, if it tells one. `touched` says whether a contact is under way.
    pub fn follow(&mut self, at: StreamInstant, sample: &Sample, touched: bool) {
        if self.thermal.is_none() {
            return;
        }
        let passed_us = at.us_since(self.at);
        self.at = at;
        // In a silence the zero does not follow anything either, so a change over it counts whole.
        if passed_us > SILENCE_US {
            self.silent_us += passed_us;
        } else if !touched {
            self.untold_us += passed_us;
        }
        if let Some(read_c) = reading_c(sample) {
            self.take(read_c);
        }
        if !touched {
            self.gains_at_c = self.smooth_c;
        }
    }

    fn take(&mut self, read_c: f64) {
        // T is read, ϑ smoothed with the time constant τ, Δt has passed since a reading was last taken:
        //   ϑ ← ϑ + min(Δt / τ, 1) (T − ϑ)
        // and what ϑ changes by is followed. What cannot be a change, or was followed by the zero, moves ϑ to T at once and is
        // not followed; a large change over a silence is followed at once.
        let smooth_c = *self.smooth_c.get_or_insert(read_c);
        let apart_c = read_c - smooth_c;
        let is_near = apart_c.abs() <= FASTEST_C_PER_S * SMOOTH_S;
        if !is_near && !self.stays(read_c) {
            return;
        }
        let elapsed_s = self.at.us_since(self.near_at) as f64 * 1e-6;
        let silent_s = self.silent_us as f64 * 1e-6;
        let can_be = is_near || (silent_s > 0.0 && apart_c.abs() <= FASTEST_C_PER_S * (SMOOTH_S + silent_s));
        let is_followed = can_be && self.untold_us < ZERO_FOLLOWS_US;
        let share = if is_near && is_followed { (elapsed_s / SMOOTH_S).min(1.0) } else { 1.0 };
        let step_c = share * apart_c;
        self.smooth_c = Some(if share < 1.0 { smooth_c + step_c } else { read_c });
        if is_followed {
            self.followed_c += step_c;
            self.gains_at_c = self.gains_at_c.map(|temp_c| temp_c + step_c);
        }
        (self.near_at, self.silent_us, self.untold_us, self.away) = (self.at, 0, 0, None);
    }

    /// Whether readings far away have been the same for long enough.
    fn stays(&mut self, read_c: f64) -> bool {
        match self.away {
            Some((away_c, since)) if (read_c - away_c).abs() <= FASTEST_C_PER_S * SMOOTH_S => {
                self.at.us_since(since) >= if self.silent_us > 0 { AWAKE_US } else { AWAY_US }
            }
            _ => {
                self.away = Some((read_c, self.at));
                false
            }
        }
    }

    /// Shift of the channels by the change of temperature since the beginning, µV.
    pub fn added_uv(&self) -> [f64; CHANNELS] {
        // β Σ Δϑ
        self.thermal.map_or([0.0; CHANNELS], |thermal| {
            thermal.zero_uv_per_c.map(|uv_per_c| uv_per_c * self.followed_c)
        })
    }

    /// Channels beyond their zero as at the decoder's temperature, µV.
    pub fn at_reference(&self, strain: &Strain) -> Strain {
        let Some(thermal) = &self.thermal else { return *strain };
        // s = s(T) / (1 + γ (T − T₀))
        let gain = thermal.gain(self.gains_at_c);
        Strain { uv: std::array::from_fn(|k| (f64::from(strain.uv[k]) / gain[k]) as f32) }
    }
}

/// `None` if the pad does not know, or tells what cannot be: then the thermometer is at fault.
fn reading_c(sample: &Sample) -> Option<f64> {
    let read_c = f64::from(sample.temperature_centi_c) * 1e-2;
    (!sample.status.temperature_invalid() && SENSIBLE_C.contains(&read_c)).then_some(read_c)
}

#[cfg(test)]
mod tests {
    use firmware_proto::sample::Status;

    use super::*;

    const THERMAL: Thermal =
        Thermal { reference_c: 25.0, zero_uv_per_c: [60.0; CHANNELS], gain_per_c: [1e-3; CHANNELS] };

    /// A thermometer in time.
    struct Played {
        thermometer: Thermometer,
        at: StreamInstant,
    }

    impl Played {
        fn new() -> Self {
            Self { thermometer: Thermometer::of(Some(THERMAL)), at: StreamInstant::from_us(0) }
        }

        /// For so many milliseconds it reads `temp_c(ms)`, unless that is none. What is added then, in degrees.
        fn reads(&mut self, ms: u64, touched: bool, temp_c: impl Fn(u64) -> Option<f64>) -> f64 {
            for ms in 0..ms {
                self.at = self.at.plus_us(1_000);
                self.thermometer.follow(self.at, &sample(temp_c(ms)), touched);
            }
            self.thermometer.added_uv()[4] / 60.0
        }

        /// What a strain of 1 mV comes to, over that: one over the gain.
        fn strain(&self) -> f32 {
            self.thermometer.at_reference(&Strain { uv: [1000.0; CHANNELS] }).uv[4] / 1000.0
        }
    }

    fn sample(temp_c: Option<f64>) -> Sample {
        let status = if temp_c.is_some() { Status::OK } else { Status::OK.with_temperature_invalid() };
        // A pad that does not know may send anything.
        let temperature_centi_c = (100.0 * temp_c.unwrap_or(20.0)).round() as i16;
        Sample { sequence: 0, time_us: 0, counts: [0; CHANNELS], temperature_centi_c, status }
    }

    fn assert_near(found: f64, wanted: f64, allowed: f64) {
        assert!((found - wanted).abs() <= allowed, "{found} is not {wanted}");
    }

    #[test]
    fn changes_are_followed_with_a_second_of_delay_and_where_it_began_does_not_count() {
        for touched in [false, true] {
            let mut played = Played::new();
            assert_near(played.reads(500, touched, |_| Some(31.0)), 0.0, 0.0);
            let warming = |ms: u64| Some(31.0 + 0.25 * ms as f64 * 1e-3);
            assert_near(played.reads(20_000, touched, warming), 5.0 - 0.25, 0.01);
            assert_near(played.reads(8_000, touched, |_| Some(36.0)), 5.0, 0.01);
        }
    }

    #[test]
    fn gains_are_those_of_the_temperature_and_do_not_jump_under_a_finger() {
        let mut played = Played::new();
        played.reads(500, true, |_| Some(35.0));
        assert_eq!(played.strain(), 1.0, "the finger came before the temperature was known");
        played.reads(500, false, |_| Some(35.0));
        assert_near(f64::from(played.strain()), 1.0 / 1.01, 1e-6);
        played.reads(30_000, true, |_| Some(80.0));
        assert_near(f64::from(played.strain()), 1.0 / 1.01, 1e-6);
        played.reads(10_000, true, |_| Some(79.0));
        assert_near(f64::from(played.strain()), 1.0 / 1.009, 1e-6);
        played.reads(1, false, |_| Some(79.0));
        assert_near(f64::from(played.strain()), 1.0 / 1.054, 1e-6);
    }

    #[test]
    fn a_thermometer_that_fails_moves_nothing() {
        let nonsense = [Some(84.9), Some(0.0), Some(-39.9), Some(86.0), Some(-327.68), Some(327.67), None];
        for wrong_c in nonsense {
            let mut played = Played::new();
            played.reads(500, false, |_| Some(30.0));
            assert_near(played.reads(60_000, true, |_| wrong_c), 0.0, 0.0);
            assert_near(played.reads(60_000, true, |_| Some(30.0)), 0.0, 0.0);
            assert_near(played.reads(20_000, true, |_| Some(30.5)), 0.5, 0.01);
        }
    }

    #[test]
    fn single_readings_that_cannot_be_are_left_out() {
        let mut played = Played::new();
        let glitches = |ms: u64| Some(if ms % 100 == 99 { 85.0 } else { 30.0 + 0.1 * ms as f64 * 1e-3 });
        assert_near(played.reads(20_000, true, glitches), 2.0 - 0.1, 0.02);
    }

    #[test]
    fn a_temperature_that_is_known_late_begins_there() {
        let mut played = Played::new();
        assert_near(played.reads(10_000, false, |_| None), 0.0, 0.0);
        assert_eq!(played.strain(), 1.0);
        assert_near(played.reads(10_000, false, |_| Some(35.0)), 0.0, 0.0);
        assert_near(f64::from(played.strain()), 1.0 / 1.01, 1e-6);
    }

    #[test]
    fn what_changes_while_nothing_is_heard_counts_whole() {
        let mut played = Played::new();
        played.reads(500, false, |_| Some(35.0));
        played.at = played.at.plus_us(60_000_000);
        assert_near(played.reads(99, false, |_| None), 0.0, 0.0);
        assert_near(played.reads(40, false, |_| Some(20.0)), 0.0, 0.0);
        assert_near(played.reads(1, false, |_| Some(20.0)), -15.0, 1e-9);
    }

    #[test]
    fn a_thermometer_that_awakes_with_nonsense_moves_nothing() {
        let mut played = Played::new();
        played.reads(500, false, |_| Some(25.0));
        played.at = played.at.plus_us(60_000_000);
        assert_near(played.reads(40, false, |_| Some(0.0)), 0.0, 0.0);
        assert_near(played.reads(60_000, false, |_| Some(25.0)), 0.0, 0.0);
    }

    #[test]
    fn what_the_zero_has_followed_is_not_followed_again() {
        let mut played = Played::new();
        played.reads(500, false, |_| Some(30.0));
        assert_near(played.reads(60_000, false, |_| None), 0.0, 0.0);
        assert_near(played.reads(5_000, false, |_| Some(30.9)), 0.0, 0.0);
        assert_near(played.reads(10_000, false, |_| Some(31.4)), 0.5, 0.01);
        // Under a finger the zero stays, so a change that can be counts.
        assert_near(played.reads(60_000, true, |_| None), 0.5, 0.01);
        assert_near(played.reads(5_000, true, |_| Some(32.3)), 1.4, 0.01);
    }

    #[test]
    fn a_pad_that_seldom_reads_its_thermometer_is_followed_as_soon() {
        let mut played = Played::new();
        played.reads(500, true, |_| Some(30.0));
        let seldom = |ms: u64| (ms % 100 == 99).then_some(30.5);
        assert_near(played.reads(1_000, true, seldom), 0.5 * (1.0 - (-1.0_f64).exp()), 0.02);
    }

    #[test]
    fn steps_of_the_thermometer_are_smoothed() {
        let mut played = Played::new();
        played.reads(500, true, |_| Some(30.0));
        // Ten readings in a second; it cannot decide between two that are 1/16 °C apart.
        let undecided = |ms: u64| Some(30.0 + f64::from((ms / 100 % 2) as u8) / 16.0);
        let added_c: Vec<f64> = (0..100).map(|_| played.reads(200, true, undecided)).collect();
        let settled = &added_c[50..];
        assert!(settled.iter().all(|c| (c - 1.0 / 32.0).abs() < 0.003), "{settled:?}");
    }

    #[test]
    fn a_decoder_that_knows_no_temperature_gets_what_is_read() {
        let mut thermometer = Thermometer::of(None);
        for ms in 0..1_000 {
            thermometer.follow(
                StreamInstant::from_us(1_000 * ms),
                &sample(Some(20.0 + ms as f64 * 1e-3)),
                false,
            );
        }
        let strain = Strain { uv: [0.1; CHANNELS] };
        assert_eq!((thermometer.added_uv(), thermometer.at_reference(&strain)), ([0.0; CHANNELS], strain));
    }
}
