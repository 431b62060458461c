//! `--output`: where events are to go.

use std::env;
use std::fmt;
use std::io::{self, Write};
use std::path::PathBuf;
use std::str::FromStr;

use super::playing::tell_of_waiting;
use super::{guardian, left_keys, runtime};
use crate::cli::failure::Failure;
use crate::cli::printing::wrapped::{COLUMNS, lines};
use crate::cli::printing::written::{both_print, say};
use tactpad::bridge::sink::uinput::{self, UinputObstacle, UinputSink};
use tactpad::bridge::sink::{
    Sink,
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

impl fmt::Display for Output {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Uinput => f.write_str("uinput"),
            Self::X11 => f.write_str("x11"),
            Self::Log(path) => write!(f, "log:{}", path.display()),
            Self::Stdout => f.write_str("log:-"),
            Self::None => f.write_str("none"),
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
            Self::None => Ok(Box::new(NullSink::NOWHERE)),
        }
    }

    /// The same for people who watch: where `Auto` finds no virtual devices, `here` opens an event log, and the text
    /// says what would bring a better output.
    pub(super) fn open_or(
        &self,
        here: impl FnOnce() -> Result<Box<dyn Sink>, Failure>,
    ) -> Result<(Box<dyn Sink>, Option<String>), Failure> {
        match (self, uinput::available()) {
            (Self::Auto, Err(obstacle)) => {
                left_keys::lift();
                Ok((here()?, Some(missing(&obstacle, window_of_keys(variable)))))
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

/// The event log where people are: the live picture shows what is recorded, and without one it is lines on `stdout`.
pub(super) fn log_here(
    is_shown: bool,
    stdout: impl Write + Send + 'static,
) -> Result<Box<dyn Sink>, Failure> {
    if is_shown { Ok(Box::new(NullSink::SHOWN)) } else { log_to(stdout) }
}

/// The window that keys of an X server go to; `None` where there is no server.
pub(super) fn window_of_keys(variable: impl Fn(&str) -> Option<String>) -> Option<&'static str> {
    let is_set = |name| variable(name).is_some_and(|value| !value.is_empty());
    match (is_set("DISPLAY"), is_set("WAYLAND_DISPLAY")) {
        (false, _) => None,
        (true, false) => Some("the window in front"),
        (true, true) => Some("the window in front, if XWayland shows it"),
    }
}

/// A variable of the environment.
pub(super) fn variable(name: &str) -> Option<String> {
    env::var(name).ok()
}

/// The message where an event log stands in for virtual devices: the ways to a game, commands whole on their lines.
fn missing(obstacle: &UinputObstacle, window: Option<&str>) -> String {
    let UinputObstacle { why, mend } = obstacle;
    let way = mend.map_or_else(|| why.clone(), |mend| format!("`{mend}`"));
    let gamepad = format!("Output: an event log, here. For a virtual gamepad: {way}");
    let keys = window.map(|window| format!("For keys, which go to {window}: `--output x11`"));
    [Some(gamepad), keys]
        .into_iter()
        .flatten()
        .flat_map(|line| lines(&line, COLUMNS))
        .collect::<Vec<_>>()
        .join("\n")
}

fn with_alternatives(message: &str) -> String {
    let x11 = if window_of_keys(variable).is_some() { ", --output x11 for keys of the X server" } else { "" };
    format!("{message}\nUntil then: --output log:FILE for an event log{x11}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ways_to_a_game_stand_whole_on_lines_of_eighty_columns() {
        let obstacle = |mend| UinputObstacle { why: "/dev/uinput is not there".into(), mend };
        let told = |mend, window| missing(&obstacle(mend), window);
        let short = told(Some("sudo modprobe uinput"), Some("the window in front"));
        assert!(short.lines().all(|line| line.chars().count() <= COLUMNS), "{short}");
        assert!(short.lines().next().is_some_and(|line| line.ends_with("`sudo modprobe uinput`")), "{short}");
        assert!(short.ends_with("the window in front: `--output x11`"), "{short}");
        let long = told(Some(uinput::INSTALL_RULES), None);
        assert!(long.lines().any(|line| line == format!("`{}`", uinput::INSTALL_RULES)), "{long}");
        assert!(!long.contains("x11"), "without an X server: {long}");
    }

    #[test]
    fn an_output_is_written_as_it_is_read() {
        for text in ["auto", "uinput", "x11", "log:/tmp/events", "log:-", "none"] {
            assert_eq!(text.parse::<Output>().map(|output| output.to_string()).as_deref(), Ok(text));
        }
    }
}
