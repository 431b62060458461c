//! `tactpad bench`: the first measurements of a new pad. It says what to do, hears what is done, and says what is wired wrong.

mod hands;
mod session;
mod text;
mod words;

use std::sync::mpsc::channel;
use std::thread;

use clap::Args;

use self::session::Session;
use super::calibrate::screen::SessionHost;
use super::playing::{Audience, TerminalHost, WaitOption, open_pad, patience, play, requests};
use super::wired::WiringOption;
use crate::cli::failure::{Failure, if_read};
use crate::cli::files::decoder_file;
use crate::cli::files::device::PadOptions;
use crate::cli::files::field::field_of;
use crate::cli::number;
use crate::cli::playing::profile;
use crate::cli::printing::written::print_json;
use tactpad::bridge::bridge_parts::{BridgeParts, PlayingDecoder};
use tactpad::bridge::changes::ChangesSlot;
use tactpad::bridge::clock::Clock;
use tactpad::bridge::event_loop::Bridge;
use tactpad::bridge::observer::observe;
use tactpad::bridge::opening::OpenedPad;
use tactpad::bridge::sink::null::NullSink;
use tactpad::bridge::transport::address::PadAddress;
use tactpad::counted::counted;
use tactpad::lab::bench::guide::BenchGuide;
use tactpad::lab::bench::report::BenchReport;
use tactpad::pipeline::mapping::read::check::OutputChoice;
use tactpad::pipeline::shipped;

/// Weights that a plate without a calibration feels and bears, in grams: a coin is enough.
const WEIGHT_G: [f64; 2] = [2.0, 1000.0];

/// The profile of the bridge that hears the pad; nothing is played.
const PROFILE: &str = "super-mario";

/// Arguments of `tactpad bench`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: tactpad bench auto --weight-g 8.5, or tactpad bench virtual to see it without a pad"
)]
pub(crate) struct Arguments {
    /// The pad: auto[:SERIAL], hid:VID:PID[:SERIAL], serial:PATH[@BAUD], usb:PORT[@BAUD], capture:FILE, or virtual, which does what is asked.
    #[arg(value_name = "PAD", default_value = "auto")]
    pad: PadAddress,
    #[command(flatten)]
    wired: WiringOption,
    #[command(flatten)]
    device: PadOptions,
    /// A known weight to put on the middle, in grams: a coin of two euros has 8.5.
    #[arg(long, value_name = "G", value_parser = number::grams, allow_hyphen_values = true)]
    weight_g: Option<f64>,
    /// Print one JSON document.
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let [least_g, largest_g] = WEIGHT_G;
    if arguments.weight_g.is_some_and(|g| !(least_g..=largest_g).contains(&g)) {
        return Err(Failure::Unusable(format!("--weight-g: take a weight of {least_g} to {largest_g} g")));
    }
    if matches!(arguments.pad, PadAddress::Described { .. }) {
        return Err(Failure::Unusable(
            "bench measures strain pads of nine channels; a pad of another kind is tried by `tactpad run` and its description".into(),
        ));
    }
    let report = measured(arguments)?;
    let printed =
        if arguments.json { print_json(&report) } else { text::print(&report).map_err(Failure::from) };
    if_read(printed)?;
    if report.is_good() {
        return Ok(());
    }
    let (faults, open) = (report.faults.len(), report.open.len());
    Err(Failure::Failed(format!("{} to mend, {open} not found out", counted(faults, "thing"))))
}

/// Runs the bridge, and the session beside it, until nothing is left to do or somebody stops it.
fn measured(arguments: &Arguments) -> Result<BenchReport, Failure> {
    let Arguments { pad, weight_g, .. } = arguments;
    let device = arguments.device.designed()?;
    let field = field_of(&device)?;
    let decoder = decoder_file::read(shipped::INVERSE.as_ref())?;
    let profile = profile::read(PROFILE, OutputChoice::AsWritten)?;
    let waits = patience(pad, WaitOption::NotGiven);
    let (opened, hands): (OpenedPad, _) = if *pad == PadAddress::Virtual {
        let (opened, hands) = hands::open(&arguments.device)?;
        (opened, Some(hands))
    } else {
        (open_pad(pad, None, &arguments.device, profile.profile(), waits)?, None)
    };
    let requests = requests()?;
    let sender = requests.sender()?;
    let (observer, heard) = observe();
    let (tell, said) = channel();
    let terminal = TerminalHost::new(PROFILE, OutputChoice::AsWritten, Audience::Nobody)?;
    let mut bridge = Bridge::new(BridgeParts {
        clock: Clock::start(),
        pad: opened.with_wiring(arguments.wired.wiring),
        patience: waits,
        decoder: PlayingDecoder { decoder, name: shipped::INVERSE.into(), place: None, file: None },
        profile,
        sink: Box::new(NullSink::NOWHERE),
        requests,
        host: Box::new(SessionHost::new(terminal, tell)),
        record: None,
        observers: vec![observer],
        changes: ChangesSlot::default(),
        duration_us: None,
    })?;
    thread::scope(|scope| {
        let guide = BenchGuide::new(&device, &field, *weight_g);
        let session = Session::new(guide, hands, sender, said);
        let session =
            thread::Builder::new().name("session".into()).spawn_scoped(scope, move || session.run(&heard))?;
        let played = play(&mut bridge, pad);
        // The session ends with what it hears.
        drop(bridge);
        let guide = session.join().map_err(|_| Failure::Failed("the session broke off".into()))?;
        played?;
        let result = guide.result().ok_or_else(|| {
            Failure::Failed(
                "stopped before the pad had been left alone for five seconds: nothing was measured".into(),
            )
        })?;
        Ok(BenchReport::of(&result, *weight_g, &device, &field))
    })
}
