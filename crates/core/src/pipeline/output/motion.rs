//! From rates to steps: what the pointer is moved by. And places of the screen that it goes to.
//!
//! The mapping says how fast the pointer should move (a level), and a mouse tells how far it has moved (a sum). Between
//! the two lies the stream's time. The sum is taken in whole numbers, so that it has no error and no preference: the
//! same way forth and back ends where it began.

use crate::pipeline::control::names::{POINTER_MOTION, POINTER_PLACE};
use crate::pipeline::control::{Code, OutputDevice};
use crate::pipeline::mapping::live::intent::Intents;
use crate::pipeline::mapping::profile::POINTER_SPEED_MAX;
use crate::time::StreamInstant;

/// Movements that can come of one call: right or left, up or down, and a place of the screen.
pub(super) const STEPS_MAX: usize = POINTER_MOTION.len() + POINTER_PLACE.len();

/// A step of the pointer: the device, and by how far, or where to.
pub(super) type MotionStep = (OutputDevice, Code, i32);

/// Steps come at least this far apart: a screen shows fewer, and a pad at 8 kHz would flood every reader.
const SPACING_US: u64 = 4_000;

/// A longer time between two samples counts as this: nobody meant the pointer to jump while nothing was heard.
const GAP_MAX_US: u64 = 20_000;

/// No step is longer, in counts: the fastest pointer, all that waited for the spacing and the longest gap.
const STEP_MAX: i32 = 127;

/// A count at a rate of one count per second takes so many microseconds.
const SECOND_US: i64 = 1_000_000;

// One more for the rest that was there before.
const _: () = assert!(
    POINTER_SPEED_MAX as i64 * (SPACING_US + GAP_MAX_US) as i64 / SECOND_US < STEP_MAX as i64,
    "every step is in bounds"
);

/// The pointer's rates and what they have summed up to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    axes: [Axis; POINTER_MOTION.len()],
    places: [TabletPosition; POINTER_PLACE.len()],
    /// Up to here the rates are summed.
    at: StreamInstant,
    /// From here on the next step may come.
    next_at: StreamInstant,
}

#[derive(Clone, Copy, Debug)]
struct Axis {
    code: Code,
    /// Counts per second.
    rate: i32,
    /// Motion not told yet, in millionths of a count.
    rest: i64,
}

/// Where the pointer goes along one side of the screen; 0 is nowhere.
#[derive(Clone, Copy, Debug)]
struct TabletPosition {
    code: Code,
    wanted: i32,
    told: i32,
}

impl Motion {
    /// The pointer at rest.
    pub(super) fn new() -> Self {
        let axes = POINTER_MOTION.map(|code| Axis { code, rate: 0, rest: 0 });
        let places = POINTER_PLACE.map(|code| TabletPosition { code, wanted: 0, told: 0 });
        Self { axes, places, at: StreamInstant::default(), next_at: StreamInstant::default() }
    }

    /// Sums up to `at` with the rates that held until now, then takes those of `levels`, none being rest.
    ///
    /// Rates beyond [`POINTER_SPEED_MAX`] count as that. Time that runs backwards counts as time that stands still.
    pub(super) fn update(&mut self, at: StreamInstant, levels: &Intents) {
        let elapsed_us = at.us_since(self.at).min(GAP_MAX_US) as i64;
        self.at = self.at.max(at);
        for axis in &mut self.axes {
            axis.rest = axis.rest.saturating_add(i64::from(axis.rate).saturating_mul(elapsed_us));
            let level = levels.iter().find(|level| level.code == axis.code);
            axis.rate = level.map_or(0, |level| level.value.clamp(-POINTER_SPEED_MAX, POINTER_SPEED_MAX));
        }
        let of_tablet = || levels.iter().filter(|level| level.device == OutputDevice::Tablet);
        for place in &mut self.places {
            // A lifted finger leaves the pointer where it is.
            place.wanted =
                of_tablet().find(|level| level.code == place.code).map_or(place.wanted, |level| level.value);
        }
    }

