//! What there is to see of a pipeline.

use firmware_proto::identity::Identity;

use super::Pipeline;
use super::contact::uncertainty::Estimate;
use super::contact::watch::Warning;
use super::health::Health;
use super::line_check::LineFinding;
use super::mapping::profile::Profile;
use super::phase::Phase;
use super::refusal::Refusal;
use super::weighing::WeighingReport;
use crate::pipeline::mapping::live::Presses;
use crate::pipeline::mapping::live::intent::Level;
use crate::pipeline::mapping::live::verdict::Verdict;
use crate::quantity::{CHANNELS, Contact, Strain};
use crate::time::{HostInstant, StreamInstant};

impl Pipeline {
    /// Whether a pad is being heard: a sample came and the link has not been lost since.
    pub fn is_heard(&self) -> bool {
        self.link.silent_at().is_some()
    }

    /// Stream time of the newest event or sample.
    pub const fn at(&self) -> StreamInstant {
        self.at
    }

    /// The profile in use.
    pub const fn profile(&self) -> &Profile {
        self.engine.profile()
    }

    /// The name of the profile's layer that is on.
    pub fn layer(&self) -> Option<&str> {
        self.engine.layer()
    }

    /// How many presses of buttons and directions counted, and how many did not.
    pub const fn presses(&self) -> Presses {
        self.engine.presses()
    }

    /// What became of presses since [`Pipeline::forget_verdicts`]: who is told of each takes them after each call.
    pub fn verdicts(&self) -> &[Verdict] {
        self.engine.verdicts()
    }

    /// Forgets what became of presses.
    pub fn forget_verdicts(&mut self) {
        self.engine.forget_verdicts();
    }

    /// The contact that is being mapped; `None` while there is none.
    pub const fn contact(&self) -> Option<&Contact> {
        self.contact.as_ref()
    }

    /// The channels of the newest sample as the decoder got them; `None` while there are none that can be trusted.
    pub fn strain(&self) -> Option<&Strain> {
        self.stage.strain().filter(|_| self.is_heard())
    }

    /// What the channels of the newest sample read, in microvolts: raw, not tared; zeros before the first one.
    pub const fn raw_uv(&self) -> &[f64; CHANNELS] {
        self.stage.raw_uv()
    }

    /// How sure the contact is that is being mapped, if there is one and the decoder knows. Decodes it anew.
    pub fn estimate(&self) -> Option<Estimate> {
        self.contact.and_then(|_| self.stage.estimate())
    }

    /// Warning about the touch at hand or the last one; only the inverse decoder tells it.
    pub const fn warning(&self) -> Option<Warning> {
        self.stage.warning()
    }

    /// The newest weighing, if there was one.
    pub const fn weighing(&self) -> Option<&WeighingReport> {
        self.weighing.account()
    }

    /// What the pad reads, over what it would read if it were as it was calibrated: 1 unless a weighing told otherwise.
    pub const fn gain(&self) -> f64 {
        self.stage.gain().factor()
    }

    /// What is held now.
    pub fn held(&self) -> impl Iterator<Item = Level> + '_ {
        self.ledger.held()
    }

    /// Everything that went wrong so far.
    pub const fn health(&self) -> &Health {
        &self.health
    }

    /// What is wrong with the pad's stream as a whole, if anything is.
    pub const fn line_finding(&self) -> Option<&LineFinding> {
        self.link.finding()
    }

    /// Whether no sample has come for a second, not even one that cannot be used.
    pub fn is_quiet(&self, now: HostInstant) -> bool {
        self.link.is_quiet(now)
    }

    /// What the pad told of itself, if it did.
    pub const fn identity(&self) -> Option<&Identity> {
        self.identity.as_ref()
    }

    /// Why this pad cannot be played with, if so. Its samples are not mapped.
    pub const fn refusal(&self) -> Option<&Refusal> {
        self.refusal.as_ref()
    }

    /// Whether nobody was weighed yet on a pad that somebody is to stand on.
    pub const fn awaits_weight(&self) -> bool {
        self.stage.awaits_weight()
    }

    /// What the pipeline is doing.
    pub fn phase(&self) -> Phase {
        match self.phase {
            _ if self.paused => Phase::Paused,
            _ if self.refusal.is_some() => Phase::Refused,
            Phase::Playing if self.at < self.trusted_at => Phase::Doubtful,
            Phase::Playing if self.weighing.hides() => Phase::Weighing,
            phase => phase,
        }
    }
}
