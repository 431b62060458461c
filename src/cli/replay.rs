//! `tactpad replay`: the event log of a capture, or of a list of contacts.

use std::fs::File;
use std::io::{self, BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};

use clap::Args;

use super::decoder_file::Choice;
use super::failure::{Failure, if_read};
use super::written::{say, stdout};
use super::{profile, tables};
use tactpad::pipeline::call::Call;
use tactpad::pipeline::capture::head::Head;
use tactpad::pipeline::capture::reader::{CaptureError, CaptureReader};
use tactpad::pipeline::contact::{Decoder, read};
use tactpad::pipeline::control::OutputEvent;
use tactpad::pipeline::mapping::check::OutputChoice;
use tactpad::pipeline::mapping::profile::Profile;
use tactpad::pipeline::output::event_log;
use tactpad::pipeline::replay::ContactReplay;
use tactpad::pipeline::{NoProbe, Pipeline};
use tactpad::quantity::Contact;
use tactpad::tables::measured::columns::Kind;
use tactpad::time::{HostInstant, StreamInstant};

/// The plate of the pads that profiles are made for.
const PLATE_RADIUS_MM: f64 = 30.0;

/// Rows of a table without times are this far apart.
const PERIOD_US: u64 = 1_000;

/// Arguments of `tactpad replay`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad record game.cap, then tactpad replay game.cap")]
#[group(skip)]
pub(super) struct Arguments {
    /// A capture, made by `tactpad record`.
    #[arg(required_unless_present = "contacts", conflicts_with = "contacts")]
    capture: Option<PathBuf>,
    /// A CSV of contacts instead: t_s,x_mm,y_mm,fx_n,fy_n,fz_n.
    ///
    /// The first line names the columns; others are ignored. t_s may be missing: then rows are 1 ms apart. A row whose
    /// fz_n is not above 0 is a lift.
    #[arg(long, requires = "profile")]
    contacts: Option<PathBuf>,
    /// A profile's name or file. Without it a capture replays with the one it was recorded with.
    #[arg(long)]
    profile: Option<String>,
    /// Without it a capture replays with the one it was recorded with.
    #[command(flatten)]
    decoder: Choice,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let chosen = arguments.profile.as_deref().map(|name| profile::read(name, OutputChoice::AsWritten));
    let chosen = chosen.transpose()?.map(|read| read.profile().clone());
    let mut log = BufWriter::new(stdout());
    match (&arguments.capture, &arguments.contacts, chosen) {
        (Some(path), _, chosen) => replay_capture(path, chosen, &arguments.decoder, &mut log)?,
        (None, Some(_), _) if arguments.decoder.is_given() => {
            return Err(Failure::Unusable("--contacts are decoded already: leave out --decoder".into()));
        }
        (None, Some(path), Some(profile)) => replay_contacts(path, profile, &mut log)?,
        _ => return Err(Failure::Unusable("give a capture, or --contacts and --profile".into())),
    }
    Ok(log.flush()?)
}

fn replay_capture(
    path: &Path,
    chosen: Option<Profile>,
    decoder: &Choice,
    log: &mut impl Write,
) -> Result<(), Failure> {
    let unusable = |error: CaptureError| Failure::Unusable(format!("{} {error}", path.display()));
    let file = File::open(path).map_err(|error| unusable(CaptureError::Io(error)))?;
    let mut capture = CaptureReader::new(BufReader::new(file)).map_err(unusable)?;
    let keeps_profile = chosen.is_none();
    let recorded = || capture.head().profile.as_ref().map(|read| read.profile().clone());
    let profile = chosen.or_else(recorded).ok_or_else(|| {
        Failure::Unusable(format!("{} names no usable profile; choose one with --profile", path.display()))
    })?;
    let mut pipeline = Pipeline::new(playing(path, decoder, capture.head())?, profile);
    while let Some(call) = capture.next_call() {
        match call {
            Ok((_, Call::Profile(_))) | Err(CaptureError::Profile { .. }) if !keeps_profile => {}
            Ok((now, call)) => replay_call(&mut pipeline, now, call, log)?,
            Err(error @ (CaptureError::CutOff { .. } | CaptureError::Missing { .. })) => {
                say(format_args!("{} {error}", path.display()));
            }
            Err(error) => {
                // The damage is the verdict, even where nobody reads the events before it.
                if_read(log.flush().map_err(Failure::from))?;
                return Err(unusable(error));
            }
        }
    }
    Ok(())
}

fn replay_call(
    pipeline: &mut Pipeline,
    now: HostInstant,
    call: Call<'_>,
    log: &mut impl Write,
) -> io::Result<()> {
    let mut left = Some(call);
    while let Some(call) = left {
        left = pipeline.apply(now, call, &mut NoProbe);
        event_log::write(log, pipeline.events())?;
    }
    Ok(())
}

/// The decoder that is chosen, else the recorded one.
fn playing(path: &Path, chosen: &Choice, recorded: &Head) -> Result<Decoder, Failure> {
    if chosen.is_given() {
        // What it plays is looked at, not felt: one that cannot play will do.
        return Ok(chosen.read_by(read::tared)?.0);
    }
    recorded.read_decoder().map_err(|why| {
        let path = path.display();
        Failure::Unusable(format!(
            "{path} was recorded with a decoder that cannot be read: {why}; replay it with the tactpad that recorded \
             it, or choose a decoder with --decoder"
        ))
    })
}

/// Maps contacts as they stand: each row is a sample, a row without normal force is a lift.
fn replay_contacts(path: &Path, profile: Profile, log: &mut impl Write) -> Result<(), Failure> {
    let rows = tables::read(path, Kind::Contacts, PLATE_RADIUS_MM)?.rows;
    let mut replay = ContactReplay::new(profile);
    let mut deliver = |events: &[OutputEvent]| event_log::write(log, events);
    let mut end = StreamInstant::default();
    for (index, row) in rows.iter().enumerate() {
        let us = row.t_s.map_or_else(|| index as u64 * PERIOD_US, |t_s| (t_s * 1e6).round() as u64);
        end = StreamInstant::from_us(us);
        let contact = Some(&row.label.into()).filter(|contact: &&Contact| contact.fz_n > 0.0).copied();
        replay.step(end, contact.as_ref(), &mut deliver)?;
    }
    // The list ends with a lift, so that nothing stays held.
    replay.step(end, None, &mut deliver)?;
    Ok(replay.settle(StreamInstant::from_us(u64::MAX), &mut deliver)?)
}
