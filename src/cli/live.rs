//! What the live verbs share: choosing and opening the pad, the output and the recorder.

use std::env;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::str::FromStr;

use rustix::event::{Timespec, poll};

use super::chosen::Chosen;
use super::device::Pad;
use super::field_cache::field_of;
use super::{Failure, profile};
use crate::bridge::clock::Clock;
use crate::bridge::keeper::{Patience, Reopen};
use crate::bridge::{Bridge, BridgeError, Ending, Parts, ReadProfile};
use crate::capture::{CallKind, CallRef, CaptureReader, CaptureWriter};
use crate::mapping::check::OutputChoice;
use crate::mapping::profile::Profile;
use crate::pipeline::{Pipeline, Refusal};
use crate::requests::Requests;
use crate::sink::{Sink, log::LogSink, null::NullSink, uinput::UinputSink, x11::X11Sink};
use crate::time::HostInstant;
use crate::transport::Transport;
use crate::transport::address::PadAddress;
use crate::transport::fault::{FaultPlan, FaultyLine};
use crate::transport::pads::{Opener, PadError};
use crate::transport::playback::Playback;
use crate::transport::virtual_pad::VirtualPad as PadOnTerminal;
use crate::virtual_pad::firmware::VirtualPad;
use crate::virtual_pad::script::Script;

/// The virtual pad of `run` and `record` plays this long, then rests.
const VIRTUAL_SCRIPT_US: u64 = 3_600_000_000;

/// A pad whose permissions are not set yet is tried again this often, …
const PERMISSION_TRIES: u32 = 20;

/// … with this pause between.
const PERMISSION_WAIT: Timespec = Timespec { tv_sec: 0, tv_nsec: 250_000_000 };

/// The virtual pad's noise is the same each time.
pub(super) const VIRTUAL_SEED: u64 = 1;

/// Where events are to go.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Output {
    /// The best that is there.
    Auto,
    /// Virtual devices of the kernel.
    Uinput,
    /// Keys of the X server.
    X11,
    /// An event log in a file.
    Log(PathBuf),
    /// Nowhere.
    None,
}

impl FromStr for Output {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once(':') {
            Some(("log", path)) if !path.is_empty() => Ok(Self::Log(path.into())),
            None if text == "auto" => Ok(Self::Auto),
            None if text == "uinput" => Ok(Self::Uinput),
            None if text == "x11" => Ok(Self::X11),
            None if text == "none" => Ok(Self::None),
            _ => Err("choose auto, uinput, x11, log:FILE or none".into()),
        }
    }
}

impl Output {
    /// X11 knows keys only; everything else uses the output that the profile names.
    pub(super) fn choice(&self) -> OutputChoice {
        if *self == Self::X11 { OutputChoice::Keyboard } else { OutputChoice::AsWritten }
    }

    /// Opens the sink. `Auto` means the kernel's virtual devices; what else would do is said in the error.
    pub(super) fn open(&self) -> Result<Box<dyn Sink>, Failure> {
        match self {
            Self::Auto | Self::Uinput => {
                let sink = UinputSink::open();
                Ok(Box::new(sink.map_err(|error| Failure::Unusable(with_alternatives(&error.message)))?))
            }
            Self::X11 => Ok(Box::new(X11Sink::open(None).map_err(|error| Failure::Unusable(error.message))?)),
            Self::Log(path) => {
                Ok(Box::new(LogSink::create(path).map_err(|error| Failure::Unusable(error.message))?))
            }
            Self::None => Ok(Box::new(NullSink)),
        }
    }
}

fn with_alternatives(message: &str) -> String {
    let x11 = if env::var_os("DISPLAY").is_some() { ", --output x11 for keys of the X server" } else { "" };
    format!("{message}\nUntil then: --output log:FILE for an event log{x11}")
}

/// An opened pad: its first opening, and how to open it again.
pub(super) struct OpenedPad {
    pub(super) pad: Option<Box<dyn Transport>>,
    pub(super) opener: Option<Reopen>,
    /// The virtual pad behind the terminal, if it is one; it ends when this is dropped.
    _virtual_pad: Option<PadOnTerminal>,
}

impl OpenedPad {
    /// The same pad on a bad line, each time it is opened. Without a plan it stays as it is.
    pub(super) fn with_faults(self, plan: Option<FaultPlan>) -> io::Result<Self> {
        let Some(plan) = plan else { return Ok(self) };
        let faulty =
            move |line| -> io::Result<Box<dyn Transport>> { Ok(Box::new(FaultyLine::new(line, &plan)?)) };
        let pad = self.pad.map(faulty).transpose()?;
        let opener = self.opener.map(|mut open| -> Reopen {
            Box::new(move || faulty(open()?).map_err(|error| PadError::Unusable(error.to_string())))
        });
        Ok(Self { pad, opener, ..self })
    }
}

