//! The search on a made-up sensor of any number of channels, whose maps are a few waves over the plate.

use super::*;
use crate::hypothesis::Hypothesis;
use crate::model::{CommonError, Linearised, Signature};
use crate::observations::Sample;
use tactpad_numeric::random::SplitMix64;
use tactpad_numeric::statistics::rms;

/// What may be wrong with the made-up sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Cause {
    Zero(usize),
    Gain(usize),
    /// All channels have one gain.
    Supply,
    /// All places are written wrong.
    Offset,
}

/// cos(a x + b y + c), summed over waves (a, b, c).
#[derive(Clone)]
struct Map(Vec<[f64; 3]>);

impl Map {
    /// With a mean square of about 1: a few waves of some 60 mm.
    fn smooth(random: &mut SplitMix64) -> Self {
        Self((0..8).map(|_| [0.1, 0.1, 3.0].map(|size| size * f64::from(random.uniform()))).collect())
    }

    fn at(&self, [x, y]: [f64; 2]) -> f64 {
        self.0.iter().map(|[a, b, c]| 0.5 * libm::cos(a * x + b * y + c)).sum()
    }
}

/// Channels that are linear in the load, by maps: yₖ = gₖ Σₐ Fₐ Gₖₐ(place + d) + zₖ.
struct Sensor {
    maps: Vec<[Map; 3]>,
    samples: Vec<Sample>,
    hypotheses: Vec<Hypothesis<Cause>>,
}

/// Five loads at each of 72 places.
fn contacts(random: &mut SplitMix64) -> Vec<Sample> {
    let mut sample = |at: usize| {
        let (angle, radius_mm) = (2.4 * (at % 72) as f64, 27.0 * ((at % 72) as f64 / 72.0).sqrt());
        let fz = 1.0 + 4.0 * f64::from(random.fraction());
        let [fx, fy] = [0; 2].map(|_| 0.4 * fz * f64::from(random.uniform()));
        let place_mm = [radius_mm * libm::cos(angle), radius_mm * libm::sin(angle)];
        Sample { place_mm, load: [fx, fy, fz], ..Sample::default() }
    };
    (0..360).map(&mut sample).collect()
}

impl Sensor {
    fn new(channels: usize, samples: Vec<Sample>) -> Self {
        let random = &mut SplitMix64::new(7);
        let hypothesis = |label: Cause| {
            let (parameters, zero_of) = match label {
                Cause::Zero(channel) => (vec![Parameter::additive("zero", [-1e3, 1e3], 0.1)], Some(channel)),
                Cause::Gain(_) | Cause::Supply => (vec![Parameter::factor("gain", [0.05, 20.0])], None),
                Cause::Offset => {
                    let mm = |name| Parameter::additive(name, [-5.0, 5.0], 0.01);
                    (vec![mm("x_mm"), mm("y_mm")], None)
                }
            };
            Hypothesis { label, parameters, signature_error: 0.0, prior_deviation: 0.0, zero_of }
        };
        let all = (0..channels).flat_map(|k| [Cause::Zero(k), Cause::Gain(k)]);
        let all = all.chain([Cause::Offset, Cause::Supply]);
        Self {
            maps: (0..channels).map(|_| [(); 3].map(|()| Map::smooth(random))).collect(),
            samples,
            hypotheses: all.map(hypothesis).collect(),
        }
    }

