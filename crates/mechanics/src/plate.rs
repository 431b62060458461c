//! The plate: bending with shear, and stretching, of a free round plate of even thickness.
//!
//! Reissner and Mindlin's plate: with ζ the height above the middle plane, the displacement is
//! (u + ζ α, v + ζ β, w). Energy per area, with ν Poisson's ratio, G the shear modulus, h the thickness:
//!
//! ```text
//! stretching  ½ E h/(1−ν²)       (u,x² + v,y² + 2ν u,x v,y + (1−ν)/2 (u,y + v,x)²)
//! bending     ½ E h³/(12(1−ν²))  (the same in α and β)
//! shear       ½ κ G h            ((w,x + α)² + (w,y + β)²),   κ = 5/6
//! ```
//!
//! Each field is a polynomial over the disc (Ritz's method), w and the rotations of one degree, so that thin plates
//! do not lock. The edge is free by itself. The unknowns are coefficients of [`tactpad_numeric::zernike`] polynomials in the
//! place divided by the plate's radius R, in five blocks: u, v, w, R α, R β, all in millimetres.
//!
//! **Blocks.** The plate is round, so its stiffness couples only motions that turn alike. Write U = u + iv and
//! z = x + iy, and take as unknowns the real multiples c of U = R(n, l) exp(ilθ) and of i times that. Then
//!
//! ```text
//! u,x + v,y = 2 Re ∂U/∂z        (u,x − v,y) + i (u,y + v,x) = 2 ∂U/∂z*        w,x + i w,y = 2 ∂w/∂z*
//! ```
//!
//! and the rule for ∂/∂z in [`tactpad_numeric::zernike`] shows that orders l = 1 + J and l = 1 − J meet only each other and the
//! waves of order J in w, real multiples apart from imaginary ones. All integrals are closed sums.
//! Source: R. D. Mindlin, J. Appl. Mech. 18 (1951) 31; E. Reissner, J. Appl. Mech. 12 (1945) A69 for κ.

use std::f64::consts::PI;

use faer::linalg::solvers::{Llt, Solve};
use faer::{Mat, Side};

use tactpad_core::pad::device::Material;
use tactpad_numeric::zernike::{Wave, count, index, square_integrals};

use super::brick::TONNES_PER_MM3;
use super::system::SolveError;

/// Fields of the plate: u, v, w, R α, R β.
pub const FIELDS: usize = 5;

/// Factors of the plate's three energies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rigidity {
    /// E h/(1−ν²), N/mm.
    pub stretching: f64,
    /// E h³/(12(1−ν²)) divided by R², N/mm.
    pub bending: f64,
    /// κ G h, N/mm.
    pub shear: f64,
    /// Poisson's ratio.
    pub nu: f64,
}

impl Rigidity {
    /// Of a plate of the given material, thickness and radius.
    pub fn of(material: Material, thickness_mm: f64, radius_mm: f64) -> Self {
        let Material { e_mpa, nu, .. } = material;
        let stretching = e_mpa * thickness_mm / (1.0 - nu * nu);
        Self {
            stretching,
            bending: stretching * thickness_mm * thickness_mm / 12.0 / (radius_mm * radius_mm),
            shear: 5.0 / 6.0 * e_mpa / (2.0 * (1.0 + nu)) * thickness_mm,
            nu,
        }
    }

    /// The derivative by thickness, per mm.
    pub fn per_thickness(self, thickness_mm: f64) -> Self {
        let Self { stretching, bending, shear, nu } = self;
        let per_mm = |energy: f64| energy / thickness_mm;
        Self { stretching: per_mm(stretching), bending: 3.0 * per_mm(bending), shear: per_mm(shear), nu }
    }

    /// The derivative by Young's modulus, per MPa.
    pub fn per_modulus(self, e_mpa: f64) -> Self {
        let Self { stretching, bending, shear, nu } = self;
        Self { stretching: stretching / e_mpa, bending: bending / e_mpa, shear: shear / e_mpa, nu }
    }
}