    /// Takes the whole counts that are due, each movement with its step; none before `SPACING_US` after the last.
    pub(super) fn take_steps(&mut self) -> [Option<MotionStep>; STEPS_MAX] {
        if self.at < self.next_at {
            return [None; STEPS_MAX];
        }
        let [right, down] = self.axes.each_mut().map(Axis::take_step);
        let [left, top] = self.places.each_mut().map(TabletPosition::take_step);
        let steps = [right, down, left, top];
        if steps.iter().any(Option::is_some) {
            self.next_at = self.at.plus_us(SPACING_US);
        }
        steps
    }

    /// Stops at once, and forgets what was not told yet.
    pub(super) fn stop(&mut self, at: StreamInstant) {
        self.at = self.at.max(at);
        for axis in &mut self.axes {
            (axis.rate, axis.rest) = (0, 0);
        }
        for place in &mut self.places {
            place.wanted = place.told;
        }
    }

    /// The movements under way with their rates in counts per second.
    pub(super) fn rates(&self) -> impl Iterator<Item = (Code, i32)> + '_ {
        self.axes.iter().filter(|axis| axis.rate != 0).map(|axis| (axis.code, axis.rate))
    }
}

impl Axis {
    /// The whole counts of the rest; the division rounds towards rest in both directions.
    fn take_step(&mut self) -> Option<MotionStep> {
        let bound = i64::from(STEP_MAX);
        let step = (self.rest / SECOND_US).clamp(-bound, bound);
        self.rest -= step * SECOND_US;
        (step != 0).then_some((OutputDevice::Pointer, self.code, step as i32))
    }
}

