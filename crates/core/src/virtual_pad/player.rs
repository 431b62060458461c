//! The player: how it touches the pad in a profile, and the gestures of directions and of buttons whose keys follow the finger.
//!
//! `repertoire` has the others, and leaves out those whose forces or places come too near to a threshold.

use crate::pipeline::contact::touch;
use crate::pipeline::control::Code;
use crate::pipeline::mapping::profile::{
    Action, Button, ButtonPlace, Dpad, DpadMode, Effect, Force, Gain, Keys, Mode, Output, Profile, When,
};
use crate::quantity::Contact;
use crate::virtual_pad::gesture::{Gesture, HeldKeys, Step};

/// A ramp of force, as quick as a finger's.
pub(super) const RAMP_US: u64 = 45_000;
/// A slide or roll of the finger between two places.
const SLIDE_US: u64 = 60_000;
/// Slack in every time that something else must fit into.
pub(super) const SLACK_US: u64 = 60_000;
const PAUSE_MIN_US: u64 = 100_000;
const SAMPLE_US: u64 = 1_000;
pub(super) const LONG_PRESS_MAX_US: u64 = 3_000_000;

const FORCE_MAX_N: f32 = 4.5;
pub(super) const RADIUS_MAX_MM: f32 = 25.0;
pub(super) const PLACE_SLACK_MM: f32 = 2.0;
pub(super) const ANGLE_SLACK_DEG: f32 = 5.0;

/// Less hysteresis than this lets noise turn one crossing into several.
const FORCE_HYSTERESIS_MIN_N: f32 = 0.02;
const RADIUS_HYSTERESIS_MIN_MM: f32 = 0.5;
const ANGLE_HYSTERESIS_MIN_DEG: f32 = 2.0;

/// A normal force reads as at most this much shear, per newton, within [`RADIUS_MAX_MM`].
const FALSE_SHEAR: f32 = 0.12;
/// A force is read this well.
pub(super) const FORCE_ERROR: f32 = 0.02;

/// A direction from the centre and what it holds.
#[derive(Clone)]
pub(super) struct Aim {
    pub(super) angle_deg: f32,
    pub(super) held: HeldKeys,
}

/// What a short press gives, and how long after its end.
#[derive(Clone, Copy)]
pub(super) struct Tap {
    keys: Keys,
    after_us: u64,
}

/// The keys of an effect that follows the press; none of another one.
pub(super) fn plain(effect: Effect) -> Option<Keys> {
    let Effect { output: Output::Keys(keys), mode: Mode::Plain } = effect else { return None };
    let turns = keys.iter().any(|binding| matches!(binding.code, Code::Relative(_)));
    (!turns).then_some(keys)
}

/// Who plays a profile.
pub(super) struct Player<'p> {
    pub(super) profile: &'p Profile,
    /// Normal force that holds a direction and presses nothing.
    pub(super) light_n: f32,
    /// Normal force under a shear.
    grip_n: f32,
    /// Distance at which directions are pressed.
    pub(super) radius_mm: f32,
    /// Long enough for filter and ledger to follow.
    pub(super) pause_us: u64,
    /// How long a press lasts before it counts.
    pub(super) slow_us: u64,
}

impl<'p> Player<'p> {
    /// With what the profile asks of forces, places and times.
    pub(super) fn new(profile: &'p Profile) -> Self {
        let (mut press_n, mut release_n) = (2.0_f32, 1.5_f32);
        for button in profile.buttons.iter().filter(|button| button.force == Force::Fz) {
            press_n = press_n.min(button.press_n);
            release_n = release_n.min(button.release_n);
        }
        let directions = profile.dpad.iter().map(|dpad| (dpad.min_force_n, dpad.centre_radius_mm));
        let motion = profile.pointer.iter().map(|pointer| (pointer.min_force_n, pointer.centre_radius_mm));
        let least_n = profile.access.rest.map_or(touch::ON_N, |rest| rest.n.max(touch::ON_N));
        let (touch_n, centre_mm) = directions
            .chain(motion)
            .fold((least_n, 0.0_f32), |most, gate| (most.0.max(gate.0), most.1.max(gate.1)));
        let (floor_n, ceiling_n) = (1.5 * touch_n, (0.7 * press_n).min(0.8 * release_n));
        let filter_us = SAMPLE_US.saturating_mul(profile.filter_samples as u64);
        let (slow_us, bounce_us) = (profile.access.slow_us, profile.access.bounce_us);
        let apart_us = profile.min_press_us.max(bounce_us);
        let follow_us = [slow_us, filter_us, SLACK_US].into_iter().fold(apart_us, u64::saturating_add);
        Self {
            profile,
            light_n: floor_n + 0.6 * (ceiling_n - floor_n),
            grip_n: 0.75 * press_n,
            radius_mm: (0.5 * (centre_mm + 27.0)).min(RADIUS_MAX_MM),
            pause_us: follow_us.max(PAUSE_MIN_US),
            slow_us,
        }
    }

