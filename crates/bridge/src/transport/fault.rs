//! A bad line: damages what comes through it, to try how the bridge behaves.
//!
//! It works on whole frames of the byte stream, each with the zero that ends it. What a seed does to a byte stream is
//! always the same, however the stream is cut into reads; only the moment at which late bytes come depends on the clock.

use std::collections::VecDeque;
use std::fmt;
use std::io;
use std::mem;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::str::FromStr;

use firmware_proto::command::Command;
use rustix::event::epoll;
use rustix::time::{
    Itimerspec, TimerfdClockId, TimerfdFlags, TimerfdTimerFlags, timerfd_create, timerfd_settime,
};
use tactpad_core::pipeline::line_check::LineFinding;

use super::Transport;
use super::pacing::{is_readable, limit, monotonic_us};
use tactpad_numeric::random::SplitMix64;

/// A delayed frame, and whatever comes behind it, is late by this much: too little for the link to count as silent.
pub const DELAY_US: u64 = 20_000;

/// A stalled line passes nothing for this long: the link counts as silent meanwhile.
pub const STALL_US: u64 = 200_000;

/// Length of the pieces in which bytes without a zero are passed on, in bytes; no frame is so long.
const FRAME_MAX: usize = 512;

/// Each probability where only a seed is given.
const PROBABILITY_DEFAULT: f32 = 0.001;

/// A fault of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FaultKind {
    /// It does not come.
    Drop,
    /// It comes twice.
    Repeat,
    /// It comes after the next one.
    Reorder,
    /// One of its bits is flipped, perhaps one of the zero that ends it.
    Corrupt,
    /// It comes late by [`DELAY_US`].
    Delay,
    /// It comes late by [`STALL_US`].
    Stall,
}

const KINDS: [(&str, FaultKind); 6] = [
    ("drop", FaultKind::Drop),
    ("repeat", FaultKind::Repeat),
    ("reorder", FaultKind::Reorder),
    ("corrupt", FaultKind::Corrupt),
    ("delay", FaultKind::Delay),
    ("stall", FaultKind::Stall),
];

/// How bad a line is: a seed, and for each fault its probability per frame.
///
/// As text: `SEED[:FAULT=PROBABILITY,…]` with the faults `drop`, `repeat`, `reorder`, `corrupt`, `delay` and `stall`.
/// A fault that is not named does not happen; a seed alone means 0.001 for each. A frame meets one fault at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaultPlan {
    seed: u64,
    /// In the order of [`KINDS`]; their sum is at most 1.
    probabilities: [f32; KINDS.len()],
}

/// Why a text is no plan of faults.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FaultPlanError {
    /// It does not begin with a whole number.
    BadSeed {
        /// The text in its place.
        seed: String,
    },
    /// Something else stands in place of `FAULT=PROBABILITY`.
    BadEntry {
        /// The text in its place.
        entry: String,
    },
    /// The probabilities make more than 1 together.
    TooMany,
}

impl FromStr for FaultPlan {
    type Err = FaultPlanError;

    fn from_str(text: &str) -> Result<Self, FaultPlanError> {
        let (seed, list) = text.split_once(':').map_or((text, None), |(seed, list)| (seed, Some(list)));
        let seed = seed.parse().map_err(|_| FaultPlanError::BadSeed { seed: seed.into() })?;
        let mut probabilities = [if list.is_some() { 0.0 } else { PROBABILITY_DEFAULT }; KINDS.len()];
        for entry in list.into_iter().flat_map(|list| list.split(',')) {
            let bad = || FaultPlanError::BadEntry { entry: entry.into() };
            let (name, probability) = entry.split_once('=').ok_or_else(bad)?;
            let mut named = KINDS.iter().zip(&mut probabilities).filter(|((known, _), _)| *known == name);
            let (_, place) = named.next().ok_or_else(bad)?;
            *place = probability.parse().ok().filter(|p| (0.0..=1.0).contains(p)).ok_or_else(bad)?;
        }
        if probabilities.iter().sum::<f32>() > 1.0 {
            return Err(FaultPlanError::TooMany);
        }
        Ok(Self { seed, probabilities })
    }
}

