//! The newest of a long row of things, each of which has its number, so that several readers can go on where they were.

use std::collections::VecDeque;

/// The newest so many things of a row.
#[derive(Clone, Debug)]
pub(super) struct Ring<T> {
    kept: VecDeque<T>,
    max: usize,
    /// How many there were before those that are kept.
    gone: u64,
}

impl<T> Ring<T> {
    /// One that keeps at most so many.
    pub(super) const fn new(max: usize) -> Self {
        Self { kept: VecDeque::new(), max, gone: 0 }
    }

    /// Adds one.
    pub(super) fn push(&mut self, thing: T) {
        if self.kept.len() == self.max {
            self.kept.pop_front();
            self.gone += 1;
        }
        self.kept.push_back(thing);
    }

    /// How many there were in all: where a reader who wants only what comes now begins.
    pub(super) fn end(&self) -> u64 {
        self.gone + self.kept.len() as u64
    }

    /// Those from `begin` on that are kept, and how many of them are not.
    pub(super) fn since(&self, begin: u64) -> (impl Iterator<Item = &T>, u64) {
        let skipped = begin.saturating_sub(self.gone);
        let missed = self.gone.saturating_sub(begin);
        (self.kept.iter().skip(usize::try_from(skipped).unwrap_or(usize::MAX)), missed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readers_go_on_where_they_were_and_hear_what_they_missed() {
        let mut ring = Ring::new(3);
        let read = |ring: &Ring<u8>, begin| {
            let (kept, missed) = ring.since(begin);
            (kept.copied().collect::<Vec<_>>(), missed)
        };
        assert_eq!(read(&ring, 0), (vec![], 0));
        (1..=2).for_each(|it| ring.push(it));
        assert_eq!((read(&ring, 1), ring.end()), ((vec![2], 0), 2));
        (3..=6).for_each(|it| ring.push(it));
        assert_eq!((read(&ring, 2), ring.end()), ((vec![4, 5, 6], 1), 6));
        assert_eq!(read(&ring, 6), (vec![], 0));
    }
}
