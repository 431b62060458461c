//! From gauge strains to bridge signals: the linear part of the readout, as weights.
//!
//! ΔR/R of gauge i is `resistance_ratio` · `gauge_factor` · (ε along + `transverse_ratio` · ε across). With δ the
//! excitation, the signals are δ (r1 − r2), δ (r3 − r4) and δ (r5 + r6 − r7); the bridges' sums, which make the exact
//! voltages nonlinear, are δ (r1 + r2), δ (r3 + r4) and δ (r5 + r6 + r7). All in microvolts.

use tactpad_core::pad::device::{Device, GAUGES};
use tactpad_core::pad::wiring::HALF_BRIDGES;

use super::superelement::{MODES, STRAINS, Superelement};

/// Microvolts per strain of a device's gauges.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Readings {
    /// Along the grid and across it, for R1, R2, … R7.
    uv_per_strain: [f64; STRAINS],
    /// Each gauge's resistance, as a share of the bridges'.
    resistance_ratios: [f64; GAUGES],
}

impl Readings {
    /// The weights of the device's gauges.
    pub(super) fn of(device: &Device) -> Self {
        let law = device.gauge_law;
        let uv = 1e6 * device.circuit.excitation_v * law.gauge_factor;
        Self {
            uv_per_strain: std::array::from_fn(|i| {
                let direction = if i % 2 == 0 { 1.0 } else { law.transverse_ratio };
                uv * direction * device.gauges[i / 2].resistance_ratio
            }),
            resistance_ratios: device.gauges.each_ref().map(|gauge| gauge.resistance_ratio),
        }
    }

    /// Signal of one axis (0: x, 1: y, 2: z) for a unit of each mode of a module's foot, µV/mm.
    pub(super) fn signal(&self, module: &Superelement, axis: usize) -> [f64; MODES] {
        self.weighted(module, HALF_BRIDGES[axis].signs())
    }

    /// The bridge's sum of one axis for a unit of each mode, µV/mm.
    pub(super) fn sum(&self, module: &Superelement, axis: usize) -> [f64; MODES] {
        self.weighted(module, HALF_BRIDGES[axis].signs().map(f64::abs))
    }

    /// δ r of each gauge for a unit of each mode, µV/mm: what the signals are sums of.
    pub(super) fn gauges(&self, module: &Superelement) -> [[f64; MODES]; GAUGES] {
        std::array::from_fn(|gauge| {
            self.weighted(module, std::array::from_fn(|other| f64::from(u8::from(other == gauge))))
        })
    }

    /// What a gauge read alone, in a bridge with a constant resistor of its own size, gives for a unit of each mode,
    /// µV/mm: δ ΔR/R of its own resistance R.
    pub(super) fn gauge(&self, module: &Superelement, gauge: usize) -> [f64; MODES] {
        let mut alone = [0.0; GAUGES];
        alone[gauge] = 1.0 / self.resistance_ratios[gauge];
        self.weighted(module, alone)
    }

    fn weighted(&self, module: &Superelement, signs: [f64; GAUGES]) -> [f64; MODES] {
        std::array::from_fn(|mode| {
            let strains = module.strains.iter().zip(&self.uv_per_strain).enumerate();
            strains.map(|(i, (strain, uv))| signs[i / 2] * uv * strain[mode]).sum()
        })
    }
}
