//! NaturalModes frequencies beside closed forms, and laws that they keep.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::f64::consts::{PI, TAU};
use std::io::{Write as _, stderr};

use faer::Mat;
use tactpad_core::pad::device::{Device, Material};
use tactpad_mechanics::mesh::Fineness;
use tactpad_mechanics::plate::{FIELDS, Plate, Rigidity, masses_t};
use tactpad_mechanics::simulator::{PLATE_DEGREE, Simulator};
use tactpad_mechanics::vibration::{NaturalModes, NaturalMotion};
use tactpad_numeric::zernike::{count, jets};

/// Leissa's Poisson ratio.
const STEEL: Material = Material { e_mpa: 200_000.0, nu: 0.33, density_kg_m3: 7_850.0 };
const RADIUS_MM: f64 = 30.0;

/// ω a² √(ϱh/D) of a free round plate, ν = 0.33: two nodal diameters, one nodal circle, three diameters, one of both.
/// All but the circle come twice. Source: A. W. Leissa, Vibration of Plates, NASA SP-160 (1969), table 2.5.
const FREE_PLATE: [f64; 7] = [5.253, 5.253, 9.084, 12.23, 12.23, 20.52, 20.52];

fn free_plate(thickness_mm: f64) -> Vec<f64> {
    const DEGREE: usize = 14;
    let rigidity = Rigidity::of(STEEL, thickness_mm, RADIUS_MM);
    // Springs that hold the rigid motions, far softer than the plate, so that they leave its own motions alone.
    let plate = Plate::of(DEGREE, rigidity, 1e-4 * rigidity.bending).unwrap();
    let masses = masses_t(DEGREE, STEEL, thickness_mm, RADIUS_MM);
    let size = count(DEGREE);
    let few = count(6);
    let start =
        Mat::from_fn(FIELDS * size, FIELDS * few, |i, j| f64::from(u8::from(i == j / few * size + j % few)));
    let mass =
        |moved: &Mat<f64>| Mat::from_fn(moved.nrows(), moved.ncols(), |i, j| masses[i] * moved[(i, j)]);
    let found =
        NaturalModes::slowest(6 + FREE_PLATE.len(), start, |loads| Ok(plate.solve(loads)), mass).unwrap();
    let frequencies: Vec<f64> = found.frequencies_hz().collect();
    assert!(frequencies[5] < 0.01 * frequencies[6], "six rigid motions: {frequencies:?}");
    frequencies[6..].to_vec()
}

#[test]
fn a_free_plate_rings_as_leissa_says() {
    const THIN_MM: f64 = 0.3;
    let rigidity = STEEL.e_mpa * THIN_MM.powi(3) / (12.0 * (1.0 - STEEL.nu * STEEL.nu));
    let area_mass = 1e-12 * STEEL.density_kg_m3 * THIN_MM;
    for (found_hz, known) in free_plate(THIN_MM).iter().zip(FREE_PLATE) {
        let found = TAU * found_hz * RADIUS_MM * RADIUS_MM * (area_mass / rigidity).sqrt();
        assert!((found / known - 1.0).abs() < 0.002, "{found} for {known}");
    }
}

#[test]
fn a_thick_plate_rings_lower_than_a_thin_one_of_its_stiffness() {
    // Thin plates: frequency as thickness. Shear and rotatory inertia take away more, the faster the motion.
    let (thin, thick) = (free_plate(0.3), free_plate(6.0));
    let shares: Vec<f64> = thick.iter().zip(&thin).map(|(thick, thin)| thick / thin / 20.0).collect();
    assert!(shares[0] > 0.9 && shares[0] < 0.99, "{shares:?}");
    assert!(shares[6] < shares[3] && shares[3] < shares[0], "{shares:?}");
}

/// A coarse mesh: these are laws, not figures.
fn motions(device: &Device) -> Vec<NaturalMotion> {
    Simulator::new(Fineness::STANDARD.scaled(2.8)).natural_motions(device).unwrap()
}

#[test]
fn a_pad_of_nearly_rigid_parts_is_a_mass_on_springs() {
    // A plate of a thousandfold modulus stays flat: pressed in the middle it sinks by f/k, and it bounces at √(k/m)/2π.
    let mut device = Device::nominal();
    device.material.plate.e_mpa = 1e8;
    // Modules without mass: only the plate moves.
    for material in [
        &mut device.material.pick,
        &mut device.material.fpc,
        &mut device.material.adh,
        &mut device.material.pi,
        &mut device.material.epoxy,
    ] {
        material.density_kg_m3 = 0.0;
    }
    let mut simulator = Simulator::new(Fineness::STANDARD.scaled(2.8));
    let pad = simulator.pad(&device).unwrap();
    let [_, _, w, ..] = pad.deflection([0.0; 2], 2);
    let sunk_mm = -w.coefficients[0];
    let mass_t = 1e-12 * device.material.plate.density_kg_m3 * PI * RADIUS_MM * RADIUS_MM;
    let known_hz = (1.0 / (sunk_mm * mass_t)).sqrt() / TAU;
    let found = simulator.natural_motions(&device).unwrap();
    let bounce = found.iter().find(|motion| motion.rigid_shares[2] > 0.9).unwrap();
    writeln!(stderr(), "bounces at {:.1} Hz, known {known_hz:.1} Hz", bounce.frequency_hz).unwrap();
    assert!((bounce.frequency_hz / known_hz - 1.0).abs() < 1e-3, "{} for {known_hz}", bounce.frequency_hz);
    // Six motions hold all of a rigid plate's mass.
    for motion in 0..6 {
        let held: f64 = found[..6].iter().map(|natural| natural.rigid_shares[motion]).sum();
        assert!((held - 1.0).abs() < 1e-3, "{motion}: {held}");
    }
}

#[test]
fn motions_come_in_pairs_and_add_up_to_the_statics() {
    let device = Device::nominal();
    let found = motions(&device);
    for motion in &found {
        writeln!(stderr(), "{:8.1} Hz {:.3?}", motion.frequency_hz, motion.rigid_shares).unwrap();
    }
    // A pad of threefold symmetry: what sways along x sways along y.
    assert!((found[0].frequency_hz / found[1].frequency_hz - 1.0).abs() < 1e-4);
    // s = Σ s_m (a_mᵀf)/ω_m²: what is missing are the faster motions.
    let mut simulator = Simulator::new(Fineness::STANDARD.scaled(2.8));
    let signals = simulator.pad(&device).unwrap().signals();
    let middle = jets(PLATE_DEGREE, [0.0; 2]);
    let still: f64 = [2, 5, 8].iter().map(|channel| signals[*channel][2].value(&middle)).sum();
    let parts: f64 = found
        .iter()
        .map(|motion| {
            let uv = motion.still_uv_per_n([0.0; 2]);
            uv[2] + uv[5] + uv[8]
        })
        .sum();
    writeln!(stderr(), "z channels {still:.1} µV/N, the slowest motions {parts:.1} µV/N").unwrap();
    assert!((parts / still - 1.0).abs() < 0.05, "{parts} for {still}");
}

#[test]
fn heavier_pads_are_slower() {
    let mut device = Device::nominal();
    let light = motions(&device)[0].frequency_hz;
    for material in [
        &mut device.material.plate,
        &mut device.material.pick,
        &mut device.material.fpc,
        &mut device.material.adh,
        &mut device.material.pi,
        &mut device.material.epoxy,
    ] {
        material.density_kg_m3 *= 4.0;
    }
    let heavy = motions(&device)[0].frequency_hz;
    assert!((light / heavy - 2.0).abs() < 1e-6, "{light} and {heavy}");
}
