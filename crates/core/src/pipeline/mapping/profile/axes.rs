//! Sticks and triggers of the gamepad, and by which numbers they follow the contact.

use super::place::ButtonPlace;
use crate::pipeline::control::Code;
use crate::pipeline::control::names::{STICKS, TRIGGERS};

/// So many sticks has a gamepad, and so many triggers.
pub const SIDES: usize = STICKS.len();

/// Which of the gamepad's two sticks or triggers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The left one.
    Left,
    /// The right one.
    Right,
}

/// Quantity that moves a stick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The place of the contact; its numbers are in millimetres from the centre.
    Place,
    /// The shear; its numbers are in newtons.
    Shear,
}

/// A stick of the gamepad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stick {
    /// Which one.
    pub side: Side,
    /// Quantity that moves it.
    pub source: Source,
    /// Up to here it rests,
    pub rest: f32,
    /// and from here on it is at its end; more than `rest`.
    pub full: f32,
    /// In between it goes with this power of the part of the way.
    pub curve: f32,
    /// It starts at this normal force or more.
    pub min_force_n: f32,
    /// It rests below this normal force.
    pub release_force_n: f32,
}

/// A trigger of the gamepad, moved by the normal force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trigger {
    /// Which one.
    pub side: Side,
    /// Up to this force it rests,
    pub from_n: f32,
    /// and from this one on it is at its end; more than `from_n`.
    pub full_n: f32,
    /// In between it goes with this power of the part of the way.
    pub curve: f32,
    /// Where it counts; everywhere if that is not said.
    pub place: Option<ButtonPlace>,
}

impl Stick {
    /// Its axes: to the right, and down.
    pub fn axes(&self) -> [Code; 2] {
        let [left, right] = STICKS;
        if self.side == Side::Left { left } else { right }
    }
}

impl Trigger {
    /// Its axis.
    pub fn axis(&self) -> Code {
        let [left, right] = TRIGGERS;
        if self.side == Side::Left { left } else { right }
    }
}
