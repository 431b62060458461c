//! A decoder from play: presses without labels, and a known weight on marked places.

use std::f64::consts::TAU;
use std::fmt;

use crate::calibration::data::contacts::Knowledge;
use crate::calibration::data::earlier::EarlierCalibration;
use crate::calibration::fit::search::Report;
use crate::calibration::fit::{Calibration, FitError, fit_known};
use crate::calibration::result::known::PressPrecision;
use crate::play::weights::{Placement, PlacementError};
use crate::play::windows::{PlayWindows, WINDOW_S, Window};
use crate::tangent::SimulatedPad;

/// Fewer presses are no play; so many placements of a weight do without.
const PRESSES_MIN: usize = 20;
const PLACEMENTS_MIN: usize = 3;
/// A region is open if its place is known so much worse than the median region's, and by no less than so many millimetres.
const OPEN_RATIO: f64 = 1.5;
const OPEN_MM: f64 = 0.1;
/// Deviation of the modules' places, twice what hands come to, beyond which it is more likely the field that differs.
const DISPLACED_MAX_MM: f64 = 0.3;
/// The middle, and the ring around it, whose sixths are regions of their own; beyond is the rim.
const MIDDLE_MM: f64 = 9.0;
const RING_MM: f64 = 20.0;

/// A pad that was calibrated without a rig.
#[derive(Clone, Debug)]
pub struct AtHome {
    /// The calibration.
    pub calibration: Calibration,
    /// Presses, as windows of a tenth of a second.
    pub presses: usize,
    /// Placements of a weight.
    pub placements: usize,
}

/// A part of the plate, and how well it is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Name for people.
    pub name: &'static str,
    /// Root mean square over the region of the place's standard deviation by the field.
    pub deviation_mm: f64,
    /// The same of a force component, as a share of the force.
    pub force_share: f64,
    /// Presses in it.
    pub presses: usize,
}

/// Why there is no calibration.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum HomeError {
    /// A placement is of no use.
    Placement(PlacementError),
    /// The pad is never untouched for a moment.
    NoRest,
    /// There is hardly a press.
    TooFew {
        /// Windows with a firm press.
        presses: usize,
    },
    /// The fit has no answer.
    Fit(FitError),
}

impl fmt::Display for HomeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Placement(unusable) => unusable.fmt(f),
            Self::NoRest => {
                f.write_str("the pad is never untouched for a moment; lift the finger between presses")
            }
            Self::TooFew { presses } => write!(
                f,
                "the finger presses with 0.3 N or more for {:.1} s in all, and {:.1} s are the least; press for a minute or two, all over the plate",
                *presses as f64 * WINDOW_S,
                PRESSES_MIN as f64 * WINDOW_S
            ),
            Self::Fit(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for HomeError {}

/// Calibrates the pad that was played on. `pad` is what it is held against; `earlier` what another pad's decoder, or
/// an earlier one of this pad, tells.
///
/// # Errors
/// Hardly a press, no rest, placements at which nothing lies on the pad, or readings beyond anything that a pad can read.
pub fn calibrated(
    windows: &[Window],
    placements: &[Placement],
    pad: &SimulatedPad<'_>,
    earlier: Option<EarlierCalibration<'_>>,
    report: Report<'_>,
) -> Result<AtHome, HomeError> {
    let placed: Vec<_> = placements
        .iter()
        .map(|placement| placement.found(windows))
        .collect::<Result<_, _>>()
        .map_err(HomeError::Placement)?;
    let play = PlayWindows::of(windows, &placed, pad.device.contact.full_scale_n).ok_or(HomeError::NoRest)?;
    let presses = play.fitted.iter().filter(|it| it.knowledge == Knowledge::Unlabelled).count();
    if presses < PRESSES_MIN && placed.len() < PLACEMENTS_MIN {
        return Err(HomeError::TooFew { presses });
    }
    let calibration = fit_known(&play.recording, &play.fitted, pad, earlier, report);
    let calibration = calibration.map_err(HomeError::Fit)?;
    Ok(AtHome { calibration, presses, placements: placed.len() })
}

impl AtHome {
    /// The decoder's file.
    pub fn file(&self) -> Vec<u8> {
        let note = format!("{} presses of play, {} placements of a weight", self.presses, self.placements);
        self.calibration.decoder().to_bytes(&note).unwrap_or_default()
    }

    /// Whether something said how strong a newton is: presses alone never do.
    pub const fn knows_scale(&self) -> bool {
        self.placements > 0
    }

    /// By how much each module seems to be displaced, mm, where that is more than pads are built off by. Presses without labels do not tell
    /// it from an error of the simulated field: what is stated of places and forces is then too narrow.
    pub fn displaced_mm(&self) -> Option<f64> {
        let numbers = self.calibration.numbers.iter();
        let shifts = numbers.filter(|it| it.quantity.name().ends_with("radial_mm"));
        // One module may be far off by itself: all of them are not.
        let least = shifts.map(|it| it.prior_deviation).reduce(f64::min)?;
        (least > DISPLACED_MAX_MM).then_some(least)
    }

    /// The plate's regions: the middle, six parts of the ring around it, six of the rim.
    pub fn regions(&self, windows: &[Window]) -> Vec<Region> {
        let presses = windows.iter().filter_map(|window| window.contact);
        let mut counts = [0; REGIONS.len()];
        presses.for_each(|it| counts[region_at([it.x_mm, it.y_mm].map(f64::from))] += 1);
        let map = &self.calibration.map;
        let region = |(at, name): (usize, &&'static str)| {
            let here: Vec<&PressPrecision> =
                map.iter().filter(|known| region_at(known.place_mm) == at).collect();
            let rms = |of: fn(&PressPrecision) -> f64| {
                let squares: f64 = here.iter().map(|known| of(known).powi(2)).sum();
                (squares / here.len().max(1) as f64).sqrt()
            };
            let (deviation_mm, force_share) = (rms(|it| it.deviation_mm), rms(|it| it.force_share));
            Region { name, deviation_mm, force_share, presses: counts[at] }
        };
        REGIONS.iter().enumerate().map(region).collect()
    }

    /// The regions that are open, the worst first: there more presses help most.
    pub fn open(regions: &[Region]) -> Vec<&Region> {
        let mut by_size: Vec<&Region> = regions.iter().collect();
        by_size.sort_by(|one, other| other.deviation_mm.total_cmp(&one.deviation_mm));
        let median_mm = by_size[by_size.len() / 2].deviation_mm;
        by_size.retain(|it| it.deviation_mm > OPEN_MM.max(OPEN_RATIO * median_mm));
        by_size
    }
}

/// Names of the plate's regions, in the order of [`AtHome::regions`].
pub(super) const fn region_names() -> &'static [&'static str] {
    &REGIONS
}

