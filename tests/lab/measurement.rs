//! The twin carries out plans: what a row of a measured table is, and how faults of pad and rig show in it.

use std::sync::OnceLock;

use tactpad::lab::rig::measurement::{Measurement, carry_on, carry_out};
use tactpad::numeric::memory::{PlayOperator, Relaxation};
use tactpad::pad::device::Device;
use tactpad::pad::device::behaviour::{Behaviour, OnChannels};
use tactpad::pad::field::PadField;
use tactpad::pad::twin::life::Life;
use tactpad::quantity::{CHANNELS, Contact};
use tactpad::tables::measured::{Approach, Label, Row, Table};
use tactpad::tables::plans;

const PRESS: Label = Label { x_mm: 4.0, y_mm: -6.0, fx_n: 0.5, fy_n: 0.0, fz_n: 2.0 };

fn field() -> &'static PadField {
    static FIELD: OnceLock<PadField> = OnceLock::new();
    FIELD.get_or_init(PadField::nominal)
}

fn measured(rows: Vec<Row>, seed: u64, change: impl Fn(&mut Behaviour)) -> Measurement {
    let mut device = Device::nominal();
    change(&mut device.behaviour);
    let plan = Table { rows, trials: vec!["one".to_owned(), "two".to_owned()], ..Table::default() };
    carry_out(&plan, &device, field(), seed)
}

fn ideal_uv(label: Label) -> [f64; CHANNELS] {
    field().signals.strain_uv(&Contact::from(label)).uv.map(f64::from)
}

fn assert_near(found: f64, wanted: f64, tolerance: f64, what: &str) {
    assert!((found - wanted).abs() <= tolerance, "{what}: {found} instead of {wanted}");
}

#[test]
fn a_perfect_pad_on_a_perfect_rig_reads_the_simulation() {
    let rows = vec![Row::of(PRESS), Row::of(Label { x_mm: -20.0, ..PRESS })];
    let Measurement { table, truth, .. } = measured(rows, 1, |_| ());
    for (row, truth) in table.rows.iter().zip(&truth) {
        assert_eq!((row.label, *truth), (row.label, row.label));
        let ideal_uv = ideal_uv(row.label);
        row.uv
            .unwrap()
            .iter()
            .zip(ideal_uv)
            .for_each(|(found, ideal)| assert_near(*found, ideal, 1e-3, "channel"));
    }
    let times: Vec<f64> = table.rows.iter().map(|row| row.t_s.unwrap()).collect();
    assert_eq!(times, [5.0, 10.0], "lifted, rested, pressed, held, read for a second");
}

#[test]
fn each_load_is_a_cycle_that_a_rig_can_count() {
    let untouched = Row::of(Label { fx_n: 0.0, fz_n: 0.0, ..PRESS });
    let pressed = Row::of(PRESS);
    let counted = measured(vec![pressed, untouched, pressed], 1, |_| ()).counted();
    let cycles: Vec<Option<f64>> = counted.table.rows.iter().map(|row| row.cycle).collect();
    assert_eq!(cycles, [Some(1.0), Some(1.0), Some(2.0)]);
    // A plan that says how many loads are behind a row is kept to.
    let aged = measured(vec![Row { cycle: Some(900.0), ..pressed }, pressed], 1, |_| ());
    assert_eq!(aged.cycles, [900.0, 901.0]);
    assert_eq!(aged.table.rows[1].cycle, None, "what nobody counted is not written");
}

#[test]
fn dwell_and_approach_show_creep_and_hysteresis() {
    let row = |dwell_s: f64, approach: Approach| Row {
        dwell_s: Some(dwell_s),
        approach: Some(approach),
        ..Row::of(PRESS)
    };
    let hysteresis = |it: &mut Behaviour| {
        it.hysteresis = vec![OnChannels::all(PlayOperator { threshold: 100.0, share: 0.2 })];
    };
    let rows = vec![row(1.0, Approach::Loading), row(1.0, Approach::Unloading)];
    let Measurement { table, .. } = measured(rows, 1, hysteresis);
    let [up, down] = [0, 1].map(|index: usize| table.rows[index].uv.unwrap()[2]);
    assert!(ideal_uv(PRESS)[2] > 200.0);
    assert_near(down - up, 40.0, 1e-6, "the loop's width");
    let creep = |it: &mut Behaviour| it.creep = vec![OnChannels::all(Relaxation { time_s: 4.0, share: 0.1 })];
    let rows = vec![row(1.0, Approach::Loading), row(400.0, Approach::Loading)];
    let Measurement { table, .. } = measured(rows, 1, creep);
    let [soon, late] = [0, 1].map(|index: usize| table.rows[index].uv.unwrap()[2] / ideal_uv(PRESS)[2]);
    assert_near(late, 1.1, 1e-6, "crept");
    // A ramp of half a second, a second held, the mean over the next.
    let crept = |after_ramp_s: f64| {
        1.0 - 4.0 / 0.5 * ((0.5_f64 / 4.0).exp() - 1.0) * (-(after_ramp_s + 0.5) / 4.0).exp()
    };
    let mean = (1..=45).map(|reading| crept(1.0 + f64::from(reading) / 45.0)).sum::<f64>() / 45.0;
    assert_near(soon, 1.0 + 0.1 * mean, 1e-6, "on its way");
}

