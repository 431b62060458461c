//! Records ordinary play beside a running bridge, and reports now and then which changes of the pad it shows. The bridge waits for
//! neither: one thread replays its calls and writes, another one compares.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError};
use std::thread::{self, JoinHandle};

use clap::ValueEnum;
use rustix::event::{Timespec, poll};
use rustix::process::nice;

use super::kept_play;
use crate::cli::files::field::flaws;
use crate::cli::laboratory::diagnose::changes::{findings, line};
use crate::cli::printing::written::{quoted, say};
use firmware_proto::identity::SerialNumber;
use tactpad::bridge::bridge_parts::PlayingDecoder;
use tactpad::bridge::changes::{ChangesSlot, PadChanges};
use tactpad::bridge::observer::{Observation, Observer, observe};
use tactpad::bridge::transport::address::PadAddress;
use tactpad::lab::play::change::{Before, changed};
use tactpad::lab::play::kept::{KeptPlay, mark};
use tactpad::lab::play::reader::Reader;
use tactpad::lab::play::windows::Window;
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;
use tactpad::pipeline::contact::Decoder;

/// It looks this often for calls; the bridge never wakes it.
const LOOK: Timespec = Timespec { tv_sec: 0, tv_nsec: 100_000_000 };
/// Looks between two writes, if there is something new: half a minute.
const WRITE_LOOKS: u32 = 300;
/// Pressed windows of a tenth of a second before the first comparison, a minute of them, and then between two: three minutes.
const FIRST_PRESSED: usize = 600;
const NEXT_PRESSED: usize = 1_800;
/// How much the comparison gives way to all else on the machine.
const NICENESS: i32 = 10;

/// Whether play is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum KeepPlay {
    /// Play is kept.
    Yes,
    /// No play is kept.
    No,
}

/// The recording of play for a bridge that is about to be made; empty where nothing is recorded.
#[derive(Default)]
pub(super) struct PlayKeeping {
    observer: Option<Observer>,
    changes: ChangesSlot,
    thread: Option<JoinHandle<()>>,
}

/// The decoder with which play is compared.
#[derive(Clone)]
struct ReferenceDecoder {
    decoder: Decoder,
    file: String,
    mark: u64,
}

/// The thread that replays the bridge's calls and records them.
struct PlayRecorder {
    reference: ReferenceDecoder,
    changes: ChangesSlot,
    reader: Option<Reader>,
    /// Of the pad that is played on, and where it is kept.
    kept: Option<(KeptPlay, PathBuf)>,
    is_new: bool,
    /// Pressed windows since the last comparison.
    pressed: usize,
    has_compared: bool,
    comparing: Option<JoinHandle<()>>,
    is_refused: bool,
}

impl PlayKeeping {
    /// Play that was recorded is no new play, and without a decoder of this pad there is nothing to hold it against.
    pub(super) fn begin(keep: KeepPlay, pad: &PadAddress, decoder: &PlayingDecoder) -> io::Result<Self> {
        let reference = ReferenceDecoder::of(decoder).filter(|_| keep == KeepPlay::Yes);
        let is_recorded = matches!(pad, PadAddress::Capture { .. });
        let Some(reference) = reference.filter(|_| !is_recorded) else { return Ok(Self::default()) };
        let (observer, calls) = observe();
        let changes = ChangesSlot::default();
        let recorder = PlayRecorder::new(reference, changes.clone());
        let thread = thread::Builder::new().name("kept play".into()).spawn(move || recorder.run(&calls))?;
        Ok(Self { observer: Some(observer), changes, thread: Some(thread) })
    }

    /// The observer for the bridge, once.
    pub(super) const fn observer(&mut self) -> Option<Observer> {
        self.observer.take()
    }

    /// The slot for the changes that were found.
    pub(super) fn changes(&self) -> ChangesSlot {
        self.changes.clone()
    }

    /// Waits until all is written, once the bridge is gone.
    pub(super) fn end(self) {
        // Without a bridge its end would never come.
        drop(self.observer);
        let _ = self.thread.map(JoinHandle::join);
    }
}

impl ReferenceDecoder {
    fn of(playing: &PlayingDecoder) -> Option<Self> {
        let PlayingDecoder { decoder, place, file, .. } = playing;
        let has_errors = decoder.inverse().is_some_and(|it| !it.field_error().modes().is_empty());
        let (file, mark) = (place.clone()?, mark(file.as_ref()?));
        has_errors.then(|| Self { decoder: decoder.clone(), file, mark })
    }
}

