//! Derivatives by the layers against solving again with changed layers.

use tactpad_core::pad::device::{Device, Module, Side};
use tactpad_mechanics::mesh::{Fineness, Layer, Mesh};
use tactpad_mechanics::superelement::{Solution, Superelement};

/// A module in which nothing vanishes by symmetry.
const MODULE: Module = Module { frame_open: Some(Side::MinusY), frame_e_factor: 0.7, ..Module::NOMINAL };

/// Share of a number by which it is changed, up and down.
const STEP: f64 = 1e-3;

/// The largest error as a share of the largest derivative: what a difference of this step leaves.
const ERROR_MAX: f64 = 1e-5;

fn mesh(device: &Device) -> Mesh {
    Mesh::of(device, &MODULE, Fineness::STANDARD.scaled(3.5))
}

fn solved(device: &Device, mesh: Mesh) -> Superelement {
    Solution::on(mesh, device, &MODULE).unwrap().superelement()
}

/// Asserts that `slope` is the difference of two superelements over `step`.
fn assert_slope(slope: &Superelement, [low, high]: &[Superelement; 2], step: f64, what: &str) {
    let parts =
        |of: &Superelement| [of.stiffness.as_flattened().to_vec(), of.strains.as_flattened().to_vec()];
    for ((slope, low), high) in parts(slope).iter().zip(parts(low)).zip(parts(high)) {
        let largest = slope.iter().fold(0.0_f64, |max, value| max.max(value.abs()));
        assert!(largest > 0.0, "{what} changes nothing");
        for ((slope, low), high) in slope.iter().zip(low).zip(high) {
            let error = ((high - low) / step - slope).abs() / largest;
            assert!(error < ERROR_MAX, "{what}: {slope} is off by {error:e} of {largest}");
        }
    }
}

fn e_mpa_mut(device: &mut Device, layer: Layer) -> &mut f64 {
    let materials = &mut device.material;
    let material = match layer {
        // Frame and bond share a material; their modules have factors of their own.
        Layer::Frame | Layer::Bond => &mut materials.epoxy,
        Layer::Pi => &mut materials.pi,
        Layer::Adh => &mut materials.adh,
        Layer::Fpc => &mut materials.fpc,
        Layer::Post => &mut materials.pick,
    };
    &mut material.e_mpa
}

#[test]
fn slopes_by_modulus_are_those_of_solving_again() {
    let device = Device::nominal();
    let slopes = Solution::on(mesh(&device), &device, &MODULE).unwrap().derivatives().unwrap();
    for layer in [Layer::Pi, Layer::Adh, Layer::Fpc, Layer::Post] {
        let e_mpa = layer.material(&device, &MODULE).e_mpa;
        let changed = [-STEP, STEP].map(|step| {
            let mut device = device.clone();
            *e_mpa_mut(&mut device, layer) *= 1.0 + step;
            solved(&device, mesh(&device))
        });
        let slope = &slopes[layer as usize].per_mpa;
        assert_slope(slope, &changed, 2.0 * STEP * e_mpa, &format!("modulus of {layer:?}"));
    }
    for (layer, factor) in [(Layer::Frame, MODULE.frame_e_factor), (Layer::Bond, MODULE.bond_e_factor)] {
        let e_mpa = layer.material(&device, &MODULE).e_mpa;
        let changed = [-STEP, STEP].map(|step| {
            let mut module = MODULE;
            let number =
                if layer == Layer::Frame { &mut module.frame_e_factor } else { &mut module.bond_e_factor };
            *number = factor * (1.0 + step);
            Solution::on(mesh(&device), &device, &module).unwrap().superelement()
        });
        let slope = &slopes[layer as usize].per_mpa;
        assert_slope(slope, &changed, 2.0 * STEP * e_mpa, &format!("modulus of {layer:?}"));
    }
}

fn thickness_mut(device: &mut Device, layer: Layer) -> &mut f64 {
    let stack = &mut device.stack;
    match layer {
        Layer::Frame => &mut stack.frame_thickness_mm,
        Layer::Pi => &mut stack.pi_thickness_mm,
        Layer::Adh => &mut stack.adh_thickness_mm,
        Layer::Fpc => &mut stack.fpc_thickness_mm,
        Layer::Post => &mut stack.post_height_mm,
        Layer::Bond => &mut stack.bond_thickness_mm,
    }
}

/// The mesh with a layer's elements stretched, so that no element is cut anew.
fn stretched(mesh: &Mesh, layer: Layer, factor: f64) -> Mesh {
    let mut mesh = mesh.clone();
    for brick in mesh.bricks.iter_mut().filter(|brick| brick.layer == layer) {
        brick.size_mm[2] *= factor;
    }
    mesh
}

#[test]
fn slopes_by_thickness_are_those_of_stretched_layers() {
    let device = Device::nominal();
    let mesh = mesh(&device);
    let slopes = Solution::on(mesh.clone(), &device, &MODULE).unwrap().derivatives().unwrap();
    for layer in Layer::ALL {
        let thickness_mm = layer.thickness_mm(&device.stack);
        let changed = [-STEP, STEP].map(|step| {
            let mut device = device.clone();
            *thickness_mut(&mut device, layer) *= 1.0 + step;
            solved(&device, stretched(&mesh, layer, 1.0 + step))
        });
        let slope = &slopes[layer as usize].per_mm;
        assert_slope(slope, &changed, 2.0 * STEP * thickness_mm, &format!("thickness of {layer:?}"));
    }
}
