//! The bridge is paused as long as this is there, so that presses of a calibration press nothing in a game.

use std::sync::Arc;

use tactpad_bridge::request::{Request, RequestSender};

/// A pause.
pub(super) struct Pause {
    sender: Arc<RequestSender>,
    /// The player had paused already, and goes on when he wants to.
    was_paused: bool,
}

impl Pause {
    /// Pauses the bridge.
    ///
    /// # Errors
    /// It has ended.
    pub(super) fn begin(sender: &Arc<RequestSender>, was_paused: bool) -> Result<Self, String> {
        sender.send(Request::Pause).map_err(|_| "the bridge has ended: start it again")?;
        Ok(Self { sender: Arc::clone(sender), was_paused })
    }

    /// Pauses it again after somebody let it go on.
    pub(super) fn again(&self) {
        // A bridge that has ended presses nothing.
        let _ = self.sender.send(Request::Pause);
    }
}

impl Drop for Pause {
    fn drop(&mut self) {
        if !self.was_paused {
            let _ = self.sender.send(Request::Resume);
        }
    }
}
