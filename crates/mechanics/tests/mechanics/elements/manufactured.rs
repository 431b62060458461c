//! A manufactured solution: a smooth displacement with the body force that makes it, on finer and finer meshes.

use tactpad_core::pad::device::Material;
use tactpad_mechanics::brick::lame_mpa;
use tactpad_mechanics::mesh::{Layer, Mesh};

use super::body::{Body, Gradient, Vector, stress_mpa};

const MATERIAL: Material = Material { e_mpa: 5000.0, nu: 0.34, density_kg_m3: 1_420.0 };

/// Component k is AMPLITUDE[k] sin(WAVE[k]·x + PHASE[k]), on the cube [0, 1]³.
const AMPLITUDE: Vector = [1.0e-3, -0.7e-3, 1.3e-3];
const WAVE: Gradient = [[2.1, 0.8, -1.3], [-0.6, 2.4, 1.1], [1.2, -0.9, 1.9]];
const PHASE: Vector = [0.3, -0.4, 0.9];

fn angle(component: usize, place: Vector) -> f64 {
    PHASE[component] + (0..3).map(|axis| WAVE[component][axis] * place[axis]).sum::<f64>()
}

fn displacement(place: Vector) -> Vector {
    [0, 1, 2].map(|k| AMPLITUDE[k] * angle(k, place).sin())
}

fn gradient(place: Vector) -> Gradient {
    [0, 1, 2].map(|k| WAVE[k].map(|wave| AMPLITUDE[k] * wave * angle(k, place).cos()))
}

/// f = −(λ + μ) grad div u − μ Δu.
fn force(place: Vector) -> Vector {
    let (lambda, mu) = lame_mpa(MATERIAL);
    [0, 1, 2].map(|k| {
        let grad_div: f64 =
            (0..3).map(|j| -AMPLITUDE[j] * WAVE[j][j] * WAVE[j][k] * angle(j, place).sin()).sum();
        let squares: f64 = WAVE[k].iter().map(|wave| wave * wave).sum();
        let laplacian = -AMPLITUDE[k] * squares * angle(k, place).sin();
        -(lambda + mu) * grad_div - mu * laplacian
    })
}

/// So many cells along each axis, graded differently along each.
fn mesh(cells: usize) -> Mesh {
    let lines = |bend: f64| {
        let even = (0..=cells).map(|line| line as f64 / cells as f64);
        even.map(|s| s + bend * (std::f64::consts::TAU * s).sin()).collect::<Vec<_>>()
    };
    Mesh::filled([lines(0.08), lines(-0.06), lines(0.1)], |[x, ..]| {
        Some(if x < 0.5 { Layer::Pi } else { Layer::Fpc })
    })
}

/// Errors of displacement (L2) and of energy (the root of ∫ σ(e):ε(e)).
fn errors(cells: usize) -> [f64; 2] {
    let outside = |place: Vector| place.iter().any(|at| at.abs() < 1e-9 || (at - 1.0).abs() < 1e-9);
    let body =
        Body::solve(mesh(cells), |_| MATERIAL, |place| outside(place).then(|| displacement(place)), force);
    let mut sums = [0.0; 2];
    for sample in body.samples() {
        let wanted = displacement(sample.place_mm);
        let off: f64 = (0..3).map(|k| (sample.displacement_mm[k] - wanted[k]).powi(2)).sum();
        let wanted = gradient(sample.place_mm);
        let strain =
            [0, 1, 2].map(|k| [0, 1, 2].map(|axis: usize| sample.gradient[k][axis] - wanted[k][axis]));
        let stress = stress_mpa(&strain, MATERIAL);
        let normal: f64 = (0..3).map(|a| stress[a] * strain[a][a]).sum();
        let sheared: f64 = [(3, 1, 2), (4, 0, 2), (5, 0, 1)]
            .iter()
            .map(|(of, a, b): &(usize, usize, usize)| stress[*of] * (strain[*a][*b] + strain[*b][*a]))
            .sum();
        sums[0] += sample.volume_mm3 * off;
        sums[1] += sample.volume_mm3 * (normal + sheared);
    }
    sums.map(f64::sqrt)
}

#[test]
fn errors_fall_with_the_elements_order() {
    let ladder = [4, 8, 16].map(errors);
    let order = |of: usize, rung: usize| (ladder[rung][of] / ladder[rung + 1][of]).log2();
    // The first two meshes are still coarse beside the solution's waves.
    for (rung, short_of) in [(0, 0.2), (1, 0.05)] {
        let (displacement, energy) = (order(0, rung), order(1, rung));
        assert!(displacement > 3.0 - short_of && displacement < 3.3, "displacement: order {displacement}");
        assert!(energy > 2.0 - short_of && energy < 2.3, "energy: order {energy}");
    }
    let size = displacement([0.5; 3]).iter().map(|u| u * u).sum::<f64>().sqrt();
    assert!(ladder[2][0] < 1e-4 * size, "{ladder:?}");
}
