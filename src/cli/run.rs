//! `tactpad run`: the live bridge.

use clap::Args;

use super::files::Files;
use super::live::{Output, Plan, bridge, open_pad, play};
use super::screen::Screen;
use super::{Failure, profile, say, seconds};
use crate::bridge::{Ending, Patience};
use crate::transport::address::PadAddress;

/// Arguments of `tactpad run`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad run --pad serial:/dev/ttyACM0 --profile tetris\n\n\
    Signals: SIGUSR1 releases everything, SIGUSR2 pauses and goes on, SIGHUP reads the profile again.")]
pub(super) struct Arguments {
    /// The pad: virtual, serial:PATH[@BAUD], capture:FILE.
    #[arg(long, value_name = "PAD", default_value = "auto")]
    pad: PadAddress,
    /// Wait for a pad that is not there yet or sends nothing yet.
    #[arg(long)]
    wait: bool,
    /// A profile's name or file.
    #[arg(long, default_value = "super-mario")]
    profile: String,
    /// Where events go: auto, uinput, x11, log:FILE, none.
    #[arg(long, default_value = "auto")]
    output: Output,
    /// End after this many seconds.
    #[arg(long, value_parser = seconds::parse, allow_hyphen_values = true)]
    seconds: Option<f64>,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { pad, profile, output, .. } = arguments;
    Files { pad, profile, output, capture: None }.check()?;
    let (text, profile) = profile::read(&arguments.profile, arguments.output.choice())?;
    let patience = if arguments.wait { Patience::Endless } else { Patience::Limited };
    let sink = arguments.output.open()?;
    let pad = open_pad(&arguments.pad, &profile, patience)?;
    let title = format!("{} → {} → {}", arguments.pad, profile.name, sink.describe());
    say(&title);
    let (mut bridge, _running) = bridge(Plan {
        pad,
        sink,
        profile_name: arguments.profile.clone(),
        profile_text: text,
        profile,
        choice: arguments.output.choice(),
        record: None,
        seconds: arguments.seconds,
        patience,
    })?;
    let screen = Screen::start(title, bridge.snapshot(), Vec::new);
    let ending = play(&mut bridge, &arguments.pad);
    drop(screen);
    if ending? == Ending::CaptureEnded {
        say("the capture has ended");
    }
    Ok(())
}
