//! The zero of the nine channels: measured when the pad lies still, then followed slowly while nothing touches it.
//!
//! A finger may lie as still as the pad itself, and what the untouched pad reads is not known beforehand. But nothing can
//! pull at the plate: of two readings the lower load is nearer to the zero. So a press is never the zero once a lower load
//! has been seen, and a zero that turns out to be a load is measured anew.
//!
//! A board may be lifted, and a cap be pulled. A zero that was found after that holds when what came next has gone again; where that stands
//! as still as no finger does, it is the zero.

use super::lone::lone_channel;
use super::stillness::{STILL_UV, Stillness};
use crate::quantity::{CHANNELS, Strain};
use crate::time::StreamInstant;

/// Loads that differ by less may be the same.
const SAME_N: f32 = 0.10;

/// So many blocks in a row below the zero are no slip of a sample: what was taken for the zero was a load.
const PULL_BLOCKS: u32 = 2;

/// Beside a touch, as a finger comes or leaves, channels of different moments can look so for as long as its way down or up takes:
/// it takes so many.
const PULL_BLOCKS_TOUCHED: u32 = 5;

/// So many blocks in a row with a channel that reads alone are no slip of a sample either.
const LONE_BLOCKS: u32 = 2;

/// A channel that reads less by itself does not matter: a finger on its module would not yet be a touch.
const LONE_UV: f64 = 250.0;

/// The lowest reading counts so long, unless the pad reads it again: a pad that jumps once when it is switched on must be
/// tared some time.
const FLOOR_US: u64 = 5_000_000;

/// The same where something can pull.
const FLOOR_PULLED_US: u64 = 1_000_000;

/// What stands still for so long after the zero was in doubt is no finger, where something can pull.
const STANDS_US: u64 = 3_000_000;

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

/// Offset of the untouched pad beside its zero, µV: the rest of earlier presses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UntouchedOffset {
    /// For each channel, as far as it is known.
    pub uv: [f64; CHANNELS],
    /// How far off that may be.
    pub doubt_uv: [f64; CHANNELS],
}

impl UntouchedOffset {
    /// Of a pad that remembers nothing.
    pub const NONE: Self = Self { uv: [0.0; CHANNELS], doubt_uv: [0.0; CHANNELS] };
}

/// State of the pad before a sample comes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PadState {
    /// Whether a contact is under way: the zero is followed only while not.
    pub touched: bool,
    /// Whether that is believed against a load below none: by decoders that do not explain what the channels read.
    pub is_touch_believed: bool,
    /// What the pad reads while not.
    pub rest: UntouchedOffset,
    /// Offset of the channels at any time, µV: it is subtracted first.
    pub added_uv: [f64; CHANNELS],
}

/// Normal forces of a difference of readings, N.
#[derive(Clone, Copy, Debug)]
pub struct Loads<P, W> {
    /// By all channels.
    pub plain_n: P,
    /// Where one channel may have moved by itself.
    pub without_stray_n: W,
}

/// The reading of the lowest load that was seen since the zero is being measured. Nothing can pull at the plate, so the untouched
/// pad is there or lower.
#[derive(Clone, Copy, Debug)]
struct Floor {
    uv: [f64; CHANNELS],
    /// When as little load was read last.
    at: StreamInstant,
}

/// The zero of the pad, once known.
#[derive(Clone, Debug)]
pub struct Tare {
    zero_uv: Option<[f64; CHANNELS]>,
    /// How far off the zero may be, as the rest was not known.
    doubt_uv: [f64; CHANNELS],
    followed_at: StreamInstant,
    stillness: Stillness,
    /// The newest block since the zero is being measured.
    block_uv: Option<[f64; CHANNELS]>,
    floor: Option<Floor>,
    loaded: bool,
    /// Blocks in a row below the zero.
    pulls: u32,
    /// Blocks in a row in which a channel reads alone.
    lones: u32,
    /// Whether something can pull at what is pressed.
    can_be_pulled: bool,
    provisional: Option<ProvisionalZero>,
}

/// A zero that was found after another one turned out to be a load.
#[derive(Clone, Copy, Debug, Default)]
struct ProvisionalZero {
    was_touched: bool,
    /// Since when what touches stands still.
    still_since: Option<StreamInstant>,
}

