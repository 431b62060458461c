//! Measuring plans: which contacts are made, how, and in what order.
//!
//! A plan is a [`Table`] without channels. What a row is for stands in its session; `docs/protocol.md` has the reasons.
//! No platform's sine is called, so a plan is the same, byte for byte, on every machine.

pub mod paper;
pub mod recommended;

use std::f64::consts::PI;

use crate::tables::measured::zero::ZERO;
use crate::tables::measured::{Approach, Label, Row, Table};

/// What a rig needs to go to a contact and to load it, unless its user knows better.
pub const REACH_S: f64 = 4.0;

/// A stage's step, and a balance's: places and forces are whole multiples.
const STEPS_PER_MM: f64 = 100.0;
const STEPS_PER_N: f64 = 1000.0;

/// Duration of a plan, with [`REACH_S`] for each contact and each trial.
pub fn duration_s(plan: &Table) -> f64 {
    let mut duration_s = 0.0;
    let mut trial = None;
    let mut before_s = 0.0;
    for row in &plan.rows {
        let t_s = row.t_s.unwrap_or_default();
        let goes_on = row.trial.is_some() && row.trial == trial;
        duration_s += if goes_on { t_s - before_s } else { REACH_S + row.dwell_s.unwrap_or_default() };
        (trial, before_s) = (row.trial, t_s);
    }
    duration_s
}

/// Where rows are, in mm: each place once, in the order in which they first come.
pub fn distinct_places<'r>(rows: impl Iterator<Item = &'r Row>) -> Vec<[f64; 2]> {
    let mut distinct = Vec::new();
    for place in rows.map(|row| [row.label.x_mm, row.label.y_mm]) {
        if !distinct.contains(&place) {
            distinct.push(place);
        }
    }
    distinct
}

/// A plan as far as it is written.
struct PlanDraft {
    table: Table,
    dwell_s: f64,
}

/// A force by its magnitude and direction.
#[derive(Clone, Copy, Debug)]
struct Load {
    magnitude_n: f64,
    /// From straight down.
    tilt_deg: f64,
    /// Of the shear, counter-clockwise from +x.
    azimuth_deg: f64,
}

impl PlanDraft {
    /// An empty plan whose zeros last for this time.
    fn new(dwell_s: f64) -> Self {
        Self { table: Table { sessions: vec![ZERO.to_owned()], ..Table::default() }, dwell_s }
    }

    /// Adds a static contact for this purpose.
    fn press(&mut self, session: &str, label: Label, approach: Approach, dwell_s: f64) {
        let session = Some(self.session(session));
        let row = Row { session, approach: Some(approach), dwell_s: Some(dwell_s), ..Row::of(label) };
        self.table.rows.push(row);
    }

    /// Adds a static reading of the untouched pad.
    fn zero(&mut self) {
        let row = Row { session: Some(0), dwell_s: Some(self.dwell_s), ..Row::of(Label::default()) };
        self.table.rows.push(row);
    }

    /// Adds a time series of normal force at one place.
    fn trial(
        &mut self,
        name: &str,
        session: &str,
        place_mm: [f64; 2],
        series: impl IntoIterator<Item = [f64; 2]>,
    ) {
        let session = Some(self.session(session));
        let trial = Some(self.table.trials.len());
        self.table.trials.push(name.to_owned());
        let rows = series.into_iter().map(|[t_s, force_n]| {
            let label = label(place_mm, Load::normal(force_n));
            Row { trial, session, t_s: Some(t_s), ..Row::of(label) }
        });
        self.table.rows.extend(rows);
    }

    fn session(&mut self, name: &str) -> usize {
        let known = self.table.sessions.iter().position(|known| known == name);
        known.unwrap_or_else(|| {
            self.table.sessions.push(name.to_owned());
            self.table.sessions.len() - 1
        })
    }
}

impl Load {
    const fn normal(magnitude_n: f64) -> Self {
        Self { magnitude_n, tilt_deg: 0.0, azimuth_deg: 0.0 }
    }

    fn force_n(self) -> [f64; 3] {
        let [sin, cos] = direction(self.azimuth_deg);
        let [tangential, normal] = direction(self.tilt_deg);
        [tangential * cos, tangential * sin, normal].map(|share| self.magnitude_n * share)
    }
}

/// Sine and cosine.
fn direction(deg: f64) -> [f64; 2] {
    let rad = deg * PI / 180.0;
    [libm::sin(rad), libm::cos(rad)]
}

/// The place at this distance from the centre.
fn polar_mm(radius_mm: f64, deg: f64) -> [f64; 2] {
    let [sin, cos] = direction(deg);
    [radius_mm * cos, radius_mm * sin]
}

/// A contact in the rig's steps.
fn label(place_mm: [f64; 2], load: Load) -> Label {
    let [x_mm, y_mm] = place_mm.map(cut_mm);
    // The sum has no −0.
    let [fx_n, fy_n, fz_n] =
        load.force_n().map(|newtons| (newtons * STEPS_PER_N).round() / STEPS_PER_N + 0.0);
    Label { x_mm, y_mm, fx_n, fy_n, fz_n }
}

/// Whole steps of a coordinate. They are cut, never rounded up: a place on the last circle must not leave it.
fn cut_mm(mm: f64) -> f64 {
    let steps = mm * STEPS_PER_MM;
    // What lacks only its last bits lacks no step.
    let whole = if (steps - steps.round()).abs() < 1e-6 { steps.round() } else { steps.trunc() };
    whole / STEPS_PER_MM + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_are_those_of_the_papers_formula() {
        let load = Load { magnitude_n: 5.0, tilt_deg: 60.0, azimuth_deg: 120.0 };
        let label = label([29.0, -0.004], load);
        let wanted = Label { x_mm: 29.0, y_mm: 0.0, fx_n: -2.165, fy_n: 3.75, fz_n: 2.5 };
        assert_eq!(label, wanted);
        assert!(label.y_mm.is_sign_positive());
    }

    #[test]
    fn places_are_cut_towards_the_centre() {
        for (mm, wanted) in
            [(0.29, 0.29), (-4.8333, -4.83), (4.839_999, 4.83), (-0.009, 0.0), (28.999_999_999, 29.0)]
        {
            assert_eq!(cut_mm(mm), wanted, "{mm}");
        }
    }

    #[test]
    fn a_plan_takes_its_dwells_its_series_and_the_ways_between() {
        let mut draft = PlanDraft::new(2.0);
        draft.zero();
        draft.press("a", Label::default(), Approach::Loading, 20.0);
        for name in ["one", "two"] {
            draft.trial(name, "b", [0.0; 2], [[0.0, 0.0], [1.5, 1.0], [10.0, 2.0]]);
        }
        assert_eq!(duration_s(&draft.table), 4.0 * REACH_S + 2.0 + 20.0 + 2.0 * 10.0);
        assert_eq!(draft.table.sessions, [ZERO, "a", "b"]);
        assert_eq!(duration_s(&Table::default()), 0.0);
    }
}
