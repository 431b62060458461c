//! Ordinary play: directions and buttons of a profile, as a thumb that only roughly knows where they are gives them.

use std::f32::consts::FRAC_1_SQRT_2;

use super::course::{FORCE_MAX_N, GestureHistory, Move, WITHIN_MM};
use super::draw::{Draw, at, microseconds, towards, within};
use crate::pipeline::contact::touch;
use crate::pipeline::mapping::profile::{Action, Button, ButtonPlace, Direction, DpadMode, Force, Profile};
use crate::quantity::Contact;
use crate::virtual_pad::script::Script;

/// How far a thumb lands from where a direction is meant, and from the middle, along each axis.
const AIM_MM: f32 = 3.0;
const AIM_MIDDLE_MM: f32 = 2.0;
/// Deviation of a force's logarithm from press to press.
const FORCE_SPREAD: f32 = 0.25;
/// The thumb's own way of dragging: shear as a share of the normal force, and its scatter along each axis.
const DRAG_SHARE: [f32; 2] = [0.02, 0.12];
const DRAG_SPREAD: f32 = 0.04;
/// Beside that it pushes outwards where it reaches far: of the normal force at the rim of its reach.
const REACH_SHARE: f32 = 0.08;
/// What a thumb does, in shares: a direction, a button, a button while a direction is held; the rest lies in the middle.
const DIRECTION_SHARE: f32 = 0.5;
const BUTTON_SHARE: f32 = 0.3;
const BOTH_SHARE: f32 = 0.12;
/// How often a direction slides on into another one.
const SLIDE_SHARE: f32 = 0.35;
const SLIDES_MAX: usize = 3;
/// How often that is the opposite one, not a neighbour.
const OPPOSITE_SHARE: f32 = 0.25;
/// Presses and holds.
const HOLD_MS: [f32; 2] = [80.0, 1_500.0];
const TAP_MS: [f32; 2] = [80.0, 250.0];
const RAMP_MS: [f32; 2] = [30.0, 90.0];
const SLIDE_MS: [f32; 2] = [60.0, 220.0];
const PAUSE_MS: [f32; 2] = [80.0, 900.0];
/// Now and then the player looks on for a while.
const LOOK_SHARE: f32 = 0.06;
const LOOK_MS: [f32; 2] = [1_000.0, 3_000.0];

/// Play of `profile` for `duration_us`, with the thumb within `within_mm` of the plate's centre; the seed draws it.
///
/// Where the profile has no directions, the thumb plays places of the plate as if it had four.
pub fn play(profile: &Profile, duration_us: u64, within_mm: f32, seed: u64) -> Script {
    let mut draw = Draw::new(seed, "play");
    let mut course = GestureHistory::new(duration_us);
    let mut thumb = Thumb::new(profile, within_mm, &mut draw);
    loop {
        let pause_ms = if thumb.draw.chance(LOOK_SHARE) { LOOK_MS } else { PAUSE_MS };
        let pause_us = thumb.draw.us(pause_ms);
        let (moves, lift_us) = (thumb.touch(), thumb.draw.us(RAMP_MS));
        if !course.touch(pause_us, &moves, lift_us) {
            return course.script();
        }
    }
}

struct Thumb<'p> {
    profile: &'p Profile,
    draw: &'p mut Draw,
    within_mm: f32,
    /// Where it thinks that directions are.
    reach_mm: f32,
    /// Normal force that means a direction.
    light_n: f32,
    /// The shear that it always has, as a share of the normal force.
    drag: [f32; 2],
}

impl<'p> Thumb<'p> {
    fn new(profile: &'p Profile, within_mm: f32, draw: &'p mut Draw) -> Self {
        let (touch_n, centre_mm) = profile
            .dpad
            .as_ref()
            .map_or((touch::ON_N, 8.0), |dpad| (dpad.min_force_n.max(touch::ON_N), dpad.centre_radius_mm));
        let pressing = profile.buttons.iter().filter(|button| button.force == Force::Fz);
        let press_n = pressing.map(|button| button.press_n).fold(2.0, f32::min);
        let share = draw.between(DRAG_SHARE);
        let drag = towards(draw.between([0.0, 360.0])).map(|part| share * part);
        Self {
            profile,
            draw,
            within_mm,
            reach_mm: (0.5 * (centre_mm + WITHIN_MM)).min(within_mm),
            light_n: 0.5 * (1.5 * touch_n + 0.7 * press_n),
            drag,
        }
    }

