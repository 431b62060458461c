//! Keys that killed bridges left down on X servers: told, and lifted.

use super::runtime;
use crate::cli::printing::written::say;
use tactpad::bridge::sink::x11::{LeftDown, Treatment, left_down};

/// What was left, as far as records say.
pub(super) fn found() -> Vec<LeftDown> {
    runtime::folder().map(|folder| left_down(&folder, Treatment::Look)).unwrap_or_default()
}

/// Lifts what was left, and tells what that was. Whether something was lifted.
pub(super) fn lift() -> bool {
    // Where there is no folder for records, there are none.
    let left = runtime::folder().map(|folder| left_down(&folder, Treatment::Lift)).unwrap_or_default();
    let mut is_lifted = false;
    for what in left {
        if matches!(what, LeftDown::Held { .. }) {
            is_lifted = true;
            say(format_args!("{what}: released"));
        } else {
            say(what);
        }
    }
    is_lifted
}
