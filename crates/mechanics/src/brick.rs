//! The 20-node brick: shape functions and the stiffness of a rectangular box, by reduced integration.
//!
//! Nodes in the usual order: corners of the lower face counter-clockwise from (−1, −1, −1), corners of the upper face,
//! then the middles of the lower edges, of the upper edges and of the uprights. The shape functions are the
//! quadratic serendipity family (O. C. Zienkiewicz, R. L. Taylor, The Finite Element Method, vol. 1, chapter 8):
//! (1+ξξᵢ)(1+ηηᵢ)(1+ζζᵢ)(ξξᵢ+ηηᵢ+ζζᵢ−2)/8 at corners, (1−ξ²)(1+ηηᵢ)(1+ζζᵢ)/4 at the middle of an edge along ξ.
//!
//! The energy is summed at 2 × 2 × 2 Gauss points. That is exact where the displacement is any quadratic polynomial, so
//! the order of convergence is that of the exact integral; the few higher terms, which make an exactly integrated brick
//! too stiff in bending and beside a singular edge, cost less. Six motions of a single brick besides the rigid ones
//! cost nothing at all; a brick's neighbours and the base hold it. Source: O. C. Zienkiewicz, R. L. Taylor, J. M. Too,
//! Reduced integration technique in general analysis of plates and shells, Int. J. Numer. Meth. Engng 3 (1971) 275.

use std::sync::OnceLock;

use tactpad_core::pad::device::Material;

/// Nodes of a brick.
pub const NODES: usize = 20;

/// Displacements of a brick: three for each node.
pub const DOFS: usize = 3 * NODES;

/// The nodes' places on the reference cube [−1, 1]³.
pub const CORNERS: [[i8; 3]; NODES] = [
    [-1, -1, -1],
    [1, -1, -1],
    [1, 1, -1],
    [-1, 1, -1],
    [-1, -1, 1],
    [1, -1, 1],
    [1, 1, 1],
    [-1, 1, 1],
    [0, -1, -1],
    [1, 0, -1],
    [0, 1, -1],
    [-1, 0, -1],
    [0, -1, 1],
    [1, 0, 1],
    [0, 1, 1],
    [-1, 0, 1],
    [-1, -1, 0],
    [1, -1, 0],
    [1, 1, 0],
    [-1, 1, 0],
];

/// A symmetric matrix over a brick's displacements, node by node, x y z within a node.
pub type Stiffness = [[f64; DOFS]; DOFS];

/// ∫ ∂ₐNᵢ ∂ᵦNⱼ over the reference cube by the reduced rule, as `[a][b][i][j]`.
type Gradients = [[[[f64; NODES]; NODES]; 3]; 3];

/// A kg/m³ in t/mm³: with N, mm and s, masses are in tonnes.
pub const TONNES_PER_MM3: f64 = 1e-12;

/// Lamé's constants λ and μ of a material.
pub fn lame_mpa(material: Material) -> (f64, f64) {
    let Material { e_mpa, nu, .. } = material;
    (e_mpa * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), e_mpa / (2.0 * (1.0 + nu)))
}

/// Values of the 20 shape functions at a place of the reference cube.
pub fn shapes(place: [f64; 3]) -> [f64; NODES] {
    CORNERS.map(|node| {
        let factors: [f64; 3] = std::array::from_fn(|a| edge_factor(node[a], place[a]));
        let product: f64 = factors.iter().product();
        if node.contains(&0) {
            product / 4.0
        } else {
            let sum: f64 = (0..3).map(|a| f64::from(node[a]) * place[a]).sum();
            product * (sum - 2.0) / 8.0
        }
    })
}

/// Derivatives of the 20 shape functions along the three axes of the reference cube, as `[axis][node]`.
pub fn slopes(place: [f64; 3]) -> [[f64; NODES]; 3] {
    std::array::from_fn(|axis| CORNERS.map(|node| slope(node, place, axis)))
}

/// The factor of one axis in a shape function: 1 + ξξᵢ, or 1 − ξ² along the node's own edge.
fn edge_factor(node: i8, place: f64) -> f64 {
    if node == 0 { 1.0 - place * place } else { 1.0 + f64::from(node) * place }
}

