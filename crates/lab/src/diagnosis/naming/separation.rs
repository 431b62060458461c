//! Which further measurement tells confounded causes apart, and how often it must be made.
//!
//! The cause c is held to be there with its fitted numbers. What is left of it, beside what any rival d can say, grows with each
//! further measurement ξ:
//!
//! ```text
//! λ(n) = min over ψ_d, ν of |W (J_c ψ_c − J_d ψ_d − N ν)|² over the present rows and n times those of ξ
//! ```
//!
//! W whitens by the noise and by the background, which is one for both: it cancels where the same places are touched twice. ν are the
//! zeros, each measurement's own, the model's own errors and the other causes. The least n with λ(n) ≥ λ* is what it takes, λ* being what is
//! found in nine of ten at the family-wise level. The cheapest measurement in all is told.
//!
//! Source: A. C. Atkinson, V. V. Fedorov, Biometrika 62 (1975) 57 (T-optimality).

use std::cell::{OnceCell, RefCell};
use std::collections::BTreeMap;
use std::ops::Range;

use rayon::prelude::*;

use super::experiments::{Experiment, catalogue};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::label::Search;
use crate::diagnosis::report::{INSEPARABLE, times_text};
use crate::effect::Effect;
use tactpad_inference::covariance::equations::NormalEquations;
use tactpad_inference::covariance::system::ChannelSystem;
use tactpad_inference::covariance::whitening::Whitening;
use tactpad_inference::model::{CommonError, Linearised, Signature};
use tactpad_inference::observations::Sample;
use tactpad_inference::policy::POWER;
use tactpad_inference::search::Attribution;
use tactpad_numeric::chi_square;
use tactpad_numeric::dense::Matrix;

/// No measurement is asked for more often than this.
const REPEATS_MAX: usize = 30;
/// Ridge that makes columns unique that others reproduce, as a part of their information.
const RIDGE: f64 = 1e-9;
/// A column in the present rows and in further ones.
struct CausePair {
    present: Signature,
    further: Signature,
    precision: f64,
}

/// Present rows and those of an experiment.
struct JointRows<'s, 'm> {
    search: &'s Search<'m>,
    found: &'s Attribution,
    experiment: &'s Experiment,
    further: &'s Linearised,
    pairs: Vec<CausePair>,
}

/// A fitted cause and its rivals, in numbers of columns.
struct Discrimination {
    channels: Vec<ChannelEquations>,
    /// Of what was known of each column before.
    precisions: Vec<f64>,
    cause: Vec<usize>,
    /// The cause's fitted coordinates.
    psi: Vec<f64>,
    /// What is free beside each rival.
    held: Vec<usize>,
    rivals: Vec<Range<usize>>,
}

/// What a channel's present rows tell of the columns that it knows, and what those of one further measurement do: it adds up.
struct ChannelEquations {
    channel: usize,
    present: NormalEquations,
    further: NormalEquations,
}

/// The measurements that could be made, each with what the model says of it once that is asked for.
pub(crate) struct Separation<'s, 'm> {
    search: &'s Search<'m>,
    found: &'s Attribution,
    pub(super) experiments: Vec<Experiment>,
    elsewhere: Vec<OnceCell<Option<ExperimentModel>>>,
    /// What was computed of experiments, fitted causes and their rivals: findings and plan ask for the same.
    cache: RefCell<BTreeMap<RepeatsKey, Option<Repeats>>>,
}

/// An experiment, a fitted cause by its place, and its rivals.
type RepeatsKey = (usize, usize, Vec<usize>);

/// For each rival, how often an experiment must be made to tell a cause from it; none if it does not.
type Repeats = Vec<Option<usize>>;

/// The model at the rows of an experiment.
type ExperimentModel = (Linearised, Vec<CommonError>);

impl<'s, 'm> Separation<'s, 'm> {
    pub(crate) fn new(search: &'s Search<'m>, found: &'s Attribution) -> Self {
        let worth = |it: &Experiment| it.rows.rows() > 0 || it.by_hand.is_some();
        let experiments: Vec<Experiment> = catalogue(search.observations).into_iter().filter(worth).collect();
        let elsewhere = experiments.iter().map(|_| OnceCell::new()).collect();
        Self { search, found, experiments, elsewhere, cache: RefCell::default() }
    }