/// A ramp of Fz over two seconds, a hundred readings a second.
fn ramp(trial: usize) -> Vec<Row> {
    let row = |step: u32| Row {
        trial: Some(trial),
        t_s: Some(f64::from(step) / 100.0),
        ..Row::of(Label { fz_n: f64::from(step) / 100.0, ..PRESS })
    };
    (0..=200).map(row).collect()
}

#[test]
fn late_labels_tell_the_past() {
    let Measurement { table, truth, .. } = measured(ramp(0), 1, |it| it.rig.label_lag_ms = 35.0);
    for (index, row) in table.rows.iter().enumerate().skip(10) {
        assert_near(truth[index].fz_n, index as f64 / 100.0, 1e-6, "truth");
        assert_near(row.label.fz_n, index as f64 / 100.0 - 0.035, 1e-6, "label");
    }
}

#[test]
fn series_keep_their_steps_and_the_clock_goes_on() {
    let Measurement { table, .. } = measured([ramp(0), ramp(1)].concat(), 1, |_| ());
    let times: Vec<f64> = table.rows.iter().map(|row| row.t_s.unwrap()).collect();
    assert!(times.windows(2).all(|pair| pair[1] > pair[0]));
    assert!(times[1..=200].iter().zip(&times).all(|(next, time)| (next - time - 0.01).abs() < 1e-6));
    assert!(times[201] - times[200] > 2.0, "the pad rests between two trials");
}

#[test]
fn stage_and_reference_are_wrong_as_said() {
    let change = |it: &mut Behaviour| {
        (it.rig.stage_x_mm, it.rig.reference_gain, it.rig.reference_zero_n) = (0.3, 1.1, [0.0, 0.2, 0.0]);
    };
    let Measurement { table, truth, .. } = measured(vec![Row::of(PRESS)], 1, change);
    assert_eq!(truth[0], Label { x_mm: 4.3, ..PRESS });
    let written = table.rows[0].label;
    assert_near(written.x_mm, 4.0, 1e-9, "x");
    assert_near(written.fx_n, 0.55, 1e-6, "fx");
    assert_near(written.fy_n, 0.2, 1e-6, "fy");
    let ideal_uv = ideal_uv(truth[0]);
    assert_near(table.rows[0].uv.unwrap()[2], ideal_uv[2], 1e-3, "the channels know the truth");
}

#[test]
fn temperature_waits_and_cycles_count() {
    let change = |it: &mut Behaviour| {
        it.thermal.zero_uv_per_c = [30.0; CHANNELS];
        it.ageing.share = [0.19; CHANNELS];
    };
    let rows = vec![
        Row { temp_c: Some(35.0), ..Row::of(Label { fx_n: 0.0, fz_n: 0.0, ..PRESS }) },
        Row { cycle: Some(50_000.0), ..Row::of(PRESS) },
    ];
    let Measurement { table, .. } = measured(rows, 1, change);
    assert_near(table.rows[0].uv.unwrap()[0], 300.0, 1e-6, "warm");
    assert!(table.rows[0].t_s.unwrap() > 1800.0);
    assert_near(table.rows[1].uv.unwrap()[2], 0.81 * ideal_uv(PRESS)[2], 1e-3, "old, and cool again");
    assert!(table.rows[1].t_s.unwrap() > 50_000.0);
}

