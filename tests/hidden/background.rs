//! What every real simulator leaves over: a smooth field of its own in each channel, and per force axis.

use std::f64::consts::TAU;

use crate::plan::{Contact, Row};
use crate::random::Random;

const WAVES: usize = 300;

/// A Gaussian random field over the plate with covariance exp(-d²/2l²), as a sum of plane waves.
#[derive(Debug)]
pub(crate) struct Smooth(Vec<[f64; 4]>);

impl Smooth {
    pub(crate) fn new(length_mm: f64, random: &mut Random) -> Self {
        let wave = |_| {
            let [across, along] = [random.normal(), random.normal()].map(|wave| wave / length_mm);
            [across, along, TAU * random.unit(), random.normal() * (2.0 / WAVES as f64).sqrt()]
        };
        Self((0..WAVES).map(wave).collect())
    }

    /// Deviation 1, in the mean over all fields.
    pub(crate) fn at(&self, place: [f64; 2]) -> f64 {
        let wave = |[x, y, phase, height]: &[f64; 4]| height * (x * place[0] + y * place[1] + phase).cos();
        self.0.iter().map(wave).sum()
    }
}

/// The background of all rows: for each channel three smooth fields, times the force's components, of exactly `share` of
/// the channel's rms over the loaded rows.
pub(crate) fn background(
    rows: &[Row],
    contacts: &[Contact],
    rms: &[f64; 9],
    [share, length_mm]: [f64; 2],
    random: &mut Random,
) -> Vec<[f64; 9]> {
    let mut whole = vec![[0.0; 9]; contacts.len()];
    for channel in 0..9 {
        let fields = [0, 1, 2].map(|_| Smooth::new(length_mm, random));
        for (contact, row) in contacts.iter().zip(&mut whole) {
            let axis = |axis: usize| fields[axis].at(contact.place) * contact.force[axis];
            row[channel] = (0..3).map(axis).sum();
        }
        let seen = rms_of(rows, &whole, channel).max(f64::MIN_POSITIVE);
        whole.iter_mut().for_each(|row| row[channel] *= share * rms[channel] / seen);
    }
    whole
}

/// The rms of a channel over the loaded rows.
pub(crate) fn rms_of(rows: &[Row], values: &[[f64; 9]], channel: usize) -> f64 {
    let loaded = rows.iter().zip(values).filter(|(row, _)| row.loaded());
    let squares: Vec<f64> = loaded.map(|(_, values)| values[channel] * values[channel]).collect();
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}
