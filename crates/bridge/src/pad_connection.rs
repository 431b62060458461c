//! The connection to the pad: opens it, asks for its identity, notices unplugging, and reconnects.

use std::io;

use firmware_proto::command::Command;

use crate::error::BridgeError;
use crate::opening::{OpenedPad, Patience};
use crate::transport::Transport;
use crate::transport::opener::PadError;
use tactpad_core::pipeline::Pipeline;
use tactpad_core::pipeline::line_check::LineFinding;
use tactpad_core::time::HostInstant;

/// Time limit for the first valid frame, in microseconds: a device that has sent none by then is no pad.
const FIRST_FRAME_US: u64 = 3_000_000;

/// Interval between attempts to open an unplugged pad, in microseconds. So one whose permissions come late is opened soon.
const REOPEN_US: u64 = 250_000;

/// Largest number of reads that are discarded: more than a port buffers.
const SKIPS_MAX: usize = 64;

/// Times at which the identity is requested, in microseconds: a pad that is still starting may miss a request.
const IDENTIFY_US: [u64; 3] = [0, 250_000, 1_000_000];

/// Reason why no pad is connected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NoPadReason {
    /// It is not there.
    Gone,
    /// It is there but may not be opened.
    Denied,
    /// Something is there, but not one pad: several, or what cannot be used.
    Ambiguous,
}

/// The connection to a pad, or the attempts to open one.
pub(super) struct PadConnection {
    /// The pad while there is one, and how to open it again.
    opened: OpenedPad,
    patience: Patience,
    no_pad_reason: NoPadReason,
    opened_at: HostInstant,
    reopen_at: HostInstant,
    /// Start of the identity requests: the opening, or the last restart of the pad, or its first frame after silence.
    identify_since: HostInstant,
    identify_sent: usize,
    /// Whether the pad had sent a frame at the last call of [`PadConnection::maintain`].
    was_heard: bool,
    /// Number of restarts of the pad at that time.
    restarts: u64,
    /// Whether this is still the pad that was opened first.
    is_first: bool,
    bytes_received: u64,
    /// Whether the pad was told that the player paused.
    is_paused: bool,
}

impl PadConnection {
    /// The connection to a pad that was opened just now. Without a way to reopen it, unplugging is final.
    pub(super) const fn new(opened: OpenedPad, patience: Patience, now: HostInstant) -> Self {
        Self {
            opened,
            patience,
            no_pad_reason: NoPadReason::Gone,
            opened_at: now,
            reopen_at: now,
            identify_since: now,
            identify_sent: 0,
            was_heard: false,
            restarts: 0,
            is_first: true,
            bytes_received: 0,
            is_paused: false,
        }
    }

    /// The pad, if there is one.
    pub(super) fn pad(&self) -> Option<&dyn Transport> {
        self.opened.pad.as_deref()
    }

    /// What is wrong with what the pad sends, where that is not frames.
    pub(super) fn finding(&self) -> Option<LineFinding> {
        self.opened.pad.as_ref().and_then(|pad| pad.finding())
    }

    /// The reason why no pad is connected; `None` while one is.
    pub(super) fn no_pad_reason(&self) -> Option<NoPadReason> {
        self.opened.pad.is_none().then_some(self.no_pad_reason)
    }

    /// Whether the pad comes back after it left.
    pub(super) const fn can_return(&self) -> bool {
        self.opened.opener.is_some()
    }

