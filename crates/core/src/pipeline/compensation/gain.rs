//! A gain that all channels share, and that has changed since the calibration: a pad loses gain as it ages.
//!
//! Such a pad reads r = z + β (T − T₀) + S (1 + γ (T − T₀)) s, where a calibrated one has S = 1; see
//! [`Compensation`](super::Compensation). No press tells S, as a finger may press with any force. A known weight does.

use crate::pipeline::signal::tare::UntouchedOffset;
use crate::quantity::Strain;

/// The gain S of all channels against that at the calibration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CommonGain {
    factor: f64,
}

impl CommonGain {
    /// Of a pad that reads what it read when it was calibrated, or that was never weighed on.
    pub const ONE: Self = Self { factor: 1.0 };

    /// S.
    pub const fn factor(self) -> f64 {
        self.factor
    }

    /// The gain of a pad that reads so many times what this one reads.
    #[must_use]
    pub const fn times(self, ratio: f64) -> Self {
        Self { factor: self.factor * ratio }
    }

    /// Channels beyond their zero as at the calibration, µV.
    pub fn calibrated(self, strain: &Strain) -> Strain {
        // s = s(S) / S
        Strain { uv: strain.uv.map(|uv| (f64::from(uv) / self.factor) as f32) }
    }

    /// What the untouched pad reads of a rest that is told as of the calibration.
    pub fn read(self, rest: &UntouchedOffset) -> UntouchedOffset {
        let read = |uv: f64| self.factor * uv;
        UntouchedOffset { uv: rest.uv.map(read), doubt_uv: rest.doubt_uv.map(read) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::CHANNELS;

    #[test]
    fn a_gain_of_one_changes_no_bit() {
        let strain = Strain { uv: std::array::from_fn(|k| 0.1 + 333.3 * k as f32) };
        assert_eq!(CommonGain::ONE.calibrated(&strain), strain);
        let rest = UntouchedOffset { uv: [0.1; CHANNELS], doubt_uv: [0.7; CHANNELS] };
        assert_eq!(CommonGain::ONE.read(&rest), rest);
    }

    #[test]
    fn a_pad_that_reads_less_is_made_up_for() {
        let gain = CommonGain::ONE.times(0.8).times(0.5);
        assert!((gain.factor() - 0.4).abs() < 1e-15);
        let strain = gain.calibrated(&Strain { uv: [40.0; CHANNELS] });
        assert!(strain.uv.iter().all(|uv| (uv - 100.0).abs() < 1e-4));
    }
}
