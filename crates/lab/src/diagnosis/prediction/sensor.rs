//! Anybody's sensor as a model of its channels: what its model predicts, and what may be otherwise.
//!
//! ```text
//! eₖ(row) = Pₖ(row) − rₖ + fₖ(labels) − fₖ(written) + Σⱼ aⱼ Dⱼₖ(row)
//! yₖ(row) = law of the channels at mₖ, and at rₖ without its bend, − rₖ
//! ```
//!
//! P are the predictions, f a regression of them on the labels, which says how they change where the labels are wrong, D the derivatives by
//! what somebody's own simulation can vary, r what channels should read at rest. m is e with what is remembered of it; the law of the
//! channels is that of all ([`tactpad_core::pad::channels`]). All readings are beside r, so that a background is a share of what loads do.

use rayon::prelude::*;

use super::derivative::Derivative;
use super::rows::PredictedRows;
use crate::diagnosis::against::ColumnSelection;
use crate::diagnosis::causes::cause::{Cause, ChainStage};
use crate::diagnosis::causes::{hypotheses, missing};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::label::{Hypothesis, Label, ModelOfRows};
use crate::diagnosis::model::chain::{Chain, Reference};
use crate::diagnosis::model::memory::RowSequence;
use crate::diagnosis::model::reading::{StrainHistory, read, slopes};
use crate::diagnosis::model::setting::Setting;
use crate::diagnosis::report::NotTestable;
use crate::effect::{Effect, interned};
use crate::rig::errors::RigErrors;
use tactpad_core::pad::channels::ChannelChain;
use tactpad_core::pad::device::Side;
use tactpad_inference::error::InferenceError;
use tactpad_inference::hypothesis::{Coordinate, Parameter};
use tactpad_inference::model::{CommonError, Linearised, Model, Signature};
use tactpad_inference::observations::{Observations, Sample};
use tactpad_inference::policy::SIGNATURE_ERROR;
use tactpad_inference::regression::{Labels, Regression};
use tactpad_numeric::products::dot;
use tactpad_numeric::statistics::{mean, rms};

/// What only a simulated pad can say.
const OF_PADS: [Effect; 3] = [Effect::PlateStiffness, Effect::ContactHeight, Effect::ContactSize];
/// Numbers of the rig, and the labels that they move.
const OF_LABELS: [(Effect, &[&str]); 6] = [
    (Effect::StageOffset, &["x_mm", "y_mm"]),
    (Effect::StageRotation, &["x_mm", "y_mm"]),
    (Effect::StageScale, &["x_mm", "y_mm"]),
    (Effect::ReferenceTilt, &["fx_n", "fy_n", "fz_n"]),
    (Effect::ReferenceGain, &["fx_n", "fy_n", "fz_n"]),
    (Effect::ReferenceZero, &["fx_n", "fy_n", "fz_n"]),
];
/// What a model may get wrong in all channels alike looks like one of these, or like what somebody's own simulation can vary.
const ERRORS_LIKE: [Effect; 7] = [
    Effect::ExcitationGain,
    Effect::ReferenceTilt,
    Effect::ReferenceGain,
    Effect::ReferenceZero,
    Effect::StageOffset,
    Effect::StageRotation,
    Effect::StageScale,
];
/// Half the width of the difference that makes a derivative by an own effect, as a share of its prior deviation.
const STEP: f64 = 1e-3;

/// What a hypothesis changes.
#[derive(Clone, Copy)]
enum Change {
    /// A cause of the catalogue.
    Cause(&'static Cause),
    /// One of the derivatives, by its number.
    Derivative(usize),
}

/// Where hypotheses hold: what derivatives are taken about.
struct Point<'p> {
    applied: &'p [(usize, Vec<f64>)],
    chain: Chain,
    /// e and m.
    history: StrainHistory<Vec<f64>>,
    readings: Vec<Vec<f64>>,
}

/// How the predictions go with the labels.
struct LabelResponse {
    regression: Regression,
    /// For each channel, weights of the covariances with the pivots.
    spreads: Vec<Vec<f64>>,
    /// Places of x, y, Fx, Fy, Fz among the labels.
    moved: [Option<usize>; 5],
}

