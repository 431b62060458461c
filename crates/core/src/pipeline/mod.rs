//! The live core: one state machine from pad bytes to output events.
//!
//! It does no I/O and reads no clock; after construction it neither allocates nor panics. The caller tells it what
//! happened and when, in three kinds of calls: `handle_*` (the pad, the clock), mutators (the player), and getters.
//! Host time must not go backwards between calls. The same calls give the same events, byte for byte.
//!
//! [`Pipeline::apply`] makes any of these calls, each as a [`call::Call`] that a capture can keep.
//!
//! After each call [`Pipeline::events`] holds what is to be emitted, and [`Pipeline::poll_timeout`] says when
//! [`Pipeline::handle_timeout`] must be called if nothing else happens before.

pub mod call;
pub mod capture;
pub mod compensation;
pub mod contact;
pub mod control;
pub mod health;
pub mod interruption;
pub mod line_check;
pub mod link;
mod look;
pub mod mapping;
pub mod output;
mod phase;
pub mod probe;
pub mod refusal;
pub mod replay;
pub mod shipped;
pub mod signal;
pub mod weighing;

use firmware_proto::identity::{Identity, SerialNumber};

use crate::pad::weight::Weight;
use crate::pipeline::call::Call;
use crate::pipeline::contact::Decoder;
use crate::pipeline::contact::stage::{ContactStage, DecodedSample};
use crate::pipeline::control::OutputEvent;
use crate::pipeline::health::Health;
use crate::pipeline::interruption::{Cause, Effect};
use crate::pipeline::link::reading::Reading;
use crate::pipeline::link::{Fault, Link, LinkEvent};
use crate::pipeline::mapping::live::engine::Engine;
use crate::pipeline::mapping::live::stated::Commands;
use crate::pipeline::mapping::profile::{Command, Profile};
use crate::pipeline::output::ledger::{Edges, Ledger};
pub use crate::pipeline::phase::Phase;
pub use crate::pipeline::probe::{NoProbe, PipelineStage, Probe};
use crate::pipeline::refusal::Refusal;
use crate::pipeline::weighing::refusal::WeighError;
use crate::pipeline::weighing::{Weighing, WeighingSample};
use crate::quantity::{CHANNELS, Contact};
use crate::time::{HostInstant, StreamInstant};

/// After a fault a contact is believed again when the stream has been sound for this long.
pub const DISTRUST_US: u64 = 50_000;

/// The state machine. See the module's text for how to drive it.
#[derive(Clone, Debug)]
pub struct Pipeline {
    link: Link,
    stage: ContactStage,
    engine: Engine,
    ledger: Ledger,
    health: Health,
    identity: Option<Identity>,
    /// The pad that told its name last, since it was plugged in.
    pad: Option<SerialNumber>,
    weighing: Weighing,
    refusal: Option<Refusal>,
    contact: Option<Contact>,
    phase: Phase,
    paused: bool,
    /// Stream time of the newest event or sample; events never go back behind it.
    at: StreamInstant,
    /// From here on contacts are believed.
    trusted_at: StreamInstant,
    edges: Edges,
    commands: Commands,
}

impl Pipeline {
    /// A pipeline that has heard nothing and holds nothing.
    pub fn new(decoder: Decoder, profile: Profile) -> Self {
        Self {
            link: Link::new(),
            stage: ContactStage::new(decoder, profile.filter()),
            ledger: Ledger::new(&profile),
            engine: Engine::new(profile),
            health: Health::default(),
            identity: None,
            pad: None,
            weighing: Weighing::default(),
            refusal: None,
            contact: None,
            phase: Phase::Waiting,
            paused: false,
            at: StreamInstant::default(),
            trusted_at: StreamInstant::default(),
            edges: Edges::new(),
            commands: Commands::new(),
        }
    }