fn slope(node: [i8; 3], place: [f64; 3], axis: usize) -> f64 {
    let across: f64 = (0..3).filter(|a| *a != axis).map(|a| edge_factor(node[a], place[a])).product();
    // Middle of an edge along ξ: −2ξ (1+ηηᵢ)(1+ζζᵢ)/4. Middle of another edge: ξᵢ/4 times the other two factors.
    let along = f64::from(node[axis]);
    if node.contains(&0) {
        return if node[axis] == 0 { -2.0 * place[axis] } else { along } * across / 4.0;
    }
    // Corner: ξᵢ (1+ηηᵢ)(1+ζζᵢ)(2ξξᵢ+ηηᵢ+ζζᵢ−1)/8.
    let sum: f64 = (0..3).map(|a| f64::from(node[a]) * place[a]).sum();
    along * across * (sum - 2.0 + edge_factor(node[axis], place[axis])) / 8.0
}

/// ∫ Nᵢ Nⱼ, node by node; the same along each axis.
pub type Mass = [[f64; NODES]; NODES];

/// Gauss's three places on [−1, 1] with their weights: exact up to the fifth power, where products of shape functions have
/// the fourth.
const GAUSS_OF_MASS: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// ∫ Nᵢ Nⱼ over the reference cube.
fn products() -> &'static Mass {
    static PRODUCTS: OnceLock<Box<Mass>> = OnceLock::new();
    PRODUCTS.get_or_init(|| {
        let mut sums = Box::new([[0.0; NODES]; NODES]);
        for (x, x_weight) in GAUSS_OF_MASS {
            for (y, y_weight) in GAUSS_OF_MASS {
                for (z, z_weight) in GAUSS_OF_MASS {
                    let (shapes, weight) = (shapes([x, y, z]), x_weight * y_weight * z_weight);
                    for (row, shape) in sums.iter_mut().zip(shapes) {
                        row.iter_mut().zip(shapes).for_each(|(sum, other)| *sum += weight * shape * other);
                    }
                }
            }
        }
        sums
    })
}

/// Consistent mass of a box, in tonnes (N for mm/s²): m(ia, jb) = δₐᵦ ϱ ∫ Nᵢ Nⱼ, the integral exact.
///
/// Source: J. S. Archer, Consistent mass matrix for distributed mass systems, J. Struct. Div. ASCE 89 (1963) 161.
pub fn box_mass_t(size_mm: [f64; 3], density_kg_m3: f64) -> Box<Mass> {
    // dV = V/8 dξ dη dζ.
    let scale = TONNES_PER_MM3 * density_kg_m3 * size_mm.iter().product::<f64>() / 8.0;
    let mut mass = Box::new(*products());
    mass.iter_mut().flatten().for_each(|entry| *entry *= scale);
    mass
}

/// Gauss's two places on [−1, 1], ±1/√3, both of weight 1: exact up to the third power.
const GAUSS: [f64; 2] = [-0.577_350_269_189_625_8, 0.577_350_269_189_625_8];

fn gradients() -> &'static Gradients {
    static GRADIENTS: OnceLock<Box<Gradients>> = OnceLock::new();
    GRADIENTS.get_or_init(|| {
        let mut sums = Box::new([[[[0.0; NODES]; NODES]; 3]; 3]);
        for x in GAUSS {
            for y in GAUSS {
                for z in GAUSS {
                    add_products(&slopes([x, y, z]), &mut sums);
                }
            }
        }
        sums
    })
}

fn add_products(slopes: &[[f64; NODES]; 3], sums: &mut Gradients) {
    for (a, along) in slopes.iter().enumerate() {
        for (b, across) in slopes.iter().enumerate() {
            for (i, slope) in along.iter().enumerate() {
                for (j, other) in across.iter().enumerate() {
                    sums[a][b][i][j] += slope * other;
                }
            }
        }
    }
}

/// The weights of ∫ ∂ₐNᵢ ∂ᵦNⱼ of the reference cube in a box of the given size (mm): `[a][b]`.
fn box_weights(size_mm: [f64; 3]) -> [[f64; 3]; 3] {
    // dV = V/8 dξ dη dζ and ∂/∂x = 2/hₓ ∂/∂ξ, hence (V/8)(2/hₐ)(2/hᵦ).
    let volume: f64 = size_mm.iter().product();
    std::array::from_fn(|a| std::array::from_fn(|b| volume / (2.0 * size_mm[a] * size_mm[b])))
}

