//! The columns beside those of θ, contact by contact: θ, modes, what may always differ, changes, contrasts.

use std::sync::Arc;

use super::plays::{Changes, PlayEstimate, Plays};
use super::reference::ReferenceState;
use crate::calibration::data::contacts::{FieldAtPlace, Maps, Measured, response};
use crate::calibration::model::prior_deviations::ParameterKind;
use crate::calibration::model::{CERTAIN, ParameterLayout};
use crate::calibration::noise::normal_equations::NormalEquations;
use crate::calibration::problem::Problem;
use tactpad_core::pipeline::compensation::hysteresis::PLAYS;
use tactpad_core::quantity::CHANNELS;
use tactpad_numeric::linear::Reduced;

/// Steps to where contacts are by known parameters.
const RELOCATIONS: usize = 8;
/// Step of the central differences of a change's maps.
const STEP_MM: f64 = 0.5;
/// Prior standard deviation of a gain's difference between parts of one play, and of what a gain may be where only how long noise
/// lasts is asked: none is excluded.
const GAIN_DEVIATION: f64 = 0.3;
/// Each play is cut into so many parts, of which half are held against the other half in these ways.
const PARTS: usize = 4;
const CONTRASTS: [[f64; PARTS]; 3] = [[1.0, -1.0, 1.0, -1.0], [1.0, 1.0, -1.0, -1.0], [1.0, -1.0, -1.0, 1.0]];
/// Columns of a play's contrasts.
const CONTRAST_COLUMNS: usize = CONTRASTS.len() * CHANNELS;
/// Of a gain that all channels share presses tell nothing, so a contrast has one degree of freedom less than channels.
const CONTRAST_FREEDOM: usize = CHANNELS - 1;
/// Nuisance parameters: the blur, the shares of play operators and creep, zeros.
const NUISANCES: usize = 2 + PLAYS + CHANNELS;

/// The columns beside those of θ.
pub(super) struct Columns<'m> {
    reference: &'m ReferenceState<'m>,
    /// How many modes there are.
    modes: usize,
    maps: Changes<'m>,
    /// The changes that the later play is taken to have.
    changes: &'m [f64],
    /// How many maps there are.
    count: usize,
    /// The first row of the later play.
    later: usize,
    contacts: [usize; 2],
}

impl<'m> Columns<'m> {
    pub(super) fn of(
        problem: &Problem<'_>,
        reference: &'m ReferenceState<'m>,
        plays: &Plays<'_>,
        maps: Changes<'m>,
        changes: &'m [f64],
    ) -> Self {
        let later = plays.later;
        let earlier = problem.contacts.iter().filter(|(row, _)| *row < later).count();
        Self {
            reference,
            modes: reference.decoder.map_or(0, |decoder| decoder.field_error().modes().len()),
            maps,
            changes,
            count: maps([0.0; 2]).len(),
            later,
            contacts: [earlier, problem.contacts() - earlier],
        }
    }

    /// A change; none where nothing is said of it.
    fn change(&self, at: usize) -> f64 {
        self.changes.get(at).copied().unwrap_or_default()
    }

