//! A thin rectangular film clamped along its whole edge, under an even load, beside Kirchhoff's plate.
//!
//! Source: S. Timoshenko, S. Woinowsky-Krieger, Theory of Plates and Shells, 2nd edition, section 44, table 35
//! (ν = 0.3, three digits); the square's deflection to more digits from R. L. Taylor, S. Govindjee, Solution of clamped
//! rectangular plate problems, Commun. Numer. Meth. Engng 20 (2004) 757.

use tactpad::mechanics::grid::{Sizing, graded};
use tactpad::mechanics::mesh::{Layer, Mesh};
use tactpad::pad::device::Material;

use super::body::{Body, Vector};

const MATERIAL: Material = Material { e_mpa: 5000.0, nu: 0.3, density_kg_m3: 1_420.0 };

/// Shorter side and thickness: so thin that shear adds less than a tenth of a percent or two.
const SIDE_MM: f64 = 10.0;
const THICKNESS_MM: f64 = 0.1;
const LOAD_MPA: f64 = 1e-4;

/// The clamped edge keeps the film from thinning over about a thickness, so the mesh is fine there.
const SIZING: Sizing = Sizing { finest_mm: 0.02, growth: 0.3, coarsest_mm: 0.5 };

fn solve(length_mm: f64) -> Body {
    let lines = |length: f64| {
        let edges = [-length / 2.0, length / 2.0];
        graded(&[edges[0], 0.0, edges[1]], |at| SIZING.near(&edges, at))
    };
    let half = THICKNESS_MM / 2.0;
    let mesh = Mesh::filled([lines(SIDE_MM), lines(length_mm), vec![-half, half]], |_| Some(Layer::Pi));
    let clamped = move |[x, y, _]: Vector| {
        (x.abs() > SIDE_MM / 2.0 - 1e-9 || y.abs() > length_mm / 2.0 - 1e-9).then_some([0.0; 3])
    };
    Body::solve(mesh, |_| MATERIAL, clamped, |_| [0.0, 0.0, LOAD_MPA / THICKNESS_MM])
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
