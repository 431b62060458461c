//! What the converter is set to: gain, oversampling, power; and what follows from it.

/// Addresses of registers.
pub mod register {
    /// Number of channels and revision.
    pub const ID: u8 = 0x00;
    /// Checksums, resets, format.
    pub const MODE: u8 = 0x02;
    /// Channels, oversampling, power.
    pub const CLOCK: u8 = 0x03;
    /// Gains of the first four channels.
    pub const GAIN1: u8 = 0x04;
}

/// The reference inside the converter, in millivolts.
pub const REFERENCE_MV: u32 = 1_200;

/// The largest code of 24 bits.
pub const CODE_MAX: i32 = (1 << 23) - 1;

/// Gain before the converter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
#[allow(missing_docs, reason = "the number says it")]
pub enum Gain {
    X1 = 0,
    X2,
    X4,
    X8,
    X16,
    X32,
    X64,
    X128,
}

impl Gain {
    /// The factor.
    #[must_use]
    pub const fn factor(self) -> u32 {
        1 << self as u8
    }

    /// One code at the input, in picovolts, rounded: the range of twice the reference over the gain has 2^24 codes.
    #[must_use]
    pub const fn picovolts_per_code(self) -> u32 {
        let range_pv = 2 * REFERENCE_MV as u64 * 1_000_000_000 / self.factor() as u64;
        ((range_pv + (1 << 23)) >> 24) as u32
    }
}

/// Oversampling: cycles of the modulator in one conversion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
#[allow(missing_docs, reason = "the number says it")]
pub enum Oversampling {
    X128 = 0,
    X256,
    X512,
    X1024,
    X2048,
    X4096,
    X8192,
    X16256,
}

impl Oversampling {
    /// All, the highest first.
    pub const FROM_HIGHEST: [Self; 8] = [
        Self::X16256,
        Self::X8192,
        Self::X4096,
        Self::X2048,
        Self::X1024,
        Self::X512,
        Self::X256,
        Self::X128,
    ];

    /// Cycles of the modulator. The highest is no power of two.
    #[must_use]
    pub const fn cycles(self) -> u32 {
        match self {
            Self::X16256 => 16_256,
            _ => 128 << self as u8,
        }
    }

    /// Cycles of the clock pin in one conversion: the modulator has half the pin's clock.
    #[must_use]
    pub const fn clocks(self) -> u32 {
        2 * self.cycles()
    }
}

/// What a converter is set to; the power mode is the one of highest resolution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Config {
    /// The same for all channels.
    pub gain: Gain,
    /// The same for all channels.
    pub oversampling: Oversampling,
}

impl Config {
    /// MODE: words of 24 bits, CCITT checksums, which are asked of the host too, the time-out of SPI on, and the mark of a reset
    /// taken off. Data-ready stays low until it is read, and follows the channel that comes last.
    pub const MODE: u16 = 0x1110;

    /// CLOCK of a converter with so many channels, all of them on.
    #[must_use]
    pub const fn clock(self, channels: usize) -> u16 {
        const HIGH_RESOLUTION: u16 = 0b10;
        ((1 << channels) - 1) << 8 | (self.oversampling as u16) << 2 | HIGH_RESOLUTION
    }

    /// GAIN1 of a converter with so many channels; of more than four, GAIN2 holds the rest.
    #[must_use]
    pub const fn gains(self, channels: usize) -> u16 {
        let mut word = 0;
        let mut channel = 0;
        while channel < channels {
            word |= (self.gain as u16) << (4 * channel);
            channel += 1;
        }
        word
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The data sheet's states after power-on: CLOCK 0x070E of three channels and 0xFF0E of eight, oversampling by 1024, gain 1.
    #[test]
    fn the_state_after_power_on_is_that_of_the_register_map() {
        let config = Config { gain: Gain::X1, oversampling: Oversampling::X1024 };
        assert_eq!(config.clock(3), 0x070E);
        assert_eq!(config.clock(8), 0xFF0E);
        assert_eq!(config.gains(3), 0x0000);
    }

    #[test]
    fn every_channel_gets_the_gain() {
        let config = Config { gain: Gain::X32, oversampling: Oversampling::X4096 };
        assert_eq!(config.gains(3), 0x0555);
        assert_eq!(config.gains(4), 0x5555);
        assert_eq!(config.clock(3), 0x0716);
    }

    /// The data sheet's full scales: 1.2 V at gain 1, 37.5 mV at 32.
    #[test]
    fn a_code_is_worth_the_range_over_two_to_the_24th() {
        assert_eq!(Gain::X1.picovolts_per_code(), 143_051);
        assert_eq!(Gain::X32.picovolts_per_code(), 4_470);
        assert_eq!(u64::from(Gain::X32.picovolts_per_code()) << 23, 37_497_077_760, "37.5 mV in picovolts");
    }

    /// The data sheet's rates at 8.192 MHz.
    #[test]
    fn the_rate_is_the_clock_over_twice_the_oversampling() {
        let rate_hz = |oversampling: Oversampling| 8_192_000 / oversampling.clocks();
        let rates = Oversampling::FROM_HIGHEST.map(rate_hz);
        assert_eq!(rates, [251, 500, 1_000, 2_000, 4_000, 8_000, 16_000, 32_000]);
    }
}
