//! The simulated pad as a model of nine channels.

use std::sync::Arc;

use rayon::prelude::*;

use super::own::own_chain;
use super::row::{Row, continued, response};
use crate::diagnosis::causes::cause::{Cause, ChainStage};
use crate::diagnosis::causes::{hypotheses, missing};
use crate::diagnosis::label::{Hypothesis, Label};
use crate::diagnosis::model::chain::{Chain, Reference};
use crate::diagnosis::model::mechanics::{Maps, at_places, changes, side_share};
use crate::diagnosis::model::memory::{MemoryChain, RowSequence};
use crate::diagnosis::model::reading::{StrainHistory, read, slopes};
use crate::diagnosis::model::setting::{Change, Setting};
use crate::diagnosis::report::NotTestable;
use crate::effect::Effect;
use crate::tangent::SimulatedPad;
use tactpad_core::pad::device::{Device, Side};
use tactpad_core::pad::field::PadField;
use tactpad_core::pad::influence::InfluenceField;
use tactpad_core::quantity::{CHANNELS, MODULES};
use tactpad_inference::model::{CommonError, Linearised, Model, Signature};
use tactpad_inference::observations::{Observations, Sample};
use tactpad_inference::policy::BACKGROUND_MAX;
use tactpad_numeric::statistics::rms;

/// Standard deviation of factors that all modules' x, y or z channels share, of their answer to any load, to shear and to normal
/// loads: the simulator's discretisation. Held against an independent solution: −0.5, −1.2 and +0.7 % of shear, +0.3, −0.1, +0.6 % of normal
/// loads.
const COMMON_ERROR: f64 = 0.008;
/// Standard deviations of the simulator's error that look like a cause, as coordinates of that cause: the plate's polynomials are
/// stiffer than the plate, and its splines round the field off. Held against the same solution: 1.1 % and 0.64 mm².
const ERRORS_LIKE: [(Effect, f64); 2] = [(Effect::PlateStiffness, 0.015), (Effect::ContactSize, 0.65)];
/// Half the width of the difference that makes the derivative by such a factor's logarithm.
const STEP: f64 = 1e-3;

/// Nine channels by a pad's field.
pub(crate) struct Simulated {
    signals: InfluenceField,
    /// The rows that are asked for, and all of their series, in their order: what is remembered is so in that.
    pub(crate) sequence: Observations,
    course: RowSequence,
    /// The rows of it that are asked for.
    pub(crate) picked: Vec<usize>,
    /// How many measurements there are in all.
    measurements: usize,
    setting: Setting,
    reference: Reference,
    /// Root mean square of the loads of the whole measurement.
    load_rms_n: f64,
    hypotheses: Vec<Hypothesis>,
    causes: Vec<&'static Cause>,
    /// The device's own imperfections.
    own: Chain,
    /// For each row, the changes of the maps, in the order of the setting's.
    changes: Vec<Arc<[Maps]>>,
}

/// The pad where hypotheses hold: what derivatives are taken about.
struct Point<'p> {
    applied: &'p [(usize, Vec<f64>)],
    chain: Chain,
    rows: Vec<Row>,
    history: StrainHistory<[f64; CHANNELS]>,
    /// Each channel's readings at the rows that are asked for.
    readings: Vec<Vec<f64>>,
}

