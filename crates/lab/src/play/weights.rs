//! A known weight that was put on marked places.

use std::borrow::Cow;
use std::fmt;

use crate::calibration::data::contacts::Knowledge;
use crate::play::windows::Window;
use tactpad_core::pad::weight::{WEIGHT_SHARE, check_weight, weight_n};
use tactpad_core::tables::measured::Label;
use tactpad_core::tables::measured::ending::OpenEnd;
use tactpad_core::tables::measured::error::{Fault, ReadError};
use tactpad_core::tables::measured::rows::Rows;

/// Standard deviation of the place of a placement by hand, along each axis.
const PLACE_MM: f64 = 0.4;
/// A weight rests at least so long after it came and before it goes.
const SETTLE_S: f64 = 0.3;

/// The columns of a table of placements.
pub const HEADER: &str = "t_s,x_mm,y_mm,weight_g";

/// A weight on a mark.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Its line in the file, from 1; 0 for one that comes from no file.
    pub line: usize,
    /// Any moment while it rests, in seconds since the recording's first sample.
    pub at_s: f64,
    /// The mark.
    pub place_mm: [f64; 2],
    /// The weight.
    pub weight_g: f64,
}

/// A table of placements.
#[derive(Clone, Debug, PartialEq)]
pub struct Placements {
    /// In the file's order; at least one.
    pub all: Vec<Placement>,
    /// The table's last line, if it may be cut off.
    pub open_end: Option<OpenEnd>,
}

/// Why placements are of no use.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacementError {
    /// The line at fault, from 1; none where no single one is.
    pub line: Option<usize>,
    /// What is wrong and what to do.
    pub why: String,
}

impl fmt::Display for PlacementError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "line {line}: {}", self.why),
            None => f.write_str(&self.why),
        }
    }
}

impl std::error::Error for PlacementError {}

impl Placement {
    /// The contact that it is.
    pub fn label(&self) -> Label {
        let [x_mm, y_mm] = self.place_mm;
        Label { x_mm, y_mm, fx_n: 0.0, fy_n: 0.0, fz_n: weight_n(self.weight_g) }
    }

    /// How well it is known.
    pub fn knowledge(&self) -> Knowledge {
        let force_n = WEIGHT_SHARE * self.label().fz_n;
        Knowledge::Placed([PLACE_MM, PLACE_MM, force_n, force_n, force_n])
    }

    /// The window in the middle of its rest, with what is known of it.
    ///
    /// # Errors
    /// Nothing lies still on the pad at its time.
    pub fn found(&self, windows: &[Window]) -> Result<(usize, Label, Knowledge), PlacementError> {
        let refused = |why: String| PlacementError { line: Some(self.line).filter(|line| *line > 0), why };
        let is_now = |window: &Window| window.begin_s <= self.at_s && self.at_s <= window.end_s + 0.01;
        let Some(now) = windows.iter().find(|window| is_now(window) && window.contact.is_some()) else {
            return Err(refused(format!(
                "nothing lies on the pad at {:.1} s{}; write a moment at which the weight rests",
                self.at_s,
                nearest(windows, self.at_s)
            )));
        };
        let mut touch = windows.iter().enumerate().filter(|(_, window)| window.stretch == now.stretch);
        let (first, last) = (touch.next(), touch.next_back());
        let begin_s = first.map_or(now.begin_s, |(_, window)| window.begin_s) + SETTLE_S;
        let end_s = last.map_or(now.end_s, |(_, window)| window.end_s) - SETTLE_S;
        let is_still = |window: &Window| {
            window.stretch == now.stretch
                && window.is_full
                && window.begin_s >= begin_s
                && window.end_s <= end_s
        };
        let still: Vec<usize> = (0..windows.len()).filter(|at| is_still(&windows[*at])).collect();
        let Some(middle) = still.get(still.len() / 2) else {
            return Err(refused(format!(
                "what lies on the pad at {:.1} s is taken away within a second; let the weight rest for two",
                self.at_s
            )));
        };
        Ok((*middle, self.label(), self.knowledge()))
    }
}

/// When the pad was touched next to a time.
fn nearest(windows: &[Window], at_s: f64) -> String {
    let touched = windows.iter().filter(|window| window.contact.is_some());
    let off_s = |window: &&Window| (window.at_s() - at_s).abs();
    touched
        .min_by(|one, other| off_s(one).total_cmp(&off_s(other)))
        .map_or(String::new(), |window| format!(", but at {:.1} s", window.at_s()))
}

/// Placements as such a table.
pub fn written(placements: &[Placement]) -> String {
    let row =
        |it: &Placement| format!("{:.3},{},{},{}\n", it.at_s, it.place_mm[0], it.place_mm[1], it.weight_g);
    let rows: String = placements.iter().map(row).collect();
    format!("{HEADER}\n{rows}")
}