    /// The measurement that separates the fitted cause at this place from its rivals, as a sentence; else one for each rival. None where
    /// the model cannot say.
    pub(crate) fn told(&self, at: usize, rivals: &[(Effect, Target)]) -> Option<String> {
        let rivals = self.numbers(rivals);
        if rivals.is_empty() {
            return None;
        }
        if let Some(sentence) = self.cheapest(at, &rivals)? {
            return Some(sentence);
        }
        let mut sentences: Vec<String> = Vec::new();
        for rival in &rivals {
            let sentence = match self.cheapest(at, &[*rival])? {
                Some(sentence) if rivals.len() > 1 => sentence,
                _ => return Some(INSEPARABLE.to_owned()),
            };
            if !sentences.contains(&sentence) {
                sentences.push(sentence);
            }
        }
        Some(sentences.join("; and "))
    }

    /// The hypotheses of these labels.
    pub(super) fn numbers(&self, rivals: &[(Effect, Target)]) -> Vec<usize> {
        let hypotheses = self.search.model.hypotheses();
        (0..hypotheses.len()).filter(|number| rivals.contains(&hypotheses[*number].label)).collect()
    }

    /// How often an experiment must be made to tell the fitted cause at this place from each rival; none where the model cannot say.
    pub(super) fn repeats(&self, number: usize, at: usize, rivals: &[usize]) -> Option<Repeats> {
        let key = (number, at, rivals.to_vec());
        if let Some(cached) = self.cache.borrow().get(&key) {
            return cached.clone();
        }
        let found = self.both(number).and_then(|rows| rows.repeats(at, rivals));
        self.cache.borrow_mut().insert(key, found.clone());
        found
    }

    /// The cheapest measurement that separates it from all of these rivals, if one does. None where the model cannot say.
    fn cheapest(&self, at: usize, rivals: &[usize]) -> Option<Option<String>> {
        let mut best: Option<(f64, usize, &Experiment)> = None;
        for (number, experiment) in self.experiments.iter().enumerate() {
            if best.is_some_and(|(minutes, ..)| minutes <= experiment.minutes) {
                break;
            }
            let each: Option<Vec<usize>> = self.repeats(number, at, rivals)?.into_iter().collect();
            let Some(repeats) = each.and_then(|each| each.into_iter().max()) else { continue };
            let minutes = repeats as f64 * experiment.minutes;
            if best.is_none_or(|(least, ..)| minutes < least) {
                best = Some((minutes, repeats, experiment));
            }
        }
        Some(best.map(|(_, repeats, experiment)| sentence(repeats, experiment)))
    }

    /// With an experiment; none where the model cannot say.
    fn both(&self, number: usize) -> Option<JointRows<'_, 'm>> {
        let (experiment, applied) = (&self.experiments[number], &self.found.fit.applied);
        let model = self.search.model;
        let elsewhere = self.elsewhere[number].get_or_init(|| model.elsewhere(&experiment.rows, applied));
        Some(JointRows::of(self.search, self.found, (experiment, elsewhere.as_ref()?)))
    }
}

pub(super) fn sentence(repeats: usize, Experiment { what, why, .. }: &Experiment) -> String {
    format!("{what}, {}: {why}", times_text(repeats))
}

impl<'s, 'm> JointRows<'s, 'm> {
    fn of(
        search: &'s Search<'m>,
        found: &'s Attribution,
        (experiment, (further, errors)): (&'s Experiment, &'s ExperimentModel),
    ) -> Self {
        let channels = search.observations.channels.len();
        let rows = [search.observations.rows(), experiment.rows.rows()];
        // Each measurement has its own zeros.
        let zero = |channel: usize, rows: usize| -> Signature {
            (0..channels).map(|k| (k == channel).then(|| vec![1.0; rows])).collect()
        };
        let none = || -> Signature { vec![None; channels] };
        let mut pairs: Vec<CausePair> = (0..channels)
            .flat_map(|k| {
                let own = CausePair { present: zero(k, rows[0]), further: none(), precision: 0.0 };
                [own, CausePair { present: none(), further: zero(k, rows[1]), precision: 0.0 }]
            })
            .collect();
        pairs.extend(search.model.common_errors(&found.fit.applied).into_iter().zip(errors).map(
            |(present, further)| {
                let CommonError { deviation, signature } = present;
                let precision = 1.0 / (deviation * deviation);
                CausePair { present: signature, further: further.signature.clone(), precision }
            },
        ));
        Self { search, found, experiment, further, pairs }
    }