impl Simulated {
    /// The pad at some `observations` of a `sequence`, about the `field` of its `own` device: hypotheses and references are those of
    /// `all` rows and of the pad that is held to be right, so that any part, about any field, has the same. Nobody asks for the effects in `without`.
    pub(crate) fn new(
        pad: &SimulatedPad<'_>,
        without: &[Effect],
        own: &Device,
        field: &PadField,
        all: &Observations,
        sequence: &Observations,
        observations: &Observations,
    ) -> Self {
        let course = |samples: &[Sample], follows: &[bool]| {
            RowSequence::of(samples, follows, pad.device.contact.full_scale_n)
        };
        let changes = changes(pad.device, own, field, pad.flaws);
        let setting = setting(pad.device, changes, all, &course(&all.samples, &all.follows()));
        let needed = sequence.with_series(&observations.numbers);
        let follows = sequence.follows();
        let follows: Vec<bool> = needed.iter().map(|row| follows[*row]).collect();
        let sequence = sequence.picked(&needed);
        let (hypotheses, causes) = hypotheses(&setting, |effect| !without.contains(&effect));
        let places_mm: Vec<[f64; 2]> = sequence.samples.iter().map(|sample| sample.place_mm).collect();
        let reference = reference(pad.device, pad.field, all);
        let weights = setting.own_weights(pad.device, own);
        Self {
            own: own_chain(pad.device, weights, &reference),
            signals: field.signals.clone(),
            reference,
            load_rms_n: all.load_rms(),
            changes: at_places(field, pad.flaws, pad.device.plate.radius_mm(), &places_mm),
            course: course(&sequence.samples, &follows),
            sequence,
            picked: observations.numbers.iter().map(|row| needed.partition_point(|it| it < row)).collect(),
            measurements: all.samples.iter().map(|it| it.measurement + 1).max().unwrap_or(1),
            setting,
            hypotheses,
            causes,
        }
    }

    /// Whether a hypothesis changes the field.
    pub(crate) fn changes_field(&self, hypothesis: usize) -> bool {
        let steps = self.hypotheses[hypothesis].parameters.iter().map(|it| it.step).collect();
        self.chain(&[(hypothesis, steps)]).mechanics.weights != self.own.mechanics.weights
    }

    /// The causes that cannot be asked for, and what is missing.
    pub(crate) fn missing(&self) -> Vec<NotTestable> {
        missing(&self.setting)
    }

    /// The chain of these hypotheses.
    pub(crate) fn chain(&self, applied: &[(usize, Vec<f64>)]) -> Chain {
        let mut chain = self.own.clone();
        for (at, coordinates) in applied {
            let hypothesis = &self.hypotheses[*at];
            let values: Vec<f64> =
                hypothesis.parameters.iter().zip(coordinates).map(|(it, psi)| it.value(*psi)).collect();
            self.causes[*at].apply(&hypothesis.label.1, &values, &self.setting, &mut chain);
        }
        chain
    }

    /// With a row `near` it, of another chain, whose maps are its own if it is at the same place, and whose changes if it bears the same force.
    fn row(&self, at: usize, chain: &Chain, near: Option<&Row>) -> Row {
        let samples = &self.sequence.samples;
        let then = self.course.moment(at, chain.rig.lag_s);
        let place_mm = std::array::from_fn(|axis| then.of(|row| samples[row].place_mm[axis]));
        let force_n = std::array::from_fn(|axis| then.of(|row| samples[row].load[axis]));
        let rig = chain.rig_at(&samples[at]);
        let (place_mm, force_n) = (rig.place_mm(place_mm), rig.force_n(force_n));
        let (gains, laplacian) = match near.filter(|it| it.place_mm == place_mm) {
            Some(near) => (near.gains, near.laplacian),
            None => (continued(&self.signals, place_mm), self.signals.laplacian(place_mm)),
        };
        let changes = match near.filter(|it| it.force_n == force_n) {
            Some(near) => near.changes.clone(),
            None => self.changes[at].iter().map(|maps| maps.map(|map| response(&map, &force_n))).collect(),
        };
        Row { place_mm, force_n, gains, laplacian, changes }
    }

    /// What a unit of true force along each axis strains at a place that is written so, without the field's changes.
    pub(crate) fn maps(&self, written_mm: [f64; 2], chain: &Chain) -> Maps {
        let place_mm = chain.rig.place_mm(written_mm);
        let gains = continued(&self.signals, place_mm);
        let laplacian = self.signals.laplacian(place_mm);
        let axes: [[f64; CHANNELS]; 3] = std::array::from_fn(|axis| {
            let force_n = std::array::from_fn(|other| f64::from(u8::from(other == axis)));
            Row { place_mm, force_n, gains, laplacian, changes: Vec::new() }.strain(chain)
        });
        std::array::from_fn(|channel| axes.map(|strain| strain[channel]))
    }

    fn rows(&self, chain: &Chain) -> Vec<Row> {
        (0..self.sequence.rows()).into_par_iter().map(|at| self.row(at, chain, None)).collect()
    }

