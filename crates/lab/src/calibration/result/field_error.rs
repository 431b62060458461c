//! Posterior uncertainty of the field, as modes over the plate: the principal directions of the posterior, seen through the
//! decoder.
//!
//! With the curvature H = L Lᵀ a channel under a load, aₖ = ∂sₖ/∂θ, has the posterior covariance aₖᵀH⁻¹aₗ = (L⁻¹aₖ)ᵀ(L⁻¹aₗ). Unit
//! vectors v of this space are independent: θ + L⁻ᵀ(a₁v₁ + a₂v₂ + …) with aᵣ ∼ N(0, 1) are draws from the posterior. The modes are
//! the changes of the maps along those v that move decoded contacts most, and then along those that make channels contradict each
//! other most.

use crate::calibration::data::contacts::{BACKGROUND_DEGREE, FieldAtPlace, Measured};
use crate::calibration::data::plate::{loads, places};
use crate::calibration::model::ParameterLayout;
use crate::calibration::noise::{self, FieldCovariance};
use crate::calibration::problem::{PosteriorFit, Problem};
use tactpad_core::pad::influence::{InfluenceField, MAPS};
use tactpad_core::pipeline::contact::field_error::{DEGREE, ErrorMode, FieldError, MODES_MAX, TERMS};
use tactpad_core::pipeline::contact::inverse::Inverse;
use tactpad_core::pipeline::contact::uncertainty::{Noise, UNKNOWNS};
use tactpad_core::quantity::CHANNELS;
use tactpad_numeric::dense::{Matrix, gram};
use tactpad_numeric::linear::{Factor, LargeFactor};
use tactpad_numeric::principal::{Principal, beside, principal_directions};
use tactpad_numeric::products::dot;
use tactpad_numeric::zernike;

/// So much of a decoded contact's variance may be left out of the modes: it is then counted alike all over the plate.
const LEFT_SHARE: f64 = 0.01;
/// Places by which a mode's maps are found: ten for each polynomial.
const FITTED_PLACES: u32 = 10 * TERMS as u32;
/// What keeps the mixture of a mode from taking up what the polynomials hold as well, as a share of the mean square of what they do
/// not hold of the field.
const RIDGE: f64 = 1e-6;
// The background has to be in the modes as it is.
const _: () = assert!(DEGREE >= BACKGROUND_DEGREE, "a mode's polynomials hold the background");

/// A contact, and how its channels follow the parameters.
struct Load {
    place_mm: [f64; 2],
    force_n: [f64; 3],
    /// L⁻¹aₖ of each channel.
    halves: Vec<Vec<f64>>,
}

/// A mode before it is rounded.
struct UnroundedMode {
    /// v, a unit vector.
    direction: Vec<f64>,
    /// Q, line by line.
    mixture: [[f64; CHANNELS]; CHANNELS],
    /// Coefficients of P, map by map.
    maps: Vec<Vec<f64>>,
}

/// The field and the polynomials at places all over the plate.
struct Basis {
    places_mm: Vec<[f64; 2]>,
    polynomials: Matrix,
    /// Of the polynomials' products.
    normal: LargeFactor,
    /// G, map by map.
    field: Vec<Vec<f64>>,
    /// The same without what polynomials hold.
    rough: Vec<Vec<f64>>,
    /// Of the products of the channels' rough parts.
    mixed: Factor<CHANNELS>,
}

/// A decoder with the pad's own field, that field's errors and their part of the noise; `noise` is of the channels alone.
pub(crate) fn decoder(problem: &Problem<'_>, fit: &PosteriorFit, noise: Noise) -> Inverse {
    let field = problem.corrected(&fit.values);
    let loads: Vec<Load> =
        loads(problem.reach_mm).map(|(place_mm, force_n)| problem.load(fit, place_mm, force_n)).collect();
    let covariances: Vec<FieldCovariance> = loads.iter().map(Load::covariance).collect();
    let noise = noise::with_field_deviations(&field, noise, &covariances);
    let certain = Inverse::new(field, noise);
    let loads = problem.without_zeros(fit, loads);
    let modes = problem.modes(fit, &principal(&certain, &loads), certain.field()).unwrap_or_default();
    let left = |load: &Load| load.left_by(&modes, certain.field(), problem.reach_mm);
    let rest: Vec<FieldCovariance> = loads.iter().map(left).collect();
    let noise = Noise { by_field: noise::mean_by_field(&certain, &rest), ..noise };
    let rounded = modes.iter().map(UnroundedMode::rounded).collect();
    let crosstalk = ParameterLayout::crosstalk(&fit.values).map(|line| line.map(|share| share as f32));
    Inverse::new(certain.field().clone(), noise)
        .with_field_error(FieldError::of(rounded).unwrap_or_default())
        .with_crosstalk(crosstalk)
}

