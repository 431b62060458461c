//! Memory of the strains: hysteresis as play operators (Prandtl and Ishlinskii), creep as a Prony series.

use crate::bytes::{Reader, push_doubles};
use crate::pad::device::behaviour::{Behaviour, OnChannels};
use crate::quantity::CHANNELS;
use tactpad_numeric::memory::{PlayOperator, Relaxation, ramped};

/// The state of all play operators and Prony terms of a pad.
#[derive(Clone, Debug)]
pub(super) struct Memory {
    plays: Vec<(OnChannels<PlayOperator>, [f64; CHANNELS])>,
    terms: Vec<(OnChannels<Relaxation>, [f64; CHANNELS])>,
    /// The strains last seen.
    strain_uv: [f64; CHANNELS],
}

impl Memory {
    /// A pad that was never touched.
    pub(super) fn new(behaviour: &Behaviour) -> Self {
        let Behaviour { hysteresis, creep, .. } = behaviour;
        Self {
            plays: hysteresis.iter().map(|play| (*play, [0.0; CHANNELS])).collect(),
            terms: creep.iter().map(|term| (*term, [0.0; CHANNELS])).collect(),
            strain_uv: [0.0; CHANNELS],
        }
    }

    /// The strains with hysteresis and creep, when they went evenly from the last ones to these within `after_s`.
    pub(super) fn follow(&mut self, after_s: f64, strain_uv: &[f64; CHANNELS]) -> [f64; CHANNELS] {
        let mut read_uv = *strain_uv;
        for (OnChannels { channels, law }, states) in &mut self.plays {
            for (channel, state) in states.iter_mut().enumerate().filter(|(channel, _)| channels[*channel]) {
                let strain = strain_uv[channel];
                *state = law.pulled(*state, strain);
                read_uv[channel] += law.added(*state, strain);
            }
        }
        for (OnChannels { channels, law }, states) in &mut self.terms {
            let (times, left) = (after_s / law.time_s, law.left(after_s));
            for (channel, state) in states.iter_mut().enumerate().filter(|(channel, _)| channels[*channel]) {
                *state = ramped(*state, [self.strain_uv[channel], strain_uv[channel]], times, left);
                read_uv[channel] += law.added(*state);
            }
        }
        self.strain_uv = *strain_uv;
        read_uv
    }

    pub(super) fn write(&self, to: &mut Vec<u8>) {
        self.plays.iter().for_each(|(_, states)| push_doubles(to, states));
        self.terms.iter().for_each(|(_, states)| push_doubles(to, states));
        push_doubles(to, &self.strain_uv);
    }

