//! The live core: one state machine from pad bytes to output events.
//!
//! It does no I/O and reads no clock; after construction it neither allocates nor panics. The caller tells it what
//! happened and when, in three kinds of calls: `handle_*` (the pad, the clock), mutators (the player), and getters.
//! Host time must not go backwards between calls. The same calls give the same events, byte for byte.
//!
//! After each call [`Pipeline::events`] holds what is to be emitted, and [`Pipeline::poll_timeout`] says when
//! [`Pipeline::handle_timeout`] must be called if nothing else happens before.

use firmware_proto::identity::Identity;
use firmware_proto::sample::Sample;

use crate::contact::Decoder;
use crate::contact::relief::Relief;
use crate::contact::thermometer::Thermometer;
use crate::contact::touch::{Touch, TouchState};
use crate::contact::watch::{Warning, Watch};
use crate::control::OutputEvent;
use crate::health::Health;
use crate::link::{Fault, Link, LinkEvent};
use crate::mapping::engine::Engine;
use crate::mapping::intent::Level;
use crate::mapping::profile::Profile;
use crate::output::ledger::{Edges, Ledger};
use crate::quantity::Contact;
use crate::signal::{Conditioned, Scale, Signal};
use crate::time::{HostInstant, StreamInstant};

/// After a fault a contact is believed again when the stream has been sound for this long.
pub const DISTRUST_US: u64 = 50_000;

/// A point inside the pipeline that a [`Probe`] can time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// A sample was unpacked from the bytes.
    Sample,
    /// Its contact was decoded.
    Contact,
    /// Its events were decided.
    Events,
}

/// Is told when a sample passes a stage. The live build passes [`NoProbe`], which costs nothing.
pub trait Probe {
    /// The sample at hand has passed `stage`.
    fn mark(&mut self, stage: Stage);
}

/// A probe that looks away.
#[derive(Clone, Copy, Debug)]
pub struct NoProbe;

impl Probe for NoProbe {
    fn mark(&mut self, _stage: Stage) {}
}

/// What the pipeline is doing, for people.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// No pad is heard.
    Waiting,
    /// The zero is being measured; the pad must lie untouched.
    Taring,
    /// Contacts become events.
    Playing,
    /// The line was at fault just now; contacts are not believed yet.
    Doubtful,
    /// A channel cannot be trusted.
    Faulty,
    /// The player paused.
    Paused,
    /// The pad cannot be played with.
    Refused,
}

/// Why a pad cannot be played with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// It speaks a newer version of the protocol.
    NewerVersion(u8),
    /// It identifies itself with numbers that no pad of ours has: channels, bits or scale.
    Unsuitable(Identity),
}

/// The state machine. See the module's text for how to drive it.
#[derive(Debug)]
pub struct Pipeline {
    link: Link,
    signal: Signal,
    relief: Relief,
    thermometer: Thermometer,
    decoder: Decoder,
    touch: Touch,
    watch: Watch,
    engine: Engine,
    ledger: Ledger,
    health: Health,
    identity: Option<Identity>,
    refusal: Option<Refusal>,
    contact: Option<Contact>,
    phase: Phase,
    paused: bool,
    /// Stream time of the newest event or sample; events never go back behind it.
    at: StreamInstant,
    /// From here on contacts are believed.
    trusted_at: StreamInstant,
    edges: Edges,
}

impl Pipeline {
    /// A pipeline that has heard nothing and holds nothing.
    pub fn new(decoder: Decoder, profile: Profile) -> Self {
        Self {
            link: Link::new(),
            signal: Signal::new(profile.filter_samples),
            relief: Relief::of(decoder.friction(), decoder.creep()),
            thermometer: Thermometer::of(decoder.thermal()),
            watch: Watch::new(decoder.inverse()),
            decoder,
            touch: Touch::new(),
            ledger: Ledger::new(&profile),
            engine: Engine::new(profile),
            health: Health::default(),
            identity: None,
            refusal: None,
            contact: None,
            phase: Phase::Waiting,
            paused: false,
            at: StreamInstant::default(),
            trusted_at: StreamInstant::default(),
            edges: Edges::new(),
        }
    }

    /// Takes bytes that came from the pad by `now`. Returns how many it took: it stops as soon as there are events,
    /// so that they get out first. Emit [`Pipeline::events`], then call again with the rest.
    pub fn handle_bytes<P: Probe>(&mut self, now: HostInstant, bytes: &[u8], probe: &mut P) -> usize {
        self.edges.clear();
        for (index, &byte) in bytes.iter().enumerate() {
            if let Some(event) = self.link.push(now, byte, &mut self.health) {
                self.handle_link(now, &event, probe);
                if !self.edges.is_empty() {
                    return index + 1;
                }
            }
        }
        self.check_silence(now);
        bytes.len()
    }

