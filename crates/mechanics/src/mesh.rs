//! The mesh of one module: boxes of 20-node bricks on a graded tensor grid, with a grid line at every edge of the
//! geometry and of every gauge.
//!
//! Module frame; z = 0 is the underside of the film (where the gauges are), the frame hangs below it, the post and
//! the bond stand on it.

use tactpad_core::pad::device::{Device, Direction, Gauge, Material, Module, Side, Stack};

use super::brick::{CORNERS, NODES};
use super::grid::{Sizing, graded};

/// A layer of a module, from bottom to top.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Layer {
    /// Epoxy ring on the base.
    Frame,
    /// Polyimide.
    Pi,
    /// Adhesive.
    Adh,
    /// Flexible printed circuit.
    Fpc,
    /// The post.
    Post,
    /// Epoxy between post and plate.
    Bond,
}

impl Layer {
    /// All layers, from bottom to top.
    pub const ALL: [Self; 6] = [Self::Frame, Self::Pi, Self::Adh, Self::Fpc, Self::Post, Self::Bond];

    /// The layer's thickness.
    pub fn thickness_mm(self, stack: &Stack) -> f64 {
        match self {
            Self::Frame => stack.frame_thickness_mm,
            Self::Pi => stack.pi_thickness_mm,
            Self::Adh => stack.adh_thickness_mm,
            Self::Fpc => stack.fpc_thickness_mm,
            Self::Post => stack.post_height_mm,
            Self::Bond => stack.bond_thickness_mm,
        }
    }

    /// The layer's material in a module, with the module's own factors.
    pub fn material(self, device: &Device, module: &Module) -> Material {
        let materials = &device.material;
        let (material, factor) = match self {
            Self::Frame => (materials.epoxy, module.frame_e_factor),
            Self::Pi => (materials.pi, module.film_e_factor),
            Self::Adh => (materials.adh, module.film_e_factor),
            Self::Fpc => (materials.fpc, module.film_e_factor),
            Self::Post => (materials.pick, 1.0),
            Self::Bond => (materials.epoxy, module.bond_e_factor),
        };
        Material { e_mpa: factor * material.e_mpa, ..material }
    }
}

/// Element sizes along one direction, which passes the post, the free film and the frame one after another.
///
/// The solution is singular where post and film meet at the post's foot, and where film and frame meet at the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grading {
    /// In the post, by the distance from its edge.
    pub post: Sizing,
    /// In the film, by the distance from the post's edge.
    pub film_at_post: Sizing,
    /// In the film, by the distance from the frame's edge; the smaller of the two counts.
    pub film_at_frame: Sizing,
    /// In the frame, by the distance from its edge.
    pub frame: Sizing,
}

impl Grading {
    /// The size at these distances outside the post's edge and beyond the frame's (negative: inside it).
    fn at(self, past_post_mm: f64, past_frame_mm: f64) -> f64 {
        if past_post_mm < 0.0 {
            self.post.at(-past_post_mm)
        } else if past_frame_mm > 0.0 {
            self.frame.at(past_frame_mm)
        } else {
            self.film_at_post.at(past_post_mm).min(self.film_at_frame.at(-past_frame_mm))
        }
    }

    fn scaled(self, factor: f64) -> Self {
        Self {
            post: self.post.scaled(factor),
            film_at_post: self.film_at_post.scaled(factor),
            film_at_frame: self.film_at_frame.scaled(factor),
            frame: self.frame.scaled(factor),
        }
    }
}

/// How fine a module is meshed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fineness {
    /// Along x and along y.
    pub plane: Grading,
    /// Across the layers.
    pub height: Grading,
    /// Along x or y, by the distance from where a bond ends that has come off in part.
    pub debonded: Sizing,
}

impl Fineness {
    /// The mesh that the program uses; `docs/mechanics.md` has the study behind it.
    pub const STANDARD: Self = Self {
        plane: Grading {
            post: Sizing { finest_mm: 0.006, growth: 1.5, coarsest_mm: 0.6 },
            film_at_post: Sizing { finest_mm: 0.006, growth: 1.5, coarsest_mm: 0.4 },
            film_at_frame: Sizing { finest_mm: 0.1, growth: 1.0, coarsest_mm: 0.4 },
            frame: Sizing { finest_mm: 0.02, growth: 1.5, coarsest_mm: 0.4 },
        },
        height: Grading {
            post: Sizing { finest_mm: 0.006, growth: 1.5, coarsest_mm: 1.0 },
            film_at_post: Sizing { finest_mm: 0.006, growth: 1.5, coarsest_mm: 0.2 },
            film_at_frame: Sizing { finest_mm: 0.05, growth: 1.5, coarsest_mm: 0.2 },
            frame: Sizing { finest_mm: 0.03, growth: 0.7, coarsest_mm: 0.2 },
        },
        debonded: Sizing { finest_mm: 0.02, growth: 1.5, coarsest_mm: 0.6 },
    };

