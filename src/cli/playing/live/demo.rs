//! `tactpad demo`: the main job with nothing attached, and the proof that it went right.

use std::io::{self, IsTerminal, Write};
use std::sync::Arc;

use clap::Args;

use super::chosen;
use super::displays::DisplayOptions;
use super::figures::Figures;
use super::files::Files;
use super::last_choice;
use super::output::{Output, log_here};
use super::playing::{Audience, TerminalHost, microseconds, open_virtual, play, requests_at};
use super::profile_selection::first;
use super::runtime::BridgeName;
use super::screen::Screen;
use crate::cli::failure::{Failure, if_read};
use crate::cli::files::decoder_file::DecoderChoice;
use crate::cli::files::device::PadOptions;
use crate::cli::playing::profile;
use crate::cli::printing::seconds;
use crate::cli::printing::terminal;
use crate::cli::printing::written::{print_json, say, stdout, wait_for_no_reader};
use tactpad::bridge::bridge_parts::BridgeParts;
use tactpad::bridge::changes::ChangesSlot;
use tactpad::bridge::clock::Clock;
use tactpad::bridge::event_loop::{Bridge, Ending};
use tactpad::bridge::opening::Patience;
use tactpad::bridge::sink::Sink;
use tactpad::bridge::sink::recording::{ExpectedEvent, RecordedEvents, RecordingSink};
use tactpad::bridge::transport::address::PadAddress;
use tactpad::counted::counted;
use tactpad::pipeline::control::OutputDevice;
use tactpad::pipeline::mapping::profile::Profile;
use tactpad::virtual_pad::script::Script;

/// Arguments of `tactpad demo`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad demo --seconds 10 --profile contra")]
pub(crate) struct Arguments {
    /// How long to play: 20 without it, and with --dashboard until it is stopped.
    #[arg(long, value_parser = seconds::parse, allow_hyphen_values = true)]
    seconds: Option<f64>,
    /// A profile's name or file.
    ///
    /// Without it the profile that was chosen last by `tactpad setup` or in the tray, else super-mario.
    #[arg(long)]
    profile: Option<String>,
    #[command(flatten)]
    decoder: DecoderChoice,
    #[command(flatten)]
    device: PadOptions,
    /// Where events go: auto (a virtual gamepad, else the screen), uinput, x11, log:FILE (- is stdout), none.
    #[arg(long, default_value = "auto")]
    output: Output,
    #[command(flatten)]
    shown: DisplayOptions,
    /// Print one JSON document on stdout.
    #[arg(long)]
    json: bool,
}

/// It plays so long unless people say how long.
const SECONDS: f64 = 20.0;

/// No gesture of the player takes longer.
const SECONDS_OF_A_GESTURE_MAX: u32 = 60;

/// The state file of the page's addresses; no name of a bridge has a dot.
const PAGE_MEMORY: &str = "page-addresses.demo";

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    wait_for_no_reader()?;
    let Arguments { output, decoder, json, .. } = arguments;
    output.leaves_stdout(*json)?;
    let selected = arguments.profile.clone().unwrap_or_else(last_choice::profile);
    let selected = first(&selected);
    Files {
        pad: &PadAddress::Virtual,
        profile: selected,
        output,
        decoder: chosen::file(decoder),
        capture: None,
    }
    .check()?;
    let decoder = chosen::read(decoder)?;
    let profile = profile::read(selected, output.choice())?;
    let duration = arguments.duration();
    let script = script(profile.profile(), duration)?;
    let verdict = Verdict::of(&script, profile.profile());
    let name = profile.profile().name.clone();
    let (sink, title) = open_sink(arguments, profile.profile())?;
    if_read(tell(arguments, &title))?;
    let recording = if duration.is_some() { RecordingSink::new(sink) } else { RecordingSink::counting(sink) };
    let recorded = recording.recorded();
    let audience = Audience::Nobody;
    let host = TerminalHost::new(selected, output.choice(), audience)?;
    let (requests, reached) = requests_at(BridgeName::of_demos(), audience)?;
    let mut prepared = arguments.shown.prepare(
        PAGE_MEMORY,
        reached.as_ref(),
        &requests,
        &host.selection(),
        output.choice(),
        (&PadAddress::Virtual, &arguments.device),
    )?;
    if let Some(url) = &prepared.url {
        if_read(tell(arguments, &format!("Dashboard: {url}")))?;
    }
    let mut bridge = Bridge::new(BridgeParts {
        clock: Clock::start(),
        pad: prepared.pad(open_virtual(&arguments.device, script)?),
        patience: Patience::Limited,
        decoder,
        profile,
        sink: prepared.sink(Box::new(recording)),
        requests,
        host: Box::new(host.with_page(prepared.url.clone())),
        record: None,
        observers: prepared.observer.take().into_iter().collect(),
        changes: ChangesSlot::default(),
        duration_us: duration.map(microseconds),
    })?;
    prepared.start(&bridge)?;
    let screen = is_shown(arguments)
        .then(|| Screen::start(format!("{name} on a virtual pad"), bridge.snapshot(), Arc::clone(&recorded)));
    let played = play(&mut bridge, &PadAddress::Virtual);
    drop(screen);
    let ending = played?;
    let recorded = recorded.lock().map(|recorded| recorded.clone()).unwrap_or_default();
    if_read(report(arguments, &Figures::of(&bridge, &recorded)))?;
    if arguments.shown.has_page() {
        // Whoever sees the page may have changed what is played.
        return Ok(());
    }
    verdict.check(ending, &recorded, &bridge)?;
    if_read(tell(arguments, &verdict.words()))?;
    if_read(tell_next(arguments))
}

