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
//! Each of the five fields is a polynomial over the disc (Ritz's method): w and the rotations of one degree, so that
//! thin plates do not lock. The edge is free by itself. Unknowns: five blocks of coefficients of [`crate::zernike`]
//! polynomials in the place divided by the plate's radius R: u, v, w, R α, R β, all in millimetres.
//! Source: R. D. Mindlin, J. Appl. Mech. 18 (1951) 31; E. Reissner, J. Appl. Mech. 12 (1945) A69 for κ.

use faer::{Mat, MatRef};

use crate::device::{Device, Material};
use crate::zernike::{count, jets};

use super::grams::{Grams, gauss_legendre};
use super::superelement::{FOOT_SHAPES, MODES, foot_shapes};

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
        let Material { e_mpa, nu } = material;
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
        Self {
            stretching: self.stretching / thickness_mm,
            bending: 3.0 * self.bending / thickness_mm,
            shear: self.shear / thickness_mm,
            nu: self.nu,
        }
    }

    /// The derivative by Young's modulus, per MPa.
    pub fn per_modulus(self, e_mpa: f64) -> Self {
        Self {
            stretching: self.stretching / e_mpa,
            bending: self.bending / e_mpa,
            shear: self.shear / e_mpa,
            nu: self.nu,
        }
    }
}

/// The plate's stiffness over all unknowns, N/mm. Six motions of it, the rigid ones, cost no energy.
pub fn stiffness(grams: &Grams, rigidity: Rigidity) -> Mat<f64> {
    let size = count(grams.degree);
    let mut matrix = Mat::zeros(FIELDS * size, FIELDS * size);
    add_plane_stress(grams, rigidity.stretching, rigidity.nu, 0, &mut matrix);
    add_plane_stress(grams, rigidity.bending, rigidity.nu, 3, &mut matrix);
    add_shear(grams, rigidity.shear, &mut matrix);
    matrix
}

/// Adds the energy of plane stress in the two fields from block `first` on.
fn add_plane_stress(grams: &Grams, factor: f64, nu: f64, first: usize, matrix: &mut Mat<f64>) {
    let size = count(grams.degree);
    let [[xx, xy], [yx, yy]] = &grams.gradients;
    let half = (1.0 - nu) / 2.0;
    let mut add = |[row, column]: [usize; 2], normal: &Mat<f64>, normal_factor: f64, sheared: &Mat<f64>| {
        for i in 0..size {
            for j in 0..size {
                matrix[((first + row) * size + i, (first + column) * size + j)] +=
                    factor * (normal_factor * normal[(i, j)] + half * sheared[(i, j)]);
            }
        }
    };
    add([0, 0], xx, 1.0, yy);
    add([0, 1], xy, nu, yx);
    add([1, 0], yx, nu, xy);
    add([1, 1], yy, 1.0, xx);
}

/// Adds the energy of shear across the thickness.
fn add_shear(grams: &Grams, factor: f64, matrix: &mut Mat<f64>) {
    let size = count(grams.degree);
    let (w, rotations) = (2 * size, [3 * size, 4 * size]);
    for i in 0..size {
        for j in 0..size {
            matrix[(w + i, w + j)] +=
                factor * (grams.gradients[0][0][(i, j)] + grams.gradients[1][1][(i, j)]);
            for (axis, rotation) in rotations.iter().enumerate() {
                matrix[(rotation + i, rotation + j)] += factor * grams.values[(i, j)];
                let coupled = factor * grams.slopes[axis][(i, j)];
                matrix[(rotation + i, w + j)] += coupled;
                matrix[(w + j, rotation + i)] += coupled;
            }
        }
    }
}

/// Where a module's foot meets the plate, in the pad frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// Its centre.
    pub centre_mm: [f64; 2],
    /// Where its edges point (along the module's x and y before any tilt): unit vectors in the pad's plane.
    pub edges: [[f64; 2]; 2],
    /// Half its sizes along these edges.
    pub half_mm: [f64; 2],
    /// The module's axes x, y, z in the pad frame, tilted with the module.
    pub axes: [[f64; 3]; 3],
}