    /// Every binding once: directions, then buttons at the centre.
    pub(super) fn first_round(&self) -> Vec<Gesture> {
        let mut gestures: Vec<Gesture> = self.cardinals().iter().map(|aim| self.press_aim(aim)).collect();
        for button in 0..self.profile.buttons.len() {
            gestures.extend(self.short_press(button, None));
            gestures.extend(self.long_press(button, None));
        }
        gestures
    }

    /// Directions that change, and buttons together with directions.
    pub(super) fn second_round(&self) -> Vec<Gesture> {
        let cardinals = self.cardinals();
        let mut gestures = Vec::new();
        if let [right, up, left, down] = cardinals.as_slice() {
            gestures.extend(self.roll(right, up));
            for button in 0..self.profile.buttons.len() {
                gestures.extend(self.short_press(button, Some(right)));
            }
            gestures.push(self.slide_over(right, left));
            gestures.extend(self.roll(left, down));
            for button in 0..self.profile.buttons.len() {
                gestures.extend(self.long_press(button, Some(left)));
            }
            gestures.extend(self.diagonal(right, up).map(|aim| self.press_aim(&aim)));
            gestures.extend(self.roll(down, right));
        }
        gestures
    }

    /// Right, up, left, down; none where the sectors are too narrow to hit. Without directions the pointer goes there,
    /// if there is one, and nothing is held.
    pub(super) fn cardinals(&self) -> Vec<Aim> {
        let Some(dpad) = &self.profile.dpad else {
            let angles_deg = self.profile.pointer.iter().flat_map(|_| [0.0, 90.0, 180.0, 270.0]);
            return angles_deg.map(|angle_deg| Aim { angle_deg, held: HeldKeys::new() }).collect();
        };
        let Gain { right, left, up, down } = self.profile.gain;
        let least_gain = [right, left, up, down].into_iter().fold(f32::INFINITY, f32::min);
        let [x_mm, y_mm] = self.profile.centre_mm;
        let reach_mm = RADIUS_MAX_MM - libm::hypotf(x_mm, y_mm);
        if cardinal_half_deg(dpad) < ANGLE_SLACK_DEG || self.radius_mm > least_gain * reach_mm {
            return Vec::new();
        }
        let aim = |angle_deg, keys: Keys| Aim { angle_deg, held: keys.iter().collect() };
        vec![aim(0.0, dpad.right), aim(90.0, dpad.up), aim(180.0, dpad.left), aim(270.0, dpad.down)]
    }

    /// Between two neighbours of which `horizontal` is right or left.
    fn diagonal(&self, horizontal: &Aim, vertical: &Aim) -> Option<Aim> {
        let dpad = self.profile.dpad.as_ref().filter(|dpad| dpad.mode == DpadMode::EightWay)?;
        let wide = 0.5 * dpad.diagonal_deg >= ANGLE_SLACK_DEG;
        let held = horizontal.held.iter().chain(&vertical.held).copied().collect();
        wide.then(|| Aim { angle_deg: 0.5 * (horizontal.angle_deg + vertical.angle_deg), held })
    }

    fn press_aim(&self, aim: &Aim) -> Gesture {
        self.lifted(vec![self.rest_on(Some(aim))], None)
    }

