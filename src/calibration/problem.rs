//! The least-squares problem of a calibration: how far the numbers are from explaining what was measured.

use std::collections::BTreeMap;

use super::before::Before;
use super::contacts::{Maps, Measured, Place, TERMS};
use super::model::Layout;
use super::noise::{Doubt, Known};
use super::plate::{places, scale};
use super::scatter::{Residual, Scatter};
use super::spread::Spread;
use crate::contact::creep::Creep;
use crate::contact::friction::{Friction, PLAYS};
use crate::contact::recording::{Lags, Recording, Untouched};
use crate::contact::thermal::Thermal;
use crate::contact::uncertainty::UNKNOWNS;
use crate::device::Device;
use crate::device::parameter::Parameter;
use crate::field::Sensitivity;
use crate::influence::{InfluenceField, MAPS};
use crate::linear::{LargeFactor, Symmetric};
use crate::quantity::{CHANNELS, Strain};

/// Steps of a fit at most; the channels are nearly linear in the numbers.
const STEPS_MAX: usize = 12;
/// A step that changes the evidence by less is the last.
const EVIDENCE_END: f64 = 0.3;
/// A force at which the field's doubt is looked at: half of full scale.
const DOUBT_N: f64 = 2.5;
/// Numbers never take up more of the readings than all but this part.
const FREEDOM_MIN: f64 = 0.05;
/// How much the zero of a channel drifts between two readings, at least, and before anything is measured.
const DRIFT_MIN_UV: f64 = 1.0;
const DRIFT_UV: f64 = 10.0;
/// A jump of the zero counts as a drift of this part of it at least: temperature may have changed.
const JUMP_PART: f64 = 1.0 / 3.0;

/// What is fitted, and to what.
#[derive(Clone)]
pub(super) struct Problem<'f> {
    before: &'f Before,
    recording: &'f Recording,
    reference_c: Option<f64>,
    sensitivities: Vec<&'f Sensitivity>,
    pub(super) layout: Layout,
    /// Rows of the recording, and what was measured in them.
    contacts: Vec<(usize, Measured)>,
    /// From one reading of the untouched pad to the next.
    jumps: Vec<Jump>,
    /// Root mean square of each map over the plate.
    scale: Maps,
    plate_mm: f64,
    reach_mm: f64,
}

/// The untouched pad at two times.
#[derive(Clone)]
struct Jump {
    rows: [usize; 2],
    change_uv: [f64; CHANNELS],
    /// What friction made of the way between.
    lags: Lags,
    /// How far the channels crept.
    crept_uv: [f64; CHANNELS],
}

/// What is taken for granted while the numbers are fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Settings {
    /// Size of the background, as a share of each map.
    pub(super) background: f64,
    /// Of the play operators, in strains before gains; one of zero does nothing.
    pub(super) thresholds_uv: [f64; PLAYS],
    /// Relaxation time; zero: no creep.
    pub(super) creep_time_s: f64,
}

/// The numbers for some settings.
#[derive(Clone, Debug)]
pub(super) struct Fit {
    pub(super) settings: Settings,
    pub(super) values: Vec<f64>,
    pub(super) scatter: Scatter,
    pub(super) spread: Spread,
    pub(super) drift_uv: [f64; CHANNELS],
    factor: LargeFactor,
    /// ln of the probability of what was measured, but for a constant.
    pub(super) evidence: f64,
}

impl Fit {
    /// The standard deviation of a number.
    pub(super) fn deviation(&self, at: usize) -> f64 {
        let mut unit = vec![0.0; self.values.len()];
        unit[at] = 1.0;
        self.factor.solve(&unit)[at].sqrt()
    }
}

/// A step of the numbers, and the factor of their curvature.
struct Step {
    change: Vec<f64>,
    factor: LargeFactor,
}

impl<'f> Problem<'f> {
    /// `rows` are the contacts to fit to; all others only tell what was before. Without polynomials for a background.
    pub(super) fn of(
        recording: &'f Recording,
        reference_c: Option<f64>,
        rows: &[usize],
        device: &Device,
        before: &'f Before,
    ) -> Self {
        let field = &before.field;
        let is_free = |it: &&Sensitivity| it.parameter.module().is_some();
        let sensitivities: Vec<&Sensitivity> = field.sensitivities.iter().filter(is_free).collect();
        let plate_mm = device.plate.diameter_mm / 2.0;
        let measured = |at: &usize| {
            let row = recording.tared().rows.get(*at)?;
            Some((*at, Measured::of(field, &sensitivities, plate_mm, row, reference_c)?))
        };
        let contacts = rows.iter().filter_map(measured).collect();
        let layout = Layout { physical: sensitivities.iter().map(|it| it.parameter).collect(), terms: 0 };
        Self {
            jumps: recording.zeros().flat_map(jumps).collect(),
            before,
            recording,
            reference_c,
            sensitivities,
            layout,
            contacts,
            scale: scale(&field.signals),
            plate_mm,
            reach_mm: f64::from(field.signals.radius_mm()),
        }
    }