    /// Does what is due at `now`: releases what the minimum press held back, and everything if the pad is silent.
    pub fn handle_timeout(&mut self, now: HostInstant) {
        self.edges.clear();
        // Silence first: what the minimum press held back must not go down only to come up in the same group.
        self.check_silence(now);
        if let Some(due) = self.ledger.next_due().filter(|&due| self.link.host_at(due) <= now) {
            self.advance(due);
            self.ledger.settle(self.at, &mut self.edges);
        }
    }

    /// The pad was unplugged. Whatever comes next may be another pad: it identifies itself and is tared anew.
    pub fn handle_unplugged(&mut self, now: HostInstant) {
        self.edges.clear();
        self.lose(now);
        (self.identity, self.refusal) = (None, None);
        self.signal.forget_pad();
        self.relief = Relief::of(self.decoder.friction(), self.decoder.creep());
        self.thermometer = Thermometer::of(self.decoder.thermal());
        self.watch = Watch::new(self.decoder.inverse());
    }

    /// Host time of the next deadline; `None` if nothing is due before something else happens.
    pub fn poll_timeout(&self) -> Option<HostInstant> {
        let release = self.ledger.next_due().map(|due| self.link.host_at(due));
        [release, self.link.silent_at()].into_iter().flatten().min()
    }

    /// The events of the last call, simultaneous, releases first. Valid until the next call.
    pub fn events(&self) -> &[OutputEvent] {
        &self.edges
    }

    /// Releases everything and ignores contacts until [`Pipeline::resume`].
    pub fn pause(&mut self, now: HostInstant) {
        self.paused = true;
        self.release_all(now);
    }

    /// Ends a pause. A finger that is on the pad begins a new contact.
    pub fn resume(&mut self) {
        self.edges.clear();
        self.paused = false;
    }

    /// Releases everything at once. A finger that stays on the pad begins a new contact a moment later.
    pub fn release_all(&mut self, now: HostInstant) {
        self.edges.clear();
        self.advance(self.link.stream_at(now));
        self.distrust();
    }

    /// Measures the zero again; the pad must lie untouched.
    pub fn retare(&mut self, now: HostInstant) {
        self.release_all(now);
        self.touch = Touch::new();
        self.signal.retare();
    }

    /// Goes over to another profile: releases what it does not hold, keeps what both hold.
    pub fn set_profile(&mut self, now: HostInstant, profile: Profile) {
        self.edges.clear();
        self.advance(self.link.stream_at(now));
        self.ledger.change_profile(self.at, &profile, &mut self.edges);
        self.signal.set_filter_samples(profile.filter_samples);
        self.engine.replace_profile(profile);
        // Without a contact nothing is stated, and the engine must not take that for a lift: see `map`.
        if self.contact.is_some() {
            let levels = self.engine.step(self.at, self.contact.as_ref());
            self.ledger.update(self.at, &levels, &mut self.edges);
        }
    }

    /// Whether a pad is being heard: a sample came and the link has not been lost since.
    pub fn is_heard(&self) -> bool {
        self.link.silent_at().is_some()
    }

    /// The profile in use.
    pub const fn profile(&self) -> &Profile {
        self.engine.profile()
    }

    /// The contact that is being mapped; `None` while there is none.
    pub const fn contact(&self) -> Option<&Contact> {
        self.contact.as_ref()
    }

    /// What the player should know of the touch at hand or the last one; only the inverse decoder tells it.
    pub const fn warning(&self) -> Option<Warning> {
        self.watch.warning()
    }