impl Default for Tare {
    fn default() -> Self {
        Self::new(false)
    }
}

impl Tare {
    /// No zero yet of a pad at which something can pull, or not.
    pub const fn new(can_be_pulled: bool) -> Self {
        Self {
            can_be_pulled,
            provisional: None,
            zero_uv: None,
            doubt_uv: [0.0; CHANNELS],
            followed_at: StreamInstant::from_us(0),
            stillness: Stillness::new(),
            block_uv: None,
            floor: None,
            loaded: false,
            pulls: 0,
            lones: 0,
        }
    }

    /// Whether the zero has been measured.
    pub const fn is_known(&self) -> bool {
        self.zero_uv.is_some()
    }

    /// Whether something lies on the pad, so that its zero cannot be measured.
    pub const fn is_loaded(&self) -> bool {
        self.loaded
    }

    /// The zero turned out to be a load. It is measured anew.
    pub const fn doubt(&mut self) {
        if self.zero_uv.take().is_some() {
            (self.block_uv, self.floor) = (None, None);
        }
        (self.loaded, self.pulls) = (true, 0);
        self.provisional = if self.can_be_pulled {
            Some(ProvisionalZero { was_touched: false, still_since: None })
        } else {
            None
        };
    }

    /// Whether what touches the pad stands still since long, and nothing has come and gone since the zero was in doubt: then it was measured
    /// while something pulled.
    pub fn stands(&mut self, at: StreamInstant, touched: bool) -> bool {
        let is_still = self.stillness.mean_uv().is_some();
        let Some(provisional) = &mut self.provisional else { return false };
        if !touched {
            self.provisional = if provisional.was_touched { None } else { Some(ProvisionalZero::default()) };
            return false;
        }
        provisional.was_touched = true;
        provisional.still_since = if is_still { provisional.still_since.or(Some(at)) } else { None };
        provisional.still_since.is_some_and(|since| at.us_since(since) > STANDS_US)
    }

    /// Takes a raw sample (µV), with or without a zero: whether the pad lies still is watched all the time. The mean of the
    /// block of samples that it closes, if it closes one.
    pub fn watch(&mut self, at: StreamInstant, raw_uv: &[f64; CHANNELS]) -> Option<[f64; CHANNELS]> {
        self.stillness.push(at, raw_uv)
    }

    /// The channel that reads alone in the blocks up to this one. That is no load, so it is this channel's zero from now on. Where the others
    /// read something beside it, the zero may be a load that it hid, and is measured anew.
    pub fn lone(&mut self, block_uv: &[f64; CHANNELS], rest: &UntouchedOffset) -> Option<usize> {
        let zero_uv = self.zero_uv.as_mut()?;
        let read_uv = std::array::from_fn(|k| block_uv[k] - zero_uv[k] - rest.uv[k]);
        let lone = lone_channel(&read_uv).filter(|channel| read_uv[*channel].abs() > LONE_UV);
        self.lones = if lone.is_some() { self.lones + 1 } else { 0 };
        let channel = lone.filter(|_| self.lones >= LONE_BLOCKS)?;
        self.lones = 0;
        if (0..CHANNELS).any(|k| k != channel && read_uv[k].abs() > LONE_UV) {
            (self.zero_uv, self.block_uv, self.floor) = (None, None, None);
        } else {
            zero_uv[channel] += read_uv[channel];
        }
        Some(channel)
    }

    /// Whether the blocks up to this one show that the zero was a load: nothing can pull at the plate. One with a touch that is
    /// believed does not.
    pub fn is_pulled(
        &mut self,
        block_uv: &[f64; CHANNELS],
        pad: &PadState,
        loads: &Loads<impl Fn(&Strain) -> f32, impl Fn(&Strain) -> f32>,
    ) -> bool {
        let PadState { touched, is_touch_believed, rest, .. } = pad;
        let Some(zero_uv) = &self.zero_uv else { return false };
        let strain = relative(block_uv, &std::array::from_fn(|k| zero_uv[k] + rest.uv[k]));
        // At rest nothing needs to be decoded.
        let stands = strain.uv.iter().all(|uv| f64::from(uv.abs()) <= STILL_UV);
        let is_sound = stands || *touched && *is_touch_believed;
        // By all channels a touch is a load; what the others say against it is asked only then, as on a pad that is not quite as it
        // was calibrated some channel is always the oddest.
        let is_below = |load_n: f32| load_n < -SAME_N;
        // Where nothing touches, neither: but for what stands still beside a channel that may have stood when the zero was measured.
        let is_far = strain.uv.iter().any(|uv| f64::from(uv.abs()) > LONE_UV);
        let is_asked = *touched || is_far && self.stillness.mean_uv().is_some();
        let is_below = !is_sound
            && (!*touched && is_below((loads.plain_n)(&strain))
                || is_asked && is_below((loads.without_stray_n)(&strain)));
        self.pulls = if is_below { self.pulls + 1 } else { 0 };
        self.pulls >= if *touched { PULL_BLOCKS_TOUCHED } else { PULL_BLOCKS }
    }

