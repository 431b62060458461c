//! Frames that wait for the serial line.

use firmware_proto::ENCODED_MAX;

/// Frames of the longest kind that may wait: two milliseconds at the fastest rate.
const FRAMES: usize = 8;

/// Bytes that may wait.
const LEN: usize = FRAMES * ENCODED_MAX;

/// A queue of whole frames: one goes in whole or not at all, so a line that is not read loses samples and damages none.
#[derive(Debug)]
pub struct Outbox {
    bytes: [u8; LEN],
    len: usize,
}

impl Default for Outbox {
    fn default() -> Self {
        Self { bytes: [0; LEN], len: 0 }
    }
}

impl Outbox {
    /// Puts a frame behind those that wait; says whether there was room.
    pub fn post(&mut self, frame: &[u8]) -> bool {
        let Some(room) = self.bytes.get_mut(self.len..self.len + frame.len()) else { return false };
        room.copy_from_slice(frame);
        self.len += frame.len();
        true
    }

    /// What waits.
    #[must_use]
    pub fn waiting(&self) -> &[u8] {
        &self.bytes[..self.len]
    }

    /// Takes the first `count` bytes off; more than wait are all.
    pub fn sent(&mut self, count: usize) {
        let count = count.min(self.len);
        self.bytes.copy_within(count..self.len, 0);
        self.len -= count;
    }

    /// Forgets all that waits.
    pub fn clear(&mut self) {
        self.len = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_go_in_whole_and_come_out_in_pieces() {
        let mut outbox = Outbox::default();
        for number in 0..8 {
            assert!(outbox.post(&[number; ENCODED_MAX]));
        }
        assert!(!outbox.post(&[9]), "full");
        outbox.sent(100);
        assert_eq!((outbox.waiting().len(), outbox.waiting()[0], outbox.waiting()[20]), (LEN - 100, 1, 2));
        assert!(!outbox.post(&[9; 101]), "not even in part");
        assert!(outbox.post(&[9; 100]));
        outbox.sent(LEN + 1);
        assert!(outbox.waiting().is_empty());
    }
}