    /// How many contacts there are.
    pub(super) const fn contacts(&self) -> usize {
        self.contacts.len()
    }

    /// What was known of the channels' noise.
    pub(super) const fn known_noise(&self) -> &Known {
        &self.before.noise
    }

    /// The same with polynomials for a background.
    pub(super) fn with_background(mut self) -> Self {
        self.layout.terms = TERMS;
        self
    }

    /// The most probable numbers. The search begins at `start`, or at the pad as it is thought to be. `None` where the
    /// numbers make no sense.
    pub(super) fn fitted(mut self, settings: Settings, start: Option<&Fit>) -> Option<Fit> {
        let before = self.layout.before(self.before);
        let mut values = before.clone();
        let (mut scatter, mut drift_uv) = (Scatter::before(self.before.noise), [DRIFT_UV; CHANNELS]);
        let mut spread = if self.recording.is_tared() { Spread::TARED } else { Spread::RAW };
        if let Some(start) = start {
            values.iter_mut().zip(&start.values).for_each(|(value, start)| *value = *start);
            (scatter, drift_uv, spread) = (start.scatter, start.drift_uv, start.spread);
        }
        let mut found: Option<Fit> = None;
        for _ in 0..STEPS_MAX {
            let precisions = self.layout.precisions(settings.background, &spread);
            self.walk(&values, &settings);
            let step = self.step(&values, &scatter, &drift_uv, &before, &precisions)?;
            values.iter_mut().zip(&step.change).for_each(|(value, change)| *value += change);
            let residuals = self.residuals(&values);
            let variances = step.factor.inverse_diagonal();
            let freedom = self.freedom(&precisions, &variances);
            let mut evidence = Self::evidence(&residuals, &scatter)?;
            evidence += self.jumps_evidence(&values, &drift_uv) - 0.5 * step.factor.log_determinant();
            evidence += prior(&values, &before, &precisions);
            let gain = found.as_ref().map_or(f64::INFINITY, |before| (evidence - before.evidence).abs());
            let values_now = values.clone();
            let factor = step.factor;
            found = Some(Fit { settings, values: values_now, scatter, spread, drift_uv, factor, evidence });
            spread = spread
                .seen(self.layout.kinds().map(|(kind, at)| (kind, values[at] - before[at], variances[at])));
            scatter = scatter.seen(&residuals, freedom);
            drift_uv = self.drift_uv(&values);
            if gain < EVIDENCE_END {
                break;
            }
        }
        found.filter(|fit| fit.values.iter().all(|value| value.is_finite()))
    }

    /// Takes what friction and creep made of the way, by these numbers.
    fn walk(&mut self, values: &[f64], settings: &Settings) {
        if settings.thresholds_uv == [0.0; PLAYS] && settings.creep_time_s == 0.0 {
            return;
        }
        let strain = |(at, it): &(usize, Measured)| (*at, self.layout.loaded_uv(values, &self.scale, it));
        let strains: BTreeMap<usize, [f64; CHANNELS]> = self.contacts.iter().map(strain).collect();
        self.creep(settings.creep_time_s, &strains);
        let friction = Layout::friction(values, &settings.thresholds_uv);
        let states = self.recording.states(&friction, |at| strains.get(&at).copied());
        let lags = self.recording.relative(&states);
        for (at, contact) in &mut self.contacts {
            contact.lags = lags[*at];
        }
        for Jump { rows: [first, second], lags, .. } in &mut self.jumps {
            let (first, second) = (&states[*first], &states[*second]);
            *lags = std::array::from_fn(|play| change(&first[play], &second[play]));
        }
    }

    /// How far the channels had crept.
    fn creep(&mut self, time_s: f64, strains: &BTreeMap<usize, [f64; CHANNELS]>) {
        if time_s == 0.0 {
            return;
        }
        let states = self.recording.crept(time_s, |at| strains.get(&at).copied());
        let relative = self.recording.relative(&states);
        for (at, contact) in &mut self.contacts {
            [contact.crept_uv] = relative[*at];
        }
        for Jump { rows: [first, second], crept_uv, .. } in &mut self.jumps {
            *crept_uv = change(&states[*first][0], &states[*second][0]);
        }
    }