    /// Rolls by a quarter turn over the diagonal between two neighbours.
    fn roll(&self, from: &Aim, to: &Aim) -> Option<Gesture> {
        let dpad = self.profile.dpad.as_ref()?;
        let past_edge_deg = dpad.hysteresis_deg + ANGLE_SLACK_DEG;
        let is_steady = match dpad.mode {
            // The diagonal is the hysteresis.
            DpadMode::FourWaySticky => 0.5 * dpad.diagonal_deg >= ANGLE_SLACK_DEG,
            DpadMode::FourWay | DpadMode::EightWay => dpad.hysteresis_deg >= ANGLE_HYSTERESIS_MIN_DEG,
        };
        let steady = is_steady && cardinal_half_deg(dpad) >= past_edge_deg;
        let end_deg = if to.angle_deg < from.angle_deg { to.angle_deg + 360.0 } else { to.angle_deg };
        let middle_deg = 0.5 * (from.angle_deg + end_deg);
        let middle = match dpad.mode {
            DpadMode::EightWay if 0.5 * dpad.diagonal_deg < past_edge_deg => return None,
            DpadMode::EightWay => Aim { angle_deg: middle_deg, held: both(from, to) },
            DpadMode::FourWay | DpadMode::FourWaySticky => {
                Aim { angle_deg: middle_deg, held: from.held.clone() }
            }
        };
        let mut steps: Vec<Step> = [from, &middle, to].iter().map(|aim| self.rest_on(Some(aim))).collect();
        for step in steps.iter_mut().skip(1) {
            step.ramp_us = SLIDE_US;
        }
        steady.then(|| self.lifted(steps, None))
    }

    /// Slides from one side over the centre to the other.
    fn slide_over(&self, from: &Aim, to: &Aim) -> Gesture {
        let mut steps = vec![self.rest_on(Some(from)), self.rest_on(None), self.rest_on(Some(to))];
        for step in steps.iter_mut().skip(1) {
            step.ramp_us = SLIDE_US;
        }
        self.lifted(steps, None)
    }