    /// Each channel's values at the rows that are asked for.
    fn picked(&self, channels: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        channels.into_iter().map(|of| self.picked.iter().map(|row| of[*row]).collect()).collect()
    }

    /// The strains of all rows, with what the channels remember of them.
    fn history(
        &self,
        strains: Vec<[f64; CHANNELS]>,
        chain: &Chain,
        near: Option<&StrainHistory<[f64; CHANNELS]>>,
    ) -> StrainHistory<[f64; CHANNELS]> {
        StrainHistory::of(strains, chain, &self.course, &self.reference.full_scale, near)
    }

    /// Half of what friction adds to strains that are too large by the largest background, less what to ones that are too small; and
    /// the same of creep under loads that came early, and late, between two rows.
    fn doubts(&self, Point { rows, chain, .. }: &Point<'_>) -> Vec<Vec<f64>> {
        let magnitude = |row: &Row| libm::sqrt(row.force_n.iter().map(|n| n * n).sum());
        let magnitudes: Vec<f64> = rows.iter().map(magnitude).collect();
        let strains: Vec<[f64; CHANNELS]> = rows.iter().map(|row| row.strain(chain)).collect();
        let friction = MemoryChain { relaxations: Vec::new(), ..chain.memory.clone() };
        let creep = MemoryChain { plays: Vec::new(), ..chain.memory.clone() };
        let doubt = |channel: usize| {
            let (full_scale, size) = (self.reference.full_scale[channel], self.reference.sizes[channel]);
            let added = |memory: &MemoryChain, off: f64, early: f64| {
                let off = |magnitude: f64| off * BACKGROUND_MAX * size * magnitude / self.load_rms_n;
                let own = strains.iter().zip(&magnitudes).map(|(strain, it)| strain[channel] + off(*it));
                memory.added(&self.course, channel, full_scale, &own.collect::<Vec<_>>(), early)
            };
            let pairs = [
                [1.0, -1.0].map(|off| added(&friction, off, 0.0)),
                [1.0, -1.0].map(|early| added(&creep, 0.0, early)),
            ];
            let halves = |pair: &[Option<Vec<f64>>; 2], row: usize| match pair {
                [Some(above), Some(below)] => 0.5 * (above[row] - below[row]),
                _ => 0.0,
            };
            if pairs.iter().flatten().all(Option::is_none) {
                return Vec::new();
            }
            self.picked
                .iter()
                .map(|row| libm::hypot(halves(&pairs[0], *row), halves(&pairs[1], *row)))
                .collect()
        };
        (0..CHANNELS).into_par_iter().map(doubt).collect()
    }

    /// Readings of the channels at strains with their memory, at the rows that are asked for.
    fn read(&self, strains: &[[f64; CHANNELS]], chain: &Chain) -> Vec<Vec<f64>> {
        self.picked(read(strains, chain, &self.course, &self.reference, &self.sequence.samples))
    }

    /// Readings of a row at these strains, without memory.
    pub(crate) fn reading(&self, at: usize, strain: &[f64; CHANNELS], chain: &Chain) -> [f64; CHANNELS] {
        let mut values = *strain;
        chain.channels.read(&mut values, &self.reference.conditions(&self.sequence.samples[at]));
        values
    }

    /// What each channel reads at the rows that are asked for because of the rows about them, by what was written.
    pub(crate) fn of_order(&self, chain: &Chain) -> Vec<Vec<f64>> {
        let mut alone = Chain { memory: MemoryChain::default(), ..chain.clone() };
        alone.rig.lag_s = 0.0;
        alone.skew_s.fill(0.0);
        let read = |chain: &Chain| self.read(&self.strained(&self.rows(chain), chain).remembered, chain);
        let channels = read(chain).into_iter().zip(read(&alone));
        channels.map(|(all, alone)| all.iter().zip(alone).map(|(a, b)| a - b).collect()).collect()
    }

