//! `tactpad demo`: the main job with nothing attached, and the proof that it went right.

use std::collections::{BTreeMap, VecDeque};
use std::io::{self, IsTerminal, Write};
use std::sync::{Arc, Mutex};

use clap::Args;
use serde::Serialize;

use super::chosen::Chosen;
use super::decoder_file::Choice;
use super::device::Pad;
use super::files::Files;
use super::live::{Audience, Output, Plan, bridge, open_virtual, play};
use super::screen::Screen;
use super::written::stdout;
use super::{Failure, chosen, if_read, print_json, profile, say, seconds};
use crate::bridge::keeper::Patience;
use crate::bridge::{Bridge, Ending};
use crate::control::{Code, Device, OutputEvent};
use crate::latency::Percentiles;
use crate::mapping::profile::Profile;
use crate::sink::log::LogSink;
use crate::sink::null::NullSink;
use crate::sink::{Sink, SinkError, uinput};
use crate::transport::address::PadAddress;
use crate::virtual_pad::script::Script;

/// Arguments of `tactpad demo`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad demo --seconds 10 --profile contra")]
pub(super) struct Arguments {
    /// How long to play.
    #[arg(long, default_value = "20", value_parser = seconds::parse, allow_hyphen_values = true)]
    seconds: f64,
    /// A profile's name or file.
    #[arg(long, default_value = "super-mario")]
    profile: String,
    #[command(flatten)]
    decoder: Choice,
    #[command(flatten)]
    device: Pad,
    /// Where events go: auto (a virtual gamepad, else the screen), uinput, x11, log:FILE, none.
    #[arg(long, default_value = "auto")]
    output: Output,
    /// Print one JSON document on stdout.
    #[arg(long)]
    json: bool,
}

/// What the demo comes to.
#[derive(Serialize)]
struct Summary {
    frames: u64,
    frames_lost: u64,
    contacts: u64,
    downs: usize,
    ups: usize,
    pointer_moves: usize,
    held_at_end: usize,
    latency_us: Percentiles,
}

/// One event as the script lists it.
type Expected = (Device, Code, i32);

/// What went out.
type Seen = Arc<Mutex<Account>>;

/// The newest events that a screen has room for.
const SHOWN_EVENTS: usize = 8;

/// What went out, in order. The pointer's steps are many and no two runs have the same: they are counted.
#[derive(Clone, Default)]
struct Account {
    /// All but the pointer's steps.
    edges: Vec<OutputEvent>,
    pointer_moves: usize,
    newest: VecDeque<OutputEvent>,
}

impl Account {
    fn extend(&mut self, group: &[OutputEvent]) {
        for event in group {
            match event.code {
                Code::Relative(_) => self.pointer_moves += 1,
                Code::Key(_) | Code::Axis(_) => self.edges.push(*event),
            }
            if self.newest.len() == SHOWN_EVENTS {
                self.newest.pop_front();
            }
            self.newest.push_back(*event);
        }
    }
}

/// Lets events pass and remembers them.
struct Witness {
    sink: Box<dyn Sink>,
    seen: Seen,
}

impl Sink for Witness {
    fn prepare(&mut self, device: Device) -> Result<(), SinkError> {
        self.sink.prepare(device)
    }

    fn write(&mut self, group: &[OutputEvent]) -> Result<(), SinkError> {
        self.sink.write(group)?;
        if let Ok(mut seen) = self.seen.lock() {
            seen.extend(group);
        }
        Ok(())
    }

