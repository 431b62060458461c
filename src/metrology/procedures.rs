//! The procedures by which the paper's figures are measured, as one plan.
//!
//! The paper gives loads, places and counts, where it says anything; rates, durations and the order are ours, and
//! `docs/metrology.md` tells them apart. Sessions name the procedures for people: nothing looks for them by name.

use crate::device::Patch;
use crate::measured::{Label, Row, Table};
use crate::protocol::paper::places_mm;

use super::{FULL_SCALE_N, holding, location};

/// Samples a second of a series: the authors' earlier pad gave 40 to 50.
const RATE_HZ: f64 = 45.0;

/// Everything but the temperature sweep is done at this temperature.
const ROOM_C: f64 = 25.0;

/// The sweep of the paper's Figure 8.
const SWEEP_C: [f64; 7] = [-10.0, 0.0, 10.0, 20.0, 30.0, 40.0, 50.0];
const SWEEP_READINGS: usize = 5;

/// Cycles of the repeatability test.
const REPEATED: usize = 100;

/// Trials of the hysteresis test, each up and down in so many seconds.
const TRIALS: usize = 10;
const TRIAL_S: f64 = 20.0;

/// Presses of the model's comparison between two zeros.
const PRESSES_PER_ZERO: usize = 10;

/// Readings of the endurance test, after so many cycles.
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

/// How long each load of the task is held.
const TASK_S: f64 = 5.0;

/// No load, before and after the loads of a trial.
const REST_S: f64 = 2.0;

/// Rings of places at which the decoded drift is found, with six places each.
const RINGS_MM: [f64; 2] = [10.0, 20.0];

/// How long a static load is held before it is read.
const DWELL_S: f64 = 2.0;

/// All procedures, one after the other, in about six hours. The endurance test is the last one and begins with a new
/// pad: its cycles count from zero.
pub fn plan(patch: &Patch) -> Table {
    let mut plan = Plan { table: Table::default(), temp_c: ROOM_C };
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
        self.session("force resolution");
        self.trial("1 N held", [0.0; 2], RESOLVED_S, |_| RESOLVED_N);
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

    /// A static load of a pad with so many cycles behind it.
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
