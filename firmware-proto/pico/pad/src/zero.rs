//! The zero of each channel: taken from a pad that lies still, and followed while nothing touches it.

use firmware_proto::CHANNELS;

use crate::excitation::PICOVOLTS_PER_COUNT;

/// A pad lies still when the means of so many tenths of a second in a row agree within this.
const STILL_TENTHS: i64 = 3;
const STILL_COUNTS: i64 = 40 * 1_000_000 / PICOVOLTS_PER_COUNT as i64;

/// A tenth of a second in which nothing touches counts for one in 2^this: the zero follows within some two seconds.
const FOLLOW_SHIFT: u32 = 4;

/// Binary digits after the point of a zero.
const PARTS_SHIFT: u32 = 8;

/// The zero.
#[derive(Clone, Debug, Default)]
pub struct Zero {
    /// In parts of a count.
    parts: Option<[i64; CHANNELS]>,
    /// Sums of the tenth of a second at hand, and how many samples they have.
    sums: [i64; CHANNELS],
    samples: u16,
    /// Means of the first of those tenths that agree, the sums of all of these means, and how many there are.
    first: [i64; CHANNELS],
    agreed: [i64; CHANNELS],
    tenths: i64,
}

impl Zero {
    /// The zero now, in counts; `None` until it is known.
    #[must_use]
    pub fn at(&self) -> Option<[i32; CHANNELS]> {
        self.parts.map(|parts| parts.map(|parts| (parts >> PARTS_SHIFT) as i32))
    }

    /// Takes counts of an untouched pad, of which `rate_hz` come in a second. `None` breaks off what was begun: something touches, or no
    /// count can be trusted.
    pub fn see(&mut self, counts: Option<&[i32; CHANNELS]>, rate_hz: u16) {
        let Some(counts) = counts else {
            (self.sums, self.samples, self.tenths) = ([0; CHANNELS], 0, 0);
            return;
        };
        for (sum, count) in self.sums.iter_mut().zip(counts) {
            *sum += i64::from(*count);
        }
        self.samples += 1;
        if self.samples >= rate_hz / 10 {
            let means = self.sums.map(|sum| sum / i64::from(self.samples));
            (self.sums, self.samples) = ([0; CHANNELS], 0);
            match &mut self.parts {
                Some(parts) => follow(parts, &means),
                None => self.lie_still(means),
            }
        }
    }

    fn lie_still(&mut self, means: [i64; CHANNELS]) {
        let agrees = means.iter().zip(&self.first).all(|(mean, first)| (mean - first).abs() <= STILL_COUNTS);
        if self.tenths == 0 || !agrees {
            (self.first, self.agreed, self.tenths) = (means, means, 1);
            return;
        }
        for (agreed, mean) in self.agreed.iter_mut().zip(means) {
            *agreed += mean;
        }
        self.tenths += 1;
        if self.tenths >= STILL_TENTHS {
            self.parts = Some(self.agreed.map(|sum| (sum << PARTS_SHIFT) / self.tenths));
        }
    }
}

fn follow(parts: &mut [i64; CHANNELS], means: &[i64; CHANNELS]) {
    for (parts, mean) in parts.iter_mut().zip(means) {
        *parts += ((mean << PARTS_SHIFT) - *parts) >> FOLLOW_SHIFT;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: u16 = 1_000;

    fn see(zero: &mut Zero, count: i32, samples: u32) {
        for _ in 0..samples {
            zero.see(Some(&[count; CHANNELS]), RATE_HZ);
        }
    }

    #[test]
    fn it_is_taken_once_the_pad_has_lain_still() {
        let mut zero = Zero::default();
        see(&mut zero, 50_000, 299);
        assert_eq!(zero.at(), None);
        see(&mut zero, 50_000, 1);
        assert_eq!(zero.at(), Some([50_000; CHANNELS]));
    }

    #[test]
    fn a_pad_that_is_moved_or_touched_begins_anew() {
        let mut zero = Zero::default();
        see(&mut zero, 0, 200);
        see(&mut zero, 3_000, 250);
        assert_eq!(zero.at(), None, "three tenths, and two agree");
        zero.see(None, RATE_HZ);
        see(&mut zero, 3_000, 299);
        assert_eq!(zero.at(), None);
        see(&mut zero, 3_000, 1);
        assert_eq!(zero.at(), Some([3_000; CHANNELS]));
    }

    #[test]
    fn it_follows_a_slow_drift_and_no_touch() {
        let mut zero = Zero::default();
        see(&mut zero, 0, 300);
        see(&mut zero, 1_000, 10_000);
        let at = zero.at().unwrap()[0];
        assert!((990..=1_000).contains(&at), "{at}");
        for _ in 0..10_000 {
            zero.see(None, RATE_HZ);
        }
        assert_eq!(zero.at().unwrap()[0], at);
    }
}
