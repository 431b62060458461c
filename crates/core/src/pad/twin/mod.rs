//! The imperfect twin: a pad, a finger and a measuring rig that are wrong in the ways of
//! [`Behaviour`](crate::pad::device::behaviour::Behaviour).
//!
//! No hardware was measured: it is a numerical stand-in for a pad. Its state goes on in time, so that streams and static
//! samples come from one model. It has no clock: the caller says how much time has passed. The same calls with the same
//! seed give the same numbers. `docs/twin.md` has the equations.

use crate::pad::device::Device;
use crate::pad::field::PadField;
use crate::pad::readout::Bridges;
use crate::quantity::{CHANNELS, Contact};
use tactpad_numeric::random::SplitMix64;

mod delay;
pub mod hand;
pub mod life;
mod memory;
mod noise;
pub mod pad;
pub mod state;

/// The pad that a seed stands for: parameters that vary from pad to pad are drawn, and fixed from then on.
pub fn drawn(device: &Device, seed: u64) -> Device {
    let mut device = device.clone();
    let thermal = &mut device.behaviour.thermal;
    let (mut zeros, mut gains) = (SplitMix64::named(seed, "zeros"), SplitMix64::named(seed, "gains"));
    for channel in 0..CHANNELS {
        thermal.zero_uv_per_c[channel] += thermal.zero_scatter_uv_per_c * f64::from(zeros.normal());
        thermal.gain_per_c[channel] += thermal.gain_scatter_per_c * f64::from(gains.normal());
    }
    (thermal.zero_scatter_uv_per_c, thermal.gain_scatter_per_c) = (0.0, 0.0);
    device
}

/// Signals of the bridges for several contacts at once, µV: the pad is linear in their forces.
pub fn bridges_of(field: &PadField, contacts: &[Contact]) -> Bridges {
    let mut sum = Bridges { signal_uv: [0.0; CHANNELS], sum_uv: [0.0; CHANNELS] };
    for Bridges { signal_uv, sum_uv } in contacts.iter().map(|contact| bridges(field, contact)) {
        sum.signal_uv.iter_mut().zip(signal_uv).for_each(|(sum, uv)| *sum += uv);
        sum.sum_uv.iter_mut().zip(sum_uv).for_each(|(sum, uv)| *sum += uv);
    }
    sum
}

/// Signals of the bridges for a contact, µV.
pub fn bridges(field: &PadField, contact: &Contact) -> Bridges {
    Bridges {
        signal_uv: field.signals.strain_uv(contact).uv.map(f64::from),
        sum_uv: field.sums.strain_uv(contact).uv.map(f64::from),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pads_scatter_by_as_much_as_is_said() {
        let mut device = Device::nominal();
        let thermal = &mut device.behaviour.thermal;
        (thermal.zero_scatter_uv_per_c, thermal.gain_scatter_per_c) = (8.0, 1e-4);
        thermal.zero_uv_per_c = [30.0; CHANNELS];
        let pads: Vec<Device> = (0..400).map(|seed| drawn(&device, seed)).collect();
        let spread = |of: fn(&Device) -> [f64; CHANNELS], mean: f64| {
            let square: f64 = pads.iter().flat_map(of).map(|value| (value - mean).powi(2)).sum();
            (square / (400 * CHANNELS) as f64).sqrt()
        };
        assert!((spread(|pad| pad.behaviour.thermal.zero_uv_per_c, 30.0) - 8.0).abs() < 0.3);
        assert!((spread(|pad| pad.behaviour.thermal.gain_per_c, 0.0) - 1e-4).abs() < 4e-6);
        assert_eq!(drawn(&device, 7), drawn(&device, 7));
        assert_eq!(drawn(&pads[3], 5), pads[3], "a pad that is drawn stays as it is");
    }
}
