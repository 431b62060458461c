//! What changed in a pad between two recordings without labels, beside all that they share.
//!
//! The parameters θ of the fit hold in both. In the later one each channel reads beyond f(θ) also B c + N n, with the columns B
//! of possible changes (a channel's gain, a change of the field's maps) and N of what may always differ (the finger's blur, the
//! shares of hysteresis and creep, what is left of the zeros). About the maximum of the earlier recording's fit the equations of all together are
//!
//! ```text
//! | H  Gᵀ | |δ|   |h|        S = K − G H⁻¹ Gᵀ
//! | G  K  | |c| = |k|        s = k − G H⁻¹ h
//! ```
//!
//! where θ and n, with their priors, stand above and the changes below. S is the information about the changes that is left when
//! everything above is free, s what they are pulled by: a set of changes C has the estimate (CᵀSC)⁻¹ Cᵀs and explains
//! χ² = sᵀC (CᵀSC)⁻¹ Cᵀs.
//!
//! The same is asked of the recordings themselves: gains that differ between the parts of one play. What these contrasts explain
//! beyond chance is what the model lacks.
//!
//! Source: C. R. Rao, Proc. Camb. Phil. Soc. 44 (1948) 50 (score tests beside free parameters).

use std::sync::Arc;

use super::contacts::{Fitted, Maps, Measured, Place, response};
use super::fit::{FitError, Report, settled_reported};
use super::model::Layout;
use super::normal_equations::NormalEquations;
use super::prepared::Prepared;
use super::prior::Prior;
use super::prior_deviations::Kind;
use super::problem::{Effort, Fit, Problem};
use crate::numeric::linear::Reduced;
use crate::pad::device::Device;
use crate::pad::field::PadField;
use crate::pipeline::compensation::hysteresis::PLAYS;
use crate::quantity::CHANNELS;
use crate::tables::recording::Recording;

/// Steps to where contacts are by known parameters.
const RELOCATIONS: usize = 8;
/// Step of the central differences of a change's maps.
const STEP_MM: f64 = 0.5;
/// Every so many contacts settle the settings of the fit, which is tried for many of them.
const SETTLING_STRIDE: usize = 2;
/// Prior standard deviation of a gain's difference between parts of one play: none is excluded.
const CONTRAST_DEVIATION: f64 = 0.3;
/// Each play is cut into so many parts, of which half are held against the other half in these ways.
const PARTS: usize = 4;
const CONTRASTS: [[f64; PARTS]; 3] = [[1.0, -1.0, 1.0, -1.0], [1.0, 1.0, -1.0, -1.0], [1.0, -1.0, -1.0, 1.0]];
const PLAYS_COMPARED: usize = 2;
const CONTRAST_COLUMNS: usize = PLAYS_COMPARED * CONTRASTS.len() * CHANNELS;
/// Of a gain that all channels share presses tell nothing, so a contrast has one degree of freedom less than channels.
const CONTRAST_FREEDOM: usize = CHANNELS - 1;
/// What may always differ: the blur, the shares of play operators and creep, zeros.
const NUISANCES: usize = 2 + PLAYS + CHANNELS;

/// What two recordings say of the changes between them.
#[derive(Clone, Debug)]
pub struct Compared {
    /// S and s of the changes: the nine channels' gains, as shares of themselves, and then the maps.
    pub changes: Reduced,
    /// By how much the contrasts within the plays exceed chance: mean χ² for each degree of freedom, 1 at least.
    pub inflation: f64,
    /// Contacts of either play.
    pub contacts: [usize; 2],
}

/// Two recordings, one after the other.
#[derive(Clone, Copy, Debug)]
pub struct Plays<'p> {
    /// Both.
    pub recording: &'p Recording,
    /// Their contacts.
    pub fitted: &'p [Fitted],
    /// The later one's first row.
    pub later: usize,
}

/// Maps at a place in mm: µV/N per unit of each change.
pub type Changes<'m> = &'m (dyn Fn([f64; 2]) -> Vec<Maps> + Sync);

/// Two plays that are held against each other.
pub struct Comparison<'p> {
    plays: Plays<'p>,
    device: &'p Device,
    maps: Changes<'p>,
    prepared: Prepared,
    prior: Prior,
    /// Of the earlier play: the pad as it was.
    fit: Fit,
}

