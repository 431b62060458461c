//! The generator against its tables, its symmetries and closed forms.

use crate::background::{Smooth, background, rms_of};
use crate::case::Case;
use crate::effects::mechanical::{OPEN_SHARE, influence};
use crate::effects::{electrical, memory, rig};
use crate::fields::{Influence, MOVED, NOMINAL, OPEN_FRAME, SOFT_FRAME, THICK_PLATE, TURNED, Table, View};
use crate::measured::{Quality, typical};
use crate::plan::{Contact, Plan, Room, Row, carry_out};
use crate::random::Random;
use crate::sizes::{CAUSES, drawn, scaled};
use crate::truth::Truth;

fn places() -> Vec<[f64; 2]> {
    let place = |index: u32| {
        let radius = 28.5 * (f64::from(index) / 80.0).sqrt();
        let (sin, cos) = (f64::from(index) * 2.399_963).sin_cos();
        [radius * cos, radius * sin]
    };
    (0..80).map(place).collect()
}

/// The rms of the difference of two fields over the plate, as a share of the first's.
fn apart(a: &dyn Fn([f64; 2]) -> Influence, b: &dyn Fn([f64; 2]) -> Influence) -> f64 {
    let [mut difference, mut whole] = [0.0; 2];
    for place in places() {
        for (a, b) in a(place).iter().flatten().zip(b(place).iter().flatten()) {
            difference += (a - b).powi(2);
            whole += a * a;
        }
    }
    f64::sqrt(difference / whole)
}

#[test]
fn points_of_the_tables_are_met() {
    let point = NOMINAL.point(17, 5);
    let (sin, cos) = 25.0_f64.to_radians().sin_cos();
    let read = NOMINAL.at([17.0 * cos, 17.0 * sin]);
    for (read, point) in read.iter().flatten().zip(point.iter().flatten()) {
        assert!((read - point).abs() < 1e-9, "{read} {point}");
    }
}

/// A slope is the same from both sides of a table's line, and of the centre.
#[test]
fn slopes_have_no_steps() {
    let (mut steps, mut slopes) = (0.0, 0.0);
    for ring in 0..28 {
        for [x, y] in [[1.0, 0.0], [-0.5, 0.866_025_403_784_438_6], [0.0, 1.0]] {
            let at = |along: f64| NOMINAL.at([(f64::from(ring) + along) * x, (f64::from(ring) + along) * y]);
            let [before, middle, after] = [at(-1e-3), at(0.0), at(1e-3)];
            for k in 0..27 {
                let value = |field: &Influence| field[k / 3][k % 3];
                steps += (value(&after) - 2.0 * value(&middle) + value(&before)).powi(2);
                slopes += (value(&after) - value(&before)).powi(2) / 4.0;
            }
        }
    }
    // Half a step is what a slope may be wrong by.
    assert!(f64::sqrt(steps / slopes) / 2.0 < 1.5e-3, "{}", f64::sqrt(steps / slopes) / 2.0);
}

#[test]
fn a_third_of_a_turn_and_a_mirror_change_nothing() {
    for (target, mirrored) in [(1, false), (2, false), (0, true), (2, true)] {
        let view = View { table: &NOMINAL, home: 0, target, mirrored };
        let found = apart(&|place| NOMINAL.at(place), &|place| view.at(place));
        assert!(found < 1e-3, "{target} {mirrored}: {found}");
    }
}

#[test]
fn the_size_of_a_table_gives_the_table() {
    let moved = [("radial_mm", -0.7), ("tangential_mm", 0.9)];
    let cases: [(&Table, Truth); 5] = [
        (&MOVED, Truth::new("module_displaced", "module0", &moved)),
        (&TURNED, Truth::new("module_rotated", "module1", &[("deg", -5.0)])),
        (&SOFT_FRAME, Truth::new("module_stiffness", "module2", &[("factor", 0.6)])),
        (&OPEN_FRAME, Truth::new("module_frame_open", "module0", &[("area_share", OPEN_SHARE)]).on("-x")),
        (&THICK_PLATE, Truth::new("plate_stiffness", "pad", &[("factor", 1.15_f64.powi(3))])),
    ];
    for (table, truth) in cases {
        let truths = [truth];
        let found = apart(&|place| table.at(place), &|place| influence(&truths, place));
        assert!(found < 1e-9, "{}: {found}", truths[0].effect);
    }
}

