//! The program's own mesh, solved once for all tests of this program: most of their devices differ in one module.

use std::sync::{LazyLock, Mutex};

use tactpad_mechanics::mesh::Fineness;
use tactpad_mechanics::simulator::Simulator;

/// Solved modules stay with it.
pub(crate) static SIMULATOR: LazyLock<Mutex<Simulator>> =
    LazyLock::new(|| Mutex::new(Simulator::new(Fineness::STANDARD)));
