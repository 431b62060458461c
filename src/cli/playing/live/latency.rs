//! `tactpad latency`: from pad bytes readable to event written, and where the time goes.

use std::io::{self, Write};

use clap::Args;
use serde::Serialize;

use super::chosen;
use super::described::{DescribedPad, SourceOption};
use super::files::Files;
use super::output::Output;
use super::playing::{Audience, TerminalHost, microseconds, open_pad, play, requests};
use super::wired::WiringOption;
use crate::cli::failure::Failure;
use crate::cli::files::decoder_file::DecoderChoice;
use crate::cli::files::device::PadOptions;
use crate::cli::playing::profile;
use crate::cli::printing::seconds;
use crate::cli::printing::written::{print_json, say, stdout, wait_for_no_reader};
use tactpad::bridge::bridge_parts::BridgeParts;
use tactpad::bridge::changes::ChangesSlot;
use tactpad::bridge::clock::Clock;
use tactpad::bridge::event_loop::Bridge;
use tactpad::bridge::latency::Percentiles;
use tactpad::bridge::opening::Patience;
use tactpad::bridge::sink::{Sink, null::NullSink, uinput};
use tactpad::bridge::timing::{ProfileDelays, Stages, Timing};
use tactpad::bridge::transport::address::PadAddress;
use tactpad::counted::counted;
use tactpad::pipeline::Pipeline;

/// Arguments of `tactpad latency`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: tactpad latency --seconds 10 --json, or tactpad latency --pad auto while you press your own pad"
)]
pub(crate) struct Arguments {
    /// How long to measure.
    #[arg(long, default_value = "10", value_parser = seconds::parse, allow_hyphen_values = true)]
    seconds: f64,
    /// The pad: virtual, auto[:SERIAL], hid:VID:PID[:SERIAL], serial:PATH[@BAUD], usb:PORT[@BAUD], capture:FILE.
    #[arg(long, value_name = "PAD", default_value = "virtual")]
    pad: PadAddress,
    #[command(flatten)]
    source: SourceOption,
    #[command(flatten)]
    wired: WiringOption,
    #[command(flatten)]
    device: PadOptions,
    /// A profile's name or file.
    #[arg(long, default_value = "super-mario")]
    profile: String,
    #[command(flatten)]
    decoder: DecoderChoice,
    /// Where events go: auto (a virtual gamepad, else nowhere), uinput, x11, log:FILE (- is stdout), none.
    #[arg(long, default_value = "auto")]
    output: Output,
    /// Print one JSON document.
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct LatencyReport {
    samples: u64,
    writes: u64,
    stages_us: Stages<Percentiles>,
    end_to_end_us: Percentiles,
    policy_ms: ProfileDelays,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    wait_for_no_reader()?;
    let Arguments { pad, profile, output, decoder, json, .. } = arguments;
    output.leaves_stdout(*json)?;
    Files { pad, profile, output, decoder: chosen::file(decoder), capture: None }.check()?;
    let described = arguments.source.read(pad, decoder)?;
    let decoder = described.as_ref().map_or_else(|| chosen::read(decoder), DescribedPad::decoder)?;
    let profile = profile::read(profile, output.choice())?;
    let opened = open_pad(pad, described.as_ref(), &arguments.device, profile.profile(), Patience::Limited)?;
    let opened = opened.with_wiring(arguments.wired.wiring);
    let timing = Timing::default();
    let sink = timing.sink(open_sink(output)?);
    let way = format!("{pad} → {} → {}", decoder.name, sink.describe());
    say(format_args!("{way} for {} s", arguments.seconds));
    let played = profile.profile().clone();
    let pipeline = Pipeline::new(decoder.decoder.clone(), played.clone());
    let audience = Audience::Nobody;
    let host = TerminalHost::new(&arguments.profile, output.choice(), audience)?;
    let host = host.on_pad(described.as_ref(), &profile);
    let mut bridge = Bridge::new(BridgeParts {
        clock: Clock::start(),
        pad: timing.pad(opened),
        patience: Patience::Limited,
        decoder,
        profile,
        sink,
        requests: requests()?,
        host: Box::new(host),
        record: Some(timing.record()),
        observers: Vec::new(),
        changes: ChangesSlot::default(),
        duration_us: Some(microseconds(arguments.seconds)),
    })?;
    play(&mut bridge, pad)?;
    let timed = timing.finish(pipeline).map_err(|error| Failure::Failed(error.to_string()))?;
    let report = LatencyReport {
        samples: bridge.health().samples,
        writes: bridge.latency().len(),
        stages_us: timed.stages_us,
        end_to_end_us: bridge.latency().percentiles(),
        policy_ms: ProfileDelays::of(&played, timed.period_us),
    };
    match output {
        _ if arguments.json => print_json(&report),
        Output::Stdout => Ok(print(&report, &mut io::stderr())?),
        _ => Ok(print(&report, &mut stdout())?),
    }
}

fn open_sink(output: &Output) -> Result<Box<dyn Sink>, Failure> {
    match output {
        Output::Auto if uinput::available().is_err() => Ok(Box::new(NullSink::NOWHERE)),
        output => output.open(),
    }
}

fn print(report: &LatencyReport, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "{}, {}", counted(report.samples, "sample"), counted(report.writes, "write"))?;
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
    let ProfileDelays { filter, hold, slow, tremor } = report.policy_ms;
    write!(out, "asked for by the profile: filter {filter:.1} ms, long press {hold:.0} ms")?;
    for (name, delay_ms) in [("slow press", slow), ("tremor", tremor)] {
        if delay_ms > 0.0 {
            write!(out, ", {name} {delay_ms:.0} ms")?;
        }
    }
    writeln!(out)
}
