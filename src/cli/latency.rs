//! `tactpad latency`: from pad bytes readable to event written, and where the time goes.
//!
//! The whole is measured live with one clock read at each end. What happens inside comes from replaying the same
//! calls with a clock as the probe, so that the live figures carry no instruments.

use std::io::{self, Write};
use std::os::fd::BorrowedFd;
use std::sync::{Arc, Mutex};

use clap::Args;
use firmware_proto::command::Command;
use serde::Serialize;

use super::chosen::Chosen;
use super::decoder_file::Choice;
use super::device::Pad;
use super::files::Files;
use super::live::{Audience, OpenedPad, Output, Plan, bridge, open_pad, play};
use super::written::stdout;
use super::{Failure, chosen, print_json, profile, say, seconds};
use crate::bridge::clock::Clock;
use crate::bridge::keeper::Patience;
use crate::capture::{CallRef, CaptureReader};
use crate::control::{Device, OutputEvent};
use crate::latency::{Durations, Percentiles};
use crate::mapping::profile::{Action, Profile};
use crate::pipeline::{Pipeline, Probe, Stage};
use crate::replay::make_call;
use crate::sink::{Sink, SinkError, null::NullSink, uinput};
use crate::time::HostInstant;
use crate::transport::Transport;
use crate::transport::address::PadAddress;

/// Arguments of `tactpad latency`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad latency --seconds 10 --json")]
pub(super) struct Arguments {
    /// How long to measure.
    #[arg(long, default_value = "10", value_parser = seconds::parse, allow_hyphen_values = true)]
    seconds: f64,
    /// The pad: virtual, serial:PATH[@BAUD], capture:FILE.
    #[arg(long, value_name = "PAD", default_value = "virtual")]
    pad: PadAddress,
    #[command(flatten)]
    device: Pad,
    /// A profile's name or file.
    #[arg(long, default_value = "super-mario")]
    profile: String,
    #[command(flatten)]
    decoder: Choice,
    /// Where events go: auto (a virtual gamepad, else nowhere), uinput, x11, log:FILE, none.
    #[arg(long, default_value = "auto")]
    output: Output,
    /// Print one JSON document.
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Report {
    samples: u64,
    writes: u64,
    stages_us: Stages<Percentiles>,
    end_to_end_us: Percentiles,
    policy_ms: Policy,
}

/// Durations of the stages: read and write are the system calls; decode ends with the contact, map with the events.
#[derive(Clone, Debug, Default, Serialize)]
struct Stages<T> {
    read: T,
    decode: T,
    map: T,
    write: T,
}

/// Delays that the profile asks for; no part of the processing.
#[derive(Serialize)]
struct Policy {
    /// The mean filter's: half of its window.
    filter: f64,
    /// Until a press is long.
    hold: f64,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { pad, profile, output, decoder, .. } = arguments;
    Files { pad, profile, output, decoder: chosen::file(decoder), capture: None }.check()?;
    let decoder = Chosen::read(decoder)?;
    let (text, profile) = profile::read(&arguments.profile, arguments.output.choice())?;
    let pad = open_pad(&arguments.pad, &arguments.device, &profile, Patience::Limited)?;
    let timing = Timing::default();
    let calls = Shared::default();
    let sink = TimedSink { sink: open_sink(&arguments.output)?, timing: timing.clone() };
    let way = format!("{} → {} → {}", arguments.pad, decoder.name, sink.describe());
    say(format_args!("{way} for {} s", arguments.seconds));
    let replayed = decoder.decoder.clone();
    let (mut bridge, _running) = bridge(Plan {
        pad: timed(pad, &timing),
        sink: Box::new(sink),
        profile_name: arguments.profile.clone(),
        profile_text: text,
        profile: profile.clone(),
        choice: arguments.output.choice(),
        decoder,
        record: Some(Box::new(calls.clone())),
        seconds: Some(arguments.seconds),
        patience: Patience::Limited,
        audience: Audience::Nobody,
        socket: None,
    })?;
    play(&mut bridge, &arguments.pad)?;
    let mut stages = timing.taken();
    let period_us = replay_timed(&calls.taken(), Pipeline::new(replayed, profile.clone()), &mut stages)?;
    let report = Report {
        samples: bridge.health().samples,
        writes: bridge.latency().len(),
        stages_us: stages.percentiles(),
        end_to_end_us: bridge.latency().percentiles(),
        policy_ms: policy(&profile, period_us),
    };
    if arguments.json { print_json(&report) } else { Ok(print(&report)?) }
}

fn open_sink(output: &Output) -> Result<Box<dyn Sink>, Failure> {
    match output {
        Output::Auto if uinput::available().is_err() => Ok(Box::new(NullSink)),
        output => output.open(),
    }
}

fn print(report: &Report) -> io::Result<()> {
    let mut out = stdout();
    writeln!(out, "{} samples, {} writes", report.samples, report.writes)?;
    writeln!(out, "{:<11} {:>9} {:>9} {:>9} {:>9}", "µs", "p50", "p95", "p99", "max")?;
    let Stages { read, decode, map, write } = &report.stages_us;
    let rows = [
        ("read", read),
        ("decode", decode),
        ("map", map),
        ("write", write),
        ("end to end", &report.end_to_end_us),
    ];
    for (name, Percentiles { p50, p95, p99, max }) in rows {
        writeln!(out, "{name:<11} {p50:>9.1} {p95:>9.1} {p99:>9.1} {max:>9.1}")?;
    }
    let Policy { filter, hold } = report.policy_ms;
    writeln!(out, "asked for by the profile: filter {filter:.1} ms, long press {hold:.0} ms")
}

fn policy(profile: &Profile, period_us: u64) -> Policy {
    let window = profile.filter_samples.max(1);
    let hold_us = profile.buttons.iter().map(|button| match button.action {
        Action::TapHold { long_press_us, .. } => long_press_us,
        Action::Hold(_) => 0,
    });
    Policy {
        filter: (window - 1) as f64 / 2.0 * period_us as f64 * 1e-3,
        hold: hold_us.max().unwrap_or(0) as f64 * 1e-3,
    }
}

/// Makes the recorded calls again with a clock inside. Returns the samples' period.
fn replay_timed(
    calls: &[u8],
    mut pipeline: Pipeline,
    stages: &mut Stages<Durations>,
) -> Result<u64, Failure> {
    let mut probe = Stopwatch { clock: Clock::start(), last: HostInstant::default(), stages };
    let reader = CaptureReader::new(calls).map_err(|error| Failure::Failed(error.to_string()))?;
    let (mut first, mut last) = (None, HostInstant::default());
    for call in reader {
        let call = call.map_err(|error| Failure::Failed(error.to_string()))?;
        if matches!(
            call.kind.as_ref(),
            CallRef::Decoder(_) | CallRef::Profile(_) | CallRef::KeyboardProfile(_)
        ) {
            continue;
        }
        first.get_or_insert(call.now);
        last = call.now;
        probe.last = probe.clock.now();
        make_call(&mut pipeline, call.now, call.kind.as_ref(), &mut probe, |_| Ok::<(), Failure>(()))?;
    }
    let samples = pipeline.health().samples.max(1);
    Ok(last.us_since(first.unwrap_or_default()) / samples)
}

/// A probe that reads the clock at each stage.
struct Stopwatch<'a> {
    clock: Clock,
    last: HostInstant,
    stages: &'a mut Stages<Durations>,
}

