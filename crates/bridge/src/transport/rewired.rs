//! A pad whose channels are sent in another order, or with other signs, as one that is wired as it should be.
//!
//! Samples of nine channels get their counts and status bits exchanged, and are sealed anew; whatever else comes passes as it is. So everything
//! behind, captures too, hears a pad that was mended at its converters.

use std::io;
use std::os::fd::BorrowedFd;

use firmware_proto::command::Command;
use firmware_proto::frame::Message;
use firmware_proto::link::{MessageReceiver, encode_message};
use firmware_proto::sample::{Sample, Status};
use firmware_proto::{CHANNELS, ENCODED_MAX};
use tactpad_core::pad::wiring::permutation::SignedPermutation;
use tactpad_core::pipeline::line_check::LineFinding;

use super::Transport;

/// The pad behind such a wiring.
pub struct RewiredPad {
    pad: Box<dyn Transport>,
    frames: RewiredFrames,
}

impl RewiredPad {
    /// What each channel of `pad` is sent as.
    pub fn new(pad: Box<dyn Transport>, wiring: SignedPermutation) -> Self {
        Self { pad, frames: RewiredFrames { wiring, part: Vec::with_capacity(ENCODED_MAX) } }
    }
}

impl Transport for RewiredPad {
    fn fd(&self) -> BorrowedFd<'_> {
        self.pad.fd()
    }

    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        // What was held back comes first, and a frame keeps its length: there is always room.
        let held = self.frames.part.len().min(bytes.len() / 2);
        let room = bytes.len() - held;
        let read = self.pad.read(bytes.get_mut(..room).unwrap_or_default())?;
        let count = self.frames.take(bytes, read);
        if read > 0 && count == 0 { Err(io::ErrorKind::WouldBlock.into()) } else { Ok(count) }
    }

    fn send(&mut self, command: &Command) -> io::Result<()> {
        self.pad.send(command)
    }

    fn pause(&mut self, is_paused: bool) {
        self.pad.pause(is_paused);
    }

    fn asks_pause(&mut self) -> bool {
        self.pad.asks_pause()
    }

    fn finding(&self) -> Option<LineFinding> {
        self.pad.finding()
    }
}

/// Frames of a byte stream, however it is cut.
struct RewiredFrames {
    wiring: SignedPermutation,
    /// The part of a frame whose end has not come yet.
    part: Vec<u8>,
}

impl RewiredFrames {
    /// Puts in place of the first `read` bytes what is whole of what was held back and them. Returns how many bytes that is.
    fn take(&mut self, bytes: &mut [u8], read: usize) -> usize {
        let come: Vec<u8> = bytes.iter().take(read).copied().collect();
        let mut at = 0;
        for byte in come {
            self.part.push(byte);
            // A frame is no longer than this; what is longer is none, and passes.
            if byte == 0 || self.part.len() == ENCODED_MAX {
                let mut frame = [0; ENCODED_MAX];
                let whole = self.rewired(&mut frame).map_or(&self.part[..], |count| &frame[..count]);
                let to = bytes.get_mut(at..at + whole.len()).unwrap_or_default();
                to.iter_mut().zip(whole).for_each(|(to, from)| *to = *from);
                at += to.len();
                self.part.clear();
            }
        }
        at
    }

    /// The frame with its channels exchanged, if it is a sample of nine.
    fn rewired(&self, to: &mut [u8; ENCODED_MAX]) -> Option<usize> {
        let mut receiver = MessageReceiver::new();
        let message = self.part.iter().find_map(|byte| receiver.push(*byte))?;
        let Ok(Message::Sample(sample)) = message else { return None };
        Some(encode_message(&Message::Sample(rewired(&sample, &self.wiring)), to))
    }
}

fn rewired(sample: &Sample, wiring: &SignedPermutation) -> Sample {
    const CHANNEL_BITS: u16 = (1 << CHANNELS) - 1;
    let sources = wiring.sources();
    let counts = sources.map(|(sent, is_reversed)| {
        let count = sample.counts[sent];
        if is_reversed { count.saturating_neg() } else { count }
    });
    let of_whole_pad = Status(sample.status.0 & !CHANNEL_BITS);
    let status = sources.iter().enumerate().fold(of_whole_pad, |status, (channel, (sent, _))| {
        if sample.status.is_out_of_range(*sent) { status.with_out_of_range(channel) } else { status }
    });
    Sample { counts, status, ..*sample }
}

#[cfg(test)]
mod tests {
    use std::collections::VecDeque;
    use std::os::fd::AsFd;

    use super::*;
    use tactpad_numeric::random::SplitMix64;

    /// Bytes in pieces of any size.
    struct Pieces {
        pieces: VecDeque<Vec<u8>>,
        fd: std::fs::File,
    }

    impl Transport for Pieces {
        fn fd(&self) -> BorrowedFd<'_> {
            self.fd.as_fd()
        }

        fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
            let Some(mut piece) = self.pieces.pop_front() else { return Ok(0) };
            if piece.len() > bytes.len() {
                self.pieces.push_front(piece.split_off(bytes.len()));
            }
            bytes[..piece.len()].copy_from_slice(&piece);
            Ok(piece.len())
        }

        fn send(&mut self, _command: &Command) -> io::Result<()> {
            Ok(())
        }
    }

    fn sample(random: &mut SplitMix64, sequence: u32) -> Sample {
        let status = Status(random.next_bits() as u16 & 0x0fff);
        let counts = std::array::from_fn(|_| random.next_bits() as i32);
        Sample { sequence, time_us: 7, counts, temperature_centi_c: 2_000, status }
    }

    fn encoded(sample: &Sample) -> Vec<u8> {
        let mut frame = [0; ENCODED_MAX];
        let count = encode_message(&Message::Sample(*sample), &mut frame);
        frame[..count].to_vec()
    }

    #[test]
    fn channels_and_their_status_change_places_however_the_bytes_are_cut() {
        for seed in 0..200 {
            let mut random = SplitMix64::named(seed, "rewired");
            let all = SignedPermutation::single_mistakes();
            let mut draw = || all[random.next_bits() as usize % all.len()];
            let wiring = draw().after(&draw());
            let (mut sent, mut wanted) = (Vec::new(), Vec::new());
            for sequence in 0..40 {
                let wired = sample(&mut random, sequence);
                match random.next_bits() % 8 {
                    // What is no frame passes as it is.
                    0 => {
                        let noise: Vec<u8> = (0..random.next_bits() % 700)
                            .map(|_| random.next_bits() as u8 | 1)
                            .chain([0])
                            .collect();
                        sent.extend(&noise);
                        wanted.extend(noise);
                    }
                    _ => {
                        wanted.extend(encoded(&wired));
                        sent.extend(encoded(&rewired(&wired, &wiring.inverse())));
                    }
                }
            }
            let mut pieces = VecDeque::new();
            let mut rest = &sent[..];
            while !rest.is_empty() {
                let (piece, after) = rest.split_at((1 + random.next_bits() as usize % 300).min(rest.len()));
                pieces.push_back(piece.to_vec());
                rest = after;
            }
            let fd = std::fs::File::open("/dev/null").unwrap();
            let mut pad = RewiredPad::new(Box::new(Pieces { pieces, fd }), wiring);
            let (mut got, mut bytes) = (Vec::<u8>::new(), [0; 512]);
            loop {
                match pad.read(&mut bytes) {
                    Ok(0) => break,
                    Ok(count) => got.extend(&bytes[..count]),
                    Err(error) => assert_eq!(error.kind(), io::ErrorKind::WouldBlock),
                }
            }
            assert!(got == wanted, "seed {seed}");
        }
    }
}