    /// Reads once; `None` when nothing is there.
    ///
    /// # Errors
    /// The pad is gone.
    pub(super) fn read(&mut self, bytes: &mut [u8]) -> io::Result<Option<usize>> {
        let Some(pad) = &mut self.opened.pad else { return Ok(None) };
        match pad.read(bytes) {
            Ok(0) => Err(io::ErrorKind::UnexpectedEof.into()),
            Ok(read) => {
                self.bytes_received += read as u64;
                Ok(Some(read))
            }
            Err(error) if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted) => {
                Ok(None)
            }
            Err(error) => Err(error),
        }
    }

    /// Discards the bytes that the pad has sent by now. The time limit for its first frame begins anew.
    pub(super) fn discard_input(&mut self, now: HostInstant, bytes: &mut [u8]) {
        self.opened_at = now;
        // A pad sends more slowly than this reads; a recording may not. A pad that is gone is noticed by who reads next.
        for _ in 0..SKIPS_MAX {
            if !matches!(self.read(bytes), Ok(Some(_))) {
                return;
            }
        }
    }

    /// The pad was unplugged: tries to reopen it from now on.
    pub(super) fn on_unplugged(&mut self, now: HostInstant) {
        (self.opened.pad, self.no_pad_reason, self.is_first) = (None, NoPadReason::Gone, false);
        self.reopen_at = now.plus_us(REOPEN_US);
    }

    /// Tells the pad whether the player paused, if that is new to it.
    pub(super) fn pause(&mut self, is_paused: bool) {
        if let Some(pad) = self.opened.pad.as_mut().filter(|_| self.is_paused != is_paused) {
            pad.pause(is_paused);
            self.is_paused = is_paused;
        }
    }

    /// Whether the player asked on the pad itself to pause it; tells it once.
    pub(super) fn asks_pause(&mut self) -> bool {
        self.opened.pad.as_mut().is_some_and(|pad| pad.asks_pause())
    }

    /// Closes the pad for good.
    pub(super) fn close(&mut self) {
        (self.opened.pad, self.opened.opener) = (None, None);
    }

    /// The time of the next call of [`PadConnection::maintain`].
    pub(super) fn next_deadline(&self, pipeline: &Pipeline) -> Option<HostInstant> {
        let reopen = self.reopens().then_some(self.reopen_at);
        let first_frame = self.awaits_first_frame(pipeline).then(|| self.opened_at.plus_us(FIRST_FRAME_US));
        [reopen, first_frame, self.identify_at(pipeline)].into_iter().flatten().min()
    }

    /// Reopens an unplugged pad, requests the identity of a new one, and gives up on a device that is no pad.
    ///
    /// # Errors
    /// The device that was opened first is no pad, or none that can be played with.
    pub(super) fn maintain(&mut self, now: HostInstant, pipeline: &Pipeline) -> Result<(), BridgeError> {
        if self.is_first
            && self.patience == Patience::Limited
            && let Some(refusal) = pipeline.refusal()
        {
            return Err(BridgeError::Refused(*refusal));
        }
        if self.awaits_first_frame(pipeline) && now >= self.opened_at.plus_us(FIRST_FRAME_US) {
            return Err(BridgeError::NotAPad(self.why_not_a_pad()));
        }
        let (is_heard, restarts) = (pipeline.is_heard(), pipeline.health().restarts);
        if (is_heard, restarts) != (self.was_heard, self.restarts) {
            // A pad that was powered late, or began anew, has missed the questions so far.
            (self.was_heard, self.restarts) = (is_heard, restarts);
            (self.identify_since, self.identify_sent) = (now, 0);
        }
        if self.reopens() && now >= self.reopen_at {
            self.reopen(now);
        }
        if self.identify_at(pipeline).is_some_and(|due| due <= now) {
            self.identify_sent += 1;
            if let Some(pad) = &mut self.opened.pad {
                // A pad that takes no commands is no error: it plays with the default scale.
                let _ = pad.send(&Command::Identify);
            }
        }
        Ok(())
    }

    const fn reopens(&self) -> bool {
        self.opened.pad.is_none() && self.opened.opener.is_some()
    }

    fn reopen(&mut self, now: HostInstant) {
        self.reopen_at = now.plus_us(REOPEN_US);
        match self.opened.opener.as_mut().map(|open| open()) {
            Some(Ok(pad)) => {
                (self.opened.pad, self.opened_at, self.identify_since) = (Some(pad), now, now);
                (self.identify_sent, self.is_paused) = (0, false);
            }
            Some(Err(PadError::Denied(_))) => self.no_pad_reason = NoPadReason::Denied,
            Some(Err(PadError::Unusable(_))) => self.no_pad_reason = NoPadReason::Ambiguous,
            Some(Err(PadError::NotThere(_))) | None => self.no_pad_reason = NoPadReason::Gone,
        }
    }

    fn identify_at(&self, pipeline: &Pipeline) -> Option<HostInstant> {
        let asking = self.opened.pad.is_some() && pipeline.identity().is_none();
        let due = IDENTIFY_US.get(self.identify_sent).filter(|_| asking)?;
        Some(self.identify_since.plus_us(*due))
    }

    /// Whether the first frame is still missing and patience is limited. Later nothing that a pad does ends the bridge.
    fn awaits_first_frame(&self, pipeline: &Pipeline) -> bool {
        self.patience == Patience::Limited && self.opened.pad.is_some() && pipeline.health().samples == 0
    }

    fn why_not_a_pad(&self) -> String {
        if let Some(finding) = self.finding() {
            return format!("sent nothing in 3 s that can be played with: {finding}");
        }
        match self.bytes_received {
            0 => "sent nothing for 3 s: check that the pad is powered and this is its port, or wait for it with --wait"
                .into(),
            bytes => format!(
                "sent {bytes} bytes in 3 s but not one tactpad frame: another device, or another baud rate \
                 (serial:PATH@BAUD)"
            ),
        }
    }
}
