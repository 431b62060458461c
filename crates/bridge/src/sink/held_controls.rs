//! The controls that readers of a log believe to be held.

use std::collections::BTreeMap;

use tactpad_core::pipeline::control::{Code, OutputDevice, OutputEvent};
use tactpad_core::time::StreamInstant;

/// The controls that are held, with their values, and when that was.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct HeldControls {
    held: BTreeMap<(OutputDevice, Code), i32>,
    at: StreamInstant,
}

impl HeldControls {
    /// Updates the held controls by `group`.
    pub(super) fn apply(&mut self, group: &[OutputEvent]) {
        for event in group {
            self.at = event.at;
            let control = (event.device, event.code);
            match event.code {
                Code::Relative(_) => {}
                Code::Key(_) | Code::Axis(_) if event.value == 0 => {
                    self.held.remove(&control);
                }
                Code::Key(_) | Code::Axis(_) => {
                    self.held.insert(control, event.value);
                }
            }
        }
    }

    /// The events that lead from here to `later`: releases first.
    pub(super) fn events_to(&self, later: &Self) -> Vec<OutputEvent> {
        let event =
            |(device, code): (OutputDevice, Code), value| OutputEvent { at: later.at, device, code, value };
        let released = self.held.keys().filter(|control| !later.held.contains_key(control));
        let pressed = later.held.iter().filter(|(control, value)| self.held.get(control) != Some(value));
        released
            .map(|control| event(*control, 0))
            .chain(pressed.map(|(control, value)| event(*control, *value)))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_from_one_state_to_another_releases_first_and_says_nothing_twice() {
        let event = |code, value, t_us| OutputEvent {
            at: StreamInstant::from_us(t_us),
            device: OutputDevice::Gamepad,
            code,
            value,
        };
        let [hat, south, east] = [Code::Axis(16), Code::Key(0x130), Code::Key(0x131)];
        let mut controls = HeldControls::default();
        controls.apply(&[event(hat, 1, 1), event(south, 1, 1), event(Code::Relative(0), 5, 1)]);
        let before = controls.clone();
        assert_eq!(before.events_to(&controls), []);
        controls.apply(&[event(south, 0, 2), event(hat, -1, 2), event(east, 1, 2)]);
        controls.apply(&[event(east, 0, 3), event(east, 1, 4)]);
        let way = before.events_to(&controls);
        assert_eq!(way, [event(south, 0, 4), event(east, 1, 4), event(hat, -1, 4)]);
        let mut there = before;
        there.apply(&way);
        assert_eq!(there, controls);
    }
}
