//! The simulated pad about more than one field: its own, and those of changed pads that lie too far off for its tangent.

use crate::diagnosis::data::target::Target;
use crate::diagnosis::extension::{Circumstances, with};
use crate::diagnosis::label::{Hypothesis, Label, ModelOfRows, Search};
use crate::diagnosis::model::mechanics::changed;
use crate::diagnosis::report::NotTestable;
use crate::diagnosis::simulation::bench::contacts;
use crate::diagnosis::simulation::simulated::Simulated;
use crate::effect::Effect;
use crate::tangent::SimulatedPad;
use crate::tangent::{STIFFNESS_REACH, TURN_REACH_DEG, on_grid, shift_reach_mm};
use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::PadField;
use tactpad_inference::error::InferenceError;
use tactpad_inference::hypothesis::{Coordinate, Parameter};
use tactpad_inference::model::{ChannelBaselines, CommonError, Linearised, Model, Written};
use tactpad_inference::observations::Observations;
use tactpad_inference::search::{Applied, Attribution, AttributionFit, RandomEffects};
use tactpad_numeric::products::dot;

/// No more fields than this are solved for one diagnosis.
const SOLVED_MAX: usize = 3;
/// What each pad has of its own by make.
const OF_EACH_PAD: [Effect; 4] =
    [Effect::ChannelGain, Effect::ModuleDisplaced, Effect::ModuleRotated, Effect::ModuleTilted];
/// So few causes are not held against a pad that has all of these.
const SPARSE_MAX: usize = 2;
/// A field is solved where the tangent's error would move a number by so many of its own standard deviations.
const FAR: f64 = 1.0;

/// A changed pad.
struct Solved {
    /// The hypotheses that change its field.
    at: Applied,
    device: Device,
    field: PadField,
}

/// Nine channels, by the field that is nearest to what is asked for.
pub(crate) struct Atlas<'f> {
    pad: SimulatedPad<'f>,
    /// Effects that are not asked for.
    without: &'f [Effect],
    all: &'f Observations,
    /// The rows in whose order `observations` are remembered: all, or those of another measurement.
    sequence: &'f Observations,
    /// About the pad that is held to be right.
    first: Simulated,
    /// About the others, in the order of `solved`.
    others: Vec<Simulated>,
    solved: Vec<Solved>,
    /// For each hypothesis and each of its coordinates, how far the tangent reaches; none where the field does not change.
    reaches: Vec<Option<Vec<f64>>>,
    observations: &'f Observations,
}

/// What the search finds. Where that is too far from any field that is known, it is searched again about the field of the pad that was
/// found: what only made up for the tangent's error goes, and what that hid is seen.
pub(crate) fn attributed(atlas: &mut Atlas<'_>) -> Result<Attribution, InferenceError> {
    let mut found = chosen(&atlas.search())?;
    while atlas.solved.len() < SOLVED_MAX && atlas.is_far(&found.fit)? {
        let Some(solved) = atlas.solve(&found.fit.applied) else { break };
        atlas.add(solved);
        found = atlas.search().run(&found.fit.applied, &found.random_effects)?;
    }
    Ok(found)
}

/// What the search finds from nothing, or where it finds several causes and that is likelier, beside what each pad has of its own.
pub(crate) fn chosen(search: &Search<'_>) -> Result<Attribution, InferenceError> {
    let sparse = search.run(&Vec::new(), &[])?;
    if sparse.fit.applied.len() <= SPARSE_MAX {
        return Ok(sparse);
    }
    let hypotheses = search.model.hypotheses();
    // Nobody knows the gain of a channel that tells nothing.
    let is_told = |target: Target| match target {
        Target::Channel(channel) => search.observations.is_alive(channel),
        _ => true,
    };
    let of_effect = |effect: Effect| -> Vec<usize> {
        let is_random_effect = |at: &usize| {
            let (own, target) = hypotheses[*at].label;
            own == effect && is_told(target)
        };
        (0..hypotheses.len()).filter(is_random_effect).collect()
    };
    let random_effects: RandomEffects =
        OF_EACH_PAD.map(of_effect).into_iter().filter(|members| !members.is_empty()).collect();
    let none = |at: &usize| (*at, vec![0.0; hypotheses[*at].parameters.len()]);
    // Rows that do not tell all of it have no such fit.
    let Ok(dense) = search.run(&random_effects.iter().flatten().map(none).collect(), &random_effects) else {
        return Ok(sparse);
    };
    let is_dense = search.criterion_of(&dense)? < search.criterion_of(&sparse)?;
    Ok(if is_dense { dense } else { sparse })
}

