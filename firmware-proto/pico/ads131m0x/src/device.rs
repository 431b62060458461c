//! One converter on a bus: found, set, and read.

use core::fmt;

use embedded_hal::spi::SpiDevice;

use crate::command::{NULL, REGISTERS_MAX, RESET, read_register, was_reset, write_registers, written};
use crate::config::{Config, register};
use crate::frame::{FRAME_MAX, Frame, WORD_LEN, crc16, frame_len};

/// Bytes of the longest frame to the converter: a command, registers, a checksum.
const OUT_MAX: usize = (REGISTERS_MAX + 2) * WORD_LEN;

/// Why a converter did not do what it should.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error<E> {
    /// The bus failed.
    Bus(E),
    /// A frame came with a wrong checksum, or nothing drives the line.
    Damaged,
    /// Another answer than the one to this command.
    Answer {
        /// What should have come.
        expected: u16,
        /// What came.
        found: u16,
    },
}

impl<E: fmt::Debug> fmt::Display for Error<E> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Bus(error) => write!(f, "the bus failed: {error:?}"),
            Self::Damaged => write!(f, "the converter's frame is damaged, or no converter answers"),
            Self::Answer { expected, found } => {
                write!(f, "the converter answers {found:#06x}, not {expected:#06x}")
            }
        }
    }
}

/// A converter of so many channels, four at most set by [`configure`](Self::configure).
pub struct Device<D, const CHANNELS: usize> {
    bus: D,
}

impl<D: SpiDevice, const CHANNELS: usize> Device<D, CHANNELS> {
    /// The converter that `bus` selects.
    pub const fn new(bus: D) -> Self {
        Self { bus }
    }

    /// Sends one frame with `words` and their checksum; returns what came meanwhile, the answer to the frame before.
    ///
    /// # Errors
    /// `Bus`, and `Damaged`.
    pub fn exchange(&mut self, words: &[u16]) -> Result<Frame<CHANNELS>, Error<D::Error>> {
        const { assert!(FRAME_MAX <= OUT_MAX) };
        let mut bytes = [0; OUT_MAX];
        let len = put(words, &mut bytes).max(frame_len(CHANNELS));
        self.bus.transfer_in_place(&mut bytes[..len]).map_err(Error::Bus)?;
        Frame::read(&bytes).ok_or(Error::Damaged)
    }

    fn command(&mut self, words: &[u16], expected: u16) -> Result<(), Error<D::Error>> {
        self.exchange(words)?;
        let found = self.exchange(&[NULL])?.answer;
        if found == expected { Ok(()) } else { Err(Error::Answer { expected, found }) }
    }

    /// Back to the state after power-on. Wait five microseconds before the next frame.
    ///
    /// # Errors
    /// As of [`exchange`](Self::exchange); `Answer` if it is no converter of so many channels.
    pub fn reset(&mut self) -> Result<(), Error<D::Error>> {
        // Such a command is executed at the end of a whole frame only.
        self.command(&[RESET], was_reset(CHANNELS))
    }

    /// The register's content.
    ///
    /// # Errors
    /// As of [`exchange`](Self::exchange).
    pub fn register(&mut self, address: u8) -> Result<u16, Error<D::Error>> {
        self.exchange(&[read_register(address)])?;
        Ok(self.exchange(&[NULL])?.answer)
    }

    /// Says whether it is a converter of so many channels, sets it, and reads back what it holds.
    ///
    /// # Errors
    /// As of [`exchange`](Self::exchange); `Answer` with what it should be, or should hold.
    pub fn configure(&mut self, config: Config) -> Result<(), Error<D::Error>> {
        let expected = 0x2000 | (CHANNELS as u16) << 8;
        let found = self.register(register::ID)? & 0xFF00;
        if found != expected {
            return Err(Error::Answer { expected, found });
        }
        let contents = [Config::MODE, config.clock(CHANNELS), config.gains(CHANNELS)];
        let [mode, clock, gains] = contents;
        let count = contents.len();
        self.command(
            &[write_registers(register::MODE, count), mode, clock, gains],
            written(register::MODE, count),
        )?;
        for (address, expected) in (register::MODE..).zip(contents) {
            let found = self.register(address)?;
            if found != expected {
                return Err(Error::Answer { expected, found });
            }
        }
        Ok(())
    }
}

/// Words and their checksum, each in 24 bits; returns how many bytes they take. What is too much is left out.
///
/// The checksum stands after the last word, and the converter looks at it where it was told to.
fn put(words: &[u16], out: &mut [u8; OUT_MAX]) -> usize {
    let mut len = 0;
    for word in words.iter().take(OUT_MAX / WORD_LEN - 1) {
        out[len..len + 2].copy_from_slice(&word.to_be_bytes());
        len += WORD_LEN;
    }
    let checksum = crc16(&out[..len]).to_be_bytes();
    out[len..len + 2].copy_from_slice(&checksum);
    len + WORD_LEN
}

