//! `tactpad record`: plays like `run` and writes down every call, so that `replay` gives the same events.

use std::io;
use std::path::PathBuf;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::Duration;

use clap::Args;

use super::chosen;
use super::described::{DescribedPad, SourceOption};
use super::files::{self, Files};
use super::output::{Output, log_to};
use super::playing::{
    Audience, TerminalHost, WaitOption, create_capture, microseconds, open_pad, patience, play, requests_at,
};
use super::runtime::BridgeName;
use super::wired::WiringOption;
use crate::cli::failure::Failure;
use crate::cli::files::decoder_file::DecoderChoice;
use crate::cli::files::device::PadOptions;
use crate::cli::playing::profile;
use crate::cli::printing::seconds;
use crate::cli::printing::written::{Named, say, wait_for_no_reader};
use tactpad::bridge::bridge_parts::BridgeParts;
use tactpad::bridge::changes::ChangesSlot;
use tactpad::bridge::clock::Clock;
use tactpad::bridge::event_loop::Bridge;
use tactpad::bridge::transport::address::PadAddress;
use tactpad::bridge::transport::fault::FaultPlan;
use tactpad::counted::counted;

/// Arguments of `tactpad record`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad record game.cap --pad auto, then tactpad replay game.cap")]
pub(crate) struct Arguments {
    /// The file to write; a file that is there already is kept, and - is standard output.
    capture: PathBuf,
    /// Write over a file that is there already.
    #[arg(long)]
    force: bool,
    /// The pad: virtual, auto[:SERIAL], hid:VID:PID[:SERIAL], serial:PATH[@BAUD], usb:PORT[@BAUD], load-cells:PATH[@BAUD], tablet, touchpad, … (source list), capture:FILE.
    #[arg(long, value_name = "PAD", default_value = "virtual")]
    pad: PadAddress,
    #[command(flatten)]
    source: SourceOption,
    #[command(flatten)]
    wired: WiringOption,
    #[command(flatten)]
    device: PadOptions,
    /// A profile's name or file; it is kept in the capture, and so is the decoder.
    #[arg(long, default_value = "super-mario")]
    profile: String,
    #[command(flatten)]
    decoder: DecoderChoice,
    /// Where events go meanwhile: auto (virtual devices, else an event log here), uinput, x11, log:FILE (- is stdout),
    /// none.
    #[arg(long, default_value = "none")]
    output: Output,
    /// Try a bad line: SEED[:FAULT=PROBABILITY,...] with drop, repeat, reorder, corrupt, delay, stall; each
    /// probability is per frame, and 0.001 where only a seed is given.
    #[arg(long, value_name = "FAULTS")]
    faults: Option<FaultPlan>,
    /// End after this many seconds; without it Ctrl-C ends.
    #[arg(long, value_parser = seconds::parse, allow_hyphen_values = true)]
    seconds: Option<f64>,
    /// Say when to press lightly and when hard, for tune --force-range; it ends after 30 s, or after --seconds. It is for your own
    /// hand: give --pad auto.
    #[arg(long)]
    force_range: bool,
}

/// How long presses for the force range are recorded, and what is said at the begin and in the middle.
const FORCE_RANGE_S: f64 = 30.0;
const FORCE_RANGE_CUES: [&str; 2] = [
    "press again and again as lightly as feels sure, and lift the finger after each press",
    "and now again and again as hard as is comfortable",
];

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    wait_for_no_reader()?;
    let Arguments { capture, pad, profile, output, decoder, .. } = arguments;
    Files { pad, profile, output, decoder: chosen::file(decoder), capture: Some(capture) }.check()?;
    if !arguments.force {
        files::keep_file(capture, ", or give --force to write over it")?;
    }
    let described = arguments.source.read(pad, decoder)?;
    let decoder = described.as_ref().map_or_else(|| chosen::read(decoder), DescribedPad::decoder)?;
    let profile = profile::read(profile, output.choice())?;
    let (sink, missing) = output.open_or(|| log_to(io::stdout()))?;
    let patience = patience(&arguments.pad, WaitOption::NotGiven);
    let opened = open_pad(pad, described.as_ref(), &arguments.device, profile.profile(), patience)?;
    let opened = opened.with_wiring(arguments.wired.wiring).with_faults(arguments.faults)?;
    let place = capture.display().to_string();
    let capture = Named::new(create_capture(capture)?, place.clone());
    if let Some(missing) = missing {
        say(missing);
    }
    say(format_args!("recording {} in {place}", arguments.pad));
    let audience = Audience::Stderr;
    let host = TerminalHost::new(&arguments.profile, output.choice(), audience)?;
    let host = host.on_pad(described.as_ref(), &profile);
    let seconds = arguments.seconds.or(arguments.force_range.then_some(FORCE_RANGE_S));
    let mut bridge = Bridge::new(BridgeParts {
        clock: Clock::start(),
        pad: opened,
        patience,
        decoder,
        profile,
        sink,
        requests: requests_at([None].into_iter().chain(BridgeName::numbers()), audience)?.0,
        host: Box::new(host),
        record: Some(Box::new(capture)),
        observers: Vec::new(),
        changes: ChangesSlot::default(),
        duration_us: seconds.map(microseconds),
    })?;
    let cue = seconds.filter(|_| arguments.force_range).map(cue);
    play(&mut bridge, &arguments.pad)?;
    drop(cue);
    match bridge.drops().calls_unrecorded {
        0 => {
            say(format_args!("{} recorded", counted(bridge.health().samples, "sample")));
            Ok(())
        }
        missing => Err(Failure::Failed(format!(
            "{place} did not take what was recorded: {} missing at its end; record to a faster disk, or \
             see that the pipe is read",
            counted(missing, "call")
        ))),
    }
}

/// Says what to press: now, and in the middle of so many seconds, unless what it gives back is gone by then.
fn cue(seconds: f64) -> Sender<()> {
    let [light, hard] = FORCE_RANGE_CUES;
    say(light);
    let (held, gone) = channel();
    let half = Duration::from_secs_f64(seconds / 2.0);
    thread::spawn(move || {
        if gone.recv_timeout(half) == Err(RecvTimeoutError::Timeout) {
            say(hard);
        }
    });
    held
}
