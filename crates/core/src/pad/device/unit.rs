//! The units of a device file, and those that people take for them.

/// Unit of a number of the device file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Lengths.
    Millimetre,
    /// Angles.
    Degree,
    /// Moduli; N/mm².
    Megapascal,
    /// The excitation.
    Volt,
    /// Signals.
    Microvolt,
    /// Forces.
    Newton,
    /// Instants and time constants.
    Second,
    /// Lags of labels.
    Millisecond,
    /// Delays of channels.
    Microsecond,
    /// The mains.
    Hertz,
    /// Cycles of load.
    Cycle,
    /// Temperatures.
    Celsius,
    /// Slopes of zeros by temperature.
    MicrovoltPerKelvin,
    /// Curvatures of zeros by temperature.
    MicrovoltPerKelvin2,
    /// Relative changes of gains by temperature.
    PerKelvin,
    /// Densities.
    KilogramPerCubicMetre,
    /// Drifts of zeros.
    MicrovoltPerHour,
    /// Ratios and factors.
    One,
    /// A resistance as a share of the bridge's R.
    BridgeR,
}

impl Unit {
    /// The unit's symbol; empty for [`Unit::One`].
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Millimetre => "mm",
            Self::Degree => "deg",
            Self::Megapascal => "MPa",
            Self::Volt => "V",
            Self::Microvolt => "uV",
            Self::Newton => "N",
            Self::Second => "s",
            Self::Millisecond => "ms",
            Self::Microsecond => "us",
            Self::Hertz => "Hz",
            Self::Cycle => "cycles",
            Self::Celsius => "degC",
            Self::MicrovoltPerKelvin => "uV/K",
            Self::MicrovoltPerKelvin2 => "uV/K2",
            Self::PerKelvin => "1/K",
            Self::KilogramPerCubicMetre => "kg/m3",
            Self::MicrovoltPerHour => "uV/h",
            Self::One => "",
            Self::BridgeR => "R",
        }
    }

    /// Units that people write by mistake, the likeliest first, each as a multiple of this one.
    const fn mistaken_for(self) -> &'static [(&'static str, f64)] {
        match self {
            Self::Millimetre => &[("metres", 1e3), ("micrometres", 1e-3), ("centimetres", 10.0)],
            Self::Megapascal => &[("gigapascals", 1e3), ("pascals", 1e-6), ("kilopascals", 1e-3)],
            Self::Volt => &[("millivolts", 1e-3), ("microvolts", 1e-6)],
            Self::Microvolt => &[("millivolts", 1e3), ("volts", 1e6), ("nanovolts", 1e-3)],
            Self::Newton => &[("millinewtons", 1e-3), ("kilonewtons", 1e3)],
            Self::Second => &[("milliseconds", 1e-3), ("microseconds", 1e-6)],
            Self::Millisecond => &[("microseconds", 1e-3)],
            Self::Microsecond => &[("nanoseconds", 1e-3)],
            Self::Hertz => &[("kilohertz", 1e3), ("millihertz", 1e-3)],
            Self::Cycle => &[("thousands", 1e3), ("millions", 1e6)],
            Self::MicrovoltPerKelvin => &[("microvolts per 10 K", 0.1), ("nanovolts per kelvin", 1e-3)],
            Self::PerKelvin => &[("percent per kelvin", 1e-2), ("parts per million and kelvin", 1e-6)],
            Self::KilogramPerCubicMetre => {
                &[("grams per cubic centimetre", 1e3), ("tonnes per cubic millimetre", 1e12)]
            }
            Self::MicrovoltPerHour => &[("microvolts per day", 1.0 / 24.0), ("nanovolts per hour", 1e-3)],
            Self::One => &[("percent", 1e-2)],
            // Radians are small numbers, so no range tells them; `possible` does by where the modules stand.
            // And what an ohm is of the bridge's R is not known.
            // Kelvins differ from degrees by a sum, not by a factor.
            Self::Degree | Self::BridgeR | Self::Celsius | Self::MicrovoltPerKelvin2 => &[],
        }
    }

    /// The unit that was probably meant by a number outside `low` to `high`, and the number in this unit.
    pub(super) fn meant(self, value: f64, low: f64, high: f64) -> Option<(&'static str, f64)> {
        if self == Self::Celsius {
            let celsius = rounded(value - 273.15);
            return (low..=high).contains(&celsius).then_some(("kelvins", celsius));
        }
        // Near zero there is room for any number in a smaller unit: only one that is far out tells its own.
        let is_far = |factor: f64| {
            low > 0.0 || factor > THOUSANDTH || value.abs() >= FAR_OUT * low.abs().max(high.abs())
        };
        let likely = self.mistaken_for().iter().filter(|(_, factor)| is_far(*factor));
        let mut converted = likely.map(|(unit, factor)| (*unit, rounded(value * factor)));
        // One percent and less is nobody's mistake: whoever writes 1 means 1.
        let is_small = |unit, value: f64| value == 0.0 || unit == "percent" && value.abs() <= 0.01;
        converted.find(|(unit, value)| (low..=high).contains(value) && !is_small(*unit, *value))
    }
}

/// Smaller units than this are told by the number alone only if it is so many times beyond the range.
const THOUSANDTH: f64 = 1e-3;
const FAR_OUT: f64 = 10.0;

/// `value` without the digits that a change of its unit leaves behind.
fn rounded(value: f64) -> f64 {
    format!("{value:.9e}").parse().unwrap_or(value)
}

/// The number as a sentence shows it.
pub(super) fn shown(value: f64) -> String {
    let magnitude = value.abs();
    if value != 0.0 && !(1e-4..1e9).contains(&magnitude) {
        return format!("{value:e}");
    }
    format!("{value}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_of_the_wrong_magnitude_tells_its_unit() {
        let meant = |unit: Unit, value| unit.meant(value, 0.1, 10.0);
        assert_eq!(meant(Unit::Millimetre, 0.0012), Some(("metres", 1.2)));
        assert_eq!(meant(Unit::Millimetre, 1_000.0), Some(("micrometres", 1.0)));
        assert_eq!(meant(Unit::Millimetre, 0.05), Some(("centimetres", 0.5)));
        assert_eq!(meant(Unit::One, 60.0), Some(("percent", 0.6)));
        assert_eq!(meant(Unit::Millimetre, -1.0), None);
        assert_eq!(meant(Unit::Degree, 400.0), None);
        let displaced = |value| Unit::Millimetre.meant(value, -10.0, 10.0);
        assert_eq!([displaced(15.0), displaced(-99.0)], [None, None], "too far, and in millimetres");
        assert_eq!(displaced(-700.0), Some(("micrometres", -0.7)));
        assert_eq!(meant(Unit::Celsius, 275.15), Some(("kelvins", 2.0)));
        assert_eq!(meant(Unit::Celsius, 25.0), None);
        assert_eq!(Unit::Megapascal.meant(193.0, 1_200.0, 1e6), Some(("gigapascals", 193_000.0)));
        assert_eq!(Unit::Megapascal.meant(1.93e11, 1_200.0, 1e6), Some(("pascals", 193_000.0)));
        assert_eq!(Unit::Microvolt.meant(0.0, 1.0, 2.0), None, "zero is zero in any unit");
    }

    #[test]
    fn numbers_stay_short() {
        assert_eq!(
            [0.0, -0.125, 193_000.0, 1e300, 2e-9].map(shown),
            ["0", "-0.125", "193000", "1e300", "2e-9"]
        );
    }
}