/// Consistent mass of each unknown of a plate with fields up to `degree`, in tonnes: the polynomials are orthogonal over the
/// disc, so each meets only itself. Kinetic energy per area:
///
/// ```text
/// ½ ϱ h (u̇² + v̇² + ẇ²) + ½ ϱ h³/12 (α̇² + β̇²)
/// ```
///
/// With R α and R β for unknowns the second factor is divided by R²; the disc's area element is R² times that of the unit
/// disc, over which a polynomial's square has [`square_integrals`].
/// Source: R. D. Mindlin, J. Appl. Mech. 18 (1951) 31.
pub fn masses_t(degree: usize, material: Material, thickness_mm: f64, radius_mm: f64) -> Vec<f64> {
    let disc = TONNES_PER_MM3 * material.density_kg_m3 * thickness_mm * radius_mm * radius_mm;
    let turning = disc * thickness_mm * thickness_mm / (12.0 * radius_mm * radius_mm);
    let integrals: Vec<f64> = square_integrals(degree);
    (0..FIELDS)
        .flat_map(|field| {
            let factor = if field < 3 { disc } else { turning };
            integrals.iter().map(move |integral| factor * integral)
        })
        .collect()
}

/// Whether a block's unknowns are real or imaginary multiples of exp(ilθ).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// Mirror-symmetric about the x axis: w waves as the cosine.
    Real,
    /// Antisymmetric: w waves as the sine.
    Imaginary,
}

/// One unknown of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Unknown {
    /// Degree n.
    degree: usize,
    kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// A wave of the block's order in w.
    Deflection,
    /// A rotation (or, in the plate's plane, a displacement) of signed order l.
    Vector { order: isize },
}

/// Motions of the plate that meet only each other.
struct Block {
    turn: usize,
    phase: Phase,
    /// The first of the two fields that the vectors stand for: 0 for u and v, 3 for R α and R β.
    first_field: usize,
    unknowns: Vec<Unknown>,
}

impl Block {
    /// All blocks up to a degree.
    fn all(degree: usize) -> Vec<Self> {
        let turns =
            (0..=degree + 1).flat_map(|turn| [Phase::Real, Phase::Imaginary].map(|phase| (turn, phase)));
        let blocks = turns
            .flat_map(|(turn, phase)| [0, 3].map(|first_field| Self::new(degree, turn, phase, first_field)));
        blocks.filter(|block| !block.unknowns.is_empty()).collect()
    }

    fn new(degree: usize, turn: usize, phase: Phase, first_field: usize) -> Self {
        let degrees = |order: usize| (order..=degree).step_by(2);
        let mut unknowns = Vec::new();
        let waves = !(turn == 0 && phase == Phase::Imaginary);
        if first_field == 3 && waves {
            unknowns.extend(degrees(turn).map(|degree| Unknown { degree, kind: Kind::Deflection }));
        }
        let above = 1 + turn.cast_signed();
        let below = 1 - turn.cast_signed();
        let orders = if turn == 0 { vec![above] } else { vec![above, below] };
        for order in orders {
            let kind = Kind::Vector { order };
            unknowns.extend(degrees(order.unsigned_abs()).map(|degree| Unknown { degree, kind }));
        }
        Self { turn, phase, first_field, unknowns }
    }

    /// The sign with which a vector of order l meets the block's waves: that of Re or Im of exp(i(l−1)θ).
    fn sign(&self, order: isize) -> f64 {
        match self.phase {
            Phase::Real => 1.0,
            Phase::Imaginary if order > 1 => -1.0,
            Phase::Imaginary if order < 1 => 1.0,
            Phase::Imaginary => 0.0,
        }
    }

    /// Energy of a pair of unknowns: an entry of the stiffness.
    fn entry(&self, a: Unknown, b: Unknown, rigidity: Rigidity) -> f64 {
        // The plane energy is ½ D ((1+ν)/2 (u,x + v,y)² + (1−ν)/2 ((u,x − v,y)² + (u,y + v,x)²)), the first square `divergence`,
        // the others `distortion`; shear adds ½ κGh |2 ∂w/∂z* + U|² with U = α + iβ.
        let plane = if self.first_field == 0 { rigidity.stretching } else { rigidity.bending };
        let shear = if self.first_field == 0 { 0.0 } else { rigidity.shear };
        match (a.kind, b.kind) {
            (Kind::Deflection, Kind::Deflection) => shear * self.deflections(a.degree, b.degree),
            (Kind::Deflection, Kind::Vector { order }) => shear * self.mixed(a.degree, b.degree, order),
            (Kind::Vector { order }, Kind::Deflection) => shear * self.mixed(b.degree, a.degree, order),
            (Kind::Vector { order: l }, Kind::Vector { order: k }) => {
                let least = a.degree.min(b.degree);
                let even = (1.0 + rigidity.nu) / 2.0 * self.sign(l) * self.sign(k) * self.divergence(least);
                let odd = if l == k { (1.0 - rigidity.nu) / 2.0 * distortion(least, l) } else { 0.0 };
                let own = if l == k && a.degree == b.degree { PI / (a.degree + 1) as f64 } else { 0.0 };
                plane * (even + odd) + shear * own
            }
        }
    }

