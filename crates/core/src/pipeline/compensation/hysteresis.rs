//! Hysteresis of a channel, µV, by friction between the pad's parts. The model is Prandtl's and
//! Ishlinskii's.
//!
//! A channel reads s = e + Σⱼ wⱼ (pⱼ − e), where e is the strain without hysteresis and pⱼ the state of a play operator: it
//! stays where it is until e is further from it than a threshold, and is then pulled along. Time plays no part in it.
//!
//! Source: M. A. Krasnosel'skii, A. V. Pokrovskii, Systems with Hysteresis (1989), section 2; the inverse is that of K.
//! Kuhnen, Eur. J. Control 9 (2003) 407.

use crate::quantity::CHANNELS;
use tactpad_numeric::memory::PlayOperator;

/// How many play operators a channel has.
pub const PLAYS: usize = 2;

/// Rounds at most in which the strain without hysteresis is found. Each leaves a part of the error that is the sum of the
/// shares.
const ROUNDS: usize = 12;
/// A round that changes less is the last.
const ROUND_END_UV: f64 = 1e-7;

/// The hysteresis of a pad, µV: for each operator, one in each channel. The magnitudes of a channel's shares are less than 1 in sum.
pub type Hysteresis = [[PlayOperator; CHANNELS]; PLAYS];

/// A pad without hysteresis.
pub const NO_HYSTERESIS: Hysteresis = [[PlayOperator::NONE; CHANNELS]; PLAYS];

/// Where the play operators of a pad are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct History {
    /// For each operator and channel.
    pub state_uv: [[f64; CHANNELS]; PLAYS],
}

impl History {
    /// The channels went to these strains, which are without hysteresis.
    pub fn follow(&mut self, hysteresis: &Hysteresis, free_uv: &[f64; CHANNELS]) {
        for (states, plays) in self.state_uv.iter_mut().zip(hysteresis) {
            for ((state, play), free) in states.iter_mut().zip(plays).zip(free_uv) {
                *state = play.pulled(*state, *free);
            }
        }
    }

    /// The strains without hysteresis when the channels have come to these readings. The states do not follow by that.
    pub fn freed(&self, hysteresis: &Hysteresis, read_uv: &[f64; CHANNELS]) -> [f64; CHANNELS] {
        std::array::from_fn(|channel| self.free_uv(hysteresis, channel, read_uv[channel]))
    }

    /// Hysteresis in the readings of these strains, µV.
    pub fn added_uv(&self, hysteresis: &Hysteresis, free_uv: &[f64; CHANNELS]) -> [f64; CHANNELS] {
        std::array::from_fn(|channel| {
            // Σⱼ wⱼ (pⱼ − e)
            let plays = self.state_uv.iter().zip(hysteresis);
            plays.map(|(states, plays)| plays[channel].added(states[channel], free_uv[channel])).sum()
        })
    }

    fn free_uv(&self, hysteresis: &Hysteresis, channel: usize, read_uv: f64) -> f64 {
        // The fixed point of e ← s − Σⱼ wⱼ (pⱼ(e) − e), from e = s on. Σⱼ |wⱼ| < 1 makes it a contraction: pⱼ(e) − e changes
        // by no more than e does.
        let mut free_uv = read_uv;
        for _ in 0..ROUNDS {
            let added_uv = |(states, plays): (&[f64; CHANNELS], &[PlayOperator; CHANNELS])| {
                let play = &plays[channel];
                play.added(play.pulled(states[channel], free_uv), free_uv)
            };
            let next_uv = read_uv - self.state_uv.iter().zip(hysteresis).map(added_uv).sum::<f64>();
            let change_uv = (next_uv - free_uv).abs();
            free_uv = next_uv;
            if change_uv < ROUND_END_UV {
                break;
            }
        }
        free_uv
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_numeric::random::SplitMix64;

    fn hysteresis() -> Hysteresis {
        let play = |threshold_uv: f64, share: f64| {
            std::array::from_fn(|channel| {
                let threshold = threshold_uv * (1.0 + 0.1 * channel as f64);
                PlayOperator { threshold, share }
            })
        };
        [play(100.0, 0.05), play(800.0, 0.0625)]
    }

    #[test]
    fn strains_come_out_again() {
        let mut random = SplitMix64::new(1);
        let (mut pad, mut found) = (History::default(), History::default());
        for _ in 0..3000 {
            let strains: [f64; CHANNELS] = std::array::from_fn(|_| 3000.0 * f64::from(random.uniform()));
            pad.follow(&hysteresis(), &strains);
            let added = pad.added_uv(&hysteresis(), &strains);
            let read = std::array::from_fn(|channel| strains[channel] + added[channel]);
            let freed = found.freed(&hysteresis(), &read);
            found.follow(&hysteresis(), &freed);
            let off =
                freed.iter().zip(strains).map(|(freed, strain)| (freed - strain).abs()).fold(0.0, f64::max);
            assert!(off < 1e-6, "{off}");
        }
    }

    #[test]
    fn a_released_pad_keeps_a_rest() {
        let mut history = History::default();
        history.follow(&hysteresis(), &[3000.0; CHANNELS]);
        history.follow(&hysteresis(), &[0.0; CHANNELS]);
        let rest_uv = history.added_uv(&hysteresis(), &[0.0; CHANNELS])[0];
        assert!((rest_uv - (0.05 * 100.0 + 0.0625 * 800.0)).abs() < 1e-9, "{rest_uv}");
    }

    #[test]
    fn without_hysteresis_channels_are_what_they_are() {
        let history = History::default();
        assert_eq!(history.freed(&NO_HYSTERESIS, &[123.0; CHANNELS]), [123.0; CHANNELS]);
        assert_eq!(history.added_uv(&NO_HYSTERESIS, &[123.0; CHANNELS]), [0.0; CHANNELS]);
    }
}
