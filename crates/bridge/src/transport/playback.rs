//! A recording in place of a pad: its chunks arrive at the recorded pace.

use std::io;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::thread::{self, JoinHandle};

use firmware_proto::command::Command;
use rustix::io::Errno;
use rustix::pipe::{PipeFlags, pipe_with};

use super::Transport;
use super::pacing::{StopSignal, WaitOutcome, WriteOutcome, monotonic_us, wait, write_whole};

/// A recording that plays on its own thread. Dropping it stops the thread.
#[derive(Debug)]
pub struct Playback {
    reader: OwnedFd,
    stop: StopSignal,
    player: Option<JoinHandle<io::Result<()>>>,
}

impl Playback {
    /// Plays `chunks` from now on: pairs of the time since the chunk before, in microseconds, and the bytes.
    ///
    /// # Errors
    /// The kernel gives no pipe or no thread.
    pub fn start<C>(chunks: C) -> io::Result<Self>
    where
        C: IntoIterator<Item = (u64, Vec<u8>)>,
        C::IntoIter: Send + 'static,
    {
        let (reader, writer) = pipe_with(PipeFlags::CLOEXEC | PipeFlags::NONBLOCK)?;
        let stop = StopSignal::new()?;
        let (chunks, told) = (chunks.into_iter(), stop.clone());
        let player =
            thread::Builder::new().name("playback".into()).spawn(move || play(chunks, &writer, &told))?;
        Ok(Self { reader, stop, player: Some(player) })
    }
}

fn play(chunks: impl Iterator<Item = (u64, Vec<u8>)>, writer: &OwnedFd, stop: &StopSignal) -> io::Result<()> {
    let mut at_us = monotonic_us();
    for (delay_us, bytes) in chunks {
        at_us = at_us.saturating_add(delay_us);
        while monotonic_us() < at_us {
            if wait(stop, None, at_us)? == WaitOutcome::Stopped {
                return Ok(());
            }
        }
        if !matches!(write_whole(stop, writer.as_fd(), &bytes)?, WriteOutcome::Whole { .. }) {
            return Ok(());
        }
    }
    Ok(())
}

impl Transport for Playback {
    fn fd(&self) -> BorrowedFd<'_> {
        self.reader.as_fd()
    }

    /// Takes what has been played so far.
    ///
    /// # Errors
    /// `UnexpectedEof` when the recording has ended and all of it was taken; `WouldBlock` when nothing
    /// is there.
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        match rustix::io::read(&self.reader, bytes) {
            Ok(0) => Err(io::Error::new(io::ErrorKind::UnexpectedEof, "the recording has ended")),
            Ok(count) => Ok(count),
            Err(Errno::INTR) => Err(io::ErrorKind::WouldBlock.into()),
            Err(error) => Err(error.into()),
        }
    }

    /// Does nothing: what the pad answered back then is part of the recording.
    fn send(&mut self, _command: &Command) -> io::Result<()> {
        Ok(())
    }
}

impl Drop for Playback {
    fn drop(&mut self) {
        self.stop.raise();
        if let Some(player) = self.player.take() {
            // A player that failed has closed its end; the reader has been told so.
            let _ = player.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use rustix::event::{PollFd, PollFlags, poll};

    use super::super::pacing::limit;
    use super::*;

    /// Reads until the recording ends: the bytes, and the time of the last of them.
    fn read_all(playback: &mut Playback) -> (Vec<u8>, u64) {
        let (mut all, mut last_us, mut bytes) = (Vec::new(), 0, [0; 1024]);
        loop {
            let fd = playback.fd();
            assert_eq!(
                poll(&mut [PollFd::new(&fd, PollFlags::IN)], Some(&limit(60_000_000))),
                Ok(1),
                "silent"
            );
            match playback.read(&mut bytes) {
                Ok(count) => {
                    all.extend_from_slice(&bytes[..count]);
                    last_us = monotonic_us();
                }
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
                Err(error) => {
                    assert_eq!(error.kind(), io::ErrorKind::UnexpectedEof);
                    return (all, last_us);
                }
            }
        }
    }

    #[test]
    fn a_thousand_chunks_arrive_whole_and_in_order() {
        let chunks: Vec<_> =
            (0..1000_u32).map(|i| (10, i.to_le_bytes().repeat(1 + i as usize % 7))).collect();
        let expected: Vec<u8> = chunks.iter().flat_map(|(_, bytes)| bytes.clone()).collect();
        let mut playback = Playback::start(chunks).unwrap();
        assert_eq!(read_all(&mut playback).0, expected);
    }

    #[test]
    fn chunks_keep_the_recorded_pace() {
        let from_us = monotonic_us();
        let mut playback = Playback::start([(4_000, vec![1]), (6_000, vec![2])]).unwrap();
        assert_eq!(playback.read(&mut [0; 8]).unwrap_err().kind(), io::ErrorKind::WouldBlock);
        let (bytes, last_us) = read_all(&mut playback);
        assert_eq!(bytes, [1, 2]);
        assert!(last_us - from_us >= 10_000, "{} us", last_us - from_us);
    }

    #[test]
    fn more_than_a_pipe_holds_waits_for_the_reader() {
        let big: Vec<u8> = (0..300_000_u32).map(|i| (i % 251) as u8).collect();
        let mut playback = Playback::start([(0, big.clone())]).unwrap();
        assert_eq!(read_all(&mut playback).0, big);
    }

    #[test]
    fn dropping_ends_an_hour_of_silence_and_a_full_pipe() {
        drop(Playback::start([(3_600_000_000, vec![1])]).unwrap());
        drop(Playback::start([(0, vec![0; 1_000_000])]).unwrap());
    }

    #[test]
    fn empty_recording_is_finished_at_once() {
        assert!(read_all(&mut Playback::start([]).unwrap()).0.is_empty());
    }
}
