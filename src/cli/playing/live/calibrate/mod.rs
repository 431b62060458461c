//! `tactpad calibrate`: a calibration at home. It says what to do, hears what is done, and fits a decoder to it.

mod hands;
pub(super) mod kept;
pub(super) mod screen;
mod session;
mod words;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::mpsc::channel;
use std::thread;

use clap::Args;

use self::hands::Hands;
use self::kept::{SessionFiles, SessionStart};
use self::screen::{SessionHost, SessionScreen};
use self::session::Session;
use super::playing::{Audience, TerminalHost, WaitOption, open_pad, patience, play, requests};
use super::wired::WiringOption;
use crate::cli::failure::Failure;
use crate::cli::files::decoder_file;
use crate::cli::files::destination::Destination;
use crate::cli::files::device::PadOptions;
use crate::cli::files::field::field_of;
use crate::cli::laboratory::adapt::at_home;
use crate::cli::number;
use crate::cli::playing::profile;
use crate::cli::printing::progress::Progress;
use crate::cli::printing::written::{is_same, is_stdout, say, stdout, written_over};
use tactpad::bridge::bridge_parts::{BridgeParts, PlayingDecoder};
use tactpad::bridge::changes::ChangesSlot;
use tactpad::bridge::clock::Clock;
use tactpad::bridge::event_loop::Bridge;
use tactpad::bridge::observer::observe;
use tactpad::bridge::opening::OpenedPad;
use tactpad::bridge::sink::null::NullSink;
use tactpad::bridge::transport::address::PadAddress;
use tactpad::lab::play::guide::{Guide, GuideStep};
use tactpad::lab::play::reader::Reader;
use tactpad::lab::play::sheet::Sheet;
use tactpad::lab::play::words::WITHOUT_WEIGHT;
use tactpad::pad::marks::MARKS_MM;
use tactpad::pad::weight::check_weight;
use tactpad::pipeline::capture::head::Head;
use tactpad::pipeline::mapping::profile::Profile;
use tactpad::pipeline::mapping::read::ReadProfile;
use tactpad::pipeline::mapping::read::check::OutputChoice;
use tactpad::pipeline::shipped;

/// Arguments of `tactpad calibrate`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: tactpad calibrate --sheet marks.pdf, then tactpad calibrate --weight-g 200 --out my.decoder"
)]
pub(crate) struct Arguments {
    /// Write a sheet with the five marks in true size, for A4 paper; alone, nothing else is done.
    #[arg(long, value_name = "OUT.svg|OUT.pdf")]
    sheet: Option<PathBuf>,
    /// The pad: auto[:SERIAL], hid:VID:PID[:SERIAL], serial:PATH[@BAUD], usb:PORT[@BAUD], or virtual, which does what is asked.
    #[arg(long, value_name = "PAD", default_value = "auto")]
    pad: PadAddress,
    #[command(flatten)]
    wired: WiringOption,
    #[command(flatten)]
    device: PadOptions,
    /// The weight that is put on the marks, in grams; without it the force's scale stays unknown.
    #[arg(long, value_name = "G", value_parser = number::grams, requires = "out", allow_hyphen_values = true)]
    weight_g: Option<f64>,
    /// The decoder to write.
    ///
    /// Beside it, what is heard is kept in FILE.cap and FILE.weights.csv: with the same FILE a later session goes on from there.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Begin anew instead of going on.
    #[arg(long, requires = "out")]
    fresh: bool,
    /// Print one JSON document: what came of it.
    #[arg(long, requires = "out")]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    arguments.check()?;
    if let Some(path) = &arguments.sheet {
        write_sheet(path, arguments)?;
    }
    arguments.out.as_deref().map_or(Ok(()), |out| calibrate(arguments, out))
}

impl Arguments {
    fn check(&self) -> Result<(), Failure> {
        let unusable = |why: &str| Err(Failure::Unusable(why.into()));
        if self.sheet.is_none() && self.out.is_none() {
            return unusable(
                "nothing is asked for: name the decoder to write, as in --out my.decoder, or the sheet, as in --sheet marks.pdf",
            );
        }
        if let Some(weight_g) = self.weight_g {
            check_weight(weight_g).map_err(|why| Failure::Unusable(format!("--weight-g: {why}")))?;
        }
        for written in [&self.sheet, &self.out].into_iter().flatten() {
            self.device.spare(written)?;
        }
        let Some(out) = &self.out else { return Ok(()) };
        if is_stdout(out) {
            return unusable("--out - leaves nothing beside which the session could be kept: name a file");
        }
        if self.sheet.as_ref().is_some_and(|sheet| is_same(sheet, out)) {
            return Err(written_over(out, "is the sheet"));
        }
        if matches!(self.pad, PadAddress::Capture { .. }) {
            return unusable(
                "a capture does nothing that it is asked for: use tactpad adapt --play CAPTURE --weights W.csv",
            );
        }
        Ok(())
    }
}

