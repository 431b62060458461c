//! Shared parts of the live verbs: opening the pad, messages to people, and the end of a run.

use std::io::{self, Write};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use super::described::DescribedPad;
use super::profile_reader::ProfileReader;
use super::profile_selection::ProfileSelection;
use super::runtime::{self, BridgeName};
use crate::cli::failure::Failure;
use crate::cli::files::device::PadOptions;
use crate::cli::files::field::field_of;
use crate::cli::printing::written::{is_stdout, reason, say, tell_in_passing};
use tactpad::bridge::destination::Destination;
use tactpad::bridge::error::BridgeError;
use tactpad::bridge::event_loop::{Bridge, Ending};
use tactpad::bridge::host::{Host, ProfileReply, ProfileRequest};
use tactpad::bridge::opening::{OpenError, OpenedPad, Patience};
use tactpad::bridge::profile_update::ProfileUpdate;
use tactpad::bridge::requests::Requests;
use tactpad::bridge::snapshot::Drops;
use tactpad::bridge::transport::address::PadAddress;
use tactpad::counted::counted;
use tactpad::pipeline::mapping::profile::Profile;
use tactpad::pipeline::mapping::read::ReadProfile;
use tactpad::pipeline::mapping::read::check::OutputChoice;
use tactpad::virtual_pad::firmware::VirtualPad;
use tactpad::virtual_pad::script::Script;

/// The virtual pad of `run` and `record` plays this long, then rests.
const VIRTUAL_SCRIPT_US: u64 = 3_600_000_000;

/// The virtual pad's noise is the same each time.
const VIRTUAL_SEED: u64 = 1;

/// Opens the pad at `address`, or the one that is described. The virtual pad is `pad` and plays a script made for `profile`.
pub(super) fn open_pad(
    address: &PadAddress,
    described: Option<&DescribedPad>,
    pad: &PadOptions,
    profile: &Profile,
    patience: Patience,
) -> Result<OpenedPad, Failure> {
    let opened = match address {
        PadAddress::Virtual => return open_virtual(pad, Script::for_profile(profile, VIRTUAL_SCRIPT_US)),
        _ if pad.is_given() => {
            return Err(Failure::Unusable(
                "--device and --imperfections say what the virtual pad is: add --pad virtual, or leave them out"
                    .into(),
            ));
        }
        _ if let Some(described) = described => described.open(patience),
        PadAddress::Capture { file } => OpenedPad::capture(file),
        PadAddress::Auto { .. }
        | PadAddress::Hid { .. }
        | PadAddress::Serial { .. }
        | PadAddress::Described { .. }
        | PadAddress::Usb { .. } => OpenedPad::device(address.clone(), patience),
    };
    opened.map_err(not_opened)
}

/// Starts a virtual pad that plays `script`.
pub(super) fn open_virtual(pad: &PadOptions, script: Script) -> Result<OpenedPad, Failure> {
    OpenedPad::simulated(virtual_pad(pad, script)?).map_err(not_opened)
}

/// The virtual pad, on which `script` is played.
pub(super) fn virtual_pad(pad: &PadOptions, script: Script) -> Result<VirtualPad, Failure> {
    if !pad.is_given() {
        return Ok(VirtualPad::new(script, VIRTUAL_SEED));
    }
    let device = pad.read()?;
    Ok(VirtualPad::of(script, &device, &field_of(&device)?, VIRTUAL_SEED))
}

pub(super) fn not_opened(error: OpenError) -> Failure {
    match error {
        OpenError::Io(error) => error.into(),
        error => Failure::Unusable(error.to_string()),
    }
}

/// How long to wait for a pad: `auto` always waits, a named one only if that is asked for.
pub(super) fn patience(pad: &PadAddress, waits: WaitOption) -> Patience {
    match (pad, waits) {
        (PadAddress::Auto { .. }, _) | (_, WaitOption::Given) => Patience::Endless,
        (_, WaitOption::NotGiven) => Patience::Limited,
    }
}

/// Whether `--wait` was given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum WaitOption {
    /// It was.
    Given,
    /// It was not.
    NotGiven,
}

/// The file of a capture, which is written where it stands: what was recorded before a crash is there. Or the pipe.
pub(super) fn create_capture(path: &Path) -> Result<Box<dyn Write + Send>, Failure> {
    if is_stdout(path) {
        return Ok(Box::new(io::stdout()));
    }
    match Destination::create(path) {
        Ok(to) => {
            tell_of_waiting(path, to.waits_for_reader());
            Ok(Box::new(to))
        }
        Err(error) => {
            let (path, why) = (path.display(), reason(&error));
            Err(Failure::Unusable(format!("{path} cannot be written: {why}; name another file")))
        }
    }
}

