//! Measured contacts, with the simulator's field and its derivatives at their places: what stays fixed during a calibration.

use std::sync::Arc;

use super::rig::WrittenLabel;
use tactpad_core::pad::field::{PadField, Sensitivity};
use tactpad_core::pipeline::compensation::hysteresis::PLAYS;
use tactpad_core::pipeline::contact::uncertainty::UNKNOWNS;
use tactpad_core::quantity::{CHANNELS, Contact};
use tactpad_core::tables::measured::Row;
use tactpad_numeric::products::dot;
use tactpad_numeric::zernike::{Jet, jets, norms};

/// Degree of the background's polynomials: features of some 10 mm.
pub(crate) const BACKGROUND_DEGREE: usize = 5;
/// Number of these polynomials.
pub(crate) const TERMS: usize = (BACKGROUND_DEGREE + 1) * (BACKGROUND_DEGREE + 2) / 2;

/// Per channel, what a unit force along each axis gives.
pub(crate) type Maps = [[f64; 3]; CHANNELS];

/// For each play operator and channel: its state beside the strain, relative to the same of the untouched pad.
pub(crate) type Lags = [[f64; CHANNELS]; PLAYS];

/// Knowledge of a contact beside its channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Knowledge {
    /// A reference wrote it down: how well, the fit finds.
    Written,
    /// Nothing, as of a press in play. Its label is where the search for it begins.
    Unlabelled,
    /// A known weight on a marked place: standard deviations of x, y (mm), Fx, Fy, Fz (N) around the label.
    Placed([f64; UNKNOWNS]),
}

/// A contact to fit to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fitted {
    /// Its row in the recording.
    pub row: usize,
    /// Knowledge of it.
    pub knowledge: Knowledge,
}

/// The simulator's field at a place.
#[derive(Clone, Debug)]
pub(crate) struct FieldAtPlace {
    /// µV/N.
    pub(crate) gains: Maps,
    /// ∇G: µV/N per mm of x and of y.
    pub(crate) gradient: [Maps; 2],
    /// ∇²G: the sum of the second derivatives by x and y, µV/N per mm².
    pub(crate) laplacian: Maps,
    /// ∂G/∂p: µV/N per unit of each physical parameter.
    pub(crate) sensitivities: Vec<Maps>,
    /// ∇∂G/∂p: the same per mm of x and of y.
    pub(crate) sensitivity_gradients: Vec<[Maps; 2]>,
    /// The background's polynomials, each with a root mean square of 1 over the plate.
    pub(crate) terms: [f64; TERMS],
}

/// One measured contact.
#[derive(Clone, Debug)]
pub(crate) struct Measured {
    /// Knowledge of it.
    pub(crate) knowledge: Knowledge,
    /// Label as it was written.
    pub(crate) written: WrittenLabel,
    /// x, y, Fx, Fy, Fz that this stands for.
    pub(crate) label: [f64; UNKNOWNS],
    /// On the pad's clock; zero where rows have no time.
    pub(crate) at_s: f64,
    /// Where the contact is taken to be, and its force: the label's, or the most likely ones where the channels may correct it.
    pub(crate) place_mm: [f64; 2],
    pub(crate) place: Arc<FieldAtPlace>,
    pub(crate) force_n: [f64; 3],
    /// Channels relative to the zero.
    pub(crate) uv: [f64; CHANNELS],
    /// ΔT: temperature above the reference; zero where it is unknown.
    pub(crate) above_c: f64,
    /// b: the part of the measurement's ageing that was still to come.
    pub(crate) to_come: f64,
    /// Lags of the play operators, by the load path and the parameters.
    pub(crate) lags: Lags,
    /// Creep states u.
    pub(crate) crept_uv: [f64; CHANNELS],
}

impl FieldAtPlace {
    /// The field at a place in millimetres.
    pub(crate) fn of(
        field: &PadField,
        sensitivities: &[&Sensitivity],
        plate_mm: f64,
        place_mm: [f64; 2],
    ) -> Self {
        let jets = polynomials(sensitivities, plate_mm, place_mm);
        let [dx, dy] =
            [|it: &Jet| it.dx, |it: &Jet| it.dy].map(|of| jets.iter().map(of).collect::<Vec<f64>>());
        // Σₜ cₜ ∇Uₜ/R.
        let gradient = |it: &&Sensitivity| [&dx, &dy].map(|terms| maps(it, terms, 1.0 / plate_mm));
        Self {
            sensitivity_gradients: sensitivities.iter().map(gradient).collect(),
            ..Self::level(field, sensitivities, plate_mm, place_mm)
        }
    }

