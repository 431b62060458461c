//! The three converters: their clock, their reset, their settings, and that they begin to convert at the same moment.

use core::convert::Infallible;

use ads131m0x::command::NULL;
use ads131m0x::config::Config;
use ads131m0x::device::Device;
use embedded_hal::delay::DelayNs;
use embedded_hal::spi::{ErrorType, Operation, SpiDevice};
use pad::CHANNELS_EACH;
use pad::excitation::GAIN;
use pad::rate::{Rate, SYSTEM_HZ};
use rp2040_hal::{Timer, pac};

use crate::board::{CLOCK_SLICE, SELECT_PINS, SYNC_PIN, drive};
use crate::sampling;

/// The bus runs at an eighth of the system's clock, 16.4 MHz; the converters take 25.
const BUS_DIVISION: u8 = 8;

/// Low for so many cycles of their clock resets the converters; for fewer it synchronizes them.
const RESET_CYCLES: u32 = 2_048 + 100;

/// Low for synchronization, in microseconds: more than a cycle of the slowest clock, far fewer than a reset.
const SYNC_US: u32 = 20;

/// From the end of a reset to the first frame, in microseconds.
const READY_US: u32 = 300;

/// The converters.
pub(crate) struct Converters {
    timer: Timer,
}

impl Converters {
    /// The converters, at rest. `timer` waits for short times.
    pub(crate) fn new(timer: Timer) -> Self {
        let spi = spi();
        // Mode 1: the clock rests low, and data are taken at its falling edge.
        spi.sspcr0().write(|w| unsafe { w.dss().bits(7).frf().bits(0) }.spo().clear_bit().sph().set_bit());
        spi.sspcpsr().write(|w| unsafe { w.cpsdvsr().bits(BUS_DIVISION) });
        spi.sspdmacr().write(|w| w.rxdmae().set_bit().txdmae().set_bit());
        spi.sspcr1().write(|w| w.sse().set_bit());
        Self { timer }
    }

    /// Resets all, sets them for this rate, and lets them begin together; says whether all three answered as they should.
    pub(crate) fn begin(&mut self, rate: Rate) -> bool {
        sampling::stop();
        set_clock(rate);
        drive(SYNC_PIN, false);
        self.timer.delay_us(RESET_CYCLES * u32::from(rate.division) / (SYSTEM_HZ / 1_000_000) + 1);
        drive(SYNC_PIN, true);
        self.timer.delay_us(READY_US);
        let config = Config { gain: GAIN, oversampling: rate.oversampling };
        // Each is tried, so that the ones that answer go on while one is mended.
        let well = SELECT_PINS.map(|pin| converter(pin).configure(config).is_ok()).iter().all(|well| *well);
        drive(SYNC_PIN, false);
        self.timer.delay_us(SYNC_US);
        drive(SYNC_PIN, true);
        // Two conversions may wait in each: none from before is left.
        for pin in SELECT_PINS.into_iter().chain(SELECT_PINS) {
            let _ = converter(pin).exchange(&[NULL]);
        }
        sampling::start();
        well
    }
}

fn converter(pin: u8) -> Device<Selected, CHANNELS_EACH> {
    Device::new(Selected(pin))
}

fn spi() -> &'static pac::spi0::RegisterBlock {
    // SAFETY: the loop uses the bus only while sampling is stopped.
    unsafe { &*pac::SPI0::ptr() }
}

/// Half of `division` cycles low, half high.
fn set_clock(rate: Rate) {
    // SAFETY: nothing but this function uses the slice.
    let pwm = unsafe { &*pac::PWM::ptr() };
    let slice = pwm.ch(CLOCK_SLICE);
    slice.csr().write(|w| w.en().clear_bit());
    slice.div().write(|w| unsafe { w.int().bits(1).frac().bits(0) });
    slice.top().write(|w| unsafe { w.top().bits(rate.division - 1) });
    slice.cc().write(|w| unsafe { w.a().bits(rate.division / 2) });
    slice.ctr().write(|w| unsafe { w.bits(0) });
    slice.csr().write(|w| w.en().set_bit());
}

/// One converter on the bus, selected by this pin.
struct Selected(u8);

impl ErrorType for Selected {
    type Error = Infallible;
}

impl Selected {
    fn exchange(out: u8) -> u8 {
        let spi = spi();
        spi.sspdr().write(|w| unsafe { w.data().bits(u16::from(out)) });
        while spi.sspsr().read().rne().bit_is_clear() {}
        spi.sspdr().read().data().bits() as u8
    }
}

impl SpiDevice for Selected {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        drive(self.0, false);
        for operation in operations {
            match operation {
                Operation::Read(bytes) => bytes.iter_mut().for_each(|byte| *byte = Self::exchange(0)),
                Operation::Write(bytes) => {
                    for byte in bytes.iter() {
                        let _ = Self::exchange(*byte);
                    }
                }
                Operation::Transfer(read, write) => {
                    for (index, byte) in read.iter_mut().enumerate() {
                        *byte = Self::exchange(write.get(index).copied().unwrap_or(0));
                    }
                }
                Operation::TransferInPlace(bytes) => {
                    bytes.iter_mut().for_each(|byte| *byte = Self::exchange(*byte))
                }
                Operation::DelayNs(ns) => cortex_m::asm::delay(*ns / 7),
            }
        }
        drive(self.0, true);
        Ok(())
    }
}
