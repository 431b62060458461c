//! Whether a table can be of the pad: a look at its channels before anything is fitted to them.
//!
//! The readings yₖ of each channel are held against the strains xₖ that the device has under the written loads. A fit explains
//! everything as noise that it does not explain otherwise; this does not fit. It asks
//!
//! - whether the channels go with the strains at all: the mean correlation r̄ against its permutation distribution, in which any
//!   contact may have any reading. Its variance is Σₖₗ ρₖₗ(x) ρₖₗ(y)/(m² (n − 1)) for m channels and n contacts;
//! - which single fault shows: a channel that goes with no strain, its own or another's, where an ordinary one would; one that
//!   goes against its own; two of which each goes with the other's.
//!
//! Pads of one kind differ. So a channel is judged only where its strains are well above what the calibration's priors let it
//! differ by, and nothing smaller than that counts as unexplained. All levels are fixed: one table in a thousand of a sound
//! pad fails a question by chance.
//!
//! Source: R. A. Fisher, Metron 1 (1921) 3 (tanh⁻¹ r is normal with the variance 1/(n − 3)); P. I. Good, Permutation,
//! Parametric and Bootstrap Tests of Hypotheses (2005); M. S. Bartlett, J. R. Statist. Soc. Suppl. 9 (1947) 176.

pub(crate) mod moments;

use std::fmt;

use self::moments::Moments;
use crate::calibration::data::contacts::{FieldAtPlace, Maps, response};
use crate::calibration::data::plate::{PLACES, places};
use crate::calibration::model::physical::free;
use crate::calibration::model::prior_deviations::{GAIN_DEVIATION, ParameterKind, PriorDeviations};
use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::PadField;
use tactpad_core::quantity::{CHANNEL_NAMES, CHANNELS, Contact};
use tactpad_core::tables::measured::Row;
use tactpad_numeric::statistics::median;

/// Normal quantile of one in a thousand.
const QUANTILE: f64 = 3.09;
/// The same where nine channels are asked, in both directions: 0.001/18.
const QUANTILE_OF_CHANNELS: f64 = 3.87;
/// χ² of nine numbers that one case in a hundred exceeds.
const CHI_SQUARE_OF_STRAINS: f64 = 21.67;
/// No channel has a smaller gain: three standard deviations of the calibration's prior below 1.
const GAIN_MIN: f64 = 1.0 - 3.0 * GAIN_DEVIATION;
/// ln of the odds that must favour a swap: those of one in a thousand, times 36 pairs.
const LOG_ODDS_OF_A_SWAP: f64 = 10.49;
/// How many times its quantile an ordinary channel must come to before a silent one counts as silent, and an ordinary table
/// before one counts as chance: the power of the question.
const POWER: f64 = 2.0;
const POWER_OF_A_TABLE: f64 = 1.5;
/// How many times the variance by which pads differ a channel's strains must vary, if it is to be judged.
const LOADED: f64 = 4.0;

/// A fault of a single part, by which a table can be of a pad.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Fault {
    /// A channel goes with no contact.
    Silent(usize),
    /// A channel goes down where it should go up.
    Reversed(usize),
    /// Two channels stand in each other's place.
    Swapped(usize, usize),
}

/// Why a table is not of the pad.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum TableMismatch {
    /// The channels follow the contacts no better than chance would.
    Chance,
    /// No single fault explains it: these would have to come together.
    Faults(Vec<Fault>),
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Silent(channel) => {
                write!(f, "channel {} does not answer: it follows no contact", CHANNEL_NAMES[channel])
            }
            Self::Reversed(channel) => {
                write!(
                    f,
                    "channel {} has the reverse sign: it falls where it should rise",
                    CHANNEL_NAMES[channel]
                )
            }
            Self::Swapped(one, other) => {
                let [one, other] = [one, other].map(|channel| CHANNEL_NAMES[channel]);
                write!(
                    f,
                    "channels {one} and {other} are swapped: each follows the contacts as the other should"
                )
            }
        }
    }
}

impl fmt::Display for TableMismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Chance => f.write_str(
                "the channels follow the contacts no better than chance would; measure again, and see that each row has the \
                 channels of its own contact",
            ),
            Self::Faults(faults) => {
                let faults: Vec<String> = faults.iter().map(Fault::to_string).collect();
                write!(
                    f,
                    "no pad with one fault reads this: {}; mend the wiring or the columns and measure again, or name the \
                     pad with --device",
                    faults.join("; ")
                )
            }
        }
    }
}

impl std::error::Error for TableMismatch {}

