//! What the player does beyond pressing keys that follow the finger: zones, resting, hair triggers, stages, keys that stay down, and keys that
//! go down again and again.

use crate::pipeline::mapping::profile::{
    Action, Button, ButtonPlace, Direction, Dwell, Effect, Keys, Mode, Profile, Skip, TimedEffect, Zone,
};
use crate::virtual_pad::gesture::{Gesture, HeldKeys, Step};
use crate::virtual_pad::player::{
    ANGLE_SLACK_DEG, FORCE_ERROR, LONG_PRESS_MAX_US, PLACE_SLACK_MM, Player, RADIUS_MAX_MM, RAMP_US,
    SLACK_US, cardinal_half_deg, plain,
};

/// With less the noise of a force may be taken for an easing finger.
const HAIR_MIN_N: f32 = 0.15;
/// With less the noise of a place may be taken for a moving finger.
const DWELL_MIN_MM: f32 = 1.5;
/// With less the times at which a force comes and goes are not known well enough to count its turns.
const TURBO_MIN_US: u64 = 80_000;
/// So many turns of a turbo are waited for.
const TURNS: u64 = 3;

/// Everything the player does with `profile`, in a lively order. Empty if the profile leaves nothing to do.
pub(super) fn gestures(profile: &Profile) -> Vec<Gesture> {
    let player = Player::new(profile);
    let mut gestures = player.first_round();
    gestures.extend(player.second_round());
    for index in 0..profile.buttons.len() {
        gestures.extend(special(&player, index).unwrap_or_default());
    }
    gestures.retain(|gesture| gesture.is_consistent() && player.is_clear(gesture));
    gestures
}

/// A place that means something for certain.
struct Spot {
    /// As the profile counts it.
    at_mm: [f32; 2],
    /// The directions that a touch holds there.
    held: HeldKeys,
    place: Option<ButtonPlace>,
}

/// A button that is pressed at its spot.
struct Pressing<'p> {
    player: &'p Player<'p>,
    index: usize,
    button: &'p Button,
    spot: Spot,
    /// How long a press lasts before it counts.
    wait_us: u64,
}

/// What can be done with a button that the simple presses leave out. Nothing where it is uncertain what a press gives.
fn special(player: &Player<'_>, index: usize) -> Option<Vec<Gesture>> {
    let button = player.profile.buttons.get(index)?;
    let dwell = button.dwell.filter(|dwell| dwell.radius_mm >= DWELL_MIN_MM);
    let is_certain = button.hair_n.is_none_or(|hair_n| hair_n >= HAIR_MIN_N) && dwell == button.dwell;
    let dwell_us = dwell.map_or(0, |Dwell { us, .. }| us);
    if !is_certain || !player.acts_on_keys(button.force) || dwell_us > LONG_PRESS_MAX_US {
        return None;
    }
    let wait_us = dwell_us.max(player.slow_us);
    let pressing = Pressing { player, index, button, spot: spot(player, button.place)?, wait_us };
    let is_simple = player.simple(index).is_some();
    let gestures = match button.action {
        Action::Hold(effect) => {
            let [once, eased] = [pressing.repeated(effect, None), pressing.eased(effect)];
            vec![once.filter(|_| !is_simple || effect.mode != Mode::Plain), eased, pressing.turned(effect)]
        }
        Action::ByTime { tap, double, hold, .. } => {
            let short_us = hold.map_or(Some(player.pause_us), |hold| player.tap_us(hold.us));
            let after_us = double.map_or(0, |double| double.us);
            let tapped = short_us.and_then(|short_us| pressing.repeated(tap, Some((short_us, after_us))));
            let held = hold.and_then(|hold| pressing.long(hold)).filter(|_| !is_simple);
            let twice = double.zip(short_us).and_then(|(double, short_us)| pressing.twice(double, short_us));
            vec![tapped.filter(|_| !is_simple || tap.mode != Mode::Plain), held, twice]
        }
        Action::ByForce { light, hard, hard_press_n, hard_release_n, skip } => {
            let (light, hard) = plain(light).zip(plain(hard))?;
            let forces_n = [hard_press_n, hard_release_n];
            vec![
                pressing.slowly_hard(light, hard, forces_n, skip),
                pressing.quickly_hard(hard, forces_n, skip),
            ]
        }
    };
    Some(gestures.into_iter().flatten().collect())
}