/// How [`box_weights`] change per millimetre of height.
fn box_weights_per_height(size_mm: [f64; 3]) -> [[f64; 3]; 3] {
    // A weight is proportional to h_z to the power p = 1 − δ(a, z) − δ(b, z): ∂/∂h_z = p weight/h_z.
    let weights = box_weights(size_mm);
    let vertical = |axis: usize| f64::from(u8::from(axis == 2));
    let power = |a: usize, b: usize| 1.0 - vertical(a) - vertical(b);
    std::array::from_fn(|a| std::array::from_fn(|b| weights[a][b] * power(a, b) / size_mm[2]))
}

/// Stiffness of a box with edges along the axes, in N/mm.
///
/// K(ia, jb) = λ ∫∂ₐNᵢ ∂ᵦNⱼ + μ ∫∂ᵦNᵢ ∂ₐNⱼ + μ δₐᵦ Σ ∫∂꜀Nᵢ ∂꜀Nⱼ, the integrals by the reduced rule.
pub fn box_stiffness(size_mm: [f64; 3], material: Material) -> Box<Stiffness> {
    weighted_stiffness(&box_weights(size_mm), material)
}

/// The derivative of [`box_stiffness`] with respect to the box's height, in N/mm².
pub fn box_stiffness_per_height(size_mm: [f64; 3], material: Material) -> Box<Stiffness> {
    weighted_stiffness(&box_weights_per_height(size_mm), material)
}

fn weighted_stiffness(weights: &[[f64; 3]; 3], material: Material) -> Box<Stiffness> {
    let (lambda, mu) = lame_mpa(material);
    let gradients = gradients();
    let mut stiffness = Box::new([[0.0; DOFS]; DOFS]);
    for i in 0..NODES {
        for j in 0..NODES {
            let gradient = |a: usize, b: usize| weights[a][b] * gradients[a][b][i][j];
            let laplace: f64 = (0..3).map(|c| gradient(c, c)).sum();
            for a in 0..3 {
                for b in 0..3 {
                    let same = if a == b { mu * laplace } else { 0.0 };
                    stiffness[3 * i + a][3 * j + b] = lambda * gradient(a, b) + mu * gradient(b, a) + same;
                }
            }
        }
    }
    stiffness
}