    /// ∫ of the product of two divergences, of which `least` is the smaller degree.
    fn divergence(&self, least: usize) -> f64 {
        let norm = if self.turn == 0 { PI } else { PI / 2.0 };
        4.0 * norm * weighted_sum(least, self.turn)
    }

    /// ∫ of the product of two slopes of w.
    fn deflections(&self, a: usize, b: usize) -> f64 {
        let (least, above, below) = (a.min(b), self.turn + 1, self.turn.abs_diff(1));
        if self.turn == 0 {
            return 4.0 * PI * weighted_sum(least, above);
        }
        PI * (weighted_sum(least, above) + weighted_sum(least, below))
    }

    /// ∫ of the slope of w, of degree `deflection`, times a rotation of signed order l.
    fn mixed(&self, deflection: usize, rotation: usize, order: isize) -> f64 {
        let doubled = if self.turn == 0 { 2.0 } else { 1.0 };
        if rotation < deflection { doubled * self.sign(order) * PI } else { 0.0 }
    }

    /// The coefficients of u, v, w, R α, R β that a unit of the unknown stands for: (index, factor).
    fn coefficients(&self, unknown: Unknown, size: usize) -> Vec<(usize, f64)> {
        let Unknown { degree, kind } = unknown;
        let at = |field: usize, order: usize, wave: Wave, factor: f64| {
            index(degree, order, wave).map(|k| (field * size + k, factor))
        };
        let entries = match (kind, self.phase) {
            (Kind::Deflection, Phase::Real) => [at(2, self.turn, Wave::Cos, 1.0), None],
            (Kind::Deflection, Phase::Imaginary) => [at(2, self.turn, Wave::Sin, 1.0), None],
            (Kind::Vector { order }, phase) => {
                let (l, side) = (order.unsigned_abs(), if order < 0 { -1.0 } else { 1.0 });
                let (u, v) = (self.first_field, self.first_field + 1);
                match phase {
                    Phase::Real => [at(u, l, Wave::Cos, 1.0), at(v, l, Wave::Sin, side)],
                    Phase::Imaginary => [at(u, l, Wave::Sin, -side), at(v, l, Wave::Cos, 1.0)],
                }
            }
        };
        entries.into_iter().flatten().collect()
    }

    fn stiffness(&self, rigidity: Rigidity) -> Mat<f64> {
        let size = self.unknowns.len();
        Mat::from_fn(size, size, |i, j| self.entry(self.unknowns[i], self.unknowns[j], rigidity))
    }
}

/// ∫ |2 ∂U/∂z*|² for a product of two vectors of signed order l, of which `least` is the smaller degree.
fn distortion(least: usize, order: isize) -> f64 {
    4.0 * PI * weighted_sum(least, (order + 1).unsigned_abs())
}

/// Σ (p + 1) over p = n−1, n−3, … down to `order`.
fn weighted_sum(degree: usize, order: usize) -> f64 {
    let terms = (0..degree).rev().step_by(2).take_while(|p| *p >= order);
    terms.map(|p| (p + 1) as f64).sum()
}

/// The stiffness of a plate, and its inverse once the six rigid motions are held.
pub struct Plate {
    size: usize,
    blocks: Vec<HeldBlock>,
}

struct HeldBlock {
    block: Block,
    /// For each unknown, the coefficients it stands for.
    coefficients: Vec<Vec<(usize, f64)>>,
    factor: Llt<f64>,
}

/// Motions whose fixing holds the plate: u, v and w of degree 0, both tilts of w, and the turn in the plane. Each is
/// a sum of (field, circle polynomial, factor) that meets the unknowns of one block only.
const HELD: [&[(usize, usize, f64)]; 6] = [
    &[(0, 0, 1.0)],
    &[(1, 0, 1.0)],
    &[(2, 0, 1.0)],
    &[(2, 1, 1.0)],
    &[(2, 2, 1.0)],
    &[(0, 1, -0.5), (1, 2, 0.5)],
];