impl Pressing<'_> {
    /// A light touch at the spot.
    fn rest(&self) -> Step {
        let mut step = self.player.rest_on(None);
        let (x_mm, y_mm) = self.player.profile.gain.undone(self.spot.at_mm);
        (step.contact.x_mm, step.contact.y_mm) = (x_mm, y_mm);
        step.held.clone_from(&self.spot.held);
        step.place = self.spot.place;
        step
    }

    /// The button's force, so high, while `keys` are held, too.
    fn press(&self, force_n: f32, keys: Option<Keys>) -> Step {
        let mut step = self.player.forced(self.rest(), self.button.force, force_n);
        step.pressed = Some(self.index);
        with(step, keys)
    }

    /// What presses for certain.
    fn force_n(&self) -> f32 {
        1.4 * self.button.press_n
    }

    fn gesture(&self, steps: Vec<Step>) -> Gesture {
        let around = std::iter::once(self.rest()).chain(steps).collect();
        let mut gesture = self.player.lifted(around, None);
        for step in &mut gesture.steps {
            step.place = self.spot.place;
        }
        gesture
    }

    /// Presses until the keys are up again: keys that are toggled take two presses, Sticky Keys three. `tap` is how long a short press lasts and
    /// how long after it something comes; without it the keys come with the press.
    fn repeated(&self, effect: Effect, tap: Option<(u64, u64)>) -> Option<Gesture> {
        let stays_after = match effect.mode {
            Mode::Plain => 0,
            Mode::Toggle => 1,
            Mode::Sticky => 2,
            Mode::Turbo { .. } => return None,
        };
        let keys = Some(plain(Effect { mode: Mode::Plain, ..effect })?);
        let mut steps = Vec::new();
        for number in 0..=stays_after {
            let (before, after) = (keys.filter(|_| number > 0), keys.filter(|_| number < stays_after));
            let mut press = self.press(self.force_n(), before);
            let mut rest = with(self.rest(), after);
            match tap {
                Some((short_us, after_us)) => {
                    press.stay_us = short_us;
                    rest.stay_us = rest.stay_us.saturating_add(after_us);
                    rest.tapped = keys.filter(|_| stays_after == 0);
                }
                None if stays_after == 0 => press = with(press, keys),
                None => press = with(self.press(self.force_n(), None), after),
            }
            press.stay_us = press.stay_us.saturating_add(self.wait_us);
            steps.extend([press, rest]);
        }
        Some(self.gesture(steps))
    }

    /// Presses for long.
    fn long(&self, hold: TimedEffect) -> Option<Gesture> {
        let keys = plain(hold.effect).filter(|_| hold.us <= LONG_PRESS_MAX_US)?;
        let mut wait = self.press(self.force_n(), None);
        wait.stay_us = hold.us.saturating_add(self.wait_us);
        let held = Step { ramp_us: 0, stay_us: self.player.pause_us, ..with(wait.clone(), Some(keys)) };
        Some(self.gesture(vec![wait, held, self.rest()]))
    }

    /// Presses twice, quickly.
    fn twice(&self, double: TimedEffect, short_us: u64) -> Option<Gesture> {
        let keys = plain(double.effect)?;
        let is_quick = double.us >= 2 * RAMP_US + SLACK_US && self.wait_us == 0;
        if !is_quick || self.player.profile.access.bounce_us > 0 {
            return None;
        }
        let first = Step { stay_us: short_us, ..self.press(self.force_n(), None) };
        let between = Step { stay_us: 0, ..self.rest() };
        Some(self.gesture(vec![first, between, self.press(self.force_n(), Some(keys)), self.rest()]))
    }

    /// Eases a hair trigger's force by little, and presses again.
    fn eased(&self, effect: Effect) -> Option<Gesture> {
        let hair_n = self.button.hair_n.filter(|_| self.wait_us == 0)?;
        let keys = Some(plain(effect)?);
        let high_n = self.force_n().max(1.15 * self.button.press_n + 3.0 * hair_n);
        let low_n = high_n - 2.5 * hair_n;
        let steps = [(high_n, keys), (low_n, None), (high_n, keys)].map(|(n, keys)| self.press(n, keys));
        Some(self.gesture(steps.into_iter().chain([self.rest()]).collect()))
    }

    /// Presses for some turns of a turbo.
    fn turned(&self, effect: Effect) -> Option<Gesture> {
        let Mode::Turbo { period_us } = effect.mode else { return None };
        let keys = plain(Effect { mode: Mode::Plain, ..effect }).filter(|_| period_us >= TURBO_MIN_US)?;
        let mut press = self.press(self.force_n(), None);
        // It ends where the keys are up, as far as can be from both of their next turns.
        let lasts_us = (TURNS - 1) * period_us + period_us / 4 * 3;
        let floor_n = match press.contact.fx_n == 0.0 && press.contact.fy_n == 0.0 {
            true => self.player.light_n,
            false => 0.0,
        };
        let part = |n: f32| eased_part((n - floor_n) / (self.force_n() - floor_n));
        let [on, off] = [self.button.press_n, self.button.release_n].map(part);
        let ramps_us = ((2.0 - on - off) * RAMP_US as f32) as u64;
        press.stay_us = lasts_us.saturating_add(self.wait_us).checked_sub(ramps_us)?;
        press.tapped = Some(keys);
        let turn = Step { ramp_us: 0, stay_us: 0, ..press.clone() };
        let steps = std::iter::once(press).chain(vec![turn; TURNS as usize - 1]).chain([self.rest()]);
        Some(self.gesture(steps.collect()))
    }

    /// Presses lightly, then hard, then lightly.
    fn slowly_hard(&self, light: Keys, hard: Keys, forces_n: [f32; 2], skip: Skip) -> Option<Gesture> {
        let (light_n, hard_n) = self.stages_n(forces_n)?;
        let waits_us = match skip {
            Skip::No => 0,
            Skip::May { us } | Skip::Must { us } => us,
        };
        let mut press = self.press(light_n, Some(light));
        press.stay_us = press.stay_us.saturating_add(self.wait_us).saturating_add(waits_us);
        let is_alone = matches!(skip, Skip::Must { .. });
        let on_top = with(self.press(hard_n, Some(light)), Some(hard).filter(|_| !is_alone));
        Some(self.gesture(vec![press, on_top, self.press(light_n, Some(light)), self.rest()]))
    }

    /// Presses so quickly that light is passed over.
    fn quickly_hard(&self, hard: Keys, forces_n: [f32; 2], skip: Skip) -> Option<Gesture> {
        let (_, hard_n) = self.stages_n(forces_n)?;
        let (Skip::May { us } | Skip::Must { us }) = skip else { return None };
        let is_quick = us >= RAMP_US + SLACK_US && self.wait_us == 0;
        is_quick.then(|| self.gesture(vec![self.press(hard_n, Some(hard)), self.rest()]))
    }

    /// Forces that are light and hard for certain.
    fn stages_n(&self, [hard_press_n, hard_release_n]: [f32; 2]) -> Option<(f32, f32)> {
        let (light_n, hard_n) = (1.2 * self.button.press_n, 1.2 * hard_press_n);
        let is_light = light_n <= (0.85 - FORCE_ERROR) * hard_release_n.min(hard_press_n);
        is_light.then_some((light_n, hard_n))
    }
}

