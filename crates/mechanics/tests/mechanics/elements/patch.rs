//! Patch tests: what the elements can represent, they find exactly, however irregular the mesh.

use tactpad_core::pad::device::Material;
use tactpad_mechanics::brick::lame_mpa;
use tactpad_mechanics::mesh::{Layer, Mesh};

use super::body::{Body, Vector, stress_mpa};

/// The same constants in every layer.
const MATERIAL: Material = Material { e_mpa: 4100.0, nu: 0.33, density_kg_m3: 1_900.0 };

/// Neighbours differ in size up to twentyfold.
fn mesh() -> Mesh {
    let lines_mm =
        [vec![-1.0, -0.95, -0.2, 0.1, 1.3], vec![0.0, 0.4, 0.45, 1.2, 1.25, 1.9], vec![0.0, 0.02, 0.3, 0.7]];
    Mesh::filled(lines_mm, |[x, y, z]| {
        // Every layer somewhere, and a notch.
        let layer = Layer::ALL[((10.0 * (x + y + z) + 20.0) as usize) % Layer::ALL.len()];
        (x < 0.1 || y > 0.4).then_some(layer)
    })
}

/// Whether a place is on the boundary of [`mesh`].
fn is_outside(place: Vector) -> bool {
    let [x, y, z] = place;
    let on = |at: f64, of: &[f64]| of.iter().any(|line| (at - line).abs() < 1e-9);
    on(x, &[-1.0, 1.3]) || on(y, &[0.0, 1.9]) || on(z, &[0.0, 0.7]) || x > 0.1 - 1e-9 && y < 0.4 + 1e-9
}

/// The largest error inside the body, as a share of the largest displacement.
fn error(displacement: impl Fn(Vector) -> Vector, force: Vector) -> (Body, f64) {
    let given = |place| is_outside(place).then(|| displacement(place));
    let body = Body::solve(mesh(), |_| MATERIAL, given, |_| force);
    let (mut largest, mut worst, mut inside) = (0.0_f64, 0.0_f64, 0);
    for (node, moved) in body.displacements_mm.iter().enumerate() {
        let place = body.mesh.place_mm(node);
        inside += usize::from(!is_outside(place));
        for (found, wanted) in moved.iter().zip(displacement(place)) {
            largest = largest.max(wanted.abs());
            worst = worst.max((found - wanted).abs());
        }
    }
    assert!(inside > 100, "only {inside} nodes are inside");
    (body, worst / largest)
}

#[test]
fn an_even_strain_is_found_exactly() {
    let gradient = [[1e-3, -4e-4, 2e-4], [7e-4, -5e-4, 3e-4], [-6e-4, 1e-4, 8e-4]];
    let linear =
        |place: Vector| gradient.map(|row| 0.01 + (0..3).map(|axis| row[axis] * place[axis]).sum::<f64>());
    let (body, error) = error(linear, [0.0; 3]);
    assert!(error < 1e-12, "{error:e}");
    let wanted = stress_mpa(&gradient, MATERIAL);
    for sample in body.samples() {
        for (found, wanted) in stress_mpa(&sample.gradient, MATERIAL).iter().zip(wanted) {
            assert!(
                (found - wanted).abs() < 1e-9,
                "{found} instead of {wanted} MPa at {:?}",
                sample.place_mm
            );
        }
    }
}

#[test]
fn any_parabola_is_found_exactly() {
    let (lambda, mu) = lame_mpa(MATERIAL);
    let parabola =
        |[x, y, z]: Vector| [1e-3 * (x * x - y * z), 1e-3 * (x * y + 2.0 * z * z), 1e-3 * (x * z - y * y)];
    // div u = 4e-3 x, and the Laplacians are 2e-3, 4e-3 and −2e-3.
    let force = [-((lambda + mu) * 4e-3 + mu * 2e-3), -mu * 4e-3, mu * 2e-3];
    let (_, error) = error(parabola, force);
    assert!(error < 1e-11, "{error:e}");
}