impl fmt::Display for FaultPlanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BadSeed { seed } => {
                write!(f, "`{seed}` is no seed: write a whole number, as in 7 or 7:drop=0.01,stall=0.001")
            }
            Self::BadEntry { entry } => {
                let names = KINDS.map(|(name, _)| name).join(", ");
                write!(f, "`{entry}` is not FAULT=PROBABILITY with one of {names} and a number from 0 to 1")
            }
            Self::TooMany => {
                f.write_str("a frame meets one fault at most: let the probabilities sum to 1 or less")
            }
        }
    }
}

impl std::error::Error for FaultPlanError {}

/// Cuts a byte stream into frames and lets faults happen to them. Knows no time.
#[derive(Debug)]
struct Injector {
    probabilities: [f32; KINDS.len()],
    random: SplitMix64,
    /// The bytes of the frame that has not ended yet.
    frame: Vec<u8>,
    /// The frame that comes after the next one.
    overtaken: Option<Vec<u8>>,
}

impl Injector {
    fn new(plan: &FaultPlan) -> Self {
        let FaultPlan { seed, probabilities } = *plan;
        Self { probabilities, random: SplitMix64::new(seed), frame: Vec::new(), overtaken: None }
    }

    /// Takes bytes; hands what comes through to `pass`, with its delay in microseconds.
    fn feed(&mut self, bytes: &[u8], pass: &mut impl FnMut(Vec<u8>, u64)) {
        for &byte in bytes {
            self.frame.push(byte);
            if byte == 0 || self.frame.len() == FRAME_MAX {
                let frame = mem::take(&mut self.frame);
                self.strike(frame, pass);
            }
        }
    }

    /// The stream has ended: hands over what was held back.
    fn finish(&mut self, pass: &mut impl FnMut(Vec<u8>, u64)) {
        for frame in self.overtaken.take().into_iter().chain([mem::take(&mut self.frame)]) {
            pass(frame, 0);
        }
    }

    fn strike(&mut self, mut frame: Vec<u8>, pass: &mut impl FnMut(Vec<u8>, u64)) {
        let fault = self.draw();
        match fault {
            Some(FaultKind::Drop) => return,
            Some(FaultKind::Reorder) if self.overtaken.is_none() => {
                self.overtaken = Some(frame);
                return;
            }
            Some(FaultKind::Repeat) => pass(frame.clone(), 0),
            Some(FaultKind::Corrupt) => self.flip_bit(&mut frame),
            // A frame that is to come after the next one, while another is so already, is that next one.
            None | Some(FaultKind::Reorder | FaultKind::Delay | FaultKind::Stall) => {}
        }
        let late_us = match fault {
            Some(FaultKind::Delay) => DELAY_US,
            Some(FaultKind::Stall) => STALL_US,
            _ => 0,
        };
        pass(frame, late_us);
        if let Some(overtaken) = self.overtaken.take() {
            pass(overtaken, 0);
        }
    }

    /// The fault of the next frame.
    fn draw(&mut self) -> Option<FaultKind> {
        let mut rest = self.random.fraction();
        for ((_, kind), probability) in KINDS.into_iter().zip(self.probabilities) {
            if rest < probability {
                return Some(kind);
            }
            rest -= probability;
        }
        None
    }

    fn flip_bit(&mut self, frame: &mut [u8]) {
        let bits = self.random.next_bits();
        let place = (bits >> 3).checked_rem(frame.len() as u64).unwrap_or(0) as usize;
        if let Some(byte) = frame.get_mut(place) {
            *byte ^= 1 << (bits & 7);
        }
    }
}

/// A transport whose incoming bytes suffer faults. Commands to the pad pass unharmed.
///
/// Nothing overtakes a late frame: the line behind it waits, too. When the pad is gone, what is on its way still comes.
pub struct FaultyLine {
    line: Box<dyn Transport>,
    injector: Injector,
    /// Frames on their way, and when they are due by the monotonic clock; never before the one ahead.
    on_way: VecDeque<(u64, Vec<u8>)>,
    /// How the line ended.
    ended: Option<io::ErrorKind>,
    /// Readable while `line` or `timer` is: so a poll sees both.
    either: OwnedFd,
    timer: OwnedFd,
}

impl FaultyLine {
    /// Puts faults on `line`.
    ///
    /// # Errors
    /// The kernel gives no more descriptors, or that of the line cannot be polled together with others.
    pub fn new(line: Box<dyn Transport>, plan: &FaultPlan) -> io::Result<Self> {
        let either = epoll::create(epoll::CreateFlags::CLOEXEC)?;
        let timer =
            timerfd_create(TimerfdClockId::Monotonic, TimerfdFlags::CLOEXEC | TimerfdFlags::NONBLOCK)?;
        for fd in [line.fd(), timer.as_fd()] {
            epoll::add(&either, fd, epoll::EventData::new_u64(0), epoll::EventFlags::IN)?;
        }
        Ok(Self { line, injector: Injector::new(plan), on_way: VecDeque::new(), ended: None, either, timer })
    }