impl TabletPosition {
    /// The place, if it is another one than was told last.
    fn take_step(&mut self) -> Option<MotionStep> {
        let is_new = self.wanted != self.told;
        self.told = self.wanted;
        is_new.then_some((OutputDevice::Tablet, self.code, self.told))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::pipeline::control::OutputDevice;
    use crate::pipeline::mapping::live::intent::Level;

    fn rates(right: i32, down: i32) -> Intents {
        let level = |(code, value)| Level { device: OutputDevice::Pointer, code, value };
        POINTER_MOTION.into_iter().zip([right, down]).filter(|(_, rate)| *rate != 0).map(level).collect()
    }

    /// The steps (time, right, down) of a pad with samples every `period_us` that states these rates, each so long.
    fn steps(period_us: u64, stretches: &[(u64, i32, i32)]) -> Vec<(u64, i32, i32)> {
        let (mut motion, mut at, mut all) = (Motion::new(), StreamInstant::default(), Vec::new());
        for (length_us, right, down) in stretches {
            for _ in 0..length_us / period_us {
                motion.update(at, &rates(*right, *down));
                let [x, y, ..] = motion.take_steps().map(|step| step.map_or(0, |(_, _, counts)| counts));
                if (x, y) != (0, 0) {
                    all.push((at.as_us(), x, y));
                }
                at = at.plus_us(period_us);
            }
        }
        all
    }

    fn sum(steps: &[(u64, i32, i32)]) -> (i32, i32) {
        steps.iter().fold((0, 0), |sum, step| (sum.0 + step.1, sum.1 + step.2))
    }

    const REST: (u64, i32, i32) = (20_000, 0, 0);

    #[test]
    fn a_second_at_a_rate_is_exactly_the_rate() {
        for period_us in [125, 1_000, 10_000, 20_000] {
            for (right, down) in [(800, 0), (-800, 0), (1, -7), (5_000, 5_000), (333, -999)] {
                let steps = steps(period_us, &[(1_000_000, right, down), REST]);
                assert_eq!(sum(&steps), (right, down), "every {period_us} µs");
            }
        }
    }

    #[test]
    fn slow_ways_add_up_and_mirrored_ones_cancel() {
        let way = [(700, 997, -13), (1_300_000, -3, 1), (41_000, 250, 250), REST];
        let back = way.map(|(length_us, right, down)| (length_us, -right, -down));
        assert_eq!(sum(&steps(100, &[way, back].concat())), (0, 0));
        let there: Vec<_> = steps(100, &way);
        let mirrored: Vec<_> = there.iter().map(|(at, right, down)| (*at, -right, -down)).collect();
        assert_eq!(steps(100, &back), mirrored);
        assert_eq!(sum(&steps(1_000, &[(999_000, 1, -1), REST])), (0, 0));
        assert_eq!(sum(&steps(1_000, &[(1_000_000, 1, -1), REST])), (1, -1));
    }

    #[test]
    fn a_fast_pad_does_not_flood() {
        let steps = steps(125, &[(1_000_000, 5_000, 0), REST]);
        assert_eq!(sum(&steps), (5_000, 0));
        assert!(steps.windows(2).all(|pair| pair[1].0 - pair[0].0 == SPACING_US), "{steps:?}");
    }

    #[test]
    fn a_silence_is_no_movement() {
        let mut motion = Motion::new();
        motion.update(StreamInstant::from_us(0), &rates(1_000, 0));
        motion.update(StreamInstant::from_us(GAP_MAX_US + 60_000), &rates(0, 0));
        assert_eq!(
            motion.take_steps(),
            [Some((OutputDevice::Pointer, POINTER_MOTION[0], 20)), None, None, None]
        );
    }

    #[test]
    fn a_stop_forgets_what_was_not_told() {
        let mut motion = Motion::new();
        motion.update(StreamInstant::from_us(0), &rates(5_000, -5_000));
        motion.update(StreamInstant::from_us(3_000), &rates(5_000, -5_000));
        motion.stop(StreamInstant::from_us(3_000));
        assert_eq!(motion.rates().count(), 0);
        motion.update(StreamInstant::from_us(50_000), &rates(0, 0));
        assert_eq!(motion.take_steps(), [None; STEPS_MAX]);
    }

    #[test]
    fn time_that_runs_backwards_stands_still() {
        let mut motion = Motion::new();
        motion.update(StreamInstant::from_us(9_000), &rates(1_000, 0));
        motion.update(StreamInstant::from_us(1_000), &rates(1_000, 0));
        motion.update(StreamInstant::from_us(10_000), &rates(1_000, 0));
        assert_eq!(
            motion.take_steps(),
            [Some((OutputDevice::Pointer, POINTER_MOTION[0], 1)), None, None, None]
        );
    }

    #[test]
    fn a_place_is_told_when_it_is_another_one_and_stays_after_a_lift() {
        let mut motion = Motion::new();
        let mut told = |ms: u64, place: Option<[i32; 2]>| {
            let level = |(code, value)| Level { device: OutputDevice::Tablet, code, value };
            let levels = POINTER_PLACE.into_iter().zip(place.unwrap_or_default()).map(level);
            let levels: Intents = levels.filter(|level| level.value != 0).collect();
            motion.update(StreamInstant::from_us(ms * 1_000), &levels);
            motion.take_steps().into_iter().flatten().map(|(_, _, value)| value).collect::<Vec<_>>()
        };
        assert_eq!(told(0, Some([5, 7])), [5, 7]);
        assert!(told(3, Some([6, 7])).is_empty(), "less than 4 ms later");
        assert_eq!(told(4, Some([6, 7])), [6]);
        assert!(told(20, None).is_empty());
        assert!(told(30, Some([6, 7])).is_empty());
    }

    proptest! {
        #[test]
        fn no_step_is_out_of_bounds(
            calls in prop::collection::vec((prop_oneof![0_u64..500, 0_u64..30_000, any::<u64>()], any::<i32>(), any::<i32>()), 0..80)
        ) {
            let (mut motion, mut at) = (Motion::new(), StreamInstant::default());
            let mut last = None;
            for (wait_us, right, down) in calls {
                at = at.plus_us(wait_us);
                motion.update(at, &rates(right, down));
                let steps = motion.take_steps();
                for (_, _, step) in steps.iter().flatten() {
                    prop_assert!(*step != 0 && step.abs() <= STEP_MAX);
                    prop_assert!(motion.axes.iter().all(|axis| axis.rest.abs() < SECOND_US), "nothing is left over");
                }
                if steps.iter().any(Option::is_some) {
                    prop_assert!(last.is_none_or(|last| at.us_since(last) >= SPACING_US));
                    last = Some(at);
                }
            }
        }
    }
}
