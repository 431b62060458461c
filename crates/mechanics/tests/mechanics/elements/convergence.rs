//! How far the program's mesh is from the truth: the signals of a module for unit forces and moments on its foot, and
//! the foot's flexibilities, on a ladder of meshes.
//!
//! The whole ladder, as in `docs/mechanics.md`, takes five minutes and 10 GB.

use std::io::{Write as _, stderr};

use faer::Mat;
use faer::prelude::Solve as _;
use tactpad_core::pad::device::{Device, GAUGES, Module};
use tactpad_mechanics::mesh::Fineness;
use tactpad_mechanics::superelement::{MODES, STRAINS, Solution, Superelement};

/// Forces along x, y, z and moments about x and y, at the middle of the foot.
const LOADS: usize = 5;

/// What is compared. Everything else vanishes by symmetry or does not come from a load of the plate.
const FIGURES: [&str; 10] =
    ["Sx/Fx", "Sx/My", "Sy/Fy", "Sy/Mx", "Sz/Fz", "x/Fx", "y/Fy", "z/Fz", "turn/Mx", "turn/My"];

/// How the seven gauges make the three signals.
const BRIDGES: [[f64; GAUGES]; 3] = [
    [1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, -1.0],
];

struct Rung {
    unknowns: usize,
    entries: usize,
    figures: [f64; FIGURES.len()],
}

impl Rung {
    fn of(fineness: Fineness) -> Self {
        let device = Device::nominal();
        let solution = Solution::of(&device, &Module::NOMINAL, fineness).unwrap();
        let figures = figures(&device, &solution.superelement());
        Self { unknowns: solution.unknowns(), entries: solution.factor_entries(), figures }
    }

    /// The deviation of each figure from another rung's, as a share.
    fn deviations(&self, other: &Self) -> [f64; FIGURES.len()] {
        std::array::from_fn(|figure| self.figures[figure] / other.figures[figure] - 1.0)
    }
}

/// The foot is rigid here: it moves along x, y and z, or turns about x and y.
fn rigid_motions(device: &Device) -> Mat<f64> {
    let half = [device.stack.post_length_x_mm, device.stack.post_width_y_mm].map(|size| size / 2.0);
    // The foot's polynomials 1 and 2 are x and y in half sizes; modes 3p + 2 move along z.
    let entries = [(0, 0, 1.0), (1, 1, 1.0), (2, 2, 1.0), (8, 3, half[1]), (5, 4, -half[0])];
    let mut motions = Mat::zeros(MODES, LOADS);
    entries.into_iter().for_each(|(mode, motion, value)| motions[(mode, motion)] = value);
    motions
}

fn figures(device: &Device, module: &Superelement) -> [f64; FIGURES.len()] {
    let motions = rigid_motions(device);
    let stiffness = Mat::from_fn(MODES, MODES, |j, k| module.stiffness[j][k]);
    let strains = Mat::from_fn(STRAINS, MODES, |j, k| module.strains[j][k]);
    let flexibility = (motions.transpose() * stiffness * &motions).partial_piv_lu();
    let flexibility = flexibility.solve(Mat::<f64>::identity(LOADS, LOADS));
    let strains = strains * motions * &flexibility;
    let signal = |bridge: usize, load: usize| -> f64 {
        let gauge = |gauge: usize| {
            let strain = strains[(2 * gauge, load)]
                + device.gauge_law.transverse_ratio * strains[(2 * gauge + 1, load)];
            BRIDGES[bridge][gauge] * device.gauges[gauge].resistance_ratio * strain
        };
        (0..GAUGES).map(gauge).sum()
    };
    let signals = [signal(0, 0), signal(0, 4), signal(1, 1), signal(1, 3), signal(2, 2)];
    let mut figures = [0.0; FIGURES.len()];
    figures[..5].copy_from_slice(&signals);
    (0..LOADS).for_each(|load| figures[5 + load] = flexibility[(load, load)]);
    figures
}

fn largest(deviations: &[f64]) -> f64 {
    deviations.iter().fold(0.0, |max, deviation| deviation.abs().max(max))
}

/// Half a percent of a mesh whose sizes are 0.75 of the program's. Errors go with the square of the sizes, so of the
/// error e of a mesh the difference shows (1 - 0.75²) e; a mesh of 0.85 shows less and is held to less, and meshes that are
/// twice as coarse as the program's may differ four times as much.
fn is_near_a_finer_one(coarser: f64, factor: f64) {
    let allowed = coarser.powi(2) * 5e-3 * (1.0 - factor.powi(2)) / (1.0 - 0.75_f64.powi(2));
    let [standard, finer] = [1.0, factor].map(|factor| Rung::of(Fineness::STANDARD.scaled(coarser * factor)));
    assert!(finer.unknowns > 5 * standard.unknowns / 4, "{} {}", finer.unknowns, standard.unknowns);
    let deviations = standard.deviations(&finer);
    println!("{factor}: {} and {} unknowns, {deviations:.5?}", finer.unknowns, standard.unknowns);
    assert!(largest(&deviations) < allowed, "{deviations:?}");
}

#[test]
fn a_coarse_mesh_is_as_near_a_finer_one_as_its_sizes_say() {
    is_near_a_finer_one(2.0, 0.75);
}

#[test]
#[ignore = "proof: 15 s: the program's own mesh"]
fn the_programs_mesh_is_within_half_a_percent_of_a_finer_one() {
    is_near_a_finer_one(1.0, 0.85);
}

#[test]
#[ignore = "proof: 60 s: the finer mesh has twice the unknowns, not half as many more"]
fn the_programs_mesh_is_within_half_a_percent_of_a_much_finer_one() {
    is_near_a_finer_one(1.0, 0.75);
}

#[test]
#[ignore = "proof: 300 s: six meshes, the finest of 560,000 unknowns; 10 GB"]
fn ladder() {
    let rungs =
        [2.8, 2.0, 1.4, 1.0, 0.7, 0.5].map(|factor| (factor, Rung::of(Fineness::STANDARD.scaled(factor))));
    let [.., (_, finest)] = &rungs;
    writeln!(stderr(), "| sizes | unknowns | factor | {} |", FIGURES.join(" | ")).unwrap();
    for (factor, rung) in &rungs {
        let percent = rung.deviations(finest).map(|share| format!("{:.2}", 100.0 * share));
        let millions = rung.entries as f64 / 1e6;
        writeln!(stderr(), "| {factor} | {} | {millions:.0} M | {} |", rung.unknowns, percent.join(" | "))
            .unwrap();
    }
    let [.., (_, standard), _, _] = &rungs;
    assert!(largest(&standard.deviations(finest)) < 5e-3);
}