fn write_sheet(path: &Path, arguments: &Arguments) -> Result<(), Failure> {
    let sheet = Sheet::of(&arguments.device.designed()?);
    let bytes = match path.extension().map(|it| it.to_ascii_lowercase()) {
        Some(kind) if kind == "svg" => sheet.svg().into_bytes(),
        Some(kind) if kind == "pdf" => sheet.pdf(),
        _ => {
            return Err(Failure::Unusable(format!(
                "{}: a sheet is SVG or PDF; let its name end in .svg or .pdf",
                path.display()
            )));
        }
    };
    Destination::of(path)?.write(&bytes)?;
    if arguments.json {
        return Ok(());
    }
    Ok(writeln!(stdout(), "{} is written: print it at 100 % and measure its bar", path.display())?)
}

/// Leads through a session, and fits a decoder to it.
fn calibrate(arguments: &Arguments, out: &Path) -> Result<(), Failure> {
    let to = Destination::of(out)?;
    let decoder = decoder_file::read(Path::new(shipped::INVERSE))?;
    // Only its filter counts, so any will do.
    let profile = profile::read("super-mario", OutputChoice::AsWritten)?;
    let reader = Reader::new(decoder.clone(), profile.profile().clone());
    let mut guide = Guide::new(reader, arguments.weight_g);
    let file = shipped::bytes(shipped::INVERSE).map(Into::into);
    let head = Head { decoder: file, profile: Some(profile.clone()) };
    let (opened, hands) = open(arguments, profile.profile())?;
    let kept = begin(out, arguments.fresh, &mut guide, &head)?;
    if arguments.weight_g.is_none() {
        say(format_args!("without --weight-g GRAMS no weight is asked for, and {WITHOUT_WEIGHT}"));
    }
    let playing = PlayingDecoder { decoder, name: shipped::INVERSE.into(), place: None, file: head.decoder };
    let guide =
        lead(arguments, SessionParts { pad: opened, hands, guide, files: kept, decoder: playing, profile })?;
    if *guide.step() != GuideStep::Done {
        return Err(Failure::Failed(format!(
            "stopped before the end: what was heard is kept in {}, and the same command goes on from there",
            kept::capture_beside(out).display()
        )));
    }
    let (windows, placements) = guide.finish();
    let device = arguments.device.designed()?;
    let field = field_of(&device)?;
    let found = at_home::fitted(&windows, &placements, &device, &field, None)
        .map_err(|error| Failure::Failed(format!("{}: {error}", kept::capture_beside(out).display())))?;
    at_home::write(found, &windows, &to, out, arguments.json)
}

/// Opens what the session keeps, and says where it goes on.
fn begin(out: &Path, fresh: bool, guide: &mut Guide, head: &Head) -> Result<SessionFiles, Failure> {
    let progress = Progress::begin("reading what was heard earlier");
    let kept = SessionFiles::begin(out, SessionStart { fresh, way_to_fresh: "give --fresh" }, guide, head)?;
    drop(progress);
    if kept.goes_on() {
        say(format_args!(
            "it goes on from {}: {:.0} s pressed, {} of {} marks; --fresh begins anew",
            kept::capture_beside(out).display(),
            guide.pressed_s(),
            guide.placements().len(),
            MARKS_MM.len()
        ));
    }
    Ok(kept)
}

/// The pad, and hands for one that has none.
fn open(arguments: &Arguments, profile: &Profile) -> Result<(OpenedPad, Option<Hands>), Failure> {
    let wiring = arguments.wired.wiring;
    if arguments.pad == PadAddress::Virtual {
        return hands::open(&arguments.device).map(|(pad, hands)| (pad.with_wiring(wiring), Some(hands)));
    }
    let patience = patience(&arguments.pad, WaitOption::NotGiven);
    let opened = open_pad(&arguments.pad, None, &arguments.device, profile, patience)?;
    Ok((opened.with_wiring(wiring), None))
}

/// The parts of a session: the pad and its bridge, the guide, and the files.
struct SessionParts {
    pad: OpenedPad,
    hands: Option<Hands>,
    guide: Guide,
    files: SessionFiles,
    decoder: PlayingDecoder,
    profile: ReadProfile,
}

/// Runs the bridge, and the session beside it, until nothing is left to do or somebody stops it.
fn lead(arguments: &Arguments, parts: SessionParts) -> Result<Guide, Failure> {
    let SessionParts { pad, hands, guide, files, decoder, profile } = parts;
    let requests = requests()?;
    let (observer, heard) = observe();
    let (tell, said) = channel();
    let terminal = TerminalHost::new("super-mario", OutputChoice::AsWritten, Audience::Nobody)?;
    let session = Session::new(guide, files, hands, requests.sender()?, SessionScreen::new(said));
    let mut bridge = Bridge::new(BridgeParts {
        clock: Clock::start(),
        pad,
        patience: patience(&arguments.pad, WaitOption::NotGiven),
        decoder,
        profile,
        sink: Box::new(NullSink::NOWHERE),
        requests,
        host: Box::new(SessionHost::new(terminal, tell)),
        record: None,
        observers: vec![observer],
        changes: ChangesSlot::default(),
        duration_us: None,
    })?;
    let session = thread::Builder::new().name("session".into()).spawn(move || session.run(&heard))?;
    let played = play(&mut bridge, &arguments.pad);
    // The session ends with what it hears.
    drop(bridge);
    let guide = session.join().map_err(|_| Failure::Failed("the session broke off".into()))?;
    played?;
    guide
}
