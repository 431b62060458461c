//! Measured contacts, with everything of the simulator's that does not change while a pad is calibrated.

use crate::contact::friction::PLAYS;
use crate::contact::recording::Lags;
use crate::field::{PadField, Sensitivity};
use crate::influence::InfluenceField;
use crate::measured::Row;
use crate::quantity::{CHANNELS, Contact};
use crate::zernike::{Jet, jets, norms};

/// Degree of the background's polynomials: features of some 10 mm.
pub(super) const BACKGROUND_DEGREE: usize = 5;
/// How many polynomials that are.
pub(super) const TERMS: usize = (BACKGROUND_DEGREE + 1) * (BACKGROUND_DEGREE + 2) / 2;

/// Half the way over which a second derivative is taken.
const BEND_MM: f64 = 0.5;

/// Per channel, what a unit force along each axis does.
pub(super) type Maps = [[f64; 3]; CHANNELS];

/// The simulator's field at a place.
#[derive(Clone, Debug)]
pub(super) struct Place {
    /// µV/N.
    pub(super) gains: Maps,
    /// µV/N per mm of x and of y.
    pub(super) along: [Maps; 2],
    /// The sum of their second derivatives by x and y, µV/N per mm².
    pub(super) bent: Maps,
    /// µV/N per unit of each number that has a sensitivity.
    pub(super) slopes: Vec<Maps>,
    /// The background's polynomials, each with a root mean square of 1 over the plate.
    pub(super) terms: [f64; TERMS],
}

/// One measured contact.
#[derive(Clone, Debug)]
pub(super) struct Measured {
    pub(super) place: Place,
    pub(super) force_n: [f64; 3],
    /// Beyond the zero.
    pub(super) uv: [f64; CHANNELS],
    /// Above the reference temperature; zero where it is not known.
    pub(super) above_c: f64,
    /// What friction made of the way here; it follows the numbers.
    pub(super) lags: Lags,
    /// How far the channels had crept.
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
        let share = place_mm.map(|mm| mm / plate_mm);
        let degree =
            sensitivities.iter().map(|it| degree_of(it.maps[0][0].coefficients.len())).max().unwrap_or(0);
        let jets = jets(degree.max(BACKGROUND_DEGREE), share);
        let slope =
            |it: &&Sensitivity| it.maps.each_ref().map(|axes| axes.each_ref().map(|map| map.value(&jets)));
        let gains = field.signals.gains(place_mm[0] as f32, place_mm[1] as f32);
        Self {
            gains: gains.value,
            along: [gains.dx, gains.dy],
            bent: bent(&field.signals, place_mm),
            slopes: sensitivities.iter().map(slope).collect(),
            terms: terms(&jets),
        }
    }
}

/// The Laplacian of the maps.
fn bent(signals: &InfluenceField, [x_mm, y_mm]: [f64; 2]) -> Maps {
    // The field is held at its rim: beyond it there is no curvature, so that is taken a little inwards.
    let share = (f64::from(signals.radius_mm()) - BEND_MM) / libm::hypot(x_mm, y_mm);
    let [x_mm, y_mm] = [x_mm, y_mm].map(|mm| share.min(1.0) * mm);
    let at = |x_mm: f64, y_mm: f64| signals.gains(x_mm as f32, y_mm as f32);
    let (right, left) = (at(x_mm + BEND_MM, y_mm), at(x_mm - BEND_MM, y_mm));
    let (above, below) = (at(x_mm, y_mm + BEND_MM), at(x_mm, y_mm - BEND_MM));
    std::array::from_fn(|channel| {
        std::array::from_fn(|axis| {
            let by_x = right.dx[channel][axis] - left.dx[channel][axis];
            let by_y = above.dy[channel][axis] - below.dy[channel][axis];
            (by_x + by_y) / (2.0 * BEND_MM)
        })
    })
}

/// The degree of a polynomial with so many coefficients.
fn degree_of(coefficients: usize) -> usize {
    (0..).find(|degree| (degree + 1) * (degree + 2) / 2 >= coefficients).unwrap_or(0)
}

fn terms(jets: &[Jet]) -> [f64; TERMS] {
    let norms = norms(BACKGROUND_DEGREE);
    std::array::from_fn(|term| jets[term].value * (std::f64::consts::PI / norms[term]).sqrt())
}

impl Measured {
    /// What is measured where nothing is.
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