#[test]
fn truth_stays_on_the_plate_and_seeds_decide() {
    let patch = Device::nominal().contact;
    let plan = plans::paper::plan(&patch);
    let wander = |it: &mut Behaviour| {
        it.finger.wander_mm = 0.5;
        it.noise.additive_uv = [10.0; CHANNELS];
    };
    let run = |seed: u64| measured(plan.rows.clone(), seed, wander);
    let one = run(3);
    assert!(one.truth.iter().all(|truth| truth.x_mm.hypot(truth.y_mm) <= patch.max_centre_radius_mm + 1e-4));
    assert_eq!(one, run(3));
    assert_ne!(one.table, run(4).table);
}

/// A pad that remembers, drifts and ages, under a hand and on a rig that draw nothing.
fn remembering() -> Device {
    let mut device = Device::nominal();
    let it = &mut device.behaviour;
    it.hysteresis = vec![OnChannels::all(PlayOperator { threshold: 100.0, share: 0.2 })];
    it.creep = vec![OnChannels::all(Relaxation { time_s: 30.0, share: 0.1 })];
    it.noise.additive_uv = [10.0; CHANNELS];
    it.noise.walk_uv = [300.0; CHANNELS];
    it.ageing.share = [0.19; CHANNELS];
    device
}

fn plan_of(rows: &[Row]) -> Table {
    Table { rows: rows.to_vec(), trials: vec!["one".to_owned(), "two".to_owned()], ..Table::default() }
}

#[test]
fn a_plan_cut_in_two_is_one_life_of_one_pad() {
    let device = remembering();
    let rows: Vec<Row> = (0..6)
        .map(|index: i32| {
            Row::of(Label { x_mm: 4.0 * f64::from(index - 3), fz_n: f64::from(index % 3 + 1), ..PRESS })
        })
        .chain(ramp(0))
        .collect();
    let whole = carry_out(&plan_of(&rows), &device, field(), 5);
    let (first, second) = rows.split_at(4);
    let (before, life) = carry_on(&plan_of(first), &device, field(), Life::new(&device, 5), 5);
    let life = Life::from_bytes(&life.to_bytes(&device), &device).unwrap();
    // The later seed draws another hand and another rig; these draw nothing, and the pad is the same.
    let (after, life) = carry_on(&plan_of(second), &device, field(), life, 6);
    let channels = |of: &Measurement| of.table.rows.iter().map(|row| row.uv).collect::<Vec<_>>();
    assert_eq!([channels(&before), channels(&after)].concat(), channels(&whole), "bit by bit");
    assert_eq!([&before.cycles[..], &after.cycles].concat(), whole.cycles, "loads go on being counted");
    assert_eq!((after.cycles[0], life.around.cycles), (5.0, 7.0));
    let begins_s = [before, after].map(|part| part.table.rows[0].t_s.unwrap());
    assert_eq!(begins_s, [5.0, 5.0], "each table has its own time");
}

#[test]
fn what_was_pressed_before_is_seen_afterwards() {
    let mut device = remembering();
    (device.behaviour.noise.additive_uv, device.behaviour.noise.walk_uv) = ([0.0; CHANNELS], [0.0; CHANNELS]);
    let untouched = plan_of(&[Row::of(Label { fx_n: 0.0, fz_n: 0.0, ..PRESS })]);
    let pressed = plan_of(&[Row { dwell_s: Some(60.0), ..Row::of(PRESS) }]);
    let zero_uv = |life: Life| carry_on(&untouched, &device, field(), life, 2).0.table.rows[0].uv.unwrap()[2];
    assert_eq!(zero_uv(Life::new(&device, 2)), 0.0);
    let (_, life) = carry_on(&pressed, &device, field(), Life::new(&device, 2), 2);
    // What friction keeps is share · threshold; creep adds what is left of a tenth of the strain.
    let left_uv = zero_uv(life) - 0.2 * 100.0;
    assert!(left_uv > 0.05 * ideal_uv(PRESS)[2] && left_uv < 0.1 * ideal_uv(PRESS)[2], "{left_uv}");
}

#[test]
fn planned_times_count_from_the_runs_begin() {
    let device = remembering();
    let planned = plan_of(&[Row { t_s: Some(40.0), ..Row::of(PRESS) }]);
    let (first, life) = carry_on(&planned, &device, field(), Life::new(&device, 2), 2);
    let (second, life) = carry_on(&planned, &device, field(), life, 2);
    let times = [&first, &second].map(|part| part.table.rows[0].t_s);
    assert_eq!(times[0], times[1]);
    assert_near(life.state.age_s(), 2.0 * times[0].unwrap(), 1e-6, "the pad's own clock goes on");
}
