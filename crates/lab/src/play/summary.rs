//! Summary of a calibration at home: what it knows of the plate part by part, what is open, what helps most.

use serde::Serialize;

use crate::play::home::{AtHome, Region};
use crate::play::windows::Window;
use tactpad_core::counted::counted;

/// What the numbers of the parts are.
pub const HEADING: &str = "What is known of the pad, as what it leaves open of a press of 2.5 N:";

/// Summary of a calibration, for people.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Windows of a tenth of a second with a press.
    pub presses: usize,
    /// Placements of a weight.
    pub placements: usize,
    /// Whether a weight said how strong a newton is.
    pub scale_known: bool,
    /// The plate's parts.
    pub map: Vec<PlatePart>,
}

/// A part of the plate.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlatePart {
    /// Name for people.
    pub name: &'static str,
    /// Standard deviation of the place by what is not known of the pad.
    pub deviation_mm: f64,
    /// The same of a force, as a share of it.
    pub force_share: f64,
    /// Presses in it.
    pub presses: usize,
    /// Whether more presses there help most.
    pub open: bool,
}

impl Summary {
    /// What the calibration that these windows came to knows.
    pub fn of(found: &AtHome, windows: &[Window]) -> Self {
        let regions = found.regions(windows);
        let open: Vec<&str> = AtHome::open(&regions).iter().map(|region| region.name).collect();
        let part = |region: &Region| PlatePart {
            name: region.name,
            deviation_mm: region.deviation_mm,
            force_share: region.force_share,
            presses: region.presses,
            open: open.contains(&region.name),
        };
        Self {
            presses: found.presses,
            placements: found.placements,
            scale_known: found.knows_scale(),
            map: regions.iter().map(part).collect(),
        }
    }

    /// What it was found from.
    pub fn source(&self) -> String {
        let Self { presses, placements, .. } = self;
        format!(
            "{} of a second of presses, {} of a weight",
            counted(presses, "tenth"),
            counted(placements, "placement")
        )
    }

    /// What is still open, and what helps most. `weighing` says how a weight is put on the marks.
    pub fn next(&self, weighing: &str) -> String {
        let open: Vec<&str> = self.map.iter().filter(|part| part.open).map(|part| part.name).collect();
        match (self.scale_known, open.as_slice()) {
            (false, _) => format!(
                "The force's scale is unknown: presses alone never tell it. Next: put a known weight, 100 to 500 g, on five marks. {weighing}"
            ),
            (true, []) => {
                "No part of the plate is known much worse than the others. More play makes all of it better."
                    .into()
            }
            (true, parts) => format!("Next: press more on {}. It is known worst there.", parts.join(", ")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn summary(scale_known: bool, open: &[&'static str]) -> Summary {
        let names = ["the middle", "the left rim", "the right rim"];
        let part = |name| PlatePart {
            name,
            deviation_mm: 0.1,
            force_share: 0.01,
            presses: 9,
            open: open.contains(&name),
        };
        Summary { presses: 27, placements: 5, scale_known, map: names.map(part).into() }
    }

    #[test]
    fn the_scale_comes_first_then_the_worst_parts() {
        let next = |scale_known, open: &[&'static str]| summary(scale_known, open).next("Weigh it.");
        assert!(next(false, &["the left rim"]).ends_with("on five marks. Weigh it."));
        assert_eq!(
            next(true, &["the left rim"]),
            "Next: press more on the left rim. It is known worst there."
        );
        assert!(next(true, &[]).starts_with("No part of the plate"));
    }
}
