//! What the virtual pad is unless somebody says otherwise, and its converter.

use firmware_proto::sample::Status;

use crate::pad::device::Device;
use crate::pad::readout::Converter;
use crate::quantity::CHANNELS;
use tactpad_numeric::random::SplitMix64;

/// Full scale is ±20 mV. Unlike the wire's default, so that a host which does not ask for the scale reads wrong
/// forces.
pub(super) const CONVERTER: Converter = Converter { picovolts_per_count: 2384, count_bits: 24 };

const OFFSET_MAX_UV: f64 = 1500.0;
/// Standard deviation of each channel's white noise.
pub const NOISE_RMS_UV: f64 = 6.0;

/// The nominal pad with the noise and the offsets that any pad has; the seed draws the offsets.
pub(crate) fn ordinary(seed: u64) -> Device {
    let mut device = Device::nominal();
    let mut random = SplitMix64::named(seed, "offsets");
    for offset_uv in device.modules.iter_mut().flat_map(|module| &mut module.offset_uv) {
        *offset_uv = OFFSET_MAX_UV * f64::from(random.uniform());
    }
    device.behaviour.noise.additive_uv = [NOISE_RMS_UV; CHANNELS];
    device
}

/// One conversion. A channel beyond the converter's range stops at its end and is marked in the status.
pub(super) fn convert(channels_uv: &[f64; CHANNELS]) -> ([i32; CHANNELS], Status) {
    let mut status = Status::OK;
    let counts = std::array::from_fn(|channel| {
        let conversion = CONVERTER.convert(channels_uv[channel]);
        if conversion.is_out_of_range {
            status = status.with_out_of_range(channel);
        }
        conversion.count
    });
    (counts, status)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pads_differ_in_their_offsets() {
        let offsets = |seed: u64| ordinary(seed).modules.map(|module| module.offset_uv).into_iter().flatten();
        assert!(offsets(5).all(|offset_uv| offset_uv.abs() <= 1500.0));
        let spread = offsets(5).map(f64::abs).fold(0.0, f64::max);
        assert!(spread > 300.0, "offsets are of the order of a millivolt");
        assert!(offsets(5).zip(offsets(6)).all(|(one, other)| one != other));
        let other = Device { modules: Device::nominal().modules, ..ordinary(5) };
        assert_eq!(other.field_text(), Device::nominal().field_text());
    }

    #[test]
    fn a_channel_beyond_its_range_stops_and_is_marked() {
        let mut channels_uv = [0.0; CHANNELS];
        (channels_uv[2], channels_uv[7]) = (30_000.0, -30_000.0);
        let (counts, status) = convert(&channels_uv);
        assert_eq!((counts[2], counts[7], counts[0]), (8_388_607, -8_388_608, 0));
        for channel in 0..CHANNELS {
            assert_eq!(status.is_out_of_range(channel), channel == 2 || channel == 7);
        }
    }
}
