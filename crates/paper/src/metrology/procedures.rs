//! The procedures by which the paper's figures are measured, as one plan.
//!
//! The paper gives loads, places and counts, where it says anything; rates, durations and the order are ours,
//! and `docs/metrology.md` tells them apart. Sessions name the procedures for people: nothing looks for them
//! by name.

use tactpad_core::pad::device::Patch;
use tactpad_core::tables::measured::{Label, Row, Table};
use tactpad_core::tables::plans::paper::places_mm;

use super::{FULL_SCALE_N, holding, location};

/// Samples a second of a series: the authors' earlier pad gave 40 to 50.
pub(super) const RATE_HZ: f64 = 45.0;

/// Everything but the temperature sweep is done at this temperature.
const ROOM_C: f64 = 25.0;

/// The sweep of the paper's Figure 8.
const SWEEP_C: [f64; 7] = [-10.0, 0.0, 10.0, 20.0, 30.0, 40.0, 50.0];
const SWEEP_READINGS: usize = 5;

/// Cycles of the repeatability test.
const REPEATED: usize = 100;

/// Trials of the hysteresis test, and the time of each, up and down.
const TRIALS: usize = 10;
const TRIAL_S: f64 = 20.0;

/// Presses of the model's comparison between two zeros.
const PRESSES_PER_ZERO: usize = 10;

/// Cycles after which the endurance test reads.
const ENDURED: [f64; 6] = [0.0, 100.0, 1_000.0, 10_000.0, 25_000.0, 50_000.0];
const ENDURED_N: f64 = 1.0;

/// Where the spread of location is looked at; the paper does not say.
const HELD_AT_MM: [f64; 2] = [12.0, 5.0];
const HELD_S: f64 = 10.0;

/// The load whose resolution is found, and for how long.
const RESOLVED_N: f64 = 1.0;
const RESOLVED_S: f64 = 60.0;

/// Steps of load.
const STEPS: usize = 5;
const STEP_N: f64 = 2.0;
const STEP_S: f64 = 2.0;

/// Time for which each load of the task is held.
const TASK_S: f64 = 5.0;

/// No load, before and after the loads of a trial.
const REST_S: f64 = 2.0;

/// Rings of places at which the decoded drift is found, with six places each.
const RINGS_MM: [f64; 2] = [10.0, 20.0];

/// Dwell of a static load before it is read.
const DWELL_S: f64 = 2.0;

/// All procedures, one after the other. The endurance test is the last one and begins with a new pad: its
/// cycles count from zero.
pub fn plan(patch: &Patch) -> Table {
    let mut plan = Plan { table: Table::default(), temp_c: ROOM_C };
    plan.resolution();
    plan.repeatability();
    plan.model(patch);
    plan.series();
    plan.sweep();
    plan.decoded_drift();
    plan.endurance();
    plan.table
}

/// A plan as far as it is written.
struct Plan {
    table: Table,
    temp_c: f64,
}

impl Plan {
    /// The first of all: a pad that crept under other loads is still on its way back.
    fn resolution(&mut self) {
        self.session("force resolution");
        self.trial("no load", [0.0; 2], RESOLVED_S, |_| 0.0);
        self.trial("1 N held", [0.0; 2], RESOLVED_S, |_| RESOLVED_N);
    }

    /// The paper's 5 N, 100 times at the centre, with a zero before and after each.
    fn repeatability(&mut self) {
        self.session("repeatability");
        for cycle in 0..REPEATED {
            self.counted(Label::default(), cycle as f64);
            self.counted(press([0.0; 2], FULL_SCALE_N), cycle as f64);
        }
        self.counted(Label::default(), REPEATED as f64);
    }

    /// The paper's 1 N at 73 places.
    fn model(&mut self, patch: &Patch) {
        self.session("model against pad");
        for places in places_mm(patch).chunks(PRESSES_PER_ZERO) {
            self.add(Label::default());
            places.iter().for_each(|place_mm| self.add(press(*place_mm, 1.0)));
        }
        self.add(Label::default());
    }

    /// The time series.
    fn series(&mut self) {
        self.session("hysteresis");
        let triangle = |t_s: f64| FULL_SCALE_N * (1.0 - (2.0 * t_s / TRIAL_S - 1.0).abs());
        (1..=TRIALS).for_each(|trial| self.trial(&format!("loop {trial}"), [0.0; 2], TRIAL_S, triangle));
        self.session("spread of location");
        for load_n in location::LOADS_N {
            self.trial(&format!("{load_n} N stays"), HELD_AT_MM, HELD_S, |_| load_n);
        }
        self.session("step response");
        (1..=STEPS).for_each(|step| self.trial(&format!("step {step}"), [0.0; 2], STEP_S, |_| STEP_N));
        self.session("force holding");
        let loads_n = holding::LOADS_N;
        let held = |t_s: f64| loads_n.get((t_s / TASK_S) as usize).copied().unwrap_or(FULL_SCALE_N);
        self.trial("1, 3 and 5 N", [0.0; 2], TASK_S * loads_n.len() as f64, held);
    }