/// The step with more that is held.
fn with(mut step: Step, keys: Option<Keys>) -> Step {
    step.held.extend(keys.into_iter().flat_map(|keys| keys.iter()));
    step
}

/// The part of the time in which a smooth way has come so far.
fn eased_part(way: f32) -> f32 {
    let (mut low, mut high) = (0.0_f32, 1.0_f32);
    for _ in 0..20 {
        let middle = 0.5 * (low + high);
        if middle * middle * (3.0 - 2.0 * middle) < way { low = middle } else { high = middle }
    }
    high
}

/// Where a button that counts at `place` is pressed.
fn spot(player: &Player<'_>, place: Option<ButtonPlace>) -> Option<Spot> {
    let at = |radius_mm: f32, angle_deg: f32| {
        let (sin, cos) = libm::sincosf(angle_deg.to_radians());
        [radius_mm * cos, radius_mm * sin]
    };
    match place {
        None => Some(Spot { at_mm: [0.0; 2], held: HeldKeys::new(), place }),
        Some(ButtonPlace::Direction(direction)) => {
            let quarter = match direction {
                Direction::Right => 0,
                Direction::Up => 1,
                Direction::Left => 2,
                Direction::Down => 3,
            };
            let aim = player.cardinals().into_iter().nth(quarter)?;
            let rotation_deg = player.profile.dpad.as_ref()?.rotation_deg;
            Some(Spot { at_mm: at(player.radius_mm, aim.angle_deg + rotation_deg), held: aim.held, place })
        }
        Some(ButtonPlace::Zone(number)) => {
            let (radius_mm, angle_deg) = zone_spot(player.profile, number)?;
            let held = held_at(player, radius_mm, angle_deg)?;
            Some(Spot { at_mm: at(radius_mm, angle_deg), held, place })
        }
    }
}

