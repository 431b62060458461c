//! Memory of earlier loads, followed and subtracted in play: hysteresis and creep.
//!
//! A table of contacts is whole before it is decoded; in play nothing is known but what came so far. Two things help.
//! While nothing touches the pad its strain is zero, so the play operators stay where the last press left them, and what
//! they make the pad read then is known: the zero is followed around that. And where the operators are when play begins is
//! not known, but each press narrows it down: it is followed from both ends of what it can be, and once the two have met,
//! the zero that was taken before is mended (see [`UntouchedOffset`]).

use super::Compensation;
use super::creep::CreepState;
use super::hysteresis::{History, Hysteresis, NO_HYSTERESIS};
use crate::pipeline::interruption::Effect;
use crate::pipeline::signal::tare::UntouchedOffset;
use crate::quantity::{CHANNELS, Strain};
use crate::time::StreamInstant;
use tactpad_numeric::memory::Relaxation;

/// So long without a sample is a silence: a finger that is there after it need not have been there all the time.
pub(super) const SILENCE_US: u64 = 100_000;

/// State of hysteresis and creep, followed sample by sample.
#[derive(Clone, Copy, Debug)]
pub struct Memory {
    hysteresis: Hysteresis,
    creep: Relaxation,
    is_none: bool,
    likely: History,
    /// From the lowest and the highest states that there can be.
    ends: [History; 2],
    crept: CreepState,
    /// Of the sample before.
    at: Option<StreamInstant>,
}

impl Memory {
    /// Of a pad of which nothing is known yet; it is thought never to have been pressed.
    pub fn of(compensation: &Compensation) -> Self {
        Self::of_pad(compensation.hysteresis, compensation.creep)
    }

    fn of_pad(hysteresis: Hysteresis, creep: Relaxation) -> Self {
        let mut memory = Self {
            hysteresis,
            creep,
            is_none: hysteresis == NO_HYSTERESIS && creep == Relaxation::NONE,
            likely: History::default(),
            ends: [History::default(); 2],
            crept: CreepState::default(),
            at: None,
        };
        memory.doubt();
        memory
    }

    /// In doubt, what happened meanwhile is not known.
    pub fn interrupt(&mut self, effect: Effect) {
        match effect {
            Effect::Keep => {}
            Effect::Doubt => self.doubt(),
            Effect::Forget => *self = Self::of_pad(self.hysteresis, self.creep),
        }
    }

    /// The states may be anywhere, and are thought to be where they were.
    fn doubt(&mut self) {
        for (end, sign) in self.ends.iter_mut().zip([-1.0, 1.0]) {
            end.state_uv = self.hysteresis.map(|play| play.map(|it| sign * it.threshold));
        }
    }

    /// The strains that were followed are so many times what was thought: what is remembered of them follows.
    pub fn rescale(&mut self, by: f64) {
        let histories = [&mut self.likely].into_iter().chain(&mut self.ends);
        let states = histories.flat_map(|history| history.state_uv.as_flattened_mut());
        states.chain(&mut self.crept.state_uv).for_each(|uv| *uv *= by);
    }

    /// Offset of the untouched pad beside its zero now, µV.
    pub fn rest(&self) -> UntouchedOffset {
        if self.is_none {
            return UntouchedOffset::NONE;
        }
        // Untouched, e = 0: it reads Σⱼ wⱼ pⱼ + c u, and with p⁻ ≤ p ≤ p⁺ that is off by Σⱼ |wⱼ| (p⁺ⱼ − p⁻ⱼ) / 2 at most if p
        // is in the middle.
        let [low, high] = &self.ends;
        let doubt_uv = |k: usize| {
            let plays = self.hysteresis.iter().zip(low.state_uv.iter().zip(&high.state_uv));
            plays.map(|(play, (low, high))| play[k].share.abs() * (high[k] - low[k]) / 2.0).sum()
        };
        let (lag_uv, crept_uv) =
            (self.likely.added_uv(&self.hysteresis, &[0.0; CHANNELS]), self.crept.added_uv(&self.creep));
        UntouchedOffset {
            uv: std::array::from_fn(|k| lag_uv[k] + crept_uv[k]),
            doubt_uv: std::array::from_fn(doubt_uv),
        }
    }

    /// Channels without hysteresis and creep, µV.
    pub fn freed(&self, strain: &Strain) -> Strain {
        if self.is_none {
            return *strain;
        }
        // e of s = e + c u + Σⱼ wⱼ (pⱼ(e) − e), with the u of the sample before: in a sample's time nothing creeps.
        let crept_uv = self.crept.added_uv(&self.creep);
        let read_uv = std::array::from_fn(|k| f64::from(strain.uv[k]) - crept_uv[k]);
        let free_uv = self.likely.freed(&self.hysteresis, &read_uv);
        Strain { uv: free_uv.map(|uv| uv as f32) }
    }

