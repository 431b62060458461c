//! What one step of the engine states: levels, a layer, macros that begin, commands.

use arrayvec::ArrayVec;

use super::intent::{Intents, Level};
use crate::pipeline::control::names::{POINTER_MOTION, POINTER_PLACE};
use crate::pipeline::control::{Code, OutputDevice};
use crate::pipeline::mapping::live::button::effect::Playing;
use crate::pipeline::mapping::live::contact::pointer::{PointerOutput, Velocity};
use crate::pipeline::mapping::profile::{Binding, Command, Keys, MACROS_MAX, Output};

/// The most commands of one step.
pub const COMMANDS_MAX: usize = 4;

/// What presses ask of the bridge, in their order.
pub type Commands = ArrayVec<Command, COMMANDS_MAX>;

/// What one step states, while it is collected.
#[derive(Default)]
pub(crate) struct StepOutput {
    pub(crate) levels: Intents,
    pub(crate) layer: Option<usize>,
    pub(crate) begun: [bool; MACROS_MAX],
    pub(crate) commands: Commands,
}

impl StepOutput {
    /// Takes up what is on. Of several layers the last one counts.
    pub(crate) fn take(&mut self, Playing { output, begins }: Playing) {
        match output {
            Output::Keys(keys) => keys.iter().for_each(|binding| self.state(binding)),
            Output::Layer(number) => self.layer = Some(number),
            Output::Macro(number) if begins => {
                self.begun.get_mut(number).into_iter().for_each(|begun| *begun = true);
            }
            // More at once than there is room for: nobody has so many fingers.
            Output::Bridge(command) if begins => {
                let _ = self.commands.try_push(command);
            }
            Output::Macro(_) | Output::Bridge(_) => {}
        }
    }

    /// Adds a level. A control that is stated already keeps its first value: each control stands there once.
    pub(crate) fn state(&mut self, Binding { device, code, value }: Binding) {
        if self.levels.iter().all(|stated| (stated.device, stated.code) != (device, code)) {
            // A profile has at most CONTROLS_MAX controls, so there is always room.
            let _ = self.levels.try_push(Level { device, code, value });
        }
    }

    /// Adds the position of an axis; at rest it needs none.
    pub(crate) fn state_axis(&mut self, code: Code, value: i32) {
        if value != 0 {
            self.state(Binding { device: OutputDevice::Gamepad, code, value });
        }
    }

    /// Takes keys out that a macro has for its own.
    pub(crate) fn free(&mut self, keys: &Keys) {
        self.levels.retain(|level| !keys.iter().any(|it| (it.device, it.code) == (level.device, level.code)));
    }

    /// Adds the pointer's way, or its place.
    pub(crate) fn state_motion(&mut self, steered: Option<PointerOutput>) {
        let (device, codes, values) = match steered {
            None => return,
            Some(PointerOutput::Moving(Velocity { right, down })) => {
                (OutputDevice::Pointer, POINTER_MOTION, [right, down])
            }
            Some(PointerOutput::At(place)) => (OutputDevice::Tablet, POINTER_PLACE, place),
        };
        for (code, value) in codes.into_iter().zip(values).filter(|(_, value)| *value != 0) {
            self.state(Binding { device, code, value });
        }
    }
}
