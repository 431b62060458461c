//! `tactpad replay`: the event log of a capture, or of a list of contacts.

use std::fs::File;
use std::io::{self, BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};

use clap::Args;

use super::decoder_file::Choice;
use super::written::stdout;
use super::{Failure, if_read, profile, say, tables};
use crate::capture::{CallKind, CaptureError, CaptureReader};
use crate::contact::{Decoder, read};
use crate::mapping::check::{self, OutputChoice};
use crate::mapping::engine::Engine;
use crate::mapping::profile::Profile;
use crate::measured::columns::Kind;
use crate::output::event_log;
use crate::output::ledger::{Edges, Ledger};
use crate::pipeline::{NoProbe, Pipeline};
use crate::quantity::Contact;
use crate::replay::make_call;
use crate::shipped;
use crate::time::StreamInstant;

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
    let chosen = chosen.transpose()?.map(|(_, profile)| profile);
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
    let mut calls = CaptureReader::new(BufReader::new(file)).map_err(unusable)?;
    let mut next = || calls.next().ok_or_else(|| unusable(CaptureError::NoPlay))?.map_err(unusable);
    let mut first = next()?;
    let mut recorded = None;
    if let CallKind::Decoder(bytes) = first.kind {
        (recorded, first) = (Some(bytes), next()?);
    }
    let keeps_profile = chosen.is_none();
    let profile = chosen.or_else(|| recorded_profile(&first.kind)).ok_or_else(|| {
        Failure::Unusable(format!("{} names no usable profile; choose one with --profile", path.display()))
    })?;
    let mut pipeline = Pipeline::new(playing(path, decoder, recorded)?, profile);
    let first = recorded_profile(&first.kind).is_none().then_some(Ok(first));
    for call in first.into_iter().chain(calls) {
        match call {
            Ok(call) if !keeps_profile && recorded_profile(&call.kind).is_some() => {}
            Ok(call) => make_call(&mut pipeline, call.now, call.kind.as_ref(), &mut NoProbe, |events| {
                event_log::write(log, events)
            })?,
            Err(error @ CaptureError::CutOff { .. }) => say(format_args!("{} {error}", path.display())),
            Err(error) => {
                // The damage is the verdict, even where nobody reads the events before it.
                if_read(log.flush().map_err(Failure::from))?;
                return Err(unusable(error));
            }
        }
    }
    Ok(())
}

/// The decoder that is chosen, else the recorded one; captures that hold none were recorded with statics.
fn playing(path: &Path, chosen: &Choice, recorded: Option<Vec<u8>>) -> Result<Decoder, Failure> {
    match recorded {
        Some(bytes) if !chosen.is_given() => read::playing(&bytes).map_err(|why| {
            let path = path.display();
            Failure::Unusable(format!(
                "{path} was recorded with a decoder that cannot be read: {why}; replay it with the tactpad that recorded \
                 it, or choose a decoder with --decoder"
            ))
        }),
        None if !chosen.is_given() => Ok(shipped::statics()),
        _ => Ok(chosen.read()?.0),
    }
}

fn recorded_profile(call: &CallKind) -> Option<Profile> {
    match call {
        CallKind::Profile(text) => check::read(text, OutputChoice::AsWritten).0,
        CallKind::KeyboardProfile(text) => check::read(text, OutputChoice::Keyboard).0,
        _ => None,
    }
}

/// Maps contacts as they stand: each row is a sample, a row without normal force is a lift.
fn replay_contacts(path: &Path, profile: Profile, log: &mut impl Write) -> Result<(), Failure> {
    let rows = tables::read(path, Kind::Contacts, PLATE_RADIUS_MM)?.rows;
    let mut mapped = Mapped { ledger: Ledger::new(&profile), engine: Engine::new(profile), log };
    let mut end = StreamInstant::default();
    for (index, row) in rows.iter().enumerate() {
        let us = row.t_s.map_or_else(|| index as u64 * PERIOD_US, |t_s| (t_s * 1e6).round() as u64);
        end = StreamInstant::from_us(us);
        mapped.step(end, Some(&row.label.into()).filter(|contact: &&Contact| contact.fz_n > 0.0))?;
    }
    // The list ends with a lift, so that nothing stays held.
    mapped.step(end, None)?;
    Ok(mapped.settle(StreamInstant::from_us(u64::MAX))?)
}

/// Contacts on their way to the log, past the pipeline: they are decoded already.
struct Mapped<'a, W> {
    engine: Engine,
    ledger: Ledger,
    log: &'a mut W,
}

impl<W: Write> Mapped<'_, W> {
    fn step(&mut self, at: StreamInstant, contact: Option<&Contact>) -> io::Result<()> {
        self.settle(at)?;
        let mut edges = Edges::new();
        // A tap is stated once. The second step, at the same instant, tells the ledger that it is over.
        for _ in 0..2 {
            self.ledger.update(at, &self.engine.step(at, contact), &mut edges);
        }
        event_log::write(self.log, &edges)
    }

    /// Emits what the minimum press held back and is due before `until`.
    fn settle(&mut self, until: StreamInstant) -> io::Result<()> {
        while let Some(due) = self.ledger.next_due().filter(|&due| due < until) {
            let mut edges = Edges::new();
            self.ledger.settle(due, &mut edges);
            event_log::write(self.log, &edges)?;
        }
        Ok(())
    }
}