/// A sensor at all rows of a measurement.
pub(super) struct Sensor {
    hypotheses: Vec<Hypothesis>,
    changes: Vec<Change>,
    setting: Setting,
    reference: Reference,
    course: RowSequence,
    samples: Vec<Sample>,
    inputs: Vec<Vec<f64>>,
    /// For each row, the channels' strains by the predictions.
    strains: Vec<Vec<f64>>,
    /// What each channel should read at rest.
    rest: Vec<f64>,
    /// For each derivative and row, those of the channels.
    derivatives: Vec<Vec<Vec<f64>>>,
    /// None where no label is written, or none goes with the predictions.
    response: Option<LabelResponse>,
    nominal: Chain,
    /// What the model itself gets wrong, as a share of a channel's root mean square.
    model_error: f64,
}

impl Sensor {
    pub(super) fn of(
        rows: &PredictedRows,
        derivatives: &[Derivative],
        asked: &ColumnSelection<'_>,
        model_error: f64,
    ) -> Result<Self, InferenceError> {
        let PredictedRows { columns, recording, .. } = rows;
        let observations = &recording.observations;
        let samples = observations.samples.clone();
        let strains = rows.strains();
        let largest_n = samples.iter().map(|it| rms(it.load) * 3_f64.sqrt()).fold(0.0, f64::max);
        let course = RowSequence::of(&samples, &observations.follows(), largest_n);
        let setting = setting(columns.channels.len(), &samples, &course);
        let reference = reference(&strains, &samples);
        let response = if columns.inputs.is_empty() { None } else { LabelResponse::of(rows, &strains)? };
        let has = |name: &&str| columns.input(name).is_some();
        let is_moved = |effect: Effect| match OF_LABELS.iter().find(|(of, _)| *of == effect) {
            Some((Effect::StageRotation | Effect::ReferenceTilt, labels)) => labels.iter().all(has),
            Some((_, labels)) => labels.iter().any(has),
            None => true,
        };
        let asks_for = |effect: Effect| {
            asked.asks_for(effect)
                && !OF_PADS.contains(&effect)
                && (response.is_some() || !OF_LABELS.iter().any(|(of, _)| *of == effect))
                && is_moved(effect)
        };
        let (mut hypotheses, causes) = hypotheses(&setting, asks_for);
        for hypothesis in &mut hypotheses {
            if hypothesis.label.1 == Target::Pad {
                hypothesis.label.1 = Target::All;
            }
            // A number that moves a label which is not there is none.
            if let Some((_, labels)) = OF_LABELS.iter().find(|(of, _)| *of == hypothesis.label.0)
                && hypothesis.parameters.len() == labels.len()
            {
                let mut labels = labels.iter();
                hypothesis.parameters.retain(|_| labels.next().is_some_and(&has));
            }
        }
        let mut changes: Vec<Change> = causes.into_iter().map(Change::Cause).collect();
        for (at, it) in derivatives.iter().enumerate() {
            hypotheses.push(of_derivative(it));
            changes.push(Change::Derivative(at));
        }
        let at_rows = |it: &Derivative| {
            let of = |name: &String| it.table.numbers(name);
            let channels: Vec<Option<&[f64]>> = columns.channels.iter().map(of).collect();
            let number = |row: usize, of: &Option<&[f64]>| of.map_or(0.0, |of| of[row]);
            recording
                .table_rows
                .iter()
                .map(|row| channels.iter().map(|of| number(*row, of)).collect())
                .collect()
        };
        Ok(Self {
            nominal: Chain::nominal(ChannelChain::nominal(reference.full_scale.clone()), 0),
            derivatives: derivatives.iter().map(at_rows).collect(),
            inputs: recording.inputs.clone(),
            rest: rows.rest(),
            model_error,
            hypotheses,
            changes,
            setting,
            reference,
            course,
            samples,
            strains,
            response,
        })
    }

    /// The causes that cannot be asked for, and what is missing.
    pub(super) fn missing(&self) -> Vec<NotTestable> {
        missing(&self.setting)
    }

