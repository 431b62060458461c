//! Measured contacts, with the simulator's field and its derivatives at their places: what stays fixed during a calibration.

use crate::numeric::zernike::{Jet, jets, norms};
use crate::pad::field::{PadField, Sensitivity};
use crate::pipeline::compensation::hysteresis::PLAYS;
use crate::quantity::{CHANNELS, Contact};
use crate::tables::measured::Row;

/// Degree of the background's polynomials: features of some 10 mm.
pub(super) const BACKGROUND_DEGREE: usize = 5;
/// Number of these polynomials.
pub(super) const TERMS: usize = (BACKGROUND_DEGREE + 1) * (BACKGROUND_DEGREE + 2) / 2;

/// Per channel, what a unit force along each axis gives.
pub(super) type Maps = [[f64; 3]; CHANNELS];

/// For each play operator and channel: its state beside the strain, relative to the same of the untouched pad.
pub(super) type Lags = [[f64; CHANNELS]; PLAYS];

/// The simulator's field at a place.
#[derive(Clone, Debug)]
pub(super) struct Place {
    /// µV/N.
    pub(super) gains: Maps,
    /// ∇G: µV/N per mm of x and of y.
    pub(super) gradient: [Maps; 2],
    /// ∇²G: the sum of the second derivatives by x and y, µV/N per mm².
    pub(super) laplacian: Maps,
    /// ∂G/∂p: µV/N per unit of each physical parameter.
    pub(super) sensitivities: Vec<Maps>,
    /// The background's polynomials, each with a root mean square of 1 over the plate.
    pub(super) terms: [f64; TERMS],
}

/// One measured contact.
#[derive(Clone, Debug)]
pub(super) struct Measured {
    pub(super) place: Place,
    pub(super) force_n: [f64; 3],
    /// Channels relative to the zero.
    pub(super) uv: [f64; CHANNELS],
    /// ΔT: temperature above the reference; zero where it is unknown.
    pub(super) above_c: f64,
    /// Lags of the play operators, by the load path and the parameters.
    pub(super) lags: Lags,
    /// Creep states u.
    pub(super) crept_uv: [f64; CHANNELS],
}

impl Place {
    /// The field at a place in millimetres.
    pub(super) fn of(
        field: &PadField,
        sensitivities: &[&Sensitivity],
        plate_mm: f64,
        place_mm: [f64; 2],
    ) -> Self {
        // Polynomials are over the unit disc, splines in millimetres.
        let share = place_mm.map(|mm| mm / plate_mm);
        let degree =
            sensitivities.iter().map(|it| degree_of(it.maps[0][0].coefficients.len())).max().unwrap_or(0);
        let jets = jets(degree.max(BACKGROUND_DEGREE), share);
        let sensitivity =
            |it: &&Sensitivity| it.maps.each_ref().map(|axes| axes.each_ref().map(|map| map.value(&jets)));
        let gains = field.signals.gains(place_mm[0] as f32, place_mm[1] as f32);
        Self {
            gains: gains.value,
            gradient: [gains.dx, gains.dy],
            laplacian: field.signals.laplacian(place_mm),
            sensitivities: sensitivities.iter().map(sensitivity).collect(),
            terms: terms(&jets),
        }
    }
}

/// Σₐ Fₐ Eₐ.
pub(super) fn response(map: &[f64; 3], force_n: &[f64; 3]) -> f64 {
    map.iter().zip(force_n).map(|(map, n)| map * n).sum()
}

/// The degree of a polynomial with this number of coefficients.
fn degree_of(coefficients: usize) -> usize {
    (0..).find(|degree| (degree + 1) * (degree + 2) / 2 >= coefficients).unwrap_or(0)
}

/// The polynomials divided by their root mean square over the disc, √(‖U‖²/π).
fn terms(jets: &[Jet]) -> [f64; TERMS] {
    let norms = norms(BACKGROUND_DEGREE);
    std::array::from_fn(|term| jets[term].value * (std::f64::consts::PI / norms[term]).sqrt())
}

impl Measured {
    /// A contact without readings, for predictions.
    pub(super) const fn unmeasured(place: Place, force_n: [f64; 3]) -> Self {
        Self {
            place,
            force_n,
            uv: [0.0; CHANNELS],
            above_c: 0.0,
            lags: [[0.0; CHANNELS]; PLAYS],
            crept_uv: [0.0; CHANNELS],
        }
    }

    /// A tared row; `None` without channels.
    pub(super) fn of(
        field: &PadField,
        sensitivities: &[&Sensitivity],
        plate_mm: f64,
        row: &Row,
        reference_c: Option<f64>,
    ) -> Option<Self> {
        let Contact { x_mm, y_mm, .. } = Contact::from(row.label);
        let place = Place::of(field, sensitivities, plate_mm, [x_mm, y_mm].map(f64::from));
        Some(Self {
            place,
            force_n: [row.label.fx_n, row.label.fy_n, row.label.fz_n],
            uv: row.uv?,
            above_c: row.temp_c.zip(reference_c).map_or(0.0, |(temp_c, reference_c)| temp_c - reference_c),
            lags: [[0.0; CHANNELS]; PLAYS],
            crept_uv: [0.0; CHANNELS],
        })
    }
}
