//! The marks of the plate that a known weight is put on, one after the other.

/// Their places, in the order in which they are used.
pub const MARKS_MM: [[f64; 2]; 5] = [[0.0, 0.0], [15.0, 0.0], [-15.0, 0.0], [0.0, 15.0], [0.0, -15.0]];

/// What people call them.
pub const MARK_NAMES: [&str; MARKS_MM.len()] = ["the middle", "right", "left", "top", "bottom"];
