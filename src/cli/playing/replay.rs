//! `tactpad replay`: the event log of a capture, or of a list of contacts.

use std::fmt;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::failure::{Failure, if_read};
use crate::cli::files::decoder_file::DecoderChoice;
use crate::cli::files::recording::{Profiles, Recording};
use crate::cli::files::tables;
use crate::cli::playing::profile;
use crate::cli::printing::written::{print_json, stdout};
use tactpad::counted::counted;
use tactpad::lab::tuning::difference::{Difference, Side, UnmatchedPress};
use tactpad::pipeline::control::{Code, OutputEvent};
use tactpad::pipeline::mapping::profile::Profile;
use tactpad::pipeline::mapping::read::check::OutputChoice;
use tactpad::pipeline::output::event_log;
use tactpad::pipeline::replay::ContactReplay;
use tactpad::pipeline::{NoProbe, Pipeline};
use tactpad::quantity::Contact;
use tactpad::tables::measured::columns::TableKind;
use tactpad::time::StreamInstant;

/// The plate of the pads that profiles are made for.
const PLATE_RADIUS_MM: f64 = 30.0;

/// Rows of a table without times are this far apart.
const PERIOD_US: u64 = 1_000;

/// Arguments of `tactpad replay`.
#[derive(Debug, Args)]
#[command(after_help = "Example: tactpad record game.cap, then tactpad replay game.cap\n\n\
    What another profile would have done: tactpad replay game.cap --profile mine.toml --compare super-mario")]
#[group(skip)]
pub(crate) struct Arguments {
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
    /// Print instead what --profile changes: presses that only it gives (+), or only this older profile (-).
    #[arg(long, value_name = "OLD", requires = "profile")]
    compare: Option<String>,
    /// With --compare: print one JSON document.
    #[arg(long, requires = "compare")]
    json: bool,
    /// Without it a capture replays with the one it was recorded with.
    #[command(flatten)]
    decoder: DecoderChoice,
}

/// Takes simultaneous events.
type EventHandler<'s> = dyn FnMut(&[OutputEvent]) -> Result<(), Failure> + 's;

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let read =
        |name: &String| profile::read(name, OutputChoice::AsWritten).map(|read| read.profile().clone());
    let chosen = arguments.profile.as_ref().map(read).transpose()?;
    match (&arguments.compare, chosen) {
        (Some(old), Some(new)) => compare(arguments, read(old)?, new),
        (_, chosen) => {
            let mut log = BufWriter::new(stdout());
            let played = arguments.play(chosen, &mut |events| Ok(event_log::write(&mut log, events)?));
            // What a damaged recording held is printed before the verdict, even where nobody reads it.
            if_read(log.flush().map_err(Failure::from))?;
            played
        }
    }
}

/// Prints what only one of two profiles gives.
fn compare(arguments: &Arguments, old: Profile, new: Profile) -> Result<(), Failure> {
    let events = |profile: Profile| {
        let mut events = Vec::new();
        arguments.play(Some(profile), &mut |group| {
            events.extend_from_slice(group);
            Ok(())
        })?;
        Ok::<_, Failure>(events)
    };
    let difference = Difference::between(&events(old)?, &events(new)?);
    if arguments.json {
        print_json(&difference)
    } else {
        Ok(writeln!(stdout(), "{}", DifferenceText(&difference))?)
    }
}

/// A difference for people.
struct DifferenceText<'d>(&'d Difference);

impl fmt::Display for DifferenceText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Difference { both, shift_max_us, only, pointer_counts: [old, new] } = self.0;
        for UnmatchedPress { with, press } in only {
            let sign = match with {
                Side::Old => '-',
                Side::New => '+',
            };
            let side = match (press.code, press.value) {
                (Code::Axis(_), value) if value < 0 => "-",
                (Code::Axis(_), _) => "+",
                _ => "",
            };
            let seconds = |us: u64| us as f64 * 1e-6;
            let (at_s, for_s) = (seconds(press.t_us), seconds(press.duration_us));
            writeln!(f, "{sign} {at_s:10.3} s  {}{side}  for {for_s:.3} s", press.code)?;
        }
        let count = |side: Side| only.iter().filter(|it| it.with == side).count();
        write!(f, "{} with both", counted(both, "press"))?;
        if *shift_max_us > 0 {
            write!(f, ", at most {:.0} ms apart", *shift_max_us as f64 * 1e-3)?;
        }
        write!(
            f,
            "; {} only with the old profile (-), {} only with the new one (+)",
            count(Side::Old),
            count(Side::New)
        )?;
        if [old, new] != [&0, &0] {
            write!(f, "\nthe pointer goes {old} counts with the old profile, {new} with the new one")?;
        }
        Ok(())
    }
}

impl Arguments {
    /// Plays the capture or the contacts.
    fn play(&self, chosen: Option<Profile>, see: &mut EventHandler<'_>) -> Result<(), Failure> {
        match (&self.capture, &self.contacts, chosen) {
            (Some(path), _, chosen) => replay_capture(path, chosen, &self.decoder, see),
            (None, Some(_), _) if self.decoder.is_given() => {
                Err(Failure::Unusable("--contacts are decoded already: leave out --decoder".into()))
            }
            (None, Some(path), Some(profile)) => replay_contacts(path, profile, see),
            _ => Err(Failure::Unusable("give a capture, or --contacts and --profile".into())),
        }
    }
}

fn replay_capture(
    path: &Path,
    chosen: Option<Profile>,
    decoder: &DecoderChoice,
    see: &mut EventHandler<'_>,
) -> Result<(), Failure> {
    let mut recording = Recording::open(path)?;
    let profiles = if chosen.is_some() { Profiles::Skipped } else { Profiles::Followed };
    let profile = match chosen {
        Some(profile) => profile,
        None => recording.profile()?,
    };
    let mut pipeline = Pipeline::new(recording.decoder(decoder)?, profile);
    recording.each(profiles, |now, call| {
        let mut left = Some(call);
        while let Some(call) = left {
            left = pipeline.apply(now, call, &mut NoProbe);
            see(pipeline.events())?;
        }
        Ok(())
    })
}

/// Maps contacts as they stand: each row is a sample, a row without normal force is a lift.
fn replay_contacts(path: &Path, profile: Profile, see: &mut EventHandler<'_>) -> Result<(), Failure> {
    let rows = tables::read(path, TableKind::Contacts, PLATE_RADIUS_MM)?.rows;
    let mut replay = ContactReplay::new(profile);
    let mut deliver = |events: &[OutputEvent]| see(events);
    let mut end = StreamInstant::default();
    for (index, row) in rows.iter().enumerate() {
        let us = row.t_s.map_or_else(|| index as u64 * PERIOD_US, |t_s| (t_s * 1e6).round() as u64);
        end = StreamInstant::from_us(us);
        let contact = Some(&row.label.into()).filter(|contact: &&Contact| contact.fz_n > 0.0).copied();
        replay.step(end, contact.as_ref(), &mut deliver)?;
    }
    // The list ends with a lift, so that nothing stays held.
    replay.step(end, None, &mut deliver)?;
    replay.settle(StreamInstant::from_us(u64::MAX), &mut deliver)
}
