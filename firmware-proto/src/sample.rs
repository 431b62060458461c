//! One sample: nine counts with the pad's own time and state.

use crate::CHANNELS;
use crate::cursor::{Reader, Writer};

/// One conversion of all nine channels. The README tells its place in the payload byte by byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// One more than the sample before; after `u32::MAX` comes 0. A gap counts the samples lost on the way.
    pub sequence: u32,
    /// Microseconds of the pad's own clock, counted from its start, at the end of the conversion.
    pub time_us: u64,
    /// What the converter read, in the order m0x, m0y, m0z, m1x … m2z. A count times the identity's picovolts
    /// per count times 1e-6 is microvolts at the bridge.
    pub counts: [i32; CHANNELS],
    /// Temperature of the pad's board in hundredths of a degree Celsius; void if the status says so.
    pub temperature_centi_c: i16,
    /// What the pad knows to be wrong with this sample.
    pub status: Status,
}

impl Sample {
    /// The kind byte of a sample.
    pub const KIND: u8 = 0x01;

    /// Bytes of the payload.
    pub const PAYLOAD_LEN: usize = 4 + 8 + 4 * CHANNELS + 2 + 2;

    pub(crate) fn write(&self, out: &mut Writer) {
        out.put(&self.sequence.to_le_bytes());
        out.put(&self.time_us.to_le_bytes());
        for count in self.counts {
            out.put(&count.to_le_bytes());
        }
        out.put(&self.temperature_centi_c.to_le_bytes());
        out.put(&self.status.defined().0.to_le_bytes());
    }

    pub(crate) fn read(payload: &mut Reader) -> Option<Self> {
        let sequence = payload.u32()?;
        let time_us = payload.u64()?;
        let mut counts = [0; CHANNELS];
        for count in &mut counts {
            *count = payload.i32()?;
        }
        let temperature_centi_c = payload.i16()?;
        let status = Status(payload.u16()?).defined();
        Some(Self { sequence, time_us, counts, temperature_centi_c, status })
    }
}

const _: () = assert!(Sample::PAYLOAD_LEN == 52);

/// What the pad knows to be wrong with a sample, one bit each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Status(
    /// Bits 0–8: channel out of range; 9: temperature invalid; 10: first sample after a restart; 11: supply
    /// fault. Bits 12–15 mean nothing yet: they are sent as zero and read as zero.
    pub u16,
);

impl Status {
    /// Nothing is wrong.
    pub const OK: Self = Self(0);

    const TEMPERATURE_INVALID: u16 = 1 << 9;
    const RESTARTED: u16 = 1 << 10;
    const SUPPLY_FAULT: u16 = 1 << 11;
    const DEFINED: u16 = 0x0FFF;

    const fn defined(self) -> Self {
        Self(self.0 & Self::DEFINED)
    }

    /// What it says of a pad with so many channels.
    pub(crate) const fn of_channels(self, channels: u8) -> Self {
        let channel_bits = if (channels as usize) < CHANNELS { (1 << channels) - 1 } else { 0x01FF };
        Self(
            self.defined().0
                & (Self::TEMPERATURE_INVALID | Self::RESTARTED | Self::SUPPLY_FAULT | channel_bits),
        )
    }

    /// What it says of the pad as a whole: that it began anew, or that nothing can be trusted.
    pub(crate) const fn of_whole_pad(self) -> Self {
        Self(self.0 & (Self::RESTARTED | Self::SUPPLY_FAULT))
    }

    pub(crate) const fn with_temperature_valid(self) -> Self {
        Self(self.0 & !Self::TEMPERATURE_INVALID)
    }

    /// Whether channel `channel` (0 to 8, in wire order) is out of its converter's range or its bridge is
    /// open, so that its count means nothing. There is no channel from 9 on, so that is `false`.
    #[must_use]
    pub const fn is_out_of_range(self, channel: usize) -> bool {
        channel < CHANNELS && self.0 >> channel & 1 == 1
    }

    /// Whether the board temperature means nothing.
    #[must_use]
    pub const fn temperature_invalid(self) -> bool {
        self.0 & Self::TEMPERATURE_INVALID != 0
    }

    /// Whether this is the first sample after the pad started or restarted: sequence and time begin anew.
    #[must_use]
    pub const fn restarted(self) -> bool {
        self.0 & Self::RESTARTED != 0
    }

    /// Whether the excitation or the converter's reference is out of tolerance, so that no count can be
    /// trusted.
    #[must_use]
    pub const fn supply_fault(self) -> bool {
        self.0 & Self::SUPPLY_FAULT != 0
    }

    /// This status with channel `channel` out of range; unchanged if there is no such channel.
    #[must_use]
    pub const fn with_out_of_range(self, channel: usize) -> Self {
        if channel < CHANNELS { Self(self.0 | 1 << channel) } else { self }
    }

    /// This status with the temperature invalid.
    #[must_use]
    pub const fn with_temperature_invalid(self) -> Self {
        Self(self.0 | Self::TEMPERATURE_INVALID)
    }

    /// This status with the mark of the first sample after a restart.
    #[must_use]
    pub const fn with_restarted(self) -> Self {
        Self(self.0 | Self::RESTARTED)
    }

    /// This status with a supply fault.
    #[must_use]
    pub const fn with_supply_fault(self) -> Self {
        Self(self.0 | Self::SUPPLY_FAULT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a status says, in the order of its bits.
    fn said(status: Status) -> [bool; 12] {
        core::array::from_fn(|bit| match bit {
            9 => status.temperature_invalid(),
            10 => status.restarted(),
            11 => status.supply_fault(),
            channel => status.is_out_of_range(channel),
        })
    }

    #[test]
    fn each_bit_says_one_thing() {
        assert_eq!(said(Status::OK), [false; 12]);
        for bit in 0..12 {
            assert_eq!(said(Status(1 << bit)), core::array::from_fn(|i| i == bit), "bit {bit}");
        }
    }

    #[test]
    fn setters_set_the_bit_that_is_read() {
        for channel in 0..CHANNELS {
            assert_eq!(Status::OK.with_out_of_range(channel), Status(1 << channel));
        }
        assert_eq!(Status::OK.with_temperature_invalid(), Status(0x0200));
        assert_eq!(Status::OK.with_restarted(), Status(0x0400));
        assert_eq!(Status::OK.with_supply_fault(), Status(0x0800));
        let all = (0..CHANNELS).fold(Status::OK, Status::with_out_of_range);
        let all = all.with_temperature_invalid().with_restarted().with_supply_fault();
        assert_eq!(all, Status(0x0FFF));
    }

    #[test]
    fn channels_that_are_not_there_are_never_out_of_range() {
        for channel in [CHANNELS, 10, 15, 16, 64, usize::MAX] {
            assert!(!Status(u16::MAX).is_out_of_range(channel));
            assert_eq!(Status::OK.with_out_of_range(channel), Status::OK);
        }
    }

    #[test]
    fn undefined_bits_are_neither_sent_nor_read() {
        let sample = Sample {
            sequence: 0,
            time_us: 0,
            counts: [0; CHANNELS],
            temperature_centi_c: 0,
            status: Status(u16::MAX),
        };
        let mut bytes = [0; Sample::PAYLOAD_LEN];
        let mut out = Writer::new(&mut bytes);
        sample.write(&mut out);
        assert_eq!(bytes[50..], [0xFF, 0x0F]);
        bytes[51] = 0xFF;
        let read = Sample::read(&mut Reader::new(&bytes)).unwrap();
        assert_eq!(read.status, Status(0x0FFF));
    }
}
