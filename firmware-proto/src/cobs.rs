//! Consistent overhead byte stuffing: rewrites a frame without zero bytes, so that a zero can mark its end.
//!
//! Source: S. Cheshire, M. Baker, "Consistent Overhead Byte Stuffing", IEEE/ACM Transactions on Networking
//! 7(2), 1999. No frame of this protocol is longer than [`UNSTUFFED_MAX`] bytes, so the method's one special
//! case, a run of 254 bytes without a zero, never arises.

use crate::cursor::Writer;

/// The longest frame before stuffing. One byte more could be a run that needs a second extra byte.
pub(crate) const UNSTUFFED_MAX: usize = 253;

/// Bytes that stuffing adds to a frame, whatever it holds.
pub(crate) const OVERHEAD: usize = 1;

/// Appends `frame`, of at most [`UNSTUFFED_MAX`] bytes, stuffed and without the closing zero.
///
/// Each run between zeros is written as its length plus one, then its bytes; the zeros go away.
pub(crate) fn stuff(frame: &[u8], out: &mut Writer) {
    for run in frame.split(|byte| *byte == 0) {
        let code = u8::try_from(run.len() + 1).unwrap_or(u8::MAX);
        out.put(&[code]);
        out.put(run);
    }
}

/// Undoes [`stuff`] byte by byte. It never sees the closing zero.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Unstuffer {
    /// Nothing came yet.
    Start,
    /// Inside a run: this many of its bytes are still to come, and if any byte follows them, a zero goes
    /// before it.
    Run { left: u8 },
}

impl Unstuffer {
    /// Takes one byte that is not zero; yields the frame's next byte if that decides one.
    pub(crate) const fn feed(&mut self, byte: u8) -> Option<u8> {
        match *self {
            // The first code: no zero stands before the first run.
            Self::Start => {
                *self = Self::Run { left: byte.saturating_sub(1) };
                None
            }
            // The next code: the run before it ended in a zero after all.
            Self::Run { left: 0 } => {
                *self = Self::Run { left: byte.saturating_sub(1) };
                Some(0)
            }
            Self::Run { left } => {
                *self = Self::Run { left: left.saturating_sub(1) };
                Some(byte)
            }
        }
    }

    /// Whether a frame may end here: something came, and no run is cut short.
    pub(crate) const fn may_end(self) -> bool {
        matches!(self, Self::Run { left: 0 })
    }

    /// Whether nothing came yet.
    pub(crate) const fn is_at_start(self) -> bool {
        matches!(self, Self::Start)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::*;

    fn stuffed(frame: &[u8]) -> Vec<u8> {
        let mut bytes = [0; UNSTUFFED_MAX + OVERHEAD];
        let mut out = Writer::new(&mut bytes);
        stuff(frame, &mut out);
        out.written().to_vec()
    }

    fn unstuffed(bytes: &[u8]) -> Option<Vec<u8>> {
        let mut unstuffer = Unstuffer::Start;
        let frame = bytes.iter().filter_map(|byte| unstuffer.feed(*byte)).collect();
        unstuffer.may_end().then_some(frame)
    }

    #[test]
    fn examples_of_the_method() {
        assert_eq!(stuffed(&[]), [1]);
        assert_eq!(stuffed(&[0]), [1, 1]);
        assert_eq!(stuffed(&[0, 0]), [1, 1, 1]);
        assert_eq!(stuffed(&[0x11, 0x22, 0, 0x33]), [3, 0x11, 0x22, 2, 0x33]);
        assert_eq!(stuffed(&[0x11, 0, 0, 0]), [2, 0x11, 1, 1, 1]);
    }

    #[test]
    fn worst_cases_cost_one_byte_and_hold_no_zero() {
        let mut late_zero = [7; UNSTUFFED_MAX];
        late_zero[UNSTUFFED_MAX - 1] = 0;
        for frame in [[0; UNSTUFFED_MAX], [7; UNSTUFFED_MAX], [0xFF; UNSTUFFED_MAX], late_zero] {
            for len in 0..=frame.len() {
                let stuffed = stuffed(&frame[..len]);
                assert_eq!(stuffed.len(), len + OVERHEAD);
                assert!(!stuffed.contains(&0));
                assert_eq!(unstuffed(&stuffed).as_deref(), Some(&frame[..len]));
            }
        }
    }

    #[test]
    fn a_run_cut_short_is_no_frame() {
        assert_eq!(unstuffed(&[]), None);
        assert_eq!(unstuffed(&[2]), None);
        assert_eq!(unstuffed(&[4, 1, 2]), None);
        assert_eq!(unstuffed(&[1, 3, 9]), None);
    }
}
