//! Descriptions of pads that people own: where their numbers come from, what those are, and how they are a contact on the plate.

pub mod codes;
pub mod read;
pub mod shipped;

use crate::pipeline::contact::balance::{Balance, BalanceNumbers, PLATE_RADIUS_MM};
use crate::pipeline::contact::{Decoder, Method};
use codes::InputCode;

/// A force of the pad that is this force for a profile, N.
pub const FULL_N: f64 = 5.0;

/// Bits of a count that is made from a line of text.
const COUNT_BITS: u8 = 32;

/// A description, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// What people call it on the command line: small letters, digits and -.
    pub name: String,
    /// What it is, on one line.
    pub title: String,
    /// Where its numbers come from.
    pub origin: Origin,
    /// What its numbers are.
    pub measures: Measures,
}

/// Where numbers come from.
#[derive(Clone, Debug, PartialEq)]
pub enum Origin {
    /// Lines of text on a serial port.
    Lines(Lines),
    /// Frames of the wire's specification.
    Wire,
    /// An input device of the system.
    Evdev(Evdev),
}

/// An input device of the system, and how it is known among others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Evdev {
    /// A part of its name; any of these, or any name where there are none.
    pub names: Vec<String>,
    /// What it must report.
    pub has: Vec<InputCode>,
    /// What it must not report.
    pub lacks: Vec<InputCode>,
    /// Whether it is taken from the desktop while it plays, as it would move the pointer.
    pub grabs: bool,
    /// After so long without any event nothing counts, ms; `None` where silence is rest.
    pub silent_ms: Option<u32>,
    /// The axes that are the channels; none where it reports contacts.
    pub channels: Vec<u16>,
    /// What the device's own reports are, which are read beside its driver where the system allows that; `None` where the driver's
    /// axes say all.
    pub reports: Option<Reports>,
}

/// Reports of a device that say more than its driver makes of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reports {
    /// Of the Wii Balance Board: what its cells read also below their own zero.
    BalanceBoard,
}

/// Lines of text: numbers between commas, semicolons or blanks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lines {
    /// Bits per second of the port.
    pub baud: u32,
    /// Which numbers of a line are the channels', counted from 1.
    pub columns: Vec<usize>,
    /// Digits behind the point that count; one count is the last of them.
    pub decimals: u8,
}

/// What the numbers are.
#[derive(Clone, Debug, PartialEq)]
pub enum Measures {
    /// Forces into the plate at several places.
    Cells(Vec<Cell>, Reach),
    /// Three forces and three moments of one sensor below the plate.
    Wrench(Wrench, Reach),
    /// The contact itself, by the axes of an input device.
    Contact(Touching),
}

/// A contact as an input device reports it. The whole range of its axes is the plate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touching {
    /// Axis to the right, and axis downwards.
    pub place: [u16; 2],
    /// Axis of the force, if it has one.
    pub force: Option<u16>,
    /// The share of the force's full scale that is [`FULL_N`] for a profile.
    pub full_share: f64,
    /// The force that is [`FULL_N`] for a profile, N, where the device says what its numbers weigh.
    pub full_n: f64,
    /// The force of a touch for a profile where the device has none, N.
    pub touch_n: f64,
}

/// A load cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// What messages call it.
    pub name: String,
    /// Its place from the middle of the area, mm: right, up.
    pub place_mm: [f64; 2],
    /// What it presses over what it reads.
    pub gain: f64,
}

/// A sensor of six axes: Fx, Fy, Fz, Mx, My, Mz of what the hand does to it, in a right-handed frame whose z is out of the plate.
#[derive(Clone, Debug, PartialEq)]
pub struct Wrench {
    /// −1 for an axis that it counts the other way.
    pub signs: [f64; AXES],
    /// N mm per unit of a moment.
    pub nmm_per_unit: f64,
    /// Height of the plate's surface above the sensor's origin, mm.
    pub height_mm: f64,
}

/// Axes of a wrench.
pub const AXES: usize = 6;

/// Their names, in order.
pub const AXIS_NAMES: [&str; AXES] = ["fx", "fy", "fz", "mx", "my", "mz"];

/// How the area and the force of a pad map onto the plate and the forces that profiles are made for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// From the middle to the right edge and to the upper edge of the area, mm: each is the plate's radius.
    pub half_mm: [f64; 2],
    /// Newtons per unit that a number counts.
    pub n_per_unit: f64,
    /// The force of the pad that is [`FULL_N`] for a profile, N.
    pub full_n: f64,
    /// Standard deviation of a channel, N of the pad.
    pub noise_n: f64,
    /// What the weight of who stands on the pad is for a profile, N: forces are relative to it; `None` where they are absolute.
    pub standing_n: Option<f64>,
}

