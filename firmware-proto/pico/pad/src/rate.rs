//! Rates: the clock for the converters is the system's, divided by a whole number, so that its edges do not jitter.

use ads131m0x::config::Oversampling;

/// The system's clock, in hertz. A sixteenth of it is just below the 8.192 MHz for which the converter's noise is told.
pub const SYSTEM_HZ: u32 = 131_000_000;

/// The least division, in cycles of the system's clock.
const DIVISION_MIN: u32 = 16;

/// The slowest rate that can be asked for, in hertz.
pub const RATE_MIN_HZ: u16 = firmware_proto::RATE_MIN_HZ;

/// The fastest, in hertz: what one bus and one USB endpoint carry with room to spare.
pub const RATE_MAX_HZ: u16 = 4_000;

/// The rate after a start, in hertz.
pub const RATE_DEFAULT_HZ: u16 = 1_000;

/// How far the rate may be from what was asked for, in thousandths.
const DEVIATION_MAX_PERMILLE: u32 = 5;

/// How a rate is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rate {
    /// What the converters are set to.
    pub oversampling: Oversampling,
    /// Cycles of the system's clock in one of the converters'.
    pub division: u16,
}

impl Rate {
    /// The rate nearest to `rate_hz` with as much oversampling as keeps it within half a percent; `None` outside of what the pad can do.
    #[must_use]
    pub fn near(rate_hz: u16) -> Option<Self> {
        if !(RATE_MIN_HZ..=RATE_MAX_HZ).contains(&rate_hz) {
            return None;
        }
        let asked_hz = u32::from(rate_hz);
        Oversampling::FROM_HIGHEST.into_iter().find_map(|oversampling| {
            let cycles = oversampling.clocks() * asked_hz;
            let division = (SYSTEM_HZ + cycles / 2) / cycles;
            let deviation = SYSTEM_HZ.abs_diff(division * cycles) / (division * cycles / 1_000).max(1);
            let rate = Self { oversampling, division: u16::try_from(division).ok()? };
            (division >= DIVISION_MIN && deviation < DEVIATION_MAX_PERMILLE).then_some(rate)
        })
    }

    /// Samples per second, rounded.
    #[must_use]
    pub fn hz(self) -> u16 {
        let cycles = self.oversampling.clocks() * u32::from(self.division);
        ((SYSTEM_HZ + cycles / 2) / cycles) as u16
    }

    /// From sample to sample, in microseconds, rounded up.
    #[must_use]
    pub fn period_us(self) -> u32 {
        let cycles = self.oversampling.clocks() * u32::from(self.division);
        cycles.div_ceil(SYSTEM_HZ / 1_000_000)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_rate_is_met_within_half_a_percent_and_its_clock_is_one_the_converter_takes() {
        for rate_hz in RATE_MIN_HZ..=RATE_MAX_HZ {
            let rate = Rate::near(rate_hz).unwrap();
            let clock_hz = SYSTEM_HZ / u32::from(rate.division);
            assert!((300_000..=8_200_000).contains(&clock_hz), "{rate_hz} Hz: {clock_hz} Hz");
            let real_hz =
                f64::from(SYSTEM_HZ) / f64::from(rate.division) / f64::from(rate.oversampling.clocks());
            let deviation = (real_hz / f64::from(rate_hz) - 1.0).abs();
            assert!(deviation < 0.0051, "{rate_hz} Hz: {real_hz} Hz");
            assert!(rate.hz().abs_diff(rate_hz) <= 1 + rate_hz / 200, "{rate_hz} Hz: {} Hz", rate.hz());
        }
        assert_eq!((Rate::near(RATE_MIN_HZ - 1), Rate::near(RATE_MAX_HZ + 1)), (None, None));
        assert_eq!((Rate::near(0), Rate::near(u16::MAX)), (None, None));
    }

    /// A USB at full speed carries one report in a millisecond, so a pad of 1,000 Hz may be slower than that and never faster.
    #[test]
    fn a_thousand_a_second_is_as_fast_as_reports_go_and_no_faster() {
        let rate = Rate::near(1_000).unwrap();
        assert_eq!(rate, Rate { oversampling: Oversampling::X4096, division: 16 });
        assert_eq!((rate.hz(), rate.period_us()), (999, 1_001));
        assert!(f64::from(SYSTEM_HZ) / 16.0 / 8_192.0 < 1_000.0);
    }
}
