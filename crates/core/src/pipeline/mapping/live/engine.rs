//! The live mapping: contacts in, levels out.

use arrayvec::ArrayVec;

use super::button::{ButtonState, Ruling, force_of};
use super::directions::{DirectionGates, Directions};
use super::intent::Intents;
use super::interrupt::{Decision, Interrupts, PressSet, Undecided};
use super::macros::MacroPlayback;
use super::stated::{Commands, StepOutput};
use super::verdict::{Verdict, VerdictEvent, Verdicts};
use crate::pipeline::mapping::live::Presses;
use crate::pipeline::mapping::live::contact::heading;
use crate::pipeline::mapping::live::contact::pointer::{self, PointerOutput};
use crate::pipeline::mapping::live::contact::rest::{Load, RestDetector};
use crate::pipeline::mapping::live::contact::tremor::TremorFilter;
use crate::pipeline::mapping::live::contact::zone;
use crate::pipeline::mapping::profile::sector::Sector;
use crate::pipeline::mapping::profile::{
    Action, BUTTONS_MAX, Button, ButtonPlace, Direction, HoldOn, Output, Profile, SIDES, TimedEffect, When,
};
use crate::quantity::Contact;
use crate::time::StreamInstant;

/// Plays one profile. `mappings/README.md` states its rules.
///
/// All decisions are taken at samples, from their stream times: a long press starts to hold with the first
/// sample at or after its moment. There is no timer.
#[derive(Clone, Debug)]
pub struct Engine {
    profile: Profile,
    held: Option<Sector>,
    zone: Option<usize>,
    moving: Option<PointerOutput>,
    buttons: ArrayVec<ButtonState, BUTTONS_MAX>,
    interrupts: Interrupts,
    last: Option<Contact>,
    calm: Option<TremorFilter>,
    resting: Option<RestDetector>,
    directed: DirectionGates,
    directions: Directions,
    /// The layer that is on.
    layer: Option<usize>,
    running: MacroPlayback,
    /// Whether each stick is moved.
    sticks: [bool; SIDES],
    /// What presses of the last step ask of the bridge.
    commands: Commands,
    is_acting: bool,
    presses: Presses,
    verdicts: Verdicts,
}

