use super::*;
use crate::tangent::SimulatedPad;
use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::PadField;
use tactpad_core::pad::wiring::permutation::SignedPermutation;
use tactpad_core::quantity::{CHANNEL_NAMES, CHANNELS, Contact};
use tactpad_core::tables::convention::LabelConvention;
use tactpad_core::tables::measured::{Label, Row, Table};
use tactpad_numeric::random::SplitMix64;

const ROWS: usize = 240;

fn pad() -> (Device, PadField) {
    (Device::nominal(), PadField::nominal())
}

/// Contacts on a pad whose gains are off by 20 % and whose readings have noise, and readings of the untouched pad.
fn table(random: &mut SplitMix64, field: &PadField) -> Table {
    let mut uniform = |size: f64| size * f64::from(random.uniform());
    let gains: [f64; CHANNELS] = CHANNEL_NAMES.map(|_| 1.0 + uniform(0.2));
    let row = |at: usize| {
        let (radius_mm, angle) = (24.0 * uniform(1.0).abs().sqrt(), std::f64::consts::PI * uniform(1.0));
        let size = if at.is_multiple_of(10) { 0.0 } else { 1.0 };
        let label = Label {
            x_mm: radius_mm * libm::cos(angle),
            y_mm: radius_mm * libm::sin(angle),
            fx_n: size * uniform(0.7),
            fy_n: size * uniform(0.7),
            fz_n: size * (1.5 + uniform(1.0)),
        };
        let uv = field.signals.strain_uv(&Contact::from(label)).uv;
        let uv = std::array::from_fn(|k| gains[k] * f64::from(uv[k]) + 30.0 * k as f64 + uniform(8.0));
        Row { line: at + 2, uv: Some(uv), ..Row::of(label) }
    };
    Table { rows: (0..ROWS).map(row).collect(), ..Table::default() }
}

/// The table as somebody writes it who means labels so.
fn written(mut table: Table, convention: &LabelConvention) -> Table {
    for row in &mut table.rows {
        row.label = convention.written(&row.label);
        row.uv = row.uv.map(|uv| uv.map(|uv| uv / convention.units.uv));
    }
    table
}

fn drawn<T: Copy>(random: &mut SplitMix64, of: &[T]) -> T {
    of[(random.next_bits() % of.len() as u64) as usize]
}

fn drawn_convention(random: &mut SplitMix64) -> LabelConvention {
    let frames = [
        "x,y",
        "x,-y",
        "-x,y",
        "y,x",
        "-y,x",
        "y,-x",
        "-x,-y",
        "turn=60",
        "turn=-120",
        "turn=120",
        "x,-y,turn=30",
        "turn=41",
    ];
    let signs = ["fx,fy,fz", "-fx,-fy,-fz", "fx,fy,-fz", "-fx,-fy,fz", "fx,-fy,fz"];
    let units = ["mm,N,uV", "in,N,uV", "mm,lbf,uV", "cm,kgf,uV", "mm,g,uV", "m,N,V"];
    LabelConvention {
        frame: drawn(random, &frames).parse().unwrap(),
        sign: drawn(random, &signs).parse().unwrap(),
        units: drawn(random, &units).parse().unwrap(),
    }
}

/// Labels that are meant as well as the table's contacts.
fn come_back(conventions: &Conventions, table: &Table, truth: &Table) -> bool {
    let applied = conventions.applied(table);
    let apart = |(row, truth): (&Row, &Row)| {
        let [one, other] = [row.label, truth.label];
        libm::hypot(one.x_mm - other.x_mm, one.y_mm - other.y_mm)
            + libm::hypot(libm::hypot(one.fx_n - other.fx_n, one.fy_n - other.fy_n), one.fz_n - other.fz_n)
    };
    // A unit is told to some figures, and an angle to a degree.
    let pressed = applied.rows.iter().zip(&truth.rows).filter(|(_, truth)| truth.label.fz_n > 0.0);
    pressed.map(apart).all(|apart| apart < 1.0)
}