/// Forces on the nodes for displacements of the nodes, N for mm.
pub fn forces(stiffness: &Stiffness, displacement: &[f64; DOFS]) -> [f64; DOFS] {
    stiffness.each_ref().map(|row| row.iter().zip(displacement).map(|(k, u)| k * u).sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEEL: Material = Material { e_mpa: 200_000.0, nu: 0.3, density_kg_m3: 7_850.0 };
    const SIZE: [f64; 3] = [2.0, 3.0, 0.5];

    fn place(node: usize) -> [f64; 3] {
        std::array::from_fn(|a| f64::from(CORNERS[node][a]) * SIZE[a] / 2.0)
    }

    /// Forces that the box answers with to a displacement given node by node.
    fn answer(displacement: impl Fn([f64; 3]) -> [f64; 3]) -> [f64; DOFS] {
        let nodes: [[f64; 3]; NODES] = std::array::from_fn(|node| displacement(place(node)));
        forces(&box_stiffness(SIZE, STEEL), &std::array::from_fn(|dof| nodes[dof / 3][dof % 3]))
    }

    /// Twice the energy of a displacement.
    fn energy(displacement: impl Fn([f64; 3]) -> [f64; 3]) -> f64 {
        let forces = answer(&displacement);
        let pairs = forces.as_chunks::<3>().0.iter().enumerate();
        pairs.map(|(node, f)| f.iter().zip(displacement(place(node))).map(|(f, u)| f * u).sum::<f64>()).sum()
    }

    #[test]
    fn shapes_are_one_at_their_node_and_sum_to_one() {
        for (node, corner) in CORNERS.iter().enumerate() {
            let values = shapes(corner.map(f64::from));
            for (other, value) in values.iter().enumerate() {
                let wanted = f64::from(u8::from(node == other));
                assert!((value - wanted).abs() < 1e-15);
            }
        }
        let sum: f64 = shapes([0.3, -0.7, 0.2]).iter().sum();
        assert!((sum - 1.0).abs() < 1e-14);
    }

    #[test]
    fn slopes_are_the_differences_of_the_shapes() {
        let (at, step) = ([0.31, -0.62, 0.17], 1e-5);
        for axis in 0..3 {
            let moved = |by: f64| shapes(std::array::from_fn(|a| at[a] + if a == axis { by } else { 0.0 }));
            for (node, slope) in slopes(at)[axis].iter().enumerate() {
                let difference = (moved(step)[node] - moved(-step)[node]) / (2.0 * step);
                assert!((slope - difference).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn rigid_motions_need_no_force() {
        let stretched = answer(|[x, _, _]| [1e-3 * x, 0.0, 0.0]);
        let scale = stretched.iter().fold(0.0_f64, |max, f| max.max(f.abs()));
        for motion in [
            answer(|_| [1e-3, 2e-3, -1e-3]),
            answer(|[x, y, _]| [-1e-3 * y, 1e-3 * x, 0.0]),
            answer(|[x, _, z]| [1e-3 * z, 0.0, -1e-3 * x]),
        ] {
            assert!(motion.iter().all(|force| force.abs() < 1e-11 * scale));
        }
    }

    #[test]
    fn even_strain_has_the_energy_of_hookes_law() {
        let (ex, ey) = (1e-3, -4e-4);
        let strained = |[x, y, _]: [f64; 3]| [ex * x, ey * y, 0.0];
        let work = energy(strained);
        let (lambda, mu) = lame_mpa(STEEL);
        let density = lambda * (ex + ey) * (ex + ey) + 2.0 * mu * (ex * ex + ey * ey);
        let volume: f64 = SIZE.iter().product();
        assert!((work / (density * volume) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn even_curvature_has_its_exact_energy() {
        let bend = 1e-3;
        let bent = |[x, y, z]: [f64; 3]| [-bend * x * z, 0.3 * bend * y * z, bend * x * x / 2.0];
        let work = energy(bent);
        // Strains −bend z and 0.3 bend z along x and y, 0.3 bend y/2 · 2 in yz; the shear in xz cancels.
        let (lambda, mu) = lame_mpa(STEEL);
        let second_moment = SIZE[0] * SIZE[1] * SIZE[2].powi(3) / 12.0;
        let across = SIZE[0] * SIZE[2] * SIZE[1].powi(3) / 12.0;
        let trace = -0.7 * bend;
        let normal = lambda * trace * trace + 2.0 * mu * (1.0 + 0.09) * bend * bend;
        let shear = mu * (0.3 * bend) * (0.3 * bend);
        assert!((work / (normal * second_moment + shear * across) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_box_weighs_what_it_holds() {
        let mass = box_mass_t(SIZE, STEEL.density_kg_m3);
        let weight = |u: &dyn Fn([f64; 3]) -> f64| -> f64 {
            let values: Vec<f64> = (0..NODES).map(|node| u(place(node))).collect();
            let pairs = mass.iter().zip(&values);
            pairs.map(|(row, a)| a * row.iter().zip(&values).map(|(m, b)| m * b).sum::<f64>()).sum()
        };
        let whole = 7.85e-9 * SIZE.iter().product::<f64>();
        assert!((weight(&|_| 1.0) / whole - 1.0).abs() < 1e-12);
        // ∫ x² over a box about its middle is its volume times a twelfth of its length squared.
        let known = whole * SIZE[0] * SIZE[0] / 12.0;
        assert!((weight(&|[x, ..]| x) / known - 1.0).abs() < 1e-12, "{}", weight(&|[x, ..]| x));
    }

    #[test]
    fn the_derivative_by_height_is_the_difference_of_two_boxes() {
        let step = 1e-4;
        let high = box_stiffness([SIZE[0], SIZE[1], SIZE[2] + step], STEEL);
        let low = box_stiffness([SIZE[0], SIZE[1], SIZE[2] - step], STEEL);
        let slope = box_stiffness_per_height(SIZE, STEEL);
        let scale = slope.iter().flatten().fold(0.0_f64, |max, k| max.max(k.abs()));
        for (row, (high, low)) in slope.iter().zip(high.iter().zip(low.iter())) {
            for (slope, (high, low)) in row.iter().zip(high.iter().zip(low)) {
                assert!(((high - low) / (2.0 * step) - slope).abs() < 1e-6 * scale);
            }
        }
    }
}