impl Foot {
    /// The foot of a module of the device.
    pub fn of(device: &Device, module: usize) -> Self {
        let state = &device.modules[module];
        let angle = device.sites.angles_deg[module].to_radians();
        let (tangent, radius) = ([-angle.sin(), angle.cos()], [angle.cos(), angle.sin()]);
        let outwards = device.sites.centre_radius_mm + state.radial_mm;
        let centre_mm = [0, 1].map(|a| outwards * radius[a] + state.tangential_mm * tangent[a]);
        let edges = [tangent, radius].map(|edge| turned(edge, state.rotation_deg.to_radians()));
        let lifted = |[x, y]: [f64; 2]| [x, y, 0.0];
        let flat = [lifted(edges[0]), lifted(edges[1]), [0.0, 0.0, 1.0]];
        let about = |axis: usize, deg: f64| move |v: [f64; 3]| rotated(v, flat[axis], deg.to_radians());
        let axes = flat.map(about(1, state.tilt_radial_deg)).map(about(0, state.tilt_tangential_deg));
        let half_mm = [device.stack.post_length_x_mm / 2.0, device.stack.post_width_y_mm / 2.0];
        Self { centre_mm, edges, half_mm, axes }
    }

    /// The matrix from the plate's unknowns to the foot's modes (module axes): the underside's displacement over the
    /// foot, projected on the foot's polynomials.
    pub fn modes(&self, degree: usize, radius_mm: f64, thickness_mm: f64) -> Mat<f64> {
        // Enough for a parabola times whatever the plate does over so small a patch.
        const POINTS: usize = 8;
        let size = count(degree);
        let mut matrix = Mat::zeros(MODES, FIELDS * size);
        let rule = gauss_legendre(POINTS);
        for (s, s_weight) in &rule {
            for (t, t_weight) in &rule {
                let values = jets(degree, self.place([*s, *t]).map(|mm| mm / radius_mm));
                for (shape, value) in foot_shapes([*s, *t]).iter().enumerate() {
                    let [a, b] = FOOT_SHAPES[shape];
                    let weight = ((2 * a + 1) * (2 * b + 1)) as f64 / 4.0 * s_weight * t_weight * value;
                    for (k, jet) in values.iter().enumerate() {
                        self.add(
                            3 * shape,
                            k,
                            weight * jet.value,
                            thickness_mm / (2.0 * radius_mm),
                            &mut matrix,
                        );
                    }
                }
            }
        }
        matrix
    }

    fn add(&self, mode: usize, k: usize, value: f64, lever: f64, matrix: &mut Mat<f64>) {
        let size = matrix.ncols() / FIELDS;
        for (c, axis) in self.axes.iter().enumerate() {
            for (direction, share) in axis.iter().enumerate() {
                matrix[(mode + c, direction * size + k)] += share * value;
                if direction < 2 {
                    // The underside lies half the thickness below the middle plane.
                    matrix[(mode + c, (3 + direction) * size + k)] -= lever * share * value;
                }
            }
        }
    }

    fn place(&self, [s, t]: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|a| {
            self.centre_mm[a]
                + s * self.half_mm[0] * self.edges[0][a]
                + t * self.half_mm[1] * self.edges[1][a]
        })
    }
}

fn turned([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    [angle.cos() * x - angle.sin() * y, angle.sin() * x + angle.cos() * y]
}

/// Turns a vector about a unit axis, right-handed (Rodrigues).
fn rotated(v: [f64; 3], axis: [f64; 3], angle: f64) -> [f64; 3] {
    let along: f64 = (0..3).map(|a| v[a] * axis[a]).sum();
    let cross: [f64; 3] =
        std::array::from_fn(|a| axis[(a + 1) % 3] * v[(a + 2) % 3] - axis[(a + 2) % 3] * v[(a + 1) % 3]);
    std::array::from_fn(|a| {
        angle.cos() * v[a] + angle.sin() * cross[a] + (1.0 - angle.cos()) * along * axis[a]
    })
}

/// The work that unit forces on the plate's top do on a displacement of the plate: polynomials for forces along +x and
/// +y and for one pressing into the plate, by coefficients.
pub fn surface_work(field: MatRef<'_, f64>, radius_mm: f64, thickness_mm: f64) -> [Vec<f64>; 3] {
    let size = field.nrows() / FIELDS;
    let lever = thickness_mm / (2.0 * radius_mm);
    let along =
        |a: usize| (0..size).map(move |k| field[(a * size + k, 0)] + lever * field[((3 + a) * size + k, 0)]);
    [along(0).collect(), along(1).collect(), (0..size).map(|k| -field[(2 * size + k, 0)]).collect()]
}
