//! The further measurements that together separate all causes that are open, as a plan.
//!
//! Each pair of a found cause and a rival takes an experiment so many repeats (`separation`). Of all experiments the one is taken, as often as
//! some pairs want, that separates most pairs for each minute that it adds; again, until none separates any more; then those go that the
//! others make superfluous. That is the greedy set cover: within 1 + ln n of the cheapest for n pairs, mostly the cheapest. What a plan's
//! rows cannot say, as what is measured by hand, is asked for only where they tell nothing.
//!
//! Source: V. Chvátal, Mathematics of Operations Research 4 (1979) 233.

use super::experiments::Experiment;
use super::separation::{Separation, sentence};
use crate::diagnosis::data::target::Target;
use crate::diagnosis::report::{Proposal, ProposedMeasurement};
use crate::effect::Effect;
use tactpad_core::quantity::WEIGHT_N_PER_G;
use tactpad_core::tables::measured::{Approach, Label, Row, Table};
use tactpad_inference::observations::Sample;

/// A measurement that takes longer than a working day is none, min.
const DAY_MIN: f64 = 480.0;

/// A found cause, by its place in the fit, and its rivals.
pub(crate) type OpenFinding = (usize, Vec<(Effect, Target)>);

/// A pair of causes: for each experiment, how often it must be made to separate them; none if it does not.
type Pair = Vec<Option<usize>>;

/// An experiment, by its number, and how often it is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Choice {
    experiment: usize,
    repeats: usize,
}

/// Proposes what to measure; nothing where the model cannot say.
pub(crate) fn proposal(separation: &Separation<'_, '_>, open: &[OpenFinding]) -> Proposal {
    let experiments = &separation.experiments;
    let Some(pairs) = pairs(separation, open) else { return Proposal::default() };
    let (planned, others): (Vec<usize>, Vec<usize>) =
        (0..experiments.len()).partition(|it| experiments[*it].is_in_a_plan());
    let minutes = |it: usize| experiments[it].minutes;
    let planned = cover(&pairs, &planned, minutes);
    let left = |choices: &[Choice], pairs: Vec<Pair>| -> Vec<Pair> {
        pairs.into_iter().filter(|pair| !is_separated(pair, choices)).collect()
    };
    let unplanned = left(&planned, pairs);
    let others = cover(&unplanned, &others, minutes);
    let mut plan = Table::default();
    let mut measurements = Vec::new();
    for Choice { experiment, repeats } in planned {
        let Experiment { what, why, minutes, rows, .. } = &experiments[experiment];
        plan.sessions.push(format!("further {}", plan.sessions.len() + 1));
        for _ in 0..repeats {
            plan.rows.extend(rows.samples.iter().map(|it| planned_row(it, plan.sessions.len() - 1)));
        }
        let minutes = minutes * repeats as f64;
        measurements.push(ProposedMeasurement { what: what.clone(), why, repeats, minutes });
    }
    Proposal {
        measurements,
        others: others.iter().map(|it| sentence(it.repeats, &experiments[it.experiment])).collect(),
        plan,
        inseparable: left(&others, unplanned).len(),
    }
}

/// Every pair of a found cause and a rival; none where the model cannot say.
fn pairs(separation: &Separation<'_, '_>, open: &[OpenFinding]) -> Option<Vec<Pair>> {
    let mut pairs = Vec::new();
    for (at, rivals) in open {
        let rivals = separation.numbers(rivals);
        let by_experiment: Option<Vec<Pair>> =
            (0..separation.experiments.len()).map(|it| separation.repeats(it, *at, &rivals)).collect();
        let by_experiment = by_experiment?;
        let within_a_day = |(experiment, needed): (&Experiment, Option<usize>)| {
            needed.filter(|repeats| *repeats as f64 * experiment.minutes <= DAY_MIN)
        };
        pairs.extend((0..rivals.len()).map(|rival| {
            let needed = by_experiment.iter().map(|it| it[rival]);
            separation.experiments.iter().zip(needed).map(within_a_day).collect::<Pair>()
        }));
    }
    Some(pairs)
}

