//! The simulated pad as it would read contacts that nobody wrote, in the circumstances of rows that somebody did.

use rayon::prelude::*;

use super::row::response;
use super::simulated::Simulated;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::inverse::{Forward, Inverse, UNKNOWNS, Weighted};
use crate::diagnosis::model::mechanics::Maps;
use crate::rig::errors::RigErrors;
use tactpad_core::pad::influence::InfluenceField;
use tactpad_core::quantity::CHANNELS;
use tactpad_inference::model::{ChannelBaselines, Written};

/// A pad under a chain.
struct Bench<'s> {
    simulated: &'s Simulated,
    chain: Chain,
    /// What the weights of the chain change in the field, by written places; none where they change nothing.
    changed: Option<InfluenceField>,
}

/// The contacts that make the pad read what was read, row by row; none for a row that tells less than a contact's numbers.
pub(crate) fn contacts(
    simulated: &Simulated,
    chain: Chain,
    changed: Option<InfluenceField>,
    radius_mm: f64,
    told: &ChannelBaselines<'_>,
) -> Vec<Option<Written>> {
    let of_order = simulated.of_order(&chain);
    let observations = &simulated.sequence;
    let mut rigs: Vec<RigErrors> = Vec::new();
    let mut rig_of = |row: &usize| {
        let rig = chain.rig_at(&observations.samples[*row]);
        rigs.iter().position(|it| *it == rig).unwrap_or_else(|| {
            rigs.push(rig);
            rigs.len() - 1
        })
    };
    let rig_of_row: Vec<usize> = simulated.picked.iter().map(&mut rig_of).collect();
    // What is written stands for another contact where the pad is turned on the stage, or a known weight lies on it.
    let under = |rig: RigErrors| {
        let chain = Chain { rig, ..chain.clone() };
        Inverse::new(Bench { simulated, chain, changed: changed.clone() }, radius_mm)
    };
    let inverses: Vec<Inverse<Bench<'_>>> = rigs.into_iter().map(under).collect();
    let contact = |(at, row): (usize, &usize)| {
        let row = *row;
        let sample = &observations.samples[row];
        let channels = observations.readings.iter().zip(&of_order).enumerate();
        let reading = |(k, (channel, of_order)): (usize, (&Vec<f64>, &Vec<f64>))| {
            channel[row] - of_order[at] - told.zeros.at(k, sample)
        };
        let readings: Vec<f64> = channels.map(reading).collect();
        let in_series = sample.is_in_series();
        let channels = readings.iter().zip(told.noise).zip(&observations.is_told);
        let weights: Vec<f64> = channels
            .map(
                |((reading, noise), is_told)| {
                    if is_told[row] { 1.0 / noise.variance(*reading, in_series) } else { 0.0 }
                },
            )
            .collect();
        let tells = weights.iter().filter(|weight| **weight > 0.0).count() >= UNKNOWNS;
        inverses[rig_of_row[at]].contact(row, &Weighted { readings, weights }).filter(|_| tells)
    };
    simulated.picked.par_iter().enumerate().map(contact).collect()
}

impl Forward for Bench<'_> {
    /// Strains by a unit of true force along each axis.
    type Site = Maps;

    fn site(&self, place_mm: [f64; 2]) -> Maps {
        let mut maps = self.simulated.maps(place_mm, &self.chain);
        if let Some(changed) = &self.changed {
            let changes = changed.gains(place_mm[0] as f32, place_mm[1] as f32).value;
            for axis in 0..3 {
                let mut strain = changes.map(|map| map[axis]);
                self.chain.channels.couple(&mut strain);
                maps.iter_mut().zip(strain).for_each(|(map, change)| map[axis] += change);
            }
        }
        maps
    }

    fn reading(&self, row: usize, site: &Maps, load: [f64; 3]) -> Vec<f64> {
        let force_n = self.chain.rig.force_n(load);
        let strain: [f64; CHANNELS] = std::array::from_fn(|channel| response(&site[channel], &force_n));
        self.simulated.reading(row, &strain, &self.chain).to_vec()
    }
}

#[cfg(test)]
mod tests {
    use crate::diagnosis::Applied;
    use crate::diagnosis::simulation::atlas::Atlas;
    use crate::effect::Effect;
    use crate::tangent::SimulatedPad;
    use tactpad_core::pad::changes::FieldChanges;
    use tactpad_core::pad::device::Device;
    use tactpad_core::pad::field::PadField;
    use tactpad_core::quantity::CHANNELS;
    use tactpad_inference::model::{ChannelBaselines, Model};
    use tactpad_inference::noise::Noise;
    use tactpad_inference::observations::{Observations, Sample, Zeros};
    use tactpad_numeric::random::SplitMix64;
    use tactpad_numeric::statistics::mean;

