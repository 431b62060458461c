//! Natural frequencies and shapes: K a = ω² M a of the whole pad.
//!
//! **Mass.** M = Mp + Σ QᵢᵀMᵢQᵢ as the stiffness is assembled: Mp is the plate's in its own polynomials
//! ([`masses_t`]), Mᵢ a module's for the movements of its foot ([`Solution::mass`](super::superelement::Solution::mass)). Both are consistent: the kinetic
//! energy of the same displacements whose strain energy makes K.
//!
//! **Solution.** The plate has thousands of unknowns and the wanted motions are the slowest dozen. So a space of vectors is
//! turned towards them: X ← K⁻¹ M X, and within it the dense problem (XᵀKX) q = ω² (XᵀMX) q is solved. Its lowest
//! frequencies fall towards the pad's, each step by the ratio of a wanted ω² to the first one outside the space.
//! Source: K.-J. Bathe, E. L. Wilson, Large eigenvalue problems in dynamic analysis, J. Eng. Mech. Div. ASCE 98
//! (1972) 1471; the theory in L. Rayleigh, The Theory of Sound (1877), and W. Ritz (1909).

use std::f64::consts::TAU;
use std::sync::Arc;

use faer::{Mat, Side};

use super::pad::Pad;
use super::plate::{FIELDS, masses_t};
use super::superelement::{FootMass, MODES};
use super::system::SolveError;
use tactpad_core::quantity::{CHANNELS, MODULES};
use tactpad_numeric::zernike::{Polynomial, count, jets};

/// The space begins with all motions of the plate up to this degree: rigid ones, and its slowest ways to bend and stretch.
const START_DEGREE: usize = 4;

/// Frequencies that move less than this share of themselves in a step have settled.
const SETTLED: f64 = 1e-9;

/// A space of five times the wanted size settles in ten steps.
const STEPS_MAX: usize = 100;

/// Natural motions that are looked for.
pub const LOOKED_FOR: usize = 12;

/// Rigid motions of the plate: along x, y, z; turns about x, y, z.
pub const RIGID: usize = 6;

/// The slowest natural motions of a body.
pub struct NaturalModes {
    /// ω of each, rad/s, ascending.
    pub angular_per_s: Vec<f64>,
    /// Their shapes a, one column for each, with aᵀMa = 1 (t mm²).
    pub shapes: Mat<f64>,
}

impl NaturalModes {
    /// The slowest `wanted` motions of a body, from a space of `start` (linearly independent columns, more than are
    /// wanted). `solve` is K⁻¹ times loads, `mass` M times displacements.
    ///
    /// # Errors
    /// What `solve` says; a mass or stiffness that is not positive; frequencies that do not settle.
    pub fn slowest(
        wanted: usize,
        start: Mat<f64>,
        solve: impl Fn(&Mat<f64>) -> Result<Mat<f64>, SolveError>,
        mass: impl Fn(&Mat<f64>) -> Mat<f64>,
    ) -> Result<Self, SolveError> {
        let mut space = start;
        let mut before = vec![f64::INFINITY; wanted];
        for _ in 0..STEPS_MAX {
            let loads = mass(&space);
            let moved = solve(&loads)?;
            let (squares, within) = dense(moved.transpose() * &loads, moved.transpose() * mass(&moved))?;
            space = moved * within;
            let angular_per_s: Vec<f64> = squares.iter().take(wanted).map(|square| square.sqrt()).collect();
            let is_still = |(now, before): (&f64, &f64)| (now - before).abs() < SETTLED * now;
            if angular_per_s.iter().zip(&before).all(is_still) {
                let shapes = space.subcols(0, angular_per_s.len()).to_owned();
                return Ok(Self { angular_per_s, shapes });
            }
            before = angular_per_s;
        }
        Err(SolveError::NotSettled)
    }

    /// The frequencies, Hz.
    pub fn frequencies_hz(&self) -> impl Iterator<Item = f64> {
        self.angular_per_s.iter().map(|angular| angular / TAU)
    }
}

