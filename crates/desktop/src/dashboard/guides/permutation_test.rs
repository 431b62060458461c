//! Whether presses follow what was asked.
//!
//! The order of cues is drawn at random, so a hand that ignores them goes with each other order as well as with the one that was asked. Where
//! presses for the same cue are more alike in the asked order than in all but one of a hundred drawn ones, they follow it: whatever a
//! hand that ignores the cues does, it is taken for one that follows them once in a hundred times at most.

use tactpad_numeric::random::SplitMix64;

/// The share of hands that ignore the cues and are taken for one that follows them, at most.
pub(super) const ERROR_RATE: f64 = 0.01;

/// Orders are drawn so often.
const DRAWS: usize = 1_999;

/// What is compared of a press.
const FEATURES: usize = 6;

/// The press that came for a cue; all zero where there was none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct FeltPress {
    /// Where it was pressed most.
    pub(super) place_mm: [f64; 2],
    /// The forces there.
    pub(super) force_n: [f64; 3],
    pub(super) length_s: f64,
}

impl FeltPress {
    fn features(&self) -> [f64; FEATURES] {
        let ([x, y], [fx, fy, fz]) = (self.place_mm, self.force_n);
        [x, y, fx, fy, fz, self.length_s]
    }
}

/// How unlike presses for the same cue are, by each feature.
type Scatter = [f64; FEATURES];

/// Whether presses follow the cues: each with the number of what was asked.
pub(super) fn follow(presses: &[(usize, FeltPress)], seed: u64) -> bool {
    let ranks = ranks(presses);
    let mut asked: Vec<usize> = presses.iter().map(|(cue, _)| *cue).collect();
    let mut scatters = vec![scatter(&ranks, &asked)];
    let mut random = SplitMix64::named(seed, "orders of cues");
    scatters.extend((0..DRAWS).map(|_| {
        random.shuffle(&mut asked);
        scatter(&ranks, &asked)
    }));
    let closeness = closeness(&scatters);
    // The asked order is one of them.
    let as_close = closeness.iter().filter(|it| Some(*it) >= closeness.first()).count();
    as_close as f64 <= ERROR_RATE * scatters.len() as f64
}

/// Each feature by its ranks, so that one press that is far from all others does not decide.
fn ranks(presses: &[(usize, FeltPress)]) -> Vec<[f64; FEATURES]> {
    let features: Vec<_> = presses.iter().map(|(_, press)| press.features()).collect();
    let ranked = |feature: usize, value: f64| {
        let below = features.iter().filter(|other| other[feature] < value).count();
        let same = features.iter().filter(|other| other[feature] == value).count();
        below as f64 + 0.5 * same as f64
    };
    features.iter().map(|press| std::array::from_fn(|feature| ranked(feature, press[feature]))).collect()
}

fn scatter(ranks: &[[f64; FEATURES]], asked: &[usize]) -> Scatter {
    let mut scatter = [0.0; FEATURES];
    for (index, (one, cue)) in ranks.iter().zip(asked).enumerate() {
        let same = ranks.iter().zip(asked).take(index).filter(|(_, other)| *other == cue);
        for (other, _) in same {
            scatter
                .iter_mut()
                .zip(one.iter().zip(other))
                .for_each(|(sum, (one, other))| *sum += (one - other).powi(2));
        }
    }
    scatter
}