impl<'f> Atlas<'f> {
    /// The pad at some `observations` of `all`.
    pub(crate) fn new(
        pad: &SimulatedPad<'f>,
        without: &'f [Effect],
        all: &'f Observations,
        observations: &'f Observations,
    ) -> Self {
        Self::in_order(pad, without, all, all, observations)
    }

    fn in_order(
        pad: &SimulatedPad<'f>,
        without: &'f [Effect],
        all: &'f Observations,
        sequence: &'f Observations,
        observations: &'f Observations,
    ) -> Self {
        let first = Simulated::new(pad, without, pad.device, pad.field, all, sequence, observations);
        let module_mm = shift_reach_mm(pad.device);
        let reaches = first.hypotheses().iter().enumerate().map(|(at, hypothesis)| {
            let reaches = hypothesis.parameters.iter().map(|it| reach(it, module_mm)).collect();
            first.changes_field(at).then_some(reaches)
        });
        let reaches = reaches.collect();
        Self {
            pad: *pad,
            without,
            all,
            sequence,
            first,
            others: Vec::new(),
            solved: Vec::new(),
            reaches,
            observations,
        }
    }

    /// Another atlas with the same pads.
    fn with<'o>(&'o self, mut other: Atlas<'o>) -> Atlas<'o> {
        for Solved { at, device, field } in &self.solved {
            other.add(Solved { at: at.clone(), device: device.clone(), field: field.clone() });
        }
        other
    }

    fn search(&self) -> Search<'_> {
        Search::new(self, self.all, self.observations)
    }

    /// The causes that cannot be asked for, and what is missing.
    pub(crate) fn missing(&self) -> Vec<NotTestable> {
        self.first.missing()
    }

    fn add(&mut self, solved: Solved) {
        let Solved { device, field, .. } = &solved;
        let about = Simulated::new(
            &self.pad,
            self.without,
            device,
            field,
            self.all,
            self.sequence,
            self.observations,
        );
        self.others.push(about);
        self.solved.push(solved);
    }

    /// The pad with those of the hypotheses that change its field; none if it cannot be had.
    fn solve(&self, applied: &Applied) -> Option<Solved> {
        let (mut device, mut at) = (self.pad.device.clone(), Applied::new());
        for (hypothesis, coordinates) in applied {
            let Some(reaches) = &self.reaches[*hypothesis] else { continue };
            let coordinates: Vec<f64> =
                coordinates.iter().zip(reaches).map(|(psi, reach)| on_grid(*psi, *reach)).collect();
            let Hypothesis { label: (effect, target), ref parameters, .. } =
                self.first.hypotheses()[*hypothesis];
            let values = parameters.iter().zip(&coordinates);
            let numbers: Vec<_> = values.map(|(it, psi)| (it.name, it.value(*psi))).collect();
            if let Some(changed) = with(&device, effect, target, &numbers, &Circumstances::default()) {
                device = changed;
                at.push((*hypothesis, coordinates));
            }
        }
        let field = (self.pad.solve)(&device)?;
        Some(Solved { at, device, field })
    }

    /// The place in `solved` of the field that is nearest; none for the pad's own.
    fn nearest(&self, applied: &[(usize, Vec<f64>)]) -> Option<usize> {
        let own = (self.distance(applied, &[]), None);
        let others = self.solved.iter().enumerate().map(|(k, it)| (self.distance(applied, &it.at), Some(k)));
        others.fold(own, |nearest, other| if other.0 <= nearest.0 { other } else { nearest }).1
    }

    fn about(&self, applied: &[(usize, Vec<f64>)]) -> &Simulated {
        self.nearest(applied).and_then(|k| self.others.get(k)).unwrap_or(&self.first)
    }

    /// The square of a distance, in reaches.
    fn distance(&self, from: &[(usize, Vec<f64>)], to: &[(usize, Vec<f64>)]) -> f64 {
        let square = |(at, reaches): (usize, &Option<Vec<f64>>)| {
            let reaches = reaches.as_ref()?;
            let by = difference(reaches.len(), coordinates(from, at), coordinates(to, at));
            Some(by.iter().zip(reaches).map(|(by, reach)| (by / reach).powi(2)).sum::<f64>())
        };
        self.reaches.iter().enumerate().filter_map(square).sum()
    }

    /// Whether the tangent's error moves a number of a fitted cause by more than that is known.
    fn is_far(&self, fit: &AttributionFit) -> Result<bool, InferenceError> {
        let at = self.nearest(&fit.applied).map_or(&[][..], |k| &self.solved[k].at);
        let search = self.search();
        for (place, (hypothesis, psi)) in fit.applied.iter().enumerate() {
            let Some(reaches) = &self.reaches[*hypothesis] else { continue };
            let by = difference(reaches.len(), Some(psi), coordinates(at, *hypothesis));
            let error = by.iter().zip(reaches).map(|(by, reach)| (by / reach).powi(2)).sum::<f64>().sqrt();
            let (projected, _) = search.without(fit, place)?;
            let own = &search.columns.of_hypothesis[*hypothesis];
            let square = dot(&projected.fisher.picked(own, own).times(&by), &by);
            if error * square.max(0.0).sqrt() > FAR {
                return Ok(true);
            }
        }
        Ok(false)
    }
}