    /// The same grading with every size multiplied by `factor`.
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            plane: self.plane.scaled(factor),
            height: self.height.scaled(factor),
            debonded: self.debonded.scaled(factor),
        }
    }
}

/// One brick: its layer, its size and its nodes in the order of [`CORNERS`].
#[derive(Clone, Debug, PartialEq)]
pub struct Brick {
    /// The layer it belongs to.
    pub layer: Layer,
    /// Edge lengths along x, y, z.
    pub size_mm: [f64; 3],
    /// Indices of its nodes.
    pub nodes: [usize; NODES],
}

/// The mesh of one module.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// Grid lines along x, y and z.
    pub lines_mm: [Vec<f64>; 3],
    /// Twice refined grid coordinates of each node: grid line k is 2k, the middle of a cell is odd.
    pub lattice: Vec<[usize; 3]>,
    /// The bricks.
    pub bricks: Vec<Brick>,
    /// z index (lattice) of the film's underside.
    pub underside: usize,
}

impl Mesh {
    /// Meshes a module of the device.
    pub fn of(device: &Device, module: &Module, fineness: Fineness) -> Self {
        let [x, y] = [0, 1].map(|axis| plane_lines(device, module, axis, fineness));
        Self::on([x, y, lines_z(&device.stack, fineness)], &device.stack, module)
    }

    /// The bricks of a module on given ascending grid lines along x, y and z: what fills the middle of a cell fills the
    /// cell.
    pub fn on(lines_mm: [Vec<f64>; 3], stack: &Stack, module: &Module) -> Self {
        Self::filled(lines_mm, |[x, y, z]| {
            let layer = layer_at(stack, z);
            occupied(stack, module, layer, [x, y]).then_some(layer)
        })
    }

    /// Bricks on the given ascending grid lines along x, y and z, wherever a layer fills the middle of a cell.
    pub fn filled(lines_mm: [Vec<f64>; 3], layer_at: impl Fn([f64; 3]) -> Option<Layer>) -> Self {
        let cells = lines_mm.each_ref().map(|lines| lines.len().saturating_sub(1));
        let mut numbering = Numbering::new(cells);
        let mut bricks = Vec::new();
        for k in 0..cells[2] {
            for j in 0..cells[1] {
                for i in 0..cells[0] {
                    let cell = [i, j, k];
                    let along = |of: fn(&[f64], usize) -> f64| {
                        std::array::from_fn(|axis| of(&lines_mm[axis], cell[axis]))
                    };
                    if let Some(layer) = layer_at(along(middle)) {
                        bricks.push(Brick { layer, size_mm: along(size), nodes: numbering.brick(cell) });
                    }
                }
            }
        }
        let underside = 2 * lines_mm[2].partition_point(|z| *z < -1e-9);
        Self { lines_mm, lattice: numbering.lattice, bricks, underside }
    }

    /// The place of a node in the module's frame.
    pub fn place_mm(&self, node: usize) -> [f64; 3] {
        std::array::from_fn(|axis| {
            let (lines, at) = (&self.lines_mm[axis], self.lattice[node][axis]);
            if at % 2 == 0 { lines[at / 2] } else { middle(lines, at / 2) }
        })
    }

    /// Whether a node is fixed to the base.
    pub fn is_fixed(&self, node: usize) -> bool {
        self.lattice[node][2] == 0
    }

    /// Whether a node is on the bond's top, where the plate begins.
    pub fn is_top(&self, node: usize) -> bool {
        self.lattice[node][2] == 2 * (self.lines_mm[2].len() - 1)
    }
}

/// Numbers nodes as bricks ask for them.
struct Numbering {
    sides: [usize; 3],
    index: Vec<Option<usize>>,
    lattice: Vec<[usize; 3]>,
}

impl Numbering {
    fn new(cells: [usize; 3]) -> Self {
        let sides = cells.map(|n| 2 * n + 1);
        Self { sides, index: vec![None; sides.iter().product()], lattice: Vec::new() }
    }

    fn brick(&mut self, cell: [usize; 3]) -> [usize; NODES] {
        CORNERS.map(|corner| {
            let at: [usize; 3] =
                std::array::from_fn(|a| (2 * cell[a]).wrapping_add_signed(1 + isize::from(corner[a])));
            self.node(at)
        })
    }

    fn node(&mut self, at: [usize; 3]) -> usize {
        let slot = &mut self.index[(at[2] * self.sides[1] + at[1]) * self.sides[0] + at[0]];
        *slot.get_or_insert_with(|| {
            self.lattice.push(at);
            self.lattice.len() - 1
        })
    }
}