/// Where a touch is in this zone for certain: distance from the centre, and angle.
fn zone_spot(profile: &Profile, number: usize) -> Option<(f32, f32)> {
    let zone = profile.zones.get(number)?;
    let is_ring = zone.half_width_deg >= 180.0;
    let outer_mm = zone.outer_radius_mm.min(RADIUS_MAX_MM + PLACE_SLACK_MM);
    let is_disc = is_ring && zone.inner_radius_mm == 0.0;
    let radius_mm = if is_disc { 0.0 } else { 0.5 * (zone.inner_radius_mm + outer_mm) };
    let angle_deg =
        if is_ring { profile.dpad.as_ref().map_or(0.0, |it| it.rotation_deg) } else { zone.middle_deg };
    let has_room = outer_mm - radius_mm >= PLACE_SLACK_MM
        && (is_ring || radius_mm * zone.half_width_deg.to_radians() >= PLACE_SLACK_MM);
    let is_first = profile.zones.iter().take(number).all(|before| !is_near(before, radius_mm, angle_deg));
    (has_room && is_first).then_some((radius_mm, angle_deg))
}

/// Whether a touch there may be in the zone.
fn is_near(zone: &Zone, radius_mm: f32, angle_deg: f32) -> bool {
    let slack_deg = (PLACE_SLACK_MM / radius_mm.max(PLACE_SLACK_MM)).to_degrees();
    radius_mm >= zone.inner_radius_mm - PLACE_SLACK_MM
        && radius_mm <= zone.outer_radius_mm + PLACE_SLACK_MM
        && apart_deg(angle_deg, zone.middle_deg) <= zone.half_width_deg + slack_deg
}

/// What the D-pad holds at a place; `None` where that is not certain.
fn held_at(player: &Player<'_>, radius_mm: f32, angle_deg: f32) -> Option<HeldKeys> {
    let Some(dpad) = &player.profile.dpad else { return Some(HeldKeys::new()) };
    if radius_mm <= dpad.centre_radius_mm - dpad.radius_hysteresis_mm - PLACE_SLACK_MM {
        return Some(HeldKeys::new());
    }
    let half_deg = cardinal_half_deg(dpad) - ANGLE_SLACK_DEG;
    let is_there = |angle: f32| apart_deg(angle_deg, angle + dpad.rotation_deg) <= half_deg;
    player.cardinals().into_iter().find(|aim| is_there(aim.angle_deg)).map(|aim| aim.held)
}

/// The angle between two directions.
fn apart_deg(one: f32, other: f32) -> f32 {
    let turned = (one - other).abs() % 360.0;
    turned.min(360.0 - turned)
}
