//! The methods whose decoders are files of the program's own: `inverse`, `wrench`, `linear`, `knn`.

use std::fmt;
use std::path::Path;

use serde::Serialize;

use super::measured::Measured;
use super::method::Method;
use crate::cli::decoder_file;
use crate::cli::failure::Failure;
use crate::cli::progress::Progress;
use tactpad::lab::calibration::earlier::Earlier;
use tactpad::lab::calibration::fit::Calibration;
use tactpad::lab::calibration::thermal_fit::ThermalFit;
use tactpad::numeric::statistics::mean;
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;
use tactpad::pipeline::compensation::creep::{Creep, NO_CREEP};
use tactpad::pipeline::compensation::hysteresis::Play;
use tactpad::pipeline::contact::Decoder;
use tactpad::pipeline::contact::regression::Target;
use tactpad::quantity::{CHANNEL_NAMES, CHANNELS};

/// What was found about the pad.
#[derive(Default, Serialize)]
pub(super) struct Fit {
    /// What the inverse decoder's calibration found; nothing for the other methods.
    #[serde(skip_serializing_if = "Option::is_none")]
    pad: Option<Pad>,
}

#[derive(Serialize)]
struct Pad {
    gain: [f64; CHANNELS],
    noise_uv: [f64; CHANNELS],
    noise_share: [f64; CHANNELS],
    background_share: f64,
    /// Play operators: threshold and share, as means over the channels.
    #[serde(rename = "friction")]
    hysteresis: Vec<Hysteresis>,
    #[serde(skip_serializing_if = "Option::is_none")]
    creep: Option<FoundCreep>,
    parameters: Vec<Found>,
    /// What the untouched pad reads, where no row reads it.
    #[serde(skip_serializing_if = "Option::is_none")]
    zero_uv: Option<[f64; CHANNELS]>,
    /// How channels follow the temperature, where it was measured at several.
    #[serde(skip_serializing_if = "Option::is_none")]
    thermal: Option<FoundThermal>,
    /// Whether the field of `--from` was nearer than the simulated one.
    field_from_earlier: bool,
}

/// Coefficients per degree; null where nothing tells them.
#[derive(Serialize)]
struct FoundThermal {
    reference_c: f64,
    zero_uv_per_c: Option<[f64; CHANNELS]>,
    zero_deviation: Option<[f64; CHANNELS]>,
    gain_per_c: Option<[f64; CHANNELS]>,
    gain_deviation: Option<[f64; CHANNELS]>,
}

#[derive(Serialize)]
struct Hysteresis {
    threshold_uv: f64,
    share: f64,
}

/// What a load adds to itself in the end.
#[derive(Clone, Copy, Serialize)]
struct FoundCreep {
    time_s: f64,
    share: f64,
}

/// How much a number of the device differs from the device's own.
#[derive(Serialize)]
struct Found {
    name: &'static str,
    change: f64,
    deviation: f64,
}

/// The decoder of `--from`; none for a method that begins with none, or with a network.
pub(super) fn earlier(method: Method, from: Option<&Path>) -> Result<Option<Decoder>, Failure> {
    match (method, from) {
        (Method::Inverse, Some(path)) => another_pads(path).map(Some),
        (Method::Wrench | Method::Linear | Method::Knn, Some(_)) => Err(Failure::Unusable(
            "--from is for inverse and scdf; wrench, linear and knn are made of the measured contacts alone"
                .into(),
        )),
        (_, None) | (Method::Scdf, Some(_)) => Ok(None),
    }
}

/// Fits the decoder.
pub(super) fn adapt(
    method: Method,
    measured: &Measured,
    earlier: Option<&Decoder>,
    (device, field): (&Device, &PadField),
) -> Result<(Decoder, Fit), Failure> {
    let (contacts, reach_mm) = (&measured.contacts, device.contact.max_centre_radius_mm);
    let fitted = match method {
        Method::Inverse => return calibrated(measured, earlier, (device, field)),
        Method::Knn => contacts.neighbours(),
        Method::Wrench => contacts.regression(Target::Wrench, reach_mm),
        Method::Linear | Method::Scdf => contacts.regression(Target::Contact, reach_mm),
    };
    Ok((fitted.map_err(|error| measured.refused(error))?, Fit::default()))
}

fn calibrated(
    measured: &Measured,
    earlier: Option<&Decoder>,
    (device, field): (&Device, &PadField),
) -> Result<(Decoder, Fit), Failure> {
    let progress = Progress::begin("fitting the pad's field");
    let report = |done: usize, of: usize| progress.part(done, of, "fitting the pad's field");
    let earlier = earlier.and_then(Earlier::of);
    let calibration = measured.contacts.calibration(device, field, earlier, &report);
    drop(progress);
    let calibration = calibration.map_err(|error| measured.refused(error))?;
    let found = Fit { pad: Some(Pad::of(&calibration)) };
    Ok((calibration.decoder(), found))
}