    /// Its readings where causes hold, with noise of 0.4 % and a smooth error of so much.
    fn measured(&self, applied: &[(usize, Vec<f64>)], smooth: f64, random: &mut SplitMix64) -> Observations {
        let sizes = self.sizes();
        let load_rms =
            rms(self.samples.iter().map(|it| libm::sqrt(it.load.iter().map(|n| n * n).sum::<f64>())));
        let mut readings = self.readings(applied);
        for (channel, size) in readings.iter_mut().zip(sizes) {
            let maps = [(); 3].map(|()| Map::smooth(random));
            for (value, sample) in channel.iter_mut().zip(&self.samples) {
                let error: f64 =
                    maps.iter().zip(sample.load).map(|(map, n)| map.at(sample.place_mm) * n / load_rms).sum();
                let noise = 0.004 * (size + value.abs()) * f64::from(random.normal());
                *value += noise + smooth * size * error;
            }
        }
        let (channels, rows) = (readings.len(), self.samples.len());
        Observations {
            channels: (0..channels).map(|channel| format!("s{channel}")).collect(),
            readings,
            is_told: vec![vec![true; rows]; channels],
            numbers: (0..rows).collect(),
            samples: self.samples.clone(),
        }
    }

    fn place_of(&self, cause: Cause) -> usize {
        self.hypotheses.iter().position(|it| it.label == cause).unwrap()
    }

    /// ∂readings/∂ψ by a central difference.
    fn signature(&self, applied: &[(usize, Vec<f64>)], at: usize, parameter: usize) -> Signature {
        let step = self.hypotheses[at].parameters[parameter].step;
        let moved = |by: f64| {
            let mut applied = applied.to_vec();
            let mut own = vec![0.0; self.hypotheses[at].parameters.len()];
            applied.iter().filter(|(held, _)| *held == at).for_each(|(_, psi)| own.clone_from(psi));
            applied.retain(|(held, _)| *held != at);
            own[parameter] += by;
            applied.push((at, own));
            self.readings(&applied)
        };
        let slope = |(above, below): (Vec<f64>, Vec<f64>)| -> Option<Vec<f64>> {
            let slopes: Vec<f64> = above.iter().zip(below).map(|(a, b)| (a - b) / (2.0 * step)).collect();
            slopes.iter().any(|slope| *slope != 0.0).then_some(slopes)
        };
        moved(step).into_iter().zip(moved(-step)).map(slope).collect()
    }
}

impl Model<Cause> for Sensor {
    fn hypotheses(&self) -> &[Hypothesis<Cause>] {
        &self.hypotheses
    }

    fn readings(&self, applied: &[(usize, Vec<f64>)]) -> Vec<Vec<f64>> {
        let (mut zeros, mut gains) = (vec![0.0; self.maps.len()], vec![1.0; self.maps.len()]);
        let mut offset_mm = [0.0; 2];
        for (at, psi) in applied {
            let Hypothesis { label, parameters, .. } = &self.hypotheses[*at];
            let values: Vec<f64> = parameters.iter().zip(psi).map(|(it, psi)| it.value(*psi)).collect();
            match label {
                Cause::Zero(channel) => zeros[*channel] += values[0],
                Cause::Gain(channel) => gains[*channel] *= values[0],
                Cause::Supply => gains.iter_mut().for_each(|gain| *gain *= values[0]),
                Cause::Offset => offset_mm = [values[0], values[1]],
            }
        }
        let reading = |channel: usize, sample: &Sample| {
            let place_mm = [0, 1].map(|axis| sample.place_mm[axis] + offset_mm[axis]);
            let strain: f64 =
                self.maps[channel].iter().zip(sample.load).map(|(map, n)| 100.0 * n * map.at(place_mm)).sum();
            gains[channel] * strain + zeros[channel]
        };
        let channel = |channel| self.samples.iter().map(|sample| reading(channel, sample)).collect();
        (0..self.maps.len()).map(channel).collect()
    }

    fn sizes(&self) -> Vec<f64> {
        self.readings(&[]).iter().map(|of| rms(of.iter().copied())).collect()
    }

    fn linearised(&self, applied: &[(usize, Vec<f64>)]) -> Linearised {
        let of = |at: usize| {
            (0..self.hypotheses[at].parameters.len()).map(|it| self.signature(applied, at, it)).collect()
        };
        Linearised {
            readings: self.readings(applied),
            loads: self.samples.iter().map(|sample| sample.load).collect(),
            doubts: vec![Vec::new(); self.maps.len()],
            signatures: (0..self.hypotheses.len()).map(of).collect(),
        }
    }

