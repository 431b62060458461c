//! Four load cells below a plate, and a microcontroller that prints what they weigh.

use std::collections::VecDeque;
use std::os::fd::OwnedFd;

use tactpad::numeric::random::SplitMix64;
use tactpad::quantity::Contact;
use tactpad::source::{FULL_N, Measures, Reach, read, shipped};

use super::{Device, PLATE_MM};
use crate::pseudo_terminal;

/// Upper left, upper right, lower left, lower right: the side to the right, and up.
const SIDES: [[f64; 2]; 4] = [[-1.0, 1.0], [1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
/// Deviation of how much more of a load rests on two opposite corners: no floor is even.
const ROCKS_SHARE: f64 = 0.1;

/// Four cells at the corners of a described area, with their errors.
pub(super) struct FourCells {
    pub(super) reach: Reach,
    rocks: f64,
    zeros_n: [f64; 4],
    gains: [f64; 4],
    noise_n: f64,
    random: SplitMix64,
}

impl FourCells {
    /// Those of a shipped description; deviations of a zero in N, of a gain, and of the noise in N.
    pub(super) fn new(
        source: &str,
        random: &mut SplitMix64,
        [zero_n, gain_share, noise_n]: [f64; 3],
    ) -> Self {
        let described = read::read(shipped::text(source).unwrap()).0.unwrap();
        let Measures::Cells(_, reach) = described.measures else { panic!("{source} has cells") };
        let mut normal = || f64::from(random.normal());
        Self {
            reach,
            rocks: ROCKS_SHARE * normal(),
            zeros_n: std::array::from_fn(|_| zero_n * normal()),
            gains: std::array::from_fn(|_| 1.0 + gain_share * normal()),
            noise_n,
            random: SplitMix64::new(random.next_bits()),
        }
    }

    /// What lies on each, N, of a stiff plate on equal cells.
    pub(super) fn loads_n(&self, contact: &Contact) -> [f64; 4] {
        let force_n = f64::from(contact.fz_n) * self.reach.full_n / FULL_N;
        let [x, y] = [contact.x_mm, contact.y_mm].map(|mm| f64::from(mm) / PLATE_MM);
        SIDES.map(|[right, up]| force_n * (1.0 + right * x + up * y + right * up * self.rocks) / 4.0)
    }

    /// What they read of that, in the units of their description.
    pub(super) fn units(&mut self, loads_n: [f64; 4]) -> [f64; 4] {
        std::array::from_fn(|k| {
            let noise_n = self.noise_n * f64::from(self.random.normal());
            (self.zeros_n[k] + loads_n[k] / self.gains[k] + noise_n) / self.reach.n_per_unit
        })
    }
}

/// Deviations: of a cell's zero, N; of its gain; of its noise, N.
const ERRORS: [f64; 3] = [5.0, 0.03, 0.04];
/// What lies on the cells is looked at so often.
const LOOK_US: u64 = 2_500;
/// A converter of this kind needs four conversions until a number is that of a new load (HX711, "settling time": 50 ms at 80 Hz, 400 ms at
/// 10 Hz). Taken here as the mean over that time.
const SETTLING_CONVERSIONS: u64 = 4;

pub(super) struct Cells {
    cells: FourCells,
    terminal: OwnedFd,
    path: String,
    period_us: u64,
    /// The loads of the last settling time.
    loads_n: VecDeque<[f64; 4]>,
    /// Since the last line.
    since_us: u64,
}

impl Cells {
    pub(super) fn new(mut random: SplitMix64, lines_per_s: u64) -> Self {
        let cells = FourCells::new("load-cells", &mut random, ERRORS);
        let (terminal, path) = pseudo_terminal::open();
        let period_us = 1_000_000 / lines_per_s;
        Self { cells, terminal, path, period_us, loads_n: VecDeque::new(), since_us: 0 }
    }

    fn print(&mut self) {
        let count = self.loads_n.len() as f64;
        let mean_n = std::array::from_fn(|k| self.loads_n.iter().map(|loads| loads[k]).sum::<f64>() / count);
        let line = self.cells.units(mean_n).map(|unit| format!("{unit:.1}")).join(",") + "\r\n";
        // Nobody reads it before the bridge is there: what does not fit is lost.
        let _ = rustix::io::write(&self.terminal, line.as_bytes());
    }
}

impl Device for Cells {
    fn address(&self) -> String {
        format!("load-cells:{}", self.path)
    }

    fn half_mm(&self) -> [f64; 2] {
        self.cells.reach.half_mm
    }

    fn wait_us(&mut self) -> u64 {
        LOOK_US
    }

    fn feel(&mut self, contact: &Contact) {
        self.loads_n.push_back(self.cells.loads_n(contact));
        if self.loads_n.len() as u64 > SETTLING_CONVERSIONS * self.period_us / LOOK_US {
            self.loads_n.pop_front();
        }
        self.since_us += LOOK_US;
        if self.since_us >= self.period_us {
            self.since_us -= self.period_us;
            self.print();
        }
    }
}
