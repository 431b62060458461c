//! The test that knows the pad: how probable the channels are if one finger presses, beside anything else.
//!
//! It has the twin's true field, gains and noise, and a pad without friction, creep, pickup or a wrong zero. Two contacts
//! have ten unknown numbers and the pad nine channels, so two fingers can explain any reading, and the logarithm of the
//! likelihood ratio is half the misfit of one finger, by chi-square with four degrees of freedom where there is one. So
//! its false-warning rate is that of the watch's threshold.

use tactpad::pad::device::Device;
use tactpad::pad::device::behaviour::{self, Behaviour};
use tactpad::pad::field::PadField;
use tactpad::pad::twin::pad::{Circumstances, TwinPad};
use tactpad::pipeline::contact::inverse::Inverse;
use tactpad::pipeline::contact::uncertainty::Noise;
use tactpad::plot::bands::Bands;
use tactpad::plot::grid::Grid;
use tactpad::plot::isoline::Isolines;
use tactpad::plot::plan::{Field, Plan};
use tactpad::plot::svg;
use tactpad::quantity::{CHANNELS, Contact, Strain};

use super::{APART_MM, LEAST_N, REACH_MM};

/// Chi-square of four numbers that a ten-thousandth exceeds.
const MISFIT_MAX: f64 = 23.51;
/// Readings of 1 kHz between the ramps of a press of 0.3 s.
const READINGS: u32 = 220;
/// Partners of a finger that the map tries: so many around, on so many rings.
const PARTNERS_AROUND: u32 = 72;
const PARTNER_RINGS: u32 = 12;

pub(crate) struct Ratio {
    /// The pad with noise and nothing else.
    device: Device,
    field: PadField,
    /// Of channels divided by their gains.
    known: Inverse,
    gain: [f64; CHANNELS],
}

impl Ratio {
    pub(crate) fn of(device: &Device, field: &PadField) -> Self {
        let mut noisy = device.clone();
        noisy.modules.iter_mut().for_each(|module| module.offset_uv = [0.0; 3]);
        noisy.behaviour = Behaviour { noise: device.behaviour.noise, ..Behaviour::IDEAL };
        let gain = std::array::from_fn(|k| device.modules[k / 3].gain[k % 3]);
        let behaviour::Noise { additive_uv, share, .. } = noisy.behaviour.noise;
        let of_mean = f64::from(READINGS).sqrt();
        let noise = Noise::of_channels(std::array::from_fn(|k| additive_uv[k] / of_mean / gain[k]), share);
        let known = Inverse::new(field.signals.clone(), noise);
        Self { device: noisy, field: field.clone(), known, gain }
    }

    /// Whether the test warns of these fingers.
    pub(crate) fn warns(&self, pair: &[Contact; 2], seed: u64) -> bool {
        let mut pad = TwinPad::new(&self.device, &self.field, seed);
        let around = Circumstances { temperature_c: 25.0, cycles: 0.0 };
        let mut mean_uv = [0.0; CHANNELS];
        for _ in 0..READINGS {
            let uv = pad.read_all(1e-3, pair, &around);
            mean_uv.iter_mut().zip(uv).for_each(|(mean, uv)| *mean += uv / f64::from(READINGS));
        }
        let free = std::array::from_fn(|k| (mean_uv[k] / self.gain[k]) as f32);
        self.misfit(&Strain { uv: free }) > MISFIT_MAX
    }

    fn misfit(&self, strain: &Strain) -> f64 {
        self.known.estimate(strain).map_or(0.0, |estimate| estimate.misfit)
    }

    /// Where a finger of 0.5 N hides another of 0.5 N best, as SVG: the least misfit that any partner makes.
    pub(crate) fn blind_pairs(&self) -> String {
        let reach_mm = f64::from(REACH_MM);
        let grid = Grid::over_disc(reach_mm, 51, |x_mm, y_mm| self.least(x_mm as f32, y_mm as f32));
        println!("least misfit of a pair, over the plate: {:.1?}", grid.span());
        let bands = Bands::sequential_decades(grid.span());
        let label = "misfit of one finger".into();
        let plan = Plan {
            title: "The pair of 0.5 N that is hardest to see, by one finger's place".into(),
            x: [-reach_mm, reach_mm],
            y: [-reach_mm, reach_mm],
            x_label: "x in mm".into(),
            y_label: "y in mm".into(),
            field: Some(Field { grid, bands, isolines: Isolines::None, label }),
            shapes: vec![],
        };
        svg::text(&plan.figure(480.0))
    }

    fn least(&self, x_mm: f32, y_mm: f32) -> f64 {
        let finger = |x_mm: f32, y_mm: f32| {
            self.field.signals.strain_uv(&Contact { x_mm, y_mm, fz_n: LEAST_N, ..Contact::default() }).uv
        };
        let here = finger(x_mm, y_mm);
        let mut least = f64::INFINITY;
        for partner in 0..PARTNERS_AROUND * PARTNER_RINGS {
            let radius_mm = REACH_MM * (partner / PARTNERS_AROUND + 1) as f32 / PARTNER_RINGS as f32;
            let angle = std::f32::consts::TAU * (partner % PARTNERS_AROUND) as f32 / PARTNERS_AROUND as f32;
            let (px_mm, py_mm) = (radius_mm * libm::cosf(angle), radius_mm * libm::sinf(angle));
            if libm::hypotf(px_mm - x_mm, py_mm - y_mm) >= APART_MM {
                let there = finger(px_mm, py_mm);
                let both = std::array::from_fn(|k| here[k] + there[k]);
                least = least.min(self.misfit(&Strain { uv: both }));
            }
        }
        if least.is_finite() { least } else { f64::NAN }
    }
}
