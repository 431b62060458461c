//! The bridge is paused as long as a calibration listens, so that its presses press nothing in a game.

use std::sync::mpsc::Receiver;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use serde_json::Value;

use tactpad_bridge::request::{Request, RequestSender};
use tactpad_bridge::state::State;

/// The bridge has long answered when a session ends; one that has not is ending itself.
const ANSWER_LIMIT: Duration = Duration::from_secs(2);

/// A pause of the bridge, which lasts as long as one of its holds.
pub(super) struct Pause {
    sender: Arc<RequestSender>,
    holds: Mutex<Holds>,
}

#[derive(Default)]
struct Holds {
    count: usize,
    /// Gets the bridge's status before the first of them.
    before: Option<Receiver<String>>,
}

impl Pause {
    /// Nobody holds it yet.
    pub(super) fn new(sender: &Arc<RequestSender>) -> Arc<Self> {
        Arc::new(Self { sender: Arc::clone(sender), holds: Mutex::default() })
    }

    /// Pauses the bridge, unless it is paused by another hold.
    ///
    /// # Errors
    /// It has ended.
    pub(super) fn hold(self: &Arc<Self>) -> Result<PauseHold, String> {
        let mut holds = self.holds.lock().unwrap_or_else(PoisonError::into_inner);
        if holds.count == 0 {
            // Asked in the queue of requests, where an earlier session's end stands before it: what a page was told last may be older.
            let before = self.sender.send_for_reply(Request::Status);
            let paused = before.and_then(|before| self.sender.send(Request::Pause).map(|()| before));
            holds.before = Some(paused.map_err(|_| "the bridge has ended: start it again")?);
        }
        holds.count += 1;
        Ok(PauseHold(Arc::clone(self)))
    }
}

/// Holds a pause. The last one lets the bridge go on, unless the player had paused it before.
pub(super) struct PauseHold(Arc<Pause>);

impl PauseHold {
    /// Pauses the bridge again after somebody let it go on.
    pub(super) fn again(&self) {
        // A bridge that has ended presses nothing.
        let _ = self.0.sender.send(Request::Pause);
    }
}

impl Drop for PauseHold {
    fn drop(&mut self) {
        let mut holds = self.0.holds.lock().unwrap_or_else(PoisonError::into_inner);
        holds.count -= 1;
        if holds.count == 0 && !holds.before.take().is_some_and(|before| was_paused(&before)) {
            let _ = self.0.sender.send(Request::Resume);
        }
    }
}

/// Whether the status that comes here is that of a paused bridge.
fn was_paused(before: &Receiver<String>) -> bool {
    let status = before.recv_timeout(ANSWER_LIMIT).unwrap_or_default();
    let status: Value = serde_json::from_str(&status).unwrap_or_default();
    status["state"] == State::Paused.word()
}
