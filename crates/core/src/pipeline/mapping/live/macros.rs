//! Macros that are playing.

use super::stated::StepOutput;
use crate::pipeline::mapping::profile::{MACROS_MAX, Macro};
use crate::time::StreamInstant;

/// Since when each macro plays.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct MacroPlayback {
    since: [Option<StreamInstant>; MACROS_MAX],
}

impl MacroPlayback {
    /// Lets those begin that `stated` says, and states what all press at `t`. A macro that plays does not begin anew, and has all its
    /// controls for its own, so that what the fingers do meanwhile does not get among its steps.
    pub(crate) fn step(&mut self, macros: &[Macro], t: StreamInstant, stated: &mut StepOutput) {
        for ((it, since), begun) in macros.iter().zip(&mut self.since).zip(stated.begun) {
            if begun {
                since.get_or_insert(t);
            }
            let Some(begin) = *since else { continue };
            let step = it.steps.iter().find(|step| t.us_since(begin) < step.until_us);
            let Some(step) = step else {
                *since = None;
                continue;
            };
            it.steps.iter().filter_map(|step| step.keys.as_ref()).for_each(|keys| stated.free(keys));
            step.keys.iter().flat_map(|keys| keys.iter()).for_each(|binding| stated.state(binding));
        }
    }
}