    /// Measures the zero when a block closes: the pad must lie still, at the lowest load that was seen. `load_n` is the
    /// normal force of a difference of readings. True if the pad moved in this block.
    pub fn measure(
        &mut self,
        at: StreamInstant,
        block_uv: &[f64; CHANNELS],
        rest: &UntouchedOffset,
        load_n: impl Fn(&Strain) -> f32,
    ) -> bool {
        let floor_uv = self.lower_floor(at, block_uv, &load_n);
        let is_lowest =
            |uv: &[f64; CHANNELS]| floor_uv.is_some_and(|floor| load_n(&relative(uv, &floor)) <= SAME_N);
        if let Some(mean_uv) = self.stillness.mean_uv().filter(|mean_uv| is_lowest(mean_uv)) {
            self.zero_uv = Some(std::array::from_fn(|k| mean_uv[k] - rest.uv[k]));
            self.doubt_uv = rest.doubt_uv;
            self.followed_at = at;
            (self.block_uv, self.floor, self.loaded) = (None, None, false);
        } else if self.stillness.is_full() && !is_lowest(block_uv) {
            // What does not lie still, but as low as ever, may be the pad itself, after a frame of another time.
            self.loaded = true;
        }
        self.stillness.has_just_moved()
    }

    /// Takes a block's load into account; the reading of the lowest that two blocks in a row show: one alone may be a slip of a
    /// sample.
    fn lower_floor(
        &mut self,
        at: StreamInstant,
        block_uv: &[f64; CHANNELS],
        load_n: impl Fn(&Strain) -> f32,
    ) -> Option<[f64; CHANNELS]> {
        let before_uv = self.block_uv.replace(*block_uv)?;
        let block_uv = if load_n(&relative(block_uv, &before_uv)) < 0.0 { &before_uv } else { block_uv };
        let block = Floor { uv: *block_uv, at };
        let floor_us = if self.can_be_pulled { FLOOR_PULLED_US } else { FLOOR_US };
        let standing = self.floor.filter(|floor| at.us_since(floor.at) <= floor_us);
        let floor = standing.map_or(block, |floor| match load_n(&relative(block_uv, &floor.uv)) {
            above_n if above_n > SAME_N => floor,
            above_n if above_n >= 0.0 => Floor { at, ..floor },
            _ => block,
        });
        self.floor = Some(floor);
        Some(floor.uv)
    }

    /// Raw microvolts relative to the zero. Follows the zero if nothing touches the pad, which then reads `rest`.
    pub fn apply(
        &mut self,
        at: StreamInstant,
        raw_uv: &[f64; CHANNELS],
        touched: bool,
        rest: &UntouchedOffset,
    ) -> Strain {
        // Nothing is known of a gap: a finger may have come meanwhile.
        let elapsed_s = at.us_since(self.followed_at).min(FOLLOW_GAP_MAX_US) as f64 * 1e-6;
        self.followed_at = at;
        if !touched {
            self.follow(elapsed_s, raw_uv, rest);
        }
        relative(raw_uv, &self.zero_uv.unwrap_or(*raw_uv))
    }