impl Probe for Stopwatch<'_> {
    fn mark(&mut self, stage: Stage) {
        let now = self.clock.now();
        let elapsed_ns = now.as_ns().saturating_sub(self.last.as_ns());
        match stage {
            // Unpacking is part of decoding: the time runs on.
            Stage::Sample => return,
            Stage::Contact => self.stages.decode.record_ns(elapsed_ns),
            Stage::Events => self.stages.map.record_ns(elapsed_ns),
        }
        self.last = now;
    }
}

impl Stages<Durations> {
    fn percentiles(&self) -> Stages<Percentiles> {
        Stages {
            read: self.read.percentiles(),
            decode: self.decode.percentiles(),
            map: self.map.percentiles(),
            write: self.write.percentiles(),
        }
    }
}

/// Durations that the timed pad and the timed sink share with the report.
#[derive(Clone, Default)]
struct Timing {
    stages: Arc<Mutex<Stages<Durations>>>,
}

impl Timing {
    fn record(&self, stage: fn(&mut Stages<Durations>) -> &mut Durations, clock: &Clock) {
        if let Ok(mut stages) = self.stages.lock() {
            stage(&mut stages).record_ns(clock.now().as_ns());
        }
    }

    fn taken(&self) -> Stages<Durations> {
        self.stages.lock().map(|stages| stages.clone()).unwrap_or_default()
    }
}

fn timed(mut opened: OpenedPad, timing: &Timing) -> OpenedPad {
    let timed = |pad| Box::new(TimedPad { pad, timing: timing.clone() }) as Box<dyn Transport>;
    opened.pad = opened.pad.take().map(timed);
    opened
}

struct TimedPad {
    pad: Box<dyn Transport>,
    timing: Timing,
}

impl Transport for TimedPad {
    fn fd(&self) -> BorrowedFd<'_> {
        self.pad.fd()
    }

    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let clock = Clock::start();
        let read = self.pad.read(bytes);
        self.timing.record(|stages| &mut stages.read, &clock);
        read
    }

    fn send(&mut self, command: &Command) -> io::Result<()> {
        self.pad.send(command)
    }
}

struct TimedSink {
    sink: Box<dyn Sink>,
    timing: Timing,
}

impl Sink for TimedSink {
    fn prepare(&mut self, device: Device) -> Result<(), SinkError> {
        self.sink.prepare(device)
    }

    fn write(&mut self, group: &[OutputEvent]) -> Result<(), SinkError> {
        let clock = Clock::start();
        let written = self.sink.write(group);
        self.timing.record(|stages| &mut stages.write, &clock);
        written
    }

    fn describe(&self) -> String {
        self.sink.describe()
    }
}

/// A capture in memory.
#[derive(Clone, Default)]
struct Shared(Arc<Mutex<Vec<u8>>>);

impl Shared {
    fn taken(&self) -> Vec<u8> {
        self.0.lock().map(|bytes| bytes.clone()).unwrap_or_default()
    }
}

impl Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.0.lock() {
            Ok(mut all) => all.write(bytes),
            Err(_) => Err(io::ErrorKind::Other.into()),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
