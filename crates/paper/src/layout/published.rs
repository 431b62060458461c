//! The paper's tables of other work and of cost, to stand beside this pad.

use std::f64::consts::PI;

use serde::Serialize;

use tactpad_core::quantity::CHANNELS;

/// A row of the paper's Table 7, or one to stand beside it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PublishedWork {
    /// Who.
    pub name: &'static str,
    /// What it senses with, in our words.
    pub principle: &'static str,
    /// Readout channels.
    pub channels: u32,
    /// Active area.
    pub area_cm2: f64,
    /// Area per channel as the table prints it. For two rows it is not the quotient of the table's own columns: per
    /// measured line for Piacenza, the whole area for Lee. Nothing for a pad that the table does not have.
    pub printed_cm2: Option<f64>,
    /// What it reports of its accuracy.
    pub accuracy: Accuracy,
}

/// What a work says of how near its contacts come. Areas, loads and statistics differ from row to row: none of it
/// ranks the works.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Accuracy {
    /// Error of the place; nothing where no number is given.
    pub location_mm: Option<f64>,
    /// What that error is.
    pub location_is: &'static str,
    /// Mean absolute error of the force; nothing where none is given.
    pub force_n: Option<f64>,
    /// Of what, and what else it says.
    pub of: &'static str,
    /// The work itself, if the numbers were read there; else they are as the paper's Table 7 cites them.
    pub read_in: Option<&'static str>,
}

impl PublishedWork {
    /// Area per channel from the row's own area and channels.
    pub fn area_per_channel_cm2(&self) -> f64 {
        self.area_cm2 / f64::from(self.channels)
    }
}

/// The paper's Table 7.
#[expect(
    clippy::approx_constant,
    reason = "3.14 is printed so; that it is near π follows from 60 mm and nine channels"
)]
pub const WORKS: [PublishedWork; 5] = [
    PublishedWork {
        name: "the paper",
        principle: "sparse strain, learned decoder",
        channels: 9,
        area_cm2: 28.3,
        printed_cm2: Some(3.14),
        accuracy: Accuracy {
            location_mm: Some(1.97),
            location_is: "mean absolute",
            force_n: Some(0.17),
            of: "648 contacts of 1, 3 and 5 N",
            read_in: None,
        },
    },
    PublishedWork {
        name: "Kong et al.",
        principle: "sparse taxels, deep network",
        channels: 23,
        area_cm2: 47.52,
        printed_cm2: Some(2.066),
        accuracy: Accuracy {
            location_mm: Some(0.73),
            location_is: "mean",
            force_n: None,
            of: "a pressure map, no force vector",
            read_in: None,
        },
    },
    PublishedWork {
        name: "Piacenza et al.",
        principle: "conductive elastomer, electrodes",
        channels: 6,
        area_cm2: 1.6,
        printed_cm2: Some(0.024),
        accuracy: Accuracy {
            location_mm: None,
            location_is: "median",
            force_n: None,
            of: "indentation depth to 0.74 mm",
            read_in: None,
        },
    },
    PublishedWork {
        name: "Lee et al.",
        principle: "strain gauges, microstructure",
        channels: 8,
        area_cm2: 0.027,
        printed_cm2: Some(0.027),
        accuracy: Accuracy {
            location_mm: None,
            location_is: "",
            force_n: None,
            of: "three axes of one unit, no figure",
            read_in: None,
        },
    },
    PublishedWork {
        name: "Mêda et al.",
        principle: "magnetic elastomer array, network",
        channels: 16,
        area_cm2: 6.5,
        printed_cm2: Some(0.41),
        accuracy: Accuracy {
            location_mm: Some(0.26),
            location_is: "mean absolute",
            force_n: Some(0.17),
            of: "25.5 mm square; force 0.07 to 0.17 N",
            read_in: Some("Sensors 25 (2025) 3724"),
        },
    },
];

/// Area of a round plate for each of the nine channels, in square centimetres.
///
/// Source: the paper's definition in section 3: workspace by independent strain channels.
pub fn area_per_channel_cm2(plate_diameter_mm: f64) -> f64 {
    plate_area_cm2(plate_diameter_mm) / CHANNELS as f64
}

/// Area of a round plate, in square centimetres.
pub fn plate_area_cm2(plate_diameter_mm: f64) -> f64 {
    PI * plate_diameter_mm * plate_diameter_mm / 400.0
}

/// A row of the paper's Table 1, and what it is in this project.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PublishedPart {
    /// What.
    pub name: &'static str,
    /// How many.
    pub quantity: u32,
    /// Price of one in the paper.
    pub unit_price_usd: f64,
    /// What this project asks of it.
    pub here: &'static str,
}