    /// Makes one call at host time `now`. Bytes are taken up to the first events, see [`Pipeline::handle_bytes`]: emit
    /// [`Pipeline::events`], then make the call that comes back, which carries the rest; `None` when all was taken.
    #[must_use = "the rest of the bytes are still to be taken"]
    pub fn apply<'a, P: Probe>(
        &mut self,
        now: HostInstant,
        call: Call<'a>,
        probe: &mut P,
    ) -> Option<Call<'a>> {
        match call {
            // No byte, no call: not even the clock is looked at.
            Call::Bytes([]) => self.edges.clear(),
            Call::Bytes(bytes) => {
                let taken = self.handle_bytes(now, bytes, probe);
                return bytes.get(taken..).filter(|rest| !rest.is_empty()).map(Call::Bytes);
            }
            Call::Timeout => self.handle_timeout(now),
            Call::Unplugged => self.handle_unplugged(now),
            Call::Pause => self.pause(now),
            Call::Resume => self.resume(),
            Call::ReleaseAll => self.release_all(now),
            Call::Retare => self.retare(now),
            Call::Weigh(weight) => self.weigh(now, weight),
            Call::Profile(read) => self.set_profile(now, read.profile().clone()),
        }
        None
    }

    /// Takes bytes that came from the pad by `now`. Returns how many it took: it stops as soon as there are events,
    /// so that they get out first. Emit [`Pipeline::events`], then call again with the rest.
    pub fn handle_bytes<P: Probe>(&mut self, now: HostInstant, bytes: &[u8], probe: &mut P) -> usize {
        self.begin();
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
        self.begin();
        // Silence first: what the minimum press held back must not go down only to come up in the same group.
        self.check_silence(now);
        if let Some(due) = self.ledger.next_due().filter(|&due| self.link.host_at(due) <= now) {
            self.advance(due);
            self.ledger.settle(self.at, &mut self.edges);
        }
    }

    /// The pad was unplugged. Whatever comes next may be another pad: it identifies itself and is tared anew.
    pub fn handle_unplugged(&mut self, now: HostInstant) {
        self.begin();
        self.link.unplug(now);
        self.lose(now, Cause::Unplugged);
        (self.identity, self.pad, self.refusal) = (None, None, None);
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

    /// Commands that presses asked of the bridge in the last call, in their order. Valid until the next call. The pipeline does none of it by
    /// itself: who drives it makes the call that is meant, so that a capture has it, too.
    pub fn commands(&self) -> &[Command] {
        &self.commands
    }

    /// Releases everything and ignores contacts until [`Pipeline::resume`]. Only a profile's own commands still count, so that who has
    /// no other input can go on.
    pub fn pause(&mut self, now: HostInstant) {
        self.paused = true;
        self.release_all(now);
    }

    /// Ends a pause. A finger that is on the pad begins a new contact.
    pub fn resume(&mut self) {
        self.begin();
        if self.profile().commands().next().is_some() {
            // The press that asked for it does nothing else.
            self.engine.cancel();
        }
        self.paused = false;
    }

    /// Releases everything at once. A finger that stays on the pad begins a new contact a moment later.
    pub fn release_all(&mut self, now: HostInstant) {
        self.begin();
        self.advance(self.link.stream_at(now));
        self.interrupt(Cause::Released);
    }

    /// Measures the zero again; the pad must lie untouched.
    pub fn retare(&mut self, now: HostInstant) {
        self.begin();
        self.advance(self.link.stream_at(now));
        self.interrupt(Cause::Retared);
    }

    /// Releases everything, and weighs a known weight that is put on the plate, see [`Pipeline::weighing`]. Contacts are not mapped until
    /// it is taken away. What it tells of the pad counts at once, until the pad is another one.
    pub fn weigh(&mut self, now: HostInstant, weight: Weight) {
        self.begin();
        self.advance(self.link.stream_at(now));
        self.interrupt(Cause::Weighing);
        self.weighing.begin(self.at, weight);
        if !self.is_heard() || self.refusal.is_some() {
            self.weighing.end(Err(WeighError::NoPad));
        } else if self.strain().is_none() && self.phase == Phase::Playing
            || self.stage.decoder().channels() != CHANNELS
        {
            self.weighing.end(Err(WeighError::NoNineChannels));
        }
    }

    /// Goes over to another profile: releases what it does not hold, keeps what both hold.
    pub fn set_profile(&mut self, now: HostInstant, profile: Profile) {
        self.begin();
        self.advance(self.link.stream_at(now));
        self.ledger.change_profile(self.at, &profile, &mut self.edges);
        self.stage.set_filter(profile.filter());
        self.engine.replace_profile(profile);
        // Without a contact nothing is stated, and the engine must not take that for a lift: see `map`.
        if self.contact.is_some() {
            let levels = self.engine.step(self.at, self.contact.as_ref());
            self.ledger.update(self.at, &levels, &mut self.edges);
        }
    }

    fn handle_link<P: Probe>(&mut self, now: HostInstant, event: &LinkEvent, probe: &mut P) {
        match event {
            LinkEvent::Sample { at, reading, fault } => {
                probe.mark(PipelineStage::Sample);
                self.advance(*at);
                self.health.samples += 1;
                if let Some(fault) = fault {
                    self.handle_fault(*fault);
                }
                self.handle_sample(reading, probe);
                probe.mark(PipelineStage::Events);
            }
            LinkEvent::Fault(fault) => {
                self.advance(self.link.stream_at(now));
                self.handle_fault(*fault);
            }
            LinkEvent::Identity(identity) => self.handle_identity(identity),
            LinkEvent::NewerVersion(version) => {
                self.refusal = Some(Refusal::NewerVersion(*version));
                self.advance(self.link.stream_at(now));
                self.interrupt(Cause::NewerVersion);
            }
        }
    }

    fn handle_sample<P: Probe>(&mut self, sample: &Reading, probe: &mut P) {
        let reading = self.stage.take(self.at, sample, &mut self.health, probe);
        self.look_at_weight(reading);
        let is_suited = !matches!(reading, DecodedSample::Unsuited { .. });
        if is_suited && matches!(self.refusal, Some(Refusal::OtherChannels { .. })) {
            self.refusal = None;
        }
        match reading {
            DecodedSample::Contact(contact) => {
                self.phase = Phase::Playing;
                self.map(contact.filter(|_| !self.weighing.hides()));
            }
            DecodedSample::Taring => self.tare(Phase::Taring),
            DecodedSample::Loaded => self.tare(Phase::Loaded),
            DecodedSample::Faulty => {
                self.phase = Phase::Faulty;
                self.interrupt(Cause::Faulty);
            }
            DecodedSample::Unsuited { channels } => self.refuse_channels(channels),
            DecodedSample::Doubtful => {
                if self.phase != Phase::Faulty {
                    self.interrupt(Cause::Doubted);
                }
                self.phase = Phase::Faulty;
            }
        }
    }

    /// The pad has another number of channels than the decoder is for.
    fn refuse_channels(&mut self, channels: usize) {
        let wanted = self.stage.decoder().channels();
        self.refusal = self.refusal.or(Some(Refusal::OtherChannels { channels, wanted }));
        self.interrupt(Cause::Unsuitable);
    }

    fn look_at_weight(&mut self, reading: DecodedSample) {
        let seen = match reading {
            DecodedSample::Contact(contact) => {
                contact.and(self.stage.strain()).map_or(WeighingSample::Nothing, WeighingSample::Load)
            }
            DecodedSample::Taring | DecodedSample::Loaded => WeighingSample::NoZero,
            DecodedSample::Faulty | DecodedSample::Doubtful | DecodedSample::Unsuited { .. } => {
                WeighingSample::Faulty
            }
        };
        let ratio = self.weighing.see(self.at, seen, self.stage.gain().factor(), self.stage.decoder());
        if let Some(ratio) = ratio {
            self.stage.regain(ratio);
        }
    }

    fn tare(&mut self, phase: Phase) {
        self.phase = phase;
        self.interrupt(Cause::Taring);
        self.map(None);
    }

    fn handle_fault(&mut self, fault: Fault) {
        if fault == Fault::Restarted {
            // It may tell other numbers of itself now.
            self.identity = None;
        }
        // While the zero is measured, a clock that jumps may be a pad that began anew, whose number is near by chance.
        let may_be_anew = fault == Fault::TimeJump && self.phase == Phase::Taring;
        self.interrupt(if may_be_anew { Cause::Retared } else { fault.into() });
    }

    fn handle_identity(&mut self, identity: &Identity) {
        if self.identity.replace(*identity) == Some(*identity) {
            return;
        }
        let scale = self.stage.scale_of(identity);
        self.refusal = if scale.is_some() { None } else { Some(Refusal::Unsuitable(*identity)) };
        let is_other =
            self.pad.replace(identity.serial_number).is_some_and(|pad| pad != identity.serial_number);
        let cause = match scale {
            Some(scale) if self.stage.set_scale(scale) => Cause::Rescaled,
            Some(_) if is_other => Cause::Exchanged,
            Some(_) => Cause::Identified,
            None => Cause::Unsuitable,
        };
        self.interrupt(cause);
    }

    /// Maps the contact and settles with the ledger; does nothing while contacts are not believed.
    fn map(&mut self, contact: Option<Contact>) {
        if self.refusal.is_some() || self.at < self.trusted_at {
            // The engine is not told of a lift: a press that a fault cut short stays dead until it really ends.
            return;
        }
        if self.paused {
            if self.profile().commands().next().is_some() {
                let _ = self.engine.step(self.at, contact.as_ref());
                self.take_commands();
            }
            return;
        }
        self.health.contacts += u64::from(contact.is_some() && self.contact.is_none());
        self.contact = contact;
        let levels = self.engine.step(self.at, self.contact.as_ref());
        self.take_commands();
        self.ledger.update(self.at, &levels, &mut self.edges);
    }

    /// Takes up what the engine's last step asks of the bridge.
    fn take_commands(&mut self) {
        for command in self.engine.commands() {
            // More in one call than there is room for: nobody presses so fast.
            let _ = self.commands.try_push(*command);
        }
    }

    /// Does to each part what [`Cause::effects`] says.
    fn interrupt(&mut self, cause: Cause) {
        self.stage.interrupt(cause);
        self.weighing.interrupt(cause.effects().weighing);
        if cause.effects().contact != Effect::Keep {
            self.contact = None;
            self.engine.cancel();
            self.ledger.release_all(self.at, &mut self.edges);
            self.trusted_at = self.at.plus_us(DISTRUST_US);
        }
    }

    fn check_silence(&mut self, now: HostInstant) {
        if self.link.silent_at().is_some_and(|silent_at| silent_at <= now) {
            self.link.fall_silent(now);
            self.lose(now, Cause::Lost);
        }
    }

    fn lose(&mut self, now: HostInstant, cause: Cause) {
        self.health.links_lost += 1;
        self.advance(self.link.stream_at(now));
        self.phase = Phase::Waiting;
        self.interrupt(cause);
    }

    /// Nothing has come of this call yet.
    fn begin(&mut self) {
        self.edges.clear();
        self.commands.clear();
    }

    fn advance(&mut self, at: StreamInstant) {
        self.at = self.at.max(at);
    }
}
