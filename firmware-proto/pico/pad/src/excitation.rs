//! The bridges' excitation: what it is, and what a count is worth by it.

use ads131m0x::config::Gain;

/// What the pad's bridges are supplied with, in microvolts.
pub const NOMINAL_UV: u32 = 2_500_000;

/// The excitation for which the wire's microvolts are told, in microvolts: that of the nominal pad.
const TOLD_FOR_UV: u64 = 2_800_000;

/// Signals are four times what a half-bridge's tap departs by.
const TAPS_TO_SIGNAL: u64 = 4;

/// Further from nominal than this, in thousandths, no count is trusted.
const TOLERANCE_PERMILLE: u32 = 50;

/// The gain before the converters: 37.5 mV at the tap are full scale.
pub const GAIN: Gain = Gain::X32;

/// Picovolts at the bridge per count, at nominal excitation.
pub const PICOVOLTS_PER_COUNT: u32 = {
    let range_pv = 2 * ads131m0x::config::REFERENCE_MV as u64 * 1_000_000_000 / GAIN.factor() as u64;
    let told_pv = range_pv * TAPS_TO_SIGNAL * TOLD_FOR_UV / NOMINAL_UV as u64;
    ((told_pv + (1 << 23)) >> 24) as u32
};

/// Parts of a microvolt in which the mean is kept, as a shift.
const PARTS_SHIFT: u32 = 8;

/// No reading is higher, in microvolts.
const READING_MAX_UV: u32 = 5_000_000;

/// New readings count for one in 2^this: 0.64 s at a hundred readings a second, so that the chip's own converter brings no noise.
const SMOOTHING_SHIFT: u32 = 6;

/// Follows the excitation: a signal is proportional to it, and so is told as if it were nominal.
#[derive(Clone, Copy, Debug)]
pub struct Excitation {
    mean_parts: u32,
}

impl Excitation {
    /// Begins with a first reading, in microvolts.
    #[must_use]
    pub const fn new(uv: u32) -> Self {
        Self { mean_parts: parts(uv) }
    }

    /// Takes a reading, in microvolts. One that is far off counts at once: a supply that fails is told at once.
    pub fn see(&mut self, uv: u32) {
        let seen = parts(uv);
        let mean = self.mean_parts;
        self.mean_parts = if is_far(seen) || is_far(mean) {
            seen
        } else if seen >= mean {
            mean + ((seen - mean) >> SMOOTHING_SHIFT)
        } else {
            mean - ((mean - seen) >> SMOOTHING_SHIFT)
        };
    }

    /// Whether it is so far from nominal that no count can be trusted.
    #[must_use]
    pub const fn is_out_of_tolerance(&self) -> bool {
        is_far(self.mean_parts)
    }

    /// What a code would be at nominal excitation.
    #[must_use]
    pub fn at_nominal(&self, code: i32) -> i32 {
        if self.is_out_of_tolerance() {
            return code;
        }
        let nominal = i64::from(NOMINAL_UV << PARTS_SHIFT);
        let scaled = i64::from(code) * nominal;
        let half = i64::from(self.mean_parts / 2) * scaled.signum();
        ((scaled + half) / i64::from(self.mean_parts)) as i32
    }
}

const fn parts(uv: u32) -> u32 {
    (if uv < READING_MAX_UV { uv } else { READING_MAX_UV }) << PARTS_SHIFT
}

const fn is_far(parts: u32) -> bool {
    let nominal = NOMINAL_UV << PARTS_SHIFT;
    parts.abs_diff(nominal) > nominal / 1_000 * TOLERANCE_PERMILLE
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2.4 V over 32 and 2^24 codes are 4,470.35 pV at a tap; four times that, at 2.8 instead of 2.5 V.
    #[test]
    fn a_count_is_worth_what_the_taps_and_the_gain_make_it() {
        assert_eq!(PICOVOLTS_PER_COUNT, 20_027);
    }

    #[test]
    fn a_signal_is_told_as_if_the_excitation_were_nominal() {
        for mv in [2_400, 2_450, 2_500, 2_550, 2_600] {
            let excitation = Excitation::new(1_000 * mv);
            for code in [0, 1, -1, 100_000, -100_000, 8_000_000] {
                let told = f64::from(excitation.at_nominal(code));
                assert!(
                    (told - f64::from(code) * 2_500.0 / f64::from(mv)).abs() <= 0.5,
                    "{code} at {mv} mV: {told}"
                );
            }
            assert!(!excitation.is_out_of_tolerance());
        }
    }

    #[test]
    fn noise_of_the_readings_is_smoothed_and_a_failing_supply_is_told_at_once() {
        let mut excitation = Excitation::new(2_500_000);
        for round in 0..1_000 {
            excitation.see(if round % 2 == 0 { 2_503_000 } else { 2_497_000 });
        }
        assert!((excitation.at_nominal(1_000_000) - 1_000_000).abs() < 100, "{excitation:?}");
        excitation.see(2_000_000);
        assert!(excitation.is_out_of_tolerance());
        assert_eq!(excitation.at_nominal(1_234), 1_234);
        excitation.see(2_510_000);
        assert!(!excitation.is_out_of_tolerance(), "as soon as it is back");
        for uv in [0, u32::MAX] {
            excitation.see(uv);
            assert!(excitation.is_out_of_tolerance());
        }
    }
}