#[test]
fn conventions_that_are_drawn_at_random_come_back() {
    let (device, field) = pad();
    let pad = SimulatedPad::known(&device, &field);
    for seed in 0..60 {
        let mut random = SplitMix64::new(seed);
        let truth = table(&mut random, &field);
        let convention = drawn_convention(&mut random);
        let table = written(truth.clone(), &convention);
        let found = Conventions::of(&table, &pad);
        // A pad cannot tell its mirror image and its reaction from another wiring: the labels are told, as the fewer mistakes.
        assert!(come_back(&found, &table, &truth), "{seed}: {convention}: {:?}", found.parts);
        assert_eq!(found.are_default(), convention.is_default(), "{seed}: {convention}: {found:?}");
    }
}

#[test]
fn wiring_faults_are_no_conventions() {
    let (device, field) = pad();
    let pad = SimulatedPad::known(&device, &field);
    let mistakes = SignedPermutation::single_mistakes();
    for seed in 0..40 {
        let mut random = SplitMix64::new(1000 + seed);
        let mut table = table(&mut random, &field);
        let mistake = drawn(&mut random, &mistakes);
        for row in &mut table.rows {
            row.uv = row.uv.map(|uv| mistake.of(&uv));
        }
        let found = Conventions::of(&table, &pad);
        let Some(finding) = found.findings(&table, &pad, 0.0).into_iter().next() else { continue };
        assert!(!finding.confounded_with.is_empty(), "{mistake:?}: {finding:?}");
        assert!(finding.separate_by.is_some(), "{mistake:?}: {finding:?}");
    }
}

#[test]
fn a_part_of_the_table_may_be_meant_otherwise() {
    let (device, field) = pad();
    let pad = SimulatedPad::known(&device, &field);
    for seed in 0..20 {
        let mut random = SplitMix64::new(2000 + seed);
        let truth = table(&mut random, &field);
        let mut convention = drawn_convention(&mut random);
        // The untouched pad is read in one unit.
        convention.units.uv = 1.0;
        let from = drawn(&mut random, &[ROWS / 4, ROWS / 2, ROWS - ROWS / 4]);
        let mut table = written(truth.clone(), &convention);
        table.rows[..from].clone_from_slice(&truth.rows[..from]);
        let found = Conventions::of(&table, &pad);
        assert!(come_back(&found, &table, &truth), "{seed}: {convention} from {from}: {found:?}");
    }
}

#[test]
fn labels_that_are_late_or_early_are_told() {
    let (device, field) = pad();
    let pad = SimulatedPad::known(&device, &field);
    for rows_late in [-3_isize, -1, 1, 2] {
        let mut random = SplitMix64::new(3000);
        let truth = table(&mut random, &field);
        let mut table = truth.clone();
        for at in 0..ROWS {
            let from = (at as isize - rows_late).rem_euclid(ROWS as isize) as usize;
            table.rows[at].label = truth.rows[from].label;
        }
        let found = Conventions::of(&table, &pad);
        assert_eq!(found.rows_late, rows_late);
        let said: Vec<_> =
            found.findings(&table, &pad, 0.0).iter().map(|it| (it.effect, it.parameters[0].value)).collect();
        assert_eq!(said, [(Effect::RowShift, rows_late as f64)]);
    }
}

#[test]
fn rows_of_another_recording_are_left_out() {
    let (device, field) = pad();
    let pad = SimulatedPad::known(&device, &field);
    let mut random = SplitMix64::new(4000);
    let mut table = table(&mut random, &field);
    let strange: Vec<usize> = (0..ROWS).filter(|at| at % 20 == 3).collect();
    for at in &strange {
        let [x_mm, y_mm] = [-table.rows[*at].label.y_mm - 18.0, table.rows[*at].label.x_mm];
        table.rows[*at].label = Label { x_mm, y_mm, ..table.rows[*at].label };
    }
    let found = Conventions::of(&table, &pad);
    assert!(found.are_meant_so());
    assert!(found.strangers.iter().all(|row| strange.contains(row)));
    assert!(found.strangers.len() > strange.len() / 2, "{:?}", found.strangers);
}