/// Holds contacts against the device: `None` for a table without a fault that shows.
///
/// Few contacts, or contacts that hardly load a channel, tell nothing of it.
///
/// # Errors
/// No pad of this kind explains the channels, not even one with one fault.
pub fn screened(rows: &[Row], device: &Device, field: &PadField) -> Result<Option<Fault>, TableMismatch> {
    let screening = Screening::of(rows, device, field);
    match screening.faults()[..] {
        _ if screening.is_chance() => Err(TableMismatch::Chance),
        [] => Ok(None),
        [fault] => Ok(Some(fault)),
        ref faults => Err(TableMismatch::Faults(faults.to_vec())),
    }
}

/// A table's moments beside what pads differ by.
struct Screening {
    moments: Moments,
    /// Mean square by which the strains of two pads differ at these contacts, µV².
    differing_uv2: [f64; CHANNELS],
    /// Which strains each channel goes with: its own, unless channels are swapped.
    follows: [usize; CHANNELS],
    swaps: Vec<Fault>,
}

impl Screening {
    fn of(rows: &[Row], device: &Device, field: &PadField) -> Self {
        let (mut moments, mut squares_n2) = (Moments::default(), [0.0; 3]);
        let gain: [f64; CHANNELS] = std::array::from_fn(|k| device.modules[k / 3].gain[k % 3]);
        for row in rows {
            let (Some(uv), contact) = (row.uv, Contact::from(row.label)) else { continue };
            let force_n = [row.label.fx_n, row.label.fy_n, row.label.fz_n];
            let maps = field.signals.gains(contact.x_mm, contact.y_mm).value;
            moments.add(std::array::from_fn(|k| gain[k] * response(&maps[k], &force_n)), uv);
            squares_n2.iter_mut().zip(force_n).for_each(|(sum, n)| *sum += n * n);
        }
        let count = moments.count().max(1.0);
        let differing_uv2 =
            differing(device, field).map(|map| response(&map, &squares_n2.map(|n2| n2 / count)));
        let mut screening =
            Self { moments, differing_uv2, follows: std::array::from_fn(|k| k), swaps: Vec::new() };
        screening.find_swaps();
        screening
    }

    /// Whether the contacts load a channel enough to judge it.
    fn is_loaded(&self, strain: usize) -> bool {
        self.moments.strain_variance(strain) >= LOADED * self.differing_uv2[strain]
            && self.moments.strain_variance(strain) > 0.0
    }

    /// Share of a channel's variance that these strains leave unexplained; what pads differ by is not told apart from none.
    fn unexplained(&self, channel: usize, strain: usize) -> f64 {
        let least = self.differing_uv2[strain]
            / (self.moments.strain_variance(strain) + self.differing_uv2[strain]).max(f64::MIN_POSITIVE);
        (1.0 - self.moments.correlation(channel, strain).max(0.0).powi(2)).max(least)
    }

    /// Exchanges the pair of channels of the largest likelihood ratio, as long as that is large enough.
    fn find_swaps(&mut self) {
        for _ in 0..CHANNELS {
            let Some((log_odds, one, other)) = self.likeliest_swap() else { return };
            if log_odds <= LOG_ODDS_OF_A_SWAP {
                return;
            }
            self.follows.swap(one, other);
            self.swaps.push(Fault::Swapped(one, other));
        }
    }

    /// ½ n ln [(uₖₖ uₗₗ)/(uₖₗ uₗₖ)] of the likeliest pair: with normal residuals the likelihood goes with u^(−n/2).
    fn likeliest_swap(&self) -> Option<(f64, usize, usize)> {
        let pairs = (0..CHANNELS).flat_map(|one| (one + 1..CHANNELS).map(move |other| (one, other)));
        let is_told = |(one, other): &(usize, usize)| {
            self.is_loaded(self.follows[*one]) && self.is_loaded(self.follows[*other])
        };
        let odds = |(one, other): (usize, usize)| {
            let u = |channel: usize, as_of: usize| self.unexplained(channel, self.follows[as_of]).ln();
            let log_ratio = u(one, one) + u(other, other) - u(one, other) - u(other, one);
            (0.5 * self.moments.count() * log_ratio, one, other)
        };
        pairs.filter(is_told).map(odds).max_by(|left, right| left.0.total_cmp(&right.0))
    }

    /// Fisher's z of a correlation, in standard deviations; 0 for contacts too few to have any.
    fn z(&self, correlation: f64) -> f64 {
        correlation.clamp(-1.0 + 1e-12, 1.0 - 1e-12).atanh() * (self.moments.count() - 3.0).max(0.0).sqrt()
    }

    fn correlation(&self, channel: usize) -> f64 {
        self.moments.correlation(channel, self.follows[channel])
    }

