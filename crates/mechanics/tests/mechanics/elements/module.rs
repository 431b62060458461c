//! Laws of one module: balance, reciprocity, mirror symmetry, scaling, and which way a change goes.

use tactpad_core::pad::device::{Device, Module, Side};
use tactpad_mechanics::brick::{box_stiffness, forces};
use tactpad_mechanics::mesh::{Fineness, Mesh};
use tactpad_mechanics::superelement::{FOOT_SHAPES, MODES, STRAINS, Solution, Superelement};
use tactpad_mechanics::system::gathered;

use super::body::Vector;

/// What is shown here holds on any mesh.
pub(super) fn fineness() -> Fineness {
    Fineness::STANDARD.scaled(3.0)
}

pub(super) fn superelement(device: &Device, module: &Module) -> Superelement {
    Solution::of(device, module, fineness()).unwrap().superelement()
}

fn lopsided() -> Module {
    Module { frame_open: Some(Side::MinusX), bond_e_factor: 0.6, film_e_factor: 1.2, ..Module::NOMINAL }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |max, value| value.abs().max(max))
}

/// The force that each node needs from outside for a unit of a mode.
fn nodal_forces(solution: &Solution<'_>, device: &Device, module: &Module, mode: usize) -> Vec<Vector> {
    let mut sums = vec![[0.0; 3]; solution.mesh.lattice.len()];
    for brick in &solution.mesh.bricks {
        let stiffness = box_stiffness(brick.size_mm, brick.layer.material(device, module));
        let moved = gathered(brick, |node| solution.displacement(node, mode));
        for (node, force) in brick.nodes.iter().zip(forces(&stiffness, &moved).as_chunks::<3>().0) {
            (0..3).for_each(|axis| sums[*node][axis] += force[axis]);
        }
    }
    sums
}

/// Force and moment about the module's origin.
fn resultant(mesh: &Mesh, forces: &[Vector], nodes: impl Fn(usize) -> bool) -> [f64; 6] {
    let mut sum = [0.0; 6];
    for node in (0..forces.len()).filter(|node| nodes(*node)) {
        let ([x, y, z], [fx, fy, fz]) = (mesh.place_mm(node), forces[node]);
        let parts = [fx, fy, fz, y * fz - z * fy, z * fx - x * fz, x * fy - y * fx];
        sum.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
    }
    sum
}

#[test]
fn base_and_plate_are_in_balance() {
    let (device, module) = (Device::nominal(), lopsided());
    let solution = Solution::of(&device, &module, fineness()).unwrap();
    let (mesh, stiffness) = (&solution.mesh, solution.superelement().stiffness);
    for mode in 0..MODES {
        let forces = nodal_forces(&solution, &device, &module, mode);
        let scale = largest(forces.as_flattened());
        let inside = (0..forces.len()).filter(|node| !mesh.is_fixed(*node) && !mesh.is_top(*node));
        assert!(inside.into_iter().all(|node| largest(&forces[node]) < 1e-9 * scale), "mode {mode}");
        let base = resultant(mesh, &forces, |node| mesh.is_fixed(node));
        let top = resultant(mesh, &forces, |node| mesh.is_top(node));
        for (base, top) in base.iter().zip(top) {
            assert!((base + top).abs() < 1e-8 * scale, "mode {mode}: {base} at the base, {top} at the top");
        }
        // The first three modes are translations: their rows of K are the resultant force.
        for (row, force) in stiffness.iter().zip(&top[..3]) {
            assert!((row[mode] - force).abs() < 1e-8 * scale, "mode {mode}: {} {force}", row[mode]);
        }
    }
}

#[test]
fn the_stiffness_is_symmetric() {
    let Superelement { stiffness, .. } = superelement(&Device::nominal(), &lopsided());
    let scale = largest(stiffness.as_flattened());
    for (j, row) in stiffness.iter().enumerate() {
        for (k, value) in row.iter().enumerate() {
            assert!((value - stiffness[k][j]).abs() < 1e-10 * scale, "{j} {k}");
        }
    }
}

/// How a mode changes sign in a mirror that turns one axis round.
fn mode_sign(mode: usize, axis: usize) -> f64 {
    let odd_place = FOOT_SHAPES[mode / 3][axis] % 2 == 1;
    let along_axis = mode % 3 == axis;
    if odd_place == along_axis { 1.0 } else { -1.0 }
}

/// The strain that a mirror brings a strain's gauge to: R1 ↔ R2 and R5 ↔ R6 along x, R3 ↔ R4 along y.
fn mirrored(strain: usize, axis: usize) -> usize {
    let pairs: &[[usize; 2]] = [&[[0, 1], [4, 5]][..], &[[2, 3]][..]][axis];
    let gauge = strain / 2;
    let partner = pairs.iter().find_map(|pair| {
        let at = pair.iter().position(|member| *member == gauge)?;
        Some(pair[1 - at])
    });
    2 * partner.unwrap_or(gauge) + strain % 2
}