    /// The chain of these hypotheses, and how large the own effects are.
    fn chain(&self, applied: &[(usize, Vec<f64>)]) -> (Chain, Vec<f64>) {
        let (mut chain, mut sizes) = (self.nominal.clone(), vec![0.0; self.derivatives.len()]);
        for (at, coordinates) in applied {
            let Hypothesis { label: (effect, target), parameters, .. } = &self.hypotheses[*at];
            let values: Vec<f64> =
                parameters.iter().zip(coordinates).map(|(it, psi)| it.value(*psi)).collect();
            match self.changes[*at] {
                Change::Derivative(of) => sizes[of] += values[0],
                Change::Cause(cause) => {
                    let values = self.with_missing(*effect, values, parameters);
                    cause.apply(target, &values, &self.setting, &mut chain);
                }
            }
        }
        (chain, sizes)
    }

    /// The values of a cause's numbers, with nothing for those that move labels which are not there.
    fn with_missing(&self, effect: Effect, values: Vec<f64>, parameters: &[Parameter]) -> Vec<f64> {
        let Some((_, labels)) = OF_LABELS.iter().find(|(of, _)| *of == effect) else { return values };
        if !parameters.iter().all(|it| labels.contains(&it.name)) {
            return values;
        }
        let value =
            |name: &&str| parameters.iter().position(|it| it.name == *name).map_or(0.0, |at| values[at]);
        labels.iter().map(value).collect()
    }

    /// The strains of a row.
    fn strain(&self, at: usize, chain: &Chain, sizes: &[f64]) -> Vec<f64> {
        let rig = chain.rig_at(&self.samples[at]);
        let mut strain = self.strains[at].clone();
        if chain.rig != RigErrors::NONE {
            let then = self.course.moment(at, chain.rig.lag_s);
            strain = (0..strain.len()).map(|k| then.of(|row| self.strains[row][k])).collect();
            if let Some(response) = &self.response {
                let written: Vec<f64> =
                    (0..self.inputs[at].len()).map(|k| then.of(|row| self.inputs[row][k])).collect();
                let moved = response.moved(&written, &rig);
                let [before, after] = [written, moved].map(|row| response.at(&row));
                for (strain, (after, before)) in strain.iter_mut().zip(after.iter().zip(before)) {
                    *strain += after - before;
                }
            }
        }
        for (rows, size) in self.derivatives.iter().zip(sizes).filter(|(_, size)| **size != 0.0) {
            strain.iter_mut().zip(&rows[at]).for_each(|(strain, slope)| *strain += size * slope);
        }
        strain
    }

    /// How far the strains of rows may be off whose labels are moved: what the move changes is known no better than signatures are, and not at
    /// all where no row has such labels.
    fn doubts(&self, chain: &Chain) -> Vec<Vec<f64>> {
        let channels = self.rest.len();
        let Some(response) = self.response.as_ref().filter(|_| chain.rig != RigErrors::NONE) else {
            return vec![Vec::new(); channels];
        };
        let of_row = |at: usize| {
            let rig = chain.rig_at(&self.samples[at]);
            let written = &self.inputs[at];
            let moved = response.moved(written, &rig);
            let unknown = response.regression.unknown(&moved).sqrt();
            let [before, after] = [written, &moved].map(|row| response.at(row));
            let sizes = before.into_iter().zip(after).zip(&self.reference.sizes);
            let doubt = |((before, after), size): ((f64, f64), &f64)| {
                libm::hypot(SIGNATURE_ERROR * (after - before), unknown * size)
            };
            sizes.map(doubt).collect::<Vec<f64>>()
        };
        let rows: Vec<Vec<f64>> = (0..self.strains.len()).map(of_row).collect();
        (0..channels).map(|channel| rows.iter().map(|row| row[channel]).collect()).collect()
    }

    fn strained(&self, chain: &Chain, sizes: &[f64]) -> Vec<Vec<f64>> {
        (0..self.strains.len()).map(|at| self.strain(at, chain, sizes)).collect()
    }