impl PublishedPart {
    /// Price of all of them.
    pub fn price_usd(&self) -> f64 {
        f64::from(self.quantity) * self.unit_price_usd
    }
}

/// The paper's Table 1. Its sum is 15.0 USD; the paper's text says below 15.
pub const PARTS: [PublishedPart; 7] = [
    part("sensor module", 3, 1.1, "film with 7 gauges on a frame, post and bond: models/sstid.toml"),
    part("microcontroller", 1, 5.2, "any that writes the wire of firmware-proto/, by serial port or HID"),
    part("circuit board", 3, 1.0, "three half-bridges per module, nine channels in all"),
    part("top plate", 1, 1.0, "the plate that is touched: models/sstid.toml"),
    part("bottom plate", 1, 1.0, "taken as rigid by the simulator"),
    part("base", 1, 0.5, "not part of the model"),
    part("electrical wire", 1, 1.0, "not part of the model"),
];

const fn part(name: &'static str, quantity: u32, unit_price_usd: f64, here: &'static str) -> PublishedPart {
    PublishedPart { name, quantity, unit_price_usd, here }
}

/// A row of the paper's Table 7, or of this pad beside it.
#[derive(Clone, Debug, Serialize)]
pub struct AreaRow {
    /// The work.
    #[serde(flatten)]
    pub work: PublishedWork,
    /// What a channel of it covers.
    pub area_per_channel_cm2: f64,
}

/// The paper's Table 7, with this pad before it. `rms_mm` is the pad's root mean square location error at best, if it
/// was simulated.
pub fn area_rows(plate_diameter_mm: f64, rms_mm: Option<f64>) -> Vec<AreaRow> {
    let own = PublishedWork {
        name: "this pad",
        principle: "sparse strain",
        channels: CHANNELS as u32,
        area_cm2: plate_area_cm2(plate_diameter_mm),
        printed_cm2: None,
        accuracy: Accuracy {
            location_mm: rms_mm,
            location_is: if rms_mm.is_some() { "rms, at best" } else { "" },
            force_n: None,
            of: "simulated; decoded: docs/ablation.md",
            read_in: None,
        },
    };
    let own = AreaRow { work: own, area_per_channel_cm2: area_per_channel_cm2(plate_diameter_mm) };
    let published = WORKS.map(|work| AreaRow { area_per_channel_cm2: work.area_per_channel_cm2(), work });
    [own].into_iter().chain(published).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_pad_has_its_area_per_channel() {
        // π · 30² / 9 mm² = 100 π mm² = π cm².
        assert!((area_per_channel_cm2(60.0) - PI).abs() < 1e-12);
        let [paper, ..] = WORKS;
        assert!((plate_area_cm2(60.0) - paper.area_cm2).abs() < 0.05, "28.3 is rounded");
        assert_eq!(format!("{:.2}", area_per_channel_cm2(60.0)), "3.14");
        assert_eq!(paper.printed_cm2.map(|printed| printed.to_string()).as_deref(), Some("3.14"));
        assert_eq!(paper.channels as usize, CHANNELS);
    }

    #[test]
    fn a_pad_that_was_not_simulated_has_no_accuracy() {
        let own = |rms_mm| area_rows(60.0, rms_mm)[0].work.accuracy;
        assert_eq!((own(None).location_mm, own(None).location_is), (None, ""));
        assert_eq!((own(Some(0.16)).location_mm, own(Some(0.16)).location_is), (Some(0.16), "rms, at best"));
    }

    #[test]
    fn a_number_says_what_it_is() {
        for PublishedWork { name, accuracy, .. } in WORKS {
            assert!(!accuracy.of.is_empty(), "{name}");
            assert!(accuracy.location_mm.is_none() || !accuracy.location_is.is_empty(), "{name}");
        }
    }

    #[test]
    fn two_rows_of_table_7_print_something_else_than_area_by_channels() {
        let differs = |work: &&PublishedWork| {
            (work.area_per_channel_cm2() / work.printed_cm2.unwrap() - 1.0).abs() > 0.02
        };
        let names: Vec<_> = WORKS.iter().filter(differs).map(|work| work.name).collect();
        assert_eq!(names, ["Piacenza et al.", "Lee et al."]);
    }

    #[test]
    fn table_1_sums_to_15_dollars() {
        let prices = PARTS.map(|part| part.price_usd());
        for (price, printed) in prices.into_iter().zip([3.3, 5.2, 3.0, 1.0, 1.0, 0.5, 1.0]) {
            assert!((price - printed).abs() < 1e-12);
        }
        assert!((prices.iter().sum::<f64>() - 15.0).abs() < 1e-12);
    }
}
