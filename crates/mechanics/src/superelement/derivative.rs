//! How a module's stiffness and strains change with its layers, by the adjoint method.
//!
//! With u the field of a mode, z the field that a gauge's weights load, and ∂K a derivative of the whole stiffness
//! matrix: dK = uᵀ ∂K u for the condensed stiffness and dB = −zᵀ ∂K u for the strains. So one more solution for each
//! strain gives the derivatives by any number of parameters.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};

use crate::brick::{DOFS, Stiffness, box_stiffness, box_stiffness_per_height};
use crate::mesh::{Brick, Layer};
use crate::system::{SolveError, gathered};

use super::gauge::gauge_weights;
use super::{LayerDerivatives, MODES, STRAINS, Solution, Superelement};

/// Columns of a brick's displacements: the modes' fields, then the gauges' adjoint fields.
const COLUMNS: usize = MODES + STRAINS;

/// Products of all columns with ∂K times the modes' fields, as `[column, mode]`.
type Products = Mat<f64>;

impl Solution<'_> {
    /// Derivatives with respect to each layer's modulus and thickness, in the order of [`Layer::ALL`].
    ///
    /// All elements of a layer grow in proportion, and what lies above moves along. The gauges stay where they are.
    ///
    /// # Errors
    /// Not enough memory.
    pub fn derivatives(&self) -> Result<Vec<LayerDerivatives>, SolveError> {
        let adjoint = self.adjoint()?;
        let zero = || Mat::<f64>::zeros(COLUMNS, MODES);
        let mut sums: Vec<[Products; 2]> = Layer::ALL.iter().map(|_| [zero(), zero()]).collect();
        for brick in &self.mesh.bricks {
            let columns = self.columns(brick, &adjoint);
            let slopes = self.stiffness_slopes(brick);
            for (sum, slope) in sums[brick.layer as usize].iter_mut().zip(&slopes) {
                add_products(slope, &columns, sum);
            }
        }
        let parts = |[per_mpa, per_mm]: &[Products; 2]| LayerDerivatives {
            per_mpa: from_products(per_mpa),
            per_mm: from_products(per_mm),
        };
        Ok(sums.iter().map(parts).collect())
    }

    /// A brick's stiffness per MPa of its layer's modulus and per mm of its layer's thickness.
    fn stiffness_slopes(&self, brick: &Brick) -> [Box<Stiffness>; 2] {
        let material = brick.layer.material(self.device, self.module);
        // K is proportional to E. All bricks of a layer grow in proportion: ∂h/∂H = h/H for a layer of thickness H.
        let share = brick.size_mm[2] / brick.layer.thickness_mm(&self.device.stack);
        let mut per_mpa = box_stiffness(brick.size_mm, material);
        per_mpa.as_flattened_mut().iter_mut().for_each(|k| *k /= material.e_mpa);
        let mut per_mm = box_stiffness_per_height(brick.size_mm, material);
        per_mm.as_flattened_mut().iter_mut().for_each(|k| *k *= share);
        [per_mpa, per_mm]
    }

    /// Fields that the gauges' weights load, one column for each strain.
    fn adjoint(&self) -> Result<Mat<f64>, SolveError> {
        // K z = w.
        let mut right = Mat::zeros(self.freedoms.unknowns(), STRAINS);
        for (column, weights) in gauge_weights(&self.mesh, &self.device.gauges).iter().enumerate() {
            for (node, axis, weight) in weights {
                if let Some(first) = self.freedoms.first(*node) {
                    right[(first + axis, column)] += weight;
                }
            }
        }
        self.factor.solve(&mut right)?;
        Ok(right)
    }

    /// The brick's displacements in all fields, `[dof, column]`.
    fn columns(&self, brick: &Brick, adjoint: &Mat<f64>) -> Mat<f64> {
        let mut columns = Mat::zeros(DOFS, COLUMNS);
        for mode in 0..MODES {
            let field = gathered(brick, |node| self.displacement(node, mode));
            columns.col_as_slice_mut(mode).copy_from_slice(&field);
        }
        for strain in 0..STRAINS {
            let field = gathered(brick, |node| {
                let first = self.freedoms.first(node);
                std::array::from_fn(|axis| first.map_or(0.0, |first| adjoint[(first + axis, strain)]))
            });
            columns.col_as_slice_mut(MODES + strain).copy_from_slice(&field);
        }
        columns
    }
}

fn add_products(slope: &Stiffness, columns: &Mat<f64>, sum: &mut Products) {
    // The matrix is symmetric, so its rows may be read as columns.
    let slope = MatRef::from_column_major_slice(slope.as_flattened(), DOFS, DOFS);
    // (u, z)ᵀ ∂K u.
    let mut forces = Mat::<f64>::zeros(DOFS, MODES);
    let fields = columns.subcols(0, MODES);
    matmul(&mut forces, Accum::Replace, slope, fields, 1.0, Par::Seq);
    matmul(sum, Accum::Add, columns.transpose(), &forces, 1.0, Par::Seq);
}

fn from_products(products: &Products) -> Superelement {
    Superelement {
        stiffness: std::array::from_fn(|j| std::array::from_fn(|k| products[(j, k)])),
        strains: std::array::from_fn(|j| std::array::from_fn(|k| -products[(MODES + j, k)])),
    }
}

#[cfg(test)]
mod tests {
    use crate::mesh::Fineness;
    use crate::superelement::stiffness_of;
    use crate::system::add_holding_forces;
    use tactpad_core::pad::device::{Device, Module, Side};

    use super::*;

    #[test]
    fn gauges_and_modes_are_reciprocal() {
        let (device, module) =
            (Device::nominal(), Module { frame_open: Some(Side::MinusY), ..Module::NOMINAL });
        let solution = Solution::of(&device, &module, Fineness::STANDARD.scaled(3.0)).unwrap();
        // Betti: a mode's holding forces work on a gauge's field as much as the gauge's weights on the mode's field.
        let mut forces = Mat::zeros(solution.unknowns(), MODES);
        add_holding_forces(
            solution.top_bricks(),
            &solution.freedoms,
            |brick| stiffness_of(&device, &module, brick),
            |node, mode| {
                if solution.mesh.is_top(node) { solution.displacement(node, mode) } else { [0.0; 3] }
            },
            &mut forces,
        );
        let work = solution.adjoint().unwrap().transpose() * forces;
        let strains = solution.superelement().strains;
        let largest = strains.as_flattened().iter().fold(0.0_f64, |max, strain| max.max(strain.abs()));
        for (j, row) in strains.iter().enumerate() {
            for (k, strain) in row.iter().enumerate() {
                assert!((strain - work[(j, k)]).abs() < 1e-11 * largest, "strain {j}, mode {k}");
            }
        }
    }
}