    fn point<'p>(&self, applied: &'p [(usize, Vec<f64>)]) -> Point<'p> {
        let (chain, sizes) = self.chain(applied);
        let strains = self.strained(&chain, &sizes);
        let history = self.history(strains, &chain, None);
        let readings = self.read(&history.remembered, &chain);
        Point { applied, chain, history, readings }
    }

    /// ∂readings/∂ψ by one coordinate, at all rows.
    fn signature(&self, point: &Point<'_>, at: usize, parameter: usize) -> Signature {
        let Hypothesis { parameters, .. } = &self.hypotheses[at];
        let held = point.applied.iter().position(|(held, _)| *held == at);
        if parameters[parameter].shape.is_some() && held.is_none() {
            return vec![None; self.rest.len()];
        }
        let with_memory = |strains: Vec<Vec<f64>>, chain: &Chain| {
            self.read(&self.history(strains, chain, Some(&point.history)).remembered, chain)
        };
        let moved = |by: f64| {
            let mut applied = point.applied.to_vec();
            let own = held.unwrap_or(applied.len());
            if held.is_none() {
                applied.push((at, vec![0.0; parameters.len()]));
            }
            applied[own].1[parameter] += by;
            let (chain, sizes) = self.chain(&applied);
            match self.changes[at] {
                Change::Cause(Cause { stage: ChainStage::Channels, .. }) => {
                    self.read(&point.history.remembered, &chain)
                }
                // What memory adds changes, and not the strains.
                Change::Cause(Cause { stage: ChainStage::Mechanics | ChainStage::Coupling, .. }) => {
                    with_memory(point.history.strains.clone(), &chain)
                }
                _ => with_memory(self.strained(&chain, &sizes), &chain),
            }
        };
        slopes(&parameters[parameter], &point.readings, moved, &self.reference.full_scale)
    }

    fn history(
        &self,
        strains: Vec<Vec<f64>>,
        chain: &Chain,
        near: Option<&StrainHistory<Vec<f64>>>,
    ) -> StrainHistory<Vec<f64>> {
        StrainHistory::of(strains, chain, &self.course, &self.reference.full_scale, near)
    }

    fn read(&self, remembered: &[Vec<f64>], chain: &Chain) -> Vec<Vec<f64>> {
        let mut channels = read(remembered, chain, &self.course, &self.reference, &self.samples);
        // What rest reads has a gain, and no bend: the slope is that at rest.
        let mut straight = chain.channels.clone();
        straight.second_order.fill(0.0);
        for (row, sample) in self.samples.iter().enumerate() {
            let mut rest = self.rest.clone();
            straight.amplify(&mut rest, &self.reference.conditions(sample));
            for ((channel, read), rest) in channels.iter_mut().zip(rest).zip(&self.rest) {
                channel[row] += read - rest;
            }
        }
        channels
    }
}

impl LabelResponse {
    /// None where the predictions do not go with the labels.
    fn of(rows: &PredictedRows, strains: &[Vec<f64>]) -> Result<Option<Self>, InferenceError> {
        let PredictedRows { columns, recording, .. } = rows;
        let place = |name: &str| columns.input(name);
        let moved = ["x_mm", "y_mm", "fx_n", "fy_n", "fz_n"].map(place);
        if moved.iter().all(Option::is_none) {
            return Ok(None);
        }
        let labels = Labels {
            groups: columns.groups.clone(),
            rows: recording.inputs.clone(),
            others: vec![Vec::new(); recording.inputs.len()],
        };
        let channels: Vec<Vec<f64>> = (0..columns.channels.len())
            .map(|channel| strains.iter().map(|row| row[channel]).collect())
            .collect();
        let centred = |channel: &Vec<f64>| {
            let middle = mean(channel.iter().copied());
            channel.iter().map(|value| value - middle).collect()
        };
        let regression = Regression::of(&labels, &channels.iter().map(centred).collect::<Vec<Vec<f64>>>())?;
        let functions = regression.functions_at(&labels);
        let (is_told, follows) = (vec![true; strains.len()], vec![false; strains.len()]);
        let mut spreads = Vec::new();
        for channel in &channels {
            spreads.push(regression.spread(&regression.fitted(&functions, channel, &is_told, &follows)?));
        }
        Ok(Some(Self { regression, spreads, moved }))
    }

    /// f beside a constant.
    fn at(&self, labels: &[f64]) -> Vec<f64> {
        let covariances = self.regression.covariances(labels);
        self.spreads.iter().map(|spread| dot(spread, &covariances)).collect()
    }