impl Problem<'_> {
    fn load(&self, fit: &PosteriorFit, place_mm: [f64; 2], force_n: [f64; 3]) -> Load {
        let place = FieldAtPlace::level(&self.prior.field, &self.sensitivities, self.plate_mm, place_mm);
        let contact = Measured::unmeasured(place_mm, place, force_n);
        let rows = self.layout.slopes(&fit.values, &self.scale, &contact).whole();
        let halves = rows.iter().map(|row| fit.factor.solve_lower(row)).collect();
        Load { place_mm, force_n, halves }
    }

    /// The loads as a pad reads them whose zeros are taken anew: those of a recording that has its own are no errors of the field.
    /// Where it has none the decoder keeps the zeros of the fit, and their errors.
    fn without_zeros(&self, fit: &PosteriorFit, mut loads: Vec<Load>) -> Vec<Load> {
        if self.recording.is_tared() {
            let zeros = (0..CHANNELS).map(|channel| fit.halved(&[(ParameterLayout::zero_at(channel), 1.0)]));
            let zeros: Vec<Vec<f64>> = zeros.collect();
            for (half, zero) in loads.iter_mut().flat_map(|load| load.halves.iter_mut().zip(&zeros)) {
                half.iter_mut().zip(zero).for_each(|(entry, zero)| *entry -= zero);
            }
        }
        loads
    }

    /// The modes of these directions.
    fn modes(
        &self,
        fit: &PosteriorFit,
        principal: &[Principal],
        field: &InfluenceField,
    ) -> Option<Vec<UnroundedMode>> {
        let changes: Vec<Vec<f64>> =
            principal.iter().map(|it| fit.factor.solve_upper(&it.direction)).collect();
        let basis = Basis::of(field, self.reach_mm)?;
        let sampled: Vec<Vec<[f64; MAPS]>> =
            basis.places_mm.iter().map(|place_mm| self.changed_maps(fit, &changes, *place_mm)).collect();
        let found = |(at, it): (usize, &Principal)| {
            let maps: Vec<Vec<f64>> =
                (0..MAPS).map(|map| sampled.iter().map(|modes| modes[at][map]).collect()).collect();
            basis.found(it.direction.clone(), &maps)
        };
        Some(principal.iter().enumerate().map(found).collect())
    }

    /// How the maps at a place change with each of these changes of the parameters, µV/N.
    fn changed_maps(&self, fit: &PosteriorFit, changes: &[Vec<f64>], place_mm: [f64; 2]) -> Vec<[f64; MAPS]> {
        let place = FieldAtPlace::level(&self.prior.field, &self.sensitivities, self.plate_mm, place_mm);
        let mut contact = Measured::unmeasured(place_mm, place, [0.0; 3]);
        let mut maps = vec![[0.0; MAPS]; changes.len()];
        for axis in 0..3 {
            contact.force_n = std::array::from_fn(|k| f64::from(u8::from(k == axis)));
            let rows = self.layout.slopes(&fit.values, &self.scale, &contact).whole();
            for (channel, derivatives) in rows.iter().enumerate() {
                for (maps, change) in maps.iter_mut().zip(changes) {
                    // ∂sₖ/∂θ δθ; a zero is no part of a map.
                    let zero_uv = change[ParameterLayout::zero_at(channel)];
                    maps[3 * channel + axis] = dot(derivatives, change) - zero_uv;
                }
            }
        }
        maps
    }
}