    /// Takes what is there at `now_us` and sends it on its way.
    fn take(&mut self, now_us: u64) -> io::Result<()> {
        if self.ended.is_some() || !is_readable(self.line.fd())? {
            return Ok(());
        }
        let mut bytes = [0; 4096];
        let read = self.line.read(&mut bytes);
        let Self { injector, on_way, .. } = self;
        let mut pass = |frame, late_us| {
            let ahead_us = on_way.back().map_or(0, |(due_us, _)| *due_us);
            on_way.push_back((ahead_us.max(now_us.saturating_add(late_us)), frame));
        };
        match read {
            Ok(count) if count > 0 => injector.feed(bytes.get(..count).unwrap_or_default(), &mut pass),
            Err(error) if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted) => {}
            gone => {
                injector.finish(&mut pass);
                // A line that is gone is readable for ever.
                epoll::delete(&self.either, self.line.fd())?;
                self.ended = Some(gone.err().map_or(io::ErrorKind::UnexpectedEof, |error| error.kind()));
            }
        }
        Ok(())
    }

    /// Hands over what has arrived by `now_us`, as much as there is room for.
    fn hand_over(&mut self, now_us: u64, bytes: &mut [u8]) -> usize {
        let mut filled = 0;
        while let Some((_, frame)) = self.on_way.front_mut().filter(|(due_us, _)| *due_us <= now_us) {
            let room = bytes.get_mut(filled..).unwrap_or_default();
            let count = room.len().min(frame.len());
            room.iter_mut().zip(frame.drain(..count)).for_each(|(to, from)| *to = from);
            filled += count;
            if !frame.is_empty() {
                break;
            }
            self.on_way.pop_front();
        }
        filled
    }

    /// Lets the descriptor poll readable when the next frame is due, or at once to tell how the line ended.
    fn set_timer(&self) -> io::Result<()> {
        let due_us = self.on_way.front().map(|(due_us, _)| *due_us).or(self.ended.map(|_| 0));
        // Zero would stop the timer, and so does `None`.
        let it_value = limit(due_us.map_or(0, |due_us| due_us.max(1)));
        let timer = Itimerspec { it_interval: limit(0), it_value };
        timerfd_settime(&self.timer, TimerfdTimerFlags::ABSTIME, &timer)?;
        Ok(())
    }
}

impl Transport for FaultyLine {
    fn fd(&self) -> BorrowedFd<'_> {
        self.either.as_fd()
    }

    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let now_us = monotonic_us();
        self.take(now_us)?;
        let count = self.hand_over(now_us, bytes);
        self.set_timer()?;
        match self.ended {
            _ if count > 0 => Ok(count),
            Some(kind) if self.on_way.is_empty() => Err(kind.into()),
            _ => Err(io::ErrorKind::WouldBlock.into()),
        }
    }

    fn send(&mut self, command: &Command) -> io::Result<()> {
        self.line.send(command)
    }

    fn pause(&mut self, is_paused: bool) {
        self.line.pause(is_paused);
    }

    fn asks_pause(&mut self) -> bool {
        self.line.asks_pause()
    }

    fn finding(&self) -> Option<LineFinding> {
        self.line.finding()
    }
}

#[cfg(test)]
mod tests {
    use rustix::event::{PollFd, PollFlags, poll};

    use super::super::playback::Playback;
    use super::*;

    const FRAMES: u32 = 20_000;

    fn plan(text: &str) -> FaultPlan {
        text.parse().unwrap()
    }

    /// Distinct frames, each with the zero that ends it.
    fn stream() -> Vec<Vec<u8>> {
        (0..FRAMES).map(|n| [format!("{n:05}").into_bytes(), vec![0]].concat()).collect()
    }

    /// The frames that come through, with their delays.
    fn injected(text: &str, pieces: &[Vec<u8>]) -> Vec<(Vec<u8>, u64)> {
        let (mut injector, mut out) = (Injector::new(&plan(text)), Vec::new());
        let mut pass = |frame: Vec<u8>, late_us| out.push((frame, late_us));
        pieces.iter().for_each(|piece| injector.feed(piece, &mut pass));
        injector.finish(&mut pass);
        out.retain(|(frame, _)| !frame.is_empty());
        out
    }

