//! Ceiling of the explained residual by a flexible model: the most that any causes could.
//!
//! Such a model is a Gaussian-process regression of each channel's residual on all that was written: places and loads, and in
//! proportion time, temperature, the way by which a load came and how long it was held. It learns at the open rows and is judged at the
//! locked ones, in units of the noise: L₀ is what the model as it is leaves there, L₁ what it leaves with the findings, and L∞ the
//! least that the regression leaves, on top of either. The findings remove (L₀ − L₁)/(L₀ − L∞) of what can be removed.
//!
//! Source: M. C. Kennedy, A. O'Hagan, J. R. Statist. Soc. B 63 (2001) 425 (the discrepancy as a process).

use super::gain::Rows;
use tactpad_inference::noise::Noise;
use tactpad_inference::observations::{Observations, Sample};
use tactpad_inference::regression::{Group, Labels, Regression};
use tactpad_inference::search::Applied;

/// What can be removed is more than chance where it is so many standard errors.
const SURE: f64 = 2.0;

/// The part of what a flexible model could remove that these findings do; none where it could remove nothing.
pub(crate) fn ceiling_share(
    [open, locked]: [&Rows<'_>; 2],
    applied: &Applied,
    noise: &[Noise],
) -> Option<f64> {
    if locked.observations.rows() == 0 {
        return None;
    }
    let labels = [open, locked].map(|rows| labels(rows.observations));
    let left = |applied: &Applied| left([open, locked], &labels, applied, noise);
    let ([nominal, flexible], [extended, both]) = match applied.as_slice() {
        [] => {
            let nominal = left(applied)?;
            (nominal.clone(), nominal)
        }
        _ => {
            let (nominal, extended) = rayon::join(|| left(&Applied::new()), || left(applied));
            (nominal?, extended?)
        }
    };
    let sum = |squares: &[f64]| squares.iter().sum::<f64>();
    let least = if sum(&both) < sum(&flexible) { both } else { flexible };
    let least = if sum(&extended) < sum(&least) { extended.clone() } else { least };
    let removable: Vec<f64> = nominal.iter().zip(&least).map(|(nominal, least)| nominal - least).collect();
    let whole = sum(&removable);
    let middle = whole / removable.len() as f64;
    let scatter = removable.iter().map(|it| (it - middle).powi(2)).sum::<f64>().sqrt();
    (whole > SURE * scatter).then(|| ((sum(&nominal) - sum(&extended)) / whole).clamp(0.0, 1.0))
}

/// From this share on, causes leave nothing of which they may be a part.
const ALL: f64 = 0.95;

/// Whether these causes remove all that a flexible model could, by one half of the places against the other. The rows are those in
/// which the causes were found, so that no locked row has a part in it; the causes' few numbers hardly fit either half by chance.
pub(crate) fn is_all_removed(halves: [&Rows<'_>; 2], applied: &Applied, noise: &[Noise]) -> bool {
    ceiling_share(halves, applied, noise).is_some_and(|share| share >= ALL)
}

/// For each cluster of the locked rows, the squares that the model with these hypotheses leaves, and those that it leaves together
/// with the regression.
fn left(
    [open, locked]: [&Rows<'_>; 2],
    [learnt, judged]: &[Labels; 2],
    applied: &Applied,
    noise: &[Noise],
) -> Option<[Vec<f64>; 2]> {
    let zeros = open.zeros(applied);
    let [residuals, judged_residuals] = [open, locked].map(|rows| rows.beside(applied, &zeros));
    let readings = locked.model.readings(applied);
    let clusters = locked.observations.clusters();
    let mut squares = [(); 2].map(|()| vec![0.0; clusters.iter().max().map_or(0, |last| last + 1)]);
    let alive: Vec<usize> =
        (0..residuals.len()).filter(|channel| open.observations.is_alive(*channel)).collect();
    // What tells nothing is at its channel's zero, which the regression has anyway.
    let told = |channel: usize| -> Vec<f64> {
        residuals[channel].iter().map(|it| if it.is_nan() { 0.0 } else { *it }).collect()
    };
    let regression =
        Regression::of(learnt, &alive.iter().map(|channel| told(*channel)).collect::<Vec<_>>()).ok()?;
    let [at_open, at_locked] = [learnt, judged].map(|labels| regression.functions_at(labels));
    let follows = open.observations.follows();
    let in_series = locked.observations.in_series();
    for channel in alive {
        let is_told = &open.observations.is_told[channel];
        let fit = regression.fitted(&at_open, &told(channel), is_told, &follows).ok()?;
        for (row, residual) in judged_residuals[channel].iter().enumerate() {
            if residual.is_nan() {
                continue;
            }
            let variance = noise[channel].variance(readings[channel][row], in_series[row]);
            squares[0][clusters[row]] += residual.powi(2) / variance;
            squares[1][clusters[row]] += (residual - fit.value(&at_locked[row])).powi(2) / variance;
        }
    }
    Some(squares)
}

/// Labels of rows, as the regression takes them.
fn labels(observations: &Observations) -> Labels {
    let inputs = |sample: &Sample| [sample.place_mm.as_slice(), &sample.load].concat();
    let others = |sample: &Sample| {
        let hours = sample.t_s.unwrap_or_default() / 3600.0;
        let came_down = f64::from(u8::from(sample.is_unloading));
        vec![hours, sample.temp_c.unwrap_or_default(), came_down, sample.dwell_s.unwrap_or_default()]
    };
    Labels {
        groups: vec![
            Group { inputs: vec![0, 1], is_load: false },
            Group { inputs: vec![2, 3, 4], is_load: true },
        ],
        rows: observations.samples.iter().map(inputs).collect(),
        others: observations.samples.iter().map(others).collect(),
    }
}