impl Basis {
    /// `None` for a field that reads nothing anywhere.
    fn of(field: &InfluenceField, reach_mm: f64) -> Option<Self> {
        let places_mm: Vec<[f64; 2]> = places(reach_mm, FITTED_PLACES).collect();
        let values = |place_mm: &[f64; 2]| polynomials(place_mm, reach_mm).to_vec();
        let polynomials = Matrix::from_rows(&places_mm.iter().map(values).collect::<Vec<_>>());
        let columns: Vec<Vec<f64>> = (0..TERMS).map(|term| polynomials.column(term)).collect();
        let normal = gram(&columns.iter().map(Vec::as_slice).collect::<Vec<_>>()).factorised()?;
        let gains: Vec<_> =
            places_mm.iter().map(|[x_mm, y_mm]| field.gains(*x_mm as f32, *y_mm as f32).value).collect();
        let map = |map: usize| gains.iter().map(|maps| maps[map / 3][map % 3]).collect();
        let field: Vec<Vec<f64>> = (0..MAPS).map(map).collect();
        let rough = |map: &Vec<f64>| {
            let smooth = polynomials.times(&closest(&normal, &polynomials, map));
            map.iter().zip(smooth).map(|(map, smooth)| map - smooth).collect()
        };
        let rough: Vec<Vec<f64>> = field.iter().map(rough).collect();
        let mut products: [[f64; CHANNELS]; CHANNELS] =
            std::array::from_fn(|one| products(&rough[3 * one..], &rough));
        let trace: f64 = (0..CHANNELS).map(|k| products[k][k]).sum();
        (0..CHANNELS).for_each(|k| products[k][k] += RIDGE * trace);
        let mixed = Factor::of(&products)?;
        Some(Self { places_mm, polynomials, normal, field, rough, mixed })
    }

    /// The mode whose maps have these values at the places.
    fn found(&self, direction: Vec<f64>, maps: &[Vec<f64>]) -> UnroundedMode {
        // M = Q G + P by least squares. What polynomials do not hold of G tells Q, as it is orthogonal to them: Q R Rᵀ = M Rᵀ; then P
        // is what comes closest to M − Q G.
        let mixture: [[f64; CHANNELS]; CHANNELS] =
            std::array::from_fn(|channel| self.mixed.solve(&products(&maps[3 * channel..], &self.rough)));
        let smooth = |(at, map): (usize, &Vec<f64>)| {
            let mut rest = map.clone();
            for (share, field) in mixture[at / 3].iter().zip(self.field.iter().skip(at % 3).step_by(3)) {
                rest.iter_mut().zip(field).for_each(|(rest, field)| *rest -= share * field);
            }
            closest(&self.normal, &self.polynomials, &rest)
        };
        UnroundedMode { direction, mixture, maps: maps.iter().enumerate().map(smooth).collect() }
    }
}

/// Sums of products of a channel's three maps, the first of `maps`, with those of each channel.
fn products(maps: &[Vec<f64>], all: &[Vec<f64>]) -> [f64; CHANNELS] {
    let product = |other: usize| maps.iter().zip(&all[3 * other..][..3]).map(|(one, it)| dot(one, it)).sum();
    std::array::from_fn(product)
}

/// The coefficients that come closest to these samples: (PᵀP) c = Pᵀ m.
fn closest(normal: &LargeFactor, polynomials: &Matrix, samples: &[f64]) -> Vec<f64> {
    normal.solve(&polynomials.transposed_times(samples))
}

/// Values of the polynomials at a place.
fn polynomials(place_mm: &[f64; 2], reach_mm: f64) -> [f64; TERMS] {
    zernike::values(place_mm.map(|mm| mm / reach_mm))
}

/// The directions that do what the field's errors do to decoded contacts, each counted in that contact's own deviations, but for a
/// small share of the contacts' whole variance; and then, beside these, those that do what no contact explains, counted in the
/// channels' deviations: by that presses without labels show what changed.
fn principal(certain: &Inverse, loads: &[Load]) -> Vec<Principal> {
    let moved = loads.iter().filter_map(|load| load.moved(certain)).flatten().collect();
    let mut found = enough(moved, MODES_MAX);
    let left = loads.iter().filter_map(|load| load.unexplained(certain)).flatten();
    let left: Vec<Vec<f64>> = left.map(|row| beside(row, &found)).collect();
    found.extend(enough(left, MODES_MAX - found.len()));
    found
}

/// The principal directions of rows that count in deviations, but for a small share of their variance.
fn enough(rows: Vec<Vec<f64>>, most: usize) -> Vec<Principal> {
    let mut left: f64 = rows.iter().map(|row| dot(row, row)).sum();
    let mut found = principal_directions(&Matrix::from_rows(&rows), most);
    let enough = found.iter().position(|it| {
        let is_enough = left <= LEFT_SHARE * rows.len() as f64;
        left -= it.square;
        is_enough
    });
    found.truncate(enough.unwrap_or(found.len()));
    found
}