    /// What is held now.
    pub fn held(&self) -> impl Iterator<Item = Level> + '_ {
        self.ledger.held()
    }

    /// Everything that went wrong so far.
    pub const fn health(&self) -> &Health {
        &self.health
    }

    /// What the pad told of itself, if it did.
    pub const fn identity(&self) -> Option<&Identity> {
        self.identity.as_ref()
    }

    /// Why this pad cannot be played with, if so. Its samples are not mapped.
    pub const fn refusal(&self) -> Option<&Refusal> {
        self.refusal.as_ref()
    }

    /// What the pipeline is doing.
    pub fn phase(&self) -> Phase {
        match self.phase {
            _ if self.paused => Phase::Paused,
            _ if self.refusal.is_some() => Phase::Refused,
            Phase::Playing if self.at < self.trusted_at => Phase::Doubtful,
            phase => phase,
        }
    }

    fn handle_link<P: Probe>(&mut self, now: HostInstant, event: &LinkEvent, probe: &mut P) {
        match event {
            LinkEvent::Sample { at, sample, fault } => {
                probe.mark(Stage::Sample);
                self.advance(*at);
                self.health.samples += 1;
                if let Some(fault) = fault {
                    self.handle_fault(*fault);
                }
                self.handle_sample(sample, probe);
                probe.mark(Stage::Events);
            }
            LinkEvent::Fault(fault) => {
                self.advance(self.link.stream_at(now));
                self.handle_fault(*fault);
            }
            LinkEvent::Identity(identity) => self.handle_identity(identity),
            LinkEvent::NewerVersion(version) => {
                self.refusal = Some(Refusal::NewerVersion(*version));
                self.advance(self.link.stream_at(now));
                self.distrust();
            }
        }
    }

    fn handle_sample<P: Probe>(&mut self, sample: &Sample, probe: &mut P) {
        let (touched, rest) = (self.touch.is_touched(), self.relief.rest());
        self.thermometer.follow(self.at, sample, touched);
        let added_uv = self.thermometer.added_uv();
        match self.signal.condition(self.at, sample, touched, &rest, &added_uv, &mut self.health) {
            Conditioned::Strain(strain) => {
                let strain = self.relief.freed(&self.thermometer.at_reference(&strain));
                let (contact, explained) = self.decoder.explain(&strain);
                probe.mark(Stage::Contact);
                self.phase = Phase::Playing;
                let touched = self.handle_touch(&contact);
                self.relief.follow(self.at, touched.then_some(&strain));
                if let Some((explained, inverse)) = explained.zip(self.decoder.inverse()) {
                    self.watch.see(self.at, &strain, &explained, touched, inverse, &mut self.health);
                }
                self.map(touched.then_some(contact));
            }
            Conditioned::Taring => {
                self.phase = Phase::Taring;
                self.relief.wait(self.at);
                self.watch.interrupt();
                self.map(None);
            }
            Conditioned::Faulty => {
                self.phase = Phase::Faulty;
                self.relief.wait(self.at);
                self.distrust();
            }
        }
    }

    fn handle_touch(&mut self, contact: &Contact) -> bool {
        match self.touch.update(self.at, contact) {
            TouchState::Touched => true,
            TouchState::Idle => false,
            TouchState::Drifted => {
                self.signal.retare();
                // What was followed from a wrong zero is wrong, too.
                self.relief = Relief::of(self.decoder.friction(), self.decoder.creep());
                false
            }
        }
    }

    fn handle_fault(&mut self, fault: Fault) {
        if fault == Fault::Restarted {
            // It may tell other numbers of itself now.
            self.identity = None;
            self.signal.restart();
            self.relief.doubt();
            self.touch = Touch::new();
        }
        self.signal.clear_filter();
        self.distrust();
    }

    fn handle_identity(&mut self, identity: &Identity) {
        if self.identity.replace(*identity) == Some(*identity) {
            return;
        }
        match Scale::of(identity) {
            Some(scale) => {
                self.refusal = None;
                self.signal.set_scale(scale);
                self.relief.doubt();
            }
            None => self.refusal = Some(Refusal::Unsuitable(*identity)),
        }
        self.touch = Touch::new();
        self.distrust();
    }

    /// Maps the contact and settles with the ledger; does nothing while contacts are not believed.
    fn map(&mut self, contact: Option<Contact>) {
        if self.paused || self.refusal.is_some() || self.at < self.trusted_at {
            // The engine is not told of a lift: a press that a fault cut short stays dead until it really ends.
            return;
        }
        self.health.contacts += u64::from(contact.is_some() && self.contact.is_none());
        self.contact = contact;
        let levels = self.engine.step(self.at, self.contact.as_ref());
        self.ledger.update(self.at, &levels, &mut self.edges);
    }

    /// Ends the contact without believing it: presses are forgotten, everything is released at once.
    fn distrust(&mut self) {
        self.watch.interrupt();
        self.contact = None;
        self.engine.cancel();
        self.ledger.release_all(self.at, &mut self.edges);
        self.trusted_at = self.at.plus_us(DISTRUST_US);
    }

    fn check_silence(&mut self, now: HostInstant) {
        if self.link.silent_at().is_some_and(|silent_at| silent_at <= now) {
            self.lose(now);
        }
    }

    fn lose(&mut self, now: HostInstant) {
        self.health.links_lost += 1;
        self.link.lose(now);
        self.advance(self.link.stream_at(now));
        self.phase = Phase::Waiting;
        self.touch.end();
        self.signal.clear_filter();
        self.relief.doubt();
        self.distrust();
    }

    fn advance(&mut self, at: StreamInstant) {
        self.at = self.at.max(at);
    }
}