/// Opens the pad at `address`. The virtual pad is `pad` and plays a script made for `profile`.
pub(super) fn open_pad(
    address: &PadAddress,
    pad: &Pad,
    profile: &Profile,
    patience: Patience,
) -> Result<OpenedPad, Failure> {
    match address {
        PadAddress::Virtual => open_virtual(pad, Script::for_profile(profile, VIRTUAL_SCRIPT_US)),
        _ if pad.is_given() => Err(Failure::Unusable(
            "--device and --imperfections say what the virtual pad is: add --pad virtual, or leave them out"
                .into(),
        )),
        PadAddress::Capture { file } => open_capture(file),
        PadAddress::Auto { .. } | PadAddress::Hid { .. } | PadAddress::Serial { .. } => {
            open_device(address.clone(), patience)
        }
    }
}

/// Opens a pad that is a device. With endless patience one that is not there yet is waited for.
fn open_device(address: PadAddress, patience: Patience) -> Result<OpenedPad, Failure> {
    let mut opener = Opener::new(address);
    let pad = match open_when_allowed(&mut opener, patience) {
        Ok(pad) => Some(pad),
        Err(PadError::NotThere(_) | PadError::Denied(_)) if patience == Patience::Endless => None,
        Err(error) => return Err(Failure::Unusable(error.to_string())),
    };
    Ok(OpenedPad { pad, opener: Some(Box::new(move || opener.open())), _virtual_pad: None })
}

/// Opens the pad. One that was plugged in just now may still be waiting for its permissions: tries for five seconds.
fn open_when_allowed(opener: &mut Opener, patience: Patience) -> Result<Box<dyn Transport>, PadError> {
    let mut opened = opener.open();
    let tries = if patience == Patience::Limited { PERMISSION_TRIES } else { 0 };
    for _ in 0..tries {
        if !matches!(opened, Err(PadError::Denied(_))) {
            break;
        }
        wait(PERMISSION_WAIT);
        opened = opener.open();
    }
    opened
}

/// Lets time pass before the bridge runs.
fn wait(time: Timespec) {
    let _ = poll(&mut [], Some(&time));
}

/// Starts a virtual pad that plays `script` and opens its terminal like any pad's port.
pub(super) fn open_virtual(pad: &Pad, script: Script) -> Result<OpenedPad, Failure> {
    let virtual_pad = if pad.is_given() {
        let device = pad.read()?;
        VirtualPad::of(script, &device, &field_of(&device)?, VIRTUAL_SEED)
    } else {
        VirtualPad::new(script, VIRTUAL_SEED)
    };
    let virtual_pad = PadOnTerminal::start(virtual_pad)?;
    let terminal =
        PadAddress::Serial { path: virtual_pad.path().to_owned(), baud: firmware_proto::DEFAULT_BAUD };
    let opened = open_device(terminal, Patience::Limited)?;
    Ok(OpenedPad { _virtual_pad: Some(virtual_pad), ..opened })
}

/// Plays the bytes of a capture at the pace at which they were recorded.
fn open_capture(path: &Path) -> Result<OpenedPad, Failure> {
    let unusable = |what: String| Failure::Unusable(format!("{} {what}", path.display()));
    let file = File::open(path).map_err(|error| unusable(format!("cannot be read: {error}")))?;
    let calls = CaptureReader::new(BufReader::new(file)).map_err(|error| unusable(error.to_string()))?;
    let mut last: Option<HostInstant> = None;
    let chunks = calls.map_while(Result::ok).filter_map(move |call| match call.kind {
        CallKind::Bytes(bytes) => {
            let delay_us = last.map_or(0, |last| call.now.us_since(last));
            last = Some(call.now);
            Some((delay_us, bytes))
        }
        _ => None,
    });
    let pad: Box<dyn Transport> = Box::new(Playback::start(chunks)?);
    Ok(OpenedPad { pad: Some(pad), opener: None, _virtual_pad: None })
}

/// What a live verb decided before it starts.
pub(super) struct Plan {
    pub(super) pad: OpenedPad,
    pub(super) sink: Box<dyn Sink>,
    pub(super) profile_name: String,
    pub(super) profile_text: String,
    pub(super) profile: Profile,
    pub(super) choice: OutputChoice,
    pub(super) decoder: Chosen,
    pub(super) record: Option<Box<dyn Write>>,
    pub(super) seconds: Option<f64>,
    pub(super) patience: Patience,
    pub(super) audience: Audience,
    pub(super) socket: Option<PathBuf>,
}

/// How long to wait for a pad: `auto` always waits, a named one only if that is asked for.
pub(super) fn patience(pad: &PadAddress, waits: Waits) -> Patience {
    match (pad, waits) {
        (PadAddress::Auto { .. }, _) | (_, Waits::Asked) => Patience::Endless,
        (_, Waits::NotAsked) => Patience::Limited,
    }
}

/// Whether `--wait` was given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Waits {
    /// It was.
    Asked,
    /// It was not.
    NotAsked,
}