impl Model<Label> for Atlas<'_> {
    fn hypotheses(&self) -> &[Hypothesis] {
        self.first.hypotheses()
    }

    fn readings(&self, applied: &[(usize, Vec<f64>)]) -> Vec<Vec<f64>> {
        self.about(applied).readings(applied)
    }

    fn sizes(&self) -> Vec<f64> {
        self.first.sizes()
    }

    fn full_scale(&self) -> Vec<f64> {
        self.first.full_scale()
    }

    fn linearised(&self, applied: &[(usize, Vec<f64>)]) -> Linearised {
        self.about(applied).linearised(applied)
    }

    fn linearised_by_applied(&self, applied: &[(usize, Vec<f64>)]) -> Linearised {
        self.about(applied).linearised_by_applied(applied)
    }

    fn common_errors(&self, applied: &[(usize, Vec<f64>)]) -> Vec<CommonError> {
        self.about(applied).common_errors(applied)
    }

    fn contacts(
        &self,
        applied: &[(usize, Vec<f64>)],
        told: &ChannelBaselines<'_>,
    ) -> Option<Vec<Option<Written>>> {
        let nearest = self.nearest(applied);
        let field = nearest.and_then(|k| self.solved.get(k)).map_or(self.pad.field, |solved| &solved.field);
        let (about, plate_mm) = (self.about(applied), self.pad.device.plate.radius_mm());
        let chain = about.chain(applied);
        let changed = changed(field, self.pad.flaws, plate_mm, &chain.mechanics.weights);
        Some(contacts(about, chain, changed, plate_mm, told))
    }

    fn elsewhere(
        &self,
        rows: &Observations,
        applied: &[(usize, Vec<f64>)],
    ) -> Option<(Linearised, Vec<CommonError>)> {
        let there = self.with(Atlas::in_order(&self.pad, self.without, self.all, rows, rows));
        Some((there.linearised(applied), there.common_errors(applied)))
    }
}

impl ModelOfRows for Atlas<'_> {
    fn at<'o>(&'o self, rows: &'o Observations) -> Box<dyn Model<Label> + 'o> {
        Box::new(self.with(Atlas::new(&self.pad, self.without, self.all, rows)))
    }

    fn at_measured<'o>(
        &'o self,
        all: &'o Observations,
        rows: &'o Observations,
    ) -> Box<dyn Model<Label> + 'o> {
        Box::new(Atlas::new(&self.pad, self.without, all, rows))
    }
}

fn coordinates(applied: &[(usize, Vec<f64>)], hypothesis: usize) -> Option<&Vec<f64>> {
    applied.iter().find(|(at, _)| *at == hypothesis).map(|(_, psi)| psi)
}

/// Coordinates less others; those of a cause that does not hold are zero.
fn difference(count: usize, from: Option<&Vec<f64>>, to: Option<&Vec<f64>>) -> Vec<f64> {
    let of = |psi: Option<&Vec<f64>>, k: usize| psi.and_then(|psi| psi.get(k)).copied().unwrap_or(0.0);
    (0..count).map(|k| of(from, k) - of(to, k)).collect()
}

/// How far a coordinate may go until the tangent is off by as much as it says. What a module lacks is no tangent.
fn reach(parameter: &Parameter, module_mm: f64) -> f64 {
    match parameter.coordinate {
        Coordinate::Logarithm => STIFFNESS_REACH,
        _ if parameter.name.ends_with("_mm") => module_mm,
        _ if parameter.name.ends_with("deg") => TURN_REACH_DEG,
        _ => f64::INFINITY,
    }
}
