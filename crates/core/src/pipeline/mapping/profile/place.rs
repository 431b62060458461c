//! Meaning of the contact's place in a profile: directions, the pointer's way, zones, and how far each side counts.

use super::angle::wrapped;
use super::keys::Keys;
use crate::quantity::Contact;

/// How the directions divide the plate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DpadMode {
    /// Four sectors of 90°.
    FourWay,
    /// Four sectors; between them, on the diagonals, the last direction stays.
    FourWaySticky,
    /// Eight sectors; a diagonal holds two directions.
    EightWay,
}

/// Directions from the place of the contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dpad {
    /// How the directions divide the plate.
    pub mode: DpadMode,
    /// A direction starts at this distance from the centre or farther.
    pub centre_radius_mm: f32,
    /// It ends closer than `centre_radius_mm − radius_hysteresis_mm`.
    pub radius_hysteresis_mm: f32,
    /// Angle of each diagonal zone. The 8-way mode holds two directions there, the sticky 4-way mode keeps the
    /// last one; the plain 4-way mode has no such zones.
    pub diagonal_deg: f32,
    /// A direction changes only when the contact is this far past the sector's edge. 0 in the sticky 4-way
    /// mode, whose diagonal zones are its hysteresis.
    pub hysteresis_deg: f32,
    /// The same along the arc at the contact's distance from the centre; the larger of the two counts, and half of the
    /// neighbouring zone at most. 0 in the sticky 4-way mode.
    pub hysteresis_mm: f32,
    /// Turns the sectors counter-clockwise seen from above.
    pub rotation_deg: f32,
    /// A direction starts at this normal force or more.
    pub min_force_n: f32,
    /// It ends below this normal force.
    pub release_force_n: f32,
    /// Up.
    pub up: Keys,
    /// Down.
    pub down: Keys,
    /// Left.
    pub left: Keys,
    /// Right.
    pub right: Keys,
}

/// How a contact moves the pointer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointerMode {
    /// Like a joystick: the place of the contact is a velocity.
    Relative,
    /// Like a tablet: the place of the contact is a place of the screen, and `full_radius_mm` from the centre is its edge.
    Absolute,
}

/// The pointer, moved by the place of the contact. What is said of speeds counts where the mode is relative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pointer {
    /// How it is moved.
    pub mode: PointerMode,
    /// Up to this distance from the centre the pointer rests.
    pub centre_radius_mm: f32,
    /// From this distance on it has its full speed; more than `centre_radius_mm`.
    pub full_radius_mm: f32,
    /// The full speed, at most [`POINTER_SPEED_MAX`](super::POINTER_SPEED_MAX).
    pub speed_counts_per_s: f32,
    /// Between the two distances the speed grows with this power of the part of the way.
    pub curve: f32,
    /// It starts to move at this normal force or more.
    pub min_force_n: f32,
    /// It rests below this normal force.
    pub release_force_n: f32,
}

/// By how much farther than it is a contact counts to each side, for a hand that does not reach as far everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gain {
    /// To the right.
    pub right: f32,
    /// To the left.
    pub left: f32,
    /// Upwards.
    pub up: f32,
    /// Downwards.
    pub down: f32,
}

impl Gain {
    /// As it is.
    pub const ONE: Self = Self { right: 1.0, left: 1.0, up: 1.0, down: 1.0 };

    /// The place that counts as this one.
    pub fn undone(&self, [x_mm, y_mm]: [f32; 2]) -> (f32, f32) {
        let x_gain = if x_mm < 0.0 { self.left } else { self.right };
        let y_gain = if y_mm < 0.0 { self.down } else { self.up };
        (x_mm / x_gain, y_mm / y_gain)
    }

    /// The contact with its place stretched.
    pub fn applied(&self, contact: &Contact) -> Contact {
        let x_gain = if contact.x_mm < 0.0 { self.left } else { self.right };
        let y_gain = if contact.y_mm < 0.0 { self.down } else { self.up };
        Contact { x_mm: x_gain * contact.x_mm, y_mm: y_gain * contact.y_mm, ..*contact }
    }
}

/// A part of the plate: a sector, a ring, or a part of a ring.
#[derive(Clone, Debug, PartialEq)]
pub struct Zone {
    /// The name by which buttons ask for it.
    pub name: String,
    /// Its middle, counter-clockwise from right.
    pub middle_deg: f32,
    /// How far it reaches to both sides of that; 180 for a ring.
    pub half_width_deg: f32,
    /// It begins at this distance from the centre
    pub inner_radius_mm: f32,
    /// and ends before this one.
    pub outer_radius_mm: f32,
    /// While it is held it reaches so much farther to both sides,
    pub hysteresis_deg: f32,
    /// or so far along the arc, whichever is more; but no farther than half of the narrowest other zone.
    pub hysteresis_mm: f32,
    /// See [`Self::hysteresis_mm`].
    pub hysteresis_max_deg: f32,
    /// While it is held it reaches so far inwards and outwards.
    pub radius_hysteresis_mm: f32,
}

impl Zone {
    /// Whether it holds a place when it reaches so much farther in and out, and to both sides.
    pub(crate) fn holds(&self, radius_mm: f32, slack_mm: f32, angle_deg: f32, slack_deg: f32) -> bool {
        let is_in_ring =
            radius_mm >= self.inner_radius_mm - slack_mm && radius_mm < self.outer_radius_mm + slack_mm;
        is_in_ring && wrapped(angle_deg - self.middle_deg).abs() <= self.half_width_deg + slack_deg
    }
}

/// Where a button counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ButtonPlace {
    /// In the zone of this number.
    Zone(usize),
    /// While the D-pad holds this direction.
    Direction(Direction),
}

/// A direction of the D-pad.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Up.
    Up,
    /// Down.
    Down,
    /// Left.
    Left,
    /// Right.
    Right,
}

impl Direction {
    /// All, in the order in which a profile has them.
    pub const ALL: [Self; 4] = [Self::Up, Self::Down, Self::Left, Self::Right];
    /// How a profile writes them.
    pub const NAMES: [&'static str; 4] =
        [Self::Up.name(), Self::Down.name(), Self::Left.name(), Self::Right.name()];

    /// How a profile writes it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Up => "up",
            Self::Down => "down",
            Self::Left => "left",
            Self::Right => "right",
        }
    }
}
