//! The bridge is paused as long as this is there, so that presses of a calibration press nothing in a game.

use std::sync::Arc;

use tactpad_bridge::request::{Asker, Request};

/// A pause.
pub(super) struct Pause {
    asker: Arc<Asker>,
    /// The player had paused already, and goes on when he wants to.
    was_paused: bool,
}

impl Pause {
    /// Pauses the bridge.
    ///
    /// # Errors
    /// It has ended.
    pub(super) fn begin(asker: &Arc<Asker>, was_paused: bool) -> Result<Self, String> {
        asker.ask(Request::Pause).map_err(|_| "the bridge has ended: start it again")?;
        Ok(Self { asker: Arc::clone(asker), was_paused })
    }

    /// Pauses it again after somebody let it go on.
    pub(super) fn again(&self) {
        // A bridge that has ended presses nothing.
        let _ = self.asker.ask(Request::Pause);
    }
}

impl Drop for Pause {
    fn drop(&mut self) {
        if !self.was_paused {
            let _ = self.asker.ask(Request::Resume);
        }
    }
}