    /// A hypothesis' columns here and there.
    fn hypothesis(&self, number: usize) -> Vec<CausePair> {
        let Experiment { silent, by_hand, .. } = self.experiment;
        let (effect, _) = self.search.model.hypotheses()[number].label;
        let present = self.found.fit.linearised.signatures[number].clone();
        let mut further = self.further.signatures[number].clone();
        if *silent == Some(effect) {
            further.iter_mut().flatten().for_each(|channel| *channel = None);
        }
        let precision = by_hand.filter(|(of, _)| *of == effect).map_or(0.0, |(_, sd)| 1.0 / (sd * sd));
        let asked = self.search.model.hypotheses()[number].asked().len();
        let both = present.into_iter().zip(further).take(asked);
        both.map(|(present, further)| CausePair { present, further, precision }).collect()
    }

    /// How often it takes the experiment to tell the cause from each rival.
    fn repeats(&self, at: usize, rivals: &[usize]) -> Option<Repeats> {
        let most = if self.experiment.by_hand.is_some() { 1 } else { REPEATS_MAX };
        let discrimination = self.discrimination(at, rivals)?;
        let freedom = discrimination.cause.len();
        // Something significant is left of the cause in nine of ten such measurements.
        let threshold = chi_square::quantile(self.found.critical, freedom);
        let wanted = chi_square::noncentrality(threshold, freedom, POWER);
        let mut fishers: BTreeMap<usize, Option<Matrix>> = BTreeMap::new();
        let mut is_enough = |repeats: usize, rival: &Range<usize>| {
            let fisher = fishers.entry(repeats).or_insert_with(|| self.fisher(&discrimination, repeats));
            let left = fisher.as_ref().and_then(|it| discrimination.left(it, rival));
            left.is_some_and(|left| left >= wanted)
        };
        let of_rival = |rival: &Range<usize>| {
            if is_enough(1, rival) {
                return Some(1);
            }
            if most == 1 || !is_enough(most, rival) {
                return None;
            }
            let (mut low, mut high) = (1, most);
            while high - low > 1 {
                let middle = usize::midpoint(low, high);
                if is_enough(middle, rival) { high = middle } else { low = middle }
            }
            Some(high)
        };
        Some(discrimination.rivals.iter().map(of_rival).collect())
    }

    /// The columns of a fitted cause, of the others beside it and of its rivals, with what the rows tell of them.
    fn discrimination(&self, at: usize, rivals: &[usize]) -> Option<Discrimination> {
        let fit = &self.found.fit;
        let mut columns: Vec<CausePair> = Vec::new();
        let mut groups = Vec::new();
        let others = fit.applied.iter().enumerate().filter(|(k, _)| *k != at).map(|(_, (held, _))| *held);
        let (cause, psi) = &fit.applied[at];
        for number in others.chain([*cause]).chain(rivals.iter().copied()) {
            let own = self.hypothesis(number);
            groups.push(columns.len()..columns.len() + own.len());
            columns.extend(own);
        }
        let all: Vec<&CausePair> = self.pairs.iter().chain(&columns).collect();
        let shifted = |group: &Range<usize>| group.start + self.pairs.len()..group.end + self.pairs.len();
        let groups: Vec<Range<usize>> = groups.iter().map(shifted).collect();
        let (held, rest) = groups.split_at(groups.len() - rivals.len() - 1);
        let (cause, rivals) = (rest[0].clone(), rest[1..].to_vec());
        Some(Discrimination {
            channels: self.channels(&all)?,
            precisions: all.iter().map(|pair| pair.precision).collect(),
            psi: psi[..cause.len()].to_vec(),
            held: (0..self.pairs.len()).chain(held.iter().cloned().flatten()).collect(),
            cause: cause.collect(),
            rivals,
        })
    }

    /// What the present rows and so many measurements tell of the columns, and what was known of them before.
    fn fisher(&self, discrimination: &Discrimination, repeats: usize) -> Option<Matrix> {
        let background = &self.found.fit.background;
        let count = discrimination.precisions.len();
        let mut fisher = Matrix::zeros(count, count);
        let own = |ChannelEquations { channel, present, further }: &ChannelEquations| {
            let both = present.plus(repeats as f64, further);
            Some(both.reduced(&background.prior, &background.shares[*channel]).ok()?.fisher)
        };
        let channels: Option<Vec<Matrix>> = discrimination.channels.par_iter().map(own).collect();
        for (told, own) in discrimination.channels.iter().zip(channels?) {
            let numbers = &told.present.columns;
            for (row, number) in numbers.iter().enumerate() {
                for (column, other) in numbers.iter().enumerate() {
                    fisher.row_mut(*number)[*other] += own.at(row, column);
                }
            }
        }
        for (at, precision) in discrimination.precisions.iter().enumerate() {
            // Zeros of the channels that tell nothing are in no row.
            let least = if fisher.at(at, at) > 0.0 { RIDGE * fisher.at(at, at) } else { 1.0 };
            fisher.row_mut(at)[at] += precision + least;
        }
        Some(fisher)
    }

