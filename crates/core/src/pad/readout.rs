//! From the half-bridges to what a pad writes down: bridge law, [`channels`](super::channels), converter.
//!
//! A module's seven gauges form three half-bridges. With rᵢ = ΔRᵢ/R, where R is the bridge's resistance, the signals
//! are S = δ·d for the excitation δ and the differences d
//!
//! | | difference d | sum s |
//! |---|---|---|
//! | x | r1 − r2 | r1 + r2 |
//! | y | r3 − r4 | r3 + r4 |
//! | z | (r5 + r6) − r7 | (r5 + r6) + r7 |
//!
//! That is the linear part of the bridges' voltages. The device file's exact forms are
//!
//! ```text
//! x   Vx = δ (1 + r1)/(2 + r1 + r2),          S =  4 (Vx − δ/2)
//! y   Vy = δ (1 + r3)/(2 + r3 + r4),          S =  4 (Vy − δ/2)
//! z   Vz = δ (1 + r7)/(2 + r7 + (r5 + r6)),   S = −4 (Vz − δ/2)
//! ```
//!
//! Let a be the change from tap to ground and b that from the supply to the tap (`wiring` says which gauges), so that V = δ (1 + a)/(2 + a + b). Over the common denominator
//! V − δ/2 = δ (2 + 2a − 2 − a − b)/(2 (2 + a + b)) = δ (a − b)/(2 (2 + a + b)), hence
//!
//! ```text
//! 4 (V − δ/2) = δ (a − b)/(1 + (a + b)/2)
//! ```
//!
//! With (a, b) = (r1, r2), (r3, r4) and, under the minus sign, (r7, r5 + r6), all three are S/(1 + s/2): the signal
//! and the sum are all that a bridge needs to know of its gauges.
//!
//! The paper prints Vx with r1 and r3, and Vy with r4 and r2. By the same algebra those are δ (r1 − r3)/(1 + (r1 + r3)/2)
//! and δ (r4 − r2)/(1 + (r4 + r2)/2): to first order another signal than its own Signal_Fx and Signal_Fy, not a small
//! correction of them. Its Vz is the one above. A test holds all of this against the voltages.
//!
//! Source: Wu et al., *Sensors* 2026, 26(4), 1378, section 2.2; the signs and forms are those of `models/sstid.toml`.

use crate::pad::channels::{ChannelChain, ChannelConditions};
use crate::pad::device::{Circuit, Device};
use crate::quantity::CHANNELS;

/// Signals of the nine half-bridges for one contact, µV: gauge law and excitation are in it.
///
/// Both arrays are in the order of [`CHANNEL_NAMES`](crate::quantity::CHANNEL_NAMES).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bridges {
    /// δ·d, the linear signals.
    pub signal_uv: [f64; CHANNELS],
    /// δ·s, the excitation times the sums of the gauges' relative resistance changes.
    pub sum_uv: [f64; CHANNELS],
}

impl Bridges {
    /// The signals of the exact voltages, S/(1 + s/2), in microvolts.
    ///
    /// A sum of s = −2 would be a bridge without resistance; there the quotient is not finite. Foil gauges stay
    /// below 0.01.
    pub fn exact_uv(&self, excitation_v: f64) -> [f64; CHANNELS] {
        let mut exact_uv = self.signal_uv;
        for (uv, sum_uv) in exact_uv.iter_mut().zip(self.sum_uv) {
            // S/(1 + s/2), with s = (δ s)/δ.
            *uv /= 1.0 + 0.5 * sum_uv / (excitation_v * 1e6);
        }
        exact_uv
    }
}

/// The electronics of a pad between its bridges and its converter, and the coupling of its modules.
#[derive(Clone, Debug, PartialEq)]
pub struct Readout {
    circuit: Circuit,
    channels: ChannelChain,
    /// Temperature at which gains and zeros are nominal.
    reference_c: f64,
}

impl Readout {
    /// The readout of `device`.
    pub fn of(device: &Device) -> Self {
        Self {
            circuit: device.circuit,
            channels: ChannelChain::of(device),
            reference_c: device.behaviour.thermal.reference_c,
        }
    }

    /// A new pad at the first moment of a measurement.
    pub fn conditions(&self, temperature_c: f64) -> ChannelConditions {
        ChannelConditions { above_c: temperature_c - self.reference_c, ..ChannelConditions::default() }
    }