/// ω², ascending, and q of K q = ω² M q, with qᵀMq = 1.
///
/// With K = LLᵀ and q = L⁻ᵀp that is (L⁻¹ M L⁻ᵀ) p = p/ω²: the slowest motions are the largest numbers of a symmetric
/// matrix, which rounding hurts least.
fn dense(stiffness: Mat<f64>, mass: Mat<f64>) -> Result<(Vec<f64>, Mat<f64>), SolveError> {
    let factor = stiffness.llt(Side::Lower).map_err(|_| SolveError::NotPositive)?;
    let lower = factor.L().to_owned();
    let mut half = mass;
    lower.solve_lower_triangular_in_place(&mut half);
    let mut whole = half.transpose().to_owned();
    lower.solve_lower_triangular_in_place(&mut whole);
    let found = whole.self_adjoint_eigen(Side::Lower).map_err(|_| SolveError::NotPositive)?;
    let (values, size) = (found.S().column_vector(), whole.nrows());
    let mut within = Mat::from_fn(size, size, |i, j| {
        // Of p with pᵀp = 1, qᵀMq is 1/ω².
        found.U()[(i, size - 1 - j)] / values[size - 1 - j].sqrt()
    });
    lower.transpose().solve_upper_triangular_in_place(&mut within);
    let squares: Vec<f64> = (0..size).map(|j| 1.0 / values[size - 1 - j]).collect();
    // Beyond the wanted ones, rounding may leave a mass of nothing; those columns would spoil the space.
    let usable = squares.iter().take_while(|square| square.is_finite() && **square > 0.0).count();
    if usable == 0 {
        Err(SolveError::NotPositive)
    } else {
        Ok((squares, within.subcols(0, usable).to_owned()))
    }
}

/// How the plate moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlateMotion {
    /// Along itself.
    Slides,
    /// Up and down.
    Bounces,
    /// About an axis in its plane.
    Tilts,
    /// About its own axis.
    Twists,
    /// None of these: it bends.
    Bends,
}

impl PlateMotion {
    /// A word for it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Slides => "slides",
            Self::Bounces => "bounces",
            Self::Tilts => "tilts",
            Self::Twists => "twists",
            Self::Bends => "bends",
        }
    }
}

/// One natural motion of a pad.
#[derive(Clone, Debug, PartialEq)]
pub struct NaturalMotion {
    /// Its frequency.
    pub frequency_hz: f64,
    /// Shares of the pad's moving mass (for turns: of its moment of inertia about the middle of the plate) that go with it, for
    /// each of the six rigid motions of the plate; over all motions they add up to 1.
    pub rigid_shares: [f64; RIGID],
    /// u, v, w, R α, R β of the plate in millimetres, polynomials in the place divided by the plate's radius; the kinetic energy at 1 rad/s
    /// is ½ t mm².
    pub shape: [Polynomial; FIELDS],
    /// What the channels read while the plate has that shape, µV.
    pub signals_uv: [f64; CHANNELS],
}

impl NaturalMotion {
    /// What it is, by the rigid motion that has more than half of its mass in it.
    pub fn kind(&self) -> PlateMotion {
        let [x, y, z, about_x, about_y, about_z] = self.rigid_shares;
        let kinds = [
            (PlateMotion::Slides, x + y),
            (PlateMotion::Bounces, z),
            (PlateMotion::Tilts, about_x + about_y),
            (PlateMotion::Twists, about_z),
        ];
        kinds.into_iter().find(|(_, share)| *share > 0.5).map_or(PlateMotion::Bends, |(kind, _)| kind)
    }

    /// Displacement of the plate's middle plane along z at a place in plate radii, mm.
    pub fn height_mm(&self, place: [f64; 2]) -> f64 {
        let size = self.shape[2].coefficients.len();
        // count(n) = (n + 1)(n + 2)/2 polynomials.
        let degree = (0..).find(|degree| count(*degree) >= size).unwrap_or(0);
        self.shape[2].value(&jets(degree, place))
    }

    /// Its part in what the channels read at rest under 1 N that presses at a place (in plate radii), µV/N: s (aᵀf)/ω².
    pub fn still_uv_per_n(&self, place: [f64; 2]) -> [f64; CHANNELS] {
        let work = -self.height_mm(place);
        let angular = TAU * self.frequency_hz;
        self.signals_uv.map(|uv| uv * work / (angular * angular))
    }
}

