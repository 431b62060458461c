//! About which pad the field is linearised: the one that measured pads are held against, or, where the tangent does not reach, one
//! that was found and solved for.

use crate::calibration::model::ParameterLayout;
use crate::calibration::model::physical::Physical;
use crate::calibration::problem::{PosteriorFit, Problem};
use crate::tangent::{SimulatedPad, on_grid};
use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::PadField;

/// No more fields than this are solved for one fit.
pub(crate) const SOLVED_MAX: usize = 2;
/// A field is solved where the tangent's error could move the fit by so many standard deviations, all its numbers together.
const FAR: f64 = 3.0;
/// What is nearer than so many of its own standard deviations is not known to differ.
const SIGNIFICANT: f64 = 3.0;

/// A number that is known to be beside the pad that the field is of.
struct OutOfReach<'l> {
    number: &'l Physical,
    value: f64,
    /// By how much the tangent's error could move the fit, in its standard deviations.
    error: f64,
}

/// The pad that was found, and its field; none where the tangent reaches, or where the field cannot be had.
pub(crate) fn solved(
    problem: &Problem<'_>,
    fit: &PosteriorFit,
    pad: &SimulatedPad<'_>,
) -> Option<(Device, PadField)> {
    let beyond = beyond(problem, fit, pad.device);
    let square: f64 = beyond.iter().map(|it| it.error * it.error).sum();
    if square <= FAR * FAR {
        return None;
    }
    let mut device = problem.prior.solved.as_ref().unwrap_or(pad.device).clone();
    for OutOfReach { number, value, .. } in beyond {
        number.put(&mut device, on_grid(value, number.reach(pad.device)));
    }
    let field = (pad.solve)(&device)?;
    Some((device, field))
}

fn beyond<'l>(problem: &'l Problem<'_>, fit: &PosteriorFit, device: &Device) -> Vec<OutOfReach<'l>> {
    let (_, precisions) = problem.prior_of(fit);
    let curvature = fit.factor.diagonal();
    let one = |(number, at): (&'l Physical, usize)| {
        let value = fit.values[at];
        let by = number.beyond(value);
        // The tangent is off by a change d of (d/r)² of what it says at the reach r. The contacts see a change d as J d², where
        // J = H − P is their information of it when all other numbers are known: more than the fit has.
        let seen = by * by * (curvature[at] - precisions[at]).max(0.0);
        let error = (by / number.reach(device)).abs() * seen.sqrt();
        (by.abs() > SIGNIFICANT * fit.deviation(at)).then_some(OutOfReach { number, value, error })
    };
    problem.layout.physical.iter().zip(ParameterLayout::first_physical()..).filter_map(one).collect()
}