fn middle(lines: &[f64], cell: usize) -> f64 {
    f64::midpoint(lines[cell], lines[cell + 1])
}

fn size(lines: &[f64], cell: usize) -> f64 {
    lines[cell + 1] - lines[cell]
}

/// A gauge's rectangle: half its size along x and y.
pub fn half_sizes_mm(gauge: &Gauge) -> [f64; 2] {
    match gauge.direction {
        Direction::X => [gauge.length_mm / 2.0, gauge.width_mm / 2.0],
        Direction::Y => [gauge.width_mm / 2.0, gauge.length_mm / 2.0],
    }
}

/// Half the sizes along x and y of the post, of the frame's window and of the film.
fn half_outlines_mm(stack: &Stack) -> [[f64; 2]; 3] {
    let film = [stack.film_length_x_mm / 2.0, stack.film_width_y_mm / 2.0];
    let window = film.map(|half| half - stack.frame_width_mm);
    [[stack.post_length_x_mm / 2.0, stack.post_width_y_mm / 2.0], window, film]
}

/// The axis that a side lies along, and the side's sign on it.
const fn facing(side: Side) -> (usize, f64) {
    match side {
        Side::PlusX => (0, 1.0),
        Side::MinusX => (0, -1.0),
        Side::PlusY => (1, 1.0),
        Side::MinusY => (1, -1.0),
    }
}

/// The side from which a bond has come off, as its axis and sign, and how far towards it the rest reaches.
fn bond_rest(stack: &Stack, module: &Module) -> Option<(usize, f64, f64)> {
    let (side, share) = module.debonded()?;
    let ((axis, sign), [post, ..]) = (facing(side), half_outlines_mm(stack));
    Some((axis, sign, post[axis] * (1.0 - 2.0 * share)))
}

/// Grid lines along x (axis 0) or y.
fn plane_lines(device: &Device, module: &Module, axis: usize, fineness: Fineness) -> Vec<f64> {
    let outlines = half_outlines_mm(&device.stack).map(|half| half[axis]);
    let mut lines: Vec<f64> = outlines.into_iter().flat_map(|at| [-at, at]).collect();
    for gauge in &device.gauges {
        let (centre, half) = ([gauge.x_mm, gauge.y_mm][axis], half_sizes_mm(gauge)[axis]);
        lines.extend([centre - half, centre + half]);
    }
    let rest = bond_rest(&device.stack, module).filter(|rest| rest.0 == axis);
    let bond_end = rest.map(|(_, sign, reach)| sign * reach);
    lines.extend(bond_end);
    let [post, window, _] = outlines;
    graded(&lines, |at| {
        let size = fineness.plane.at(at.abs() - post, at.abs() - window);
        bond_end.map_or(size, |end| size.min(fineness.debonded.at((at - end).abs())))
    })
}

fn lines_z(stack: &Stack, fineness: Fineness) -> Vec<f64> {
    let mut lines = vec![-stack.frame_thickness_mm];
    for layer in Layer::ALL {
        let below = lines.last().copied().unwrap_or(0.0);
        lines.push(below + layer.thickness_mm(stack));
    }
    let film_top = stack.pi_thickness_mm + stack.adh_thickness_mm + stack.fpc_thickness_mm;
    graded(&lines, |at| fineness.height.at(film_top - at, -at))
}

fn layer_at(stack: &Stack, z_mm: f64) -> Layer {
    let mut top = -stack.frame_thickness_mm;
    let reached = Layer::ALL.into_iter().find(|layer| {
        top += layer.thickness_mm(stack);
        z_mm < top
    });
    reached.unwrap_or(Layer::Bond)
}

/// Whether a layer fills the column at a place of the module's plane.
fn occupied(stack: &Stack, module: &Module, layer: Layer, place_mm: [f64; 2]) -> bool {
    let [post, window, _] = half_outlines_mm(stack);
    let within = |half: [f64; 2]| place_mm[0].abs() < half[0] && place_mm[1].abs() < half[1];
    match layer {
        Layer::Frame => {
            let is_open = |(axis, sign): (usize, f64)| sign * place_mm[axis] > window[axis];
            !within(window) && !module.frame_open.map(facing).is_some_and(is_open)
        }
        Layer::Pi | Layer::Adh | Layer::Fpc => true,
        Layer::Post => within(post),
        Layer::Bond => {
            let is_off = |(axis, sign, reach): (usize, f64, f64)| sign * place_mm[axis] > reach;
            within(post) && !bond_rest(stack, module).is_some_and(is_off)
        }
    }
}
