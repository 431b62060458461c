//! `tactpad record`: plays like `run` and writes down every call, so that `replay` gives the same events.

use std::path::PathBuf;

use clap::Args;

use super::chosen::Chosen;
use super::decoder_file::Choice;
use super::device::Pad;
use super::files::Files;
use super::live::{Audience, Output, Plan, Waits, bridge, create_capture, open_pad, patience, play};
use super::written::Named;
use super::{Failure, chosen, ctl, profile, say, seconds};
use crate::transport::address::PadAddress;
use crate::transport::fault::FaultPlan;

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
    #[command(flatten)]
    device: Pad,
    /// A profile's name or file; it is kept in the capture, and so is the decoder.
    #[arg(long, default_value = "super-mario")]
    profile: String,
    #[command(flatten)]
    decoder: Choice,
    /// Where events go meanwhile: auto, uinput, x11, log:FILE, none.
    #[arg(long, default_value = "none")]
    output: Output,
    /// Try a bad line: SEED[:FAULT=PROBABILITY,...] with drop, repeat, reorder, corrupt, delay, stall; each
    /// probability is per frame, and 0.001 where only a seed is given.
    #[arg(long, value_name = "FAULTS")]
    faults: Option<FaultPlan>,
    /// End after this many seconds; without it Ctrl-C ends.
    #[arg(long, value_parser = seconds::parse, allow_hyphen_values = true)]
    seconds: Option<f64>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { capture, pad, profile, output, decoder, .. } = arguments;
    Files { pad, profile, output, decoder: chosen::file(decoder), capture: Some(capture) }.check()?;
    let decoder = Chosen::read(decoder)?;
    let (text, profile) = profile::read(&arguments.profile, arguments.output.choice())?;
    let sink = arguments.output.open()?;
    let patience = patience(&arguments.pad, Waits::NotAsked);
    let pad =
        open_pad(&arguments.pad, &arguments.device, &profile, patience)?.with_faults(arguments.faults)?;
    let place = capture.display().to_string();
    let capture = Named::new(create_capture(capture)?, place.clone());
    say(format_args!("recording {} in {place}", arguments.pad));
    let (mut bridge, _running) = bridge(Plan {
        pad,
        sink,
        profile_name: arguments.profile.clone(),
        profile_text: text,
        profile,
        choice: arguments.output.choice(),
        decoder,
        record: Some(Box::new(capture)),
        seconds: arguments.seconds,
        patience,
        audience: Audience::Stderr,
        socket: Some(ctl::socket_path()),
    })?;
    play(&mut bridge, &arguments.pad)?;
    say(format_args!("{} samples recorded", bridge.health().samples));
    Ok(())
}