/// A bridge for the plan; the opened pad must live as long as the bridge runs.
pub(super) fn bridge(plan: Plan) -> Result<(Bridge, RunningPad), Failure> {
    let clock = Clock::start();
    let now = clock.now();
    let Plan { pad: OpenedPad { pad, opener, _virtual_pad }, profile_text, choice, audience, .. } = plan;
    let mut profile_name = plan.profile_name;
    let begin = |to| begin_capture(to, now, plan.decoder.bytes.as_deref(), &profile_text, choice);
    let recorder = plan.record.map(begin).transpose()?;
    let parts = Parts {
        pipeline: Pipeline::new(plan.decoder.decoder, plan.profile),
        decoder: plan.decoder.name,
        pad,
        opener,
        sink: plan.sink,
        requests: requests(plan.socket.as_deref(), audience)?,
        recorder,
        read_profile: Box::new(move |name| {
            let chosen = name.unwrap_or(&profile_name).to_owned();
            let read = read_profile(&chosen, choice)?;
            // A profile that was chosen and can be used is the one to be read again.
            profile_name = chosen;
            Ok(read)
        }),
        tell: Box::new(move |line| audience.tell(line)),
        end_at: plan.seconds.map(|seconds| now.plus_us((seconds * 1e6) as u64)),
        patience: plan.patience,
        clock,
    };
    Ok((Bridge::new(parts), RunningPad { _virtual_pad }))
}

/// Keeps the virtual pad playing.
pub(super) struct RunningPad {
    _virtual_pad: Option<PadOnTerminal>,
}

/// The file of a capture.
pub(super) fn create_capture(path: &Path) -> Result<Box<dyn Write>, Failure> {
    match File::create(path) {
        Ok(file) => Ok(Box::new(BufWriter::new(file))),
        Err(error) => Err(Failure::Unusable(format!("{} cannot be written: {error}", path.display()))),
    }
}

/// Begins a capture with decoder and profile, so that it replays without another word.
fn begin_capture(
    to: Box<dyn Write>,
    now: HostInstant,
    decoder: Option<&[u8]>,
    text: &str,
    choice: OutputChoice,
) -> io::Result<CaptureWriter<Box<dyn Write>>> {
    let mut recorder = CaptureWriter::new(to)?;
    decoder.map_or(Ok(()), |bytes| recorder.write(now, CallRef::Decoder(bytes)))?;
    let call = match choice {
        OutputChoice::AsWritten => CallRef::Profile(text),
        OutputChoice::Keyboard => CallRef::KeyboardProfile(text),
    };
    recorder.write(now, call)?;
    Ok(recorder)
}

/// Reads a profile for the running bridge; the error is for people.
fn read_profile(name: &str, choice: OutputChoice) -> Result<ReadProfile, String> {
    profile::read(name, choice).map_err(|failure| match failure {
        Failure::Unusable(message) | Failure::Failed(message) => message,
        Failure::Unread => "nobody reads the warnings".into(),
    })
}

/// Who is told what the bridge is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Audience {
    /// Somebody who reads stderr.
    Stderr,
    /// Nobody, or somebody who watches the screen.
    Nobody,
}

impl Audience {
    pub(super) fn tell(self, line: &str) {
        if self == Self::Stderr {
            // Where nobody reads, the bridge plays on.
            let _ = writeln!(io::stderr(), "{line}");
        }
    }
}

/// Requests by signals and, where `socket` is given, through it. A second bridge plays without one.
fn requests(socket: Option<&Path>, audience: Audience) -> Result<Requests, Failure> {
    let mut requests = Requests::catch_signals()?;
    if let Some(path) = socket
        && let Err(error) = requests.listen(path)
    {
        audience.tell(&format!("`tactpad ctl` does not reach this bridge: {} ({error})", path.display()));
    }
    Ok(requests)
}

/// Runs the bridge and turns its errors into the program's.
pub(super) fn play(bridge: &mut Bridge, address: &PadAddress) -> Result<Ending, Failure> {
    bridge.run().map_err(|error| match error {
        BridgeError::NotAPad(why) => Failure::Unusable(format!("{address} {why}")),
        BridgeError::Refused(refusal) => Failure::Unusable(format!("{address} {}", why_refused(&refusal))),
        BridgeError::Sink(error) => Failure::Failed(error.message),
        BridgeError::Io(error) => Failure::Failed(error.to_string()),
    })
}

fn why_refused(refusal: &Refusal) -> String {
    match refusal {
        Refusal::NewerVersion(version) => format!(
            "speaks protocol version {version}; this tactpad knows up to {}: update tactpad",
            firmware_proto::PROTOCOL_VERSION
        ),
        Refusal::Unsuitable(identity) => format!(
            "says that it has {} channels of {} bits and {} pV per count; a pad has {} channels of 24 to 32 bits: \
             check its firmware",
            identity.channels,
            identity.count_bits,
            identity.picovolts_per_count,
            firmware_proto::CHANNELS
        ),
    }
}
