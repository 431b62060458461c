//! A module's mass as the plate feels it.

use super::{FootMass, MODES, Solution};
use crate::brick::{DOFS, NODES, box_mass_t};
use crate::system::gathered;

impl Solution<'_> {
    /// Condenses the module's mass to its modes: M_jk = uⱼᵀ M u_k, with the displacements u of the statics.
    ///
    /// That is exact as long as the module's own vibrations are fast beside the pad's: a film with its post alone rings at
    /// some ten kilohertz. Source: R. J. Guyan, AIAA J. 3 (1965) 380.
    pub fn mass(&self) -> FootMass {
        let mut condensed = [[0.0; MODES]; MODES];
        for brick in &self.mesh.bricks {
            let density_kg_m3 = brick.layer.material(self.device, self.module).density_kg_m3;
            let mass = box_mass_t(brick.size_mm, density_kg_m3);
            let moved: [[f64; DOFS]; MODES] =
                std::array::from_fn(|mode| gathered(brick, |node| self.displacement(node, mode)));
            for (k, by) in moved.iter().enumerate() {
                let forces: [f64; DOFS] = std::array::from_fn(|dof| {
                    (0..NODES).map(|node| mass[dof / 3][node] * by[3 * node + dof % 3]).sum()
                });
                for (j, row) in condensed.iter_mut().enumerate() {
                    row[k] += moved[j].iter().zip(&forces).map(|(u, force)| u * force).sum::<f64>();
                }
            }
        }
        condensed
    }
}
