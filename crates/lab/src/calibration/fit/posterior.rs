//! Result of a fit: how probable it is and how sure, the pad's own field, and the contacts without what the past adds to them.

use crate::calibration::data::contacts::{FieldAtPlace, Knowledge, Measured};
use crate::calibration::data::rig::RigPrior;
use crate::calibration::model::ParameterLayout;
use crate::calibration::problem::hyperparameters::Estimates;
use crate::calibration::problem::{PosteriorFit, Problem};
use tactpad_core::pad::influence::{InfluenceField, MAPS};
use tactpad_core::pipeline::compensation::hysteresis::Hysteresis;
use tactpad_core::pipeline::compensation::thermal::Thermal;
use tactpad_core::quantity::{CHANNELS, Strain};
use tactpad_numeric::memory::Relaxation;
use tactpad_numeric::products::dot;

impl PosteriorFit {
    /// Posterior standard deviation of a parameter.
    pub(crate) fn deviation(&self, at: usize) -> f64 {
        // √(H⁻¹)ᵢᵢ = √(eᵢᵀ H⁻¹ eᵢ).
        let half = self.halved(&[(at, 1.0)]);
        dot(&half, &half).sqrt()
    }

    /// ln p(y, σ | settings) but for a constant that all settings share, as the priors' deviations σ are found from the contacts, too.
    pub(crate) fn log_probability(&self) -> f64 {
        self.log_evidence + self.estimates.prior_deviations.log_density()
    }

    /// The same as a start from which a module is far off and the rig is as any.
    pub(crate) fn displaced(&self, module: usize) -> Self {
        let prior_deviations = self.estimates.prior_deviations.displaced(module);
        let mut start = self.clone();
        start.estimates = Estimates { prior_deviations, rig: RigPrior::new(), ..self.estimates };
        start
    }

    /// L⁻¹c of a linear combination cᵀθ of few parameters, where H = L Lᵀ: the posterior covariance of two combinations is
    /// cᵀ H⁻¹ d = (L⁻¹c)ᵀ (L⁻¹d).
    pub(crate) fn halved(&self, combination: &[(usize, f64)]) -> Vec<f64> {
        let mut whole = vec![0.0; self.values.len()];
        combination.iter().for_each(|(at, factor)| whole[*at] = *factor);
        self.factor.solve_lower(&whole)
    }
}

impl Problem<'_> {
    /// Standard deviation of the smooth background that the evidence chose, as a share of each map; 0: none.
    pub(crate) fn background(&self, fit: &PosteriorFit) -> f64 {
        if self.layout.terms > 0 { fit.estimates.prior_deviations.background.whole() } else { 0.0 }
    }

    /// The channels of contacts with written labels, at the reference temperature, without zeros, creep and hysteresis, and the
    /// written forces.
    pub(crate) fn compensated(
        &self,
        values: &[f64],
        hysteresis: &Hysteresis,
        creep: &Relaxation,
    ) -> Vec<(Strain, [f64; 3])> {
        let mut recording = self.recording.clone().less(&ParameterLayout::zeros(values));
        if let Some(reference_c) = self.reference_c {
            let gain_per_c =
                std::array::from_fn(|channel| values[ParameterLayout::first_gain_slope() + channel]);
            let zero_uv_per_c = [0.0; CHANNELS];
            recording = recording.at_reference(&Thermal { reference_c, zero_uv_per_c, gain_per_c });
        }
        let compensated = recording.without_creep(creep).without_hysteresis(hysteresis);
        let contact = |(at, it): &(usize, Measured)| {
            if it.knowledge != Knowledge::Written {
                return None;
            }
            // As the pad would read it now.
            let gain = ParameterLayout::gain_before_ageing(values, it);
            let uv = compensated.rows.get(*at)?.uv?;
            Some((Strain { uv: uv.map(|uv| (uv / gain) as f32) }, it.force_n))
        };
        self.contacts.iter().filter_map(contact).collect()
    }

    /// The pad's own field.
    pub(crate) fn corrected(&self, values: &[f64]) -> InfluenceField {
        let signals = &self.prior.field.signals;
        InfluenceField::sampled(f64::from(signals.spacing_mm()), self.reach_mm, self.reach_mm, |place_mm| {
            let place = FieldAtPlace::level(&self.prior.field, &self.sensitivities, self.plate_mm, place_mm);
            let maps = self.layout.maps(values, &self.scale, &place, Knowledge::Written);
            std::array::from_fn::<f64, MAPS, _>(|map| maps[map / 3][map % 3])
        })
    }
}