impl Load {
    /// Posterior covariance of the channels, Σₖₗ = aₖᵀ H⁻¹ aₗ.
    fn covariance(&self) -> FieldCovariance {
        self.of_channels(|one, other| dot(&self.halves[one], &self.halves[other]))
    }

    fn of_channels(&self, uv2: impl Fn(usize, usize) -> f64) -> FieldCovariance {
        let uv2 = std::array::from_fn(|one| std::array::from_fn(|other| uv2(one, other)));
        FieldCovariance { place_mm: self.place_mm, force_n: self.force_n, uv2 }
    }

    /// How the decoded contact follows the channels, in its own standard deviations; `None` where the field does not tell a
    /// contact.
    fn weights(&self, certain: &Inverse) -> Option<[[f64; CHANNELS]; UNKNOWNS]> {
        let expected = certain.expected(&noise::contact(&self.place_mm, &self.force_n))?;
        // D = C + K Σ Kᵀ = M Mᵀ, and M⁻¹ K.
        let uv2 = self.covariance().uv2;
        let mut whole = expected.covariance;
        for (line, left) in whole.iter_mut().zip(&expected.response) {
            for (entry, right) in line.iter_mut().zip(&expected.response) {
                *entry += noise::form(left, &uv2, right);
            }
        }
        let factor = Factor::of(&whole)?;
        let columns: [[f64; UNKNOWNS]; CHANNELS] =
            std::array::from_fn(|channel| factor.solve_lower(&expected.response.map(|row| row[channel])));
        Some(std::array::from_fn(|unknown| columns.map(|column| column[unknown])))
    }

    /// The same of unit steps in the space of L⁻¹.
    fn moved(&self, certain: &Inverse) -> Option<Vec<Vec<f64>>> {
        self.weights(certain).map(|weights| self.combined(&weights))
    }

    /// Part of unit steps that no contact explains there, in the channels' deviations: (I − J K) s.
    fn unexplained(&self, certain: &Inverse) -> Option<Vec<Vec<f64>>> {
        let contact = noise::contact(&self.place_mm, &self.force_n);
        let response = certain.expected(&contact)?.response;
        let slopes = certain.slopes(self.place_mm, &self.force_n);
        let uv = certain.field().strain_uv(&contact).uv.map(f64::from);
        let variances = certain.noise().variances(&uv, self.force_n[2]);
        let weights: [[f64; CHANNELS]; CHANNELS] = std::array::from_fn(|channel| {
            let deviation = (variances.noise[channel] + variances.field[channel]).sqrt();
            std::array::from_fn(|other| {
                let explained: f64 = slopes[channel].iter().zip(&response).map(|(j, k)| j * k[other]).sum();
                (f64::from(u8::from(channel == other)) - explained) / deviation
            })
        });
        Some(self.combined(&weights))
    }

    /// These combinations of the channels' L⁻¹aₖ.
    fn combined(&self, weights: &[[f64; CHANNELS]]) -> Vec<Vec<f64>> {
        let combined = |weights: &[f64; CHANNELS]| {
            let mut combined = vec![0.0; self.halves[0].len()];
            for (weight, half) in weights.iter().zip(&self.halves) {
                combined.iter_mut().zip(half).for_each(|(sum, entry)| *sum += weight * entry);
            }
            combined
        };
        weights.iter().map(combined).collect()
    }

    /// Covariance of the channels that these modes leave.
    fn left_by(&self, modes: &[UnroundedMode], field: &InfluenceField, reach_mm: f64) -> FieldCovariance {
        // Σₖₗ − Σᵣ cᵣₖ cᵣₗ + Σᵣ eᵣₖ eᵣₗ, where c = vᵀL⁻¹a is what a mode does and e what its polynomials miss of that.
        let values = polynomials(&self.place_mm, reach_mm);
        let contact = noise::contact(&self.place_mm, &self.force_n);
        let signals_uv = field.strain_uv(&contact).uv.map(f64::from);
        let pairs: Vec<[[f64; 2]; CHANNELS]> =
            modes.iter().map(|mode| self.read(mode, &values, &signals_uv)).collect();
        self.of_channels(|one, other| {
            let change =
                |pair: &[[f64; 2]; CHANNELS]| pair[one][1] * pair[other][1] - pair[one][0] * pair[other][0];
            dot(&self.halves[one], &self.halves[other]) + pairs.iter().map(change).sum::<f64>()
        })
    }

