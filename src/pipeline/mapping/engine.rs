//! The live mapping: contacts in, levels out.

use arrayvec::ArrayVec;

use super::accept::Presses;
use super::intent::{Intents, Level};
use super::profile::{BUTTONS_MAX, Binding, Button, Dpad, Place, Profile};
use super::sector::{self, Horizontal, Sector, Vertical};
use super::steer::{self, Velocity};
use super::touched::{Touched, force_of};
use super::tremor::Calm;
use super::zone;
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
    zone: Option<usize>,
    moving: Option<Velocity>,
    buttons: ArrayVec<Touched, BUTTONS_MAX>,
    last: Option<Contact>,
    calm: Option<Calm>,
    is_acting: bool,
    presses: Presses,
}

impl Engine {
    /// An engine that has seen no contact yet.
    pub fn new(profile: Profile) -> Self {
        let buttons = profile.buttons.iter().map(|_| Touched::fresh()).collect();
        Self {
            profile,
            held: None,
            zone: None,
            moving: None,
            buttons,
            last: None,
            calm: None,
            is_acting: false,
            presses: Presses::default(),
        }
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
        let meant = self.meant(t, contact);
        let contact = meant.as_ref();
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
        self.zone = contact.and_then(|contact| zone::follow(&self.profile.zones, self.zone, contact));
        let is_in = |place: Option<Place>| match place {
            None => true,
            Some(Place::Zone(number)) => self.zone == Some(number),
            Some(Place::Direction(direction)) => self.held.is_some_and(|held| held.has(direction)),
        };
        for (button, touched) in self.profile.buttons.iter().zip(&mut self.buttons) {
            // A lifted contact was where it was.
            let is_in_place = contact.is_none() || is_in(button.place);
            let help = (self.profile.access, &mut self.presses);
            touched.step(button, t, (contact, is_in_place), help).for_each(|binding| levels.state(binding));
        }
        self.unlatch();
        self.moving = self
            .profile
            .pointer
            .as_ref()
            .zip(contact)
            .and_then(|(pointer, contact)| steer::follow(pointer, self.moving, contact));
        levels.state_motion(self.moving);
        levels.stated
    }

    /// The place that the hand means: calmed, and stretched where it does not reach.
    fn meant(&mut self, t: StreamInstant, contact: Option<&Contact>) -> Option<Contact> {
        let Some(contact) = contact else {
            self.calm = None;
            return None;
        };
        let calmed = match &self.profile.access.tremor {
            Some(tremor) => Calm::step(&mut self.calm, tremor, t, contact),
            None => *contact,
        };
        Some(self.profile.gain.applied(&calmed))
    }

    /// Lets latched keys go where an action has ended.
    fn unlatch(&mut self) {
        let buttons = || self.profile.buttons.iter().zip(&self.buttons);
        let is_acting = self.held.is_some() || buttons().any(|(button, touched)| touched.is_acting(button));
        if self.is_acting && !is_acting {
            self.buttons.iter_mut().for_each(Touched::unlatch);
        }
        self.is_acting = is_acting;
    }

    /// How many presses counted since the engine began, and how many did not.
    pub const fn presses(&self) -> Presses {
        self.presses
    }

    /// After a fault (lost link, dead channel, pause): forgets directions, the pointer's way, presses and what they toggled;
    /// nothing is tapped for them.
    ///
    /// A press that was under way stays forgotten until its force was released once, even if the contact goes
    /// on.
    pub fn cancel(&mut self) {
        (self.held, self.zone, self.moving, self.calm) = (None, None, None, None);
        self.is_acting = false;
        self.buttons.iter_mut().for_each(Touched::forget);
    }

    /// Goes on with another profile, also in the middle of a contact.
    ///
    /// The next step states the levels of the new profile, so whatever both profiles hold stays held. The
    /// direction and the pointer's way continue (the thresholds that end them apply, not those that start them); what was toggled
    /// does not. A press that was under way, or that the new profile would see as under way, does nothing in the new profile until its
    /// force was released once.
    pub fn replace_profile(&mut self, profile: Profile) {
        self.buttons = profile.buttons.iter().map(|button| self.taken_over(button)).collect();
        (self.zone, self.calm, self.is_acting) = (None, None, false);
        self.profile = profile;
    }

    /// Where a button of another profile stands that takes over now.
    fn taken_over(&self, button: &Button) -> Touched {
        let force_n = self.last.map_or(0.0, |contact| force_of(button.force, &contact));
        let mut same_force =
            self.profile.buttons.iter().zip(&self.buttons).filter(|(old, _)| old.force == button.force);
        let is_under_way = same_force.any(|(_, touched)| touched.is_under_way());
        if is_under_way || force_n >= button.press_n { Touched::spent(force_n) } else { Touched::fresh() }
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

fn is_finite(contact: &Contact) -> bool {
    let Contact { x_mm, y_mm, fx_n, fy_n, fz_n } = *contact;
    [x_mm, y_mm, fx_n, fy_n, fz_n].into_iter().all(f32::is_finite)
}