impl Engine {
    /// An engine that has seen no contact yet.
    pub fn new(profile: Profile) -> Self {
        let buttons = profile.buttons.iter().map(|_| ButtonState::fresh()).collect();
        Self {
            profile,
            held: None,
            zone: None,
            moving: None,
            buttons,
            interrupts: Interrupts::default(),
            last: None,
            calm: None,
            resting: None,
            directed: DirectionGates::fresh(),
            directions: Directions::default(),
            layer: None,
            running: MacroPlayback::default(),
            sticks: [false; SIDES],
            commands: Commands::new(),
            is_acting: false,
            presses: Presses::default(),
            verdicts: Verdicts::default(),
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
        let mut stated = StepOutput::default();
        self.direct(t, contact);
        self.zone = contact.and_then(|contact| zone::follow(&self.profile.zones, self.zone, contact));
        let decision = self.decide(t, contact);
        self.press(t, decision, &mut stated);
        self.unlatch();
        self.moving = self
            .profile
            .pointer
            .as_ref()
            .zip(contact)
            .and_then(|(pointer, contact)| pointer::follow(pointer, self.moving, contact));
        stated.state_motion(self.moving);
        self.steer(contact, &mut stated);
        self.running.step(&self.profile, t, &mut stated);
        self.layer = stated.layer;
        self.commands = stated.commands;
        stated.levels
    }

    /// Follows the directions to `t`.
    fn direct(&mut self, t: StreamInstant, contact: Option<&Contact>) {
        let Some(dpad) = &self.profile.dpad else {
            // The profile before may have had directions.
            (self.held, self.directed, self.directions) =
                (None, DirectionGates::fresh(), Directions::default());
            return;
        };
        self.held = contact.and_then(|contact| heading::follow(dpad, self.held, contact));
        self.directions = self.directed.step(
            self.profile.access,
            t,
            self.held,
            contact,
            &mut self.presses,
            &mut self.verdicts,
        );
    }

    /// States the directions.
    fn state_directions(&self, decision: Decision, stated: &mut StepOutput) {
        let Some(dpad) = &self.profile.dpad else { return };
        let layer = self.layer.and_then(|number| self.profile.layers.get(number));
        for direction in decision.directions(self.directions) {
            let (own, in_layer) = match direction {
                Direction::Left => (dpad.left, layer.and_then(|layer| layer.left)),
                Direction::Right => (dpad.right, layer.and_then(|layer| layer.right)),
                Direction::Up => (dpad.up, layer.and_then(|layer| layer.up)),
                Direction::Down => (dpad.down, layer.and_then(|layer| layer.down)),
            };
            in_layer.unwrap_or(own).iter().for_each(|binding| stated.state(binding));
        }
    }

    /// States where sticks and triggers are.
    fn steer(&mut self, contact: Option<&Contact>, stated: &mut StepOutput) {
        for (stick, is_held) in self.profile.sticks.iter().zip(&mut self.sticks) {
            let position = contact.and_then(|contact| stick.follow(*is_held, contact));
            *is_held = position.is_some();
            stick
                .axes()
                .into_iter()
                .zip(position.unwrap_or_default())
                .for_each(|(code, value)| stated.state_axis(code, value));
        }
        let (zone, directions) = (self.zone, self.directions);
        for trigger in self.profile.triggers.iter().filter(|trigger| is_in(zone, directions, trigger.place)) {
            let position = contact.map_or(0, |contact| trigger.position(contact.fz_n));
            stated.state_axis(trigger.axis(), position);
        }
    }

    /// Presses of which it is open at `t` whether they are taps or holds, where another press may decide it.
    fn undecided(&self, t: StreamInstant) -> ArrayVec<Undecided, BUTTONS_MAX> {
        let buttons = self.profile.buttons.iter().zip(&self.buttons).enumerate();
        let counting = buttons.filter(|(_, (button, _))| button.when.is_met(self.layer));
        let undecided = counting.filter_map(|(number, (button, state))| {
            let (hold, hold_on) = interruptible(button)?;
            let is_due = t.us_since(state.undecided()?) >= hold.us;
            Some(Undecided { button: number, hold_on, is_due, layer: layer_of(hold) })
        });
        undecided.collect()
    }

    /// Follows the forces of all buttons to `t`, and says what their presses make of each other.
    fn decide(&mut self, t: StreamInstant, contact: Option<&Contact>) -> Decision {
        let (zone, directions, layer) = (self.zone, self.directions, self.layer);
        let undecided = self.undecided(t);
        // A press that comes meanwhile may turn out to be one of the layer that is then on.
        let may_be_met = |when: When| {
            let mut ahead = undecided.iter().filter_map(|it| it.layer);
            when.is_met(layer) || ahead.any(|number| when == When::Layer(number))
        };
        let access = self.profile.access;
        let mut on = PressSet::directions(directions);
        for (number, (button, state)) in self.profile.buttons.iter().zip(&mut self.buttons).enumerate() {
            if !may_be_met(button.when) {
                state.doze(button, contact);
                continue;
            }
            // A lifted contact was where it was.
            let is_in_place = contact.is_none() || is_in(zone, directions, button.place);
            let before = self.presses;
            state.feel(button, t, contact, is_in_place, access, &mut self.presses);
            if let Some(is_rejected) = self.presses.since(before) {
                let rejected = is_rejected.then(|| state.why_rejected(button, access, t));
                self.verdicts
                    .keep(Verdict { t, told: VerdictEvent::Button { number: number + 1, rejected } });
            }
            if state.is_pressed(button) {
                on = on | PressSet::button(number);
            }
        }
        self.interrupts.step(on, &undecided)
    }

    /// States what the directions and the buttons do. A layer that one of them switches counts from the next sample on; that of a hold
    /// that another press decided is on at once, so that the other press is in it.
    fn press(&mut self, t: StreamInstant, decision: Decision, stated: &mut StepOutput) {
        let before = self.layer;
        let holds = |number| decision.of(number) == Ruling::Hold;
        for (_, button) in self.profile.buttons.iter().enumerate().filter(|(number, _)| holds(*number)) {
            self.layer = interruptible(button).and_then(|(hold, _)| layer_of(hold)).or(self.layer);
        }
        self.is_acting |= decision.replayed != PressSet::NONE;
        self.state_directions(decision, stated);
        let layer = self.layer;
        for (number, (button, state)) in self.profile.buttons.iter().zip(&mut self.buttons).enumerate() {
            let counts = if holds(number) { before } else { layer };
            if button.when.is_met(counts) {
                state.play(button, t, decision.of(number)).for_each(|playing| stated.take(playing));
            } else {
                state.sleep(button, t).for_each(|playing| stated.take(playing));
            }
        }
    }

    /// The place that the hand means: calmed, counted from its centre, and stretched where it does not reach.
    fn meant(&mut self, t: StreamInstant, contact: Option<&Contact>) -> Option<Contact> {
        let Some(contact) = contact else {
            (self.calm, self.resting) = (None, None);
            return None;
        };
        let access = self.profile.access;
        let load =
            access.rest.map_or(Load::Touch, |rest| RestDetector::step(&mut self.resting, rest, t, contact));
        if let Load::Rest { is_news } = load {
            if is_news {
                self.verdicts.keep(Verdict { t, told: VerdictEvent::Rest });
            }
            self.calm = None;
            return None;
        }
        let calmed = match &access.tremor {
            Some(tremor) => TremorFilter::step(&mut self.calm, tremor, t, contact),
            None => *contact,
        };
        let [x_mm, y_mm] = self.profile.centre_mm;
        let from_centre = Contact { x_mm: calmed.x_mm - x_mm, y_mm: calmed.y_mm - y_mm, ..calmed };
        Some(self.profile.gain.applied(&from_centre))
    }

    /// Lets latched keys go where an action has ended.
    fn unlatch(&mut self) {
        let buttons = || self.profile.buttons.iter().zip(&self.buttons);
        let is_acting =
            !self.directions.is_empty() || buttons().any(|(button, state)| state.is_acting(button));
        if self.is_acting && !is_acting {
            self.buttons.iter_mut().for_each(ButtonState::unlatch);
        }
        self.is_acting = is_acting;
    }

    /// What presses of the last step ask of the bridge.
    pub const fn commands(&self) -> &Commands {
        &self.commands
    }

    /// The name of the layer that is on.
    pub fn layer(&self) -> Option<&str> {
        self.layer.and_then(|number| self.profile.layers.get(number)).map(|layer| layer.name.as_str())
    }

    /// How many presses counted since the engine began, and how many did not.
    pub const fn presses(&self) -> Presses {
        self.presses
    }

    /// What became of presses, and when a hand began to rest, since [`Self::forget_verdicts`], as far as there was room: the oldest first.
    pub fn verdicts(&self) -> &[Verdict] {
        self.verdicts.all()
    }

    /// Forgets what became of presses.
    pub fn forget_verdicts(&mut self) {
        self.verdicts.clear();
    }

    /// After a fault (lost link, dead channel, pause): forgets directions, the pointer's way, presses and what they toggled;
    /// nothing is tapped for them.
    ///
    /// A press that was under way stays forgotten until its force was released once, even if the contact goes
    /// on.
    pub fn cancel(&mut self) {
        (self.held, self.zone, self.moving, self.calm, self.resting) = (None, None, None, None, None);
        (self.layer, self.is_acting) = (None, false);
        self.running.forget();
        (self.directed, self.directions) = (DirectionGates::fresh(), Directions::default());
        self.sticks = [false; SIDES];
        self.commands.clear();
        self.interrupts = Interrupts::default();
        self.buttons.iter_mut().for_each(ButtonState::forget);
    }

    /// Goes on with another profile, also in the middle of a contact.
    ///
    /// If it is the same profile, but for what was changed in it, then a button that stands unchanged goes on as if nothing had been.
    ///
    /// The next step states the levels of the new profile, so whatever both profiles hold stays held. The
    /// direction and the pointer's way continue (the thresholds that end them apply, not those that start them); what was toggled
    /// does not. A press that was under way, or that the new profile would see as under way, does nothing in the new profile until its
    /// force was released once.
    pub fn replace_profile(&mut self, profile: Profile) {
        let is_changed_only = self.profile.name == profile.name;
        let taken_over = |button: &Button| match self.unchanged(button) {
            Some(state) if is_changed_only => state,
            _ => self.taken_over(button),
        };
        self.buttons = profile.buttons.iter().map(taken_over).collect();
        if self.profile.zones != profile.zones {
            self.zone = None;
        }
        if self.profile.access != profile.access {
            self.calm = None;
        }
        if self.profile.layers != profile.layers {
            self.layer = None;
        }
        if self.profile.macros != profile.macros {
            self.running.forget();
        }
        (self.sticks, self.is_acting) = ([false; SIDES], false);
        self.interrupts = Interrupts::taken_over();
        self.profile = profile;
    }

    /// Where the same button stands.
    fn unchanged(&self, button: &Button) -> Option<ButtonState> {
        let mut all = self.profile.buttons.iter().zip(&self.buttons);
        all.find(|(old, _)| *old == button).map(|(_, state)| *state)
    }

    /// Where a button of another profile stands that takes over now.
    fn taken_over(&self, button: &Button) -> ButtonState {
        let force_n = self.last.map_or(0.0, |contact| force_of(button.force, &contact));
        let mut same_force =
            self.profile.buttons.iter().zip(&self.buttons).filter(|(old, _)| old.force == button.force);
        let is_under_way = same_force.any(|(_, state)| state.is_under_way());
        if is_under_way || force_n >= button.press_n {
            ButtonState::spent(force_n)
        } else {
            ButtonState::fresh()
        }
    }
}

/// The long press of a button, if other presses can make one of its presses that.
fn interruptible(button: &Button) -> Option<(TimedEffect, HoldOn)> {
    match button.action {
        Action::ByTime { hold: Some(hold), hold_on, .. } if hold_on != HoldOn::Time => Some((hold, hold_on)),
        _ => None,
    }
}

/// The layer that a long press switches on.
const fn layer_of(hold: TimedEffect) -> Option<usize> {
    if let Output::Layer(number) = hold.effect.output { Some(number) } else { None }
}

/// Whether the contact is there, being in this zone and having these directions.
fn is_in(zone: Option<usize>, directions: Directions, place: Option<ButtonPlace>) -> bool {
    match place {
        None => true,
        Some(ButtonPlace::Zone(number)) => zone == Some(number),
        Some(ButtonPlace::Direction(direction)) => directions.has(direction),
    }
}

fn is_finite(contact: &Contact) -> bool {
    let Contact { x_mm, y_mm, fx_n, fy_n, fz_n } = *contact;
    [x_mm, y_mm, fx_n, fy_n, fz_n].into_iter().all(f32::is_finite)
}
