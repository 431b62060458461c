//! `tactpad run`: the live bridge.

use std::io;
use std::sync::Arc;

use clap::Args;
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use super::described::{DescribedPad, SourceOption};
use super::displays::DisplayOptions;
use super::figures::Figures;
use super::files::Files;
use super::follower;
use super::keeping::{KeepPlay, PlayKeeping};
use super::last_choice::ChosenPad;
use super::output::{Output, log_here};
use super::playing::{
    Audience, TerminalHost, WaitOption, microseconds, open_pad, patience, play, requests_at,
};
use super::profile_selection;
use super::runtime::BridgeName;
use super::screen::Screen;
use super::wired::WiringOption;
use super::{chosen, last_choice, runtime};
use crate::cli::failure::Failure;
use crate::cli::files::decoder_file::DecoderChoice;
use crate::cli::files::device::PadOptions;
use crate::cli::playing::profile;
use crate::cli::printing::seconds;
use crate::cli::printing::terminal;
use crate::cli::printing::written::{printable, say, wait_for_no_reader};
use tactpad::bridge::bridge_parts::BridgeParts;
use tactpad::bridge::clock::Clock;
use tactpad::bridge::event_loop::{Bridge, Ending};
use tactpad::bridge::sink::Sink as _;
use tactpad::bridge::sink::recording::RecordingSink;
use tactpad::bridge::transport::address::PadAddress;
use tactpad::bridge::transport::fault::FaultPlan;
use tactpad::bridge::transport::pads;

/// Arguments of `tactpad run`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad run --pad serial:/dev/ttyACM0 --profile tetris\n\n\
    `tactpad ctl` talks to it. Signals: SIGUSR1 releases everything, SIGUSR2 pauses and goes on. It ends with its \
    terminal, unless it was started with nohup; where it has none, SIGHUP reads the profile again.")]
pub(crate) struct Arguments {
    /// The pad: auto[:SERIAL], hid:VID:PID[:SERIAL], serial:PATH[@BAUD], usb:PORT[@BAUD], load-cells:PATH[@BAUD], tablet, touchpad, … (source list), virtual, capture:FILE.
    ///
    /// Without it the pad that `tactpad setup` was told, else auto.
    #[arg(long, value_name = "PAD")]
    pad: Option<PadAddress>,
    /// Wait for a named pad that is not there yet or sends nothing yet; `auto` always waits.
    #[arg(long)]
    wait: bool,
    #[command(flatten)]
    source: SourceOption,
    #[command(flatten)]
    wired: WiringOption,
    #[command(flatten)]
    device: PadOptions,
    /// A profile's name or file; it is read again when it is changed. Or auto[:NAME]: the one whose [[program]] is in front, else NAME.
    ///
    /// Without it the profile that was chosen last by `tactpad setup` or in the tray, else super-mario.
    #[arg(long)]
    profile: Option<String>,
    #[command(flatten)]
    decoder: DecoderChoice,
    /// Where events go: auto (virtual devices, else an event log here), uinput, x11, log:FILE (- is stdout), none.
    ///
    /// Without it what was chosen in `tactpad setup`, else auto.
    #[arg(long)]
    output: Option<Output>,
    #[command(flatten)]
    shown: DisplayOptions,
    /// Try a bad line: SEED[:FAULT=PROBABILITY,...] with drop, repeat, reorder, corrupt, delay, stall; each
    /// probability is per frame, and 0.001 where only a seed is given.
    #[arg(long, value_name = "FAULTS")]
    faults: Option<FaultPlan>,
    /// Keep the newest ten minutes of play, on this machine alone, to say what changed in the pad: docs/home.md.
    ///
    /// It is kept for pads with a serial number whose decoder calibrate or adapt made.
    #[arg(long, value_name = "WHETHER", default_value = "yes")]
    keep_play: KeepPlay,
    /// A name for this bridge where several play at once, each on its pad: `tactpad ctl --name NAME` talks to it.
    #[arg(long, value_name = "NAME")]
    name: Option<BridgeName>,
    /// End after this many seconds.
    #[arg(long, value_parser = seconds::parse, allow_hyphen_values = true)]
    seconds: Option<f64>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    wait_for_no_reader()?;
    let decoder = &arguments.decoder;
    let output = &arguments.output.clone().unwrap_or_else(last_choice::output);
    let ChosenPad { address: pad, source } = arguments.chosen_pad();
    let (pad, source) = (&pad, arguments.source.or(source));
    let selected = arguments.profile.clone().unwrap_or_else(last_choice::profile);
    let profile = profile_selection::first(&selected);
    Files { pad, profile, output, decoder: chosen::file(decoder), capture: None }.check()?;
    let described = source.read(pad, decoder)?;
    let decoder = described.as_ref().map_or_else(|| chosen::read(decoder), DescribedPad::decoder)?;
    let audience = audience(output);
    let host = TerminalHost::new(&selected, output.choice(), audience)?;
    let selection = host.selection();
    let profile = profile::read(profile, output.choice())?;
    let host = host.on_pad(described.as_ref(), &profile);
    // Who names no pad waits for the one that was chosen.
    let waits = arguments.wait || arguments.pad.is_none();
    let patience = patience(pad, if waits { WaitOption::Given } else { WaitOption::NotGiven });
    let is_shown = audience == Audience::Nobody;
    let (sink, missing) = output.open_or(|| log_here(is_shown, io::stdout()))?;
    let sink = RecordingSink::counting(sink);
    let recorded = sink.recorded();
    let opened = open_pad(pad, described.as_ref(), &arguments.device, profile.profile(), patience)?;
    let opened = opened.with_wiring(arguments.wired.wiring).with_faults(arguments.faults)?;
    let name = &profile.profile().name;
    let (requests, reached) = match &arguments.name {
        Some(name) => requests_at([Some(name.clone())].into_iter(), audience)?,
        None => requests_at([None].into_iter().chain(BridgeName::numbers()), audience)?,
    };
    let second = reached.as_ref().filter(|_| arguments.name.is_none());
    let second = second.map(|name| format!(" (tactpad ctl --name {name})")).unwrap_or_default();
    let title = format!("{pad} → {} → {name} → {}{second}", decoder.name, sink.describe());
    let title = printable(&title);
    let prints = *output == Output::Stdout || (missing.is_some() && !is_shown);
    if let Some(missing) = missing {
        say(missing);
    }
    audience.tell(&title);
    if let Some(leave) = described.as_ref().and_then(DescribedPad::leave) {
        audience.tell(leave);
    }
    let memory = runtime::page_memory(reached.as_ref().or(arguments.name.as_ref()));
    let mut prepared = arguments.shown.prepare(
        &memory,
        reached.as_ref(),
        &requests,
        &selection,
        output.choice(),
        (pad, &arguments.device),
    )?;
    if let Some(url) = &prepared.url {
        say(format_args!("Dashboard: {url}"));
    }
    follower::start(selection, output.choice(), requests.sender()?, audience)?;
    let mut keeping = PlayKeeping::begin(arguments.keep_play, pad, &decoder)?;
    let mut bridge = Bridge::new(BridgeParts {
        clock: Clock::start(),
        pad: prepared.pad(opened),
        patience,
        decoder,
        profile,
        sink: prepared.sink(Box::new(sink)),
        requests,
        host: Box::new(host.with_page(prepared.url.clone())),
        record: None,
        observers: prepared.observer.take().into_iter().chain(keeping.observer()).collect(),
        changes: keeping.changes(),
        duration_us: arguments.seconds.map(microseconds),
    })?;
    prepared.start(&bridge)?;
    let screen = is_shown.then(|| Screen::start(title, bridge.snapshot(), Arc::clone(&recorded)));
    let ending = play(&mut bridge, pad);
    drop(screen);
    let figures = recorded.lock().map(|recorded| Figures::of(&bridge, &recorded)).ok();
    // What keeps play ends with what it hears.
    drop(bridge);
    keeping.end();
    ended(ending, prints, figures.as_ref())
}

