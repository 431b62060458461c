//! The eight sectors of the plate that mean directions.

use super::angle::wrapped;
use super::{Direction, Dpad, DpadMode};

/// One of eight directions, counted in steps of 45° counter-clockwise from right; odd ones are diagonals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Sector(pub(crate) u8);

/// The horizontal part of a sector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Horizontal {
    Left,
    Right,
}

/// The vertical part of a sector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Vertical {
    Up,
    Down,
}

impl Sector {
    pub(crate) const RIGHT: Self = Self(0);
    pub(crate) const UP: Self = Self(2);
    pub(crate) const LEFT: Self = Self(4);
    pub(crate) const DOWN: Self = Self(6);

    /// Left or right, if the sector has either.
    pub(crate) const fn horizontal(self) -> Option<Horizontal> {
        match self.0 {
            0 | 1 | 7 => Some(Horizontal::Right),
            3..=5 => Some(Horizontal::Left),
            _ => None,
        }
    }

    /// Up or down, if the sector has either.
    pub(crate) const fn vertical(self) -> Option<Vertical> {
        match self.0 {
            1..=3 => Some(Vertical::Up),
            5..=7 => Some(Vertical::Down),
            _ => None,
        }
    }

    /// Whether it holds this direction.
    pub(crate) fn has(self, direction: Direction) -> bool {
        match direction {
            Direction::Left => self.horizontal() == Some(Horizontal::Left),
            Direction::Right => self.horizontal() == Some(Horizontal::Right),
            Direction::Up => self.vertical() == Some(Vertical::Up),
            Direction::Down => self.vertical() == Some(Vertical::Down),
        }
    }

    /// Whether it lies between two directions.
    pub(crate) const fn is_diagonal(self) -> bool {
        self.0 % 2 == 1
    }

    /// The next one counter-clockwise.
    pub(crate) const fn next(self) -> Self {
        Self((self.0 + 1) % 8)
    }

    /// Degrees, 0 to 180, between `angle_deg` and the middle of this sector.
    pub(crate) fn distance_deg(self, angle_deg: f32) -> f32 {
        wrapped(angle_deg - 45.0 * f32::from(self.0)).abs()
    }

    /// The right, upper, left or lower quarter of the plate; exactly on a diagonal it is right or left.
    pub(crate) fn nearest_cardinal(angle_deg: f32) -> Self {
        if Self::RIGHT.distance_deg(angle_deg) <= 45.0 {
            Self::RIGHT
        } else if Self::LEFT.distance_deg(angle_deg) <= 45.0 {
            Self::LEFT
        } else if Self::UP.distance_deg(angle_deg) < 90.0 {
            Self::UP
        } else {
            Self::DOWN
        }
    }

    fn nearest_diagonal(angle_deg: f32) -> Self {
        let right = Self::RIGHT.distance_deg(angle_deg) < 90.0;
        let up = Self::UP.distance_deg(angle_deg) < 90.0;
        match (right, up) {
            (true, true) => Self(1),
            (false, true) => Self(3),
            (false, false) => Self(5),
            (true, false) => Self(7),
        }
    }
}

/// The zone that holds the angle; edges belong to the cardinal zone.
pub(crate) fn sector_at(dpad: &Dpad, angle_deg: f32) -> Sector {
    let cardinal = Sector::nearest_cardinal(angle_deg);
    if cardinal.distance_deg(angle_deg) <= half_width_deg(dpad, cardinal) {
        cardinal
    } else {
        Sector::nearest_diagonal(angle_deg)
    }
}

/// The parts of the plate, counter-clockwise from right: where each begins and ends, in degrees, and whether it holds a direction. In a
/// diagonal part of the sticky mode the last direction stays.
pub(crate) fn parts(dpad: &Dpad) -> impl Iterator<Item = (f32, f32, impl Fn(Direction) -> bool)> + '_ {
    let step = if dpad.mode == DpadMode::FourWay { 2 } else { 1 };
    (0..8).step_by(step).map(Sector).map(|sector| {
        let middle_deg = 45.0 * f32::from(sector.0) + dpad.rotation_deg;
        let half_deg = half_width_deg(dpad, sector);
        let stays = dpad.mode == DpadMode::FourWaySticky && sector.is_diagonal();
        (middle_deg - half_deg, middle_deg + half_deg, move |direction| !stays && sector.has(direction))
    })
}

/// Half of the angle that a sector spans, in degrees.
pub(crate) fn half_width_deg(dpad: &Dpad, sector: Sector) -> f32 {
    match (dpad.mode, sector.is_diagonal()) {
        (DpadMode::FourWay, _) => 45.0,
        (_, true) => dpad.diagonal_deg / 2.0,
        (_, false) => 45.0 - dpad.diagonal_deg / 2.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_of_a_sector() {
        let shown = |k: u8| (Sector(k).horizontal(), Sector(k).vertical());
        assert_eq!(shown(0), (Some(Horizontal::Right), None));
        assert_eq!(shown(1), (Some(Horizontal::Right), Some(Vertical::Up)));
        assert_eq!(shown(2), (None, Some(Vertical::Up)));
        assert_eq!(shown(3), (Some(Horizontal::Left), Some(Vertical::Up)));
        assert_eq!(shown(4), (Some(Horizontal::Left), None));
        assert_eq!(shown(5), (Some(Horizontal::Left), Some(Vertical::Down)));
        assert_eq!(shown(6), (None, Some(Vertical::Down)));
        assert_eq!(shown(7), (Some(Horizontal::Right), Some(Vertical::Down)));
    }
}