    /// Takes up what [`Self::write`] wrote of a pad with as many operators and terms.
    pub(super) fn take_up(&mut self, from: &mut Reader<'_>) -> Option<()> {
        let plays = self.plays.iter_mut().map(|(_, states)| states);
        let terms = self.terms.iter_mut().map(|(_, states)| states);
        for states in plays.chain(terms).chain([&mut self.strain_uv]) {
            *states = from.finites()?;
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn memory(plays: &[PlayOperator], terms: &[Relaxation]) -> Memory {
        let hysteresis = plays.iter().map(|play| OnChannels::all(*play)).collect();
        let creep = terms.iter().map(|term| OnChannels::all(*term)).collect();
        Memory::new(&Behaviour { hysteresis, creep, ..Behaviour::IDEAL })
    }

    fn reads(memory: &mut Memory, after_s: f64, strain_uv: f64) -> f64 {
        memory.follow(after_s, &[strain_uv; CHANNELS])[0]
    }

    #[test]
    fn a_prony_step_relaxes_to_its_plateau() {
        let mut memory =
            memory(&[], &[Relaxation { time_s: 4.0, share: 0.1 }, Relaxation { time_s: 40.0, share: 0.05 }]);
        assert_eq!(reads(&mut memory, 0.0, 1000.0), 1000.0, "a sudden load has not crept");
        for step in 1..=600 {
            let seconds = f64::from(step) * 0.5;
            let wanted =
                1000.0 + 100.0 * (1.0 - (-seconds / 4.0).exp()) + 50.0 * (1.0 - (-seconds / 40.0).exp());
            assert!((reads(&mut memory, 0.5, 1000.0) - wanted).abs() < 1e-9, "{seconds} s");
        }
        assert!((reads(&mut memory, 1e6, 1000.0) - 1150.0).abs() < 1e-9);
        assert!((reads(&mut memory, 0.0, 0.0) - 150.0).abs() < 1e-9, "what crept comes back slowly");
    }

    #[test]
    fn a_ramp_creeps_the_same_in_one_step_as_in_many() {
        let term = || memory(&[], &[Relaxation { time_s: 0.7, share: 0.2 }]);
        let (mut one, mut many) = (term(), term());
        let whole = reads(&mut one, 2.0, 500.0);
        let parts = (1..=1000).map(|part| reads(&mut many, 0.002, f64::from(part) * 0.5)).last().unwrap();
        assert!((whole - parts).abs() < 1e-9, "{whole} {parts}");
        // Of a ramp, a low pass reads the end less the rise within a time constant, once the start is forgotten.
        let wanted = 500.0 + 0.2 * (500.0 - 250.0 * 0.7 * (1.0 - (-2.0_f64 / 0.7).exp()));
        assert!((whole - wanted).abs() < 1e-9, "{whole} {wanted}");
    }

    #[test]
    fn a_play_operator_closes_its_loop() {
        let play = PlayOperator { threshold: 100.0, share: 0.25 };
        let mut memory = memory(&[play], &[]);
        let up = |level: i32| f64::from(level) * 10.0;
        let loading: Vec<f64> = (0..=100).map(|level| reads(&mut memory, 0.01, up(level))).collect();
        let unloading: Vec<f64> = (0..=100).rev().map(|level| reads(&mut memory, 0.01, up(level))).collect();
        let again: Vec<f64> = (0..=100).map(|level| reads(&mut memory, 0.01, up(level))).collect();
        assert_eq!(loading[100], 1000.0 - 25.0);
        assert!(
            unloading[20..=80]
                .iter()
                .zip(loading[20..=80].iter().rev())
                .all(|(down, up)| (down - up - 50.0).abs() < 1e-9)
        );
        assert_eq!(again[100], loading[100], "the loop closes");
        assert_eq!(unloading[100], 25.0, "what is left at rest");
        // Its area is that of the parallelogram: twice the share's width over the stroke without the turns.
        let area: f64 = unloading.iter().rev().zip(&again).map(|(down, up)| 10.0 * (down - up)).sum();
        assert!((area - 50.0 * (1000.0 - 200.0)).abs() < 600.0, "{area}");
    }

    #[test]
    fn rates_do_not_matter_to_friction() {
        let play = PlayOperator { threshold: 30.0, share: 0.4 };
        let (mut slow, mut fast) = (memory(&[play], &[]), memory(&[play], &[]));
        for strain_uv in [0.0, 300.0, 120.0, 500.0, -40.0] {
            assert_eq!(reads(&mut slow, 100.0, strain_uv), reads(&mut fast, 1e-3, strain_uv));
        }
    }

    #[test]
    fn channels_that_are_left_out_remember_nothing() {
        let mut channels = [true; CHANNELS];
        channels[4] = false;
        let mut memory = Memory::new(&Behaviour {
            hysteresis: vec![OnChannels { channels, law: PlayOperator { threshold: 100.0, share: 0.5 } }],
            creep: vec![OnChannels { channels, law: Relaxation { time_s: 1.0, share: 0.5 } }],
            ..Behaviour::IDEAL
        });
        let read_uv = memory.follow(10.0, &[1000.0; CHANNELS]);
        assert_eq!(read_uv[4], 1000.0);
        assert!(read_uv[3] != 1000.0 && read_uv[5] == read_uv[3]);
    }
}
