//! A Wii Balance Board as the kernel's driver reports it.

use evdev::uinput::VirtualDevice;
use evdev::{AbsInfo, AbsoluteAxisCode, BusType, KeyCode};
use tactpad::numeric::random::SplitMix64;
use tactpad::quantity::Contact;

use super::cells::FourCells;
use super::{Device, between, input};

/// The description that it is played by.
const SOURCE: &str = "balance-board";
/// Upper left, upper right, lower left, lower right.
const AXES: [AbsoluteAxisCode; 4] = [
    AbsoluteAxisCode::ABS_HAT1X,
    AbsoluteAxisCode::ABS_HAT0X,
    AbsoluteAxisCode::ABS_HAT1Y,
    AbsoluteAxisCode::ABS_HAT0Y,
];
/// Its reports come so often, per second, on average, …
const RATES_HZ: [f64; 2] = [85.0, 105.0];
/// … each of these shares of that after the one before: the radio lets them wait.
const WAITS: [f64; 2] = [0.5, 1.5];
/// Deviations: of a cell's zero from the factory's, of its gain, of its noise in N.
const ZERO_N: f64 = 3.0;
const GAIN_SHARE: f64 = 0.02;
const NOISE_N: f64 = 0.4;

pub(super) struct Board {
    device: VirtualDevice,
    cells: FourCells,
    random: SplitMix64,
    period_us: f64,
}

impl Board {
    pub(super) fn new(mut random: SplitMix64) -> Self {
        let axes = AXES.map(|axis| (axis, AbsInfo::new(0, 0, 65_535, 2, 4, 0)));
        let device = input::plug_in(
            "Nintendo Wii Remote Balance Board",
            BusType::BUS_BLUETOOTH,
            &[KeyCode::BTN_SOUTH],
            &axes,
        );
        let cells = FourCells::new(SOURCE, &mut random, [ZERO_N, GAIN_SHARE, NOISE_N]);
        let period_us = 1e6 / between(&mut random, RATES_HZ);
        Self { device, cells, random, period_us }
    }
}

impl Device for Board {
    fn address(&self) -> String {
        SOURCE.into()
    }

    fn half_mm(&self) -> [f64; 2] {
        self.cells.reach.half_mm
    }

    fn wait_us(&mut self) -> u64 {
        (self.period_us * between(&mut self.random, WAITS)) as u64
    }

    fn feel(&mut self, contact: &Contact) {
        let loads = self.cells.loads_n(contact);
        let units = self.cells.units(loads);
        // The driver knows nothing below a cell's own zero.
        let events: Vec<_> =
            AXES.iter().zip(units).map(|(axis, unit)| input::axis(*axis, unit.round().max(0.0))).collect();
        self.device.emit(&events).unwrap();
    }
}