    fn point<'p>(&self, applied: &'p [(usize, Vec<f64>)]) -> Point<'p> {
        let chain = self.chain(applied);
        let rows = self.rows(&chain);
        let history = self.strained(&rows, &chain);
        let readings = self.read(&history.remembered, &chain);
        Point { applied, chain, rows, history, readings }
    }

    /// The readings with one more hypothesis, of which only what it can change is computed anew.
    fn perturbed(
        &self,
        Point { rows, history, .. }: &Point<'_>,
        stage: ChainStage,
        chain: &Chain,
    ) -> Vec<Vec<f64>> {
        let strains = match stage {
            ChainStage::Contact => {
                let row = |(at, near)| self.row(at, chain, Some(near)).strain(chain);
                rows.iter().enumerate().map(row).collect()
            }
            ChainStage::Mechanics | ChainStage::Coupling => {
                rows.iter().map(|row| row.strain(chain)).collect()
            }
            ChainStage::Channels => return self.read(&history.remembered, chain),
        };
        self.read(&self.history(strains, chain, Some(history)).remembered, chain)
    }

    /// The strains of all rows, and with their memory.
    fn strained(&self, rows: &[Row], chain: &Chain) -> StrainHistory<[f64; CHANNELS]> {
        self.history(rows.iter().map(|row| row.strain(chain)).collect(), chain, None)
    }

    /// ∂readings/∂ln g where all modules' x, y or z channels answer g times: with all that is remembered.
    fn gain_of_axis(&self, point: &Point<'_>, axis: usize) -> Signature {
        let moved = |by: f64| {
            let mut chain = point.chain.clone();
            (axis..CHANNELS).step_by(3).for_each(|channel| chain.channels.gain[channel] *= by.exp());
            self.read(&point.history.remembered, &chain)
        };
        let channels = moved(STEP).into_iter().zip(moved(-STEP)).enumerate();
        let slope = |(above, below): (f64, f64)| (above - below) / (2.0 * STEP);
        channels
            .map(|(channel, (above, below))| {
                (channel % 3 == axis).then(|| above.into_iter().zip(below).map(slope).collect())
            })
            .collect()
    }

    /// What x, y or z channels answer to these parts of the loads, without what is remembered.
    fn answer_of_axis(&self, point: &Point<'_>, axis: usize, taken: [f64; 3]) -> Signature {
        let of_channel = |channel: usize| {
            let of = |row: &usize| {
                let row = &point.rows[*row];
                let force_n = [0, 1, 2].map(|load| taken[load] * row.force_n[load]);
                response(&row.gains.value[channel], &force_n)
            };
            (channel % 3 == axis).then(|| self.picked.iter().map(of).collect())
        };
        (0..CHANNELS).map(of_channel).collect()
    }

    /// What each channel's zero of a further measurement differs by from that of the first: as much as it reads.
    fn zeros_of_further(&self) -> impl Iterator<Item = CommonError> {
        (1..self.measurements).flat_map(move |measurement| {
            (0..CHANNELS).map(move |channel| {
                let is_own = |row: &usize| self.sequence.samples[*row].measurement == measurement;
                let own: Vec<f64> = self.picked.iter().map(|row| f64::from(u8::from(is_own(row)))).collect();
                let signature = (0..CHANNELS).map(|k| (k == channel).then(|| own.clone())).collect();
                CommonError { deviation: self.reference.sizes[channel], signature }
            })
        })
    }

    /// With the derivatives by the coordinates of some hypotheses.
    fn derived(
        &self,
        point: Point<'_>,
        doubts: Vec<Vec<f64>>,
        of: impl Fn(usize) -> bool + Sync,
    ) -> Linearised {
        let signatures = self.hypotheses.par_iter().enumerate().map(|(at, hypothesis)| {
            let signature = |parameter| {
                if of(at) { self.signature(&point, [at, parameter]) } else { vec![None; CHANNELS] }
            };
            (0..hypothesis.parameters.len()).map(signature).collect()
        });
        Linearised {
            signatures: signatures.collect(),
            loads: self.picked.iter().map(|row| point.rows[*row].force_n).collect(),
            doubts,
            readings: point.readings,
        }
    }

    /// ∂readings/∂ψ by one coordinate: a central difference.
    fn signature(&self, point: &Point<'_>, [at, parameter]: [usize; 2]) -> Signature {
        let hypothesis = &self.hypotheses[at];
        if hypothesis.parameters[parameter].shape.is_some()
            && point.applied.iter().all(|(held, _)| *held != at)
        {
            return vec![None; CHANNELS];
        }
        let moved = |by: f64| {
            let mut applied = point.applied.to_vec();
            let own = match applied.iter().position(|(index, _)| *index == at) {
                Some(own) => own,
                None => {
                    applied.push((at, vec![0.0; hypothesis.parameters.len()]));
                    applied.len() - 1
                }
            };
            applied[own].1[parameter] += by;
            self.perturbed(point, self.causes[at].stage, &self.chain(&applied))
        };
        slopes(&hypothesis.parameters[parameter], &point.readings, moved, &self.reference.full_scale)
    }
}

