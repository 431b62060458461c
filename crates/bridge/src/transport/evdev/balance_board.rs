//! Reports of the Wii Balance Board: from bytes to what lies on its cells. Its driver says 0 where a cell reads less than its own zero,
//! as on many boards it does until some kilograms lie on it; here that is a weight like any other, below 0 or above.
//!
//! Source: <https://wiibrew.org/wiki/Wii_Balance_Board>.

use tactpad_core::source::codes::{ABS_HAT0X, ABS_HAT0Y, ABS_HAT1X, ABS_HAT1Y};

/// Cells of a board.
const CELLS: usize = 4;

/// Upper right, lower right, upper left, lower left, as a report has them, and the axes that the driver makes of them.
pub(super) const AXES: [u16; CELLS] = [ABS_HAT0X, ABS_HAT0Y, ABS_HAT1X, ABS_HAT1Y];

/// Reports with two bytes of buttons and eight or nineteen of cells, temperature and battery.
const IDS: [u8; 2] = [0x32, 0x34];

/// Where the cells begin in such a report, which begins with its number.
const CELLS_AT: usize = 3;

/// Where the battery is.
const BATTERY_AT: usize = CELLS_AT + 10;

/// Counts of the battery for a volt of its four cells together, as a user has measured it.
///
/// Source: <http://forum.wiibrew.org/read.php?27,1310394421,newer>, July 2011.
const BATTERY_PER_V: f32 = 25.3;

/// Weights of which the factory wrote down what each cell reads, in the driver's unit of 10 g.
const FACTORY: [f64; 3] = [0.0, 1_700.0, 3_400.0];

/// What each cell reads under the factory's weights.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Calibration([[f64; FACTORY.len()]; CELLS]);

impl Calibration {
    /// As the driver's file `bboard_calib` has it: twelve hexadecimal numbers between colons, of all cells under the first weight, then
    /// the next. `None` where that is not what it says, and where a cell does not read more under more.
    pub(super) fn read(text: &str) -> Option<Self> {
        let numbers =
            text.trim().split(':').map(|number| u16::from_str_radix(number, 16).ok().map(f64::from));
        let numbers: Vec<f64> = numbers.collect::<Option<_>>()?;
        let [none, some, more] = numbers.as_chunks::<CELLS>().0 else { return None };
        let is_whole = numbers.len() == CELLS * FACTORY.len();
        let cells = std::array::from_fn(|cell| [none[cell], some[cell], more[cell]]);
        let grows = cells.iter().all(|points| points.is_sorted_by(|less, more| less < more));
        (is_whole && grows).then_some(Self(cells))
    }

    /// What lies on each cell by a report, 10 g; `None` for a report of other things.
    pub(super) fn weights(&self, report: &[u8]) -> Option<[i32; CELLS]> {
        let (id, bytes) = (report.first()?, report.get(CELLS_AT..CELLS_AT + 2 * CELLS)?);
        let cells = bytes.as_chunks::<2>().0.iter().map(|bytes| f64::from(u16::from_be_bytes(*bytes)));
        let mut weights = [0; CELLS];
        for ((weight, reads), points) in weights.iter_mut().zip(cells).zip(self.0) {
            *weight = along(points, reads).round() as i32;
        }
        IDS.contains(id).then_some(weights)
    }
}

/// The weight at which a cell reads so much: on the line through the two nearer points.
fn along([none, some, more]: [f64; 3], reads: f64) -> f64 {
    let (from, to, weight) = if reads < some { (none, some, FACTORY[0]) } else { (some, more, FACTORY[1]) };
    weight + (reads - from) / (to - from) * FACTORY[1]
}

/// The voltage of the board's batteries by a report, V; `None` where it does not say.
pub(super) fn battery_v(report: &[u8]) -> Option<f32> {
    let counts = report.get(BATTERY_AT).filter(|_| report.first() == Some(&IDS[1]))?;
    Some(f32::from(*counts) / BATTERY_PER_V)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of one board that its owner published.
    const TOLD: &str = "07c3:3cf8:048c:296b:0ed2:4384:0b3a:3069:15e9:4a10:11ef:376e\n";

    fn report(id: u8, cells: [u16; 4]) -> Vec<u8> {
        let cells = cells.into_iter().flat_map(u16::to_be_bytes);
        [id, 0, 0].into_iter().chain(cells).chain([0x19, 0, 131]).chain([0; 8]).collect()
    }

    #[test]
    fn a_cell_below_its_own_zero_weighs_less_than_nothing() {
        let calibration = Calibration::read(TOLD).unwrap();
        let weights = |cells| calibration.weights(&report(0x34, cells)).unwrap();
        assert_eq!(weights([0x07c3, 0x4384, 0x11ef, 0x296b]), [0, 1_700, 3_400, 0]);
        // Half way between the points, and as far below the first one.
        let half = (0x0ed2 - 0x07c3) / 2;
        let [above, _, _, _] = weights([0x07c3 + half, 0, 0, 0]);
        let [below, least, _, most] = weights([0x07c3 - half, 0, 0, u16::MAX]);
        assert_eq!((above, below), (850, -850));
        assert!(least < -15_000 && most > 12_000, "{least} {most}");
    }

    #[test]
    fn what_is_no_calibration_or_no_report_of_cells_is_nothing() {
        for text in
            ["", ":", "07c3", &TOLD[..54], &format!("{}:1", TOLD.trim()), &TOLD.replace("15e9", "15g9")]
        {
            assert_eq!(Calibration::read(text), None, "{text}");
        }
        // A board that says nothing of itself, and one that reads less under more.
        assert_eq!(Calibration::read(&["0000"; 12].join(":")), None);
        assert_eq!(Calibration::read(&TOLD.replace("15e9", "0ed1")), None);
        let calibration = Calibration::read(TOLD).unwrap();
        let whole = report(0x34, [1, 2, 3, 4]);
        for length in 0..11 {
            assert_eq!(calibration.weights(&whole[..length]), None, "{length}");
        }
        assert!(calibration.weights(&whole[..11]).is_some());
        assert_eq!(calibration.weights(&report(0x21, [1, 2, 3, 4])), None);
    }

    #[test]
    fn a_report_tells_the_battery() {
        let volts = battery_v(&report(0x34, [0; 4])).unwrap();
        assert!((5.1..5.3).contains(&volts), "{volts}");
        assert_eq!(battery_v(&report(0x32, [0; 4])), None);
        assert_eq!(battery_v(&report(0x34, [0; 4])[..13]), None);
    }
}
