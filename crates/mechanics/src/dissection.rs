//! Nested dissection of a grid's nodes by planes: an elimination order that keeps a sparse factor small.
//!
//! Source: A. George, Nested dissection of a regular finite element mesh, SIAM J. Numer. Anal. 10 (1973) 345.

/// Largest group of nodes that is not cut further.
const LEAF_NODES: usize = 60;

/// The nodes in elimination order.
///
/// `lattice` has even coordinates on grid planes and odd ones between them, so that the nodes on a grid plane part
/// the elements on its two sides. Every index from 0 to `lattice.len()` comes once.
pub(super) fn elimination_order(lattice: &[[usize; 3]], nodes: Vec<usize>) -> Vec<usize> {
    let mut order = Vec::with_capacity(nodes.len());
    dissect(lattice, nodes, &mut order);
    order
}

fn dissect(lattice: &[[usize; 3]], nodes: Vec<usize>, order: &mut Vec<usize>) {
    let cut = if nodes.len() <= LEAF_NODES { None } else { best_cut(lattice, &nodes) };
    let Some((axis, plane)) = cut else {
        order.extend(nodes);
        return;
    };
    let side = |node: &usize| lattice[*node][axis].cmp(&plane);
    let (below, rest): (Vec<_>, Vec<_>) = nodes.into_iter().partition(|node| side(node).is_lt());
    let (above, separator): (Vec<_>, Vec<_>) = rest.into_iter().partition(|node| side(node).is_gt());
    dissect(lattice, below, order);
    dissect(lattice, above, order);
    order.extend(separator);
}

/// The axis and grid plane that cut the nodes at their median with the fewest nodes on the plane.
fn best_cut(lattice: &[[usize; 3]], nodes: &[usize]) -> Option<(usize, usize)> {
    let cuts = (0..3).filter_map(|axis| {
        let plane = median_plane(lattice, nodes, axis)?;
        let on_plane = nodes.iter().filter(|node| lattice[**node][axis] == plane).count();
        Some((on_plane, axis, plane))
    });
    cuts.min().map(|(_, axis, plane)| (axis, plane))
}

/// The grid plane next to the median that has nodes on both sides.
fn median_plane(lattice: &[[usize; 3]], nodes: &[usize], axis: usize) -> Option<usize> {
    let mut places: Vec<usize> = nodes.iter().map(|node| lattice[*node][axis]).collect();
    let (least, greatest) = (*places.iter().min()?, *places.iter().max()?);
    let middle = places.len() / 2;
    let (_, median, _) = places.select_nth_unstable(middle);
    let plane = *median / 2 * 2;
    [plane, plane + 2].into_iter().find(|plane| *plane > least && *plane < greatest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(cells: usize) -> Vec<[usize; 3]> {
        let side = 2 * cells + 1;
        let all = (0..side * side * side).map(|k| [k % side, k / side % side, k / side / side]);
        all.filter(|at| at.iter().filter(|c| *c % 2 == 1).count() <= 1).collect()
    }

    #[test]
    fn every_node_comes_once() {
        let lattice = cube(8);
        let mut order = elimination_order(&lattice, (0..lattice.len()).collect());
        order.sort_unstable();
        assert!(order.into_iter().eq(0..lattice.len()));
    }

    #[test]
    fn the_last_nodes_are_a_plane_that_parts_the_rest() {
        let lattice = cube(8);
        let order = elimination_order(&lattice, (0..lattice.len()).collect());
        let last = lattice[order[order.len() - 1]];
        let axis = (0..3).find(|axis| last[*axis] == 8).unwrap();
        let plane = lattice.iter().filter(|at| at[axis] == 8).count();
        assert!(order[order.len() - plane..].iter().all(|node| lattice[*node][axis] == 8));
    }
}
