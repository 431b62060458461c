//! One sample of a pad that has one to eight channels instead of nine.

use crate::cursor::{Reader, Writer};
use crate::sample::Status;

/// The most channels of a [`ChannelSample`]; nine are a [`Sample`](crate::sample::Sample).
pub const FEW_CHANNELS_MAX: usize = 8;

/// One conversion of one to eight channels, whatever they measure. The README tells its place in the payload byte by byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChannelSample {
    /// One more than the sample before; after `u32::MAX` comes 0. A gap counts the samples lost on the way.
    pub sequence: u32,
    /// Microseconds of the pad's own clock, counted from its start, at the end of the conversion.
    pub time_us: u64,
    /// Temperature of the pad's board in hundredths of a degree Celsius; void if the status says so.
    pub temperature_centi_c: i16,
    status: Status,
    channels: u8,
    counts: [i32; FEW_CHANNELS_MAX],
}

impl ChannelSample {
    /// The kind byte.
    pub const KIND: u8 = 0x04;

    /// Bytes of the payload with `channels` channels.
    #[must_use]
    pub const fn payload_len(channels: usize) -> usize {
        4 + 8 + 1 + 1 + 2 + 2 + 4 * channels
    }

    /// A sample of these counts at `time_us`, its temperature void; `None` for none, or more than [`FEW_CHANNELS_MAX`]. Status bits
    /// of channels that it does not have are not set.
    #[must_use]
    pub fn new(sequence: u32, time_us: u64, counts: &[i32], status: Status) -> Option<Self> {
        let mut all = [0; FEW_CHANNELS_MAX];
        all.get_mut(..counts.len())?.copy_from_slice(counts);
        let channels = u8::try_from(counts.len()).ok().filter(|channels| *channels > 0)?;
        let status = status.with_temperature_invalid().of_channels(channels);
        Some(Self { sequence, time_us, temperature_centi_c: 0, status, channels, counts: all })
    }

    /// The same with the temperature of the pad's board, in hundredths of a degree Celsius.
    #[must_use]
    pub const fn with_temperature(self, temperature_centi_c: i16) -> Self {
        Self { temperature_centi_c, status: self.status.with_temperature_valid(), ..self }
    }

    /// What the converters read, one count for each channel. What a count is worth the host knows from elsewhere.
    #[must_use]
    pub fn counts(&self) -> &[i32] {
        self.counts.get(..usize::from(self.channels)).unwrap_or_default()
    }

    /// What the pad knows to be wrong with this sample.
    #[must_use]
    pub const fn status(&self) -> Status {
        self.status
    }

    pub(crate) fn write(&self, out: &mut Writer) {
        out.put(&self.sequence.to_le_bytes());
        out.put(&self.time_us.to_le_bytes());
        out.put(&[self.channels, 0]);
        out.put(&self.temperature_centi_c.to_le_bytes());
        out.put(&self.status.0.to_le_bytes());
        for count in self.counts() {
            out.put(&count.to_le_bytes());
        }
    }

    pub(crate) fn read(payload: &mut Reader) -> Option<Self> {
        let sequence = payload.u32()?;
        let time_us = payload.u64()?;
        let channels =
            payload.u8().filter(|channels| (1..=FEW_CHANNELS_MAX).contains(&usize::from(*channels)))?;
        let _ = payload.u8()?;
        let temperature_centi_c = payload.i16()?;
        let status = Status(payload.u16()?).of_channels(channels);
        let mut counts = [0; FEW_CHANNELS_MAX];
        for count in counts.iter_mut().take(usize::from(channels)) {
            *count = payload.i32()?;
        }
        Some(Self { sequence, time_us, temperature_centi_c, status, channels, counts })
    }
}

const _: () = assert!(ChannelSample::payload_len(FEW_CHANNELS_MAX) == 50);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_one_to_eight_channels() {
        let made = |count| {
            ChannelSample::new(0, 0, &[7; 9][..count], Status::OK).map(|sample| sample.counts().len())
        };
        assert_eq!([0, 1, 4, 8, 9].map(made), [None, Some(1), Some(4), Some(8), None]);
        let mut bytes = [0; 50];
        for channels in [0, 9, 255] {
            bytes[12] = channels;
            assert_eq!(ChannelSample::read(&mut Reader::new(&bytes)), None, "{channels}");
        }
    }

    #[test]
    fn bits_of_channels_that_are_not_there_are_neither_sent_nor_read() {
        let sample = ChannelSample::new(0, 0, &[1, 2, 3, 4], Status(u16::MAX)).unwrap();
        assert_eq!(sample.status(), Status(0x0E0F));
        let mut bytes = [0; 50];
        let mut out = Writer::new(&mut bytes);
        sample.write(&mut out);
        let len = out.len();
        assert_eq!((len, [bytes[16], bytes[17]]), (34, [0x0F, 0x0E]));
        (bytes[16], bytes[17]) = (0xFF, 0xFF);
        assert_eq!(ChannelSample::read(&mut Reader::new(&bytes[..len])), Some(sample));
    }

    #[test]
    fn the_temperature_is_void_unless_it_is_told() {
        let sample = ChannelSample::new(0, 0, &[1], Status::OK).unwrap();
        assert!(sample.status().temperature_invalid());
        assert!(!sample.with_temperature(2_150).status().temperature_invalid());
    }
}
