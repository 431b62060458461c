//! The twin carries out a plan: labels as a reference would write them, channels as the pad would read, and the truth.
//!
//! A row without trial is a static sample: lift, rest, press, hold, read the mean of a second. Rows of one trial are one
//! approach, read row by row at their times. The clock goes on over all of it, as do creep, hysteresis and drift.

use crate::rig::stage::LoadingStage;
use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::PadField;
use tactpad_core::pad::twin::hand::Hand;
use tactpad_core::pad::twin::life::{CYCLE_S, Life};
use tactpad_core::pad::twin::pad::{Circumstances, TwinPad};
use tactpad_core::quantity::{CHANNELS, Contact};
use tactpad_core::tables::measured::{Approach, DWELL_S, Label, Row, Table};

/// Sampling rate where the plan has no times: the authors' earlier pad gave 40 to 50 samples a second.
pub const RATE_HZ: f64 = 45.0;
/// Readings whose mean is a static sample: those of a second.
pub(super) const READINGS: u32 = 45;
/// Rest between two contacts.
const REST_S: f64 = 2.0;
/// Time in which a load comes, or goes.
const RAMP_S: f64 = 0.5;
/// Wait at a new temperature.
const SOAK_S: f64 = 1800.0;
const UNTOUCHED: Label = Label { x_mm: 0.0, y_mm: 0.0, fx_n: 0.0, fy_n: 0.0, fz_n: 0.0 };

/// A plan, carried out.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// The plan's rows with times, written labels and channels.
    pub table: Table,
    /// The true contact of each row.
    pub truth: Vec<Label>,
    /// The cycles of load up to each row, its own among them.
    pub cycles: Vec<f64>,
}

impl Measurement {
    /// The table with the cycles of load, as a rig can count them.
    pub fn counted(mut self) -> Self {
        self.table.rows.iter_mut().zip(&self.cycles).for_each(|(row, cycles)| row.cycle = Some(*cycles));
        self
    }
}

/// Carries out a plan on a new pad of `device`, whose field is `field`; the seed draws the pad, the hand and the rig.
pub fn carry_out(plan: &Table, device: &Device, field: &PadField, seed: u64) -> Measurement {
    carry_on(plan, device, field, Life::new(device, seed), seed).0
}

/// Carries out a plan on a pad that has a life behind it, and gives the life after it; the seed draws the hand and the rig.
///
/// Times are counted from the plan's begin, cycles over the whole life. A planned `cycle` is the pad's from then on, also where
/// it had more before.
pub fn carry_on(
    plan: &Table,
    device: &Device,
    field: &PadField,
    life: Life,
    seed: u64,
) -> (Measurement, Life) {
    let mut bench = Bench::new(device, field, life, seed);
    let mut measurement = Measurement {
        table: Table { rows: Vec::with_capacity(plan.rows.len()), ..plan.clone() },
        truth: Vec::with_capacity(plan.rows.len()),
        cycles: Vec::with_capacity(plan.rows.len()),
    };
    for rows in plan.rows.chunk_by(|one, next| one.trial.is_some() && one.trial == next.trial) {
        match rows {
            [row] if row.trial.is_none() => bench.static_sample(row, &mut measurement),
            rows => bench.series(rows, &mut measurement),
        }
    }
    (measurement, Life { state: bench.pad.into_state(), around: bench.around })
}

struct Bench {
    pad: TwinPad,
    hand: Hand,
    stage: LoadingStage,
    around: Circumstances,
    reference_c: f64,
    full_scale_n: f64,
    /// The farthest contact's distance from the axis.
    reach_mm: f32,
    lag_s: f64,
    at_s: f64,
}

impl Bench {
    fn new(device: &Device, field: &PadField, life: Life, seed: u64) -> Self {
        let behaviour = &device.behaviour;
        Self {
            pad: TwinPad::going_on(device, field, life.state),
            hand: Hand::new(behaviour.finger, seed),
            stage: LoadingStage::new(behaviour.rig, seed),
            around: life.around,
            reference_c: behaviour.thermal.reference_c,
            full_scale_n: device.contact.full_scale_n,
            reach_mm: device.contact.max_centre_radius_mm as f32,
            lag_s: behaviour.rig.label_lag_ms * 1e-3,
            at_s: 0.0,
        }
    }

    /// The true contact and the channels `after_s` later, when this contact is meant.
    fn touch(&mut self, after_s: f64, meant: &Label) -> (Label, [f64; CHANNELS]) {
        self.at_s += after_s;
        let held = self.hand.hold(after_s, &self.stage.truth(meant).into());
        let truth = self.kept(held);
        (label(&truth), self.pad.read(after_s, &truth, &self.around))
    }

    /// The contact on the plate: an indenter does not press beyond the rim.
    fn kept(&self, contact: Contact) -> Contact {
        // (x, y)/max(1, r/reach).
        let beyond = libm::hypotf(contact.x_mm, contact.y_mm) / self.reach_mm;
        let [x_mm, y_mm] = [contact.x_mm, contact.y_mm].map(|mm| mm / beyond.max(1.0));
        Contact { x_mm, y_mm, ..contact }
    }

    /// Lifts, takes the circumstances of the row, and comes down on its contact anew.
    fn come_to(&mut self, row: &Row) {
        self.touch(RAMP_S, &UNTOUCHED);
        self.stage.set_up(row.turned_deg.unwrap_or(0.0), row.weight_g.is_some());
        let temperature_c = row.temp_c.unwrap_or(self.reference_c);
        if temperature_c != self.around.temperature_c {
            self.around.temperature_c = temperature_c;
            self.touch(SOAK_S, &UNTOUCHED);
        }
        let cycles =
            row.cycle.unwrap_or_else(|| self.around.cycles + f64::from(u8::from(is_loaded(&row.label))));
        // The row's own load is one of the cycles, so the rig makes up for all but that one.
        let counted_s = CYCLE_S * (cycles - self.around.cycles - 1.0).max(0.0);
        self.around.cycles = cycles;
        // Rest until the planned time less the ramp.
        let planned_s = row.t_s.map_or(0.0, |t_s| t_s - self.at_s - RAMP_S);
        self.touch(REST_S.max(counted_s).max(planned_s), &UNTOUCHED);
        self.stage.approach();
    }

