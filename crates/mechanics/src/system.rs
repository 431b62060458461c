//! The linear system of a mesh's free nodes: sparse assembly, Cholesky factorisation, loads of given displacements.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, Mat, Par, Side};

use super::brick::{DOFS, Stiffness, forces};
use super::dissection::elimination_order;
use super::mesh::{Brick, Mesh};

/// Why a stiffness could not be factorised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SolveError {
    /// The memory for the factor is not there.
    OutOfMemory,
    /// The stiffness is not positive definite: something is loose, or a number is far off.
    NotPositive,
    /// The natural frequencies did not settle.
    NotSettled,
}

impl std::fmt::Display for SolveError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::OutOfMemory => "the memory for the factorised stiffness is not there",
            Self::NotPositive => {
                "the stiffness is not positive definite: a part is loose or a number far off"
            }
            Self::NotSettled => "the natural frequencies did not settle",
        })
    }
}

impl std::error::Error for SolveError {}

/// The nodes of a mesh whose displacement is unknown, in elimination order.
pub struct DegreesOfFreedom {
    /// Position of each node in the order; `None` where the displacement is given.
    position: Vec<Option<usize>>,
    count: usize,
}

impl DegreesOfFreedom {
    /// All nodes but those whose displacement is given.
    pub fn new(mesh: &Mesh, is_given: impl Fn(usize) -> bool) -> Self {
        let free = (0..mesh.lattice.len()).filter(|node| !is_given(*node)).collect();
        let order = elimination_order(&mesh.lattice, free);
        let mut position = vec![None; mesh.lattice.len()];
        for (place, node) in order.iter().enumerate() {
            position[*node] = Some(place);
        }
        Self { position, count: order.len() }
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        3 * self.count
    }

    /// The first of a node's three unknowns; `None` where the displacement is given.
    pub fn first(&self, node: usize) -> Option<usize> {
        self.position[node].map(|place| 3 * place)
    }
}

/// Displacements of a brick's nodes, x y z within a node.
pub fn gathered(brick: &Brick, displacement: impl Fn(usize) -> [f64; 3]) -> [f64; DOFS] {
    let nodes = brick.nodes.map(displacement);
    std::array::from_fn(|dof| nodes[dof / 3][dof % 3])
}

/// Adds the forces on the free nodes that hold given displacements of the others: −K_fg u_g.
///
/// `bricks` are those that have a given node that moves; `given` is the displacement of a given node, and zero at a free
/// one.
pub fn add_holding_forces<'m>(
    bricks: impl Iterator<Item = &'m Brick>,
    freedoms: &DegreesOfFreedom,
    stiffness_of: impl Fn(&Brick) -> Box<Stiffness>,
    given: impl Fn(usize, usize) -> [f64; 3],
    right: &mut Mat<f64>,
) {
    for brick in bricks {
        let stiffness = stiffness_of(brick);
        for column in 0..right.ncols() {
            let held = forces(&stiffness, &gathered(brick, |node| given(node, column)));
            for (node, force) in brick.nodes.iter().zip(held.as_chunks::<3>().0) {
                let Some(first) = freedoms.first(*node) else { continue };
                for axis in 0..3 {
                    right[(first + axis, column)] -= force[axis];
                }
            }
        }
    }
}

/// The factorised stiffness of the free nodes.
pub struct Factor {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
}

impl Factor {
    /// Assembles and factorises.
    ///
    /// # Errors
    /// Not enough memory, or a stiffness that is not positive definite.
    pub fn of(
        mesh: &Mesh,
        freedoms: &DegreesOfFreedom,
        stiffness_of: impl Fn(&Brick) -> Box<Stiffness>,
    ) -> Result<Self, SolveError> {
        let lower = assemble(mesh, freedoms, stiffness_of);
        let pattern = lower.pattern.as_ref();
        // The unknowns are numbered in elimination order already. (`Identity` would take the upper triangle.)
        let natural: Vec<usize> = (0..freedoms.unknowns()).collect();
        let symbolic = factorize_symbolic_cholesky(
            pattern,
            Side::Lower,
            SymmetricOrdering::Custom(PermRef::new_checked(&natural, &natural, natural.len())),
            CholeskySymbolicParams::default(),
        )
        .map_err(|_| SolveError::OutOfMemory)?;
        let mut values = vec![0.0; symbolic.len_val()];
        let scratch = symbolic.factorize_numeric_llt_scratch::<f64>(parallelism(), Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| SolveError::OutOfMemory)?;
        symbolic
            .factorize_numeric_llt(
                &mut values,
                SparseColMatRef::new(pattern, &lower.values),
                Side::Lower,
                LltRegularization::default(),
                parallelism(),
                MemStack::new(&mut memory),
                Default::default(),
            )
            .map_err(|_| SolveError::NotPositive)?;
        Ok(Self { symbolic, values })
    }

