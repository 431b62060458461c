//! The front end that `docs/build.md` builds: three ADS131M03, one for each module, and what their data sheet says that a builder must
//! keep to.
//!
//! A tap's departure from the mid-point is converted; a channel is four times that ([`super::HALF_BRIDGES`]), and is told as if the excitation
//! were the device file's.
//!
//! Source: Texas Instruments, ADS131M03 data sheet (SBAS853 and its sisters): input range ±1.2 V/gain, absolute input voltage, input-referred noise.

use crate::pad::device::Device;

/// The converter's name.
pub const CONVERTER: &str = "ADS131M03";
/// Gain of its amplifiers.
pub const GAIN: f64 = 32.0;
/// Excitation of the half-bridges, V, whatever the device file has: with it a tap stays within the common mode.
pub const EXCITATION_V: f64 = 2.5;
/// Analogue supply of the converters, V.
pub const ANALOGUE_SUPPLY_V: f64 = 3.3;
/// At gains of 8 and above an input stays so far below the analogue supply, V.
pub const HEADROOM_V: f64 = 1.8;
/// Full scale at gain 1, V.
const RANGE_V: f64 = 1.2;
/// Noise at the input with gain 32: samples per second, µV rms.
const NOISE_UV: [[f64; 2]; 2] = [[1_000.0, 0.77], [8_000.0, 1.69]];

/// Microvolts of a channel for a microvolt between a tap and the mid-point.
fn channel_per_tap(device: &Device) -> f64 {
    4.0 * device.circuit.excitation_v / EXCITATION_V
}

/// Full scale of a channel, mV.
pub fn range_mv(device: &Device) -> f64 {
    1e3 * channel_per_tap(device) * RANGE_V / GAIN
}

/// Full scale at a tap, mV.
pub const fn tap_range_mv() -> f64 {
    1e3 * RANGE_V / GAIN
}

/// Largest voltage of an input against ground, V.
pub const fn input_max_v() -> f64 {
    ANALOGUE_SUPPLY_V - HEADROOM_V
}

/// Noise of a channel at so many samples a second, by the data sheet, µV rms: between its rates a power of the rate.
pub fn noise_uv(device: &Device, rate_hz: f64) -> f64 {
    let [[slow_hz, slow_uv], [fast_hz, fast_uv]] = NOISE_UV;
    let power = libm::log(fast_uv / slow_uv) / libm::log(fast_hz / slow_hz);
    // Below its slowest rate here the sheet's figure stays: the noise of the bridges is not in it.
    channel_per_tap(device) * slow_uv * libm::pow((rate_hz / slow_hz).max(1.0), power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nominal_pad_reads_within_a_tap_s_common_mode_and_range() {
        let device = Device::nominal();
        assert!(0.5 * EXCITATION_V < input_max_v());
        assert!((range_mv(&device) - 168.0).abs() < 1e-9 && (tap_range_mv() - 37.5).abs() < 1e-12);
        assert!((noise_uv(&device, 1_000.0) - 3.45).abs() < 0.01);
        assert!((noise_uv(&device, 8_000.0) - 7.57).abs() < 0.01);
    }
}