    fn follow(&mut self, elapsed_s: f64, raw_uv: &[f64; CHANNELS], rest: &UntouchedOffset) {
        // z ← z + (Δt / τ) (r − rest − z), and the doubt of z goes to that of the rest as fast.
        let Some(zero_uv) = &mut self.zero_uv else { return };
        for (k, (zero, doubt)) in zero_uv.iter_mut().zip(&mut self.doubt_uv).enumerate() {
            let is_settled = *doubt - rest.doubt_uv[k] < SETTLED_UV;
            let share = (elapsed_s / if is_settled { FOLLOW_S } else { SETTLE_S }).min(1.0);
            *zero += (raw_uv[k] - rest.uv[k] - *zero) * share;
            *doubt += (rest.doubt_uv[k] - *doubt) * share;
        }
    }
}

/// Difference of two readings, µV.
fn relative(uv: &[f64; CHANNELS], from_uv: &[f64; CHANNELS]) -> Strain {
    Strain { uv: std::array::from_fn(|k| (uv[k] - from_uv[k]) as f32) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Channels that all change by so much are a newton.
    const UV_PER_N: f32 = 1_000.0;

    /// Feeds a reading of all channels towards a zero.
    fn feed(tare: &mut Tare, ms: u64, uv: f64, rest: &UntouchedOffset) {
        let at = StreamInstant::from_us(ms * 1_000);
        if let Some(block_uv) = tare.watch(at, &[uv; CHANNELS])
            && !tare.is_known()
        {
            tare.measure(at, &block_uv, rest, |strain| strain.uv[0] / UV_PER_N);
        }
    }

    /// Feeds `raw_uv(t_ms)` in all channels every millisecond; the time at which the zero was known, in ms.
    fn known_at_ms(tare: &mut Tare, raw_uv: impl Fn(u64) -> f64) -> Option<u64> {
        (0..8_000).find(|&ms| {
            feed(tare, ms, raw_uv(ms), &UntouchedOffset::NONE);
            tare.is_known()
        })
    }

    #[test]
    fn a_pad_at_rest_is_tared_within_a_short_lift() {
        let mut tare = Tare::new(false);
        assert!(
            known_at_ms(&mut tare, |ms| 1_500.0 + if ms % 2 == 0 { 30.0 } else { -30.0 }).unwrap() <= 200
        );
        let strain =
            tare.apply(StreamInstant::from_us(500_000), &[1_600.0; CHANNELS], true, &UntouchedOffset::NONE);
        assert!(strain.uv.iter().all(|uv| (uv - 100.0).abs() < 1.0));
    }

    #[test]
    fn a_finger_that_leaves_keeps_the_zero_unknown_until_the_pad_lies_still() {
        let ramp = |ms: u64| 400.0 * (2_000.0 - ms.min(2_000) as f64) * 1e-3;
        let known_at_ms = known_at_ms(&mut Tare::new(false), ramp).unwrap();
        assert!((2_000..2_250).contains(&known_at_ms), "{known_at_ms} ms");
    }

    #[test]
    fn a_still_press_after_a_lower_load_is_no_zero_until_it_is_the_lowest_for_long() {
        // A finger comes after 100 ms, too soon for a zero, and stays.
        let press = |until_ms: u64| move |ms: u64| if (100..until_ms).contains(&ms) { 800.0 } else { 0.0 };
        let mut tare = Tare::new(false);
        let known = known_at_ms(&mut tare, press(2_000)).unwrap();
        assert!((2_150..2_250).contains(&known), "{known} ms");
        assert!(!tare.is_loaded());
        let known = known_at_ms(&mut Tare::new(false), press(8_000)).unwrap();
        assert!((5_100..5_200).contains(&known), "{known} ms");
    }

    #[test]
    fn a_slip_of_a_sample_is_no_lower_load() {
        for slipped in 0..190 {
            let slip = |ms: u64| if ms == slipped { -100_000.0 } else { 800.0 };
            let known = known_at_ms(&mut Tare::new(false), slip).unwrap();
            assert!(known <= slipped + 250, "{slipped}: {known} ms");
        }
    }

    #[test]
    fn a_zero_under_load_is_measured_anew_at_rest_however_short_the_lifts_before() {
        let mut tare = Tare::new(false);
        assert!(known_at_ms(&mut tare, |_| 3_000.0).is_some_and(|ms| ms < 200));
        // Lifts of 100 ms are too short; in between it is pressed as before, and lighter.
        let load = |ms: u64| match ms {
            200..300 | 800..900 | 1_400.. => 0.0,
            ..200 | 300..800 => 3_000.0,
            _ => 1_000.0,
        };
        for ms in 0..240 {
            feed(&mut tare, ms, load(ms), &UntouchedOffset::NONE);
        }
        tare.doubt();
        let known = (240..8_000).find(|&ms| {
            feed(&mut tare, ms, load(ms), &UntouchedOffset::NONE);
            tare.is_known()
        });
        let known = known.unwrap();
        assert!((1_550..1_650).contains(&known), "{known} ms");
        let strain =
            tare.apply(StreamInstant::from_us(1_700_000), &[1_000.0; CHANNELS], true, &UntouchedOffset::NONE);
        assert!((strain.uv[4] - 1_000.0).abs() < 1e-3);
    }

    #[test]
    fn blocks_below_the_zero_with_a_touch_between_are_not_in_a_row() {
        let mut tare = Tare::new(false);
        assert!(known_at_ms(&mut tare, |_| 0.0).is_some());
        let mut pulled = |touched| {
            let rest = UntouchedOffset::NONE;
            let pad = PadState { touched, is_touch_believed: true, rest, added_uv: [0.0; CHANNELS] };
            let load_n = |strain: &Strain| strain.uv[0] / UV_PER_N;
            let loads = Loads { plain_n: load_n, without_stray_n: load_n };
            tare.is_pulled(&[-500.0; CHANNELS], &pad, &loads)
        };
        assert_eq!([false, true, false, false].map(&mut pulled), [false, false, false, true]);
    }

    #[test]
    fn the_zero_follows_drift_while_idle_and_stands_still_under_a_finger() {
        for (touched, expected_uv) in [(false, 36.8), (true, 100.0)] {
            let mut tare = Tare::new(false);
            known_at_ms(&mut tare, |_| 0.0);
            let strain_uv = (0..20_000).map(|ms| {
                tare.apply(
                    StreamInstant::from_us(500_000 + ms * 1_000),
                    &[100.0; CHANNELS],
                    touched,
                    &UntouchedOffset::NONE,
                )
                .uv[0]
            });
            let last_uv = f64::from(strain_uv.last().unwrap());
            assert!((last_uv - expected_uv).abs() < 2.0, "{last_uv} µV is not {expected_uv} µV");
        }
    }

    #[test]
    fn a_load_that_came_during_a_gap_is_no_drift() {
        let mut tare = Tare::new(false);
        known_at_ms(&mut tare, |_| 0.0);
        let strain = tare.apply(
            StreamInstant::from_us(60_000_000),
            &[1_000.0; CHANNELS],
            false,
            &UntouchedOffset::NONE,
        );
        assert!(strain.uv[0] > 999.0, "{} µV", strain.uv[0]);
    }

    #[test]
    fn a_slow_pad_is_tared_too() {
        let mut tare = Tare::new(false);
        let known = (0..50).find(|&i| {
            feed(&mut tare, 10 * i, 7.0, &UntouchedOffset::NONE);
            tare.is_known()
        });
        assert!(known.unwrap() * 10 <= 200);
    }

    #[test]
    fn what_is_left_behind_is_not_taken_for_the_zero_and_what_was_is_mended_soon() {
        let rest = |uv, doubt_uv| UntouchedOffset { uv: [uv; CHANNELS], doubt_uv: [doubt_uv; CHANNELS] };
        let mut tare = Tare::new(false);
        // A pad with 30 µV of hysteresis, of which nothing is known yet.
        for ms in 0..500 {
            feed(&mut tare, ms, 130.0, &rest(0.0, 50.0));
        }
        let mut reads_uv = |ms: std::ops::Range<u64>, rest: UntouchedOffset| {
            let mut uv = 0.0;
            for ms in ms {
                let at = StreamInstant::from_us(ms * 1_000);
                uv = tare.apply(at, &[130.0; CHANNELS], false, &rest).uv[4];
            }
            f64::from(uv)
        };
        assert!(reads_uv(500..1_500, rest(0.0, 50.0)).abs() < 1e-3, "nothing new");
        assert!((reads_uv(1_500..3_000, rest(30.0, 0.0)) - 30.0).abs() < 1.0, "now it is known");
        assert!((reads_uv(3_000..20_000, rest(30.0, 0.0)) - 30.0).abs() < 1.0, "and stays");
    }
}
