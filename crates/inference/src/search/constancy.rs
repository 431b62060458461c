//! Whether a fitted cause holds alike in all parts of a measurement.
//!
//! A cause that is the nearest name for something else explains it in some channels, places or loads and not in others. With
//! s = Σ J ψ̂ of the cause, and with a partition of channels or rows into parts g, the score test of the columns s·1(g) beside all
//! fitted ones asks whether ψ is another one in some part.
//!
//! Source: J. A. Hausman, Econometrica 46 (1978) 1251 (two estimates of one number that must agree if the model is right).

use super::score_test::Projected;
use super::{AttributionFit, Search};
use crate::error::InferenceError;
use crate::model::Signature;
use crate::observations::Sample;
use tactpad_numeric::statistics::median;

/// How often a right cause may be taken for a wrong one, over all partitions.
const LEVEL: f64 = 0.01;
/// Less than this part of what the cause explains is what its signature may be wrong by.
const SHARE_MIN: f64 = 0.1;
/// Coordinates so near to an end are there.
const AT_END: f64 = 1e-9;
/// From this part of the load on shear tells its direction.
const SHEAR_MIN: f64 = 0.2;

impl<L> Search<'_, L> {
    /// Whether a fitted cause is as large in all parts of the measurement, as far as they tell, and no number of it ended where it
    /// can go no further.
    pub fn holds_throughout(&self, fit: &AttributionFit, at: usize) -> Result<bool, InferenceError> {
        let own = self.test_within(fit, at)?.square;
        Ok(!self.is_at_an_end(fit, at) && self.is_alike(fit, &self.effect(fit, at), own)?)
    }

    /// The same of a channel's zero, whose square over its variance is `own`.
    pub fn zero_holds_throughout(
        &self,
        fit: &AttributionFit,
        channel: usize,
        own: f64,
    ) -> Result<bool, InferenceError> {
        let is_own = |at: usize| (at == channel).then(|| vec![1.0; self.observations.rows()]);
        self.is_alike(fit, &(0..self.observations.channels.len()).map(is_own).collect(), own)
    }

    /// Whether a number that is asked for ended at an end of its range that is not its none.
    pub fn is_at_an_end(&self, fit: &AttributionFit, at: usize) -> bool {
        let (hypothesis, coordinates) = &fit.applied[at];
        self.model.hypotheses()[*hypothesis].asked().iter().zip(coordinates).any(|(it, psi)| {
            let is_there = |end: f64| end != it.none && (it.coordinate(end) - psi).abs() <= AT_END;
            it.range.into_iter().any(is_there)
        })
    }

    /// Whether an effect that takes `own` off the weighted squares is as large in all parts.
    fn is_alike(&self, fit: &AttributionFit, effect: &Signature, own: f64) -> Result<bool, InferenceError> {
        let partitions = self.partitions(effect);
        let fitted = self.columns.fitted(fit.applied.iter().map(|(held, _)| *held));
        for parts in &partitions {
            let marginal = fit.systems.marginal_beside(&fitted.columns, parts, &fit.background)?;
            let projected = Projected::of(&marginal, &fitted)?;
            let numbers: Vec<usize> = (fit.systems.columns..fit.systems.columns + parts.len()).collect();
            let test = projected.test(&numbers, &projected.score);
            if test.p_value() < LEVEL / partitions.len() as f64 && test.square > SHARE_MIN * own {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Σ J ψ̂ of a fitted cause.
    fn effect(&self, fit: &AttributionFit, at: usize) -> Signature {
        let (hypothesis, coordinates) = &fit.applied[at];
        let signatures = &fit.linearised.signatures[*hypothesis];
        let channel = |channel: usize| {
            let known = signatures.iter().zip(coordinates);
            let mut known = known.filter_map(|(it, psi)| Some((it[channel].as_deref()?, psi))).peekable();
            known.peek()?;
            let mut sum = vec![0.0; self.observations.rows()];
            for (values, psi) in known {
                sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += psi * value);
            }
            Some(sum)
        };
        (0..self.observations.channels.len()).map(channel).collect()
    }

    /// The effect in parts, in several ways: channel by channel, by place, direction and size of the load, and time.
    fn partitions(&self, effect: &Signature) -> Vec<Vec<Signature>> {
        let samples = &self.observations.samples;
        let radius = |sample: &Sample| libm::hypot(sample.place_mm[0], sample.place_mm[1]);
        let load = |sample: &Sample| libm::sqrt(sample.load.iter().map(|n| n * n).sum());
        let quadrant = |sample: &Sample| {
            2 * usize::from(sample.place_mm[0] < 0.0) + usize::from(sample.place_mm[1] < 0.0)
        };
        let direction = |sample: &Sample| {
            let [fx, fy, _] = sample.load;
            match (libm::hypot(fx, fy) < SHEAR_MIN * load(sample), fx.abs() < fy.abs()) {
                (true, _) => 0,
                (false, false) => 1,
                (false, true) => 2,
            }
        };
        let above = |of: &dyn Fn(&Sample) -> f64| -> Vec<usize> {
            let middle = median(samples.iter().map(of)).unwrap_or_default();
            samples.iter().map(|sample| usize::from(of(sample) > middle)).collect()
        };
        let rows = samples.len();
        let ways = [
            samples.iter().map(quadrant).collect(),
            above(&radius),
            samples.iter().map(direction).collect(),
            above(&load),
            (0..rows).map(|row| 2 * row / rows.max(1)).collect(),
        ];
        let by_rows = ways.iter().map(|groups| by_rows(effect, groups));
        by_rows.chain([by_channel(effect)]).filter(|parts| parts.len() > 1).collect()
    }
}

/// The effect in each group of rows.
fn by_rows(effect: &Signature, groups: &[usize]) -> Vec<Signature> {
    let count = groups.iter().max().map_or(0, |last| last + 1);
    let in_group = |group: usize, of: &Vec<f64>| {
        of.iter().zip(groups).map(|(value, own)| if *own == group { *value } else { 0.0 }).collect()
    };
    let part = |group: usize| effect.iter().map(|of| Some(in_group(group, of.as_ref()?))).collect();
    (0..count).map(part).collect()
}

/// The effect in each channel.
fn by_channel(effect: &Signature) -> Vec<Signature> {
    let has = (0..effect.len()).filter(|channel| effect[*channel].is_some());
    has.map(|channel| {
        effect.iter().enumerate().map(|(at, of)| of.clone().filter(|_| at == channel)).collect()
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parts_of_an_effect_are_the_effect() {
        let effect: Signature = vec![Some(vec![1.0, 2.0, 3.0, 4.0]), None, Some(vec![5.0, 6.0, 7.0, 8.0])];
        let sum = |parts: &[Signature], channel: usize, row: usize| {
            parts.iter().filter_map(|part| part[channel].as_ref()).map(|of| of[row]).sum::<f64>()
        };
        let (rows, channels) = (by_rows(&effect, &[1, 0, 1, 2]), by_channel(&effect));
        assert_eq!((rows.len(), channels.len()), (3, 2));
        assert_eq!(rows[1][0].as_deref(), Some([1.0, 0.0, 3.0, 0.0].as_slice()));
        assert!(channels[1][0].is_none() && channels[1][2] == effect[2]);
        for (channel, row) in [(0, 0), (0, 3), (2, 1), (2, 2)] {
            let whole = effect[channel].as_ref().unwrap()[row];
            assert!((sum(&rows, channel, row) - whole).abs() < 1e-12);
            assert!((sum(&channels, channel, row) - whole).abs() < 1e-12);
        }
    }
}