/// The slowest natural motions of a pad whose modules have these masses, from the slowest on.
///
/// # Errors
/// As for [`NaturalModes::slowest`].
pub fn natural_motions(
    pad: &Pad,
    masses: &[Arc<FootMass>; MODULES],
) -> Result<Vec<NaturalMotion>, SolveError> {
    let mass = Mass::of(pad, masses);
    let start = start(pad.assembly.plate.unknowns());
    let natural = NaturalModes::slowest(
        LOOKED_FOR,
        start,
        |loads| Ok(pad.assembly.solve(loads)),
        |moved| mass.times(moved),
    )?;
    let size = pad.assembly.plate.unknowns() / FIELDS;
    let rigid = rigid_motions(pad.assembly.plate.unknowns());
    let loads = mass.times(&rigid);
    let signals = pad.signals_of(&natural.shapes);
    let motions = natural.frequencies_hz().enumerate().map(|(column, frequency_hz)| {
        let shape = natural.shapes.col(column);
        NaturalMotion {
            frequency_hz,
            rigid_shares: std::array::from_fn(|motion| {
                // Γ²/(rᵀMr) with Γ = aᵀMr.
                let part = shape.transpose() * loads.col(motion);
                part * part / (rigid.col(motion).transpose() * loads.col(motion))
            }),
            shape: std::array::from_fn(|field| Polynomial {
                coefficients: (0..size).map(|k| shape[field * size + k]).collect(),
            }),
            signals_uv: std::array::from_fn(|channel| signals[(channel, column)]),
        }
    });
    Ok(motions.collect())
}

/// The pad's mass.
struct Mass<'p> {
    pad: &'p Pad,
    plate_t: Vec<f64>,
    feet_t: Mat<f64>,
}

impl<'p> Mass<'p> {
    fn of(pad: &'p Pad, masses: &[Arc<FootMass>; MODULES]) -> Self {
        let device = &pad.device;
        let plate_t = masses_t(
            pad.degree(),
            device.material.plate,
            device.plate.thickness_mm,
            device.plate.radius_mm(),
        );
        let rows = pad.assembly.couplings.nrows();
        let feet_t = Mat::from_fn(rows, rows, |i, j| match masses.get(i / MODES) {
            Some(mass) if i / MODES == j / MODES => mass[i % MODES][j % MODES],
            _ => 0.0,
        });
        Self { pad, plate_t, feet_t }
    }

    /// M times displacements, one column for each.
    fn times(&self, moved: &Mat<f64>) -> Mat<f64> {
        let couplings = &self.pad.assembly.couplings;
        let mut forces = couplings.transpose() * (&self.feet_t * (couplings * moved));
        for (i, mass) in self.plate_t.iter().enumerate() {
            for j in 0..moved.ncols() {
                forces[(i, j)] += mass * moved[(i, j)];
            }
        }
        forces
    }
}

/// All motions of a plate of so many unknowns up to [`START_DEGREE`].
fn start(unknowns: usize) -> Mat<f64> {
    let (size, few) = (unknowns / FIELDS, count(START_DEGREE).min(unknowns / FIELDS));
    Mat::from_fn(unknowns, FIELDS * few, |i, j| {
        let (field, k) = (j / few, j % few);
        f64::from(u8::from(i == field * size + k))
    })
}

/// The rigid motions of a plate of so many unknowns, in the order of [`RIGID`].
fn rigid_motions(unknowns: usize) -> Mat<f64> {
    let size = unknowns / FIELDS;
    let at = |field: usize, k: usize| field * size + k;
    // The polynomials are 1, y, x, …. A turn about x by 1/R lifts w = y and turns β by −1/R, so R β = −1.
    let sums: [&[(usize, f64)]; RIGID] = [
        &[(at(0, 0), 1.0)],
        &[(at(1, 0), 1.0)],
        &[(at(2, 0), 1.0)],
        &[(at(2, 1), 1.0), (at(4, 0), -1.0)],
        &[(at(2, 2), -1.0), (at(3, 0), 1.0)],
        &[(at(0, 1), -1.0), (at(1, 2), 1.0)],
    ];
    Mat::from_fn(unknowns, RIGID, |i, j| {
        sums[j].iter().filter(|(k, _)| *k == i).map(|(_, factor)| factor).sum()
    })
}