/// The bytes of a frame that asks nothing, for who moves them without this driver.
#[must_use]
pub fn null_frame() -> [u8; FRAME_MAX] {
    let mut bytes = [0; OUT_MAX];
    put(&[NULL], &mut bytes);
    let mut frame = [0; FRAME_MAX];
    frame.copy_from_slice(&bytes[..FRAME_MAX]);
    frame
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec;
    use std::vec::Vec;

    use embedded_hal_mock::eh1::spi::{Mock, Transaction};

    use super::*;
    use crate::config::{Gain, Oversampling};
    use crate::frame::Status;

    const CONFIG: Config = Config { gain: Gain::X32, oversampling: Oversampling::X4096 };

    /// What goes to the converter: words and their checksum, filled up to a frame.
    fn to(words: &[u16]) -> Vec<u8> {
        let mut bytes =
            words.iter().flat_map(|word| [(word >> 8) as u8, *word as u8, 0]).collect::<Vec<u8>>();
        let checksum = crc16(&bytes);
        bytes.extend([(checksum >> 8) as u8, checksum as u8, 0]);
        bytes.resize(bytes.len().max(15), 0);
        bytes
    }

    /// What comes from it: an answer, three codes, a checksum.
    fn from(answer: u16, len: usize) -> Vec<u8> {
        let mut bytes = vec![(answer >> 8) as u8, answer as u8, 0, 0, 0, 1, 0, 0, 2, 0, 0, 3];
        let checksum = crc16(&bytes);
        bytes.extend([(checksum >> 8) as u8, checksum as u8, 0]);
        bytes.resize(len, 0);
        bytes
    }

    /// Frames on the bus: words that go, and the answer that comes meanwhile.
    fn bus(frames: &[(&[u16], u16)]) -> Mock<u8> {
        let frame = |(words, answer): &(&[u16], u16)| {
            let out = to(words);
            let len = out.len();
            [
                Transaction::transaction_start(),
                Transaction::transfer_in_place(out, from(*answer, len)),
                Transaction::transaction_end(),
            ]
        };
        Mock::new(&frames.iter().flat_map(frame).collect::<Vec<_>>())
    }

    /// A bus on which the frames of this part of frames.txt pass.
    fn examples(part: &str) -> Mock<u8> {
        let text = include_str!("../frames.txt").split("## ").find(|it| it.starts_with(part)).unwrap();
        let bytes = |line: &str| -> Vec<u8> {
            let digits = line.chars().filter(char::is_ascii_hexdigit).collect::<Vec<_>>();
            let byte = |pair: &[char]| u8::from_str_radix(&pair.iter().collect::<std::string::String>(), 16);
            digits.chunks(2).map(|pair| byte(pair).unwrap()).collect()
        };
        let lines = |mark| text.lines().filter_map(move |line| line.strip_prefix(mark)).map(bytes);
        let frames = lines("> ").zip(lines("< ")).flat_map(|(out, came)| {
            [
                Transaction::transaction_start(),
                Transaction::transfer_in_place(out, came),
                Transaction::transaction_end(),
            ]
        });
        Mock::new(&frames.collect::<Vec<_>>())
    }

    #[test]
    fn a_reset_is_that_of_the_examples() {
        let mut bus = examples("m03 reset");
        assert_eq!(Device::<_, 3>::new(bus.clone()).reset(), Ok(()));
        bus.done();
        let mut bus = examples("m08 reset");
        assert_eq!(Device::<_, 8>::new(bus.clone()).reset(), Ok(()));
        bus.done();
    }

    #[test]
    fn registers_are_written_and_read_back_as_in_the_examples() {
        let mut bus = examples("m03 configure");
        assert_eq!(Device::<_, 3>::new(bus.clone()).configure(CONFIG), Ok(()));
        bus.done();
        let mut bus = examples("m08 identify");
        assert_eq!(Device::<_, 8>::new(bus.clone()).register(0), Ok(0x2800));
        bus.done();
    }

    #[test]
    fn codes_are_those_of_the_examples() {
        let mut bus = examples("m03 codes");
        let mut device = Device::<_, 3>::new(bus.clone());
        let frames = [(); 3].map(|()| device.exchange(&[NULL]).unwrap());
        bus.done();
        assert_eq!(frames[0], Frame { answer: 0x0107, codes: [8_388_607, 1, -8_388_608] });
        assert_eq!(frames[1].codes, [-1, 0, 8_388_607]);
        assert!(Status(frames[1].answer).all_new(3) && !Status(frames[2].answer).all_new(3));
    }

    #[test]
    fn another_converter_and_another_content_are_told() {
        let mut four = bus(&[(&[0xA000], 0x0500), (&[NULL], 0x2401)]);
        let told = Device::<_, 3>::new(four.clone()).configure(CONFIG);
        assert_eq!(told, Err(Error::Answer { expected: 0x2300, found: 0x2400 }));
        four.done();
        let mut deaf = bus(&[(&[RESET], 0x0500), (&[NULL], 0x0500)]);
        let told = Device::<_, 3>::new(deaf.clone()).reset();
        assert_eq!(told, Err(Error::Answer { expected: 0xFF23, found: 0x0500 }));
        deaf.done();
    }

    #[test]
    fn a_line_that_nothing_drives_is_damage() {
        for level in [0x00, 0xFF] {
            let mut bus = Mock::new(&[
                Transaction::transaction_start(),
                Transaction::transfer_in_place(to(&[NULL]), vec![level; 15]),
                Transaction::transaction_end(),
            ]);
            assert_eq!(Device::<_, 3>::new(bus.clone()).exchange(&[NULL]), Err(Error::Damaged));
            bus.done();
        }
    }

    #[test]
    fn the_frame_that_asks_nothing_has_its_checksum() {
        assert_eq!(null_frame()[..15], to(&[NULL])[..]);
    }
}
