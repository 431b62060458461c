//! What a fit comes to: the pad's own field, its posterior covariance, and the contacts without what the past adds to them.

use super::contacts::{Knowledge, Measured, Place};
use super::model::Layout;
use super::noise::FieldCovariance;
use super::plate::places;
use super::problem::{Fit, Problem};
use crate::pad::influence::{InfluenceField, MAPS};
use crate::pipeline::compensation::creep::Creep;
use crate::pipeline::compensation::hysteresis::Hysteresis;
use crate::pipeline::compensation::thermal::Thermal;
use crate::quantity::{CHANNELS, Strain};

/// Normal force at which the field's posterior covariance is evaluated: half of full scale.
const REFERENCE_FORCE_N: f64 = 2.5;

impl Problem<'_> {
    /// The channels of contacts with written labels, at the reference temperature, without zeros, creep and hysteresis, and the
    /// written forces.
    pub(super) fn compensated(
        &self,
        values: &[f64],
        hysteresis: &Hysteresis,
        creep: &Creep,
    ) -> Vec<(Strain, [f64; 3])> {
        let mut recording = self.recording.clone().less(&Layout::zeros(values));
        if let Some(reference_c) = self.reference_c {
            let gain_per_c = std::array::from_fn(|channel| values[Layout::first_gain_slope() + channel]);
            let zero_uv_per_c = [0.0; CHANNELS];
            recording = recording.at_reference(&Thermal { reference_c, zero_uv_per_c, gain_per_c });
        }
        let compensated = recording.without_creep(creep).without_hysteresis(hysteresis);
        let contact = |(at, it): &(usize, Measured)| {
            if it.knowledge != Knowledge::Written {
                return None;
            }
            let uv = compensated.rows.get(*at)?.uv?;
            Some((Strain { uv: uv.map(|uv| uv as f32) }, it.force_n))
        };
        self.contacts.iter().filter_map(contact).collect()
    }

    /// Posterior covariance of the channels, Σₖₗ = aₖᵀ H⁻¹ aₗ, at contacts all over the plate that are partly shear.
    pub(super) fn field_covariances(&self, fit: &Fit) -> Vec<FieldCovariance> {
        let shear_n = 0.4 * REFERENCE_FORCE_N;
        let forces_n = [
            [shear_n, 0.0, REFERENCE_FORCE_N],
            [0.0, shear_n, REFERENCE_FORCE_N],
            [-shear_n, -shear_n, REFERENCE_FORCE_N],
        ];
        let covariances = |place_mm: [f64; 2]| {
            let place = Place::of(&self.prior.field, &self.sensitivities, self.plate_mm, place_mm);
            forces_n.map(|force_n| {
                let contact = Measured::unmeasured(place_mm, place.clone(), force_n);
                // H = L Lᵀ, so aₖᵀ H⁻¹ aₗ = (L⁻¹aₖ)ᵀ (L⁻¹aₗ).
                let mut halves = Vec::with_capacity(CHANNELS);
                self.layout.readings(&fit.values, &self.scale, &contact, |_, _, derivatives| {
                    halves.push(fit.factor.solve_lower(derivatives));
                });
                let product =
                    |one: &Vec<f64>, other: &Vec<f64>| one.iter().zip(other).map(|(a, b)| a * b).sum();
                FieldCovariance { place_mm, force_n, uv2: products(&halves, product) }
            })
        };
        places(self.reach_mm).flat_map(covariances).collect()
    }

    /// The pad's own field.
    pub(super) fn corrected(&self, values: &[f64]) -> InfluenceField {
        let signals = &self.prior.field.signals;
        InfluenceField::sampled(f64::from(signals.spacing_mm()), self.reach_mm, self.reach_mm, |place_mm| {
            let place = Place::of(&self.prior.field, &self.sensitivities, self.plate_mm, place_mm);
            let maps = self.layout.maps(values, &self.scale, &place, Knowledge::Written);
            std::array::from_fn::<f64, MAPS, _>(|map| maps[map / 3][map % 3])
        })
    }
}

/// The matrix of all products.
fn products<T>(all: &[T], product: impl Fn(&T, &T) -> f64) -> [[f64; CHANNELS]; CHANNELS] {
    std::array::from_fn(|i| std::array::from_fn(|j| product(&all[i], &all[j])))
}