/// Asserts that `other` is `one` in a mirror that turns an axis round.
pub(super) fn assert_mirrored(one: &Superelement, other: &Superelement, axis: usize) {
    let scale = [largest(one.stiffness.as_flattened()), largest(one.strains.as_flattened())];
    for k in 0..MODES {
        for j in 0..MODES {
            let wanted = mode_sign(j, axis) * mode_sign(k, axis) * one.stiffness[j][k];
            assert!(
                (other.stiffness[j][k] - wanted).abs() < 1e-8 * scale[0],
                "stiffness {j} {k}, axis {axis}"
            );
        }
        for j in 0..STRAINS {
            let wanted = mode_sign(k, axis) * one.strains[j][k];
            let found = other.strains[mirrored(j, axis)][k];
            assert!((found - wanted).abs() < 1e-8 * scale[1], "strain {j}, mode {k}, axis {axis}");
        }
    }
}

#[test]
fn a_module_as_drawn_is_its_own_mirror_image() {
    let nominal = superelement(&Device::nominal(), &Module::NOMINAL);
    assert_mirrored(&nominal, &nominal, 0);
    assert_mirrored(&nominal, &nominal, 1);
    // What this means for a force on the foot: no middle gauge feels a push along x, no outer one differs in y.
    let scale = largest(nominal.strains.as_flattened());
    assert!([2, 3, 6].iter().all(|gauge: &usize| nominal.strains[2 * gauge][0].abs() < 1e-8 * scale));
    assert!(nominal.stiffness[2][0].abs() < 1e-8 * nominal.stiffness[2][2]);
}

#[test]
fn frames_open_on_opposite_sides_are_mirror_images() {
    let device = Device::nominal();
    for (axis, sides) in [[Side::PlusX, Side::MinusX], [Side::PlusY, Side::MinusY]].into_iter().enumerate() {
        let [plus, minus] =
            sides.map(|side| superelement(&device, &Module { frame_open: Some(side), ..Module::NOMINAL }));
        assert_mirrored(&plus, &minus, axis);
        // R1 and R3, pressed down: they lie off the middle along x and along y.
        let [one, other] = [&plus, &minus].map(|module| module.strains[[0, 4][axis]][2]);
        assert!((one - other).abs() > 1e-3 * one.abs(), "{one} {other}");
    }
}

#[test]
fn an_open_frame_relieves_the_film_on_its_side() {
    let device = Device::nominal();
    let whole = superelement(&device, &Module::NOMINAL).strains;
    let open = superelement(&device, &Module { frame_open: Some(Side::MinusX), ..Module::NOMINAL }).strains;
    // R1 lies at −x, R2 at +x: pressed down, the film at R1 hangs on nothing.
    let pressed = |strains: &[[f64; MODES]; STRAINS], gauge: usize| strains[2 * gauge][2].abs();
    assert!(pressed(&open, 0) < 0.75 * pressed(&whole, 0), "R1");
    assert!((pressed(&open, 1) / pressed(&whole, 1) - 1.0).abs() < 0.05, "R2");
}

#[test]
fn a_softer_part_softens_the_module() {
    let device = Device::nominal();
    let nominal = superelement(&device, &Module::NOMINAL).stiffness;
    for soft in [
        Module { frame_e_factor: 0.8, ..Module::NOMINAL },
        Module { bond_e_factor: 0.8, ..Module::NOMINAL },
        Module { film_e_factor: 0.8, ..Module::NOMINAL },
    ] {
        let stiffness = superelement(&device, &soft).stiffness;
        for mode in 0..MODES {
            let share = stiffness[mode][mode] / nominal[mode][mode];
            assert!(share < 1.0 && share > 0.8, "mode {mode} of {soft:?}: {share}");
        }
    }
}

#[test]
fn moduli_scale_the_stiffness_and_leave_the_strains() {
    const SCALE: f64 = 3.7;
    let device = Device::nominal();
    let mut scaled = device.clone();
    let materials = &mut scaled.material;
    for material in
        [&mut materials.pick, &mut materials.fpc, &mut materials.adh, &mut materials.pi, &mut materials.epoxy]
    {
        material.e_mpa *= SCALE;
    }
    let (one, other) = (superelement(&device, &Module::NOMINAL), superelement(&scaled, &Module::NOMINAL));
    let stiffness = largest(one.stiffness.as_flattened());
    for (one, other) in one.stiffness.iter().flatten().zip(other.stiffness.iter().flatten()) {
        assert!((other - SCALE * one).abs() < 1e-9 * SCALE * stiffness);
    }
    let strain = largest(one.strains.as_flattened());
    for (one, other) in one.strains.iter().flatten().zip(other.strains.iter().flatten()) {
        assert!((other - one).abs() < 1e-9 * strain);
    }
}
