//! Play and presses: what is written, and what is told of it.

use std::borrow::Cow;
use std::io::{self, BufWriter, Write};

use serde::Serialize;

use super::arguments::{Arguments, NUMERICAL};
use super::life::{self, LifeFile};
use crate::cli::failure::Failure;
use crate::cli::files::destination::Destination;
use crate::cli::files::field::field_of;
use crate::cli::playing::profile;
use crate::cli::printing::progress::Progress;
use crate::cli::printing::written::{print_json, say, stdout};
use tactpad::pad::device::{Device, Patch};
use tactpad::pad::twin::life::Life;
use tactpad::pipeline::capture::head::Head;
use tactpad::pipeline::capture::writer::CaptureWriter;
use tactpad::pipeline::mapping::profile::Profile;
use tactpad::pipeline::mapping::read::ReadProfile;
use tactpad::pipeline::mapping::read::check::OutputChoice;
use tactpad::pipeline::shipped;
use tactpad::quantity::Contact;
use tactpad::time::HostInstant;
use tactpad::virtual_pad::firmware::VirtualPad;
use tactpad::virtual_pad::freehand::{FORCE_MAX_N, LEAST_US, Placement, WITHIN_MM, Weights, play, presses};
use tactpad::virtual_pad::recording::{Recorded, record, record_weights};
use tactpad::virtual_pad::script::Script;

/// Where nobody says otherwise.
const SECONDS: f64 = 120.0;
const PROFILE: &str = "super-mario";

/// One row of the truth in so many microseconds.
const TRUTH_US: u64 = 10_000;

/// The motion of a hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum HandMotion {
    /// It plays a profile.
    Play,
    /// It presses anywhere.
    Presses,
}

/// The report of a capture.
#[derive(Serialize)]
struct CaptureReport {
    samples: u64,
    touches: u64,
    weights: usize,
    seconds: f64,
    /// Age of the pad in the end, in seconds.
    pad_seconds: f64,
    pad_cycles: f64,
    twin: &'static str,
}

/// The files to write.
struct TwinFiles {
    capture: Destination,
    truth: Option<Destination>,
    weights: Option<Destination>,
    state: Option<LifeFile>,
}

/// Records what a hand does.
pub(super) fn make(arguments: &Arguments, hands: HandMotion, prints_capture: bool) -> Result<(), Failure> {
    let device = arguments.pad.read_imperfect()?;
    let profile = profile::read(arguments.profile(), OutputChoice::AsWritten)?;
    let (script, duration_us) = arguments.script(hands, profile.profile(), &device)?;
    let weights = arguments.weights_on(&device)?;
    let files = TwinFiles {
        capture: Destination::of(&arguments.out)?,
        truth: arguments.truth.as_deref().map(Destination::of).transpose()?,
        weights: arguments.weights.as_deref().map(Destination::of).transpose()?,
        state: arguments.state.as_deref().map(LifeFile::of).transpose()?,
    };
    let life = life::begun(files.state.as_ref(), &device, arguments.seed)?;
    let field = field_of(&device)?;
    let progress = Progress::begin("playing");
    let life = life::after(arguments.cycles, life, &device, &field);
    let pad = VirtualPad::going_on(script, &device, &field, life, arguments.seed);
    let (recorded, life) = files.record(pad, profile, duration_us, weights.as_ref(), arguments.weight_g)?;
    if let Some(state) = &files.state {
        state.write(&life, &device)?;
    }
    drop(progress);
    report(arguments, recorded, weights.as_ref(), &life, prints_capture)
}

impl Arguments {
    /// The profile's name.
    pub(super) fn profile(&self) -> &str {
        self.profile.as_deref().unwrap_or(PROFILE)
    }

    /// The script of the hand's motion.
    fn script(
        &self,
        hands: HandMotion,
        profile: &Profile,
        device: &Device,
    ) -> Result<(Script, u64), Failure> {
        let duration_us = (1e6 * self.seconds.unwrap_or(SECONDS)) as u64;
        if duration_us < LEAST_US {
            let least = LEAST_US / 1_000_000;
            return Err(Failure::Unusable(format!(
                "--seconds is too short for a touch between two rests: give it {least} or more"
            )));
        }
        let within_mm = self.within_mm(&device.contact)?;
        let script = match hands {
            HandMotion::Play => play(profile, duration_us, within_mm, self.seed),
            HandMotion::Presses => presses(duration_us, within_mm, self.seed),
        };
        Ok((script, duration_us))
    }

    /// How far from the centre the hand goes.
    fn within_mm(&self, patch: &Patch) -> Result<f32, Failure> {
        let max_mm = patch.max_centre_radius_mm;
        match self.within_mm {
            None => Ok(WITHIN_MM.min(max_mm as f32)),
            Some(mm) if mm > 0.0 && mm <= max_mm => Ok(mm as f32),
            Some(mm) => Err(Failure::Unusable(format!(
                "--within-mm is {mm}, and a finger stays on this plate up to {max_mm} mm from its centre: give it a number \
                 above 0 and up to that"
            ))),
        }
    }

