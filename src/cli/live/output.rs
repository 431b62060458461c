//! `--output`: where events are to go.

use std::env;
use std::path::PathBuf;
use std::str::FromStr;

use super::playing::tell_of_waiting;
use crate::cli::failure::Failure;
use tactpad::bridge::sink::{Sink, log::LogSink, null::NullSink, uinput::UinputSink, x11::X11Sink};
use tactpad::pipeline::mapping::check::OutputChoice;

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
                let sink = LogSink::create(path).map_err(|error| Failure::Unusable(error.message))?;
                tell_of_waiting(path, sink.waits_for_reader());
                Ok(Box::new(sink))
            }
            Self::None => Ok(Box::new(NullSink)),
        }
    }
}

fn with_alternatives(message: &str) -> String {
    let x11 = if env::var_os("DISPLAY").is_some() { ", --output x11 for keys of the X server" } else { "" };
    format!("{message}\nUntil then: --output log:FILE for an event log{x11}")
}