    /// The same without the slopes of the sensitivities, which take twice as long as all else: these are empty.
    pub(crate) fn level(
        field: &PadField,
        sensitivities: &[&Sensitivity],
        plate_mm: f64,
        place_mm: [f64; 2],
    ) -> Self {
        let jets = polynomials(sensitivities, plate_mm, place_mm);
        let values: Vec<f64> = jets.iter().map(|it| it.value).collect();
        let factors = term_factors();
        let gains = field.signals.gains(place_mm[0] as f32, place_mm[1] as f32);
        Self {
            gains: gains.value,
            gradient: [gains.dx, gains.dy],
            laplacian: field.signals.laplacian(place_mm),
            // Σₜ cₜ Uₜ.
            sensitivities: sensitivities.iter().map(|it| maps(it, &values, 1.0)).collect(),
            sensitivity_gradients: Vec::new(),
            terms: std::array::from_fn(|term| factors[term] * values[term]),
        }
    }
}

/// The polynomials of the sensitivities and of the background at a place. They are over the unit disc, splines in millimetres.
fn polynomials(sensitivities: &[&Sensitivity], plate_mm: f64, place_mm: [f64; 2]) -> Vec<Jet> {
    let degrees = sensitivities.iter().map(|it| degree_of(it.maps[0][0].coefficients.len()));
    jets(degrees.max().unwrap_or(0).max(BACKGROUND_DEGREE), place_mm.map(|mm| mm / plate_mm))
}

/// A sensitivity's maps by these values of its polynomials, or slopes of them.
fn maps(sensitivity: &Sensitivity, terms: &[f64], scale: f64) -> Maps {
    sensitivity.maps.each_ref().map(|axes| {
        axes.each_ref().map(|map| {
            let terms = &terms[..map.coefficients.len().min(terms.len())];
            scale * dot(&map.coefficients[..terms.len()], terms)
        })
    })
}

/// Σₐ Fₐ Eₐ.
pub(crate) fn response(map: &[f64; 3], force_n: &[f64; 3]) -> f64 {
    map.iter().zip(force_n).map(|(map, n)| map * n).sum()
}

/// The degree of a polynomial with this number of coefficients.
fn degree_of(coefficients: usize) -> usize {
    (0..).find(|degree| (degree + 1) * (degree + 2) / 2 >= coefficients).unwrap_or(0)
}

/// One over each polynomial's root mean square over the disc, √(‖U‖²/π).
fn term_factors() -> [f64; TERMS] {
    let norms = norms(BACKGROUND_DEGREE);
    std::array::from_fn(|term| (std::f64::consts::PI / norms[term]).sqrt())
}

impl Measured {
    /// A contact without readings, for predictions.
    pub(crate) fn unmeasured(place_mm: [f64; 2], place: FieldAtPlace, force_n: [f64; 3]) -> Self {
        let ([x_mm, y_mm], [fx_n, fy_n, fz_n]) = (place_mm, force_n);
        Self {
            knowledge: Knowledge::Written,
            written: WrittenLabel::still([x_mm, y_mm, fx_n, fy_n, fz_n]),
            label: [x_mm, y_mm, fx_n, fy_n, fz_n],
            at_s: 0.0,
            place_mm,
            place: Arc::new(place),
            force_n,
            uv: [0.0; CHANNELS],
            above_c: 0.0,
            to_come: 0.0,
            lags: [[0.0; CHANNELS]; PLAYS],
            crept_uv: [0.0; CHANNELS],
        }
    }

    /// A row of a tared table; `None` without channels.
    pub(crate) fn of(
        field: &PadField,
        sensitivities: &[&Sensitivity],
        plate_mm: f64,
        rows: &[Row],
        at: usize,
        knowledge: Knowledge,
        reference_c: Option<f64>,
    ) -> Option<Self> {
        let row = rows.get(at)?;
        let Contact { x_mm, y_mm, .. } = Contact::from(row.label);
        let place_mm = [x_mm, y_mm].map(f64::from);
        let place = FieldAtPlace::of(field, sensitivities, plate_mm, place_mm);
        let force_n = [row.label.fx_n, row.label.fy_n, row.label.fz_n];
        Some(Self {
            knowledge,
            written: WrittenLabel::of(rows, at)?,
            at_s: row.t_s.unwrap_or(0.0),
            uv: row.uv?,
            above_c: row.temp_c.zip(reference_c).map_or(0.0, |(temp_c, reference_c)| temp_c - reference_c),
            ..Self::unmeasured(place_mm, place, force_n)
        })
    }

    /// How far it is taken to be from its label.
    pub(crate) fn off_label(&self) -> [f64; UNKNOWNS] {
        let ([x_mm, y_mm], [fx_n, fy_n, fz_n]) = (self.place_mm, self.force_n);
        let here = [x_mm, y_mm, fx_n, fy_n, fz_n];
        std::array::from_fn(|k| here[k] - self.label[k])
    }
}