    fn frames(text: &str) -> Vec<Vec<u8>> {
        injected(text, &stream()).into_iter().map(|(frame, _)| frame).collect()
    }

    /// Whether `count` of [`FRAMES`] is what `probability` gives, within five standard deviations.
    fn is_about(count: usize, probability: f64) -> bool {
        let mean = f64::from(FRAMES) * probability;
        (count as f64 - mean).abs() < 5.0 * (mean * (1.0 - probability)).sqrt()
    }

    #[test]
    fn a_good_line_changes_nothing() {
        let long = vec![vec![7; 3 * FRAME_MAX + 5], vec![0, 0, 1]];
        for pieces in [stream(), long] {
            let through = injected("1:drop=0", &pieces);
            assert!(through.iter().all(|(_, late_us)| *late_us == 0));
            assert_eq!(through.into_iter().flat_map(|(frame, _)| frame).collect::<Vec<_>>(), pieces.concat());
        }
    }

    #[test]
    fn dropped_frames_are_missing_and_the_rest_is_in_order() {
        let (sent, come) = (stream(), frames("1:drop=0.1"));
        assert!(is_about(sent.len() - come.len(), 0.1));
        assert!(come.is_sorted() && come.iter().all(|frame| sent.binary_search(frame).is_ok()));
        assert!(frames("1:drop=1").is_empty());
    }

    #[test]
    fn repeated_frames_come_twice_in_a_row() {
        let mut come = frames("2:repeat=0.1");
        assert!(is_about(come.len() - FRAMES as usize, 0.1));
        come.dedup();
        assert_eq!(come, stream());
    }

    #[test]
    fn reordered_frames_change_places_with_the_next() {
        let (sent, mut come) = (stream(), frames("3:reorder=0.1"));
        let mut swapped = 0;
        for place in 1..come.len() {
            if come[place - 1] > come[place] {
                come.swap(place - 1, place);
                swapped += 1;
            }
        }
        assert_eq!(come, sent);
        // The frame that overtakes is not reordered itself: of every 1 + 0.1 frames, 0.1 are.
        assert!(is_about(swapped, 0.1 / 1.1), "{swapped}");
    }

    #[test]
    fn the_last_frame_comes_though_no_next_one_does() {
        let through = injected("3:reorder=1", &[b"a\0b\0c\0half".to_vec()]);
        let text: Vec<_> = through.into_iter().flat_map(|(frame, _)| frame).collect();
        assert_eq!(text, b"b\0a\0c\0half");
    }

    #[test]
    fn corrupt_frames_differ_in_one_bit() {
        let (sent, come) = (stream(), frames("4:corrupt=0.1"));
        assert_eq!(sent.len(), come.len());
        let bits = |(sent, come): (&Vec<u8>, &Vec<u8>)| {
            assert_eq!(sent.len(), come.len());
            sent.iter().zip(come).map(|(sent, come)| (sent ^ come).count_ones()).sum::<u32>()
        };
        let differ: Vec<_> = sent.iter().zip(&come).map(bits).collect();
        assert!(differ.iter().all(|bits| *bits <= 1));
        assert!(is_about(differ.iter().filter(|bits| **bits == 1).count(), 0.1));
        let in_zero = come.iter().filter(|frame| frame.last() != Some(&0)).count();
        assert!(is_about(in_zero, 0.1 / 6.0), "the zero is hit like the other five bytes: {in_zero}");
    }

    #[test]
    fn late_frames_are_unchanged() {
        for (text, expected_us) in [("5:delay=0.1", DELAY_US), ("5:stall=0.1", STALL_US)] {
            let through = injected(text, &stream());
            assert!(through.iter().all(|(_, late_us)| [0, expected_us].contains(late_us)));
            assert!(is_about(through.iter().filter(|(_, late_us)| *late_us != 0).count(), 0.1));
            assert_eq!(through.into_iter().map(|(frame, _)| frame).collect::<Vec<_>>(), stream());
        }
    }

