//! Checks before any physics: faults of the recording and the electronics.
//!
//! Each check mends what it finds, or takes away the weight of the readings that it cannot mend, and leaves a [`Notice`] that
//! says which channel, how many rows, what was done, and how to look at it. What has a name among the effects is a finding,
//! too. Nothing here knows of nine channels or of a pad: where a model says what the channels should read, that helps, and
//! where none does, the channels are held against each other and against themselves.
//!
//! A check is a file, and a name in [`OF_TABLE`] or [`OF_CHANNELS`].

pub(crate) mod checks;
pub(crate) mod gate;
pub(crate) mod prediction;

use self::checks::{clipping, clock, dead, intermittent, mains, missing, steps, stuck, wiring};
pub(super) use self::gate::Gate;
use crate::effect::Effect;
use tactpad_inference::observations::Observations;

type Check = fn(&mut Gate);
/// Checks of the table, in their order: times before series, codes before anything that calculates.
const OF_TABLE: [Check; 5] = [clock::check, missing::check, stuck::check, stuck::held, clock::apart];
/// Checks of channels and electronics: wires before whatever holds a channel against its own model.
const OF_CHANNELS: [Check; 6] =
    [dead::check, wiring::check, clipping::check, intermittent::check, steps::check, mains::check];

/// Effects that the checks name, [`checks::excess`] among them.
pub(super) const EFFECTS: [Effect; 7] = [
    Effect::ChannelDead,
    Effect::ChannelsSwapped,
    Effect::ChannelPolarity,
    Effect::AdcClipping,
    Effect::ChannelIntermittent,
    Effect::MainsPickup,
    Effect::NoiseExcess,
];

/// The observations after all checks, but those that find an effect that is not asked for. `expected` are each channel's readings by a model, row by row; `None`: there is no model.
///
/// Tables of any size pass, also ones without rows; whether enough is left in them is for the caller to ask.
pub(super) fn guarded(
    observations: &Observations,
    expected: Option<&[Vec<f64>]>,
    asks_for: impl Fn(Effect) -> bool,
) -> Gate {
    let mut gate = Gate {
        observations: observations.clone(),
        unrepaired: None,
        expected: expected.map(<[Vec<f64>]>::to_vec),
        notices: Vec::new(),
        findings: Vec::new(),
        not_detected: Vec::new(),
        not_testable: Vec::new(),
        left: 1.0,
    };
    let pass = |gate: &mut Gate, checks: &[Check]| {
        for check in checks {
            let before = gate.clone();
            check(gate);
            let own = &gate.findings[before.findings.len()..];
            if own.iter().any(|finding| !asks_for(finding.effect)) {
                *gate = before;
            }
        }
    };
    pass(&mut gate, &OF_TABLE);
    let (measured, found) = (gate.observations.clone(), gate.findings.len());
    pass(&mut gate, &OF_CHANNELS);
    gate.unrepaired = (gate.findings.len() > found).then_some(measured);
    gate
}

#[cfg(test)]
mod tests;