/// How alike presses for the same cue are in each order: by how many standard deviations of all orders each feature scatters less than in the
/// mean of them, squared and added up. What tells cues apart counts so, and what does not counts little.
fn closeness(scatters: &[Scatter]) -> Vec<f64> {
    let count = scatters.len() as f64;
    let moments: [(f64, f64); FEATURES] = std::array::from_fn(|feature| {
        let mean = scatters.iter().map(|it| it[feature]).sum::<f64>() / count;
        let variance = scatters.iter().map(|it| (it[feature] - mean).powi(2)).sum::<f64>() / count;
        (mean, variance.sqrt())
    });
    let close = |value: f64, (mean, deviation): (f64, f64)| {
        if deviation > 0.0 { ((mean - value) / deviation).max(0.0).powi(2) } else { 0.0 }
    };
    scatters.iter().map(|it| it.iter().zip(moments).map(|(value, of)| close(*value, of)).sum()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three cues of each of six kinds, in a drawn order: four directions, a press in the middle and a push.
    fn order(random: &mut SplitMix64) -> Vec<usize> {
        let mut order: Vec<usize> = (0..18).map(|number| number % 6).collect();
        random.shuffle(&mut order);
        order
    }

    /// What a hand does: where it presses and how hard, and how much of both is not meant.
    #[derive(Clone, Copy)]
    struct Hand {
        force_n: f64,
        /// Where it has its middle.
        centre_mm: [f64; 2],
        /// How far out it reaches for a direction.
        reach_mm: f64,
        trembles_mm: f64,
    }

    const HANDS: [(&str, Hand); 4] = [
        ("weak", Hand { force_n: 0.25, centre_mm: [0.0; 2], reach_mm: 12.0, trembles_mm: 2.0 }),
        ("trembling", Hand { force_n: 1.2, centre_mm: [0.0; 2], reach_mm: 15.0, trembles_mm: 5.0 }),
        ("one finger", Hand { force_n: 1.5, centre_mm: [0.0; 2], reach_mm: 8.0, trembles_mm: 2.0 }),
        ("off-centre", Hand { force_n: 1.5, centre_mm: [-9.0, 7.0], reach_mm: 12.0, trembles_mm: 2.5 }),
    ];

    /// What a hand does for the cue of this number.
    type HandAt = dyn Fn(usize, &mut SplitMix64) -> FeltPress;

    fn pressed(hand: Hand, cue: usize, random: &mut SplitMix64) -> FeltPress {
        let mut around = |middle: f64, deviation: f64| middle + deviation * f64::from(random.normal());
        let (out_mm, up_n, harder) =
            if cue < 4 { (hand.reach_mm, 0.0, 1.0) } else { (0.0, (cue == 5).into(), 1.6) };
        let (sin, cos) = (std::f64::consts::FRAC_PI_2 * cue as f64).sin_cos();
        let [x_mm, y_mm] = hand.centre_mm;
        FeltPress {
            place_mm: [
                around(x_mm + out_mm * cos, hand.trembles_mm),
                around(y_mm + out_mm * sin, hand.trembles_mm),
            ],
            force_n: [
                around(0.0, 0.1 * hand.force_n),
                around(up_n * 0.6 * hand.force_n, 0.1 * hand.force_n),
                around(harder * hand.force_n, 0.25 * hand.force_n),
            ],
            length_s: around(0.5, 0.15),
        }
    }

    #[test]
    fn each_hand_that_follows_is_believed() {
        let mut random = SplitMix64::named(3, "following hands");
        for (name, hand) in HANDS {
            let believed = (0..50_u64).filter(|seed| {
                let presses: Vec<_> = order(&mut random)
                    .into_iter()
                    .map(|cue| (cue, pressed(hand, cue, &mut random)))
                    .collect();
                follow(&presses, *seed)
            });
            let believed = believed.count();
            assert!(believed >= 48, "{name}: {believed} of 50");
        }
    }

    #[test]
    fn hands_that_ignore_the_cues_are_believed_once_in_a_hundred_at_most() {
        let mut random = SplitMix64::named(7, "ignoring hands");
        // One presses as it likes, one goes round and round, one does always the same, one grows tired, one does nothing.
        let ignoring: [(&str, &HandAt); 5] = [
            ("as it likes", &|_, random| {
                let cue = (random.next_bits() % 6) as usize;
                pressed(HANDS[1].1, cue, random)
            }),
            ("round", &|index, random| pressed(HANDS[2].1, index % 6, random)),
            ("the same", &|_, random| pressed(HANDS[3].1, 0, random)),
            ("tired", &|index, random| {
                let force_n = 2.0 - 0.1 * index as f64;
                pressed(Hand { force_n, ..HANDS[0].1 }, 4, random)
            }),
            ("nothing", &|_, _| FeltPress::default()),
        ];
        const HANDS_EACH: u64 = 400;
        let mut believed = 0;
        for (name, hand) in ignoring {
            let of_this = (0..HANDS_EACH).filter(|seed| {
                let cues = order(&mut random);
                let presses: Vec<_> = cues
                    .into_iter()
                    .enumerate()
                    .map(|(index, cue)| (cue, hand(index, &mut random)))
                    .collect();
                follow(&presses, *seed)
            });
            let of_this = of_this.count();
            // Of 400, more than 12 are believed by chance less than once in a thousand times.
            assert!(of_this <= 12, "{name}: {of_this} of {HANDS_EACH}");
            believed += of_this;
        }
        assert!(believed <= 38, "{believed} of {}", 5 * HANDS_EACH);
    }
}
