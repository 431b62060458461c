//! A thin rectangular film clamped along its whole edge, under an even load, beside Kirchhoff's plate.
//!
//! Source: S. Timoshenko, S. Woinowsky-Krieger, Theory of Plates and Shells, 2nd edition, section 44, table 35
//! (ν = 0.3, three digits); the square's deflection to more digits from R. L. Taylor, S. Govindjee, Solution of clamped
//! rectangular plate problems, Commun. Numer. Meth. Engng 20 (2004) 757.

use std::f64::consts::TAU;

use faer::Mat;
use tactpad_core::pad::device::Material;
use tactpad_mechanics::brick::box_mass_t;
use tactpad_mechanics::brick::box_stiffness;
use tactpad_mechanics::grid::{Sizing, graded};
use tactpad_mechanics::mesh::{Layer, Mesh};
use tactpad_mechanics::system::{DegreesOfFreedom, Factor};
use tactpad_mechanics::vibration::NaturalModes;

use super::body::{Body, Vector};

const MATERIAL: Material = Material { e_mpa: 5000.0, nu: 0.3, density_kg_m3: 1_420.0 };

/// Shorter side and thickness: so thin that shear adds less than a tenth of a percent or two.
const SIDE_MM: f64 = 10.0;
const THICKNESS_MM: f64 = 0.1;
const LOAD_MPA: f64 = 1e-4;

/// The clamped edge keeps the film from thinning over about a thickness, so the mesh is fine there.
const SIZING: Sizing = Sizing { finest_mm: 0.02, growth: 0.3, coarsest_mm: 0.5 };

fn solve(length_mm: f64) -> Body {
    let load = |_| [0.0, 0.0, LOAD_MPA / THICKNESS_MM];
    Body::solve(mesh(length_mm), |_| MATERIAL, move |place| clamped(length_mm, place), load)
}

fn mesh(length_mm: f64) -> Mesh {
    let lines = |length: f64| {
        let edges = [-length / 2.0, length / 2.0];
        graded(&[edges[0], 0.0, edges[1]], |at| SIZING.near(&edges, at))
    };
    let half = THICKNESS_MM / 2.0;
    Mesh::filled([lines(SIDE_MM), lines(length_mm), vec![-half, half]], |_| Some(Layer::Pi))
}

fn clamped(length_mm: f64, [x, y, _]: Vector) -> Option<Vector> {
    (x.abs() > SIDE_MM / 2.0 - 1e-9 || y.abs() > length_mm / 2.0 - 1e-9).then_some([0.0; 3])
}

/// Deflection at the centre in units of q a⁴/D, and moments about both axes there in units of q a².
fn at_centre(body: &Body) -> [f64; 3] {
    let Material { e_mpa, nu, .. } = MATERIAL;
    let rigidity = e_mpa * THICKNESS_MM.powi(3) / (12.0 * (1.0 - nu * nu));
    let brick = body.mesh.bricks.iter().find(|brick| {
        let corner = body.mesh.place_mm(brick.nodes[0]);
        (0..2).all(|axis| corner[axis].abs() < 1e-9)
    });
    let top = body.sample(brick.unwrap(), [-1.0, -1.0, 1.0], 0.0);
    let curvature = [0, 1].map(|axis: usize| top.gradient[axis][axis] / (THICKNESS_MM / 2.0));
    let moment =
        |a: usize| rigidity * (curvature[a] + nu * curvature[1 - a]) / (LOAD_MPA * SIDE_MM * SIDE_MM);
    [top.displacement_mm[2] * rigidity / (LOAD_MPA * SIDE_MM.powi(4)), moment(0), moment(1)]
}

#[test]
fn a_square_film_bends_as_kirchhoff_says() {
    let [deflection, mx, my] = at_centre(&solve(SIDE_MM));
    assert!((deflection / 1.265_32e-3 - 1.0).abs() < 2e-3, "{deflection:e}");
    assert!((mx / 0.0231 - 1.0).abs() < 1e-2 && (my / 0.0231 - 1.0).abs() < 1e-2, "{mx:e} {my:e}");
}