    /// The true labels.
    fn moved(&self, written: &[f64], rig: &RigErrors) -> Vec<f64> {
        let number = |at: usize| self.moved[at].map_or(0.0, |at| written[at]);
        let place_mm = rig.place_mm([0, 1].map(number));
        let force_n = rig.force_n([2, 3, 4].map(number));
        let mut labels = written.to_vec();
        for (at, value) in self.moved.iter().zip(place_mm.into_iter().chain(force_n)) {
            at.iter().for_each(|at| labels[*at] = value);
        }
        labels
    }
}

fn of_derivative(it: &Derivative) -> Hypothesis {
    let value = Parameter {
        name: interned(&if it.unit.is_empty() { "value".to_owned() } else { format!("value_{}", it.unit) }),
        none: 0.0,
        range: it.range,
        step: STEP * it.prior_deviation,
        coordinate: Coordinate::Difference,
        shape: None,
    };
    Hypothesis {
        label: (Effect::Own(it.effect), Target::All),
        parameters: vec![value],
        signature_error: SIGNATURE_ERROR,
        prior_deviation: it.prior_deviation,
        zero_of: None,
    }
}

fn setting(channels: usize, samples: &[Sample], course: &RowSequence) -> Setting {
    let differs = |of: fn(&Sample) -> Option<f64>| {
        let mut values = samples.iter().map(of);
        let first = values.next().flatten();
        let mut all = samples.iter().map(of);
        first.is_some() && all.clone().all(|it| it.is_some()) && all.any(|it| it != first)
    };
    Setting {
        channels,
        modules: 0,
        changes: Vec::new(),
        has_field: true,
        side_shares: Side::ALL.map(|side| (side, 0.0)),
        patch_radius_mm: 1.0,
        has_time: differs(|sample| sample.t_s),
        has_temperature: differs(|sample| sample.temp_c),
        has_cycles: differs(|sample| sample.cycle),
        has_series: course.has_series(),
        has_both_ways: course.has_both_ways() || course.has_series(),
        dwells: course.dwells(),
    }
}

fn reference(strains: &[Vec<f64>], samples: &[Sample]) -> Reference {
    let channels = strains.first().map_or(0, Vec::len);
    let of = |channel: usize| strains.iter().map(move |row| row[channel]);
    let temps: Vec<f64> = samples.iter().filter_map(|sample| sample.temp_c).collect();
    Reference {
        temp_c: if temps.is_empty() { 0.0 } else { mean(temps) },
        t_s: samples.iter().filter_map(|sample| sample.t_s).fold(f64::INFINITY, f64::min),
        cycle: samples.iter().filter_map(|sample| sample.cycle).fold(0.0, f64::max),
        full_scale: (0..channels).map(|k| of(k).map(f64::abs).fold(f64::MIN_POSITIVE, f64::max)).collect(),
        sizes: (0..channels).map(|k| rms(of(k)).max(f64::MIN_POSITIVE.sqrt())).collect(),
    }
}

/// A sensor at some rows.
pub(super) struct SensorAt<'s> {
    sensor: &'s Sensor,
    picked: Vec<usize>,
    /// For each channel, what its model may get wrong of itself.
    errors: Vec<Vec<Vec<f64>>>,
}

impl<'s> SensorAt<'s> {
    pub(super) fn new(sensor: &'s Sensor, rows: &Observations) -> Self {
        let picked = rows.numbers.clone();
        // As a gain, and as a bend.
        let of_channel = |channel: usize| -> Vec<Vec<f64>> {
            let full_scale = sensor.reference.full_scale[channel];
            let of = |error: &dyn Fn(f64) -> f64| -> Vec<f64> {
                let strain = |row: &usize| sensor.strains[*row][channel];
                picked.iter().map(|row| sensor.model_error * error(strain(row))).collect()
            };
            vec![of(&|strain| strain), of(&|strain| strain * strain / full_scale)]
        };
        let channels = if sensor.model_error > 0.0 { 0..sensor.rest.len() } else { 0..0 };
        let errors = channels.map(of_channel).collect();
        Self { sensor, picked, errors }
    }

    fn at_rows(&self, signature: Signature) -> Signature {
        let picked = |of: Vec<f64>| self.picked.iter().map(|row| of[*row]).collect();
        signature.into_iter().map(|of| of.map(picked)).collect()
    }