    /// The channels of a new pad, in microvolts: raw, with offset and temperature, not tared.
    ///
    /// Gain acts on the bridge's signal alone, so that a gain of zero is a dead channel that still has its offset.
    pub fn read_uv(&self, bridges: &Bridges, temperature_c: f64) -> [f64; CHANNELS] {
        let mut uv = self.strain_uv(bridges);
        self.channels.read(&mut uv, &self.conditions(temperature_c));
        uv
    }

    /// Channels by the modules' strains, µV: the bridges by the circuit's law, with what modules take of
    /// each other.
    pub fn strain_uv(&self, bridges: &Bridges) -> [f64; CHANNELS] {
        let mut uv = if self.circuit.bridge_nonlinearity {
            bridges.exact_uv(self.circuit.excitation_v)
        } else {
            bridges.signal_uv
        };
        self.channels.couple(&mut uv);
        uv
    }

    /// The channels without their zeros: strains with ageing, gain and crosstalk.
    pub fn signal_uv(&self, strain_uv: &[f64; CHANNELS], at: &ChannelConditions) -> [f64; CHANNELS] {
        let mut uv = *strain_uv;
        self.channels.amplify(&mut uv, at);
        uv
    }

    /// Zeros of the untouched pad, µV.
    pub fn zero_uv(&self, at: &ChannelConditions) -> [f64; CHANNELS] {
        std::array::from_fn(|channel| self.channels.zero(channel, at))
    }
}

/// An analogue-to-digital converter with a symmetric range, in the wire's terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Converter {
    /// One count, in picovolts at the bridge. A count of 0 pV makes every signal reach the range's end.
    pub picovolts_per_count: u32,
    /// Width of a code, 1 to 32; a wider one counts as 32.
    pub count_bits: u8,
}

/// One channel, converted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Conversion {
    /// The code.
    pub count: i32,
    /// Whether the signal lay beyond the range (or was not a number, which reads 0).
    pub is_out_of_range: bool,
}

impl Converter {
    /// The nearest code to `uv`, halves away from zero; the range's end for a signal beyond it.
    pub fn convert(self, uv: f64) -> Conversion {
        // Codes are −2ⁿ⁻¹ … 2ⁿ⁻¹ − 1 for n bits.
        let half_range = f64::from(1_u32 << (self.count_bits.clamp(1, 32) - 1));
        let code = (uv * 1e6 / f64::from(self.picovolts_per_count)).round();
        let kept = code.clamp(-half_range, half_range - 1.0);
        Conversion { count: kept as i32, is_out_of_range: kept != code }
    }

    /// The microvolts that `count` stands for.
    pub fn uv(self, count: i32) -> f64 {
        f64::from(count) * f64::from(self.picovolts_per_count) * 1e-6
    }
}

#[cfg(test)]
mod tests {
    use firmware_proto::{DEFAULT_COUNT_BITS, DEFAULT_PICOVOLTS_PER_COUNT};

    use super::*;
    use crate::pad::device::behaviour::{Crosstalk, ModuleCrosstalk};
    use crate::pipeline::signal::Scale;
    use tactpad_numeric::random::SplitMix64;

    const EXCITATION_V: f64 = 2.8;

    /// r1 … r7 of one module.
    type Gauges = [f64; 7];

    /// Changes of foil gauges up to `scale`.
    fn gauges(random: &mut SplitMix64, scale: f64) -> Gauges {
        std::array::from_fn(|_| scale * f64::from(random.uniform()))
    }

    /// The voltage in the middle of a divider, from its two resistances.
    fn divider_v(to_ground: f64, to_supply: f64) -> f64 {
        EXCITATION_V * to_ground / (to_ground + to_supply)
    }

    /// The device file's three signals, literally: bridge resistances in ohms, dividers, four times the unbalance.
    fn from_voltages_uv([r1, r2, r3, r4, r5, r6, r7]: Gauges) -> [f64; 3] {
        let ohms = 350.0;
        let (whole, half) = (|r: f64| ohms * (1.0 + r), |r: f64| ohms * (0.5 + r));
        let unbalance_uv = |v: f64| 4e6 * (v - EXCITATION_V / 2.0);
        [
            unbalance_uv(divider_v(whole(r1), whole(r2))),
            unbalance_uv(divider_v(whole(r3), whole(r4))),
            -unbalance_uv(divider_v(whole(r7), half(r5) + half(r6))),
        ]
    }

