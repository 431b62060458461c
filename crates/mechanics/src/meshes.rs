//! The pressed plate and modules as meshes for ParaView, all in the pad frame, so that they fit together.

use super::brick::NODES;
use super::deformed::{Strain, von_mises_mpa};
use super::pressed::{PressedPad, plane_von_mises_mpa};
use tactpad_plot::vtk::{Cell, CellKind, Field, UnstructuredGrid, Values};

/// Cells along a side of the plate's grid.
const CELLS: usize = 80;

/// A brick's nodes in a mirrored frame. The modules' frames are left-handed, and VTK's cells are not.
const MIRRORED: [usize; NODES] = [0, 3, 2, 1, 4, 7, 6, 5, 11, 10, 9, 8, 15, 14, 13, 12, 16, 19, 18, 17];

/// The middle of a brick on its reference cube.
const MIDDLE: [f64; 3] = [0.0; 3];

/// The plate's top surface: how it moves, its rotations, and strain and equivalent stress on both sides of the plate.
pub fn plate(pressed: &PressedPad) -> UnstructuredGrid {
    let radius_mm = pressed.pad.device.plate.radius_mm();
    let side = CELLS + 1;
    let places: Vec<[f64; 2]> =
        (0..side * side).map(|node| on_disc([node % side, node / side]).map(|at| radius_mm * at)).collect();
    let movements: Vec<_> = places.iter().map(|place| pressed.plate(*place)).collect();
    let quad = |cell: usize| {
        let first = cell / CELLS * side + cell % CELLS;
        Cell { kind: CellKind::Quad, nodes: vec![first, first + 1, first + side + 1, first + side] }
    };
    let device = &pressed.pad.device;
    let half_mm = 0.5 * device.plate.thickness_mm;
    let [top, bottom] = [half_mm, -half_mm].map(|height_mm| {
        places.iter().map(|place| pressed.plate_strain(*place, height_mm)).collect::<Vec<_>>()
    });
    let stresses = [&top, &bottom]
        .map(|side| side.iter().map(|s| plane_von_mises_mpa(*s, device.material.plate)).collect());
    let [top_mpa, bottom_mpa] = stresses;
    let displacements = movements.iter().map(|movement| movement.top_mm).collect();
    let rotations = movements.iter().map(|movement| [movement.rotation[0], movement.rotation[1], 0.0]);
    UnstructuredGrid {
        nodes_mm: places.into_iter().map(|[x, y]| [x, y, 0.0]).collect(),
        cells: (0..CELLS * CELLS).map(quad).collect(),
        node_fields: vec![
            vectors("displacement_mm", displacements),
            vectors("rotation_rad", rotations.collect()),
            vectors("top_strain_xx_yy_xy", top),
            vectors("bottom_strain_xx_yy_xy", bottom),
            scalars("top_von_mises_mpa", top_mpa),
            scalars("bottom_von_mises_mpa", bottom_mpa),
        ],
        cell_fields: vec![],
    }
}

/// A node of the plate's grid on the unit disc. Source of the way from square to disc, x = u √(1 − v²/2) and likewise
/// y: P. Nowell, "Mapping a square to a circle", 2005.
fn on_disc(node: [usize; 2]) -> [f64; 2] {
    let [u, v] = node.map(|k| 2.0 * k as f64 / CELLS as f64 - 1.0);
    [u * (1.0 - 0.5 * v * v).sqrt(), v * (1.0 - 0.5 * u * u).sqrt()]
}

/// A module's bricks: how they move, their layers (0 the frame, 5 the bond), strains and equivalent stress in their
/// middles. Strains are along the module's axes.
pub fn module(pressed: &PressedPad, index: usize) -> UnstructuredGrid {
    let device = &pressed.pad.device;
    let (module, frame) = (pressed.module(index), pressed.module_frame(index));
    let bricks = &module.mesh.bricks;
    let strains: Vec<Strain> = bricks.iter().map(|brick| module.strain(brick, MIDDLE)).collect();
    let material = |brick: usize| bricks[brick].layer.material(device, &device.modules[index]);
    let stresses = strains.iter().enumerate().map(|(brick, strain)| von_mises_mpa(strain, material(brick)));
    let three = |of: fn(&Strain) -> [f64; 3]| strains.iter().map(of).collect();
    let displacements = module.displacements_mm.iter().map(|vector| frame.vector(*vector));
    UnstructuredGrid {
        nodes_mm: (0..module.mesh.lattice.len())
            .map(|node| frame.place_mm(module.mesh.place_mm(node)))
            .collect(),
        cells: bricks
            .iter()
            .map(|brick| Cell {
                kind: CellKind::Hexahedron20,
                nodes: MIRRORED.map(|node| brick.nodes[node]).to_vec(),
            })
            .collect(),
        node_fields: vec![vectors("displacement_mm", displacements.collect())],
        cell_fields: vec![
            scalars("layer", bricks.iter().map(|brick| f64::from(brick.layer as u8)).collect()),
            vectors("strain_xx_yy_zz", three(|[xx, yy, zz, ..]| [*xx, *yy, *zz])),
            vectors("shear_yz_zx_xy", three(|[.., yz, zx, xy]| [*yz, *zx, *xy])),
            scalars("von_mises_mpa", stresses.collect()),
        ],
    }
}

fn scalars(name: &str, values: Vec<f64>) -> Field {
    Field { name: name.to_owned(), values: Values::Scalars(values) }
}

fn vectors(name: &str, values: Vec<[f64; 3]>) -> Field {
    Field { name: name.to_owned(), values: Values::Vectors(values) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_plot::vtk::HEXAHEDRON_EDGES;

    #[test]
    fn mirrored_bricks_have_their_middles_between_their_corners() {
        use crate::brick::CORNERS;
        let place = |node: usize| CORNERS[MIRRORED[node]];
        for (index, edge) in HEXAHEDRON_EDGES.into_iter().enumerate() {
            let [from, to] = edge.map(place);
            let middle = [0, 1, 2].map(|axis| (from[axis] + to[axis]) / 2);
            assert_eq!(place(8 + index), middle, "edge {index}");
        }
        // From node 0 to 1, 3 and 4: left-handed, so right-handed once it is mirrored.
        let along = |node: usize| [0, 1, 2].map(|axis| i32::from(place(node)[axis] - place(0)[axis]));
        let [[a, b, c], [d, e, f], [g, h, i]] = [along(1), along(3), along(4)];
        assert!(a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g) < 0);
    }
}