    /// What each channel that is alive tells of these columns.
    fn channels(&self, columns: &[&CausePair]) -> Option<Vec<ChannelEquations>> {
        let alive = (0..self.further.readings.len()).into_par_iter();
        let alive = alive.filter(|channel| self.search.observations.is_alive(*channel));
        alive.map(|channel| self.of_channel(channel, columns)).collect()
    }

    /// What the present rows of a channel tell of the columns that it knows, and what those of one measurement do.
    fn of_channel(&self, channel: usize, columns: &[&CausePair]) -> Option<ChannelEquations> {
        let (fit, rows) = (&self.found.fit, &self.experiment.rows);
        let (system, noise) = (&fit.systems.channels[channel], &fit.systems.noise[channel]);
        let weight = |(row, f): (usize, &f64)| {
            let in_series = rows.samples.get(row).is_some_and(Sample::is_in_series);
            1.0 / noise.variance(*f, in_series).sqrt()
        };
        let weights: Vec<f64> = self.further.readings[channel].iter().enumerate().map(weight).collect();
        // No values: nothing of the column is in these rows.
        let weighted = |values: Option<&Vec<f64>>| -> Vec<f64> {
            let none = || vec![0.0; weights.len()];
            values.map_or_else(none, |it| it.iter().zip(&weights).map(|(v, weight)| v * weight).collect())
        };
        let known = |(_, pair): &(usize, &&CausePair)| {
            pair.present[channel].is_some() || pair.further[channel].is_some()
        };
        let known: Vec<(usize, &&CausePair)> = columns.iter().enumerate().filter(known).collect();
        // What is measured by hand has no rows, and so no functions there.
        let functions = fit.systems.background_at(channel, self.search.model.sizes()[channel], rows);
        let functions: Vec<Vec<f64>> =
            (0..system.background.len()).map(|at| weighted(functions.get(at))).collect();
        let none = vec![0.0; system.residual.len()];
        let present = known.iter().map(|(number, pair)| (*number, pair.present[channel].as_ref()));
        let present: Vec<(usize, &[f64])> =
            present.map(|(number, values)| (number, values.unwrap_or(&none).as_slice())).collect();
        let further: Vec<(usize, Vec<f64>)> =
            known.iter().map(|(number, pair)| (*number, weighted(pair.further[channel].as_ref()))).collect();
        Some(ChannelEquations {
            channel,
            present: system.about(&present, &none),
            further: equations(&further, &functions)?,
        })
    }
}

/// The normal equations of whitened columns, with their numbers, and a whitened background.
fn equations(columns: &[(usize, Vec<f64>)], background: &[Vec<f64>]) -> Option<NormalEquations> {
    let count = background.first().map_or(0, Vec::len);
    let columns: Vec<(usize, &[f64])> = columns.iter().map(|(at, column)| (*at, column.as_slice())).collect();
    let white = Whitening::none(count);
    Some(ChannelSystem::of(&columns, background, &[], &vec![0.0; count], white).ok()?.equations)
}