    #[test]
    fn the_seed_decides_and_the_cut_into_reads_does_not() {
        let text = ":drop=0.1,repeat=0.1,reorder=0.1,corrupt=0.1,delay=0.1,stall=0.1";
        let seed = |seed: u64, cut: usize| {
            let pieces: Vec<_> = stream().concat().chunks(cut).map(<[u8]>::to_vec).collect();
            injected(&format!("{seed}{text}"), &pieces)
        };
        assert_eq!(seed(6, 1), seed(6, 4_096));
        assert_ne!(seed(6, 1), seed(7, 1));
    }

    #[test]
    fn plans_are_written_as_text() {
        assert_eq!(plan("9"), FaultPlan { seed: 9, probabilities: [PROBABILITY_DEFAULT; 6] });
        let one = FaultPlan { seed: u64::MAX, probabilities: [0.0, 0.0, 0.0, 0.25, 0.0, 0.75] };
        assert_eq!(plan("18446744073709551615:stall=0.75,corrupt=0.25"), one);
        for seed in ["", "x", "-1", "18446744073709551616"] {
            assert_eq!(seed.parse::<FaultPlan>(), Err(FaultPlanError::BadSeed { seed: seed.into() }));
        }
        for entry in ["", "drop", "drop=", "drop=1.01", "drop=-0.1", "drop=NaN", "lose=0.1", "drop=0.1;"] {
            let error = format!("1:{entry}").parse::<FaultPlan>().unwrap_err();
            assert_eq!(error, FaultPlanError::BadEntry { entry: entry.into() });
            assert!(error.to_string().contains("reorder"), "{error}");
        }
        assert_eq!("1:drop=0.6,stall=0.5".parse::<FaultPlan>(), Err(FaultPlanError::TooMany));
    }

    /// Polls and reads until the line ends: the bytes, and when the first of them came.
    fn read_all(line: &mut FaultyLine) -> (Vec<u8>, u64) {
        let (mut all, mut first_us, mut bytes) = (Vec::new(), None, [0; 64]);
        loop {
            let mut fds = [PollFd::from_borrowed_fd(line.fd(), PollFlags::IN)];
            assert_eq!(poll(&mut fds, Some(&limit(60_000_000))), Ok(1), "the poll sleeps for ever");
            match line.read(&mut bytes) {
                Ok(count) => {
                    all.extend_from_slice(&bytes[..count]);
                    first_us.get_or_insert_with(monotonic_us);
                }
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
                Err(error) => {
                    assert_eq!(error.kind(), io::ErrorKind::UnexpectedEof);
                    return (all, first_us.unwrap_or(0));
                }
            }
        }
    }

    fn line(text: &str, chunks: Vec<(u64, Vec<u8>)>) -> FaultyLine {
        FaultyLine::new(Box::new(Playback::start(chunks).unwrap()), &plan(text)).unwrap()
    }

    #[test]
    fn all_bytes_pass_a_good_line_and_then_its_end() {
        let chunks: Vec<_> =
            stream().concat().chunks(77).map(|bytes| (10, bytes.to_vec())).take(300).collect();
        let sent: Vec<u8> = chunks.iter().flat_map(|(_, bytes)| bytes.clone()).collect();
        assert_eq!(read_all(&mut line("1:drop=0", chunks)).0, sent);
    }

    #[test]
    fn late_bytes_wake_the_poller_when_they_are_due_though_the_pad_is_gone() {
        for (text, late_us) in [("1:delay=1", DELAY_US), ("1:stall=1", STALL_US)] {
            let from_us = monotonic_us();
            let (bytes, first_us) = read_all(&mut line(text, vec![(0, b"one\0two\0half".to_vec())]));
            assert_eq!(bytes, b"one\0two\0half");
            assert!(first_us - from_us >= late_us, "{text}: {} us", first_us - from_us);
        }
    }

    #[test]
    fn half_a_frame_does_not_pass_and_does_not_keep_the_poller_awake() {
        let mut line = line("1:drop=0", vec![(0, b"half".to_vec()), (3_600_000_000, vec![0])]);
        let mut readable = |within_us| {
            let mut fds = [PollFd::from_borrowed_fd(line.fd(), PollFlags::IN)];
            let ready = poll(&mut fds, Some(&limit(within_us))).unwrap() > 0;
            (ready, line.read(&mut [0; 64]).map_err(|error| error.kind()))
        };
        assert_eq!(readable(60_000_000), (true, Err(io::ErrorKind::WouldBlock)));
        assert_eq!(readable(0), (false, Err(io::ErrorKind::WouldBlock)));
    }
}