/// What module 1 does to its own channels when it moves, module 2 does one third of a turn on.
#[test]
fn changes_of_other_modules_are_turned() {
    let truth = |module: &str| [Truth::new("module_displaced", module, &[("radial_mm", 0.5)])];
    let [one, two] = [truth("module1"), truth("module2")];
    let place = [4.0, -7.0];
    let (a, b) = (influence(&one, place), influence(&two, crate::fields::turned(place, 1)));
    // A pressing force has no direction in the plane.
    for axis in 0..3 {
        assert!((a[3 + axis][2] - b[6 + axis][2]).abs() < 0.7, "{} {}", a[3 + axis][2], b[6 + axis][2]);
    }
}

#[test]
fn a_background_has_its_share_and_length() {
    let rows = Plan::Paper.rows(1);
    let contacts: Vec<Contact> = rows.iter().map(|row| row.contact).collect();
    let rms = typical(&rows);
    let made = background(&rows, &contacts, &rms, [0.02, 14.0], &mut Random::new(1, "test"));
    for (channel, rms) in rms.into_iter().enumerate() {
        assert!((rms_of(&rows, &made, channel) / rms - 0.02).abs() < 1e-9);
    }
    let random = &mut Random::new(2, "test");
    let pairs: Vec<[f64; 2]> = (0..2000)
        .map(|_| {
            let field = Smooth::new(12.0, random);
            [field.at([3.0, 5.0]), field.at([3.0, 17.0])]
        })
        .collect();
    let mean = |of: &dyn Fn(&[f64; 2]) -> f64| pairs.iter().map(of).sum::<f64>() / 2000.0;
    assert!((mean(&|pair| pair[0] * pair[0]) - 1.0).abs() < 0.1);
    assert!((mean(&|pair| pair[0] * pair[1]) - (-0.5_f64).exp()).abs() < 0.1);
}

#[test]
fn two_recordings_of_a_pad_differ_by_their_noise() {
    let mut case = Case::new("pair", 3, Plan::Paper, Vec::new());
    case.quality = Quality { noise: [[0.006, 0.0]; 9], ..Quality::STATED };
    let [first, second] = [case.table(0), case.table(1)];
    for (channel, rms) in typical(&first.rows).into_iter().enumerate() {
        let squares: f64 =
            first.channels.iter().zip(&second.channels).map(|(a, b)| (a[channel] - b[channel]).powi(2)).sum();
        let noise = (squares / first.channels.len() as f64 / 2.0).sqrt() / rms;
        assert!((noise / 0.006 - 1.0).abs() < 0.15, "{noise}");
    }
}

fn pressed(force: [f64; 3]) -> Row {
    Row {
        trial: String::new(),
        session: String::new(),
        in_trial_s: None,
        time_s: 0.0,
        temp_c: 25.0,
        cycle: 0.0,
        contact: Contact { place: [0.0; 2], force },
        dwell_s: 2.0,
        unloading: false,
        turned_deg: 0.0,
        weight_g: None,
    }
}

/// Right-handed about x, from z towards -y: what presses along -z then pushes along +y.
#[test]
fn a_tilted_reference_turns_pressing_into_shear() {
    let truths = [Truth::new("reference_tilt", "rig", &[("x_deg", 1.0), ("y_deg", 0.0)])];
    let [x, y, z] = rig::labels(&truths, &[pressed([0.0, 0.0, 1.0])])[0].force;
    assert!(x.abs() < 1e-12 && (y - 0.017_452).abs() < 1e-5 && (z - 0.999_848).abs() < 1e-5);
    let truths = [Truth::new("reference_tilt", "rig", &[("x_deg", 0.0), ("y_deg", 1.0)])];
    let [x, y, _] = rig::labels(&truths, &[pressed([0.0, 0.0, 1.0])])[0].force;
    assert!((x + 0.017_452).abs() < 1e-5 && y.abs() < 1e-12);
}