    /// With the derivatives by the coordinates of some hypotheses.
    fn derived(
        &self,
        point: &Point<'_>,
        doubts: Vec<Vec<f64>>,
        of: impl Fn(usize) -> bool + Sync,
    ) -> Linearised {
        let sensor = self.sensor;
        let signatures = sensor.hypotheses.par_iter().enumerate().map(|(at, it)| {
            let signature = |parameter| {
                if of(at) {
                    self.at_rows(sensor.signature(point, at, parameter))
                } else {
                    vec![None; sensor.rest.len()]
                }
            };
            (0..it.parameters.len()).map(signature).collect()
        });
        Linearised {
            signatures: signatures.collect(),
            loads: self.picked.iter().map(|row| sensor.samples[*row].load).collect(),
            doubts,
            readings: self.picked(point.readings.clone()),
        }
    }

    /// Each channel's values at these rows.
    fn picked(&self, channels: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        let picked = |of: Vec<f64>| {
            if of.is_empty() { of } else { self.picked.iter().map(|row| of[*row]).collect() }
        };
        channels.into_iter().map(picked).collect()
    }
}

impl Model<Label> for SensorAt<'_> {
    fn hypotheses(&self) -> &[Hypothesis] {
        &self.sensor.hypotheses
    }

    fn readings(&self, applied: &[(usize, Vec<f64>)]) -> Vec<Vec<f64>> {
        self.picked(self.sensor.point(applied).readings)
    }

    fn sizes(&self) -> Vec<f64> {
        self.sensor.reference.sizes.clone()
    }

    fn full_scale(&self) -> Vec<f64> {
        self.sensor.reference.full_scale.clone()
    }

    fn linearised(&self, applied: &[(usize, Vec<f64>)]) -> Linearised {
        let point = self.sensor.point(applied);
        let doubts = self.picked(self.sensor.doubts(&point.chain));
        self.derived(&point, doubts, |_| true)
    }

    fn linearised_by_applied(&self, applied: &[(usize, Vec<f64>)]) -> Linearised {
        let is_applied = |at: usize| applied.iter().any(|(held, _)| *held == at);
        self.derived(&self.sensor.point(applied), vec![Vec::new(); self.sensor.rest.len()], is_applied)
    }

    /// Each as large, in units of the channels' root mean squares, as the model's error.
    fn common_errors(&self, applied: &[(usize, Vec<f64>)]) -> Vec<CommonError> {
        let (sensor, point) = (self.sensor, self.sensor.point(applied));
        if sensor.model_error <= 0.0 {
            return Vec::new();
        }
        let is_like = |effect: Effect| matches!(effect, Effect::Own(_)) || ERRORS_LIKE.contains(&effect);
        let like = (0..sensor.hypotheses.len()).filter(|at| is_like(sensor.hypotheses[*at].label.0));
        let of =
            |at: usize| (0..sensor.hypotheses[at].parameters.len()).map(move |parameter| (at, parameter));
        let like: Vec<(usize, usize)> = like.flat_map(of).collect();
        let error = |(at, parameter): &(usize, usize)| {
            let signature = sensor.signature(&point, *at, *parameter);
            let channels = signature.iter().zip(&sensor.reference.sizes);
            let shares = channels.map(|(slopes, size)| {
                slopes.as_ref().map_or(0.0, |slopes| (rms(slopes.iter().copied()) / size).powi(2))
            });
            let share = mean(shares.collect::<Vec<f64>>()).sqrt();
            let deviation = sensor.model_error / share.max(f64::MIN_POSITIVE.sqrt());
            CommonError { deviation, signature: self.at_rows(signature) }
        };
        like.par_iter().map(error).collect()
    }

    fn stated_errors(&self, channel: usize) -> &[Vec<f64>] {
        self.errors.get(channel).map_or(&[], Vec::as_slice)
    }
}

impl ModelOfRows for SensorAt<'_> {
    fn at<'o>(&'o self, rows: &'o Observations) -> Box<dyn Model<Label> + 'o> {
        Box::new(SensorAt::new(self.sensor, rows))
    }

    fn at_measured<'o>(
        &'o self,
        _all: &'o Observations,
        rows: &'o Observations,
    ) -> Box<dyn Model<Label> + 'o> {
        Box::new(SensorAt::new(self.sensor, rows))
    }
}