impl Arguments {
    /// How long it plays, in seconds; `None` where it plays until it is stopped.
    fn duration(&self) -> Option<f64> {
        self.seconds.or((!self.shown.has_page()).then_some(SECONDS))
    }
}

/// The script of the player. A time in which nothing can be played is refused, unless nothing ever can.
fn script(profile: &Profile, seconds: Option<f64>) -> Result<Script, Failure> {
    let Some(seconds) = seconds else { return Ok(Script::endless(profile)) };
    let script = Script::for_profile(profile, microseconds(seconds));
    let plays =
        |seconds: &u32| Script::for_profile(profile, microseconds(f64::from(*seconds))).contacts() > 0;
    match (1..=SECONDS_OF_A_GESTURE_MAX).find(plays) {
        Some(least) if script.contacts() == 0 => Err(Failure::Unusable(format!(
            "--seconds {seconds} is too short for anything to be played: give it {least} or more"
        ))),
        _ => Ok(script),
    }
}

/// Why events may differ from the script without any fault of the bridge's.
const SILENT: &str = "the demo was stopped for a while (Ctrl-Z, or a machine that stood still), so the script was not \
                      played whole";

/// The events and contacts that the script expects.
struct Verdict {
    expected: Vec<ExpectedEvent>,
    contacts: u64,
    steered: bool,
}

impl Verdict {
    fn of(script: &Script, profile: &Profile) -> Self {
        let contacts = script.contacts() as u64;
        Self {
            expected: script.expected().to_vec(),
            contacts,
            steered: profile.pointer.is_some() && contacts > 0,
        }
    }

    /// The message for a run without differences.
    fn words(&self) -> String {
        let (events, contacts) = (counted(self.expected.len(), "event"), counted(self.contacts, "contact"));
        format!("all {events} and {contacts} are those that the player meant")
    }

    fn check(&self, ending: Ending, seen: &RecordedEvents, bridge: &Bridge) -> Result<(), Failure> {
        if ending != Ending::TimeOver {
            return Err(Failure::Failed("interrupted: the events were not compared with the script".into()));
        }
        self.compare(seen, bridge).map_err(|difference| {
            let silent = bridge.health().links_lost > 0;
            Failure::Failed(if silent { format!("{SILENT}: {difference}") } else { difference })
        })
    }

    fn compare(&self, seen: &RecordedEvents, bridge: &Bridge) -> Result<(), String> {
        seen.compare(&self.expected)?;
        if self.steered && seen.pointer_moves == 0 {
            return Err("the pointer did not move".into());
        }
        check_end(bridge, self.contacts)
    }
}

/// The sink, and the demo's first line: where events go, and what would bring a better place.
fn open_sink(arguments: &Arguments, profile: &Profile) -> Result<(Box<dyn Sink>, String), Failure> {
    if arguments.output != Output::Auto {
        let sink = arguments.output.open()?;
        let title = format!("Output: {} (asked for).", sink.describe());
        return Ok((sink, title));
    }
    if profile.uses(OutputDevice::Keyboard) {
        let title = "Output: an event log, here. The profile types keys: for those ask with --output uinput.";
        return Ok((here(arguments)?, title.into()));
    }
    if profile.uses(OutputDevice::Pointer) {
        let title = "Output: an event log, here. The profile moves the pointer and clicks: for that ask with \
                     --output uinput.";
        return Ok((here(arguments)?, title.into()));
    }
    let (sink, missing) = arguments.output.open_or(|| here(arguments))?;
    let best = || "Output: a virtual gamepad. Nothing better is to be had.".into();
    Ok((sink, missing.unwrap_or_else(best)))
}

/// Whether there is a live picture.
fn is_shown(arguments: &Arguments) -> bool {
    !arguments.json && arguments.output != Output::Stdout && terminal::moves_cursor(&io::stdout())
}

/// The event log on the screen. A document on stdout leaves no room for one.
fn here(arguments: &Arguments) -> Result<Box<dyn Sink>, Failure> {
    log_here(arguments.json || is_shown(arguments), WhileRead(io::stdout()))
}

/// Writes as long as somebody reads. The demo goes on without a reader: its verdict is the exit code.
struct WhileRead<W>(W);

impl<W: Write> Write for WhileRead<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.0.write(bytes) {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(bytes.len()),
            written => written,
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self.0.flush() {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
            flushed => flushed,
        }
    }
}

/// Prints a line to stdout, or to stderr where stdout is for a program.
fn tell(arguments: &Arguments, line: &str) -> Result<(), Failure> {
    if arguments.json || arguments.output == Output::Stdout {
        say(line);
        return Ok(());
    }
    Ok(writeln!(stdout(), "{line}")?)
}

/// What somebody at a terminal may type next.
fn tell_next(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.json || !io::stdin().is_terminal() {
        return Ok(());
    }
    let game = if last_choice::pad().is_some() { "run" } else { "setup" };
    tell(arguments, &format!("In a game: `tactpad {game}`; in the browser: `tactpad demo --dashboard`"))
}

fn report(arguments: &Arguments, figures: &Figures) -> Result<(), Failure> {
    match arguments.json {
        true => print_json(figures),
        false => tell(arguments, &figures.lines().join("\n")),
    }
}

fn check_end(bridge: &Bridge, expected: u64) -> Result<(), String> {
    let (contacts, held) = (bridge.health().contacts, bridge.held_when_over());
    if held > 0 {
        return Err(format!("still held when the time was over: {}", counted(held, "control")));
    }
    if contacts == expected {
        return Ok(());
    }
    Err(format!("{} where the script has {expected}", counted(contacts, "contact")))
}
