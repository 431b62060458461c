//! `tactpad record`: plays like `run` and writes down every call, so that `replay` gives the same events.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;

use super::live::{Audience, Output, Plan, bridge, create_capture, open_pad, play};
use super::{Failure, ctl, profile};
use crate::bridge::keeper::Patience;
use crate::transport::address::PadAddress;

/// Arguments of `tactpad record`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: tactpad record game.cap --pad serial:/dev/ttyACM0, then tactpad replay game.cap"
)]
pub(super) struct Arguments {
    /// The file to write.
    capture: PathBuf,
    /// The pad: virtual, serial:PATH[@BAUD], capture:FILE.
    #[arg(long, value_name = "PAD", default_value = "virtual")]
    pad: PadAddress,
    /// A profile's name or file; it is kept in the capture.
    #[arg(long, default_value = "super-mario")]
    profile: String,
    /// Where events go meanwhile: auto, uinput, x11, log:FILE, none.
    #[arg(long, default_value = "none")]
    output: Output,
    /// End after this many seconds; without it Ctrl-C ends.
    #[arg(long)]
    seconds: Option<f64>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (text, profile) = profile::read(&arguments.profile, arguments.output.choice())?;
    let sink = arguments.output.open()?;
    let pad = open_pad(&arguments.pad, &profile, Patience::Limited)?;
    writeln!(io::stderr(), "recording {} in {}", arguments.pad, arguments.capture.display())?;
    let (mut bridge, _running) = bridge(Plan {
        pad,
        sink,
        profile_name: arguments.profile.clone(),
        profile_text: text,
        profile,
        choice: arguments.output.choice(),
        record: Some(create_capture(&arguments.capture)?),
        seconds: arguments.seconds,
        patience: Patience::Limited,
        audience: Audience::Stderr,
        socket: Some(ctl::socket_path()),
    })?;
    play(&mut bridge, &arguments.pad)?;
    writeln!(io::stderr(), "{} samples recorded", bridge.health().samples)?;
    Ok(())
}