impl<'p> Comparison<'p> {
    /// Finds the pad as it was: what changed must not count as noise, nor be half of it. `field` is that of `device`, the nominal
    /// pad.
    ///
    /// # Errors
    /// No contact, or readings beyond anything that a pad can read.
    pub fn of(
        plays: Plays<'p>,
        (device, field): (&'p Device, &PadField),
        maps: Changes<'p>,
        report: Report<'_>,
    ) -> Result<Self, FitError> {
        let Plays { recording, fitted, later } = plays;
        let earlier: Vec<Fitted> = fitted.iter().filter(|it| it.row < later).copied().collect();
        if earlier.is_empty() {
            return Err(FitError::TooFew { contacts: 0, least: 1 });
        }
        let prepared = Prepared::of(recording, fitted, device, field).ok_or(FitError::Senseless)?;
        let prior = Prior::simulated(field);
        // Thresholds and times are asked of some contacts, and all other numbers then of all.
        let some: Vec<Fitted> = earlier.iter().step_by(SETTLING_STRIDE).copied().collect();
        let settled = settled_reported(&prepared.problem(&some, device, &prior), &prior, report);
        let fit = settled.and_then(|it| {
            prepared.problem(&earlier, device, &prior).fitted(it.settings, None, Effort::FULL)
        });
        let fit = fit.ok_or(FitError::Senseless)?;
        Ok(Self { plays, device, maps, prepared, prior, fit })
    }

    /// The equations of the changes about these, in their order: those of the whole changes, not of what is beyond these.
    ///
    /// # Errors
    /// Readings beyond anything that a pad can read.
    pub fn about(&self, changes: &[f64]) -> Result<Compared, FitError> {
        let problem = self.prepared.problem(self.plays.fitted, self.device, &self.prior);
        let columns = Columns::of(&problem, &self.fit, &self.plays, (self.maps, changes));
        let problem = columns.located(columns.changed(problem), &self.fit);
        columns.compared(&problem, &self.fit).ok_or(FitError::Senseless)
    }
}

/// The columns beside those of θ, contact by contact.
struct Columns<'m> {
    /// Place of the first one.
    first: usize,
    maps: Changes<'m>,
    /// The changes that the later play is taken to have.
    changes: &'m [f64],
    /// How many maps there are.
    count: usize,
    /// The first row of the later play.
    later: usize,
    contacts: [usize; PLAYS_COMPARED],
    /// The parameters at the maximum.
    values: &'m [f64],
}

impl<'m> Columns<'m> {
    fn of(
        problem: &Problem<'_>,
        fit: &'m Fit,
        plays: &Plays<'_>,
        (maps, changes): (Changes<'m>, &'m [f64]),
    ) -> Self {
        let later = plays.later;
        let earlier = problem.contacts.iter().filter(|(row, _)| *row < later).count();
        Self {
            first: fit.values.len(),
            maps,
            changes,
            count: maps([0.0; 2]).len(),
            later,
            contacts: [earlier, problem.contacts() - earlier],
            values: &fit.values,
        }
    }

    /// A change; none where nothing is said of it.
    fn change(&self, at: usize) -> f64 {
        self.changes.get(at).copied().unwrap_or_default()
    }