/// The held motions as sums of unknowns (index, factor) of a plate with fields up to `degree`.
pub fn held(degree: usize) -> [Vec<(usize, f64)>; HELD.len()] {
    HELD.map(|sum| sum.iter().map(|(field, k, factor)| (field * count(degree) + k, *factor)).collect())
}

impl Plate {
    /// A plate of the given rigidity with fields up to `degree`, each held motion by a spring of `spring` N/mm.
    ///
    /// # Errors
    /// A rigidity that is not positive.
    pub fn of(degree: usize, rigidity: Rigidity, spring: f64) -> Result<Self, SolveError> {
        let size = count(degree);
        let held = |block: Block| {
            let coefficients: Vec<_> =
                block.unknowns.iter().map(|unknown| block.coefficients(*unknown, size)).collect();
            let mut matrix = block.stiffness(rigidity);
            add_springs(&coefficients, degree, spring, &mut matrix);
            let factor = matrix.llt(Side::Lower).map_err(|_| SolveError::NotPositive)?;
            Ok(HeldBlock { block, coefficients, factor })
        };
        let blocks = Block::all(degree).into_iter().map(held).collect::<Result<_, _>>()?;
        Ok(Self { size, blocks })
    }

    /// Number of unknowns: five times the number of polynomials.
    pub fn unknowns(&self) -> usize {
        FIELDS * self.size
    }

    /// Displacements of the held plate under loads, one column for each.
    pub fn solve(&self, loads: &Mat<f64>) -> Mat<f64> {
        let mut result = Mat::zeros(loads.nrows(), loads.ncols());
        for HeldBlock { coefficients, factor, .. } in &self.blocks {
            let mut right = gathered(coefficients, loads);
            factor.solve_in_place(&mut right);
            scatter(coefficients, &right, &mut result);
        }
        result
    }

    /// The free plate's stiffness, of another rigidity perhaps, times displacements (no springs).
    pub fn forces(&self, rigidity: Rigidity, displacements: &Mat<f64>) -> Mat<f64> {
        let mut result = Mat::zeros(displacements.nrows(), displacements.ncols());
        for HeldBlock { block, coefficients, .. } in &self.blocks {
            // The unknowns are orthogonal combinations: back to them takes the square of their length.
            let mut amplitudes = gathered(coefficients, displacements);
            for (i, entries) in coefficients.iter().enumerate() {
                for j in 0..amplitudes.ncols() {
                    amplitudes[(i, j)] /= entries.len() as f64;
                }
            }
            let mut forces = block.stiffness(rigidity) * amplitudes;
            for (i, entries) in coefficients.iter().enumerate() {
                for j in 0..forces.ncols() {
                    forces[(i, j)] /= entries.len() as f64;
                }
            }
            scatter(coefficients, &forces, &mut result);
        }
        result
    }
}

fn add_springs(coefficients: &[Vec<(usize, f64)>], degree: usize, spring: f64, matrix: &mut Mat<f64>) {
    for held in held(degree) {
        let share = |entries: &[(usize, f64)]| -> f64 {
            let pairs = entries.iter().flat_map(|(k, factor)| {
                held.iter().filter(move |(held, _)| held == k).map(move |(_, share)| factor * share)
            });
            pairs.sum()
        };
        for (i, a) in coefficients.iter().enumerate() {
            for (j, b) in coefficients.iter().enumerate() {
                matrix[(i, j)] += spring * share(a) * share(b);
            }
        }
    }
}

fn gathered(coefficients: &[Vec<(usize, f64)>], from: &Mat<f64>) -> Mat<f64> {
    Mat::from_fn(coefficients.len(), from.ncols(), |i, j| {
        coefficients[i].iter().map(|(k, factor)| factor * from[(*k, j)]).sum()
    })
}