    /// The faults that show, one for each pair or channel.
    fn faults(&self) -> Vec<Fault> {
        let noise_uv2 = median((0..CHANNELS).map(|k| self.residual_variance(k))).unwrap_or_default();
        let of_channel = |channel: usize| {
            let strain = self.follows[channel];
            if !self.is_loaded(strain) {
                return None;
            }
            if self.is_still(channel) {
                return Some(Fault::Silent(channel));
            }
            let z = self.z(self.correlation(channel));
            // What an ordinary channel comes to, with the noise that channels have in this table.
            let variance = self.moments.strain_variance(strain);
            let share = variance / (variance + noise_uv2.max(self.differing_uv2[strain]));
            let is_telling = self.z(share.sqrt()) >= POWER * QUANTILE_OF_CHANNELS;
            match () {
                () if z <= -QUANTILE_OF_CHANNELS => Some(Fault::Reversed(channel)),
                () if z < QUANTILE_OF_CHANNELS && is_telling && self.is_silent(channel) => {
                    Some(Fault::Silent(channel))
                }
                () => None,
            }
        };
        self.swaps.iter().copied().chain((0..CHANNELS).filter_map(of_channel)).collect()
    }

    /// Whether a channel moves so little that its gain is less than any: |g| is at most σ(y)/σ(x).
    fn is_still(&self, channel: usize) -> bool {
        let strain = self.follows[channel];
        self.moments.reading_variance(channel) < GAIN_MIN.powi(2) * self.moments.strain_variance(strain)
    }

    /// Whether a channel follows the contacts in no way, not even in that of another channel: a module that came loose reads
    /// otherwise, but it reads. By Bartlett's χ² = −(n − 1 − (9 + 2)/2) ln(1 − R²).
    fn is_silent(&self, channel: usize) -> bool {
        let unexplained = (1.0 - self.moments.explained(channel)).max(f64::MIN_POSITIVE);
        -(self.moments.count() - 6.5) * unexplained.ln() < CHI_SQUARE_OF_STRAINS
    }

    fn residual_variance(&self, channel: usize) -> f64 {
        self.moments.reading_variance(channel) * (1.0 - self.correlation(channel).powi(2))
    }

    /// Whether the channels follow the contacts no better than readings of other contacts would.
    fn is_chance(&self) -> bool {
        let loaded: Vec<usize> = (0..CHANNELS).filter(|k| self.is_loaded(self.follows[*k])).collect();
        let sum = |of: &dyn Fn(usize, usize) -> f64| -> f64 {
            loaded.iter().flat_map(|k| loaded.iter().map(move |l| (*k, *l))).map(|(k, l)| of(k, l)).sum()
        };
        let (moments, follows) = (&self.moments, &self.follows);
        let strains = |k: usize, l: usize| moments.correlation_of_strains(follows[k], follows[l]);
        let total: f64 = loaded.iter().map(|k| self.correlation(*k)).sum();
        let freedom = moments.count() - 1.0;
        // The permutation variances of the sum of correlations: of these readings, and of those that are the strains.
        let deviation =
            (sum(&|k, l| strains(k, l) * moments.correlation_of_readings(k, l)).max(0.0) / freedom).sqrt();
        let ordinary = (sum(&|k, l| strains(k, l).powi(2)) / freedom).sqrt();
        let is_telling = loaded.len() as f64 >= POWER_OF_A_TABLE * QUANTILE * ordinary;
        let is_still = loaded.iter().all(|k| self.is_still(*k));
        !loaded.is_empty()
            && freedom > 0.0
            && (is_still || (is_telling && total.abs() <= QUANTILE * deviation))
    }
}

/// Mean square over the plate by which the maps of two pads differ before gains, (µV/N)², by the calibration's priors: of
/// poses and stiffnesses of modules, and of crosstalk. A plate of another thickness, or glue of another modulus, changes all channels
/// much alike, which is told from no gain.
fn differing(device: &Device, field: &PadField) -> Maps {
    let (physical, sensitivities) = free(field, device, device);
    let of_modules =
        physical.into_iter().zip(sensitivities).filter(|(it, _)| it.parameter.module().is_some());
    let (physical, sensitivities): (Vec<_>, Vec<_>) = of_modules.unzip();
    let prior = PriorDeviations::first(true);
    let mut squares: Maps = [[0.0; 3]; CHANNELS];
    let mut count = 0.0;
    for place_mm in places(f64::from(field.signals.radius_mm()), PLACES) {
        count += 1.0;
        let place = FieldAtPlace::of(field, &sensitivities, device.plate.radius_mm(), place_mm);
        for (channel, squares) in squares.iter_mut().enumerate() {
            for (axis, square) in squares.iter_mut().enumerate() {
                let by_parameters = place
                    .sensitivities
                    .iter()
                    .zip(&physical)
                    .map(|(maps, it)| (prior.of(it.kind()) * it.unit() * maps[channel][axis]).powi(2));
                let by_crosstalk = place
                    .gains
                    .iter()
                    .map(|other| (prior.of(ParameterKind::Crosstalk) * other[axis]).powi(2))
                    .sum::<f64>();
                *square += by_parameters.sum::<f64>() + by_crosstalk;
            }
        }
    }
    squares.map(|map| map.map(|square| square / count))
}
