//! How a module's seven gauges are wired into three half-bridges.
//!
//! A half-bridge is a divider of the excitation δ. Its tap is read against ground, and what it departs from δ/2 is the
//! signal:
//!
//! ```text
//! V = δ · (resistance from tap to ground)/(whole resistance),   S = ±4 (V − δ/2)
//! ```
//!
//! To first order S = ±δ (Σ r to ground − Σ r to the supply), with r = ΔR/R; `readout` has the exact law. Who changes the
//! two sides of a half-bridge turns its channel's sign.
//!
//! Source: Wu et al., *Sensors* 2026, 26(4), 1378, section 2.2, the equations of the signals; the paper's printed Vx and
//! Vy pair the gauges otherwise (`docs/contradictions.md`).

pub mod front_end;
pub mod permutation;

use super::device::GAUGES;

/// One half-bridge of each module. Gauges are counted from 0: R1 is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfBridge {
    /// The channel that it makes, without its module: x, y or z.
    pub axis: &'static str,
    /// In series between the excitation and the tap.
    pub to_supply: &'static [usize],
    /// In series between the tap and ground.
    pub to_ground: &'static [usize],
    /// 1 if the channel grows with the tap's voltage, −1 if it falls.
    pub polarity: f64,
}

/// The half-bridges in the order of a module's channels.
pub const HALF_BRIDGES: [HalfBridge; 3] = [
    HalfBridge { axis: "x", to_supply: &[1], to_ground: &[0], polarity: 1.0 },
    HalfBridge { axis: "y", to_supply: &[3], to_ground: &[2], polarity: 1.0 },
    HalfBridge { axis: "z", to_supply: &[4, 5], to_ground: &[6], polarity: -1.0 },
];

/// A gauge's name, R1 to R7.
pub fn gauge_name(gauge: usize) -> String {
    format!("R{}", gauge + 1)
}

impl HalfBridge {
    /// The factor of each gauge's r in the signal over δ, to first order.
    pub fn signs(&self) -> [f64; GAUGES] {
        std::array::from_fn(|gauge| {
            let on = |side: &[usize]| f64::from(u8::from(side.contains(&gauge)));
            self.polarity * (on(self.to_ground) - on(self.to_supply))
        })
    }

    /// Whether a gauge is part of it.
    pub fn has(&self, gauge: usize) -> bool {
        self.to_supply.contains(&gauge) || self.to_ground.contains(&gauge)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pad::device::Device;

    #[test]
    fn signals_are_those_of_the_device_file() {
        // δ (r1 − r2), δ (r3 − r4), δ ((r5 + r6) − r7).
        let wanted = [
            [1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, -1.0],
        ];
        assert_eq!(HALF_BRIDGES.map(|bridge| bridge.signs()), wanted);
    }

    #[test]
    fn every_gauge_is_in_one_half_bridge_and_the_nominal_ones_are_in_balance() {
        let gauges = Device::nominal().gauges;
        for gauge in 0..GAUGES {
            assert_eq!(
                HALF_BRIDGES.iter().filter(|bridge| bridge.has(gauge)).count(),
                1,
                "{}",
                gauge_name(gauge)
            );
        }
        for bridge in HALF_BRIDGES {
            let whole = |side: &[usize]| -> f64 { side.iter().map(|g| gauges[*g].resistance_ratio).sum() };
            assert_eq!(whole(bridge.to_supply), whole(bridge.to_ground), "{}", bridge.axis);
        }
    }
}