    /// Time passes until then, in which nobody knows the strain: what has crept fades.
    pub fn wait(&mut self, at: StreamInstant) {
        let waited_us = self.passed_us(at);
        self.crept.hold(&[0.0; CHANNELS], waited_us as f64 * 1e-6, &self.creep);
    }

    /// Goes on to a strain without hysteresis and creep, at this time; `None` if nothing touches the pad.
    pub fn follow(&mut self, at: StreamInstant, free: Option<&Strain>) {
        if self.is_none {
            return;
        }
        if self.at.is_none_or(|before| at.us_since(before) > SILENCE_US) {
            self.wait(at);
        }
        let passed_us = self.passed_us(at);
        let free_uv = free.map_or([0.0; CHANNELS], |free| free.uv.map(f64::from));
        self.crept.hold(&free_uv, passed_us as f64 * 1e-6, &self.creep);
        self.likely.follow(&self.hysteresis, &free_uv);
        self.ends.iter_mut().for_each(|end| end.follow(&self.hysteresis, &free_uv));
    }

    /// Since the last time that was told.
    fn passed_us(&mut self, at: StreamInstant) -> u64 {
        self.at.replace(at).map_or(0, |before| at.us_since(before))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_numeric::memory::PlayOperator;

    const HYSTERESIS: Hysteresis =
        [[PlayOperator { threshold: 800.0, share: 0.0625 }; CHANNELS], [PlayOperator::NONE; CHANNELS]];

    #[test]
    fn a_press_says_where_hysteresis_is() {
        let mut memory = Memory::of(&Compensation { hysteresis: HYSTERESIS, ..Compensation::NONE });
        assert_eq!(memory.rest(), UntouchedOffset { uv: [0.0; CHANNELS], doubt_uv: [50.0; CHANNELS] });
        let mut known = |press_uv: f32| {
            memory.follow(StreamInstant::default(), Some(&Strain { uv: [press_uv; CHANNELS] }));
            memory.follow(StreamInstant::default(), None);
            (memory.rest().uv[0], memory.rest().doubt_uv[0])
        };
        assert_eq!(known(400.0), (0.0, 37.5), "a weak one says a little");
        assert_eq!(known(1200.0), (25.0, 12.5), "a firmer one more");
        assert_eq!(known(3000.0), (50.0, 0.0), "a strong one all");
        assert_eq!(known(-1200.0), (-25.0, 0.0), "which stays so");
        memory.doubt();
        assert_eq!(memory.rest(), UntouchedOffset { uv: [-25.0; CHANNELS], doubt_uv: [50.0; CHANNELS] });
    }

    #[test]
    fn strains_that_turn_out_to_be_larger_leave_as_much_in_the_readings() {
        let creep = Relaxation { time_s: 8.0, share: 0.01 };
        let memory = |uv: f32| {
            let mut memory =
                Memory::of(&Compensation { hysteresis: HYSTERESIS, creep, ..Compensation::NONE });
            for ms in 0..3_000 {
                let at = StreamInstant::from_us(1_000 * ms);
                memory.follow(at, (ms < 2_000).then_some(&Strain { uv: [uv; CHANNELS] }));
            }
            memory
        };
        // Presses below the threshold: the states are in proportion to them.
        let (mut lighter, harder) = (memory(600.0), memory(750.0));
        lighter.rescale(1.25);
        let [lighter, harder] = [lighter, harder].map(|memory| memory.crept.state_uv[4]);
        assert!((lighter - harder).abs() < 1e-3 && harder > 100.0, "{lighter} {harder}");
    }

    #[test]
    fn a_long_press_does_not_creep_and_leaves_nothing() {
        let creep = Relaxation { time_s: 8.0, share: 0.01 };
        let (mut memory, mut pad) =
            (Memory::of(&Compensation { creep, ..Compensation::NONE }), CreepState::default());
        let mut at = StreamInstant::default();
        for ms in 0..60_000 {
            let pressed_uv = if (5_000..35_000).contains(&ms) { 2000.0 } else { 0.0 };
            let read_uv = pressed_uv + pad.added_uv(&creep)[0];
            let free = memory.freed(&Strain { uv: [read_uv as f32; CHANNELS] });
            assert!((f64::from(free.uv[0]) - pressed_uv).abs() < 0.05, "{ms} ms: {}", free.uv[0]);
            if ms == 35_500 {
                assert!((memory.rest().uv[0] - read_uv).abs() < 0.05 && read_uv > 15.0, "{read_uv}");
            }
            memory.follow(at, (pressed_uv > 0.0).then_some(&free));
            pad.hold(&[pressed_uv; CHANNELS], 1e-3, &creep);
            at = at.plus_us(1_000);
        }
    }

    #[test]
    fn a_pad_without_hysteresis_passes() {
        let mut memory = Memory::of(&Compensation::NONE);
        let strain = Strain { uv: [0.1; CHANNELS] };
        memory.follow(StreamInstant::default(), Some(&strain));
        assert_eq!((memory.freed(&strain), memory.rest()), (strain, UntouchedOffset::NONE));
    }
}