    /// The weight that is laid on the pad, if one is.
    fn weights_on(&self, device: &Device) -> Result<Option<Weights>, Failure> {
        let Some(weight_g) = self.weight_g else { return Ok(None) };
        let (force_n, max_n) =
            (Weights::force_n(weight_g), f64::from(FORCE_MAX_N).max(device.contact.full_scale_n));
        if force_n > 0.0 && force_n <= max_n {
            return Ok(Some(Weights::new(weight_g, self.seed)));
        }
        Err(Failure::Unusable(format!(
            "--weight-g is {weight_g}, which presses with {force_n:.2} N: take a weight that presses with more than 0 and up \
             to {max_n} N"
        )))
    }
}

impl TwinFiles {
    /// Writes capture, truth and weights.
    fn record(
        &self,
        mut pad: VirtualPad,
        profile: ReadProfile,
        duration_us: u64,
        weights: Option<&Weights>,
        weight_g: Option<f64>,
    ) -> Result<(Recorded, Life), Failure> {
        let decoder = shipped::bytes(shipped::INVERSE).map(Cow::into_owned);
        let head = Head { decoder, profile: Some(profile) };
        let mut writing = self.capture.begin()?;
        let mut truth_writing = self.truth.as_ref().map(Destination::begin).transpose()?;
        let mut truth = Truth::begin(truth_writing.as_mut())?;
        let mut to = BufWriter::new(&mut writing);
        let mut capture = CaptureWriter::begin(&mut to, HostInstant::default(), &head)?;
        pad.introduce();
        let mut recorded = record(&mut pad, duration_us, &mut capture, |at_us, it| truth.see(at_us, it))?;
        let mut placements = Vec::new();
        if let Some(weights) = weights {
            let (laid, at) =
                record_weights(&mut pad, weights, &mut capture, |at_us, it| truth.see(at_us, it))?;
            recorded.samples += laid.samples;
            recorded.touches += laid.touches;
            placements = at;
        }
        capture.flush()?;
        drop(capture);
        truth.flush()?;
        drop((to, truth));
        writing.finish()?;
        truth_writing.map_or(Ok(()), |writing| writing.finish())?;
        if let Some((to, weight_g)) = self.weights.as_ref().zip(weight_g) {
            to.write(table_of(&placements, weight_g).as_bytes())?;
        }
        Ok((recorded, pad.into_life()))
    }
}

/// The placements as a table.
fn table_of(placements: &[Placement], weight_g: f64) -> String {
    let row = |it: &Placement| {
        let [x_mm, y_mm] = it.mark_mm;
        format!("{:.3},{x_mm},{y_mm},{weight_g}\n", seconds(it.at_us))
    };
    let rows: String = placements.iter().map(row).collect();
    format!("t_s,x_mm,y_mm,weight_g\n{rows}")
}

/// Microseconds since the first sample, in seconds.
fn seconds(us: u64) -> f64 {
    us as f64 * 1e-6
}

/// The true contacts while the pad is touched.
struct Truth<W: Write>(Option<BufWriter<W>>);

impl<W: Write> Truth<W> {
    fn begin(to: Option<W>) -> io::Result<Self> {
        let mut to = to.map(BufWriter::new);
        if let Some(to) = &mut to {
            writeln!(to, "t_s,x_mm,y_mm,fx_n,fy_n,fz_n")?;
        }
        Ok(Self(to))
    }

    fn see(&mut self, at_us: u64, contact: &Contact) -> io::Result<()> {
        let Some(to) = self.0.as_mut().filter(|_| at_us.is_multiple_of(TRUTH_US) && contact.fz_n > 0.0)
        else {
            return Ok(());
        };
        let Contact { x_mm, y_mm, fx_n, fy_n, fz_n } = contact;
        writeln!(to, "{:.2},{x_mm:.4},{y_mm:.4},{fx_n:.5},{fy_n:.5},{fz_n:.5}", seconds(at_us))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.as_mut().map_or(Ok(()), Write::flush)
    }
}

fn report(
    arguments: &Arguments,
    recorded: Recorded,
    weights: Option<&Weights>,
    life: &Life,
    prints_capture: bool,
) -> Result<(), Failure> {
    let Recorded { samples, touches } = recorded;
    let outcome = CaptureReport {
        samples,
        touches,
        weights: weights.map_or(0, |weights| weights.placements.len()),
        seconds: 1e-3 * samples as f64,
        pad_seconds: life.state.age_s(),
        pad_cycles: life.around.cycles,
        twin: NUMERICAL,
    };
    if arguments.json {
        return print_json(&outcome);
    }
    let lived = match arguments.state {
        Some(_) => life::told(life),
        None => String::new(),
    };
    let told = format!(
        "{samples} samples, {touches} touches, {:.0} s on the pad's clock{lived}; {NUMERICAL}",
        outcome.seconds
    );
    if prints_capture {
        say(told);
        return Ok(());
    }
    Ok(writeln!(stdout(), "{told}")?)
}