/// Says that nobody reads a pipe yet.
pub(super) fn tell_of_waiting(path: &Path, waits: bool) {
    if waits {
        say(format_args!("nobody reads the pipe {} yet: start its reader", path.display()));
    }
}

/// The host of a bridge that was started from a command line.
pub(super) struct TerminalHost {
    /// The profile that is read again when nobody names another one.
    selection: Arc<Mutex<ProfileSelection>>,
    profiles: ProfileReader,
    /// Address of the bridge's page.
    page: Option<String>,
    audience: Audience,
}

impl TerminalHost {
    /// A bridge that plays `profile` for an output of this kind.
    pub(super) fn new(profile: &str, output: OutputChoice, audience: Audience) -> io::Result<Self> {
        let selection = Arc::new(Mutex::new(ProfileSelection::of(profile)));
        let profiles = ProfileReader::start(Arc::clone(&selection), output, audience == Audience::Stderr)?;
        Ok(Self { selection, profiles, page: None, audience })
    }

    /// The same, of a bridge on this pad: what of `profile` does nothing on it is said now, and of others when they are read.
    pub(super) fn on_pad(self, pad: Option<&DescribedPad>, profile: &ReadProfile) -> Self {
        let mut selection = self.selection.lock().unwrap_or_else(PoisonError::into_inner);
        selection.described = pad.map(DescribedPad::source);
        let warnings = selection.shear_warnings(&selection.name, profile);
        drop(selection);
        if !warnings.is_empty() {
            say(warnings.trim_end());
        }
        self
    }

    /// The same, of a bridge that is shown at this address.
    pub(super) fn with_page(self, page: Option<String>) -> Self {
        Self { page, ..self }
    }

    /// The profile selection, shared with the thread that follows it.
    pub(super) fn selection(&self) -> Arc<Mutex<ProfileSelection>> {
        Arc::clone(&self.selection)
    }
}

impl Host for TerminalHost {
    fn read_profile(&mut self, request: ProfileRequest, reply: ProfileReply) {
        self.profiles.read(request, reply);
    }

    fn page(&self) -> Option<String> {
        self.page.clone()
    }

    fn wants(&self, update: &ProfileUpdate) -> bool {
        update.request_count == self.selection.lock().unwrap_or_else(PoisonError::into_inner).request_count
    }

    fn tell(&mut self, line: &str) {
        if self.audience == Audience::Stderr {
            tell_in_passing(line);
        }
    }
}

/// The reader of messages about the bridge.
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
            say(line);
        }
    }
}

/// Requests by signals alone.
pub(super) fn requests() -> Result<Requests, Failure> {
    let mut requests = Requests::new()?;
    requests.catch_signals()?;
    Ok(requests)
}

/// Requests by signals and through a socket, of the first of these names that no other bridge has; and that name. Without a socket the bridge plays, too.
pub(super) fn requests_at(
    names: impl Iterator<Item = Option<BridgeName>>,
    audience: Audience,
) -> Result<(Requests, Option<BridgeName>), Failure> {
    let mut requests = requests()?;
    let mut why = String::new();
    for name in names {
        let listens = runtime::socket_path(name.as_ref()).map_err(Failure::sentence).and_then(|path| {
            requests.listen(&path).map_err(|error| format!("{} ({})", path.display(), reason(&error)))
        });
        match listens {
            Ok(()) => return Ok((requests, name)),
            Err(error) if why.is_empty() => why = error,
            Err(_) => {}
        }
    }
    audience.tell(&format!("`tactpad ctl` does not reach this bridge: {why}"));
    Ok((requests, None))
}

/// A duration as the bridge has it.
pub(super) fn microseconds(seconds: f64) -> u64 {
    (seconds * 1e6) as u64
}

/// Runs the bridge, turns its errors into the program's, and says what is missing in logs and captures.
pub(super) fn play(bridge: &mut Bridge, address: &PadAddress) -> Result<Ending, Failure> {
    let ending = bridge.run();
    let Drops { groups_dropped, .. } = bridge.drops();
    if groups_dropped > 0 {
        say(format_args!("{} of events missing: not taken in time", counted(groups_dropped, "group")));
    }
    ending.map_err(|error| match error {
        BridgeError::NotAPad(_) | BridgeError::Refused(_) => Failure::Unusable(format!("{address} {error}")),
        error => Failure::Failed(error.to_string()),
    })
}
