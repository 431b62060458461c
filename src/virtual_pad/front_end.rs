//! What stands between the bridges and the wire: offset, noise and the converter.

use firmware_proto::sample::Status;

use crate::quantity::{CHANNELS, Strain};
use crate::random::SplitMix64;
use crate::readout::Converter;

/// Full scale is ±20 mV. Unlike the wire's default, so that a host which does not ask for the scale reads wrong
/// forces.
pub(super) const CONVERTER: Converter = Converter { picovolts_per_count: 2384, count_bits: 24 };

const OFFSET_MAX_UV: f32 = 1500.0;
/// Standard deviation of each channel's white noise.
pub(crate) const NOISE_RMS_UV: f32 = 6.0;

/// Nine channels with their own constant offset and white noise.
#[derive(Clone, Debug)]
pub(super) struct FrontEnd {
    offsets_uv: [f32; CHANNELS],
    noise: SplitMix64,
}

impl FrontEnd {
    pub(super) fn new(seed: u64) -> Self {
        let mut noise = SplitMix64::new(seed);
        let offsets_uv = std::array::from_fn(|_| OFFSET_MAX_UV * noise.uniform());
        Self { offsets_uv, noise }
    }

    /// One conversion. A channel beyond the converter's range stops at its end and is marked in the status.
    pub(super) fn convert(&mut self, strain: &Strain) -> ([i32; CHANNELS], Status) {
        let mut counts = [0; CHANNELS];
        let mut status = Status::OK;
        let channels = counts.iter_mut().zip(strain.uv).zip(self.offsets_uv);
        for (channel, ((count, uv), offset_uv)) in channels.enumerate() {
            let bridge_uv = uv + offset_uv + NOISE_RMS_UV * self.noise.normal();
            let conversion = CONVERTER.convert(f64::from(bridge_uv));
            if conversion.is_out_of_range {
                status = status.with_out_of_range(channel);
            }
            *count = conversion.count;
        }
        (counts, status)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn uv(count: i32) -> f32 {
        CONVERTER.uv(count) as f32
    }

    #[test]
    fn rest_reads_offset_and_noise() {
        let mut front_end = FrontEnd::new(5);
        let readings: Vec<_> = (0..4000).map(|_| front_end.convert(&Strain::default())).collect();
        for channel in 0..CHANNELS {
            let values = || readings.iter().map(|(counts, _)| f64::from(uv(counts[channel])));
            let mean = values().sum::<f64>() / 4000.0;
            let rms = (values().map(|value| (value - mean).powi(2)).sum::<f64>() / 4000.0).sqrt();
            assert!((mean - f64::from(front_end.offsets_uv[channel])).abs() < 0.5, "{mean}");
            assert!(mean.abs() < 1500.5, "{mean}");
            assert!((rms - 6.0).abs() < 0.3, "{rms}");
        }
        assert!(readings.iter().all(|(_, status)| *status == Status::OK));
        let spread = front_end.offsets_uv.iter().fold(0.0_f32, |spread, offset| spread.max(offset.abs()));
        assert!(spread > 300.0, "offsets are of the order of a millivolt");
    }

    #[test]
    fn strain_adds_to_the_offset() {
        let strain = Strain { uv: std::array::from_fn(|channel| 1000.0 * (channel as f32 - 4.0)) };
        let (rest, _) = FrontEnd::new(5).convert(&Strain::default());
        let (loaded, _) = FrontEnd::new(5).convert(&strain);
        for channel in 0..CHANNELS {
            assert!((uv(loaded[channel] - rest[channel]) - strain.uv[channel]).abs() < 0.01);
        }
    }

    #[test]
    fn a_channel_beyond_its_range_stops_and_is_marked() {
        let mut strain = Strain::default();
        strain.uv[2] = 30_000.0;
        strain.uv[7] = -30_000.0;
        let (counts, status) = FrontEnd::new(5).convert(&strain);
        assert_eq!((counts[2], counts[7]), (8_388_607, -8_388_608));
        for channel in 0..CHANNELS {
            assert_eq!(status.is_out_of_range(channel), channel == 2 || channel == 7);
        }
    }
}
