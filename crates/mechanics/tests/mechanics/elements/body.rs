//! Any body of bricks under body forces, by the simulator's own elements, assembly and solver.

use faer::Mat;
use tactpad_core::pad::device::Material;
use tactpad_mechanics::brick::{DOFS, NODES, box_stiffness, lame_mpa, shapes, slopes};
use tactpad_mechanics::mesh::{Brick, Layer, Mesh};
use tactpad_mechanics::system::{DegreesOfFreedom, Factor, add_holding_forces, gathered};

/// Four points of Gauss's rule on [−1, 1] with their weights: more than the elements use themselves.
const GAUSS: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    (-0.339_981_043_584_856_3, 0.652_145_154_862_546_2),
    (0.339_981_043_584_856_3, 0.652_145_154_862_546_2),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
];

/// Displacements by axis, or their derivatives.
pub(crate) type Vector = [f64; 3];

/// Derivatives of a displacement, `[component][axis]`.
pub(crate) type Gradient = [Vector; 3];

/// A place inside a body with what was solved there.
pub(crate) struct Sample {
    pub(crate) place_mm: Vector,
    pub(crate) volume_mm3: f64,
    pub(crate) displacement_mm: Vector,
    pub(crate) gradient: Gradient,
}

/// A body and its solution.
pub(crate) struct Body {
    pub(crate) mesh: Mesh,
    pub(crate) displacements_mm: Vec<Vector>,
}

impl Body {
    /// Solves a body whose displacement is given at some places, under a force per volume.
    pub(crate) fn solve(
        mesh: Mesh,
        material: impl Fn(Layer) -> Material,
        given_mm: impl Fn(Vector) -> Option<Vector>,
        force_n_per_mm3: impl Fn(Vector) -> Vector,
    ) -> Self {
        let given: Vec<Option<Vector>> =
            (0..mesh.lattice.len()).map(|node| given_mm(mesh.place_mm(node))).collect();
        let freedoms = DegreesOfFreedom::new(&mesh, |node| given[node].is_some());
        let stiffness = |brick: &Brick| box_stiffness(brick.size_mm, material(brick.layer));
        let mut right = Mat::zeros(freedoms.unknowns(), 1);
        add_body_forces(&mesh, &freedoms, force_n_per_mm3, &mut right);
        let held = |node: usize, _| given[node].unwrap_or_default();
        add_holding_forces(mesh.bricks.iter(), &freedoms, stiffness, held, &mut right);
        Factor::of(&mesh, &freedoms, stiffness).unwrap().solve(&mut right).unwrap();
        let solved = |node: usize| {
            let first = freedoms.first(node)?;
            Some([0, 1, 2].map(|axis| right[(first + axis, 0)]))
        };
        let displacements_mm =
            (0..given.len()).map(|node| given[node].or_else(|| solved(node)).unwrap()).collect();
        Self { mesh, displacements_mm }
    }

    /// The solution at the integration points.
    pub(crate) fn samples(&self) -> impl Iterator<Item = Sample> {
        self.mesh.bricks.iter().flat_map(|brick| points().map(|(at, weight)| self.sample(brick, at, weight)))
    }

    /// The solution at a place of a brick's reference cube.
    pub(crate) fn sample(&self, brick: &Brick, at: Vector, weight: f64) -> Sample {
        let moved: [f64; DOFS] = gathered(brick, |node| self.displacements_mm[node]);
        let (values, slopes) = (shapes(at), slopes(at));
        let sum = |component: usize, values: &[f64; NODES]| -> f64 {
            values.iter().enumerate().map(|(node, value)| value * moved[3 * node + component]).sum()
        };
        Sample {
            place_mm: place_mm(&self.mesh, brick, at),
            volume_mm3: weight * volume_mm3(brick) / 8.0,
            displacement_mm: [0, 1, 2].map(|component| sum(component, &values)),
            gradient: [0, 1, 2].map(|component| {
                [0, 1, 2].map(|axis: usize| sum(component, &slopes[axis]) * 2.0 / brick.size_mm[axis])
            }),
        }
    }
}

/// Stress xx, yy, zz, yz, xz, xy by Hooke's law.
pub(crate) fn stress_mpa(gradient: &Gradient, material: Material) -> [f64; 6] {
    let (lambda, mu) = lame_mpa(material);
    let trace: f64 = (0..3).map(|a| gradient[a][a]).sum();
    let normal = |a: usize| lambda * trace + 2.0 * mu * gradient[a][a];
    let shear = |a: usize, b: usize| mu * (gradient[a][b] + gradient[b][a]);
    [normal(0), normal(1), normal(2), shear(1, 2), shear(0, 2), shear(0, 1)]
}

fn add_body_forces(
    mesh: &Mesh,
    freedoms: &DegreesOfFreedom,
    force: impl Fn(Vector) -> Vector,
    right: &mut Mat<f64>,
) {
    for brick in &mesh.bricks {
        for (at, weight) in points() {
            let force = force(place_mm(mesh, brick, at));
            for (node, shape) in brick.nodes.iter().zip(shapes(at)) {
                let Some(first) = freedoms.first(*node) else { continue };
                for axis in 0..3 {
                    right[(first + axis, 0)] += weight * volume_mm3(brick) / 8.0 * shape * force[axis];
                }
            }
        }
    }
}

fn points() -> impl Iterator<Item = (Vector, f64)> {
    let line = |axis: usize, of: usize| GAUSS[of / [1, 4, 16][axis] % 4];
    (0..64).map(move |of| {
        let [x, y, z] = [0, 1, 2].map(|axis| line(axis, of));
        ([x.0, y.0, z.0], x.1 * y.1 * z.1)
    })
}

fn place_mm(mesh: &Mesh, brick: &Brick, at: Vector) -> Vector {
    let corner = mesh.place_mm(brick.nodes[0]);
    [0, 1, 2].map(|axis| corner[axis] + (1.0 + at[axis]) / 2.0 * brick.size_mm[axis])
}

fn volume_mm3(brick: &Brick) -> f64 {
    brick.size_mm.iter().product()
}
