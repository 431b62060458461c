//! Whether a module lacks a part of its frame or of its bond.
//!
//! That is no small change, and no number of a pad that is whole stands for it: crosstalk within the module takes it up, by shares that
//! no leak has. Where these are found, the module's flaws are tried, each as a pad of its own, and the evidence decides.

use rayon::prelude::*;

use crate::calibration::model::ParameterLayout;
use crate::calibration::model::prior::Prior;
use crate::calibration::problem::{PosteriorFit, Problem};
use crate::diagnosis::model::mechanics::flawed;
use crate::tangent::SimulatedPad;
use tactpad_core::pad::changes::{FieldChange, Flaw};
use tactpad_core::pad::device::{Device, Module};
use tactpad_core::pad::field::PadField;
use tactpad_core::quantity::MODULES;

/// Whether flaws are looked for: channels of a module share more than they do on pads that are whole.
pub(crate) fn are_asked(problem: &Problem<'_>, fit: &PosteriorFit, pad: &SimulatedPad<'_>) -> bool {
    // Only labels tell crosstalk within a module from its pose. Of a pad that was solved for it was asked before.
    let is_asked = !problem.layout.is_play && problem.prior.solved.is_none() && of(pad.device).is_none();
    is_asked && fit.estimates.prior_deviations.is_shared_within()
}

/// The pad with the most probable flaw, if that is more probable than the whole pad, of which `whole` is the fit. `fitted` is the fit
/// under a prior.
pub(crate) fn found(
    problem: &Problem<'_>,
    whole: &PosteriorFit,
    pad: &SimulatedPad<'_>,
    fitted: impl Fn(&Prior) -> Option<PosteriorFit> + Sync,
) -> Option<(Device, PadField)> {
    let module = sharing_most(whole);
    let tried = |change: &FieldChange| {
        let field = PadField {
            signals: flawed(&problem.prior.field, change, module, problem.plate_mm),
            ..problem.prior.field.clone()
        };
        let prior = problem.prior.clone().about(with(pad.device, module, change.flaw), field);
        Some((fitted(&prior)?.log_probability(), prior))
    };
    let best: Vec<(f64, Prior)> = pad.flaws.par_iter().filter_map(tried).collect();
    let best = best.into_iter().max_by(|one, other| one.0.total_cmp(&other.0));
    let (by_change, prior) = best?;
    // Of the whole pad's derivatives its own are some percent off.
    let device = prior.solved?;
    let (field, flawed) = match (pad.solve)(&device) {
        Some(field) => {
            let fit = fitted(&problem.prior.clone().about(device.clone(), field.clone()))?;
            (field, fit.log_probability())
        }
        None => (prior.field, by_change),
    };
    // Shares that no pad has are not for nothing. That channels share so much is as likely by a flaw, any of them, as by a leak.
    (flawed > whole.log_probability() + libm::log(pad.flaws.len() as f64)).then_some((device, field))
}

/// The first module of a device that lacks something, and what; none where all are whole.
pub(crate) fn of(device: &Device) -> Option<(usize, Flaw)> {
    let flaw = |it: &Module| {
        let debonded = || it.debonded().map(|(side, share)| Flaw::Debonded(side, share));
        it.frame_open.map(Flaw::FrameOpen).or_else(debonded)
    };
    device.modules.iter().enumerate().find_map(|(module, it)| Some((module, flaw(it)?)))
}

/// The module whose channels share most.
fn sharing_most(fit: &PosteriorFit) -> usize {
    let crosstalk = ParameterLayout::crosstalk(&fit.values);
    let within = |module: usize| {
        let own = 3 * module..3 * module + 3;
        let shares = own.clone().flat_map(|into| own.clone().map(move |from| (into, from)));
        shares.map(|(into, from)| crosstalk[into][from].powi(2)).sum::<f64>()
    };
    (0..MODULES).max_by(|one, other| within(*one).total_cmp(&within(*other))).unwrap_or(0)
}

/// A device whose module has the flaw.
fn with(device: &Device, module: usize, flaw: Flaw) -> Device {
    let mut flawed = device.clone();
    flawed.modules.swap(0, module);
    flawed = flaw.on(&flawed);
    flawed.modules.swap(0, module);
    flawed
}
