//! Labels that were rounded, by what the fitted model decodes.
//!
//! A label that was rounded to steps of q misses the contact by anything from −q/2 to q/2 alike. So the variance of what it misses is q²/12, and
//! its kurtosis 9/5, where that of errors of many small reasons is 3. Places on a grid that were really touched there miss nothing. So steps are
//! seen that are some five times what the model itself misses contacts by.

use super::gain::{Rows, is_loaded};
use crate::diagnosis::data::target::{LABELS, LabelColumns, Target};
use crate::diagnosis::report::{Estimate, Finding, Notice};
use crate::effect::Effect;
use tactpad_inference::model::ChannelBaselines;
use tactpad_inference::search::AttributionFit;
use tactpad_numeric::chi_square;
use tactpad_numeric::statistics::{mean, population_deviation};

/// Steps that are asked for, mm and N: others are no rounding.
const STEPS: [f64; 9] = [5.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01];
/// A number is a multiple of a step if it is as near to one as this part of it.
const ON_STEP: f64 = 1e-6;
/// The variance of what is missed, by q²/12, and the largest kurtosis: noise adds to both.
const VARIANCE: [f64; 2] = [0.75, 1.5];
const KURTOSIS_MAX: f64 = 2.5;
/// Largest part of the contacts that may miss by more than a step.
const BEYOND_MAX: f64 = 0.02;
/// Probability by which normal errors may be taken for those of a rounded label.
const LEVEL: f64 = 1e-3;

/// Columns of labels that were rounded.
pub(crate) fn rounded(rows: &Rows<'_>, fit: &AttributionFit) -> Vec<(Finding, Notice)> {
    let told = ChannelBaselines { zeros: &rows.zeros(&fit.applied), noise: &fit.systems.noise };
    let Some(contacts) = rows.model.contacts(&fit.applied, &told) else { return Vec::new() };
    let samples = rows.observations.samples.iter().zip(contacts);
    let mut pairs: Vec<[[f64; 5]; 2]> = samples
        .filter(|(sample, _)| is_loaded(sample))
        .filter_map(|(sample, contact)| {
            let ([x_mm, y_mm], [fx_n, fy_n, fz_n]) = (sample.place_mm, sample.load);
            Some([contact?, [x_mm, y_mm, fx_n, fy_n, fz_n]])
        })
        .collect();
    // Light contacts are decoded worst.
    let force = |[_, [_, _, fx, fy, fz]]: &[[f64; 5]; 2]| fx * fx + fy * fy + fz * fz;
    pairs.sort_by(|one, other| force(other).total_cmp(&force(one)));
    let of_column = |column: usize| {
        let written: Vec<f64> = pairs.iter().map(|[_, written]| written[column]).collect();
        let missed: Vec<f64> =
            pairs.iter().map(|[contact, written]| contact[column] - written[column]).collect();
        let strong = pairs.len() / 2;
        let rounding =
            rounding(&written, &missed).or_else(|| rounding(&written[..strong], &missed[..strong]));
        let (step, p_value) = rounding?;
        Some((finding(column, step, p_value), notice(column, step)))
    };
    (0..LABELS.len()).filter_map(of_column).collect()
}

/// The step to which these numbers were rounded, by how far each misses, and the probability of that by chance.
fn rounding(written: &[f64], missed: &[f64]) -> Option<(f64, f64)> {
    let is_step = |step: &f64| {
        written.iter().all(|number| (number / step - libm::round(number / step)).abs() < ON_STEP)
    };
    let step = STEPS.into_iter().find(is_step)?;
    let within: Vec<f64> = missed.iter().copied().filter(|it| it.abs() < step).collect();
    let is_beyond = within.len() as f64 <= (1.0 - BEYOND_MAX) * missed.len() as f64;
    let variance = population_deviation(&within).powi(2) / (step * step / 12.0);
    if within.is_empty() || is_beyond || !(VARIANCE[0]..VARIANCE[1]).contains(&variance) {
        return None;
    }
    let middle = mean(within.iter().copied());
    let moment = |power: i32| mean(within.iter().map(|it| (it - middle).powi(power)));
    let kurtosis = moment(4) / moment(2).powi(2);
    // Of n normal numbers it has the variance 24/n.
    let p_value = 0.5 * chi_square::exceeded((kurtosis - 3.0).powi(2) * within.len() as f64 / 24.0, 1);
    (kurtosis < KURTOSIS_MAX && p_value < LEVEL).then_some((step, p_value))
}

fn finding(column: usize, step: f64, p_value: f64) -> Finding {
    let name = if column < 2 { "step_mm" } else { "step_n" };
    Finding {
        effect: Effect::LabelRounded,
        target: Target::Labels(LabelColumns::One(column)),
        parameters: vec![Estimate { name, value: step, interval95: [step; 2] }],
        shapes: Vec::new(),
        p_value,
        share: 0.0,
        confounded_with: Vec::new(),
        separate_by: None,
        labels: None,
    }
}

fn notice(column: usize, step: f64) -> Notice {
    let detail = format!(
        "{} is written in steps of {step}, and misses the contacts by anything up to half of one: nothing is changed, what that adds counts as \
         noise; write more digits",
        LABELS[column]
    );
    Notice { check: "labels", channel: None, detail }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_numeric::random::SplitMix64;

    #[test]
    fn rounding_is_told_from_places_on_a_grid_and_from_noise() {
        let mut random = SplitMix64::new(1);
        let mut normal = || f64::from(random.normal());
        let places: Vec<f64> = (0..600).map(|at| (at as f64 * 7.368).rem_euclid(40.0) - 20.0).collect();
        let rounded: Vec<f64> = places.iter().map(|x_mm| libm::round(*x_mm)).collect();
        let miss = |truth: &[f64], noise: f64, normal: &mut dyn FnMut() -> f64| -> Vec<f64> {
            truth.iter().zip(&rounded).map(|(x_mm, written)| x_mm - written + noise * normal()).collect()
        };
        assert_eq!(rounding(&rounded, &miss(&places, 0.1, &mut normal)).map(|(step, _)| step), Some(1.0));
        for noise in [0.02, 0.1, 0.29, 0.5, 2.0] {
            assert_eq!(rounding(&rounded, &miss(&rounded, noise, &mut normal)), None, "{noise}");
        }
        assert_eq!(rounding(&places, &miss(&places, 0.1, &mut normal)), None);
        assert_eq!(rounding(&[], &[]), None);
    }
}