fn scatter(coefficients: &[Vec<(usize, f64)>], from: &Mat<f64>, to: &mut Mat<f64>) {
    for (i, entries) in coefficients.iter().enumerate() {
        for (k, factor) in entries {
            for j in 0..from.ncols() {
                to[(*k, j)] += factor * from[(i, j)];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use tactpad_numeric::zernike::{Polynomial, jets};

    const DEGREE: usize = 40;
    const STEEL: Material = Material { e_mpa: 200_000.0, nu: 0.3, density_kg_m3: 7_850.0 };
    const RADIUS_MM: f64 = 30.0;
    /// So thin that shear does not count.
    const THIN_MM: f64 = 0.2;

    fn thin() -> Plate {
        Plate::of(DEGREE, Rigidity::of(STEEL, THIN_MM, RADIUS_MM), 100.0).unwrap()
    }

    fn bending_stiffness(thickness_mm: f64) -> f64 {
        STEEL.e_mpa * thickness_mm.powi(3) / (12.0 * (1.0 - STEEL.nu * STEEL.nu))
    }

    /// Loads along z: the work of a point force of the given size at each place (in plate radii).
    fn forces(points: &[([f64; 2], f64)]) -> Mat<f64> {
        let size = count(DEGREE);
        let mut load = Mat::zeros(FIELDS * size, 1);
        for (place, newtons) in points {
            for (k, jet) in jets(DEGREE, *place).iter().enumerate() {
                load[(2 * size + k, 0)] += newtons * jet.value;
            }
        }
        load
    }

    fn deflection(field: &Mat<f64>, place: [f64; 2]) -> f64 {
        let size = count(DEGREE);
        let coefficients = (0..size).map(|k| field[(2 * size + k, 0)]).collect();
        Polynomial { coefficients }.value(&jets(DEGREE, place))
    }

    fn supports() -> [[f64; 2]; 3] {
        [0.0, 1.0, 2.0].map(|k| {
            let (sin, cos) = (k * TAU / 3.0).sin_cos();
            [cos, sin]
        })
    }

    /// Deflection of the centre under a central force P on three point supports at the rim, in P a²/D.
    ///
    /// The simply supported plate's (3+ν)/(16π(1+ν)), and what the rim's waves of order m = 3, 6, … add: of the support
    /// forces' Fourier series, each wave of edge force P/(π a) cos mθ lifts the supports by (A + B) cos mθ, where
    /// w = (A rᵐ + B rᵐ⁺²) cos mθ has no edge moment. Source: S. Timoshenko, S. Woinowsky-Krieger, Theory of Plates and
    /// Shells, chapter 9 (figures for ν = 0.3: 0.0670 here, with a load on the whole plate 0.0362 q a⁴/D).
    fn three_supports(nu: f64) -> f64 {
        let waves = (1..4000).map(|k| {
            let m = f64::from(3 * k);
            let ratio = -m * (m - 1.0) * (1.0 - nu) / ((m + 1.0) * (m + 2.0 + nu * (2.0 - m)));
            let (a, b) = (1.0, ratio);
            let edge_force = 4.0 * m * (m + 1.0) * b - (1.0 - nu) * m * m * (a * (m - 1.0) + b * (m + 1.0));
            (a + b) / edge_force.abs() / PI
        });
        (3.0 + nu) / (16.0 * PI * (1.0 + nu)) + waves.map(f64::abs).sum::<f64>()
    }

    #[test]
    fn a_plate_on_three_supports_sags_as_in_the_books() {
        let known = three_supports(STEEL.nu);
        // The book rounds its series early.
        assert!((known - 0.0670).abs() < 0.0005, "{known}");
        let thirds = supports().map(|place| (place, 1.0 / 3.0));
        let loads = [([0.0; 2], -1.0), thirds[0], thirds[1], thirds[2]];
        let field = thin().solve(&forces(&loads));
        let sag = supports().map(|place| deflection(&field, place) - deflection(&field, [0.0; 2]));
        for sag in sag {
            let found = sag * bending_stiffness(THIN_MM) / (RADIUS_MM * RADIUS_MM);
            assert!((found / known - 1.0).abs() < 0.005, "{found} for {known}");
        }
    }

    #[test]
    fn an_edge_moment_bends_the_plate_to_a_sphere() {
        // M all along the rim: w = −M r²/(2 D (1+ν)), R α = M R² r/(D (1+ν)); work of the moment on R α is M ∮ α_r.
        let size = count(DEGREE);
        let mut load = Mat::zeros(FIELDS * size, 1);
        const STEPS: usize = 400;
        for step in 0..STEPS {
            let (sin, cos) = (step as f64 / STEPS as f64 * TAU).sin_cos();
            for (k, jet) in jets(DEGREE, [cos, sin]).iter().enumerate() {
                // Per millimetre of rim a moment of 1 N; R α works with it once divided by R.
                let share = TAU / STEPS as f64 * jet.value;
                load[(3 * size + k, 0)] += share * cos;
                load[(4 * size + k, 0)] += share * sin;
            }
        }
        let field = thin().solve(&load);
        let sag = deflection(&field, [0.0; 2]) - deflection(&field, [0.6, 0.0]);
        let known = (0.6 * RADIUS_MM).powi(2) / (2.0 * bending_stiffness(THIN_MM) * (1.0 + STEEL.nu));
        assert!((sag / known - 1.0).abs() < 1e-6, "{sag} for {known}");
    }

    #[test]
    fn rigid_motions_cost_nothing() {
        let plate = thin();
        let size = count(DEGREE);
        let mut motions = Mat::zeros(FIELDS * size, 6);
        (0..3).for_each(|field| motions[(field * size, field)] = 1.0);
        // Tilts: w = x, R α = −R·(1/R)·…: in the place divided by R, w = x goes with R α = −1.
        for (column, (wave, rotation)) in [(2, 3), (1, 4)].into_iter().enumerate() {
            motions[(2 * size + wave, 3 + column)] = 1.0;
            motions[(rotation * size, 3 + column)] = -1.0;
        }
        (motions[(1, 5)], motions[(size + 2, 5)]) = (-1.0, 1.0);
        let rigidity = Rigidity::of(STEEL, THIN_MM, RADIUS_MM);
        let forces = plate.forces(rigidity, &motions);
        assert!(forces.norm_max() < 1e-12 * rigidity.stretching, "{}", forces.norm_max());
    }

    #[test]
    fn even_tension_stretches_by_hookes_law() {
        // u = x, v = y (strain 1/R each): energy ½ E h/(1−ν) · 2 · area/R².
        let plate = thin();
        let size = count(DEGREE);
        let mut stretched = Mat::zeros(FIELDS * size, 1);
        (stretched[(2, 0)], stretched[(size + 1, 0)]) = (1.0, 1.0);
        let forces = plate.forces(Rigidity::of(STEEL, THIN_MM, RADIUS_MM), &stretched);
        let work = (stretched.transpose() * forces)[(0, 0)];
        let known = 2.0 * PI * STEEL.e_mpa * THIN_MM / (1.0 - STEEL.nu);
        assert!((work / known - 1.0).abs() < 1e-12, "{work} for {known}");
    }

    #[test]
    fn a_thick_plate_shears_as_reissner_says() {
        // Simply supported rim, force on the whole plate: shear adds q a²/(4 κ G h) to the sag of the thin plate
        // q a⁴ (5+ν)/(64 D (1+ν)). The rim's shear force is spread evenly, as the reaction of a free plate.
        let thickness_mm = 6.0;
        let rigidity = Rigidity::of(STEEL, thickness_mm, RADIUS_MM);
        let plate = Plate::of(DEGREE, rigidity, 100.0).unwrap();
        let size = count(DEGREE);
        let mut load = Mat::zeros(FIELDS * size, 1);
        // 1 N/mm² down on R² times the unit disc; only the constant polynomial has an integral.
        load[(2 * size, 0)] = -PI * RADIUS_MM * RADIUS_MM;
        const STEPS: usize = 400;
        for step in 0..STEPS {
            let (sin, cos) = (step as f64 / STEPS as f64 * TAU).sin_cos();
            for (k, jet) in jets(DEGREE, [cos, sin]).iter().enumerate() {
                load[(2 * size + k, 0)] += PI * RADIUS_MM * RADIUS_MM / STEPS as f64 * jet.value;
            }
        }
        let field = plate.solve(&load);
        let sag = deflection(&field, [1.0, 0.0]) - deflection(&field, [0.0; 2]);
        let (a, nu) = (RADIUS_MM, STEEL.nu);
        let bent = a.powi(4) * (5.0 + nu) / (64.0 * bending_stiffness(thickness_mm) * (1.0 + nu));
        let sheared = a * a / (4.0 * rigidity.shear);
        assert!((sag / (bent + sheared) - 1.0).abs() < 1e-9, "{sag} for {bent} + {sheared}");
    }
}