    fn bridges([r1, r2, r3, r4, r5, r6, r7]: Gauges) -> Bridges {
        let excitation_uv = EXCITATION_V * 1e6;
        let module = |xyz: [f64; 3]| std::array::from_fn(|channel| excitation_uv * xyz[channel % 3]);
        Bridges {
            signal_uv: module([r1 - r2, r3 - r4, r5 + r6 - r7]),
            sum_uv: module([r1 + r2, r3 + r4, r5 + r6 + r7]),
        }
    }

    #[test]
    fn all_three_bridges_are_the_signal_over_one_and_half_the_sum() {
        let mut random = SplitMix64::new(1);
        for scale in [1e-6, 1e-4, 2e-3, 0.05, 0.4] {
            for _ in 0..200 {
                let gauges = gauges(&mut random, scale);
                let exact_uv = bridges(gauges).exact_uv(EXCITATION_V);
                let wanted_uv = from_voltages_uv(gauges);
                for (channel, uv) in exact_uv.iter().enumerate() {
                    // The voltages lose their leading digits to δ/2.
                    assert!((uv - wanted_uv[channel % 3]).abs() < 1e-8, "{gauges:?}, channel {channel}");
                }
            }
        }
    }

    #[test]
    fn exact_and_linear_differ_in_second_order() {
        let small = [-250e-6, 125e-6, 1e-3, 1e-3, 280e-6, 280e-6, 130e-6];
        let difference = |scale: f64| {
            let bridges = bridges(small.map(|r| scale * r));
            bridges.exact_uv(EXCITATION_V)[2] - bridges.signal_uv[2]
        };
        // −S·s/2 with s = 690e-6 and S = 2.8e6 · 430e-6.
        assert!((difference(1.0) + 1204.0 * 345e-6).abs() < 1e-3, "{}", difference(1.0));
        assert!((difference(2.0) / difference(1.0) - 4.0).abs() < 2e-3);
    }

    #[test]
    fn the_printed_x_and_y_bridges_are_other_signals() {
        // Only R1 and R2 stretch: a pure x signal.
        let [r1, r2, r3, r4, r5, r6, r7] = [1e-3, -0.6e-3, 0.0, 0.0, 0.0, 0.0, 0.0];
        let printed_uv = |to_ground: f64, to_supply: f64| {
            4e6 * (EXCITATION_V * (1.0 + to_ground) / (2.0 + to_ground + to_supply) - EXCITATION_V / 2.0)
        };
        let [x_uv, y_uv, z_uv] = from_voltages_uv([r1, r2, r3, r4, r5, r6, r7]);
        let linear_uv = bridges([r1, r2, r3, r4, r5, r6, r7]).signal_uv;
        assert!((x_uv - linear_uv[0]).abs() < 1e-3 * x_uv && y_uv.abs() < 1e-8);
        // Printed, R2 is in the y bridge: x loses it, and y reads what x does not.
        assert!((printed_uv(r1, r3) - EXCITATION_V * 1e6 * r1).abs() < 2.0, "{}", printed_uv(r1, r3));
        assert!((printed_uv(r4, r2) + EXCITATION_V * 1e6 * r2).abs() < 1.0, "{}", printed_uv(r4, r2));
        assert!((printed_uv(r1, r3) - x_uv).abs() > 0.3 * x_uv);
        assert!((printed_uv(r7, r5 + r6) + z_uv).abs() < 1e-8, "Vz is printed as it is");
    }

    /// A device whose circuit follows the linear or the exact law.
    fn device(bridge_nonlinearity: bool) -> Device {
        let mut device = Device::nominal();
        device.circuit = Circuit { excitation_v: EXCITATION_V, bridge_nonlinearity };
        device
    }

    const EVEN: Bridges = Bridges { signal_uv: [1000.0; CHANNELS], sum_uv: [0.0; CHANNELS] };

    #[test]
    fn the_circuit_chooses_the_law() {
        let bridges = bridges([2e-3, 1e-3, 1e-3, 3e-3, 1e-3, 1e-3, 5e-4]);
        assert_eq!(Readout::of(&device(false)).read_uv(&bridges, 40.0), bridges.signal_uv);
        assert_eq!(Readout::of(&device(true)).read_uv(&bridges, 40.0), bridges.exact_uv(EXCITATION_V));
        assert_ne!(bridges.signal_uv, bridges.exact_uv(EXCITATION_V));
    }

