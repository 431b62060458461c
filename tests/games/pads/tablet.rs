//! A pen tablet: the pen hovers from one touch to the next.

use evdev::uinput::VirtualDevice;
use evdev::{AbsInfo, AbsoluteAxisCode, BusType, KeyCode};
use tactpad::numeric::random::SplitMix64;
use tactpad::quantity::Contact;
use tactpad::source::{FULL_N, Measures, read, shipped};

use super::{Device, PLATE_MM, between, input};

/// Areas are so wide, mm, and so many times as wide as high.
const WIDTHS_MM: [f64; 2] = [150.0, 320.0];
const ASPECTS: [f64; 2] = [1.3, 1.8];
/// Units per mm, and the highest pressure, one of each.
const RESOLUTIONS: [i32; 3] = [100, 157, 200];
const PRESSURES: [i32; 4] = [1_023, 2_047, 4_095, 8_191];
/// Reports per second while the pen is in range.
const RATES_HZ: [f64; 2] = [133.0, 266.0];
/// Deviation of a pressure from one report to the next, as a share of its scale.
const NOISE_SHARE: f64 = 0.003;
/// The tip closes at this share of the scale.
const TIP_SHARE: f64 = 0.01;
/// A pen that has not touched for so long is taken out of range.
const NEAR_US: u64 = 1_000_000;

pub(super) struct Tablet {
    device: VirtualDevice,
    half_mm: [f64; 2],
    units_per_mm: f64,
    pressure_max: f64,
    /// The share of the scale that is 5 N for a profile.
    full_share: f64,
    period_us: u64,
    random: SplitMix64,
    /// Since the last touch.
    idle_us: u64,
}

impl Tablet {
    pub(super) fn new(mut random: SplitMix64) -> Self {
        let described = read::read(shipped::text("tablet").unwrap()).0.unwrap();
        let Measures::Contact(touching) = described.measures else { panic!("a pen is a contact") };
        let width_mm = between(&mut random, WIDTHS_MM);
        let half_mm = [width_mm / 2.0, width_mm / between(&mut random, ASPECTS) / 2.0];
        let mut one_of = |all: &[i32]| all[(random.next_bits() % all.len() as u64) as usize];
        let (resolution, pressure_max) = (one_of(&RESOLUTIONS), one_of(&PRESSURES));
        let units_per_mm = f64::from(resolution);
        let [x, y] = half_mm
            .map(|half_mm| AbsInfo::new(0, 0, (2.0 * half_mm * units_per_mm) as i32, 0, 0, resolution));
        let axes = [
            (AbsoluteAxisCode::ABS_X, x),
            (AbsoluteAxisCode::ABS_Y, y),
            (AbsoluteAxisCode::ABS_PRESSURE, AbsInfo::new(0, 0, pressure_max, 0, 0, 0)),
        ];
        let keys = [KeyCode::BTN_TOOL_PEN, KeyCode::BTN_TOUCH, KeyCode::BTN_STYLUS];
        let device = input::plug_in(&format!("Tablet {width_mm:.0} mm Pen"), BusType::BUS_USB, &keys, &axes);
        let period_us = (1e6 / between(&mut random, RATES_HZ)) as u64;
        Self {
            device,
            half_mm,
            units_per_mm,
            pressure_max: f64::from(pressure_max),
            full_share: touching.full_share,
            period_us,
            random,
            idle_us: NEAR_US,
        }
    }
}

impl Device for Tablet {
    fn address(&self) -> String {
        "tablet".into()
    }

    fn half_mm(&self) -> [f64; 2] {
        self.half_mm
    }

    fn wait_us(&mut self) -> u64 {
        self.period_us
    }

    fn feel(&mut self, contact: &Contact) {
        let share = f64::from(contact.fz_n) / FULL_N * self.full_share;
        let is_down = share > TIP_SHARE;
        self.idle_us = if is_down { 0 } else { self.idle_us + self.period_us };
        if self.idle_us > NEAR_US {
            self.device.emit(&[input::key(KeyCode::BTN_TOOL_PEN, false)]).unwrap();
            return;
        }
        let noise = NOISE_SHARE * f64::from(self.random.normal());
        let pressure =
            if is_down { ((share + noise) * self.pressure_max).clamp(1.0, self.pressure_max) } else { 0.0 };
        let [half_width_mm, half_height_mm] = self.half_mm;
        let [right, up] = [contact.x_mm, contact.y_mm].map(|mm| (f64::from(mm) / PLATE_MM).clamp(-1.0, 1.0));
        // A tablet counts downwards.
        let place =
            [(1.0 + right) * half_width_mm, (1.0 - up) * half_height_mm].map(|mm| mm * self.units_per_mm);
        let events = [
            input::key(KeyCode::BTN_TOOL_PEN, true),
            input::axis(AbsoluteAxisCode::ABS_X, place[0]),
            input::axis(AbsoluteAxisCode::ABS_Y, place[1]),
            input::axis(AbsoluteAxisCode::ABS_PRESSURE, pressure),
            input::key(KeyCode::BTN_TOUCH, is_down),
        ];
        self.device.emit(&events).unwrap();
    }
}
