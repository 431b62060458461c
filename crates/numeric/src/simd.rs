//! Loops with the widest vectors that the processor has.
//!
//! A loop is compiled once more for processors that have more than every processor of its kind, and the one that fits is run.
//! Neither the order of a sum changes by that nor the rounding of a product, so the numbers are the same, bit by bit.

/// Runs the work so. What is to gain by it has to be inlined into it.
#[cfg(feature = "wide")]
#[inline]
pub fn widest<R>(work: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(work)
}

/// Runs the work as it is: the live core works on vectors that are too short to gain.
#[cfg(not(feature = "wide"))]
#[inline]
pub fn widest<R>(work: impl FnOnce() -> R) -> R {
    work()
}