    /// A button that its force presses wherever the finger is; `None` where another one of that force goes with a zone, a hair trigger
    /// or stages, so that this player would not know what a press gives.
    pub(super) fn simple(&self, index: usize) -> Option<&'p Button> {
        let button = self.profile.buttons.get(index)?;
        let is_simple = |it: &Button| {
            it.place.is_none()
                && it.hair_n.is_none()
                && it.dwell.is_none()
                && !matches!(it.action, Action::ByForce { .. })
        };
        (self.acts_on_keys(button.force) && self.of_force(button.force).all(is_simple)).then_some(button)
    }

    /// The buttons that a force presses.
    fn of_force(&self, force: Force) -> impl Iterator<Item = &'p Button> {
        self.profile.buttons.iter().filter(move |it| it.force == force)
    }

    /// Whether all that a force presses are keys, and at any time. What layers and macros do, and what is asked of the bridge, this
    /// player does not show.
    pub(super) fn acts_on_keys(&self, force: Force) -> bool {
        self.of_force(force).all(|button| {
            let mut effects = button.effects().into_iter().flatten();
            button.when == When::Always && effects.all(|effect| matches!(effect.output, Output::Keys(_)))
        })
    }

    /// Presses a button and lets go soon. A tap button taps, a hold button holds meanwhile; a tap that a double press might follow
    /// comes when that is over.
    fn short_press(&self, index: usize, aim: Option<&Aim>) -> Option<Gesture> {
        let button = self.simple(index)?;
        let (held, tapped, stay_us) = match button.action {
            Action::ByForce { .. } => return None,
            Action::Hold(effect) => (Some(plain(effect)?), None, self.pause_us),
            Action::ByTime { tap, double, hold, .. } => {
                let after_us = double.map_or(0, |double| double.us);
                let stay_us = hold.map_or(Some(self.pause_us), |hold| self.tap_us(hold.us))?;
                (None, Some(Tap { keys: plain(tap)?, after_us }), stay_us)
            }
        };
        let mut press = self.press_step(index, button, aim);
        press.held.extend(held.into_iter().flat_map(|keys| keys.iter()));
        press.stay_us = stay_us.saturating_add(self.slow_us);
        Some(self.around_press(vec![press], aim, tapped))
    }

    /// Presses a tap-or-hold button until it holds.
    fn long_press(&self, index: usize, aim: Option<&Aim>) -> Option<Gesture> {
        let button = self.simple(index)?;
        let Action::ByTime { hold: Some(hold), .. } = button.action else { return None };
        if hold.us > LONG_PRESS_MAX_US {
            return None;
        }
        let mut wait = self.press_step(index, button, aim);
        wait.stay_us = hold.us.saturating_add(self.slow_us);
        let mut held = Step { ramp_us: 0, stay_us: self.pause_us, ..wait.clone() };
        held.held.extend(plain(hold.effect)?.iter());
        Some(self.around_press(vec![wait, held], aim, None))
    }

    /// How long a short press stays at its force; `None` if it could come out long or be filtered away.
    pub(super) fn tap_us(&self, long_press_us: u64) -> Option<u64> {
        let filter_us = SAMPLE_US.saturating_mul(self.profile.filter_samples as u64);
        let shortest_us = filter_us.saturating_add(SLACK_US / 2);
        let room_us = (long_press_us / 5 * 4).checked_sub(2 * RAMP_US)?.checked_sub(filter_us)?;
        (room_us >= shortest_us).then(|| room_us.min(shortest_us.max(PAUSE_MIN_US)))
    }

    /// A press on a direction, or by shear, starts and ends with a light touch, so that one thing happens at
    /// a time.
    fn around_press(&self, press: Vec<Step>, aim: Option<&Aim>, tapped: Option<Tap>) -> Gesture {
        let sheared = press.iter().any(|step| step.contact.fx_n != 0.0 || step.contact.fy_n != 0.0);
        if aim.is_none() && !sheared {
            return self.lifted(press, tapped);
        }
        let mut steps = vec![self.rest_on(aim)];
        steps.extend(press);
        let mut rest = self.rest_on(aim);
        rest.tapped = tapped.map(|tap| tap.keys);
        rest.stay_us = rest.stay_us.saturating_add(tapped.map_or(0, |tap| tap.after_us));
        steps.push(rest);
        self.lifted(steps, None)
    }

    fn press_step(&self, index: usize, button: &Button, aim: Option<&Aim>) -> Step {
        let factor = if button.force == Force::Fz { 1.4 } else { 1.3 };
        let mut step = self.forced(self.rest_on(aim), button.force, factor * button.press_n);
        step.pressed = Some(index);
        step
    }

    /// The step with so much of a force, instead of a light touch.
    pub(super) fn forced(&self, mut step: Step, force: Force, force_n: f32) -> Step {
        let contact = &mut step.contact;
        contact.fz_n = if force == Force::Fz { force_n } else { self.grip_n };
        match force {
            Force::Fz => {}
            Force::FxPositive => contact.fx_n = force_n,
            Force::FxNegative => contact.fx_n = -force_n,
            Force::FyPositive => contact.fy_n = force_n,
            Force::FyNegative => contact.fy_n = -force_n,
        }
        step
    }

    /// A light touch on a direction, or at the centre.
    pub(super) fn rest_on(&self, aim: Option<&Aim>) -> Step {
        let rotation_deg = self.profile.dpad.as_ref().map_or(0.0, |dpad| dpad.rotation_deg);
        let (radius_mm, angle_deg) =
            aim.map_or((0.0, 0.0), |aim| (self.radius_mm, aim.angle_deg + rotation_deg));
        let (sin, cos) = libm::sincosf(angle_deg.to_radians());
        let (x_mm, y_mm) = self.profile.gain.undone([radius_mm * cos, radius_mm * sin]);
        let [centre_x_mm, centre_y_mm] = self.profile.centre_mm;
        let (x_mm, y_mm) = (x_mm + centre_x_mm, y_mm + centre_y_mm);
        Step {
            contact: Contact { x_mm, y_mm, fx_n: 0.0, fy_n: 0.0, fz_n: self.light_n },
            ramp_us: RAMP_US,
            stay_us: self.pause_us,
            held: aim.map_or_else(HeldKeys::new, |aim| aim.held.clone()),
            tapped: None,
            pressed: None,
            place: None,
        }
    }

    pub(super) fn lifted(&self, mut steps: Vec<Step>, tapped: Option<Tap>) -> Gesture {
        let mut lift = self.rest_on(None);
        if let Some(last) = steps.last() {
            lift.contact = Contact { x_mm: last.contact.x_mm, y_mm: last.contact.y_mm, ..Contact::default() };
        }
        lift.tapped = tapped.map(|tap| tap.keys);
        let after_us = tapped.map_or(0, |tap| tap.after_us);
        lift.stay_us = self.pause_us.saturating_add(SLACK_US).saturating_add(after_us);
        steps.push(lift);
        Gesture { steps }
    }

    /// Whether every step before the lift keeps clear of the thresholds that it is not meant to cross.
    pub(super) fn is_clear(&self, gesture: &Gesture) -> bool {
        let Some((_, touching)) = gesture.steps.split_last() else { return false };
        let mut pressed_before = Vec::new();
        touching.iter().all(|step| {
            pressed_before.extend(step.pressed);
            let buttons = self.profile.buttons.iter().enumerate();
            step.contact.fz_n >= 1.3 * touch::ON_N
                && step.contact.fz_n.max(shear_n(&step.contact)) <= FORCE_MAX_N
                && self.is_place_clear(step)
                && buttons.into_iter().all(|(index, button)| {
                    is_elsewhere(button, step)
                        || button_is_clear(button, step, index, pressed_before.contains(&index))
                })
        })
    }

    fn is_place_clear(&self, step: &Step) -> bool {
        let Some(dpad) = &self.profile.dpad else { return true };
        let radius_mm = libm::hypotf(step.contact.x_mm, step.contact.y_mm);
        if radius_mm > dpad.centre_radius_mm - dpad.radius_hysteresis_mm - PLACE_SLACK_MM {
            dpad.radius_hysteresis_mm >= RADIUS_HYSTERESIS_MIN_MM
                && dpad.min_force_n - dpad.release_force_n >= FORCE_HYSTERESIS_MIN_N
                && radius_mm >= dpad.centre_radius_mm + PLACE_SLACK_MM
                && step.contact.fz_n >= 1.3 * dpad.min_force_n
                && step.contact.fz_n >= 1.3 * dpad.release_force_n
        } else {
            dpad.centre_radius_mm - dpad.radius_hysteresis_mm >= PLACE_SLACK_MM
        }
    }
}