    /// The paper's temperatures, without load.
    fn sweep(&mut self) {
        self.session("temperature");
        for temp_c in SWEEP_C {
            self.temp_c = temp_c;
            (0..SWEEP_READINGS).for_each(|_| self.add(Label::default()));
        }
    }

    /// The same contacts at room temperature, colder and warmer; zeros only at room temperature.
    fn decoded_drift(&mut self) {
        self.session("decoded drift");
        for change_c in [0.0, -10.0, 10.0] {
            self.temp_c = ROOM_C + change_c;
            if change_c == 0.0 {
                (0..SWEEP_READINGS).for_each(|_| self.add(Label::default()));
            }
            for place_mm in ring_places_mm() {
                contacts(place_mm).into_iter().for_each(|contact| self.add(contact));
            }
        }
        self.temp_c = ROOM_C;
    }

    /// The paper's 1 N, with readings on the way.
    fn endurance(&mut self) {
        self.session("endurance, a new pad");
        for cycle in ENDURED {
            self.counted(Label::default(), cycle);
            self.counted(press([0.0; 2], ENDURED_N), cycle);
        }
    }

    /// Rows from here on belong to this procedure.
    fn session(&mut self, name: &str) {
        self.table.sessions.push(name.to_owned());
    }

    fn row(&self, label: Label) -> Row {
        let session = self.table.sessions.len().checked_sub(1);
        Row { session, temp_c: Some(self.temp_c), ..Row::of(label) }
    }

    /// A static load.
    fn add(&mut self, label: Label) {
        let row = Row { dwell_s: Some(DWELL_S), ..self.row(label) };
        self.table.rows.push(row);
    }

    /// A static load of a pad with this number of cycles behind it.
    fn counted(&mut self, label: Label, cycle: f64) {
        let row = Row { cycle: Some(cycle), dwell_s: Some(DWELL_S), ..self.row(label) };
        self.table.rows.push(row);
    }

    /// A series at one place: rest, the load by the time since it began, rest.
    fn trial(&mut self, name: &str, place_mm: [f64; 2], seconds: f64, load_n: impl Fn(f64) -> f64) {
        let trial = Some(self.table.trials.len());
        self.table.trials.push(name.to_owned());
        let samples = ((seconds + 2.0 * REST_S) * RATE_HZ) as usize;
        for sample in 0..samples {
            // Whole microseconds, as streams have them.
            let t_s = (1e6 * sample as f64 / RATE_HZ).round() / 1e6;
            let loaded_s = sample as f64 / RATE_HZ - REST_S;
            let fz_n = if (0.0..seconds).contains(&loaded_s) { load_n(loaded_s) } else { 0.0 };
            let row = Row { trial, t_s: Some(t_s), ..self.row(press(place_mm, fz_n)) };
            self.table.rows.push(row);
        }
    }
}

const fn press([x_mm, y_mm]: [f64; 2], fz_n: f64) -> Label {
    Label { x_mm, y_mm, fx_n: 0.0, fy_n: 0.0, fz_n }
}

/// The centre and the places of the rings.
fn ring_places_mm() -> Vec<[f64; 2]> {
    let ring =
        |radius_mm: f64| (0..6).map(move |k| direction(60.0 * f64::from(k)).map(|share| share * radius_mm));
    [[0.0; 2]].into_iter().chain(RINGS_MM.into_iter().flat_map(ring)).collect()
}

/// As in the paper's calibration: 1, 3 and 5 N pressing, and 3 N tilted by 30° in three directions.
fn contacts(place_mm: [f64; 2]) -> Vec<Label> {
    let normal = [1.0, 3.0, FULL_SCALE_N].map(|fz_n| press(place_mm, fz_n));
    let tilted = [0.0, 120.0, 240.0].map(|azimuth_deg| {
        let ([fz, shear], [x, y]) = (direction(30.0), direction(azimuth_deg));
        Label { fx_n: 3.0 * shear * x, fy_n: 3.0 * shear * y, ..press(place_mm, 3.0 * fz) }
    });
    normal.into_iter().chain(tilted).collect()
}

/// Cosine and sine; no platform's own, so that a plan is the same everywhere.
fn direction(deg: f64) -> [f64; 2] {
    [libm::cos(deg.to_radians()), libm::sin(deg.to_radians())]
}

