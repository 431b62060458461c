//! Keeps the pad: opens it, asks who it is, notices that it left, and looks for it again.

use std::io;

use firmware_proto::command::Command;

use crate::error::BridgeError;
use crate::opening::{OpenedPad, Patience};
use crate::transport::Transport;
use crate::transport::pads::PadError;
use tactpad_core::pipeline::Pipeline;
use tactpad_core::time::HostInstant;

/// A pad that has not sent one sound frame by then is no pad, or not there.
const FIRST_FRAME_US: u64 = 3_000_000;

/// An unplugged pad is looked for this often. So one whose permissions come late is opened as soon as they are there.
const REOPEN_US: u64 = 250_000;

/// So many reads are passed over at most: more than a port keeps.
const SKIPS_MAX: usize = 64;

/// A pad that is still starting may miss a question: it is asked again after these times.
const IDENTIFY_US: [u64; 3] = [0, 250_000, 1_000_000];

/// Why there is no pad at the moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Absence {
    /// It is not there.
    Gone,
    /// It is there but may not be opened.
    Denied,
    /// Something is there, but not one pad: several, or what cannot be used.
    Unclear,
}

/// The pad, or the search for it.
pub(super) struct Keeper {
    /// The pad while there is one, and how to open it again.
    opened: OpenedPad,
    patience: Patience,
    absence: Absence,
    opened_at: HostInstant,
    reopen_at: HostInstant,
    /// When asking began: at the opening, and anew when the pad began anew or was heard after silence.
    asking_since: HostInstant,
    identify_asked: usize,
    /// Whether the pad was heard, and how often it had begun anew, at the last look.
    seen: (bool, u64),
    /// Whether this is still the pad that was opened first.
    is_first: bool,
    bytes_heard: u64,
}

impl Keeper {
    /// Keeps a pad that was opened just now. One that cannot be opened again ends for good when it leaves.
    pub(super) const fn new(opened: OpenedPad, patience: Patience, now: HostInstant) -> Self {
        Self {
            opened,
            patience,
            absence: Absence::Gone,
            opened_at: now,
            reopen_at: now,
            asking_since: now,
            identify_asked: 0,
            seen: (false, 0),
            is_first: true,
            bytes_heard: 0,
        }
    }

    /// The pad, if there is one.
    pub(super) fn pad(&self) -> Option<&dyn Transport> {
        self.opened.pad.as_deref()
    }

    /// Why there is none; `None` while there is one.
    pub(super) fn absence(&self) -> Option<Absence> {
        self.opened.pad.is_none().then_some(self.absence)
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
                self.bytes_heard += read as u64;
                Ok(Some(read))
            }
            Err(error) if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted) => {
                Ok(None)
            }
            Err(error) => Err(error),
        }
    }

    /// Passes over what the pad has sent by now; one that was not heard yet gets its time anew.
    pub(super) fn skip(&mut self, now: HostInstant, bytes: &mut [u8]) {
        self.opened_at = now;
        // A pad sends more slowly than this reads; a recording may not. A pad that is gone is noticed by who reads next.
        for _ in 0..SKIPS_MAX {
            if !matches!(self.read(bytes), Ok(Some(_))) {
                return;
            }
        }
    }

    /// The pad left: looks for it from now on.
    pub(super) fn lose(&mut self, now: HostInstant) {
        (self.opened.pad, self.absence, self.is_first) = (None, Absence::Gone, false);
        self.reopen_at = now.plus_us(REOPEN_US);
    }

    /// Closes the pad for good.
    pub(super) fn close(&mut self) {
        (self.opened.pad, self.opened.opener) = (None, None);
    }

    /// When [`Keeper::attend`] has something to do.
    pub(super) fn next_deadline(&self, pipeline: &Pipeline) -> Option<HostInstant> {
        let reopen = self.reopens().then_some(self.reopen_at);
        let first_frame = self.is_unheard(pipeline).then(|| self.opened_at.plus_us(FIRST_FRAME_US));
        [reopen, first_frame, self.identify_at(pipeline)].into_iter().flatten().min()
    }

    /// Looks for a pad that left, asks one that came who it is, and gives up on what is no pad.
    ///
    /// # Errors
    /// What was opened first is no pad, or none that can be played with.
    pub(super) fn attend(&mut self, now: HostInstant, pipeline: &Pipeline) -> Result<(), BridgeError> {
        if self.is_first
            && self.patience == Patience::Limited
            && let Some(refusal) = pipeline.refusal()
        {
            return Err(BridgeError::Refused(*refusal));
        }
        if self.is_unheard(pipeline) && now >= self.opened_at.plus_us(FIRST_FRAME_US) {
            return Err(BridgeError::NotAPad(self.why_not_a_pad()));
        }
        let seen = (pipeline.is_heard(), pipeline.health().restarts);
        if seen != self.seen {
            // A pad that was powered late, or began anew, has missed the questions so far.
            (self.seen, self.asking_since, self.identify_asked) = (seen, now, 0);
        }
        if self.reopens() && now >= self.reopen_at {
            self.reopen(now);
        }
        if self.identify_at(pipeline).is_some_and(|due| due <= now) {
            self.identify_asked += 1;
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
                (self.opened.pad, self.opened_at, self.asking_since) = (Some(pad), now, now);
                self.identify_asked = 0;
            }
            Some(Err(PadError::Denied(_))) => self.absence = Absence::Denied,
            Some(Err(PadError::Unusable(_))) => self.absence = Absence::Unclear,
            Some(Err(PadError::NotThere(_))) | None => self.absence = Absence::Gone,
        }
    }

    fn identify_at(&self, pipeline: &Pipeline) -> Option<HostInstant> {
        let asking = self.opened.pad.is_some() && pipeline.identity().is_none();
        let due = IDENTIFY_US.get(self.identify_asked).filter(|_| asking)?;
        Some(self.asking_since.plus_us(*due))
    }

    /// Whether no pad has played yet and patience is limited. Later nothing that a pad does ends the bridge.
    fn is_unheard(&self, pipeline: &Pipeline) -> bool {
        self.patience == Patience::Limited && self.opened.pad.is_some() && pipeline.health().samples == 0
    }

    fn why_not_a_pad(&self) -> String {
        match self.bytes_heard {
            0 => "sent nothing for 3 s: check that the pad is powered and this is its port, or wait for it with --wait"
                .into(),
            bytes => format!(
                "sent {bytes} bytes in 3 s but not one tactpad frame: another device, or another baud rate \
                 (serial:PATH@BAUD)"
            ),
        }
    }
}