    fn common_errors(&self, _applied: &[(usize, Vec<f64>)]) -> Vec<CommonError> {
        Vec::new()
    }
}

/// Whether any cause is found.
fn is_alarm(search: &Search<'_, Cause>) -> bool {
    let fit = search.fitted(&Vec::new(), None).unwrap();
    let critical = search.critical(&fit).unwrap();
    search.next(&fit, critical, &[], &[]).unwrap().is_some()
}

#[test]
fn without_the_background_sound_sensors_raise_alarms() {
    for channels in [4, 12] {
        let mut alarms = [0; 2];
        for seed in 41..45 {
            let random = &mut SplitMix64::new(seed);
            let sensor = Sensor::new(channels, contacts(random));
            let measured = sensor.measured(&[], 0.02, random);
            let mut search = Search::new(&sensor, &measured, &measured);
            alarms[0] += usize::from(is_alarm(&search));
            search.smooth = Arc::new(Smooth::of(&measured, &measured).without());
            alarms[1] += usize::from(is_alarm(&search));
        }
        assert!(alarms[0] <= 1 && alarms[1] == 4, "{channels} channels: {alarms:?}");
    }
}

#[test]
fn a_step_that_leads_up_is_shortened() {
    let random = &mut SplitMix64::new(52);
    let mut sensor = Sensor::new(4, contacts(random));
    let supply = sensor.place_of(Cause::Supply);
    // From 1 the first step leads to exp 14, and each further one by 1 back.
    sensor.hypotheses[supply].parameters[0].range = [1e-9, 1e9];
    let wanted = libm::log(15.0);
    let measured = sensor.measured(&[(supply, vec![wanted])], 0.01, random);
    let search = Search::new(&sensor, &measured, &measured);
    let fit = search.nearly_fitted(&vec![(supply, vec![0.0])], None).unwrap();
    assert!((fit.applied[0].1[0] - wanted).abs() < 0.02, "{:?} is not {wanted}", fit.applied);
}

#[test]
fn causes_are_found_with_their_numbers_in_any_number_of_channels() {
    for channels in [4, 12] {
        let random = &mut SplitMix64::new(51);
        let sensor = Sensor::new(channels, contacts(random));
        let (gain, offset) = (sensor.place_of(Cause::Gain(channels - 2)), sensor.place_of(Cause::Offset));
        let zero = sensor.place_of(Cause::Zero(1));
        let applied = vec![(gain, vec![libm::log(1.12)]), (offset, vec![0.8, -0.5]), (zero, vec![40.0])];
        let measured = sensor.measured(&applied, 0.01, random);
        let search = Search::new(&sensor, &measured, &measured);
        let found = search.run(&Vec::new(), &[]).unwrap();
        let mut causes: Vec<usize> = found.fit.applied.iter().map(|(at, _)| *at).collect();
        causes.sort_unstable();
        assert_eq!(causes, [gain, offset], "{channels} channels");
        for at in 0..2 {
            let wanted = if found.fit.applied[at].0 == gain { vec![1.12] } else { vec![0.8, -0.5] };
            let (projected, score) = search.without(&found.fit, at).unwrap();
            assert_eq!(search.rivals(&found.fit, found.critical, at, &projected, &score), [0; 0]);
            assert!(search.holds_throughout(&found.fit, at).unwrap(), "{channels} channels");
            for (estimate, wanted) in search.estimates(&found, at, &[]).unwrap().iter().zip(wanted) {
                let [low, high] = estimate.interval95;
                // Half as far again: one interval in twenty misses.
                let off = (estimate.value - wanted).abs() / (0.5 * (high - low));
                assert!(off < 1.5, "{channels} channels: {estimate:?} is not {wanted}");
            }
        }
        let [off, variance] = search.least_zeros(&found).unwrap()[1];
        assert!((off - 40.0).abs() < 4.0 * variance.sqrt(), "{off} ± {}", variance.sqrt());
    }
}

