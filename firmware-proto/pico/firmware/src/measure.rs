//! What the board measures of itself with the chip's own converter: the bridges' excitation, and its temperature.

use pad::excitation::Excitation;
use rp2040_hal::pac;

/// The reference at the pin ADC_VREF, in microvolts: one of its own, not the supply.
const REFERENCE_UV: u32 = 3_000_000;

/// Codes of twelve bits.
const CODES: u32 = 4_096;

/// Inputs of the converter: the pin of the excitation, and the thermometer inside.
const EXCITATION: u8 = 0;
const THERMOMETER: u8 = 4;

/// Readings of which each measurement is the mean.
const READINGS: u32 = 4;

/// The chip's own converter. A measurement takes eight microseconds.
pub(crate) struct Measure(());

impl Measure {
    /// Turns it on.
    pub(crate) fn new() -> Self {
        adc().cs().write(|w| w.en().set_bit().ts_en().set_bit());
        while adc().cs().read().ready().bit_is_clear() {}
        Self(())
    }

    fn microvolts(&self, input: u8) -> u32 {
        adc().cs().modify(|_, w| unsafe { w.ainsel().bits(input) });
        let reading = || {
            adc().cs().modify(|_, w| w.start_once().set_bit());
            while adc().cs().read().ready().bit_is_clear() {}
            u32::from(adc().result().read().result().bits())
        };
        let sum: u32 = (0..READINGS).map(|_| reading()).sum();
        (u64::from(sum) * u64::from(REFERENCE_UV) / u64::from(CODES * READINGS)) as u32
    }

    /// The excitation now, in microvolts.
    pub(crate) fn excitation_uv(&self) -> u32 {
        self.microvolts(EXCITATION)
    }

    /// The excitation as it is followed from now on.
    pub(crate) fn excitation(&self) -> Excitation {
        Excitation::new(self.excitation_uv())
    }

    /// The chip's temperature in hundredths of a degree: 27 °C at 0.706 V, and 1.721 mV less for each degree more.
    pub(crate) fn temperature_centi_c(&self) -> i16 {
        let above_uv = 706_000 - self.microvolts(THERMOMETER) as i32;
        (2_700 + above_uv * 100 / 1_721) as i16
    }
}

fn adc() -> &'static pac::adc::RegisterBlock {
    // SAFETY: nothing but this file uses it.
    unsafe { &*pac::ADC::ptr() }
}