    /// The problem whose later readings have lost their changes of gain: y/(1 + cₖ).
    fn changed<'f>(&self, mut problem: Problem<'f>) -> Problem<'f> {
        for (_, contact) in problem.contacts.iter_mut().filter(|(row, _)| *row >= self.later) {
            contact.uv.iter_mut().enumerate().for_each(|(channel, uv)| *uv /= 1.0 + self.change(channel));
        }
        problem
    }

    /// The problem whose contacts are where the fit's pad says, with its changes, and whose load path is what it makes of them.
    fn located<'f>(&self, mut problem: Problem<'f>, fit: &Fit) -> Problem<'f> {
        let Fit { values, settings, estimates, .. } = fit;
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
            contact.place = Arc::new(Place::of(&prior.field, sensitivities, *plate_mm, contact.place_mm));
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

    const fn changes_at(&self) -> usize {
        self.first + NUISANCES
    }

    const fn contrasts_at(&self) -> usize {
        self.changes_at() + CHANNELS + self.count
    }

    const fn size(&self) -> usize {
        self.contrasts_at() + CONTRAST_COLUMNS
    }

    fn compared(&self, problem: &Problem<'_>, fit: &Fit) -> Option<Compared> {
        let (mean, mut precisions) = problem.prior_of(fit);
        precisions.extend(Self::nuisance_precisions(fit));
        precisions.resize(self.contrasts_at(), 0.0);
        precisions.resize(self.size(), CONTRAST_DEVIATION.powi(-2));
        // What is not in θ is zero at the maximum, and expected to be.
        let widened = |numbers: &[f64]| {
            let mut numbers = numbers.to_vec();
            numbers.resize(self.size(), 0.0);
            numbers
        };
        let prior = NormalEquations::of_prior(&precisions, &widened(&mean), &widened(&fit.values));
        let widen = |at: usize, (row, contact): &(usize, Measured), rows: &mut [Vec<f64>]| {
            self.widen(at, (*row, contact), rows);
        };
        let equations = problem.equations(prior, &fit.values, &fit.estimates, widen)?;
        let reduced = equations.reduced(self.changes_at())?;
        let (mut changes, contrasts) = reduced.split(CHANNELS + self.count);
        // Of the whole changes c = c₀ + d with S d = s: S c = s + S c₀.
        for (score, row) in changes.score.iter_mut().zip(&changes.information) {
            *score += row.iter().enumerate().map(|(at, entry)| entry * self.change(at)).sum::<f64>();
        }
        Some(Compared { inflation: inflation(&contrasts)?, changes, contacts: self.contacts })
    }

    fn nuisance_precisions(fit: &Fit) -> Vec<f64> {
        let zero_uv = fit.estimates.prior_deviations.of(Kind::Zero);
        let deviations = Layout::differing_deviations().into_iter().chain([zero_uv; CHANNELS]);
        deviations.map(|deviation| deviation.powi(-2)).collect()
    }

    /// Adds the columns of contact `at` to the derivatives by θ.
    fn widen(&self, at: usize, (row, contact): (usize, &Measured), rows: &mut [Vec<f64>]) {
        let is_later = row >= self.later;
        let maps = if is_later { (self.maps)(contact.place_mm) } else { Vec::new() };
        let contrasts = self.contrasts(at, is_later);
        for (channel, row) in rows.iter_mut().enumerate() {
            let [(gain_at, _), _] = Layout::gain_terms(self.values, channel);
            // gₖ ∂f/∂gₖ: of a gain as a share of itself.
            let by_gain = self.values[gain_at] * row[gain_at];
            let nuisances = Layout::differing_at().map(|at| row[at]);
            row.resize(self.size(), 0.0);
            for (first, sign) in &contrasts {
                row[first + channel] = sign * by_gain;
            }
            if !is_later {
                continue;
            }
            row[self.first..].iter_mut().zip(nuisances).for_each(|(entry, slope)| *entry = slope);
            row[self.first + nuisances.len() + channel] = 1.0;
            // Of the readings that are divided by 1 + cₖ.
            row[self.changes_at() + channel] = by_gain / (1.0 + self.change(channel));
            // S gₖ Σₐ Fₐ Cₖₐ.
            let gain = Layout::gain(self.values, channel);
            let by_map = maps.iter().map(|map| gain * response(&map[channel], &contact.force_n));
            row[self.changes_at() + CHANNELS..]
                .iter_mut()
                .zip(by_map)
                .for_each(|(entry, slope)| *entry = slope);
        }
    }

    /// The places of a contact's contrasts, and its signs there.
    fn contrasts(&self, at: usize, is_later: bool) -> Vec<(usize, f64)> {
        let [earlier, later] = self.contacts;
        let (play, within, count) = if is_later { (1, at - earlier, later) } else { (0, at, earlier) };
        let part = PARTS * within / count.max(1);
        let first = |contrast: usize| self.contrasts_at() + (play * CONTRASTS.len() + contrast) * CHANNELS;
        CONTRASTS.iter().enumerate().map(|(contrast, signs)| (first(contrast), 0.5 * signs[part])).collect()
    }
}

/// The mean χ² of a contrast for each of its degrees of freedom; 1 at least.
fn inflation(contrasts: &Reduced) -> Option<f64> {
    let mut rest = contrasts.clone();
    let mut squares = 0.0;
    for _ in 0..CONTRAST_COLUMNS / CHANNELS {
        let (contrast, others) = rest.split(CHANNELS);
        squares += contrast.square()?;
        rest = others;
    }
    let freedom = (CONTRAST_COLUMNS / CHANNELS * CONTRAST_FREEDOM) as f64;
    Some((squares / freedom).max(1.0))
}
