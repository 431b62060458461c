//! From the converters' frames to counts, and what can be told to be wrong with them.

use ads131m0x::config::CODE_MAX;
use ads131m0x::frame::{Frame, Status as Answer, frame_len};
use firmware_proto::CHANNELS;
use firmware_proto::sample::Status;

use crate::{CHANNELS_EACH, CONVERTERS};

/// Bytes of a converter's frame.
pub const FRAME_LEN: usize = frame_len(CHANNELS_EACH);

/// One frame of each converter.
pub type Frames = [[u8; FRAME_LEN]; CONVERTERS];

/// A code as near as this to either end of the range is out of range: an open bridge goes to the end, and the last parts are not
/// linear.
const MARGIN: i32 = CODE_MAX / 256;

/// What the frames say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Codes {
    /// Codes of all channels in the wire's order; of a converter that cannot be trusted, its last ones.
    pub codes: [i32; CHANNELS],
    /// Channels that cannot be trusted.
    pub status: Status,
    /// Whether a converter is not set to what it was, or out of step: it has to be begun anew.
    pub restart: bool,
}

/// Reads frames of the converters, and remembers what each channel had last.
#[derive(Clone, Copy, Debug, Default)]
pub struct FrameReader {
    last: [i32; CHANNELS],
}

impl FrameReader {
    /// What these frames say. A frame with a wrong checksum, one without new codes, and one of a converter that was reset say nothing
    /// of its channels.
    pub fn read(&mut self, frames: &Frames) -> Codes {
        let (mut status, mut restart) = (Status::OK, false);
        for (converter, bytes) in frames.iter().enumerate() {
            let channels = converter * CHANNELS_EACH..(converter + 1) * CHANNELS_EACH;
            let frame = Frame::<CHANNELS_EACH>::read(bytes);
            let answer = frame.map(|frame| Answer(frame.answer));
            let lost = answer.is_some_and(|it| it.was_reset() || !it.all_new(CHANNELS_EACH));
            restart |= lost;
            match frame.filter(|_| !lost) {
                Some(frame) => {
                    for (channel, code) in channels.zip(frame.codes) {
                        self.last[channel] = code;
                        if code.abs() >= CODE_MAX - MARGIN {
                            status = status.with_out_of_range(channel);
                        }
                    }
                }
                None => status = channels.fold(status, Status::with_out_of_range),
            }
        }
        Codes { codes: self.last, status, restart }
    }

    /// What is told while no frames come.
    #[must_use]
    pub fn silence(&self) -> Codes {
        let status = (0..CHANNELS).fold(Status::OK, Status::with_out_of_range);
        Codes { codes: self.last, status, restart: true }
    }
}

#[cfg(test)]
mod tests {
    use ads131m0x::frame::crc16;

    use super::*;

    /// The status word of good frames: words of 24 bits, three new codes.
    const GOOD: u16 = 0x0107;

    fn frame(answer: u16, codes: [i32; 3]) -> [u8; FRAME_LEN] {
        let mut bytes = [0; FRAME_LEN];
        bytes[..2].copy_from_slice(&answer.to_be_bytes());
        for (word, code) in bytes[3..12].chunks_exact_mut(3).zip(codes) {
            word.copy_from_slice(&code.to_be_bytes()[1..]);
        }
        let checksum = crc16(&bytes[..12]).to_be_bytes();
        bytes[12..14].copy_from_slice(&checksum);
        bytes
    }

    fn good() -> Frames {
        [frame(GOOD, [1, -2, 3]), frame(GOOD, [4, 5, -6]), frame(GOOD, [7, 8, 9])]
    }

    #[test]
    fn good_frames_are_nine_codes() {
        let said = FrameReader::default().read(&good());
        assert_eq!(said, Codes { codes: [1, -2, 3, 4, 5, -6, 7, 8, 9], status: Status::OK, restart: false });
    }

    #[test]
    fn a_damaged_frame_keeps_its_channels_last_codes_and_says_so() {
        let mut reader = FrameReader::default();
        reader.read(&good());
        let mut frames = [frame(GOOD, [10, 10, 10]); 3];
        frames[1][5] ^= 1;
        let said = reader.read(&frames);
        assert_eq!(said.codes, [10, 10, 10, 4, 5, -6, 10, 10, 10]);
        assert_eq!((said.status, said.restart), (Status(0b000_111_000), false));
    }

    #[test]
    fn ends_of_the_range_are_out_of_range_each_on_its_own() {
        for (code, out) in [
            (8_388_607, true),
            (-8_388_608, true),
            (8_355_840, true),
            (8_300_000, false),
            (-8_300_000, false),
        ] {
            for channel in 0..3 {
                let mut codes = [0; 3];
                codes[channel] = code;
                let said = FrameReader::default().read(&[
                    frame(GOOD, [0; 3]),
                    frame(GOOD, [0; 3]),
                    frame(GOOD, codes),
                ]);
                assert_eq!(said.status, Status(u16::from(out) << (6 + channel)), "{code}");
                assert!(!said.restart);
            }
        }
    }

    #[test]
    fn a_converter_that_was_reset_or_is_out_of_step_is_begun_anew() {
        for answer in [GOOD | 0x0400, 0x0100, 0x0103] {
            let mut reader = FrameReader::default();
            reader.read(&good());
            let mut frames = good();
            frames[0] = frame(answer, [1_000, 1_000, 1_000]);
            let said = reader.read(&frames);
            assert_eq!((said.status, said.restart), (Status(0b111), true), "{answer:#06x}");
            assert_eq!(said.codes[..3], [1, -2, 3]);
        }
    }

    #[test]
    fn silence_says_that_nothing_can_be_trusted() {
        assert_eq!(FrameReader::default().silence().status, Status(0x01FF));
    }
}
