//! The plate in 3-D: quadratic bricks on a polar grid, quadratic wedges about the axis.
//!
//! The grid is fine under the feet and knows nothing else of them: the modules' nodes are tied to its underside.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use tactpad_core::pad::device::Device;
use tactpad_mechanics::grid::{Sizing, graded};

use super::face::{NODES, shapes};

/// Layers of elements across the plate.
const LAYERS: usize = 3;

/// Twice refined grid coordinates: outwards, around, upwards.
type Lattice = [usize; 3];

/// The plate's mesh in the pad frame.
pub(crate) struct PlateMesh {
    /// Radii and angles (radians, the last one a full turn after the first) of the grid lines.
    radii_mm: Vec<f64>,
    angles: Vec<f64>,
    thickness_mm: f64,
    node_at: BTreeMap<Lattice, usize>,
    pub(crate) places_mm: Vec<[f64; 3]>,
    pub(crate) bricks: Vec<[usize; 20]>,
    pub(crate) wedges: Vec<[usize; 15]>,
}

/// The plate's faces.
#[derive(Clone, Copy)]
pub(crate) enum Face {
    Underside,
    Top,
}

impl PlateMesh {
    pub(crate) fn of(device: &Device, sizing: Sizing) -> Self {
        let mut mesh = Self {
            radii_mm: radii_mm(device, sizing),
            angles: angles(device, sizing),
            thickness_mm: device.plate.thickness_mm,
            node_at: BTreeMap::new(),
            places_mm: Vec::new(),
            bricks: Vec::new(),
            wedges: Vec::new(),
        };
        for k in 0..LAYERS {
            for j in 0..mesh.angles.len() - 1 {
                let wedge = wedge([j, k]).map(|at| mesh.node(at));
                mesh.wedges.push(wedge);
                for i in 1..mesh.radii_mm.len() - 1 {
                    let brick = brick([i, j, k]).map(|at| mesh.node(at));
                    mesh.bricks.push(brick);
                }
            }
        }
        mesh
    }

    fn node(&mut self, at: Lattice) -> usize {
        let at = self.canonical(at);
        let place_mm = self.place_mm(at);
        *self.node_at.entry(at).or_insert_with(|| {
            self.places_mm.push(place_mm);
            self.places_mm.len() - 1
        })
    }

    /// A full turn leads back, and on the axis all angles are one.
    fn canonical(&self, [i, j, k]: Lattice) -> Lattice {
        [i, if i == 0 { 0 } else { j % (2 * (self.angles.len() - 1)) }, k]
    }

    fn place_mm(&self, [i, j, k]: Lattice) -> [f64; 3] {
        let (radius, (sin, cos)) = (between(&self.radii_mm, i), between(&self.angles, j).sin_cos());
        let height = self.thickness_mm * (k as f64 / (2 * LAYERS) as f64 - 1.0);
        [radius * cos, radius * sin, height]
    }

    /// The nodes whose shape functions make up the displacement at a place of a face, with their weights.
    ///
    /// # Panics
    /// The place is in the wedges about the axis, or off the plate.
    pub(crate) fn weights(&self, face: Face, place_mm: [f64; 2]) -> [(usize, f64); 8] {
        let [x, y] = place_mm;
        let cell = [cell_of(&self.radii_mm, x.hypot(y)), cell_of(&self.angles, y.atan2(x).rem_euclid(TAU))];
        assert!(cell[0] > 0, "no wedge lies under a foot or a contact");
        let k = match face {
            Face::Underside => 0,
            Face::Top => 2 * LAYERS,
        };
        let nodes = face_lattice(cell, k).map(|at| self.node_at[&self.canonical(at)]);
        let values = shapes(self.reference_place(&nodes, place_mm));
        std::array::from_fn(|index| (nodes[index], values[index][0]))
    }