/// Places that were pressed, weights aside.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PressedPlaces {
    /// So long a finger pressed firmly.
    pub(super) seconds: f64,
    /// Windows that a fit can take, in each of the regions.
    pub(super) by_region: [usize; REGIONS.len()],
}

impl PressedPlaces {
    /// What was pressed in these windows; the touches of these weights do not count.
    pub(super) fn of(windows: &[Window], placements: &[Placement]) -> Self {
        let holds =
            |it: &Placement, window: &Window| window.begin_s <= it.at_s && it.at_s <= window.end_s + 0.01;
        let weighed: Vec<usize> = placements
            .iter()
            .filter_map(|it| windows.iter().find(|window| holds(it, window)).map(|window| window.stretch))
            .collect();
        let firm = || windows.iter().filter(|it| it.is_firm() && !weighed.contains(&it.stretch));
        // An empty sum is −0.0.
        let seconds = 0.0 + firm().map(|it| it.end_s - it.begin_s).sum::<f64>();
        let mut by_region = [0; REGIONS.len()];
        firm()
            .filter(|window| window.is_press())
            .filter_map(|window| window.contact)
            .for_each(|it| by_region[region_at([it.x_mm, it.y_mm].map(f64::from))] += 1);
        Self { seconds, by_region }
    }
}

/// Names of the regions; the sixths begin on the right and go counter-clockwise.
const REGIONS: [&str; 13] = [
    "the middle",
    "half way to the right",
    "half way to the upper right",
    "half way to the upper left",
    "half way to the left",
    "half way to the lower left",
    "half way to the lower right",
    "the right rim",
    "the upper right rim",
    "the upper left rim",
    "the left rim",
    "the lower left rim",
    "the lower right rim",
];

fn region_at([x_mm, y_mm]: [f64; 2]) -> usize {
    let radius_mm = x_mm.hypot(y_mm);
    if radius_mm < MIDDLE_MM {
        return 0;
    }
    // Sixths of 60°, the first one around +x.
    let turns = (y_mm.atan2(x_mm) / TAU + 1.0 + 1.0 / 12.0).fract();
    let sixth = ((6.0 * turns) as usize).min(5);
    1 + sixth + if radius_mm < RING_MM { 0 } else { 6 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_place_has_its_region() {
        let at = |x_mm: f64, y_mm: f64| REGIONS[region_at([x_mm, y_mm])];
        assert_eq!(at(1.0, -2.0), "the middle");
        assert_eq!((at(15.0, 1.0), at(15.0, -1.0)), ("half way to the right", "half way to the right"));
        assert_eq!(
            (at(8.0, 13.0), at(-8.0, 13.0)),
            ("half way to the upper right", "half way to the upper left")
        );
        assert_eq!((at(-25.0, 0.5), at(-25.0, -0.5)), ("the left rim", "the left rim"));
        assert_eq!((at(-13.0, -22.0), at(13.0, -22.0)), ("the lower left rim", "the lower right rim"));
    }

    #[test]
    fn open_is_what_is_known_much_worse_than_the_rest() {
        let region = |name, deviation_mm| Region { name, deviation_mm, force_share: 0.01, presses: 3 };
        let regions =
            [region("a", 0.1), region("b", 0.3), region("c", 0.11), region("d", 0.9), region("e", 0.12)];
        let names: Vec<&str> = AtHome::open(&regions).iter().map(|it| it.name).collect();
        assert_eq!(names, ["d", "b"]);
        let good = [region("a", 0.01), region("b", 0.05), region("c", 0.011)];
        assert!(AtHome::open(&good).is_empty(), "a twentieth of a millimetre is no hole");
    }
}