    /// Contacts all over the plate.
    fn contacts(count: usize) -> Observations {
        let mut random = SplitMix64::new(11);
        let mut sample = |row: usize| {
            let [x, y] = [0; 2].map(|_| 19.0 * f64::from(random.uniform()));
            let fz = 1.0 + 4.0 * f64::from(random.fraction());
            let shear = [0; 2].map(|_| 0.4 * fz * f64::from(random.uniform()));
            let (t_s, temp_c) = (Some(4.0 * row as f64), Some(20.0 + 8.0 * f64::from(random.fraction())));
            Sample { place_mm: [x, y], load: [shear[0], shear[1], fz], t_s, temp_c, ..Sample::default() }
        };
        Observations {
            channels: vec![String::new(); CHANNELS],
            readings: vec![vec![0.0; count]; CHANNELS],
            is_told: vec![vec![true; count]; CHANNELS],
            samples: (0..count).map(&mut sample).collect(),
            numbers: (0..count).collect(),
        }
    }

    /// Mean magnitudes of the errors of places and loads, as contacts are decoded where the first causes hold and the others are
    /// known; noise is so many parts of what the decoder believes.
    fn errors(holds: &[(Effect, &[f64])], known: &[(Effect, &[f64])], noise: f64) -> [f64; 2] {
        let (device, field, flaws) = (Device::nominal(), PadField::nominal(), FieldChanges::nominal());
        let pad = SimulatedPad { flaws: &flaws.0, ..SimulatedPad::known(&device, &field) };
        let written = contacts(60);
        let applied = |model: &Atlas<'_>, causes: &[(Effect, &[f64])]| -> Applied {
            let of = |(effect, values): &(Effect, &[f64])| {
                let at = model.hypotheses().iter().position(|it| it.label.0 == *effect).unwrap();
                let parameters = &model.hypotheses()[at].parameters;
                (at, parameters.iter().zip(*values).map(|(it, value)| it.coordinate(*value)).collect())
            };
            causes.iter().map(of).collect()
        };
        let model = Atlas::new(&pad, &[], &written, &written);
        let read = model.readings(&applied(&model, holds));
        let levels: Vec<Noise> = read.iter().map(|channel| Noise::first(channel)).collect();
        let mut random = SplitMix64::new(12);
        let mut measured = written.clone();
        for ((to, from), level) in measured.readings.iter_mut().zip(&read).zip(&levels) {
            to.clone_from(from);
            let mut off = |uv: f64| noise * level.variance(uv, false).sqrt() * f64::from(random.normal());
            to.iter_mut().for_each(|uv| *uv += off(*uv));
        }
        // One reading is no reading, and another row tells too little.
        measured.readings[2][7] = 1e9;
        measured.is_told[2][7] = false;
        (0..5).for_each(|channel| measured.is_told[channel][8] = false);
        let model = Atlas::new(&pad, &[], &measured, &measured);
        let zeros = Zeros::of(&vec![vec![0.0]; CHANNELS], &measured.samples[..1]);
        let told = ChannelBaselines { zeros: &zeros, noise: &levels };
        let found = model.contacts(&applied(&model, known), &told).unwrap();
        assert!(found[8].is_none());
        let off = |axes: std::ops::Range<usize>| {
            let rows =
                found.iter().zip(&written.samples).filter_map(|(it, sample)| Some((it.as_ref()?, sample)));
            mean(rows.flat_map(|(it, sample)| {
                let [fx, fy, fz] = sample.load;
                let wanted = [sample.place_mm[0], sample.place_mm[1], fx, fy, fz];
                axes.clone().map(move |k| (it[k] - wanted[k]).abs())
            }))
        };
        [off(0..2), off(2..5)]
    }

    #[test]
    fn what_the_model_reads_is_decoded_again() {
        let [place_mm, force_n] = errors(&[], &[], 0.0);
        assert!(place_mm < 2e-3 && force_n < 1e-4, "{place_mm} {force_n}");
        // A hundredth of each reading and of its channel: so far off as the noise makes it.
        let [place_mm, force_n] = errors(&[], &[], 1.0);
        assert!((0.1..0.4).contains(&place_mm) && (0.005..0.05).contains(&force_n), "{place_mm} {force_n}");
    }

    #[test]
    fn causes_of_every_kind_are_taken_back() {
        let all: [(Effect, &[f64]); 8] = [
            (Effect::ModuleDisplaced, &[0.8, -0.5]),
            (Effect::ModuleFrameOpen, &[0.01]),
            (Effect::StageRotation, &[1.5]),
            (Effect::ReferenceTilt, &[1.0, -1.0]),
            (Effect::ChannelCrosstalk, &[0.06]),
            (Effect::GaugeNonlinearity, &[3.0]),
            (Effect::ThermalGain, &[-0.003]),
            (Effect::ContactHeight, &[0.5]),
        ];
        let known = errors(&all, &all, 0.0);
        let unknown = errors(&all, &[], 0.0);
        assert!(known[0] < 0.01 && known[1] < 1e-3, "{known:?}");
        assert!(unknown[0] > 0.2 && unknown[1] > 0.02, "{unknown:?}");
        for cause in all {
            let (known, unknown) = (errors(&[cause], &[cause], 0.0), errors(&[cause], &[], 0.0));
            assert!(known[0] < 0.01 && known[1] < 1e-3, "{cause:?} {known:?}");
            assert!(
                unknown[0] > 3.0 * known[0] || unknown[1] > 3.0 * known[1],
                "{cause:?} {known:?} {unknown:?}"
            );
        }
    }
}