    /// What it does next.
    fn touch(&mut self) -> Vec<Move> {
        let what = self.draw.between([0.0, 1.0]);
        let button = self.button();
        match button {
            _ if what < DIRECTION_SHARE => self.directions(),
            Some(button) if what < DIRECTION_SHARE + BUTTON_SHARE => self.press(button, None),
            Some(button) if what < DIRECTION_SHARE + BUTTON_SHARE + BOTH_SHARE => self.both(button),
            _ => {
                let place = self.aimed([0.0; 2], AIM_MIDDLE_MM);
                let force_n = self.force_n(self.light_n);
                vec![self.still(place, force_n, HOLD_MS)]
            }
        }
    }

    /// One of the profile's buttons.
    fn button(&mut self) -> Option<&'p Button> {
        let index = self.draw.index(self.profile.buttons.len());
        self.profile.buttons.get(index)
    }

    /// A direction, and perhaps others that it slides into.
    fn directions(&mut self) -> Vec<Move> {
        let step_deg = self.step_deg();
        let mut angle_deg = self.direction_deg();
        let force_n = self.force_n(self.light_n);
        let place = self.at_angle(angle_deg);
        let mut moves = vec![self.still(place, force_n, HOLD_MS)];
        while moves.len() <= SLIDES_MAX && self.draw.chance(SLIDE_SHARE) {
            let side = if self.draw.chance(0.5) { step_deg } else { -step_deg };
            angle_deg += if self.draw.chance(OPPOSITE_SHARE) { 180.0 } else { side };
            let place = self.at_angle(angle_deg);
            let slide = self.still(place, force_n, HOLD_MS);
            moves.push(Move { ramp_us: self.draw.us(SLIDE_MS), ..slide });
        }
        moves
    }

    /// A button's press; where it counts, or at `place`.
    fn press(&mut self, button: &Button, place: Option<[f32; 2]>) -> Vec<Move> {
        let (force_n, lasts_ms) = match button.action {
            Action::ByForce { hard_press_n, .. } if self.draw.chance(0.5) => (1.2 * hard_press_n, TAP_MS),
            Action::ByTime { hold: Some(hold), .. } if self.draw.chance(0.4) => {
                let hold_ms = 1e-3 * hold.us as f32;
                (1.4 * button.press_n, [1.1, 2.0].map(|factor| (factor * hold_ms).min(HOLD_MS[1])))
            }
            Action::Hold(_) => (1.4 * button.press_n, HOLD_MS),
            _ => (1.4 * button.press_n, TAP_MS),
        };
        let place = place.unwrap_or_else(|| self.place_of(button.place));
        let force_n = self.force_n(force_n);
        let mut still = self.still(place, force_n, lasts_ms);
        still.to = sheared(still.to, button.force, force_n);
        vec![still]
    }

    /// A direction, a button's press there, and the direction again.
    fn both(&mut self, button: &Button) -> Vec<Move> {
        let angle_deg = self.direction_deg();
        let (place, force_n) = (self.at_angle(angle_deg), self.force_n(self.light_n));
        let before = self.still(place, force_n, HOLD_MS);
        let press = self.press(button, Some(place));
        let after = Move { ramp_us: self.draw.us(RAMP_MS), stay_us: self.draw.us(TAP_MS), ..before };
        [vec![before], press, vec![after]].concat()
    }

    /// A contact at a place, and how long it stays.
    fn still(&mut self, place: [f32; 2], fz_n: f32, lasts_ms: [f32; 2]) -> Move {
        let outwards = place.map(|mm| REACH_SHARE * mm / self.reach_mm.max(1.0));
        let shear = [0, 1]
            .map(|axis: usize| fz_n * (self.drag[axis] + outwards[axis] + self.draw.normal(DRAG_SPREAD)));
        let stay_us = microseconds(self.draw.log_between(lasts_ms));
        Move { to: at(place, shear, fz_n), ramp_us: self.draw.us(RAMP_MS), stay_us }
    }

    fn force_n(&mut self, meant_n: f32) -> f32 {
        self.draw.log_normal(meant_n, FORCE_SPREAD).min(FORCE_MAX_N)
    }

    /// From one direction to the next.
    fn step_deg(&self) -> f32 {
        match self.profile.dpad.as_ref().map(|dpad| dpad.mode) {
            Some(DpadMode::EightWay) => 45.0,
            _ => 90.0,
        }
    }

    fn direction_deg(&mut self) -> f32 {
        let step_deg = self.step_deg();
        step_deg * self.draw.index((360.0 / step_deg) as usize) as f32
    }

    /// Where a direction is thought to be, as the profile is turned.
    fn at_angle(&mut self, angle_deg: f32) -> [f32; 2] {
        let rotation_deg = self.profile.dpad.as_ref().map_or(0.0, |dpad| dpad.rotation_deg);
        let place = towards(angle_deg + rotation_deg).map(|part| self.reach_mm * part);
        self.aimed(place, AIM_MM)
    }

    /// Where a button counts, roughly.
    fn place_of(&mut self, place: Option<ButtonPlace>) -> [f32; 2] {
        match place {
            None => self.aimed([0.0; 2], AIM_MIDDLE_MM),
            Some(ButtonPlace::Direction(direction)) => self.at_angle(match direction {
                Direction::Right => 0.0,
                Direction::Up => 90.0,
                Direction::Left => 180.0,
                Direction::Down => 270.0,
            }),
            Some(ButtonPlace::Zone(number)) => {
                let middle = self.profile.zones.get(number).map_or([0.0; 2], |zone| {
                    let is_disc = zone.half_width_deg >= 180.0 && zone.inner_radius_mm == 0.0;
                    let outer_mm = zone.outer_radius_mm.min(self.within_mm);
                    let radius_mm = if is_disc { 0.0 } else { 0.5 * (zone.inner_radius_mm + outer_mm) };
                    towards(zone.middle_deg).map(|part| radius_mm * part)
                });
                self.aimed(middle, AIM_MIDDLE_MM)
            }
        }
    }

    /// Where the thumb lands that goes for what counts as this place.
    fn aimed(&mut self, place: [f32; 2], miss_mm: f32) -> [f32; 2] {
        let (x_mm, y_mm) = self.profile.gain.undone(place);
        let [centre_x_mm, centre_y_mm] = self.profile.centre_mm;
        let landed =
            [x_mm + centre_x_mm + self.draw.normal(miss_mm), y_mm + centre_y_mm + self.draw.normal(miss_mm)];
        within(landed, self.within_mm)
    }
}