/// The other pad's decoder to begin with.
fn another_pads(path: &Path) -> Result<Decoder, Failure> {
    let decoder = decoder_file::read(path)?;
    if Earlier::of(&decoder).is_none() {
        return Err(Failure::Unusable(format!(
            "--from {} is a {} decoder; inverse begins with one that adapt --method inverse wrote",
            path.display(),
            decoder.name()
        )));
    }
    Ok(decoder)
}

impl Pad {
    fn of(calibration: &Calibration) -> Self {
        let found = |(parameter, change, deviation): &(_, f64, f64)| {
            let parameter: &tactpad::pad::device::parameter::Parameter = parameter;
            Found { name: parameter.name(), change: *change, deviation: *deviation }
        };
        let hysteresis =
            |play: &Play| Hysteresis { threshold_uv: mean(play.threshold_uv), share: mean(play.share) };
        let compensation = &calibration.compensation;
        Self {
            hysteresis: compensation.hysteresis.iter().map(hysteresis).filter(|it| it.share > 0.0).collect(),
            creep: FoundCreep::of(&compensation.creep),
            gain: calibration.gain,
            noise_uv: calibration.noise.additive_uv,
            noise_share: calibration.noise.share,
            background_share: calibration.background,
            zero_uv: compensation.zero_uv,
            thermal: calibration.thermal.as_ref().map(FoundThermal::of),
            field_from_earlier: calibration.from_earlier,
            parameters: calibration.physical.iter().map(found).collect(),
        }
    }
}

impl FoundCreep {
    fn of(creep: &Creep) -> Option<Self> {
        let Creep { time_s, share } = *creep;
        (*creep != NO_CREEP).then_some(Self { time_s, share })
    }
}

impl FoundThermal {
    fn of(fit: &ThermalFit) -> Self {
        let ThermalFit { coefficients, zero_deviation, gain_deviation } = *fit;
        Self {
            reference_c: coefficients.reference_c,
            zero_uv_per_c: zero_deviation.map(|_| coefficients.zero_uv_per_c),
            zero_deviation,
            gain_per_c: gain_deviation.map(|_| coefficients.gain_per_c),
            gain_deviation,
        }
    }
}

impl fmt::Display for FoundThermal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { reference_c, zero_uv_per_c, zero_deviation, gain_per_c, gain_deviation } = self;
        writeln!(f, "channel  zero µV/°C  gain %/°C, around {reference_c:.1} °C")?;
        let text =
            |found: &Option<[f64; CHANNELS]>, deviation: &Option<[f64; CHANNELS]>, k: usize, unit: f64| {
                found.zip(*deviation).map_or_else(
                    || "not told".into(),
                    |(found, deviation)| format!("{:+.3} ± {:.3}", unit * found[k], unit * deviation[k]),
                )
            };
        for (k, name) in CHANNEL_NAMES.iter().enumerate() {
            let zero = text(zero_uv_per_c, zero_deviation, k, 1.0);
            writeln!(f, "{name:<7} {zero}  {}", text(gain_per_c, gain_deviation, k, 100.0))?;
        }
        Ok(())
    }
}

impl fmt::Display for Fit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(pad) = &self.pad else { return f.write_str("fitted") };
        writeln!(f, "channel   gain  noise µV  noise %")?;
        for (k, name) in CHANNEL_NAMES.iter().enumerate() {
            let share = 100.0 * pad.noise_share[k];
            writeln!(f, "{name:<7} {:>6.3} {:>9.1} {share:>8.2}", pad.gain[k], pad.noise_uv[k])?;
        }
        for Found { name, change, deviation } in &pad.parameters {
            writeln!(f, "{name:<30} {change:>+8.3} ± {deviation:.3}")?;
        }
        for Hysteresis { threshold_uv, share } in &pad.hysteresis {
            writeln!(f, "friction: {:.2} % of what is beyond {threshold_uv:.0} µV", 100.0 * share)?;
        }
        if let Some(FoundCreep { time_s, share }) = pad.creep {
            writeln!(f, "creep: {:+.2} % of a load, with a relaxation time of {time_s} s", 100.0 * share)?;
        }
        if let Some(zero_uv) = &pad.zero_uv {
            writeln!(f, "untouched: {zero_uv:.0?} µV, told by the contacts")?;
        }
        if let Some(thermal) = &pad.thermal {
            thermal.fmt(f)?;
        }
        write!(f, "smooth background: {:.1} % of each map", 100.0 * pad.background_share)?;
        if pad.field_from_earlier { write!(f, ", beside the earlier pad's field") } else { Ok(()) }
    }
}