    /// Addition of a mode to each channel, and the error of its mixture and polynomials in that.
    fn read(
        &self,
        mode: &UnroundedMode,
        values: &[f64],
        signals_uv: &[f64; CHANNELS],
    ) -> [[f64; 2]; CHANNELS] {
        std::array::from_fn(|channel| {
            let exact = dot(&mode.direction, &self.halves[channel]);
            let smooth = mode.maps[3 * channel..].iter().zip(self.force_n);
            let smooth: f64 = smooth.map(|(map, n)| n * dot(map, values)).sum();
            [exact, exact - dot(&mode.mixture[channel], signals_uv) - smooth]
        })
    }
}

impl UnroundedMode {
    fn rounded(&self) -> ErrorMode {
        let maps = std::array::from_fn(|term| std::array::from_fn(|map| self.maps[map][term] as f32));
        ErrorMode { mixture: self.mixture.map(|line| line.map(|share| share as f32)), maps }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::data::contacts::{Fitted, Knowledge};
    use crate::calibration::fit::prepared::PreparedRecording;
    use crate::calibration::model::prior::Prior;
    use crate::calibration::problem::effort::Effort;
    use crate::calibration::problem::hyperparameters::Settings;
    use tactpad_core::pad::device::Device;
    use tactpad_core::pad::field::PadField;
    use tactpad_core::pipeline::compensation::hysteresis::PLAYS;
    use tactpad_core::pipeline::contact::inverse::Expected;
    use tactpad_core::pipeline::contact::uncertainty::Covariance;
    use tactpad_core::quantity::{Contact, Strain};
    use tactpad_core::tables::measured::{Label, Row, Table};
    use tactpad_core::tables::recording::Recording;
    use tactpad_numeric::random::SplitMix64;

    const NOISE_UV: f64 = 10.0;
    const SETTINGS: Settings =
        Settings { thresholds_uv: [0.0; PLAYS], creep_time_s: 0.0, noise_time_s: 0.0, elastic_scale: 1.0 };
    /// χ² of five numbers below which 95 % of all cases lie.
    const CHI_SQUARE_95: f64 = 11.0705;

    /// Contacts on the nominal pad, none of them farther than 12 mm from the centre, and a reading of the untouched pad.
    fn recording(field: &PadField) -> Recording {
        let mut random = SplitMix64::new(5);
        let mut rows = vec![Row { uv: Some([0.0; CHANNELS]), ..Row::of(Label::default()) }];
        for [x_mm, y_mm] in places(12.0, 40) {
            let [fx_n, fy_n] = [0; 2].map(|_| f64::from(random.uniform()));
            let label = Label { x_mm, y_mm, fx_n, fy_n, fz_n: 2.5 };
            let uv = field.signals.strain_uv(&Contact::from(label)).uv;
            let uv = uv.map(|uv| f64::from(uv) + NOISE_UV * f64::from(random.normal()));
            rows.push(Row { uv: Some(uv), ..Row::of(label) });
        }
        Recording::of(Table { rows, ..Table::default() }, 5.0).unwrap()
    }

    /// Makes a small fit and asks about it.
    fn on_a_fit(ask: impl FnOnce(&Problem<'_>, &PosteriorFit, &Inverse)) {
        let (device, field) = (Device::nominal(), PadField::nominal());
        let recording = recording(&field);
        let fitted: Vec<Fitted> = recording
            .contacts()
            .iter()
            .map(|row| Fitted { row: *row, knowledge: Knowledge::Written })
            .collect();
        let prior = Prior::simulated(&field);
        let prepared = PreparedRecording::of(&recording, &fitted, &device, &field).unwrap();
        let problem = prepared.problem(&fitted, &device, &prior).with_background();
        let fit = problem.clone().fitted(SETTINGS, None, Effort::FULL).unwrap();
        ask(&problem, &fit, &decoder(&problem, &fit, fit.estimates.noise_model.noise));
    }

    /// Sum of the variances, in units of these deviations.
    fn trace(covariance: &Covariance, deviations: &[f64; UNKNOWNS]) -> f64 {
        (0..UNKNOWNS).map(|k| covariance[k][k] / deviations[k].powi(2)).sum()
    }

    /// What the decoder says of the field's errors at a contact, over R Σ Rᵀ with Σₖₗ = aₖᵀ H⁻¹ aₗ, the zeros left out.
    fn stated_over_exact(
        problem: &Problem<'_>,
        fit: &PosteriorFit,
        decoder: &Inverse,
        place_mm: [f64; 2],
        force_n: [f64; 3],
    ) -> f64 {
        let load = problem.without_zeros(fit, vec![problem.load(fit, place_mm, force_n)]).remove(0);
        let uv2 = load.covariance().uv2;
        let Expected { response, covariance, by_field } =
            decoder.expected(&noise::contact(&place_mm, &force_n)).unwrap();
        let exact = response.map(|left| response.map(|right| noise::form(&left, &uv2, &right)));
        let deviations = std::array::from_fn(|k| covariance[k][k].sqrt());
        trace(&by_field, &deviations) / trace(&exact, &deviations)
    }

    #[test]
    fn modes_are_the_posterior_also_between_the_places_and_under_other_forces() {
        on_a_fit(|problem, fit, decoder| {
            // The sixty places are elsewhere, and so are the directions of their forces.
            let forces_n = [[0.0, 0.0, 1.0], [2.0, -1.0, 2.0], [-0.3, 0.6, 5.0]];
            let between = places(0.97 * problem.reach_mm, 45).zip(forces_n.into_iter().cycle());
            let ratios: Vec<f64> = between
                .map(|([x_mm, y_mm], force_n)| {
                    stated_over_exact(problem, fit, decoder, [y_mm, x_mm], force_n)
                })
                .collect();
            let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
            assert!((mean - 1.0).abs() < 0.02, "{mean} {ratios:?}");
            // What the modes leave over is counted alike everywhere: too much of it in the middle, too little at the rim.
            let deviation = ratios.iter().map(|ratio| (ratio - mean).powi(2)).sum::<f64>();
            let deviation = (deviation / ratios.len() as f64).sqrt();
            assert!(deviation < 0.07, "{deviation} {ratios:?}");
            assert!(ratios.iter().all(|ratio| (ratio - 1.0).abs() < 0.16), "{ratios:?}");
        });
    }

    #[test]
    fn pads_drawn_from_the_posterior_lie_in_the_regions_in_the_middle_and_at_the_rim() {
        const DRAWS: usize = 600;
        on_a_fit(|problem, fit, decoder| {
            let mut random = SplitMix64::new(9);
            let places_mm = [[1.0, 2.0], [-5.0, 3.0], [24.0, 5.0], [-13.0, -21.0]];
            let of = |place_mm| {
                FieldAtPlace::of(&problem.prior.field, &problem.sensitivities, problem.plate_mm, place_mm)
            };
            let contacts =
                places_mm.map(|place_mm| Measured::unmeasured(place_mm, of(place_mm), [0.4, -0.3, 2.0]));
            let mut held = [0; 4];
            for _ in 0..DRAWS {
                // L⁻ᵀ n. A gain and a modulus that go against each other are far apart from θ, and their product is not: so the
                // field is drawn by its tangent, as the posterior has it.
                let normal: Vec<f64> = fit.values.iter().map(|_| f64::from(random.normal())).collect();
                let change = fit.factor.solve_upper(&normal);
                for (contact, held) in contacts.iter().zip(&mut held) {
                    let mut uv = problem.layout.load_uv(&fit.values, &problem.scale, contact);
                    let slopes = problem.layout.slopes(&fit.values, &problem.scale, contact);
                    for (k, row) in slopes.whole().iter().enumerate() {
                        uv[k] += dot(row, &change) - change[ParameterLayout::zero_at(k)];
                    }
                    let variances = decoder.noise().variances(&uv, contact.force_n[2]).noise;
                    let noisy = |k: usize| uv[k] + variances[k].sqrt() * f64::from(random.normal());
                    let strain = Strain { uv: std::array::from_fn(noisy).map(|uv: f64| uv as f32) };
                    let distance = decoder.estimate(&strain).unwrap().distance_square(&contact.label);
                    *held += usize::from(distance.unwrap() <= CHI_SQUARE_95);
                }
            }
            // 95 %, and a deviation of 600 draws is 0.9 %.
            let shares = held.map(|held| f64::from(held as u32) / DRAWS as f64);
            assert!(shares.iter().all(|share| (0.92..=0.98).contains(share)), "{shares:?}");
        });
    }
}
