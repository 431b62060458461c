//! What controls do in the game, as a person named it: "jump".

use super::action::Role;
use super::axes::Side;
use super::place::Direction;

/// A part of a profile that a person can name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Labelled {
    /// A direction of the D-pad.
    Direction(Direction),
    /// A kind of press of a button, which is counted from 0.
    Press(usize, Role),
    /// A stick of the gamepad.
    Stick(Side),
    /// A trigger of the gamepad.
    Trigger(Side),
}

/// The names that a person gave to parts of a profile. Play knows nothing of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Labels(Vec<(Labelled, String)>);

impl Labels {
    /// Names a part, if there is a name.
    pub(crate) fn add(&mut self, part: Labelled, label: Option<&str>) {
        self.0.extend(label.map(|label| (part, label.trim().to_owned())));
    }

    /// The name of a part.
    pub fn of(&self, part: Labelled) -> Option<&str> {
        self.0.iter().find(|(it, _)| *it == part).map(|(_, label)| label.as_str())
    }
}
