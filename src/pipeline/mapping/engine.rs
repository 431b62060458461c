//! The live mapping: contacts in, levels out.

use arrayvec::ArrayVec;

use super::effect::Playing;
use super::intent::{Intents, Level};
use super::press::Press;
use super::profile::{BUTTONS_MAX, Binding, Button, Dpad, Force, Profile};
use super::sector::{self, Horizontal, Sector, Vertical};
use super::steer::{self, Velocity};
use crate::pipeline::control::OutputDevice;
use crate::pipeline::control::names::POINTER_MOTION;
use crate::quantity::Contact;
use crate::time::StreamInstant;

/// Plays one profile. `mappings/README.md` states its rules.
///
/// All decisions are taken at samples, from their stream times: a long press starts to hold with the first
/// sample at or after its moment. There is no timer.
#[derive(Debug)]
pub struct Engine {
    profile: Profile,
    held: Option<Sector>,
    moving: Option<Velocity>,
    presses: ArrayVec<(Press, Playing), BUTTONS_MAX>,
    last: Option<Contact>,
}

impl Engine {
    /// An engine that has seen no contact yet.
    pub fn new(profile: Profile) -> Self {
        let presses = profile.buttons.iter().map(|_| (Press::Up, Playing::nothing())).collect();
        Self { profile, held: None, moving: None, presses, last: None }
    }

    /// The profile that is played.
    pub const fn profile(&self) -> &Profile {
        &self.profile
    }

    /// What should be held at stream time `t`, given the contact then; `None` for the contact means that it
    /// was lifted (or that there still is none).
    ///
    /// A lift ends presses in the ordinary way, so a short one taps in this very step. A contact with a
    /// number that is not finite is no contact, but no lift either: it works as [`cancel`](Self::cancel)
    /// does. Time that runs backwards counts as time that stands still.
    pub fn step(&mut self, t: StreamInstant, contact: Option<&Contact>) -> Intents {
        if contact.is_some_and(|contact| !is_finite(contact)) {
            self.cancel();
            return Intents::new();
        }
        self.last = contact.copied();
        let mut levels = Levels { stated: Intents::new() };
        self.held = self
            .profile
            .dpad
            .as_ref()
            .zip(contact)
            .and_then(|(dpad, contact)| sector::follow(dpad, self.held, contact));
        if let Some((dpad, sector)) = self.profile.dpad.as_ref().zip(self.held) {
            levels.state_directions(dpad, sector);
        }
        for (button, (press, playing)) in self.profile.buttons.iter().zip(&mut self.presses) {
            let force_n = contact.map(|contact| force_of(button.force, contact));
            let role = press.step(button, t, force_n);
            playing.step(button, t, role).for_each(|binding| levels.state(binding));
        }
        self.moving = self
            .profile
            .pointer
            .as_ref()
            .zip(contact)
            .and_then(|(pointer, contact)| steer::follow(pointer, self.moving, contact));
        levels.state_motion(self.moving);
        levels.stated
    }

    /// After a fault (lost link, dead channel, pause): forgets directions, the pointer's way, presses and what they toggled;
    /// nothing is tapped for them.
    ///
    /// A press that was under way stays forgotten until its force was released once, even if the contact goes
    /// on.
    pub fn cancel(&mut self) {
        self.held = None;
        self.moving = None;
        for (press, playing) in &mut self.presses {
            press.forget();
            *playing = Playing::nothing();
        }
    }

    /// Goes on with another profile, also in the middle of a contact.
    ///
    /// The next step states the levels of the new profile, so whatever both profiles hold stays held. The
    /// direction and the pointer's way continue (the thresholds that end them apply, not those that start them); what was toggled
    /// does not. A press that was under way, or that the new profile would see as under way, does nothing in the new profile until its
    /// force was released once.
    pub fn replace_profile(&mut self, profile: Profile) {
        let presses =
            profile.buttons.iter().map(|button| (self.press_for(button), Playing::nothing())).collect();
        self.presses = presses;
        self.profile = profile;
    }

    /// Where a button of another profile stands that takes over now.
    fn press_for(&self, button: &Button) -> Press {
        let same_force =
            self.profile.buttons.iter().zip(&self.presses).filter(|(old, _)| old.force == button.force);
        let taken_over = same_force.into_iter().any(|(_, (press, _))| press.is_under_way());
        let beyond = self.last.is_some_and(|contact| force_of(button.force, &contact) >= button.press_n);
        if taken_over || beyond { Press::Spent } else { Press::Up }
    }
}

/// The levels of one step while they are collected.
struct Levels {
    stated: Intents,
}

impl Levels {
    fn state_directions(&mut self, dpad: &Dpad, sector: Sector) {
        let horizontal = sector.horizontal().map(|horizontal| match horizontal {
            Horizontal::Left => dpad.left,
            Horizontal::Right => dpad.right,
        });
        let vertical = sector.vertical().map(|vertical| match vertical {
            Vertical::Up => dpad.up,
            Vertical::Down => dpad.down,
        });
        horizontal.into_iter().chain(vertical).flat_map(|keys| keys.iter()).for_each(|it| self.state(it));
    }

    /// Adds a level. A control that is stated already keeps its first value: each control stands there once.
    fn state(&mut self, Binding { device, code, value }: Binding) {
        self.push(Level { device, code, value });
    }

    fn state_motion(&mut self, velocity: Option<Velocity>) {
        let Some(Velocity { right, down }) = velocity else { return };
        let rates = POINTER_MOTION.into_iter().zip([right, down]);
        for (code, value) in rates.filter(|(_, rate)| *rate != 0) {
            self.push(Level { device: OutputDevice::Pointer, code, value });
        }
    }

    fn push(&mut self, level: Level) {
        if self.stated.iter().all(|stated| (stated.device, stated.code) != (level.device, level.code)) {
            // A profile has at most CONTROLS_MAX controls, so there is always room.
            let _ = self.stated.try_push(level);
        }
    }
}

/// The part of the contact's force that counts for a button, in newtons.
const fn force_of(force: Force, contact: &Contact) -> f32 {
    match force {
        Force::Fz => contact.fz_n,
        Force::FxPositive => contact.fx_n,
        Force::FxNegative => -contact.fx_n,
        Force::FyPositive => contact.fy_n,
        Force::FyNegative => -contact.fy_n,
    }
}

fn is_finite(contact: &Contact) -> bool {
    let Contact { x_mm, y_mm, fx_n, fy_n, fz_n } = *contact;
    [x_mm, y_mm, fx_n, fy_n, fz_n].into_iter().all(f32::is_finite)
}