/// The contact as it presses a button of this force: shear needs a grip.
fn sheared(contact: Contact, force: Force, force_n: f32) -> Contact {
    let grip_n = (force_n / FRAC_1_SQRT_2).min(FORCE_MAX_N);
    match force {
        Force::Fz => contact,
        Force::FxPositive => Contact { fx_n: force_n, fz_n: grip_n, ..contact },
        Force::FxNegative => Contact { fx_n: -force_n, fz_n: grip_n, ..contact },
        Force::FyPositive => Contact { fy_n: force_n, fz_n: grip_n, ..contact },
        Force::FyNegative => Contact { fy_n: -force_n, fz_n: grip_n, ..contact },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::virtual_pad::fixture::shipped_profiles;

    #[test]
    fn it_plays_every_direction_and_presses_buttons() {
        for profile in shipped_profiles() {
            let script = play(&profile, 120_000_000, 26.0, 5);
            let contacts: Vec<_> =
                script.keyframes().iter().map(|it| it.contact).filter(|it| it.fz_n > 0.0).collect();
            let towards = |sign: f32, of: fn(&Contact) -> f32| {
                contacts.iter().filter(|it| sign * of(it) > 10.0).count()
            };
            for sign in [1.0, -1.0] {
                assert!(towards(sign, |it| it.x_mm) > 10 && towards(sign, |it| it.y_mm) > 10);
            }
            let press_n = profile.buttons[0].press_n;
            let hard = contacts.iter().filter(|it| it.fz_n > press_n).count();
            assert!(hard > 20 && hard < contacts.len() / 2, "{}: {hard}", profile.name);
            assert!(contacts.iter().all(|it| libm::hypotf(it.x_mm, it.y_mm) <= 26.001));
            assert!(script.keyframes()[0].at_us >= 1_000_000);
            assert_eq!(script, play(&profile, 120_000_000, 26.0, 5));
            assert_ne!(script, play(&profile, 120_000_000, 26.0, 6));
        }
    }

    #[test]
    fn it_stays_where_it_is_told_to() {
        let script = play(&shipped_profiles()[0], 60_000_000, 9.0, 1);
        assert!(script.keyframes().iter().all(|it| libm::hypotf(it.contact.x_mm, it.contact.y_mm) <= 9.001));
    }
}
