//! What is wrong with lines of text as a whole: one stretch of time after the other is looked at.

use tactpad_core::pipeline::line_check::LineFinding;

/// Each look takes so long, µs.
const LOOK_US: u64 = 900_000;

/// Fewer bad lines in a look are not worth a word, if others are sound.
const BAD_MIN: u32 = 3;

/// What was found is taken back after so many looks without it.
const CLEAN_LOOKS: u8 = 3;

/// What a line is, if it is not all numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LineOutcome {
    /// It has too few numbers, or none.
    NotNumbers,
    /// It is longer than any line of numbers.
    TooLong,
    /// One cell prints the same number all the time while others do not.
    Stands {
        /// Its index.
        channel: usize,
    },
    /// One cell has no number.
    NoNumber {
        /// Its index.
        channel: usize,
    },
}

/// Looks at lines.
#[derive(Clone, Debug, Default)]
pub(super) struct LineLook {
    begun_us: Option<u64>,
    sound: u32,
    bad: u32,
    /// The first that was wrong in this look.
    first: Option<LineOutcome>,
    finding: Option<LineFinding>,
    clean: u8,
}

impl LineLook {
    /// Takes a line that came by `now_us`, with what is wrong with it.
    pub(super) fn line(&mut self, now_us: u64, wrong: Option<LineOutcome>) {
        let begun_us = *self.begun_us.get_or_insert(now_us);
        match wrong {
            None => self.sound += 1,
            Some(_) => self.bad += 1,
        }
        self.first = self.first.or(wrong);
        if now_us.saturating_sub(begun_us) >= LOOK_US {
            self.close();
        }
    }

    /// What is wrong, if anything is.
    pub(super) const fn finding(&self) -> Option<&LineFinding> {
        self.finding.as_ref()
    }

    fn close(&mut self) {
        let is_wrong = self.bad >= BAD_MIN || self.sound == 0 && self.bad > 0;
        self.clean = if self.bad > 0 { 0 } else { self.clean.saturating_add(1) };
        if let Some(first) = self.first.filter(|_| is_wrong) {
            self.finding = Some(match first {
                LineOutcome::NotNumbers => LineFinding::NotNumbers,
                LineOutcome::TooLong => LineFinding::LineTooLong,
                LineOutcome::Stands { channel } => LineFinding::CellStands { channel },
                LineOutcome::NoNumber { channel } => LineFinding::NoNumber { channel },
            });
        } else if self.clean >= CLEAN_LOOKS {
            self.finding = None;
        }
        (self.begun_us, self.sound, self.bad, self.first) = (None, 0, 0, None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_bad_line_among_many_is_not_told_and_what_lasts_is_and_is_taken_back() {
        let mut look = LineLook::default();
        let mut second = |from_s: u64, wrong: &dyn Fn(u64) -> Option<LineOutcome>| {
            (0..20).for_each(|k| look.line(from_s * 1_000_000 + k * 50_000, wrong(k)));
            look.finding().copied()
        };
        assert_eq!(second(0, &|k| (k == 3).then_some(LineOutcome::NotNumbers)), None);
        assert_eq!(second(1, &|_| Some(LineOutcome::TooLong)), Some(LineFinding::LineTooLong));
        assert_eq!(second(2, &|_| None), Some(LineFinding::LineTooLong), "it may come again");
        assert_eq!((3..6).map(|s| second(s, &|_| None)).last(), Some(None));
        let dead = |k| (k > 4).then_some(LineOutcome::NoNumber { channel: 2 });
        assert_eq!(second(7, &dead), Some(LineFinding::NoNumber { channel: 2 }));
    }
}
