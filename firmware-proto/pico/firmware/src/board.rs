//! The board: its pins, its clocks, and what of the chip each part of the program gets.

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{InputPin, OutputPin};
use pad::light::State;
use pad::rate::SYSTEM_HZ;
use rp2040_hal as hal;

use hal::clocks::ClocksManager;
use hal::fugit::{ExtU32, HertzU32, RateExtU32};
use hal::gpio::{
    FunctionNull, FunctionPwm, FunctionSioInput, FunctionSioOutput, FunctionSpi, Pin, PullNone, PullUp,
};
use hal::pac;
use hal::pll::{PLLConfig, common_configs::PLL_USB_48MHZ, setup_pll_blocking};
use hal::usb::UsbBus;
use hal::watchdog::Watchdog;
use hal::xosc::setup_xosc_blocking;
use usb_device::bus::UsbBusAllocator;

/// The crystal, in hertz.
const CRYSTAL_HZ: u32 = 12_000_000;

/// Chip selects of the converters of modules 0, 1 and 2, as numbers of pins.
pub(crate) const SELECT_PINS: [u8; pad::CONVERTERS] = [5, 6, 7];

/// Data-ready of the converter of module 0; the others convert at the same time.
pub(crate) const READY_PIN: u8 = 8;

/// Synchronization and reset of all converters: low acts.
pub(crate) const SYNC_PIN: u8 = 9;

/// A jumper from here to ground: the pad sends contacts from its start.
const CONTACTS_PIN: u8 = 22;

/// The light on the board.
const LIGHT_PIN: u8 = 25;

/// The clock for the converters leaves on pin 10: the first output of this PWM slice.
pub(crate) const CLOCK_SLICE: usize = 5;

/// A program that does not come round in this time is restarted, in milliseconds.
const WATCHDOG_MS: u32 = 500;

/// What the parts of the program need of the chip.
pub(crate) struct Chip {
    /// Restarts the chip when it is not fed.
    pub(crate) watchdog: Watchdog,
    /// Waits for short times.
    pub(crate) timer: hal::Timer,
    /// The USB device; taken once.
    pub(crate) usb: Option<UsbBusAllocator<UsbBus>>,
}

impl Chip {
    /// Sets up clocks and pins; `None` if the chip's parts are taken already, or its crystal does not swing.
    pub(crate) fn take() -> Option<Self> {
        let mut p = pac::Peripherals::take()?;
        let mut watchdog = Watchdog::new(p.WATCHDOG);
        // The clock without the crystal is no faster than that with it, so the time is no shorter. It guards the crystal's start, too.
        watchdog.enable_tick_generation((CRYSTAL_HZ / 1_000_000) as u8);
        watchdog.start(WATCHDOG_MS.millis());
        let crystal = setup_xosc_blocking(p.XOSC, CRYSTAL_HZ.Hz()).ok()?;
        let mut clocks = ClocksManager::new(p.CLOCKS);
        let system =
            PLLConfig { vco_freq: HertzU32::Hz(12 * SYSTEM_HZ), refdiv: 1, post_div1: 4, post_div2: 3 };
        let frequency = crystal.operating_frequency();
        let system = setup_pll_blocking(p.PLL_SYS, frequency, system, &mut clocks, &mut p.RESETS).ok()?;
        let usb = setup_pll_blocking(p.PLL_USB, frequency, PLL_USB_48MHZ, &mut clocks, &mut p.RESETS).ok()?;
        clocks.init_default(&crystal, &system, &usb).ok()?;

        let sio = hal::Sio::new(p.SIO);
        let pins = hal::gpio::Pins::new(p.IO_BANK0, p.PADS_BANK0, sio.gpio_bank0, &mut p.RESETS);
        let _: Pin<_, FunctionSpi, PullNone> = pins.gpio2.reconfigure();
        let _: Pin<_, FunctionSpi, PullNone> = pins.gpio3.reconfigure();
        let _: Pin<_, FunctionSpi, PullUp> = pins.gpio4.reconfigure();
        // A select that is driven high before it is an output selects nobody by accident.
        let _ = pins.gpio5.into_push_pull_output_in_state(hal::gpio::PinState::High);
        let _ = pins.gpio6.into_push_pull_output_in_state(hal::gpio::PinState::High);
        let _ = pins.gpio7.into_push_pull_output_in_state(hal::gpio::PinState::High);
        let mut ready: Pin<_, FunctionSioInput, PullUp> = pins.gpio8.reconfigure();
        let _ = ready.is_high();
        let _: Pin<_, FunctionSioInput, PullUp> = pins.gpio22.reconfigure();
        let _ = pins.gpio9.into_push_pull_output_in_state(hal::gpio::PinState::High);
        let _: Pin<_, FunctionPwm, PullNone> = pins.gpio10.reconfigure();
        // The excitation, which the chip's own converter reads.
        let _: Pin<_, FunctionNull, PullNone> = pins.gpio26.reconfigure();
        let mut light: Pin<_, FunctionSioOutput, PullNone> = pins.gpio25.reconfigure();
        let _ = light.set_low();

        let resets = &p.RESETS;
        resets
            .reset()
            .modify(|_, w| w.adc().clear_bit().spi0().clear_bit().dma().clear_bit().pwm().clear_bit());
        while {
            let done = resets.reset_done().read();
            done.adc().bit_is_clear()
                || done.spi0().bit_is_clear()
                || done.dma().bit_is_clear()
                || done.pwm().bit_is_clear()
        } {}

        let timer = hal::Timer::new(p.TIMER, &mut p.RESETS, &clocks);
        let usb = UsbBus::new(p.USBCTRL_REGS, p.USBCTRL_DPRAM, clocks.usb_clock, true, &mut p.RESETS);
        Some(Self { watchdog, timer, usb: Some(UsbBusAllocator::new(usb)) })
    }

    /// Shows a state by the light for a second, and does nothing else meanwhile.
    pub(crate) fn show_a_second(&mut self, state: State) {
        for time_ms in 0..1_000 {
            self.watchdog.feed();
            light(state.is_lit(time_ms));
            self.timer.delay_ms(1);
        }
        light(false);
    }
}

/// Microseconds since the chip started.
pub(crate) fn now_us() -> u64 {
    // SAFETY: registers that are only read, and by pairs that belong together.
    let timer = unsafe { &*pac::TIMER::ptr() };
    loop {
        let high = timer.timerawh().read().bits();
        let low = timer.timerawl().read().bits();
        if timer.timerawh().read().bits() == high {
            return u64::from(high) << 32 | u64::from(low);
        }
    }
}

/// Drives an output. Setting and clearing are one write each, so interrupts and the loop do not disturb one another.
pub(crate) fn drive(pin: u8, high: bool) {
    // SAFETY: registers of which each bit belongs to one pin.
    let sio = unsafe { &*pac::SIO::ptr() };
    let bit = 1 << pin;
    if high {
        sio.gpio_out_set().write(|w| unsafe { w.bits(bit) });
    } else {
        sio.gpio_out_clr().write(|w| unsafe { w.bits(bit) });
    }
}

/// Whether the jumper for contacts is set.
pub(crate) fn asks_for_contacts() -> bool {
    // SAFETY: a register that is only read.
    unsafe { (*pac::SIO::ptr()).gpio_in().read().bits() & (1 << CONTACTS_PIN) == 0 }
}

/// Turns the light on or off.
pub(crate) fn light(lit: bool) {
    drive(LIGHT_PIN, lit);
}
