//! Forces of light and hard presses of a hand, N.

use super::peaks::Peaks;
use tactpad_core::pipeline::contact::touch;

/// With fewer presses of a kind, what one in ten of them does cannot be told.
pub const PRESSES_MIN: usize = 5;

/// Of the force that nine of ten light presses reach, what the lowest threshold is. From a dozen presses that force is known to some 15 %, and
/// people press more lightly in a game than for a recording.
const LOWEST_SHARE: f64 = 0.5;

/// The lowest threshold that is proposed: where a touch begins, and the noise of the force once more. Below it the touch decides.
const LOWEST_MIN_N: f64 = 1.2 * touch::ON_N as f64;

/// The highest threshold lies by so much above what light presses reach, and what hard ones reach by as much above the threshold. The
/// tests of this file say what that comes to.
const APART: f64 = 1.2;

/// A hand's forces, in newtons.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Nine of ten light presses reach this force,
    pub light_n: f64,
    /// and one in ten exceeds this one.
    pub light_most_n: f64,
    /// Nine of ten hard presses reach this.
    pub hard_n: f64,
}

impl Range {
    /// That of these presses; `None` where there are fewer than [`PRESSES_MIN`] of a kind.
    pub fn of(peaks: &Peaks) -> Option<Self> {
        let Peaks { light_n, hard_n } = peaks;
        (light_n.len().min(hard_n.len()) >= PRESSES_MIN).then(|| Self {
            light_n: quantile(light_n, 0.1),
            light_most_n: quantile(light_n, 0.9),
            hard_n: quantile(hard_n, 0.1),
        })
    }

    /// The threshold that a light press must reach.
    pub fn lowest_n(&self) -> f64 {
        (LOWEST_SHARE * self.light_n).max(LOWEST_MIN_N)
    }

    /// The threshold that a hard press must reach and a light one must not: as far above the one, as a ratio, as below the other. Force is
    /// felt, and varies, in proportion to itself.
    pub fn highest_n(&self) -> f64 {
        (self.light_most_n * self.hard_n).sqrt()
    }

    /// Whether hard presses are surely told from light ones.
    pub fn is_told_apart(&self) -> bool {
        self.highest_n() >= APART * self.light_most_n.max(self.lowest_n())
    }
}

/// The value below which this share of all lies, between two of them by a straight line; not a number without values.
fn quantile(values: &[f64], share: f64) -> f64 {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    let place = share * values.len().saturating_sub(1) as f64;
    let at = |index: f64| values.get(index as usize).copied().unwrap_or(f64::NAN);
    let (below, above) = (at(place.floor()), at(place.ceil()));
    below + (place - place.floor()) * (above - below)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_numeric::random::SplitMix64;

    #[test]
    fn quantiles_are_between_the_values() {
        let values = [0.5, 0.25, 1.0, 0.75, 0.0];
        assert_eq!(
            [0.0, 0.1, 0.5, 0.9, 1.0].map(|share| quantile(&values, share)),
            [0.0, 0.1, 0.5, 0.9, 1.0]
        );
        assert!(quantile(&[], 0.1).is_nan());
    }

    #[test]
    fn fewer_than_five_presses_of_a_kind_are_too_few() {
        let of = |light, hard| Range::of(&Peaks { light_n: vec![0.5; light], hard_n: vec![2.0; hard] });
        assert_eq!(of(4, 9), None);
        assert_eq!(of(9, 4), None);
        let range = of(5, 5).unwrap();
        assert_eq!(range, Range { light_n: 0.5, light_most_n: 0.5, hard_n: 2.0 });
        assert_eq!((range.lowest_n(), range.highest_n(), range.is_told_apart()), (0.25, 1.0, true));
        let faint = Range { light_n: 0.16, light_most_n: 0.17, hard_n: 0.2 };
        assert!((faint.lowest_n() - 0.18).abs() < 1e-6 && !faint.is_told_apart());
    }

    /// Of hands that are told apart by `count` presses of each kind: how many of a thousand they are, and the shares of later light presses
    /// that reach the lowest threshold and not the highest, and of later hard ones that reach the highest.
    fn later(random: &mut SplitMix64, count: usize, varies: f64, ratio: f64) -> (usize, [f64; 2]) {
        let later = 100;
        let mut press = |median_n: f64| median_n * (varies * f64::from(random.normal())).exp();
        let (mut told, mut shares) = (0, [0.0; 2]);
        for _ in 0..1_000 {
            let mut many =
                |median_n: f64, count: usize| (0..count).map(|_| press(median_n)).collect::<Vec<_>>();
            let peaks = Peaks { light_n: many(0.6, count), hard_n: many(0.6 * ratio, count) };
            let range = Range::of(&peaks).unwrap();
            if !range.is_told_apart() {
                continue;
            }
            told += 1;
            let (lowest, highest) = (range.lowest_n(), range.highest_n());
            let good = [
                many(0.6, later).iter().filter(|n| (lowest..highest).contains(*n)).count(),
                many(0.6 * ratio, later).iter().filter(|n| **n >= highest).count(),
            ];
            shares = [0, 1].map(|kind| shares[kind] + good[kind] as f64 / later as f64);
        }
        (told, shares.map(|sum| sum / told.max(1) as f64))
    }

    #[test]
    fn hands_that_are_told_apart_stay_apart() {
        let mut random = SplitMix64::new(15);
        for count in [8, 12, 20] {
            for (varies, ratio) in [(0.1, 1.7), (0.15, 2.0), (0.2, 2.5), (0.25, 2.8), (0.3, 4.0)] {
                let (told, [light, hard]) = later(&mut random, count, varies, ratio);
                let what = format!("{count} presses, {varies}, {ratio}: {told} told, {light} {hard}");
                assert!(told < 300 || light.min(hard) >= 0.95, "{what}");
                assert!(ratio < 2.5 || told >= 600, "{what}");
            }
            for varies in [0.1, 0.2, 0.3] {
                assert!(later(&mut random, count, varies, 1.3).0 <= 5, "{count} presses, {varies}");
            }
        }
    }
}