    #[test]
    fn gain_leaves_the_zero_alone() {
        let mut device = device(false);
        device.modules[1].gain = [1.5, 1.0, 0.0];
        device.modules[1].offset_uv = [-700.0, 0.0, 200.0];
        device.behaviour.thermal.zero_uv_per_c[3] = 30.0;
        device.behaviour.thermal.zero_uv_per_c2[3] = 0.5;
        let readout = Readout::of(&device);
        let reference_c = device.behaviour.thermal.reference_c;
        let read_uv = readout.read_uv(&EVEN, reference_c + 10.0);
        assert_eq!(read_uv, [1000.0, 1000.0, 1000.0, 1150.0, 1000.0, 200.0, 1000.0, 1000.0, 1000.0]);
        assert_eq!(readout.read_uv(&EVEN, reference_c)[3], 800.0);
        assert_eq!(readout.read_uv(&EVEN, reference_c - 10.0)[3], 550.0);
    }

    #[test]
    fn the_thermal_gain_acts_on_the_signal() {
        let mut device = device(false);
        device.modules[0].offset_uv[2] = 100.0;
        device.behaviour.thermal.gain_per_c[2] = -1e-3;
        let read_uv = Readout::of(&device).read_uv(&EVEN, device.behaviour.thermal.reference_c + 20.0);
        assert!((read_uv[2] - 1080.0).abs() < 1e-9, "{}", read_uv[2]);
    }

    #[test]
    fn modules_couple_before_the_gain_and_channels_after_it() {
        let mut device = device(false);
        device.modules[0].gain[2] = 2.0;
        device.modules[1].gain[2] = 3.0;
        device.behaviour.module_crosstalk = vec![ModuleCrosstalk { module: 1, with: 0, share: 0.1 }];
        device.behaviour.crosstalk = vec![Crosstalk { channel: 8, with: 5, share: 0.01 }];
        let mut bridges = Bridges { signal_uv: [0.0; CHANNELS], sum_uv: [0.0; CHANNELS] };
        bridges.signal_uv[2] = 1000.0;
        let read_uv = Readout::of(&device).read_uv(&bridges, 25.0);
        // 1000 · 2; a tenth of 1000, times 3; a hundredth of that.
        assert_eq!(read_uv, [0.0, 0.0, 2000.0, 0.0, 0.0, 300.0, 0.0, 0.0, 3.0]);
    }

    const DEFAULT: Converter =
        Converter { picovolts_per_count: DEFAULT_PICOVOLTS_PER_COUNT, count_bits: DEFAULT_COUNT_BITS };

    #[test]
    fn codes_are_at_most_half_a_count_off_and_read_as_the_host_reads_them() {
        let mut random = SplitMix64::new(9);
        let host = Scale::unidentified();
        for _ in 0..1000 {
            let uv = 80_000.0 * f64::from(random.uniform());
            let Conversion { count, is_out_of_range } = DEFAULT.convert(uv);
            assert!(!is_out_of_range && (DEFAULT.uv(count) - uv).abs() <= 0.005 + 1e-9, "{uv}");
            assert!((f64::from(count) * host.uv_per_count - uv).abs() <= 0.005 + 1e-9, "{uv}");
        }
        let counts = [0.004, 0.005, -0.005, 0.0].map(|uv| DEFAULT.convert(uv).count);
        assert_eq!(counts, [0, 1, -1, 0]);
    }

    #[test]
    fn a_signal_beyond_the_range_stops_at_its_end() {
        let code = |converter: Converter, uv: f64| {
            let Conversion { count, is_out_of_range } = converter.convert(uv);
            (count, is_out_of_range)
        };
        assert_eq!(code(DEFAULT, 83_886.07), (8_388_607, false));
        assert_eq!(code(DEFAULT, 83_886.08), (8_388_607, true));
        assert_eq!(code(DEFAULT, -83_886.08), (-8_388_608, false));
        assert_eq!(code(DEFAULT, -83_886.09), (-8_388_608, true));
        for bits in [32, 33, 255] {
            let wide = Converter { count_bits: bits, ..DEFAULT };
            assert_eq!(code(wide, f64::INFINITY), (i32::MAX, true));
            assert_eq!(code(wide, f64::NEG_INFINITY), (i32::MIN, true));
        }
        for bits in [0, 1] {
            let narrow = Converter { count_bits: bits, ..DEFAULT };
            assert_eq!((code(narrow, 1.0), code(narrow, -1.0)), ((0, true), (-1, true)));
        }
        assert_eq!(code(DEFAULT, f64::NAN), (0, true));
        assert_eq!(code(Converter { picovolts_per_count: 0, ..DEFAULT }, 1.0), (8_388_607, true));
    }
}
