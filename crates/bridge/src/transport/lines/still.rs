//! Cells that print the same number line after line, while others do not: an amplifier that repeats what it read last.

use firmware_proto::channels::FEW_CHANNELS_MAX;

/// A cell that has printed the same number in so many lines stands still.
const STILL_LINES: u32 = u32::BITS;

/// A cell is lively if its number changes in so many of them: then chance brings [`STILL_LINES`] alike once in 2^32.
const LIVELY_LINES: u32 = STILL_LINES / 2;

/// Which cells are lively is learnt in so many first lines, when nothing lies on the board: under a hand also coarse cells tremble.
const LEARNT_LINES: u32 = 2 * STILL_LINES;

/// Watches the numbers of one line after the other.
#[derive(Clone, Debug, Default)]
pub(super) struct StillCells {
    last: Option<[i32; FEW_CHANNELS_MAX]>,
    /// One bit for each of the last lines, set where the number was another than before.
    changed: [u32; FEW_CHANNELS_MAX],
    /// Lines so far, up to [`LEARNT_LINES`].
    lines: u32,
    /// Whether a cell was lively while that was learnt.
    was_lively: [bool; FEW_CHANNELS_MAX],
}

impl StillCells {
    /// Takes the numbers of a line; whether each of the first `cells` stands still. One that never was lively does not count: it may print
    /// coarsely.
    pub(super) fn see(&mut self, counts: &[i32; FEW_CHANNELS_MAX], cells: usize) -> [bool; FEW_CHANNELS_MAX] {
        let last = self.last.replace(*counts).unwrap_or(*counts);
        for (changed, (count, last)) in self.changed.iter_mut().zip(counts.iter().zip(&last)) {
            *changed = *changed << 1 | u32::from(count != last);
        }
        let is_lively = self.changed.map(|changed| changed.count_ones() >= LIVELY_LINES);
        if self.lines < LEARNT_LINES {
            self.lines += 1;
            self.was_lively.iter_mut().zip(is_lively).for_each(|(was, is)| *was |= is);
        }
        let lively = is_lively.iter().take(cells).filter(|is_lively| **is_lively).count();
        std::array::from_fn(|k| k < cells && self.changed[k] == 0 && self.was_lively[k] && 2 * lively > cells)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// After how many lines of a lively board whose third cell stands that is told; its neighbours print like this.
    fn told_after(noise: impl Fn(i32) -> i32, was_lively: bool) -> Option<i32> {
        let mut cells = StillCells::default();
        let line = |k: i32, third| [noise(k), 7 + noise(k), third, noise(k + 1), 0, 0, 0, 0];
        (0..100).for_each(|k| assert_eq!(cells.see(&line(k, if was_lively { k } else { 5 }), 4), [false; 8]));
        (0..100).find(|k| cells.see(&line(*k, 5), 4)[2])
    }

    #[test]
    fn a_cell_that_stands_among_lively_ones_is_told_and_coarse_or_calm_ones_are_not() {
        assert_eq!(told_after(|k| k % 11, true), Some(32));
        assert_eq!(told_after(|k| k % 11, false), None, "it was never lively");
        assert_eq!(told_after(|_| 3, true), None, "nothing moves");
        // Whole grams, and a hand on one corner that makes three cells tremble.
        let mut coarse = StillCells::default();
        (0..100).for_each(|_| assert_eq!(coarse.see(&[0; 8], 4), [false; 8]));
        for k in 0..200 {
            let hand = [40 + k % 3, 300 + k % 7, 20 + k % 2, if k < 50 { k % 2 } else { 2 }, 0, 0, 0, 0];
            assert_eq!(coarse.see(&hand, 4), [false; 8]);
        }
    }
}
