//! Who the pad is and what its counts are worth.

use crate::cursor::{Reader, Writer};

/// A pad's answer to `identify`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Tells this pad from its siblings.
    pub serial_number: SerialNumber,
    /// Number of channels: [`CHANNELS`](crate::CHANNELS), or 1 to 8 of a pad that has fewer, or 0 of one that decodes on
    /// its own. It is passed on unchecked, so that a host can say what it refuses.
    pub channels: u8,
    /// Bits of a count, 24 to 32: codes run from -(2^(bits-1)) to 2^(bits-1) - 1. Passed on unchecked.
    pub count_bits: u8,
    /// Samples per second that the pad sends now.
    pub rate_hz: u16,
    /// Picovolts at the bridge per count, the amplifier's gain taken out. Passed on unchecked.
    pub picovolts_per_count: u32,
}

impl Identity {
    /// The kind byte of an identity.
    pub const KIND: u8 = 0x02;

    /// Bytes of the payload.
    pub const PAYLOAD_LEN: usize = SerialNumber::LEN + 1 + 1 + 2 + 4;

    pub(crate) fn write(&self, out: &mut Writer) {
        out.put(&self.serial_number.0);
        out.put(&[self.channels, self.count_bits]);
        out.put(&self.rate_hz.to_le_bytes());
        out.put(&self.picovolts_per_count.to_le_bytes());
    }

    pub(crate) fn read(payload: &mut Reader) -> Option<Self> {
        Some(Self {
            serial_number: SerialNumber::from_wire(payload.take()?),
            channels: payload.u8()?,
            count_bits: payload.u8()?,
            rate_hz: payload.u16()?,
            picovolts_per_count: payload.u32()?,
        })
    }
}

const _: () = assert!(Identity::PAYLOAD_LEN == 24);

/// Up to sixteen visible ASCII characters (`!` to `~`, no space); none if the pad has no serial number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SerialNumber([u8; Self::LEN]);

impl SerialNumber {
    /// Bytes on the wire; shorter numbers are filled up with zeros.
    pub const LEN: usize = 16;

    /// The serial number `text`; `None` if it is too long or holds anything but visible ASCII.
    #[must_use]
    pub fn from_ascii(text: &str) -> Option<Self> {
        if text.len() > Self::LEN || !text.bytes().all(|byte| byte.is_ascii_graphic()) {
            return None;
        }
        let mut bytes = [0; Self::LEN];
        Writer::new(&mut bytes).put(text.as_bytes());
        Some(Self(bytes))
    }

    /// The characters; empty if the pad has no serial number.
    #[must_use]
    pub fn as_str(&self) -> &str {
        let characters = self.0.split(|byte| *byte == 0).next().unwrap_or_default();
        // It cannot fail: both constructors let only ASCII in.
        core::str::from_utf8(characters).unwrap_or_default()
    }

    /// A pad with odd bytes in its serial number still has a scale that the host needs: what follows the
    /// first zero is dropped, and what is not visible ASCII becomes `?`.
    fn from_wire(wire: [u8; Self::LEN]) -> Self {
        let mut bytes = [0; Self::LEN];
        for (slot, byte) in bytes.iter_mut().zip(wire.into_iter().take_while(|byte| *byte != 0)) {
            *slot = if byte.is_ascii_graphic() { byte } else { b'?' };
        }
        Self(bytes)
    }
}

impl core::fmt::Display for SerialNumber {
    fn fmt(&self, f: &mut core::fmt::Formatter) -> core::fmt::Result {
        f.pad(self.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_serial_number_is_up_to_sixteen_visible_characters() {
        for text in ["", "7", "TP-0042", "0123456789abcdef", "!~"] {
            assert_eq!(SerialNumber::from_ascii(text).unwrap().as_str(), text);
        }
        for text in ["0123456789abcdefg", "a b", "a\0b", "é", "a\n", "\x7f"] {
            assert_eq!(SerialNumber::from_ascii(text), None, "{text:?}");
        }
    }

    #[test]
    fn odd_bytes_from_the_wire_become_readable() {
        let number = SerialNumber::from_wire(*b"A\xFFB C\0junk\0\0\0\0\0\0");
        assert_eq!(number.as_str(), "A?B?C");
        assert_eq!(SerialNumber::from_wire([0xFF; 16]).as_str(), "????????????????");
        assert_eq!(SerialNumber::from_wire([0; 16]).as_str(), "");
        assert_eq!(SerialNumber::from_ascii("A?B?C"), Some(number));
    }
}
