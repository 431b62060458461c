//! The page that shows a bridge: it hears each call, and makes it on a pipeline of its own.

use std::sync::mpsc::Receiver;

use super::super::*;
use crate::observer::{Observation, Observer, observe};
use tactpad_core::pipeline::NoProbe;

/// A page, which may not read for a while.
pub(super) struct Page {
    from: Receiver<Observation>,
    shadow: Option<Box<Pipeline>>,
    pub(super) is_stalled: bool,
}

impl Page {
    /// A page, and the bridge's end of it.
    pub(super) fn attached() -> (Option<Self>, Vec<Observer>) {
        let (observer, from) = observe();
        (Some(Self { from, shadow: None, is_stalled: false }), vec![observer])
    }

    /// Makes the calls that it was told.
    pub(super) fn take(&mut self) {
        if self.is_stalled {
            return;
        }
        while let Ok(observed) = self.from.try_recv() {
            match observed {
                Observation::Checkpoint { pipeline, .. } => self.shadow = Some(pipeline),
                Observation::Call { at, call } => {
                    let mut left = Some(call.as_call());
                    while let (Some(call), Some(shadow)) = (left, &mut self.shadow) {
                        left = shadow.apply(at, call, &mut NoProbe);
                    }
                }
            }
        }
    }

    /// Whether it stands as the bridge does, once it has heard all.
    pub(super) fn is_like(&mut self, live: &Pipeline) -> Result<(), String> {
        if self.is_stalled {
            return Ok(());
        }
        self.take();
        let Some(shadow) = &self.shadow else { return Err("it heard nothing".into()) };
        let of = |pipeline: &Pipeline| {
            let held: Vec<String> = pipeline.held().map(|level| format!("{level:?}")).collect();
            format!("{:?} {held:?} {:?} {:?}", pipeline.phase(), pipeline.health(), pipeline.contact())
        };
        let (shown, is) = (of(shadow), of(live));
        if shown == is { Ok(()) } else { Err(format!("{shown} for {is}")) }
    }
}
