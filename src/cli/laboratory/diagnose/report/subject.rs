//! The subject of a report.

use tactpad::lab::diagnosis::report::Diagnosis;
use tactpad::numeric::statistics::rms;
use tactpad::pad::device::Device;

/// The subject of a report.
pub(crate) struct Subject<'d> {
    /// The diagnosis.
    pub(crate) diagnosis: &'d Diagnosis,
    /// Name of the measured file.
    pub(crate) measured: String,
    /// Name of the model with which it was compared.
    pub(crate) model: String,
    /// Unit of the channels; empty where it is not known.
    pub(crate) unit: &'d str,
    /// Unit of the loads, where it is known.
    pub(crate) load_unit: Option<&'d str>,
    /// The plate that is drawn under the contacts.
    pub(crate) plate: Option<Plate>,
}

/// A plate with its modules.
pub(crate) struct Plate {
    pub(crate) radius_mm: f64,
    /// Corners of the modules' films.
    pub(crate) modules_mm: Vec<[[f64; 2]; 4]>,
}

impl Plate {
    /// The plate of a device, its modules where it has them.
    pub(crate) fn of(device: &Device) -> Self {
        let half_mm = [device.stack.film_length_x_mm, device.stack.film_width_y_mm].map(|side| 0.5 * side);
        Self {
            radius_mm: device.plate.radius_mm(),
            modules_mm: device.poses().iter().map(|pose| pose.corners_mm(half_mm)).collect(),
        }
    }
}

impl Subject<'_> {
    /// The channels that tell anything.
    pub(super) fn alive(&self) -> Vec<usize> {
        let residuals = &self.diagnosis.residuals;
        let is_alive = |channel: &usize| residuals.nominal[*channel].iter().any(|it| it.is_finite());
        (0..residuals.nominal.len()).filter(is_alive).collect()
    }

    /// Root mean square of a channel's residuals, before and after.
    pub(super) fn errors(&self, channel: usize) -> [f64; 2] {
        let residuals = &self.diagnosis.residuals;
        [&residuals.nominal, &residuals.extended]
            .map(|of| rms(of[channel].iter().copied().filter(|it| it.is_finite())))
    }

    /// How far the model misses a channel, in multiples of its noise.
    pub(super) fn excess(&self, channel: usize) -> f64 {
        self.errors(channel)[0] / self.diagnosis.residuals.noise[channel].max(f64::MIN_POSITIVE)
    }

    /// Whether there is anything that the extended model does otherwise.
    pub(super) fn is_extended(&self) -> bool {
        let residuals = &self.diagnosis.residuals;
        residuals
            .nominal
            .iter()
            .flatten()
            .zip(residuals.extended.iter().flatten())
            .any(|(one, other)| one.is_finite() && one != other)
    }
}
