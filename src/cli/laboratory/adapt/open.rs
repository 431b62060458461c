//! Numbers that the rig leaves open, and the next measurement that determines each.

use serde::Serialize;

use tactpad::lab::calibration::result::open::{Blurred, OpenByRig};
use tactpad::lab::effect::Effect;

/// An error of the rig that the contacts do not tell from the pad's.
#[derive(Serialize)]
pub(super) struct OpenNumber {
    effect: Effect,
    /// `place` or `force`.
    of: &'static str,
    /// mm of the place, or a share of the force.
    deviation: f64,
    /// Its part of the variance of that.
    share: f64,
    /// The measurement that determines it.
    next: &'static str,
}

impl OpenNumber {
    pub(super) fn of(open: &OpenByRig) -> Self {
        let OpenByRig { effect, of, deviation, share } = *open;
        let of = match of {
            Blurred::Place => "place",
            Blurred::Force => "force",
        };
        Self { effect, of, deviation, share, next: next(effect) }
    }

    pub(super) fn words(&self) -> String {
        let Self { effect, of, deviation, share, next } = self;
        let what = match effect {
            Effect::StageOffset => "stands beside the middle of the pad",
            Effect::StageRotation => "is turned against the pad",
            Effect::StageScale => "has a scale of its own",
            Effect::ReferenceTilt => "is tilted",
            _ => "has a gain of its own",
        };
        let part = if *of == "place" { "stage" } else { "reference" };
        let size = if *of == "place" {
            format!("{deviation:.2} mm of the place")
        } else {
            format!("{:.1} % of the force", 100.0 * deviation)
        };
        format!(
            "Whether the {part} {what} is open: ± {size}, {:.0} % of the variance that the field leaves of it. {next}.",
            100.0 * share
        )
    }
}

/// The measurement that tells an error of the rig from the pad's own.
fn next(effect: Effect) -> &'static str {
    match effect {
        Effect::StageOffset | Effect::ReferenceTilt => {
            "A second session would tell: clamp the pad anew, turned by 120 degrees, repeat a third of the contacts and write 120 \
             under turned_deg"
        }
        Effect::ReferenceGain => "A known weight tells: tactpad weigh",
        _ => "Measure the stage itself, with a rule or a second pad",
    }
}