impl Arguments {
    /// The pad that is meant; what was chosen before stands back behind a pad or description that is named.
    fn chosen_pad(&self) -> ChosenPad {
        let auto = PadAddress::Auto { serial_number: None };
        let named = self.pad.clone().or_else(|| self.source.is_given().then(|| auto.clone()));
        match named {
            Some(address) => ChosenPad { address, source: None },
            None => {
                let kept = last_choice::pad().unwrap_or(ChosenPad { address: auto, source: None });
                if kept.address == PadAddress::Virtual && !pads::attached().is_empty() {
                    say(
                        "a pad is attached, and `tactpad setup` chose one of software: --pad auto takes the one that is attached",
                    );
                }
                kept
            }
        }
    }
}

/// How the run ended, and what was played.
fn ended(ending: Result<Ending, Failure>, prints: bool, figures: Option<&Figures>) -> Result<(), Failure> {
    match ending {
        Err(_) if prints && is_unread() => return Err(Failure::Unread),
        Ok(Ending::CaptureEnded) => say("the capture has ended"),
        Ok(_) => {}
        Err(failure) => return Err(failure),
    }
    if let Some(figures) = figures {
        say(figures.lines().join("\n"));
    }
    Ok(())
}

/// The live picture has the title and the state; without one they are told in words.
fn audience(output: &Output) -> Audience {
    let is_shown = *output != Output::Stdout && terminal::moves_cursor(&io::stdout());
    if is_shown { Audience::Nobody } else { Audience::Stderr }
}

/// Whether the reader of standard output went away.
fn is_unread() -> bool {
    let stdout = io::stdout();
    let mut asked = [PollFd::new(&stdout, PollFlags::empty())];
    let at_once = Timespec { tv_sec: 0, tv_nsec: 0 };
    poll(&mut asked, Some(&at_once)).is_ok()
        && asked.iter().any(|stdout| stdout.revents().contains(PollFlags::ERR))
}