/// What the search finds from nothing, and beside a gain of each channel; the rivals of the first of these.
pub(super) fn sparse_and_dense(gains: &[f64]) -> (Attribution, Attribution, bool, Vec<usize>) {
    let random = &mut SplitMix64::new(61);
    let sensor = Sensor::new(gains.len(), contacts(random));
    let random_effects: RandomEffects =
        vec![(0..gains.len()).map(|channel| sensor.place_of(Cause::Gain(channel))).collect()];
    let of = |log: &dyn Fn(usize) -> f64| -> Applied {
        random_effects[0].iter().enumerate().map(|(channel, at)| (*at, vec![log(channel)])).collect()
    };
    let measured = sensor.measured(&of(&|channel| libm::log(gains[channel])), 0.01, random);
    let search = Search::new(&sensor, &measured, &measured);
    let sparse = search.run(&Vec::new(), &[]).unwrap();
    let dense = search.run(&of(&|_| 0.0), &random_effects).unwrap();
    let [of_sparse, of_dense] = [&sparse, &dense].map(|it| search.criterion_of(it).unwrap());
    let (projected, score) = search.without(&dense.fit, 0).unwrap();
    let rivals = search.rivals(&dense.fit, dense.critical, 0, &projected, &score);
    assert!(rivals.contains(&sensor.place_of(Cause::Supply)), "the other gains make up for it");
    let rivals = search.rivals_of_random_effect(&dense, 0, &projected, &score).unwrap().0;
    let squares = search.squares(&dense).unwrap();
    let whole = search.removed(&dense.fit).unwrap();
    assert!((squares.iter().sum::<f64>() / whole - 1.0).abs() < 1e-9, "{squares:?} of {whole}");
    (sparse, dense, of_dense < of_sparse, rivals)
}

#[test]
fn gains_of_all_channels_are_found_as_such_and_a_supply_where_they_go_together() {
    let own = [1.13, 0.85, 0.94, 1.19, 0.82, 1.08, 0.9, 1.16];
    let (_, dense, is_dense, rivals) = sparse_and_dense(&own);
    assert!(is_dense && rivals.is_empty(), "{rivals:?}");
    for ((_, psi), gain) in dense.fit.applied.iter().zip(own) {
        assert!((psi[0] - libm::log(gain)).abs() < 0.02, "{psi:?} is not ln {gain}");
    }
    // A supply of 1.3 is likelier than eight like it.
    let (sparse, _, is_dense, rivals) = sparse_and_dense(&[1.3; 8]);
    assert!(!is_dense && sparse.fit.applied.len() == 1 && rivals.len() == 1, "{rivals:?}");
    // Beside gains of their own it is one reason that they may have in common.
    let (_, _, is_dense, rivals) = sparse_and_dense(&own.map(|gain| 1.3 * gain));
    assert!(is_dense && rivals.len() == 1, "{rivals:?}");
}

#[test]
fn a_cause_foretells_rows_that_were_left_out_and_what_one_place_alone_says_does_not() {
    let random = &mut SplitMix64::new(53);
    let sensor = Sensor::new(6, contacts(random));
    let gain = sensor.place_of(Cause::Gain(2));
    let gain_of = |measured: &Observations| {
        let search = Search::new(&sensor, measured, measured);
        let fit = search.fitted(&vec![(gain, vec![0.0])], None).unwrap();
        search.predictive_gains(&fit)[0]
    };
    let mut measured = sensor.measured(&[(gain, vec![libm::log(1.03)])], 0.01, random);
    assert!(gain_of(&measured) > 10.0, "{}", gain_of(&measured));
    // The five loads of one place, read so that they alone call for a gain.
    measured = sensor.measured(&[], 0.01, random);
    for row in (7..360).step_by(72) {
        measured.readings[2][row] *= 1.5;
    }
    assert!(gain_of(&measured) <= 0.0, "{}", gain_of(&measured));
}