#[test]
fn an_oblong_film_bends_as_kirchhoff_says() {
    let [deflection, mx, my] = at_centre(&solve(2.0 * SIDE_MM));
    assert!((deflection / 2.54e-3 - 1.0).abs() < 4e-3, "{deflection:e}");
    assert!((mx / 0.0412 - 1.0).abs() < 1e-2 && (my / 0.0158 - 1.0).abs() < 1e-2, "{mx:e} {my:e}");
}

/// The slowest frequencies of the film, as ω a² √(ϱh/D) with its shorter side a.
fn natural(length_mm: f64) -> Vec<f64> {
    const WANTED: usize = 3;
    let mesh = mesh(length_mm);
    let freedoms = DegreesOfFreedom::new(&mesh, |node| clamped(length_mm, mesh.place_mm(node)).is_some());
    let factor = Factor::of(&mesh, &freedoms, |brick| box_stiffness(brick.size_mm, MATERIAL)).unwrap();
    let solve = |loads: &Mat<f64>| {
        let mut moved = loads.clone();
        factor.solve(&mut moved).map(|()| moved)
    };
    let mass = |moved: &Mat<f64>| {
        let mut forces = Mat::zeros(moved.nrows(), moved.ncols());
        for brick in &mesh.bricks {
            let mass = box_mass_t(brick.size_mm, MATERIAL.density_kg_m3);
            let firsts = brick.nodes.map(|node| freedoms.first(node));
            for (row, i) in mass.iter().zip(firsts) {
                for (m, j) in row.iter().zip(firsts) {
                    let (Some(i), Some(j)) = (i, j) else { continue };
                    for column in 0..moved.ncols() {
                        (0..3).for_each(|a| forces[(i + a, column)] += m * moved[(j + a, column)]);
                    }
                }
            }
        }
        forces
    };
    // Bumps and waves along the film, so that the slowest shapes are in reach.
    let start = start(&mesh, &freedoms, length_mm);
    let found = NaturalModes::slowest(WANTED, start, solve, mass).unwrap();
    let Material { e_mpa, nu, density_kg_m3 } = MATERIAL;
    let rigidity = e_mpa * THICKNESS_MM.powi(3) / (12.0 * (1.0 - nu * nu));
    let scale = SIDE_MM * SIDE_MM * (1e-12 * density_kg_m3 * THICKNESS_MM / rigidity).sqrt();
    found.frequencies_hz().map(|hz| TAU * hz * scale).collect()
}

/// Ten lifts of the film: powers of x and y up to the third, zero along the edge.
fn start(mesh: &Mesh, freedoms: &DegreesOfFreedom, length_mm: f64) -> Mat<f64> {
    let powers: Vec<[i32; 2]> = (0..4).flat_map(|n| (0..=n).map(move |m| [n - m, m])).collect();
    let mut start = Mat::zeros(freedoms.unknowns(), powers.len());
    for node in 0..mesh.lattice.len() {
        let Some(first) = freedoms.first(node) else { continue };
        let [x, y, _] = mesh.place_mm(node);
        let (s, t) = (2.0 * x / SIDE_MM, 2.0 * y / length_mm);
        let bump = ((1.0 - s * s) * (1.0 - t * t)).powi(2);
        for (column, [a, b]) in powers.iter().enumerate() {
            start[(first + 2, column)] = bump * s.powi(*a) * t.powi(*b);
        }
    }
    start
}

/// Source: A. W. Leissa, The free vibration of rectangular plates, J. Sound Vib. 31 (1973) 257, table C1, ν = 0.3: all edges
/// clamped. Its ω a² √(ϱh/D) has the side that the frequency is scaled with here: the shorter one.
#[test]
fn a_clamped_film_rings_as_leissa_says() {
    let square = natural(SIDE_MM);
    for (found, known) in square.iter().zip([35.992, 73.413, 73.413]) {
        assert!((found / known - 1.0).abs() < 0.01, "{found} for {known}");
    }
    let oblong = natural(1.5 * SIDE_MM);
    for (found, known) in oblong.iter().zip([27.010, 41.716]) {
        assert!((found / known - 1.0).abs() < 0.01, "{found} for {known}");
    }
}