    fn describe(&self) -> String {
        self.sink.describe()
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { profile, output, decoder, .. } = arguments;
    Files { pad: &PadAddress::Virtual, profile, output, decoder: chosen::file(decoder), capture: None }
        .check()?;
    let decoder = Chosen::read(decoder)?;
    let (text, profile) = profile::read(&arguments.profile, arguments.output.choice())?;
    let script = Script::for_profile(&profile, (arguments.seconds * 1e6) as u64);
    let expected = script.expected().to_vec();
    let contacts = script.contacts() as u64;
    let steered = profile.pointer.is_some() && contacts > 0;
    let name = profile.name.clone();
    let (sink, title) = open_sink(arguments, &profile)?;
    if_read(tell(arguments, &title))?;
    let seen = Seen::default();
    let witness = Witness { sink, seen: Arc::clone(&seen) };
    let (mut bridge, _running) = bridge(Plan {
        pad: open_virtual(&arguments.device, script)?,
        sink: Box::new(witness),
        profile_name: arguments.profile.clone(),
        profile_text: text,
        profile,
        choice: arguments.output.choice(),
        decoder,
        record: None,
        seconds: Some(arguments.seconds),
        patience: Patience::Limited,
        audience: Audience::Nobody,
        socket: None,
    })?;
    let title = format!("{name} on a virtual pad");
    let screen = (!arguments.json).then(|| start_screen(title, &bridge, &seen));
    let played = play(&mut bridge, &PadAddress::Virtual);
    drop(screen);
    let ending = played?;
    let seen = seen.lock().map(|seen| seen.clone()).unwrap_or_default();
    if_read(report(arguments, &bridge, &seen))?;
    if ending != Ending::TimeOver {
        return Err(Failure::Failed("interrupted: the events were not compared with the script".into()));
    }
    compare(&seen.edges, &expected)?;
    if steered && seen.pointer_moves == 0 {
        return Err(Failure::Failed("the pointer did not move".into()));
    }
    check_end(&bridge, contacts)
}

/// The sink, and the demo's first line: where events go, and what would bring a better place.
fn open_sink(arguments: &Arguments, profile: &Profile) -> Result<(Box<dyn Sink>, String), Failure> {
    if arguments.output != Output::Auto {
        let sink = arguments.output.open()?;
        let title = format!("Output: {} (asked for).", sink.describe());
        return Ok((sink, title));
    }
    match uinput::available() {
        _ if profile.uses(Device::Keyboard) => {
            let title =
                "Output: an event log, here. The profile types keys: for those ask with --output uinput.";
            Ok((here(arguments), title.into()))
        }
        _ if profile.uses(Device::Pointer) => {
            let title = "Output: an event log, here. The profile moves the pointer and clicks: for that ask with \
                         --output uinput.";
            Ok((here(arguments), title.into()))
        }
        Ok(()) => {
            let sink = Output::Uinput.open()?;
            Ok((sink, "Output: a virtual gamepad. Nothing better is to be had.".into()))
        }
        Err(error) => {
            let title = format!("Output: an event log, here. For a virtual gamepad: {}", error.message);
            Ok((here(arguments), title))
        }
    }
}

/// The event log on the screen: the live picture shows it, and without one it is lines on stdout.
fn here(arguments: &Arguments) -> Box<dyn Sink> {
    if arguments.json || io::stdout().is_terminal() {
        Box::new(NullSink)
    } else {
        Box::new(LogSink::new(WhileRead(io::stdout()), "stdout".into()))
    }
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

/// What people read goes to stdout, or to stderr where stdout is for a program.
fn tell(arguments: &Arguments, line: &str) -> Result<(), Failure> {
    if arguments.json {
        say(line);
        return Ok(());
    }
    Ok(writeln!(stdout(), "{line}")?)
}

fn start_screen(title: String, bridge: &Bridge, seen: &Seen) -> Option<Screen> {
    let seen = Arc::clone(seen);
    Screen::start(title, bridge.snapshot(), move || {
        let newest = seen.lock().map(|seen| seen.newest.clone());
        newest.unwrap_or_default().iter().map(line).collect()
    })
}

fn line(event: &OutputEvent) -> String {
    format!("{:8.3} s  {} {:+}", event.at.as_us() as f64 * 1e-6, event.code, event.value)
}

fn report(arguments: &Arguments, bridge: &Bridge, seen: &Account) -> Result<(), Failure> {
    let health = bridge.health();
    let tally = Tally::of(&seen.edges);
    let summary = Summary {
        frames: health.samples,
        frames_lost: health.frames_lost + health.frames_damaged,
        contacts: health.contacts,
        downs: tally.downs,
        ups: tally.ups,
        pointer_moves: seen.pointer_moves,
        held_at_end: bridge.held_at_end(),
        latency_us: bridge.latency().percentiles(),
    };
    if arguments.json {
        return print_json(&summary);
    }
    let Summary { frames, frames_lost, contacts, downs, ups, pointer_moves, held_at_end, latency_us } =
        summary;
    let Percentiles { p50, p95, p99, max } = latency_us;
    writeln!(stdout(), "{frames} frames, {frames_lost} lost; {contacts} contacts")?;
    writeln!(stdout(), "{downs} downs, {ups} ups, {held_at_end} held at the end")?;
    if pointer_moves > 0 {
        writeln!(stdout(), "{pointer_moves} moves of the pointer")?;
    }
    Ok(writeln!(
        stdout(),
        "bytes readable to event written: p50 {p50:.0} µs, p95 {p95:.0} µs, p99 {p99:.0} µs, max {max:.0} µs"
    )?)
}

/// How often controls went down and up.
#[derive(Default)]
struct Tally {
    downs: usize,
    ups: usize,
}

impl Tally {
    fn of(seen: &[OutputEvent]) -> Self {
        let mut tally = Self::default();
        let mut held = BTreeMap::new();
        for event in seen {
            // A hat that goes over from one side to the other is an up and a down in one event.
            let before = held.insert((event.device, event.code), event.value).unwrap_or(0);
            tally.ups += usize::from(before != 0);
            tally.downs += usize::from(event.value != 0);
        }
        tally
    }
}

fn compare(seen: &[OutputEvent], expected: &[Expected]) -> Result<(), Failure> {
    let seen: Vec<Expected> = seen.iter().map(|event| (event.device, event.code, event.value)).collect();
    let differs = seen.iter().zip(expected).position(|(seen, expected)| seen != expected);
    let Some(index) = differs.or((seen.len() != expected.len()).then(|| seen.len().min(expected.len())))
    else {
        return Ok(());
    };
    let name = |event: Option<&Expected>| match event {
        Some((device, code, value)) => format!("{} {code} {value}", device.name()),
        None => "nothing".into(),
    };
    Err(Failure::Failed(format!(
        "event {} is {} where the script has {} ({} events, {} in the script)",
        index + 1,
        name(seen.get(index)),
        name(expected.get(index)),
        seen.len(),
        expected.len()
    )))
}

fn check_end(bridge: &Bridge, expected: u64) -> Result<(), Failure> {
    let (contacts, held) = (bridge.health().contacts, bridge.held_at_end());
    if held > 0 {
        return Err(Failure::Failed(format!("{held} controls were still held at the end")));
    }
    if contacts == expected {
        return Ok(());
    }
    Err(Failure::Failed(format!("{contacts} contacts where the script has {expected}")))
}
