//! `--output`: where events are to go.

use std::env;
use std::io::{self, Write};
use std::path::PathBuf;
use std::str::FromStr;

use super::playing::tell_of_waiting;
use super::{guardian, left_keys, runtime};
use crate::cli::failure::Failure;
use crate::cli::printing::written::{both_print, say};
use tactpad::bridge::sink::uinput::{self, UinputSink};
use tactpad::bridge::sink::{
    Sink, SinkError,
    log::LogSink,
    null::NullSink,
    x11::{HeldRecords, X11Sink},
};
use tactpad::pipeline::mapping::read::check::OutputChoice;

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
    /// An event log on standard output.
    Stdout,
    /// Nowhere.
    None,
}

impl FromStr for Output {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once(':') {
            Some(("log", "-")) => Ok(Self::Stdout),
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

    /// Refuses an output on standard output where `--json` prints there, too.
    pub(super) fn leaves_stdout(&self, json: bool) -> Result<(), Failure> {
        if json && *self == Self::Stdout { Err(both_print("--output log:-")) } else { Ok(()) }
    }

    /// Opens the sink. `Auto` means the kernel's virtual devices; what else would do is said in the error. What killed bridges left down
    /// is lifted first, wherever events go now.
    pub(super) fn open(&self) -> Result<Box<dyn Sink>, Failure> {
        left_keys::lift();
        match self {
            Self::Auto | Self::Uinput => {
                let sink = UinputSink::open();
                Ok(Box::new(sink.map_err(|error| Failure::Unusable(with_alternatives(&error.message)))?))
            }
            Self::X11 => open_x11(),
            Self::Log(path) => {
                let sink = LogSink::create(path).map_err(|error| Failure::Unusable(error.message))?;
                tell_of_waiting(path, sink.waits_for_reader());
                Ok(Box::new(sink))
            }
            Self::Stdout => log_to(io::stdout()),
            Self::None => Ok(Box::new(NullSink)),
        }
    }

    /// The same for people who watch: where `Auto` finds no virtual devices, `here` opens an event log, and the text
    /// says what would bring a better output.
    pub(super) fn open_or(
        &self,
        here: impl FnOnce() -> Result<Box<dyn Sink>, Failure>,
    ) -> Result<(Box<dyn Sink>, Option<String>), Failure> {
        match (self, uinput::available()) {
            (Self::Auto, Err(error)) => {
                left_keys::lift();
                Ok((here()?, Some(missing(&error))))
            }
            _ => Ok((self.open()?, None)),
        }
    }
}

/// Keys of the X server. What is held is recorded; without a folder for that it plays all the same.
fn open_x11() -> Result<Box<dyn Sink>, Failure> {
    let records = runtime::folder();
    if let Err(Failure::Failed(why)) = &records {
        say(format_args!("keys that are held stay down if this bridge is killed: {why}"));
    }
    let records = records.ok();
    let records = records.as_deref().map(|folder| HeldRecords { folder, guardian: guardian::program() });
    let sink = X11Sink::open(None, records);
    Ok(Box::new(sink.map_err(|error| Failure::Unusable(error.message))?))
}

/// An event log on standard output, or on what stands for it.
pub(super) fn log_to(stdout: impl Write + Send + 'static) -> Result<Box<dyn Sink>, Failure> {
    let sink = LogSink::new(stdout, "stdout".into());
    Ok(Box::new(sink.map_err(|error| Failure::Failed(error.message))?))
}

/// The message where an event log stands in for virtual devices.
fn missing(error: &SinkError) -> String {
    format!("Output: an event log, here. For a virtual gamepad: {}", error.message)
}

fn with_alternatives(message: &str) -> String {
    let x11 = if env::var_os("DISPLAY").is_some() { ", --output x11 for keys of the X server" } else { "" };
    format!("{message}\nUntil then: --output log:FILE for an event log{x11}")
}
