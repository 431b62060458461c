//! The one-weight check: a known weight, put anywhere on the plate for some seconds, tells by how much the pad's readings have
//! changed since it was calibrated.
//!
//! Time is stream time. A weighing ends with a factor or with the reason why there is none, and in any case: samples bring time,
//! and a link that brings none is lost.

pub mod factor;
pub mod kept;
pub mod refusal;
pub mod resting;

use crate::pad::weight::Weight;
use crate::pipeline::contact::Decoder;
use crate::pipeline::interruption::Effect;
use crate::quantity::Strain;
use crate::time::StreamInstant;
use factor::{Weighed, is_possible};
use refusal::WeighError;
use resting::SettlingDetector;

/// A load that does not begin to rest within this time is not waited for any longer.
pub const WAIT_US: u64 = 10_000_000;

/// So many faults end a weighing: one begins its mean anew.
const FAULTS_MAX: u32 = 2;

/// Sample as a weighing sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WeighingSample<'a> {
    /// Something lies on the pad: the channels as the decoder got them.
    Load(&'a Strain),
    /// Nothing lies on it.
    Nothing,
    /// The zero is not known.
    NoZero,
    /// A channel cannot be trusted.
    Faulty,
}

/// How far a weighing is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Progress {
    /// No load rests yet.
    Waiting,
    /// A load rests, and is measured.
    Resting,
    /// It has ended.
    Ended(Result<Weighed, WeighError>),
}

/// The newest weighing, as people are told of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeighingReport {
    /// Counts the weighings, from 1.
    pub number: u64,
    /// The weight.
    pub weight: Weight,
    /// How far it is. A factor counts against the calibration, whatever was found before.
    pub progress: Progress,
}

/// Weighs when it is asked to.
#[derive(Clone, Debug, Default)]
pub struct Weighing {
    newest: Option<WeighingReport>,
    began: StreamInstant,
    faults: u32,
    resting: SettlingDetector,
    /// Whether a load was there, and what was seen last where there was none.
    came: bool,
    lacks: Option<WeighError>,
    /// What was weighed lies there still, as far as is known.
    lies: bool,
}

impl Weighing {
    /// The newest weighing, if there was one.
    pub const fn account(&self) -> Option<&WeighingReport> {
        self.newest.as_ref()
    }

    /// Whether contacts are the weight's, or may be: from the beginning until it is taken away.
    pub const fn hides(&self) -> bool {
        self.lies || self.is_under_way()
    }

    const fn is_under_way(&self) -> bool {
        matches!(self.newest, Some(WeighingReport { progress: Progress::Waiting | Progress::Resting, .. }))
    }

    /// Begins to weigh this weight at `at`. One that was under way is forgotten.
    pub fn begin(&mut self, at: StreamInstant, weight: Weight) {
        let number = self.newest.map_or(0, |newest| newest.number) + 1;
        let newest = WeighingReport { number, weight, progress: Progress::Waiting };
        *self = Self { newest: Some(newest), began: at, ..Self::default() };
    }

    /// Ends a weighing that is under way.
    pub fn end(&mut self, outcome: Result<Weighed, WeighError>) {
        if self.is_under_way()
            && let Some(newest) = &mut self.newest
        {
            newest.progress = Progress::Ended(outcome);
            self.resting.break_off();
        }
    }

    /// In doubt, the mean begins anew, but not for ever.
    pub fn interrupt(&mut self, effect: Effect) {
        match effect {
            Effect::Keep => {}
            Effect::Doubt => {
                self.resting.break_off();
                self.faults += 1;
                if self.faults >= FAULTS_MAX {
                    self.end(Err(WeighError::Faults));
                }
            }
            Effect::Forget => {
                // What lies there is no press after it either.
                self.lies = self.hides();
                self.end(Err(WeighError::Interrupted));
            }
        }
    }

    /// Takes the sample at `at`, of a pad whose common gain was `gain` so far. How many times that the pad reads, once it is
    /// known.
    pub fn see(
        &mut self,
        at: StreamInstant,
        seen: WeighingSample<'_>,
        gain: f64,
        decoder: &Decoder,
    ) -> Option<f64> {
        match seen {
            WeighingSample::Load(_) => self.lies = self.hides(),
            WeighingSample::Nothing | WeighingSample::NoZero => self.lies = false,
            WeighingSample::Faulty => {}
        }
        let newest = self.newest.filter(|_| self.is_under_way())?;
        let WeighingSample::Load(strain) = seen else {
            self.resting.break_off();
            self.lacks = lacking(seen);
            self.go_on(at);
            return None;
        };
        (self.came, self.lacks) = (true, None);
        let Some(rested) = self.resting.push(at, strain, decoder) else {
            self.go_on(at);
            return None;
        };
        let weighed = Weighed::of(&rested, newest.weight, decoder);
        let total = weighed.and_then(|weighed| against_calibration(&weighed, gain, newest.weight));
        self.end(total);
        weighed.ok().filter(|_| total.is_ok()).map(|weighed| weighed.factor)
    }

    /// Waits on, or gives up.
    fn go_on(&mut self, at: StreamInstant) {
        let is_begun = self.resting.is_begun();
        if !is_begun && at.us_since(self.began) >= WAIT_US {
            let not_there = if self.came { WeighError::NotSteady } else { WeighError::NothingCame };
            self.end(Err(self.lacks.unwrap_or(not_there)));
        } else if let Some(newest) = &mut self.newest {
            newest.progress = if is_begun { Progress::Resting } else { Progress::Waiting };
        }
    }
}

/// What hinders a weighing where nothing can be weighed.
const fn lacking(seen: WeighingSample<'_>) -> Option<WeighError> {
    match seen {
        WeighingSample::Load(_) | WeighingSample::Nothing => None,
        WeighingSample::NoZero => Some(WeighError::NoZero),
        WeighingSample::Faulty => Some(WeighError::Faults),
    }
}

/// The same against the calibration, where readings were made up for by a `gain` that was known.
fn against_calibration(weighed: &Weighed, gain: f64, weight: Weight) -> Result<Weighed, WeighError> {
    let factor = gain * weighed.factor;
    if is_possible(factor) {
        Ok(Weighed { factor, ..*weighed })
    } else {
        Err(WeighError::OtherForce { force_n: weighed.force_n, weight_g: weight.g() })
    }
}