impl Source {
    /// Names of its channels, in order.
    pub fn channel_names(&self) -> Vec<String> {
        match &self.measures {
            Measures::Cells(cells, _) => cells.iter().map(|cell| cell.name.clone()).collect(),
            Measures::Wrench(..) => AXIS_NAMES.map(str::to_owned).to_vec(),
            Measures::Contact(_) => Vec::new(),
        }
    }

    /// Whether it measures forces along the plate.
    pub const fn has_shear(&self) -> bool {
        matches!(self.measures, Measures::Wrench(..))
    }

    /// What a profile's newton and its plate are on this pad, in one sentence.
    pub fn scale_sentence(&self) -> String {
        let of_area = |half_mm: [f64; 2]| {
            let [width_mm, height_mm] = half_mm.map(|half_mm| 2.0 * half_mm);
            format!("its area of {width_mm:.0} mm by {height_mm:.0} mm is the plate of 60 mm")
        };
        match &self.measures {
            Measures::Cells(_, Reach { half_mm, standing_n: Some(standing_n), .. })
            | Measures::Wrench(_, Reach { half_mm, standing_n: Some(standing_n), .. }) => {
                format!("{standing_n} N here are the weight of who stands on the pad; {}", of_area(*half_mm))
            }
            Measures::Cells(_, Reach { half_mm, full_n, .. })
            | Measures::Wrench(_, Reach { half_mm, full_n, .. }) => {
                format!("1 N here is {} N on the pad; {}", full_n / FULL_N, of_area(*half_mm))
            }
            Measures::Contact(Touching { force: None, touch_n, .. }) => {
                format!("a touch is {touch_n} N here; the pad's whole area is the plate of 60 mm")
            }
            Measures::Contact(Touching { full_share, .. }) => {
                let share = 100.0 * full_share / FULL_N;
                format!(
                    "1 N here is {share:.0} % of the full pressure; the pad's whole area is the plate of 60 mm"
                )
            }
        }
    }

    /// The decoder of its channels; `None` if they are too many or none, which the reader refuses.
    pub fn decoder(&self) -> Option<Decoder> {
        let reach = match &self.measures {
            Measures::Cells(_, reach) | Measures::Wrench(_, reach) => reach,
            Measures::Contact(_) => return Some(Method::Told.into()),
        };
        let Reach { half_mm, n_per_unit, full_n, noise_n, standing_n } = *reach;
        let plate_n_per_n = FULL_N / full_n;
        let plate_mm_per_mm = half_mm.map(|half_mm| PLATE_RADIUS_MM / half_mm);
        let channels = match &self.measures {
            Measures::Cells(cells, _) => cells.iter().map(|cell| cell_row(cell, plate_mm_per_mm)).collect(),
            Measures::Wrench(wrench, _) => wrench_rows(wrench, n_per_unit, plate_mm_per_mm),
            Measures::Contact(_) => Vec::new(),
        };
        let units_per_count = match &self.origin {
            Origin::Lines(lines) => 0.1_f64.powi(lines.decimals.into()),
            Origin::Wire | Origin::Evdev(_) => 1.0,
        };
        let numbers = BalanceNumbers {
            n_per_count: n_per_unit * units_per_count * plate_n_per_n,
            count_bits: COUNT_BITS,
            channels,
            noise_n: noise_n * plate_n_per_n,
            // Drivers of input devices know no number below an axis' range.
            is_clamped: matches!(self.origin, Origin::Evdev(_)),
            standing_n,
        };
        Balance::new(&numbers).map(Decoder::from)
    }
}

fn cell_row(cell: &Cell, plate_mm_per_mm: [f64; 2]) -> [f64; 5] {
    let Cell { place_mm: [x_mm, y_mm], gain, .. } = *cell;
    let [x_scale, y_scale] = plate_mm_per_mm;
    [0.0, 0.0, gain, gain * x_mm * x_scale, gain * y_mm * y_scale]
}

/// Fx, Fy, Fz, x Fz and y Fz by the six axes. With the contact at (x, y, h) and Fz' out of the plate, M = r × F says
/// `Mx = y Fz' − h Fy` and `My = h Fx − x Fz'`; a force into the plate is Fz = −Fz'.
fn wrench_rows(wrench: &Wrench, n_per_unit: f64, plate_mm_per_mm: [f64; 2]) -> Vec<[f64; 5]> {
    let Wrench { signs, nmm_per_unit, height_mm } = wrench;
    let [x_scale, y_scale] = plate_mm_per_mm;
    // A moment's count is worth so many newtons' counts, times mm.
    let moment_mm = nmm_per_unit / n_per_unit;
    let rows = [
        [1.0, 0.0, 0.0, -height_mm * x_scale, 0.0],
        [0.0, 1.0, 0.0, 0.0, -height_mm * y_scale],
        [0.0, 0.0, -1.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, -moment_mm * y_scale],
        [0.0, 0.0, 0.0, moment_mm * x_scale, 0.0],
        [0.0; 5],
    ];
    rows.iter().zip(signs).map(|(row, sign)| row.map(|number| number * sign)).collect()
}