impl PlayRecorder {
    const fn new(reference: ReferenceDecoder, changes: ChangesSlot) -> Self {
        Self {
            reference,
            changes,
            reader: None,
            kept: None,
            is_new: false,
            pressed: 0,
            has_compared: false,
            comparing: None,
            is_refused: false,
        }
    }

    /// Until the bridge ends.
    fn run(mut self, calls: &Receiver<Observation>) {
        let mut looks = 0;
        while self.drain(calls) {
            looks += 1;
            if looks % (WRITE_LOOKS / 10) == 0 {
                self.take();
                self.compare();
            }
            if looks % WRITE_LOOKS == 0 {
                self.write();
            }
            // Nothing wakes it: it lets time pass.
            let _ = poll(&mut [], Some(&LOOK));
        }
        self.take();
        self.write();
    }

    /// Makes all calls that wait; false once the bridge has ended.
    fn drain(&mut self, calls: &Receiver<Observation>) -> bool {
        loop {
            match calls.try_recv() {
                Ok(Observation::Call { at, call }) => {
                    if let Some(reader) = &mut self.reader {
                        reader.apply(at, call.as_call());
                    }
                }
                Ok(Observation::Checkpoint { pipeline, .. }) => {
                    self.take();
                    self.reader = Some(Reader::going_on(*pipeline));
                    if let Some((kept, _)) = &mut self.kept {
                        kept.sit_down();
                    }
                }
                Err(TryRecvError::Empty) => return true,
                Err(TryRecvError::Disconnected) => return false,
            }
        }
    }

    /// Takes what was played since, once the pad has told who it is.
    fn take(&mut self) {
        let Some(reader) = &mut self.reader else { return };
        let (windows, pad) = (reader.take(), reader.serial_number());
        let Some(pad) = pad.filter(|pad| !pad.as_str().is_empty()) else { return };
        self.attend(pad);
        let Some((kept, _)) = self.kept.as_mut().filter(|_| !windows.is_empty()) else { return };
        self.pressed += windows.iter().filter(|it| it.contact.is_some()).count();
        kept.add(&windows);
        self.is_new = true;
    }

    /// Goes over to what is kept of this pad.
    fn attend(&mut self, pad: SerialNumber) {
        if self.kept.as_ref().is_some_and(|(kept, _)| kept.pad == pad) {
            return;
        }
        self.write();
        let mark = self.reference.mark;
        self.kept = kept_play::place(pad, mark).map(|path| (kept_play::read(&path, pad, mark), path));
        self.has_compared = false;
    }

    fn write(&mut self) {
        let Some((kept, path)) = self.kept.as_ref().filter(|_| self.is_new) else { return };
        self.is_new = false;
        if let Err(error) = kept_play::write(path, kept)
            && !std::mem::replace(&mut self.is_refused, true)
        {
            say(format_args!("play is not kept: {} cannot be written: {error}", path.display()));
        }
    }

    /// Begins to compare, if there is enough that is new and nothing is being compared.
    fn compare(&mut self) {
        let Some((kept, path)) = &self.kept else { return };
        let is_due =
            if self.has_compared { self.pressed >= NEXT_PRESSED } else { kept.pressed() >= FIRST_PRESSED };
        if !is_due || self.comparing.as_ref().is_some_and(|it| !it.is_finished()) {
            return;
        }
        (self.pressed, self.has_compared) = (0, true);
        let (windows, pad, path) = (kept.windows().to_vec(), kept.pad, path.clone());
        // What its command names has to be there.
        self.is_new = true;
        self.write();
        let (reference, changes) = (self.reference.clone(), self.changes.clone());
        let compare = move || {
            // It counts for this thread alone. Where it is refused, it compares all the same.
            let _ = nice(NICENESS);
            if let Some(found) = reference.changes(&windows, pad, &path) {
                changes.set(found);
            }
        };
        self.comparing = thread::Builder::new().name("changes".into()).spawn(compare).ok();
    }
}

impl ReferenceDecoder {
    /// The changes that these windows show; `None` where there are too few windows.
    fn changes(&self, windows: &[Window], pad: SerialNumber, path: &Path) -> Option<PadChanges> {
        let device = Device::nominal();
        let field = PadField::nominal();
        let before = Before::Decoder(&self.decoder);
        let found = changed(before, windows, &device, &field, &flaws(&device), &|_, _| ()).ok()?;
        let mut text = line(&found);
        if !found.findings.is_empty() {
            let [play, decoder] = [&path.display().to_string(), &self.file].map(|it| quoted(it));
            text += &format!(": tactpad diagnose --play {play} --against {decoder}");
        }
        let findings = serde_json::to_value(findings(&found)).ok()?;
        Some(PadChanges { pad, since: self.file.clone(), findings, text })
    }
}