impl Model<Label> for Simulated {
    fn hypotheses(&self) -> &[Hypothesis] {
        &self.hypotheses
    }

    fn readings(&self, applied: &[(usize, Vec<f64>)]) -> Vec<Vec<f64>> {
        self.point(applied).readings
    }

    fn sizes(&self) -> Vec<f64> {
        self.reference.sizes.clone()
    }

    fn full_scale(&self) -> Vec<f64> {
        self.reference.full_scale.clone()
    }

    fn linearised(&self, applied: &[(usize, Vec<f64>)]) -> Linearised {
        let point = self.point(applied);
        let doubts = self.doubts(&point);
        self.derived(point, doubts, |_| true)
    }

    fn linearised_by_applied(&self, applied: &[(usize, Vec<f64>)]) -> Linearised {
        let is_applied = |at: usize| applied.iter().any(|(held, _)| *held == at);
        self.derived(self.point(applied), vec![Vec::new(); CHANNELS], is_applied)
    }

    fn common_errors(&self, applied: &[(usize, Vec<f64>)]) -> Vec<CommonError> {
        let point = self.point(applied);
        let mut errors = Vec::new();
        for axis in 0..3 {
            errors.push(self.gain_of_axis(&point, axis));
            errors.extend(
                [[1.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|taken| self.answer_of_axis(&point, axis, taken)),
            );
        }
        let errors = errors.into_iter();
        let mut errors: Vec<CommonError> =
            errors.map(|signature| CommonError { deviation: COMMON_ERROR, signature }).collect();
        for (effect, deviation) in ERRORS_LIKE {
            let like = self.hypotheses.iter().position(|it| it.label.0 == effect);
            errors
                .extend(like.map(|at| CommonError { deviation, signature: self.signature(&point, [at, 0]) }));
        }
        errors.extend(self.zeros_of_further());
        errors
    }
}

fn setting(
    device: &Device,
    changes: Vec<Change>,
    observations: &Observations,
    course: &RowSequence,
) -> Setting {
    let differs = |of: fn(&Sample) -> Option<f64>| {
        let mut values = observations.samples.iter().filter_map(of);
        values.next().is_some_and(|first| values.any(|value| value != first))
    };
    Setting {
        channels: CHANNELS,
        modules: MODULES,
        changes,
        has_field: true,
        side_shares: Side::ALL.map(|side| (side, side_share(device, side))),
        patch_radius_mm: device.contact.patch_radius_mm,
        has_time: differs(|sample| sample.t_s),
        has_temperature: differs(|sample| sample.temp_c),
        has_cycles: differs(|sample| sample.cycle),
        has_series: course.has_series(),
        has_both_ways: course.has_both_ways() || course.has_series(),
        dwells: course.dwells(),
    }
}

fn reference(device: &Device, field: &PadField, observations: &Observations) -> Reference {
    let samples = &observations.samples;
    let nominal = |sample: &Sample| {
        continued(&field.signals, sample.place_mm).value.map(|gains| response(&gains, &sample.load))
    };
    let nominal: Vec<[f64; CHANNELS]> = samples.iter().map(nominal).collect();
    let of = |channel: usize| nominal.iter().map(move |row| row[channel]);
    Reference {
        temp_c: device.behaviour.thermal.reference_c,
        t_s: samples.iter().filter_map(|sample| sample.t_s).fold(f64::INFINITY, f64::min),
        cycle: samples.iter().filter_map(|sample| sample.cycle).fold(0.0, f64::max),
        full_scale: (0..CHANNELS).map(|k| of(k).map(f64::abs).fold(f64::MIN_POSITIVE, f64::max)).collect(),
        sizes: (0..CHANNELS).map(|k| rms(of(k))).collect(),
    }
}