    /// Newton's method on the map from the reference square to a face.
    fn reference_place(&self, nodes: &[usize; 8], wanted_mm: [f64; 2]) -> [f64; 2] {
        let mut place = [0.0; 2];
        for _ in 0..20 {
            // The map and its derivatives, for x and for y.
            let mut map = [[0.0; 3]; 2];
            for (node, jet) in nodes.iter().zip(shapes(place)) {
                for (axis, row) in map.iter_mut().enumerate() {
                    (0..3).for_each(|d| row[d] += self.places_mm[*node][axis] * jet[d]);
                }
            }
            let [[x, xs, xt], [y, ys, yt]] = map;
            let (dx, dy, det) = (wanted_mm[0] - x, wanted_mm[1] - y, xs * yt - xt * ys);
            place[0] += (dx * yt - dy * xt) / det;
            place[1] += (dy * xs - dx * ys) / det;
        }
        // Grid lines are arcs, the elements' edges parabolas: a place near one may be a hair outside.
        assert!(place.iter().all(|at| at.abs() < 1.01), "{wanted_mm:?} is at {place:?} of its face");
        place
    }
}

/// A grid's coordinate at twice refined steps.
fn between(lines: &[f64], at: usize) -> f64 {
    if at.is_multiple_of(2) { lines[at / 2] } else { f64::midpoint(lines[at / 2], lines[at / 2 + 1]) }
}

fn cell_of(lines: &[f64], at: f64) -> usize {
    lines[1..lines.len() - 1].partition_point(|line| *line <= at)
}

/// The nodes of a face of a cell (outwards, around), in the order of an eight-node face.
fn face_lattice([i, j]: [usize; 2], k: usize) -> [Lattice; 8] {
    let step = |cell: usize, at: f64| 2 * cell + (at + 1.0) as usize;
    NODES.map(|[s, t]| [step(i, s), step(j, t), k])
}

/// The nodes of a brick: lower corners, upper corners, middles of lower edges, of upper edges, of uprights.
fn brick([i, j, k]: [usize; 3]) -> [Lattice; 20] {
    let [lower, middle, upper] = [0, 1, 2].map(|step| face_lattice([i, j], 2 * k + step));
    let rows = [&lower[..4], &upper[..4], &lower[4..], &upper[4..], &middle[..4]];
    rows.concat().try_into().unwrap()
}

/// The nodes of a wedge about the axis, in the same order.
fn wedge([j, k]: [usize; 2]) -> [Lattice; 15] {
    let corners = |k| [[0, 0, k], [2, 2 * j, k], [2, 2 * j + 2, k]];
    let middles = |k| [[1, 2 * j, k], [2, 2 * j + 1, k], [1, 2 * j + 2, k]];
    let (lower, upper) = (2 * k, 2 * k + 2);
    let rows = [corners(lower), corners(upper), middles(lower), middles(upper), corners(lower + 1)];
    rows.concat().try_into().unwrap()
}

/// Lines from the axis to the edge, with one at either side of each foot.
fn radii_mm(device: &Device, sizing: Sizing) -> Vec<f64> {
    let half = device.stack.post_width_y_mm / 2.0;
    let radius = |[x, y]: [f64; 2]| x.hypot(y);
    let edges: Vec<f64> =
        device.poses().iter().flat_map(|pose| [-half, half].map(|by| radius(pose.centre_mm) + by)).collect();
    let lines = [&[0.0, device.plate.radius_mm()], &edges[..]].concat();
    graded(&lines, |at| sizing.near(&edges, at))
}

/// Lines around, from 0 to a full turn, with one at either side of each foot; sized at the modules' radius.
fn angles(device: &Device, sizing: Sizing) -> Vec<f64> {
    let (half, radius) = (device.stack.post_length_x_mm / 2.0, device.sites.centre_radius_mm);
    let arc = |[x, y]: [f64; 2]| radius * y.atan2(x);
    let edges = device.poses().map(|pose| [-half, half].map(|by| arc(pose.centre_mm) + by));
    let edges: Vec<f64> = edges.as_flattened().iter().map(|at| at.rem_euclid(radius * TAU)).collect();
    let lines = [&[0.0, radius * TAU], &edges[..]].concat();
    graded(&lines, |at| sizing.near(&edges, at)).into_iter().map(|at| at / radius).collect()
}
