//! `tactpad run`: the live bridge.

use std::io::{self, IsTerminal};

use clap::Args;

use super::chosen::Chosen;
use super::decoder_file::Choice;
use super::device::Pad;
use super::files::Files;
use super::live::{Audience, Output, Plan, Waits, bridge, open_pad, patience, play};
use super::screen::Screen;
use super::{Failure, chosen, ctl, profile, say, seconds};
use crate::bridge::Ending;
use crate::transport::address::PadAddress;
use crate::transport::fault::FaultPlan;

/// Arguments of `tactpad run`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad run --pad serial:/dev/ttyACM0 --profile tetris\n\n\
    `tactpad ctl` talks to it. Signals: SIGUSR1 releases everything, SIGUSR2 pauses and goes on, SIGHUP reads the \
    profile again.")]
pub(super) struct Arguments {
    /// The pad: auto[:SERIAL], hid:VID:PID[:SERIAL], serial:PATH[@BAUD], virtual, capture:FILE.
    #[arg(long, value_name = "PAD", default_value = "auto")]
    pad: PadAddress,
    /// Wait for a named pad that is not there yet or sends nothing yet; `auto` always waits.
    #[arg(long)]
    wait: bool,
    #[command(flatten)]
    device: Pad,
    /// A profile's name or file.
    #[arg(long, default_value = "super-mario")]
    profile: String,
    #[command(flatten)]
    decoder: Choice,
    /// Where events go: auto, uinput, x11, log:FILE, none.
    #[arg(long, default_value = "auto")]
    output: Output,
    /// Try a bad line: SEED[:FAULT=PROBABILITY,...] with drop, repeat, reorder, corrupt, delay, stall; each
    /// probability is per frame, and 0.001 where only a seed is given.
    #[arg(long, value_name = "FAULTS")]
    faults: Option<FaultPlan>,
    /// End after this many seconds.
    #[arg(long, value_parser = seconds::parse, allow_hyphen_values = true)]
    seconds: Option<f64>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { pad, profile, output, decoder, .. } = arguments;
    Files { pad, profile, output, decoder: chosen::file(decoder), capture: None }.check()?;
    let decoder = Chosen::read(decoder)?;
    let (text, profile) = profile::read(&arguments.profile, arguments.output.choice())?;
    let patience = patience(&arguments.pad, if arguments.wait { Waits::Asked } else { Waits::NotAsked });
    let sink = arguments.output.open()?;
    let pad =
        open_pad(&arguments.pad, &arguments.device, &profile, patience)?.with_faults(arguments.faults)?;
    let title = format!("{} → {} → {} → {}", arguments.pad, decoder.name, profile.name, sink.describe());
    // The live picture has the title and the state; without one they are told in words.
    let audience = if io::stdout().is_terminal() { Audience::Nobody } else { Audience::Stderr };
    audience.tell(&title);
    let (mut bridge, _running) = bridge(Plan {
        pad,
        sink,
        profile_name: arguments.profile.clone(),
        profile_text: text,
        profile,
        choice: arguments.output.choice(),
        decoder,
        record: None,
        seconds: arguments.seconds,
        patience,
        audience,
        socket: Some(ctl::socket_path()),
    })?;
    let screen = Screen::start(title, bridge.snapshot(), Vec::new);
    let ending = play(&mut bridge, &arguments.pad);
    drop(screen);
    if ending? == Ending::CaptureEnded {
        say("the capture has ended");
    }
    Ok(())
}
