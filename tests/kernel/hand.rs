//! A finger that stays where it was put while the test looks elsewhere.

use std::sync::mpsc::{Sender, TryRecvError, channel};
use std::thread;

use crate::pad::{NONE, Pad, Touch};

/// How long the pad streams before it is looked at whether the finger is elsewhere now.
const STEP_MS: u64 = 2;

/// Whoever moves the finger. The pad is pulled out when this value goes.
pub(crate) struct Hand(Sender<Touch>);

impl Hand {
    /// Lets `pad` stream on a thread of its own: looking at a screen takes so long that the bridge would take the pad
    /// for dead.
    pub(crate) fn on(mut pad: Pad) -> Self {
        let (sender, touches) = channel();
        thread::spawn(move || {
            let mut touch = NONE;
            loop {
                match touches.try_recv() {
                    Ok(next) => touch = next,
                    Err(TryRecvError::Empty) => pad.hold(touch, STEP_MS),
                    Err(TryRecvError::Disconnected) => return,
                }
            }
        });
        Self(sender)
    }

    /// Puts the finger there.
    pub(crate) fn put(&self, touch: Touch) {
        self.0.send(touch).expect("the pad still streams");
    }
}