    fn static_sample(&mut self, row: &Row, into: &mut Measurement) {
        self.come_to(row);
        if row.approach == Some(Approach::Unloading) {
            self.touch(RAMP_S, &self.overloaded(&row.label));
        }
        self.touch(RAMP_S, &row.label);
        self.touch(row.dwell_s.unwrap_or(DWELL_S), &row.label);
        let (mut truth, mut mean_uv) = (UNTOUCHED, [0.0; CHANNELS]);
        for _ in 0..READINGS {
            let (contact, uv) = self.touch(1.0 / RATE_HZ, &row.label);
            truth = plus(&truth, &contact, 1.0 / f64::from(READINGS));
            mean_uv.iter_mut().zip(uv).for_each(|(mean, uv)| *mean += uv / f64::from(READINGS));
        }
        let written = self.stage.written(&row.label, &truth);
        into.table.rows.push(Row {
            t_s: Some(whole_micros(self.at_s)),
            label: rounded(&written),
            uv: Some(mean_uv),
            ..*row
        });
        into.truth.push(rounded(&truth));
        into.cycles.push(self.around.cycles);
    }

    /// The load from which a static one is reached downwards.
    fn overloaded(&self, meant: &Label) -> Label {
        let factor = meant.overload(self.full_scale_n);
        Label { fx_n: factor * meant.fx_n, fy_n: factor * meant.fy_n, fz_n: factor * meant.fz_n, ..*meant }
    }

    fn series(&mut self, rows: &[Row], into: &mut Measurement) {
        let Some(first) = rows.first() else { return };
        self.come_to(first);
        if is_loaded(&first.label) {
            self.touch(RAMP_S, &first.label);
            self.touch(first.dwell_s.unwrap_or(DWELL_S), &first.label);
        }
        let begins_at = into.truth.len();
        let mut previous_s = first.t_s;
        for row in rows {
            let after_s = row.t_s.zip(previous_s).map_or(1.0 / RATE_HZ, |(t_s, previous_s)| t_s - previous_s);
            previous_s = row.t_s;
            let (truth, uv) = self.touch(after_s.max(0.0), &row.label);
            into.table.rows.push(Row { t_s: Some(whole_micros(self.at_s)), uv: Some(uv), ..*row });
            into.truth.push(rounded(&truth));
            into.cycles.push(self.around.cycles);
        }
        let (rows, truths) = (into.table.rows.split_at_mut(begins_at).1, into.truth.split_at(begins_at).1);
        self.write_labels(rows, truths);
    }

    /// Labels of a series: what the reference wrote, which was true the label's lag ago.
    fn write_labels(&mut self, rows: &mut [Row], truths: &[Label]) {
        let times: Vec<f64> = rows.iter().map(|row| row.t_s.unwrap_or(0.0)).collect();
        let meant: Vec<Label> = rows.iter().map(|row| row.label).collect();
        for (row, at_s) in rows.iter_mut().zip(&times) {
            let at_s = at_s - self.lag_s;
            row.label = rounded(&self.stage.written(&at(&times, &meant, at_s), &at(&times, truths, at_s)));
        }
    }
}

/// To whole millionths: further digits would say nothing and fill a file.
fn whole_micros(number: f64) -> f64 {
    libm::round(number * 1e6) / 1e6
}

fn rounded(label: &Label) -> Label {
    let [x_mm, y_mm, fx_n, fy_n, fz_n] =
        [label.x_mm, label.y_mm, label.fx_n, label.fy_n, label.fz_n].map(whole_micros);
    Label { x_mm, y_mm, fx_n, fy_n, fz_n }
}

fn is_loaded(label: &Label) -> bool {
    [label.fx_n, label.fy_n, label.fz_n].iter().any(|force_n| *force_n != 0.0)
}

fn label(contact: &Contact) -> Label {
    let [x_mm, y_mm, fx_n, fy_n, fz_n] =
        [contact.x_mm, contact.y_mm, contact.fx_n, contact.fy_n, contact.fz_n].map(f64::from);
    Label { x_mm, y_mm, fx_n, fy_n, fz_n }
}

/// `sum` and a multiple of another contact.
fn plus(sum: &Label, other: &Label, share: f64) -> Label {
    Label {
        x_mm: sum.x_mm + share * other.x_mm,
        y_mm: sum.y_mm + share * other.y_mm,
        fx_n: sum.fx_n + share * other.fx_n,
        fy_n: sum.fy_n + share * other.fy_n,
        fz_n: sum.fz_n + share * other.fz_n,
    }
}

/// A series at a time, linearly interpolated; beyond its ends, the nearest value.
fn at(times: &[f64], values: &[Label], at_s: f64) -> Label {
    let later = times.partition_point(|time_s| *time_s < at_s).min(values.len() - 1);
    let earlier = later.saturating_sub(1);
    let share = (at_s - times[earlier]) / (times[later] - times[earlier]);
    if !(0.0..1.0).contains(&share) {
        return values[if at_s < times[earlier] { earlier } else { later }];
    }
    // (1 − w) v₀ + w v₁ with w = (t − t₀)/(t₁ − t₀).
    plus(&plus(&UNTOUCHED, &values[earlier], 1.0 - share), &values[later], share)
}
