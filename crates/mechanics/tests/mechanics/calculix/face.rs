//! The eight-node face of a quadratic brick.

/// The nodes' places on the reference square, in a brick's order: corners, then middles of edges.
pub(crate) const NODES: [[f64; 2]; 8] =
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]];

/// Three points of Gauss's rule on [−1, 1] with their weights.
pub(crate) const GAUSS: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// A shape function's value and its derivatives along the square's two axes.
pub(crate) type Jet = [f64; 3];

/// The eight shape functions at a place of the reference square.
pub(crate) fn shapes([s, t]: [f64; 2]) -> [Jet; 8] {
    NODES.map(|[a, b]| {
        let (p, q) = (1.0 + a * s, 1.0 + b * t);
        if a == 0.0 {
            let arch = 1.0 - s * s;
            return [arch * q / 2.0, -s * q, arch * b / 2.0];
        }
        if b == 0.0 {
            let arch = 1.0 - t * t;
            return [p * arch / 2.0, a * arch / 2.0, -t * p];
        }
        let sum = a * s + b * t;
        [p * q * (sum - 1.0) / 4.0, a * q * (p + sum - 1.0) / 4.0, b * p * (q + sum - 1.0) / 4.0]
    })
}