    /// The problem whose contacts are where the pad as it was says, with its changes, and whose load path is what it makes of them.
    pub(super) fn located<'f>(&self, mut problem: Problem<'f>) -> Problem<'f> {
        let ReferenceState { values, settings, estimates, .. } = self.reference;
        self.change_places(&mut problem);
        for _ in 0..RELOCATIONS {
            problem.follow_load_path(values, settings);
            problem.relocate(values, &estimates.noise_model);
            self.change_places(&mut problem);
        }
        problem
    }

    fn change_places(&self, problem: &mut Problem<'_>) {
        let Problem { prior, sensitivities, plate_mm, contacts, .. } = problem;
        for (_, contact) in contacts.iter_mut().filter(|(row, _)| *row >= self.later) {
            contact.place =
                Arc::new(FieldAtPlace::of(&prior.field, sensitivities, *plate_mm, contact.place_mm));
            self.change_place(contact);
        }
    }

    /// Adds the maps' changes to a later contact's field, and to its gradient by central differences.
    fn change_place(&self, contact: &mut Measured) {
        if (0..self.count).all(|at| self.change(CHANNELS + at) == 0.0) {
            return;
        }
        let [x_mm, y_mm] = contact.place_mm;
        let sum = |place_mm: [f64; 2]| {
            let mut sum: Maps = [[0.0; 3]; CHANNELS];
            for (at, map) in (self.maps)(place_mm).iter().enumerate() {
                let entries = sum.as_flattened_mut().iter_mut().zip(map.as_flattened());
                entries.for_each(|(sum, entry)| *sum += self.change(CHANNELS + at) * entry);
            }
            sum
        };
        let add = |to: &mut Maps, factor: f64, maps: &Maps| {
            let entries = to.as_flattened_mut().iter_mut().zip(maps.as_flattened());
            entries.for_each(|(to, entry)| *to += factor * entry);
        };
        let place = Arc::make_mut(&mut contact.place);
        add(&mut place.gains, 1.0, &sum([x_mm, y_mm]));
        for (axis, [dx_mm, dy_mm]) in [[STEP_MM, 0.0], [0.0, STEP_MM]].into_iter().enumerate() {
            let per_mm = 0.5 / STEP_MM;
            add(&mut place.gradient[axis], per_mm, &sum([x_mm + dx_mm, y_mm + dy_mm]));
            add(&mut place.gradient[axis], -per_mm, &sum([x_mm - dx_mm, y_mm - dy_mm]));
        }
    }

    fn nuisances_at(&self) -> usize {
        self.reference.values.len() + self.modes
    }

    fn changes_at(&self) -> usize {
        self.nuisances_at() + NUISANCES
    }

    fn contrasts_at(&self) -> usize {
        self.changes_at() + CHANNELS + self.count
    }

    /// How many plays there are.
    fn plays(&self) -> usize {
        self.contacts.iter().filter(|contacts| **contacts > 0).count()
    }

    fn size(&self) -> usize {
        self.contrasts_at() + self.plays() * CONTRAST_COLUMNS
    }

    /// The equations of the changes when all above them is free.
    pub(super) fn compared(&self, problem: &Problem<'_>) -> Option<PlayEstimate> {
        let equations = self.equations(problem, [0.0; 2])?;
        let reduced = equations.reduced(self.changes_at())?;
        let (mut changes, contrasts) = reduced.split(CHANNELS + self.count);
        // Of the whole changes c = c₀ + d with S d = s: S c = s + S c₀.
        for (score, row) in changes.score.iter_mut().zip(&changes.information) {
            *score += row.iter().enumerate().map(|(at, entry)| entry * self.change(at)).sum::<f64>();
        }
        Some(PlayEstimate { inflation: inflation(&contrasts)?, changes, contacts: self.contacts })
    }

    /// ln p(y), where gains may have changed and nothing else has: a change is no noise. But for a constant that all noise shares.
    pub(super) fn log_evidence(&self, problem: &Problem<'_>) -> Option<f64> {
        let likelihood =
            problem.log_likelihood(&self.reference.values, &self.reference.estimates.noise_model)?;
        let gained = self.equations(problem, [GAIN_DEVIATION.powi(-2), CERTAIN])?.log_evidence_gained()?;
        Some(likelihood + gained)
    }

    /// The equations about the pad as it was; `changes` are the precisions of a gain's change and of a map's.
    fn equations(&self, problem: &Problem<'_>, changes: [f64; 2]) -> Option<NormalEquations> {
        let mut precisions = self.reference.precisions.clone();
        precisions.resize(self.nuisances_at(), 1.0);
        precisions.extend(self.nuisance_precisions());
        precisions.extend([changes[0]; CHANNELS]);
        precisions.resize(self.contrasts_at(), changes[1]);
        precisions.resize(self.size(), GAIN_DEVIATION.powi(-2));
        // What is not in θ is zero there, and expected to be.
        let widened = |numbers: &[f64]| {
            let mut numbers = numbers.to_vec();
            numbers.resize(self.size(), 0.0);
            numbers
        };
        let ReferenceState { values, mean, estimates, .. } = self.reference;
        let prior = NormalEquations::of_prior(&precisions, &widened(mean), &widened(values));
        let widen = |at: usize, (row, contact): &(usize, Measured), rows: &mut [Vec<f64>]| {
            self.widen(at, *row, contact, rows);
        };
        problem.equations(prior, values, estimates, widen)
    }

    fn nuisance_precisions(&self) -> Vec<f64> {
        let zero_uv = self.reference.estimates.prior_deviations.of(ParameterKind::Zero);
        let deviations = ParameterLayout::differing_deviations().into_iter().chain([zero_uv; CHANNELS]);
        deviations.map(|deviation| deviation.powi(-2)).collect()
    }

    /// Adds the columns of contact `at` to the derivatives by θ.
    fn widen(&self, at: usize, row: usize, contact: &Measured, rows: &mut [Vec<f64>]) {
        let is_later = row >= self.later;
        let maps = if is_later { (self.maps)(contact.place_mm) } else { Vec::new() };
        let modes = self.reference.decoder.map(|it| it.modes_uv(contact.place_mm, &contact.force_n));
        let contrasts = self.contrasts(at, is_later);
        for (channel, row) in rows.iter_mut().enumerate() {
            let [(gain_at, _), _] = ParameterLayout::gain_terms(&self.reference.values, channel);
            // gₖ ∂f/∂gₖ: of a gain as a share of itself.
            let by_gain = self.reference.values[gain_at] * row[gain_at];
            let by_gains = self.by_gains(channel, row, by_gain);
            let nuisances = ParameterLayout::differing_at().map(|at| row[at]);
            // (M F)ₖ of each mode.
            row.extend(modes.iter().flatten().map(|uv| uv[channel]));
            row.resize(self.size(), 0.0);
            for (first, sign) in &contrasts {
                row[*first..].iter_mut().zip(by_gains).for_each(|(entry, slope)| *entry = sign * slope);
            }
            if !is_later {
                continue;
            }
            let first = self.nuisances_at();
            row[first..].iter_mut().zip(nuisances).for_each(|(entry, slope)| *entry = slope);
            row[first + nuisances.len() + channel] = 1.0;
            // Of readings from which the changes were taken.
            for (from, slope) in by_gains.into_iter().enumerate() {
                row[self.changes_at() + from] = slope / (1.0 + self.change(from));
            }
            // S gₖ Σₐ Fₐ Cₖₐ.
            let gain = ParameterLayout::gain(&self.reference.values, channel);
            let by_map = maps.iter().map(|map| gain * response(&map[channel], &contact.force_n));
            row[self.changes_at() + CHANNELS..]
                .iter_mut()
                .zip(by_map)
                .for_each(|(entry, slope)| *entry = slope);
        }
    }

    /// How a channel follows each channel's gain, as a share of itself: its own, and by crosstalk the others', Xₖₗ ∂f/∂Xₖₗ.
    fn by_gains(&self, channel: usize, row: &[f64], own: f64) -> [f64; CHANNELS] {
        std::array::from_fn(|from| {
            let at = ParameterLayout::crosstalk_at(channel, from);
            if from == channel { own } else { self.reference.values[at] * row[at] }
        })
    }

    /// The places of a contact's contrasts, and its signs there.
    fn contrasts(&self, at: usize, is_later: bool) -> Vec<(usize, f64)> {
        let [earlier, later] = self.contacts;
        let (play, within, count) =
            if is_later { (self.plays() - 1, at - earlier, later) } else { (0, at, earlier) };
        let part = PARTS * within / count.max(1);
        let first = |contrast: usize| self.contrasts_at() + (play * CONTRASTS.len() + contrast) * CHANNELS;
        CONTRASTS.iter().enumerate().map(|(contrast, signs)| (first(contrast), 0.5 * signs[part])).collect()
    }
}

/// The mean χ² of a contrast for each of its degrees of freedom; 1 at least.
fn inflation(contrasts: &Reduced) -> Option<f64> {
    let count = contrasts.score.len() / CHANNELS;
    let mut rest = contrasts.clone();
    let mut squares = 0.0;
    for _ in 0..count {
        let (contrast, others) = rest.split(CHANNELS);
        squares += contrast.square()?;
        rest = others;
    }
    Some((squares / (count * CONTRAST_FREEDOM) as f64).max(1.0))
}