/// Reads a table of placements with the columns [`HEADER`].
///
/// # Errors
/// The first line that is none, with what to write.
pub fn read(text: &str, reach_mm: f64) -> Result<Placements, PlacementError> {
    let refused = |error: ReadError| PlacementError { line: Some(error.line), why: error.fault.to_string() };
    let empty = Fault::Row(format!("it is empty; its first line must be {HEADER}"));
    let mut rows = Rows::begin(text.as_bytes(), empty).map_err(refused)?;
    if rows.names().join(",") != HEADER {
        return Err(refused(rows.error(Fault::Row(format!("the first line must be {HEADER}")))));
    }
    let mut all = Vec::new();
    let read = rows.each(|line, cells| {
        all.push(placement(line, cells, reach_mm).map_err(Fault::Row)?);
        Ok(())
    });
    let open_end = read.map_err(refused)?;
    if all.is_empty() {
        return Err(PlacementError {
            line: None,
            why: "it has no placement; write one line for each".into(),
        });
    }
    Ok(Placements { all, open_end })
}

fn placement(line: usize, cells: &[Cow<'_, str>], reach_mm: f64) -> Result<Placement, String> {
    let numbers: Option<Vec<f64>> =
        cells.iter().map(|cell| cell.trim().parse().ok().filter(|number: &f64| number.is_finite())).collect();
    let Some([at_s, x_mm, y_mm, weight_g]) = numbers.as_deref() else {
        return Err(format!("write four numbers, {HEADER}"));
    };
    if x_mm.hypot(*y_mm) > reach_mm {
        return Err(format!("({x_mm}, {y_mm}) mm is beyond the plate, whose contacts reach {reach_mm} mm"));
    }
    check_weight(*weight_g)?;
    Ok(Placement { line, at_s: *at_s, place_mm: [*x_mm, *y_mm], weight_g: *weight_g })
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_core::quantity::{CHANNELS, Contact};

    const REACH_MM: f64 = 29.0;

    fn window(begin_s: f64, is_touched: bool, stretch: usize) -> Window {
        Window {
            begin_s,
            end_s: begin_s + 0.099,
            uv: [0.0; CHANNELS],
            temp_c: None,
            contact: is_touched.then(Contact::default),
            travel_mm: 0.0,
            is_full: true,
            stretch,
        }
    }

    /// Rest for a second, a weight for two, rest for one.
    fn windows() -> Vec<Window> {
        (0..40)
            .map(|tenth| {
                let stretch = [0, 1, 1, 2][tenth / 10];
                window(0.1 * tenth as f64, stretch == 1, stretch)
            })
            .collect()
    }

    #[test]
    fn placements_are_read() {
        let read_one = read("t_s, x_mm,y_mm,weight_g\n\n12.5,15,-0,200\n", REACH_MM).unwrap().all;
        assert_eq!(read_one, [Placement { line: 3, at_s: 12.5, place_mm: [15.0, -0.0], weight_g: 200.0 }]);
        assert!((read_one[0].label().fz_n - 1.96133).abs() < 1e-9);
        for (text, line, word) in [
            ("", Some(1), "empty"),
            ("t_s,x_mm,y_mm,weight_g\n", None, "no placement"),
            ("t,x,y,g\n1,0,0,200", Some(1), "first line"),
            ("t_s,x_mm,y_mm,weight_g\n1,0,0", Some(2), "3 values where"),
            ("t_s,x_mm,y_mm,weight_g\n1,0,nan,200", Some(2), "four numbers"),
            ("t_s,x_mm,y_mm,weight_g\n1,40,0,200", Some(2), "beyond the plate"),
            ("t_s,x_mm,y_mm,weight_g\n1,0,0,2", Some(2), "no weight"),
        ] {
            let refused = read(text, REACH_MM).unwrap_err();
            assert!(refused.line == line && refused.to_string().contains(word), "{refused}");
        }
    }

    #[test]
    fn a_placement_is_the_middle_of_its_rest() {
        let placement = Placement { line: 2, at_s: 1.4, place_mm: [0.0; 2], weight_g: 100.0 };
        let (at, label, _) = placement.found(&windows()).unwrap();
        assert!((18..=22).contains(&at) && label.fz_n > 0.98, "{at}");
        let nowhere = Placement { at_s: 3.5, ..placement }.found(&windows()).unwrap_err();
        assert!(
            nowhere.to_string().starts_with("line 2: nothing lies on the pad at 3.5 s, but at 2.9 s"),
            "{nowhere}"
        );
        let short: Vec<Window> = windows().into_iter().filter(|it| it.begin_s < 1.45).collect();
        assert!(placement.found(&short).unwrap_err().to_string().contains("taken away"));
    }
}