/// A trial that rises by a newton each second and falls again.
fn ramp() -> Vec<Row> {
    let row = |step: u32| {
        let at = f64::from(step) / 10.0;
        let mut row = pressed([0.0, 0.0, if at < 5.0 { at } else { 10.0 - at }]);
        (row.trial, row.in_trial_s) = ("ramp".to_owned(), Some(at));
        row
    };
    let mut rows: Vec<Row> = (0..=100).map(row).collect();
    carry_out(&mut rows, Room::UpAndDown, &mut Random::new(1, "test"));
    rows
}

#[test]
fn late_labels_and_late_channels_are_late() {
    let rows = ramp();
    let truths = [Truth::new("time_lag", "rig", &[("ms", 50.0)])];
    let contacts = rig::true_contacts(&truths, &rows);
    // What is written was true 50 ms ago, so the truth is ahead.
    assert!((contacts[20].force[2] - 2.05).abs() < 1e-9, "{:?}", contacts[20]);
    let truths = [Truth::new("channel_skew", "m1z", &[("skew_us", 20_000.0)])];
    let mut signals: Vec<[f64; 9]> = rows.iter().map(|row| [row.contact.force[2]; 9]).collect();
    electrical::conduct(&truths, &rows, &mut signals, &[5.0; 9], &mut Random::new(1, "connectors"));
    assert!((signals[20][5] - 1.98).abs() < 1e-9 && (signals[20][4] - 2.0).abs() < 1e-12);
}

#[test]
fn memory_has_its_closed_forms() {
    let rows = ramp();
    let force = |rows: &[Row]| rows.iter().map(|row| [row.contact.force[2]; 9]).collect::<Vec<_>>();
    let mut strain = force(&rows);
    let truths = [Truth::new("hysteresis", "pad", &[("share_of_full_scale", 0.04)])];
    memory::remember(&truths, &rows, &mut strain, &[5.0; 9]);
    let loop_height = strain[75][0] - strain[25][0];
    assert!((loop_height - 0.04 * 5.0).abs() < 1e-9, "{loop_height}");
    let mut held = vec![pressed([0.0, 0.0, 1.0])];
    held[0].dwell_s = 20.0;
    let mut strain = force(&held);
    memory::remember(&[Truth::new("creep", "pad", &[("share_at_20s", 0.03)])], &held, &mut strain, &[5.0; 9]);
    assert!((strain[0][0] - 1.03).abs() < 1e-9);
}

#[test]
fn a_size_is_so_many_minimum_detectable_effects() {
    let truth = Truth::new("module_displaced", "module0", &[("radial_mm", 0.3), ("tangential_mm", 0.4)]);
    let least = |name: &str| Some(if name == "radial_mm" { 0.1 } else { 0.2 });
    let made = scaled(&truth, 3.0, &least).unwrap();
    let size = (made.value("radial_mm") / 0.1).hypot(made.value("tangential_mm") / 0.2);
    assert!(
        (size - 3.0).abs() < 1e-9
            && (made.value("radial_mm") / made.value("tangential_mm") - 0.75).abs() < 1e-9
    );
    let truth = Truth::new("channel_gain", "m0x", &[("gain", 0.9)]);
    assert!((scaled(&truth, 3.0, &|_| Some(0.01)).unwrap().value("gain") - 0.97).abs() < 1e-9);
    assert_eq!(scaled(&truth, 3.0, &|_| None), None);
    assert_eq!(scaled(&truth, 3.0, &|_| Some(5.0)), None, "larger than the generator can make it");
}

#[test]
fn every_cause_can_be_drawn_and_says_where_it_is() {
    for effect in CAUSES {
        for seed in 0..20 {
            let truth = drawn(effect, 1.0, &mut Random::new(seed, effect));
            assert_eq!(truth.effect, effect);
            let place = crate::truth::channel(&truth.target).is_some()
                || crate::truth::module(&truth.target).is_some();
            assert!(place || ["pad", "rig"].contains(&truth.target.as_str()), "{}", truth.target);
            assert!(truth.parameters.iter().all(|(_, value)| value.is_finite()));
        }
    }
}