    /// Solves in place, one right-hand side for each column.
    ///
    /// # Errors
    /// Not enough memory.
    pub fn solve(&self, right: &mut Mat<f64>) -> Result<(), SolveError> {
        let scratch = self.symbolic.solve_in_place_scratch::<f64>(right.ncols(), parallelism());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| SolveError::OutOfMemory)?;
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            right.as_mut(),
            parallelism(),
            MemStack::new(&mut memory),
        );
        Ok(())
    }

    /// Numbers in the factor: a measure of the memory.
    pub fn entries(&self) -> usize {
        self.values.len()
    }
}

/// All cores.
fn parallelism() -> Par {
    Par::rayon(0)
}

struct Lower {
    pattern: SymbolicSparseColMat<usize>,
    values: Vec<f64>,
}

/// The lower triangle of the free nodes' stiffness.
fn assemble(
    mesh: &Mesh,
    freedoms: &DegreesOfFreedom,
    stiffness_of: impl Fn(&Brick) -> Box<Stiffness>,
) -> Lower {
    let below = neighbours_below(mesh, freedoms);
    let pattern = lower_pattern(&below);
    let mut values = vec![0.0; pattern.row_idx().len()];
    for brick in &mesh.bricks {
        let stiffness = stiffness_of(brick);
        for (i, column_node) in brick.nodes.iter().enumerate() {
            let Some(column) = freedoms.position[*column_node] else { continue };
            for (j, row_node) in brick.nodes.iter().enumerate() {
                let Some(row) = freedoms.position[*row_node].filter(|row| *row >= column) else { continue };
                let rank = below[column].partition_point(|place| *place < row);
                add_block(&stiffness, [i, j], column, rank, pattern.col_ptr(), &mut values);
            }
        }
    }
    Lower { pattern, values }
}

/// Adds the 3 × 3 block that couples two nodes of a brick. `rank` is the row node's place among the column's nodes.
fn add_block(
    stiffness: &Stiffness,
    [i, j]: [usize; 2],
    column: usize,
    rank: usize,
    starts: &[usize],
    values: &mut [f64],
) {
    for a in 0..3 {
        // The column of axis a lacks the entries above its diagonal: `a` of them, all in the first block.
        let first = if rank == 0 { a } else { 0 };
        for b in first..3 {
            values[starts[3 * column + a] + 3 * rank + b - a] += stiffness[3 * i + a][3 * j + b];
        }
    }
}

/// For each free node, in elimination order: itself and the free nodes after it that share a brick with it, ascending.
fn neighbours_below(mesh: &Mesh, freedoms: &DegreesOfFreedom) -> Vec<Vec<usize>> {
    let mut below: Vec<Vec<usize>> = vec![Vec::new(); freedoms.count];
    for brick in &mesh.bricks {
        let places: Vec<usize> = brick.nodes.iter().filter_map(|node| freedoms.position[*node]).collect();
        for column in &places {
            below[*column].extend(places.iter().filter(|row| *row >= column));
        }
    }
    for rows in &mut below {
        rows.sort_unstable();
        rows.dedup();
    }
    below
}

fn lower_pattern(below: &[Vec<usize>]) -> SymbolicSparseColMat<usize> {
    let unknowns = 3 * below.len();
    let (mut starts, mut rows) = (vec![0], Vec::new());
    for places in below {
        for axis in 0..3 {
            let entries = places.iter().flat_map(|place| (0..3).map(move |b| 3 * place + b));
            rows.extend(entries.skip(axis));
            starts.push(rows.len());
        }
    }
    SymbolicSparseColMat::new_checked(unknowns, unknowns, starts, None, rows)
}