    fn step(
        &self,
        values: &[f64],
        scatter: &Scatter,
        drift_uv: &[f64; CHANNELS],
        before: &[f64],
        precisions: &[f64],
    ) -> Option<Step> {
        let mut normal = Symmetric::zeros(self.layout.size());
        let mut right: Vec<f64> =
            precisions.iter().zip(before.iter().zip(values)).map(|(p, (b, v))| p * (b - v)).collect();
        precisions.iter().enumerate().for_each(|(at, precision)| normal.add_diagonal(at, *precision));
        for (_, contact) in &self.contacts {
            self.add_contact(values, scatter, contact, &mut normal, &mut right)?;
        }
        self.each_jump(values, drift_uv, |_, rest, variance, slopes| {
            normal.add_product(1.0 / variance, slopes);
            right.iter_mut().zip(slopes).for_each(|(right, slope)| *right += slope * rest / variance);
        });
        let factor = normal.factorised()?;
        Some(Step { change: factor.solve(&right), factor })
    }

    fn add_contact(
        &self,
        values: &[f64],
        scatter: &Scatter,
        contact: &Measured,
        normal: &mut Symmetric,
        right: &mut [f64],
    ) -> Option<()> {
        let residual = self.residual(values, contact);
        let worth = scatter.worth(&residual)?;
        let mut taken = vec![vec![0.0; right.len()]; UNKNOWNS];
        self.layout.readings(values, &self.scale, contact, |channel, _, slopes| {
            let weight = worth.weights[channel];
            normal.add_product(weight, slopes);
            let weighted = weight * residual.rest_uv[channel];
            right.iter_mut().zip(slopes).for_each(|(right, slope)| *right += weighted * slope);
            for (sum, taken) in taken.iter_mut().zip(&worth.taken) {
                sum.iter_mut().zip(slopes).for_each(|(sum, slope)| *sum += taken[channel] * slope);
            }
        });
        for (sum, taken) in taken.iter().zip(&worth.taken) {
            let rest: f64 = taken.iter().zip(&residual.rest_uv).map(|(taken, rest)| taken * rest).sum();
            right.iter_mut().zip(sum).for_each(|(right, sum)| *right -= sum * rest);
        }
        normal.subtract_squares(&taken);
        Some(())
    }

    fn residual(&self, values: &[f64], contact: &Measured) -> Residual {
        let mut rest_uv = contact.uv;
        self.layout.readings(values, &self.scale, contact, |channel, uv, _| rest_uv[channel] -= uv);
        let slopes = self.layout.slopes(values, &self.scale, contact);
        let [fx_n, fy_n, fz_n] = contact.force_n;
        let force_n = libm::hypot(libm::hypot(fx_n, fy_n), fz_n);
        Residual { uv: contact.uv, force_n, rest_uv, slopes }
    }

    fn residuals(&self, values: &[f64]) -> Vec<Residual> {
        self.contacts.iter().map(|(_, contact)| self.residual(values, contact)).collect()
    }

    /// Every jump of a zero: the channel, what friction and creep leave over of it, the variance of that, the slopes.
    fn each_jump(
        &self,
        values: &[f64],
        drift_uv: &[f64; CHANNELS],
        mut then: impl FnMut(usize, f64, f64, &[f64]),
    ) {
        let mut slopes = vec![0.0; self.layout.size()];
        for Jump { change_uv, lags, crept_uv, .. } in &self.jumps {
            for channel in 0..CHANNELS {
                slopes.fill(0.0);
                let remembered_uv = Layout::remembered(values, channel, lags, crept_uv, &mut slopes);
                let rest = change_uv[channel] - remembered_uv;
                let drift = drift_uv[channel].max(JUMP_PART * rest.abs());
                then(channel, rest, drift * drift, &slopes);
            }
        }
    }

    /// Which part of the readings the fitted numbers did not take up.
    fn freedom(&self, precisions: &[f64], variances: &[f64]) -> f64 {
        let taken: f64 = precisions.iter().zip(variances).map(|(before, after)| 1.0 - before * after).sum();
        (1.0 - taken / (CHANNELS * self.contacts.len()) as f64).max(FREEDOM_MIN)
    }

    /// How much each channel's zero drifts from one reading to the next: the median of what friction and creep do not explain.
    fn drift_uv(&self, values: &[f64]) -> [f64; CHANNELS] {
        let mut rests = [const { Vec::new() }; CHANNELS];
        self.each_jump(values, &[DRIFT_UV; CHANNELS], |channel, rest, _, _| rests[channel].push(rest.abs()));
        rests.map(|mut rests| {
            rests.sort_by(f64::total_cmp);
            // Of a normal number the median magnitude is 0.6745 of its standard deviation.
            rests.get(rests.len() / 2).map_or(DRIFT_UV, |median| (median / 0.6745).max(DRIFT_MIN_UV))
        })
    }

    /// ln of the probability of the contacts, but for a constant.
    fn evidence(residuals: &[Residual], scatter: &Scatter) -> Option<f64> {
        let cost = |residual| Some(scatter.worth(residual)?.cost(&residual.rest_uv));
        let costs: Option<Vec<f64>> = residuals.iter().map(cost).collect();
        Some(-0.5 * costs?.iter().sum::<f64>())
    }