#[cfg(test)]
mod tests {
    use super::super::Needs;
    use super::super::figures::{Evidence, Figures};
    use super::super::output::is_z;
    use super::super::report::{ReportEntry, Status, entries};
    use super::*;
    use tactpad_core::pad::influence::{InfluenceField, MAPS};
    use tactpad_core::quantity::CHANNELS;

    const PATCH: Patch =
        Patch { patch_radius_mm: 1.0, max_centre_radius_mm: 29.0, full_scale_n: FULL_SCALE_N };
    const Z_UV_PER_N: f64 = 300.0;
    const XY_UV_PER_N: f64 = 100.0;

    fn signals() -> InfluenceField {
        InfluenceField::sampled(5.0, 29.0, 30.0, |_| {
            std::array::from_fn::<f64, MAPS, _>(|map| match (map / 3, map % 3) {
                (channel, 2) => {
                    if is_z(channel) {
                        Z_UV_PER_N
                    } else {
                        XY_UV_PER_N
                    }
                }
                _ => 0.0,
            })
        })
    }

    /// What a pad adds that has just the faults that the paper published, in newtons: hysteresis and flicker.
    fn added_n(row: &Row, is_falling: bool) -> f64 {
        let fz_n = row.label.fz_n;
        let turn = |number: f64| if number.rem_euclid(2.0) < 1.0 { 1.0 } else { -1.0 };
        let hysteresis = if is_falling && (0.5..4.5).contains(&fz_n) { 0.031 * FULL_SCALE_N } else { 0.0 };
        // The first trial is the one without load.
        let flicker = if row.trial == Some(0) { 5e-3 / 3.605 * turn(row.t_s.unwrap() - REST_S) } else { 0.0 };
        let scatter =
            if fz_n == FULL_SCALE_N { 0.013 * FULL_SCALE_N * turn(row.cycle.unwrap_or(0.0)) } else { 0.0 };
        hysteresis + flicker + scatter
    }

    fn measured(plan: &Table) -> Table {
        let mut before_n = 0.0;
        let measure = |row: &Row| {
            let is_falling = row.trial.is_some() && row.label.fz_n < before_n;
            let output_n = row.label.fz_n + added_n(row, is_falling);
            before_n = row.label.fz_n;
            let left = 1.0 - 0.19 * row.cycle.unwrap_or(0.0) / 50_000.0;
            let uv = std::array::from_fn::<f64, CHANNELS, _>(|channel| {
                let gain = if is_z(channel) { 1.11 * Z_UV_PER_N } else { 0.68 * XY_UV_PER_N };
                40.0 + 30.0 * (row.temp_c.unwrap() - ROOM_C) + left * gain * output_n
            });
            Row { uv: Some(uv), ..*row }
        };
        Table { rows: plan.rows.iter().map(measure).collect(), ..plan.clone() }
    }

    fn found() -> Vec<ReportEntry> {
        let (table, signals) = (measured(&plan(&PATCH)), signals());
        let evidence = Evidence { table: &table, signals: &signals, decoder: None, simulation: None };
        entries(&[Figures::of(&evidence)], &[])
    }

    #[test]
    fn a_pad_with_the_published_faults_has_the_published_figures() {
        for entry in found().iter().filter(|entry| entry.paper.is_some() && entry.mean.is_some()) {
            // The hysteresis gap and the rest of the loop share a trial's calibration; the others are as
            // exact.
            assert!(entry.difference_percent.unwrap().abs() < 2.0, "{entry:?}");
            assert_eq!(entry.status, Status::Inside);
        }
    }

    #[test]
    fn the_plan_leaves_nothing_open_but_what_needs_a_decoder() {
        for entry in found().iter().filter(|entry| entry.mean.is_none()) {
            assert!(!matches!(entry.needs, Some(Needs::Rows(_)) | None), "{entry:?}");
        }
        assert_eq!(found().iter().filter(|entry| entry.mean.is_none()).count(), 15);
    }

    #[test]
    fn counts_are_the_papers() {
        let plan = plan(&PATCH);
        let of = |name: &str| {
            let session = plan.sessions.iter().position(|session| session == name);
            plan.rows.iter().filter(move |row| row.session == session).collect::<Vec<_>>()
        };
        let loads = |name: &str| of(name).iter().filter(|row| row.label.fz_n > 0.0).count();
        assert_eq!((loads("repeatability"), loads("model against pad")), (100, 73));
        assert_eq!((of("temperature").len(), loads("temperature")), (35, 0));
        assert_eq!(loads("decoded drift"), 3 * 13 * 6);
        assert_eq!(plan.trials.iter().filter(|name| name.starts_with("loop")).count(), 10);
        assert_eq!(of("endurance, a new pad").last().unwrap().cycle, Some(50_000.0));
        assert!(plan.rows.iter().all(|row| row.uv.is_none() && row.label.x_mm.hypot(row.label.y_mm) <= 29.0));
    }
}