fn both(a: &Aim, b: &Aim) -> HeldKeys {
    let is_horizontal = |aim: &Aim| aim.angle_deg == 0.0 || aim.angle_deg == 180.0;
    let (first, second) = if is_horizontal(a) { (a, b) } else { (b, a) };
    first.held.iter().chain(&second.held).copied().collect()
}

/// Half the angle in which a touch certainly means this cardinal direction.
pub(super) fn cardinal_half_deg(dpad: &Dpad) -> f32 {
    match dpad.mode {
        DpadMode::FourWay => 45.0,
        DpadMode::FourWaySticky | DpadMode::EightWay => 0.5 * (90.0 - dpad.diagonal_deg),
    }
}

fn shear_n(contact: &Contact) -> f32 {
    libm::hypotf(contact.fx_n, contact.fy_n)
}

/// Whether the button counts only where the step certainly is not.
fn is_elsewhere(button: &Button, step: &Step) -> bool {
    match (button.place, step.place) {
        (Some(ButtonPlace::Zone(one)), Some(ButtonPlace::Zone(other))) => one != other,
        (Some(ButtonPlace::Direction(one)), Some(ButtonPlace::Direction(other))) => one != other,
        _ => false,
    }
}

/// Whether the button is clearly pressed where it is meant to be, and clearly not where it is not.
fn button_is_clear(button: &Button, step: &Step, index: usize, pressed_before: bool) -> bool {
    let contact = &step.contact;
    let force_n = match button.force {
        Force::Fz => contact.fz_n,
        Force::FxPositive => contact.fx_n,
        Force::FxNegative => -contact.fx_n,
        Force::FyPositive => contact.fy_n,
        Force::FyNegative => -contact.fy_n,
    };
    // At the centre the threefold symmetry leaves no false shear.
    let off_centre = contact.x_mm != 0.0 || contact.y_mm != 0.0;
    let false_n = if button.force == Force::Fz || !off_centre { 0.0 } else { FALSE_SHEAR * contact.fz_n };
    let doubt_n = false_n + FORCE_ERROR * contact.fz_n.max(shear_n(contact));
    if step.pressed == Some(index) {
        button.press_n - button.release_n >= FORCE_HYSTERESIS_MIN_N
            && force_n - doubt_n >= 1.05 * button.press_n
    } else {
        let limit_n = if pressed_before { button.release_n } else { button.press_n };
        force_n + doubt_n <= 0.9 * limit_n
    }
}