/// The greedy cover of these pairs by the allowed experiments.
fn cover(pairs: &[Pair], allowed: &[usize], minutes: impl Fn(usize) -> f64) -> Vec<Choice> {
    let mut choices: Vec<Choice> = Vec::new();
    loop {
        let open: Vec<&Pair> = pairs.iter().filter(|pair| !is_separated(pair, &choices)).collect();
        let mut best: Option<(f64, Choice)> = None;
        for experiment in allowed.iter().copied() {
            let made = choices.iter().find(|it| it.experiment == experiment).map_or(0, |it| it.repeats);
            for repeats in open.iter().filter_map(|pair| pair[experiment]) {
                let separated = open.iter().filter(|pair| pair[experiment].is_some_and(|it| it <= repeats));
                let added_min = (repeats - made) as f64 * minutes(experiment);
                let worth = separated.count() as f64 / added_min;
                if best.is_none_or(|(most, _)| worth > most) {
                    best = Some((worth, Choice { experiment, repeats }));
                }
            }
        }
        let Some((_, best)) = best else { break };
        choices.retain(|it| it.experiment != best.experiment);
        choices.push(best);
    }
    // The dearest first.
    let cost_min = |it: &Choice| it.repeats as f64 * minutes(it.experiment);
    choices.sort_by(|one, other| cost_min(other).total_cmp(&cost_min(one)));
    let mut at = 0;
    while at < choices.len() {
        let others: Vec<Choice> =
            choices.iter().enumerate().filter(|(k, _)| *k != at).map(|(_, it)| *it).collect();
        let is_needed = pairs.iter().any(|pair| is_separated(pair, &choices) && !is_separated(pair, &others));
        if is_needed { at += 1 } else { choices = others }
    }
    choices.sort_by_key(|it| it.experiment);
    choices
}

fn is_separated(pair: &Pair, choices: &[Choice]) -> bool {
    choices.iter().any(|it| pair[it.experiment].is_some_and(|needed| needed <= it.repeats))
}

/// A row of a plan.
fn planned_row(sample: &Sample, session: usize) -> Row {
    let Sample { place_mm: [x_mm, y_mm], load: [fx_n, fy_n, fz_n], .. } = *sample;
    Row {
        session: Some(session),
        temp_c: sample.temp_c,
        dwell_s: sample.dwell_s,
        approach: sample.is_unloading.then_some(Approach::Unloading),
        turned_deg: Some(sample.turned_deg).filter(|deg| *deg != 0.0),
        weight_g: sample.is_weight.then(|| (fz_n / WEIGHT_N_PER_G).round()),
        ..Row::of(Label { x_mm, y_mm, fx_n, fy_n, fz_n })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chosen(pairs: &[Pair], minutes: &[f64]) -> Vec<(usize, usize)> {
        let allowed: Vec<usize> = (0..minutes.len()).collect();
        let choices = cover(pairs, &allowed, |it| minutes[it]);
        assert!(
            pairs.iter().filter(|it| it.iter().any(Option::is_some)).all(|pair| is_separated(pair, &choices))
        );
        choices.into_iter().map(|it| (it.experiment, it.repeats)).collect()
    }

    #[test]
    fn one_measurement_for_all_is_taken_where_it_is_cheaper_than_one_for_each() {
        let pairs = [vec![Some(1), None, Some(1)], vec![None, Some(1), Some(1)], vec![None, None, Some(2)]];
        assert_eq!(chosen(&pairs, &[10.0, 10.0, 8.0]), [(2, 2)]);
        assert_eq!(chosen(&pairs[..2], &[10.0, 10.0, 30.0]), [(0, 1), (1, 1)]);
    }

    #[test]
    fn what_nothing_separates_asks_for_nothing() {
        assert_eq!(chosen(&[vec![None, None]], &[1.0, 1.0]), []);
        assert_eq!(chosen(&[vec![None, None], vec![Some(3), None]], &[1.0, 1.0]), [(0, 3)]);
        assert_eq!(chosen(&[], &[1.0]), []);
    }
}