    /// The same of the untouched pad.
    fn jumps_evidence(&self, values: &[f64], drift_uv: &[f64; CHANNELS]) -> f64 {
        let mut cost = 0.0;
        self.each_jump(values, drift_uv, |_, rest, variance, _| {
            cost += rest * rest / variance + variance.ln();
        });
        -0.5 * cost
    }

    /// The contacts' channels without creep and this friction, and the written forces.
    pub(super) fn freed(
        &self,
        values: &[f64],
        friction: &Friction,
        creep: &Creep,
    ) -> Vec<(Strain, [f64; 3])> {
        let mut recording = self.recording.clone().less(&Layout::zeros(values));
        if let Some(reference_c) = self.reference_c {
            let gain_per_c = std::array::from_fn(|channel| values[Layout::first_warmth() + channel]);
            let zero_uv_per_c = [0.0; CHANNELS];
            recording = recording.at_reference(&Thermal { reference_c, zero_uv_per_c, gain_per_c });
        }
        let freed = recording.without_creep(creep).freed(friction);
        let contact = |(at, it): &(usize, Measured)| {
            let uv = freed.rows.get(*at)?.uv?;
            Some((Strain { uv: uv.map(|uv| uv as f32) }, it.force_n))
        };
        self.contacts.iter().filter_map(contact).collect()
    }

    /// What the fitted numbers leave open about contacts all over the plate, of which a part is shear.
    pub(super) fn doubts(&self, fit: &Fit) -> Vec<Doubt> {
        let shear_n = 0.4 * DOUBT_N;
        let forces_n = [[shear_n, 0.0, DOUBT_N], [0.0, shear_n, DOUBT_N], [-shear_n, -shear_n, DOUBT_N]];
        let doubt = |place_mm: [f64; 2]| {
            let place = Place::of(&self.before.field, &self.sensitivities, self.plate_mm, place_mm);
            forces_n.map(|force_n| {
                let contact = Measured::unmeasured(place.clone(), force_n);
                let mut halves = Vec::with_capacity(CHANNELS);
                self.layout.readings(&fit.values, &self.scale, &contact, |_, _, slopes| {
                    halves.push(fit.factor.solve_lower(slopes));
                });
                let product =
                    |one: &Vec<f64>, other: &Vec<f64>| one.iter().zip(other).map(|(a, b)| a * b).sum();
                Doubt { place_mm, force_n, uv2: products(&halves, product) }
            })
        };
        places(self.reach_mm).flat_map(doubt).collect()
    }

    /// The physical numbers: value and standard deviation.
    pub(super) fn physical(&self, fit: &Fit) -> Vec<(Parameter, f64, f64)> {
        let numbers = self.layout.physical.iter().zip(Layout::first_physical()..);
        numbers.map(|(parameter, at)| (*parameter, fit.values[at], fit.deviation(at))).collect()
    }

    /// The pad's own field.
    pub(super) fn corrected(&self, values: &[f64]) -> InfluenceField {
        let signals = &self.before.field.signals;
        InfluenceField::sampled(f64::from(signals.spacing_mm()), self.reach_mm, self.reach_mm, |place_mm| {
            let place = Place::of(&self.before.field, &self.sensitivities, self.plate_mm, place_mm);
            let maps = self.layout.maps(values, &self.scale, &place);
            std::array::from_fn::<f64, MAPS, _>(|map| maps[map / 3][map % 3])
        })
    }
}

/// From each reading of the untouched pad to the next.
fn jumps(zeros: Vec<Untouched>) -> Vec<Jump> {
    let jump = |((first, before), (second, after)): (&Untouched, &Untouched)| Jump {
        rows: [*first, *second],
        change_uv: std::array::from_fn(|k| after[k] - before[k]),
        lags: [[0.0; CHANNELS]; PLAYS],
        crept_uv: [0.0; CHANNELS],
    };
    zeros.iter().zip(zeros.get(1..).unwrap_or_default()).map(jump).collect()
}

/// From one state to another.
fn change(from: &[f64; CHANNELS], to: &[f64; CHANNELS]) -> [f64; CHANNELS] {
    std::array::from_fn(|k| to[k] - from[k])
}

/// ln of the probability of the numbers before anything is measured, but for a constant.
fn prior(values: &[f64], before: &[f64], precisions: &[f64]) -> f64 {
    let number = |(precision, (before, value)): (&f64, (&f64, &f64))| {
        precision.ln() - precision * (before - value).powi(2)
    };
    0.5 * precisions.iter().zip(before.iter().zip(values)).map(number).sum::<f64>()
}

fn products<T>(all: &[T], product: impl Fn(&T, &T) -> f64) -> [[f64; CHANNELS]; CHANNELS] {
    std::array::from_fn(|i| std::array::from_fn(|j| product(&all[i], &all[j])))
}