impl Discrimination {
    /// ψᵀ (I_cc − I_cf I_ff⁻¹ I_fc) ψ: what is left of the cause when a rival and what is held are free.
    fn left(&self, fisher: &Matrix, rival: &Range<usize>) -> Option<f64> {
        let Self { cause, psi, held, .. } = self;
        let free: Vec<usize> = held.iter().copied().chain(rival.clone()).collect();
        let factor = fisher.picked(&free, &free).factorised()?;
        let across = fisher.picked(&free, cause).times(psi);
        let whole: f64 = fisher.picked(cause, cause).times(psi).iter().zip(psi).map(|(a, b)| a * b).sum();
        Some(whole - factor.solve_lower(&across).iter().map(|it| it * it).sum::<f64>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::label::Hypothesis;
    use crate::diagnosis::simulation::atlas::Atlas;
    use crate::tangent::SimulatedPad;
    use tactpad_core::pad::device::Device;
    use tactpad_core::pad::field::PadField;
    use tactpad_core::quantity::CHANNELS;
    use tactpad_inference::model::Model;
    use tactpad_inference::observations::{Observations, Sample};
    use tactpad_numeric::random::SplitMix64;

    /// 72 places, three loads each.
    fn contacts() -> Observations {
        let mut random = SplitMix64::new(21);
        let places: Vec<[f64; 2]> =
            (0..72).map(|_| [0; 2].map(|_| 19.0 * f64::from(random.uniform()))).collect();
        let mut samples = Vec::new();
        for (at, place_mm) in (0..3).flat_map(|_| &places).enumerate() {
            let fz = 1.0 + 4.0 * f64::from(random.fraction());
            let [fx, fy] = [0; 2].map(|_| 0.4 * fz * f64::from(random.uniform()));
            let t_s = Some(6.0 * at as f64);
            samples.push(Sample { place_mm: *place_mm, load: [fx, fy, fz], t_s, ..Sample::default() });
        }
        let rows = samples.len();
        Observations {
            channels: (0..CHANNELS).map(|channel| format!("s{channel}")).collect(),
            readings: vec![vec![0.0; rows]; CHANNELS],
            is_told: vec![vec![true; rows]; CHANNELS],
            numbers: (0..rows).collect(),
            samples,
        }
    }

    /// What is said where a cause holds and its rivals are these; and how often each experiment must be made, by its sentence.
    fn told(cause: (Effect, &[f64]), rivals: &[Effect]) -> (String, Vec<(String, Option<usize>)>) {
        let (device, field) = (Device::nominal(), PadField::nominal());
        let pad = SimulatedPad::known(&device, &field);
        let unread = contacts();
        let model = Atlas::new(&pad, &[], &unread, &unread);
        let at = model.hypotheses().iter().position(|it| it.label.0 == cause.0).unwrap();
        let numbers = model.hypotheses()[at].parameters.iter().zip(cause.1);
        let applied = vec![(at, numbers.map(|(it, value)| it.coordinate(*value)).collect())];
        let mut random = SplitMix64::new(22);
        let mut measured = unread.clone();
        for (to, from) in measured.readings.iter_mut().zip(model.readings(&applied)) {
            to.clone_from(&from);
            to.iter_mut().for_each(|uv| *uv += (5.0 + 0.005 * uv.abs()) * f64::from(random.normal()));
        }
        let model = Atlas::new(&pad, &[], &measured, &measured);
        let search = Search::new(&model, &measured, &measured);
        let found = Attribution {
            fit: search.fitted(&applied, None).unwrap(),
            critical: 1e-4,
            random_effects: Vec::new(),
            reproduced: Vec::new(),
        };
        let of = |it: &&Hypothesis| rivals.contains(&it.label.0);
        let rivals: Vec<(Effect, Target)> = model.hypotheses().iter().filter(of).map(|it| it.label).collect();
        let numbers: Vec<usize> =
            (0..model.hypotheses().len()).filter(|number| of(&&model.hypotheses()[*number])).collect();
        let separation = Separation::new(&search, &found);
        let each = separation.experiments.iter().enumerate().map(|(number, experiment)| {
            let each = separation.repeats(number, 0, &numbers).unwrap().into_iter();
            (
                experiment.what.clone(),
                each.collect::<Option<Vec<usize>>>().and_then(|it| it.into_iter().max()),
            )
        });
        (separation.told(0, &rivals).unwrap(), each.collect())
    }

    #[test]
    fn weights_tell_a_wrong_excitation_from_a_wrong_reference() {
        let (sentence, each) = told((Effect::ExcitationGain, &[1.05]), &[Effect::ReferenceGain]);
        assert!(
            sentence.starts_with(
                "place a known weight of 300 g at 12 of the places, and write so under weight_g, once"
            ),
            "{sentence}"
        );
        // Whatever has both in it tells nothing, however often it is made: weights and a shunt have one of them.
        let helps: Vec<&str> =
            each.iter().filter(|(_, repeats)| repeats.is_some()).map(|(what, _)| what.as_str()).collect();
        assert_eq!(helps.len(), 2, "{each:?}");
    }

    #[test]
    fn what_is_clamped_anew_turns_with_the_pad() {
        let (sentence, each) = told((Effect::StageOffset, &[0.15, 0.05]), &[Effect::ModuleDisplaced]);
        let turned = each.iter().find(|(what, _)| what.contains("120 degrees")).unwrap();
        assert!(turned.1.is_some_and(|repeats| repeats <= 3), "{each:?}");
        assert_ne!(sentence, INSEPARABLE);
        // A small cause takes more repeats than a large one.
        let repeats = |mm: f64| told((Effect::StageOffset, &[mm, 0.0]), &[Effect::ModuleDisplaced]).1;
        for ((what, small), (_, large)) in repeats(0.02).into_iter().zip(repeats(0.3)) {
            assert!(large.unwrap_or(usize::MAX) <= small.unwrap_or(usize::MAX), "{what}");
        }
    }
}
