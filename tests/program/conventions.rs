//! Labels that are meant otherwise: no decoder comes of them unasked, and each argument brings the table back.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::path::Path;

use tactpad::numeric::random::SplitMix64;

use crate::ran::{json, refused, tactpad};

/// Writes a table of the twin again with other labels, and with other channels.
fn rewrite(folder: &Path, name: &str, label: impl Fn([f64; 5]) -> [f64; 5], channels: f64) {
    let text = fs::read_to_string(folder.join("twin.csv")).unwrap();
    let (header, rows) = text.split_once('\n').unwrap();
    let names: Vec<&str> = header.split(',').collect();
    let place = |wanted: &str| names.iter().position(|name| *name == wanted).unwrap();
    let labels = ["x_mm", "y_mm", "fx_n", "fy_n", "fz_n"].map(place);
    let row = |line: &str| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        let written = label(labels.map(|at| cells[at].parse().unwrap()));
        labels.into_iter().zip(written).for_each(|(at, value)| cells[at] = value.to_string());
        for (cell, name) in cells.iter_mut().zip(&names) {
            if name.ends_with("_uv") {
                *cell = (channels * cell.parse::<f64>().unwrap()).to_string();
            }
        }
        cells.join(",") + "\n"
    };
    fs::write(folder.join(name), format!("{header}\n{}", rows.lines().map(row).collect::<String>())).unwrap();
}

#[test]
fn a_table_in_another_convention_makes_no_decoder_until_somebody_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    assert!(tactpad(folder, "twin --plan recommended --seed 3 --out twin.csv").status.success());
    let as_meant = json(folder, "evaluate --measured twin.csv --json");
    type Case = (&'static str, fn([f64; 5]) -> [f64; 5], f64, &'static str, &'static str);
    let cases: [Case; 6] = [
        ("y_down", |[x, y, fx, fy, fz]| [x, -y, fx, -fy, fz], 1.0, "another frame", "--frame \"x,-y\""),
        ("fz_negative", |[x, y, fx, fy, fz]| [x, y, fx, fy, -fz], 1.0, "signs", "--sign \"fx,fy,-fz\""),
        (
            "metres",
            |[x, y, fx, fy, fz]| [x / 1e3, y / 1e3, fx, fy, fz],
            1.0,
            "unit of places",
            "--units \"m,N,uV\"",
        ),
        (
            "pounds",
            |[x, y, fx, fy, fz]| [x, y, fx / 4.448_222, fy / 4.448_222, fz / 4.448_222],
            1.0,
            "unit of forces",
            "--units \"mm,lbf,uV\"",
        ),
        ("volts", |label| label, 1e-6, "unit of channels", "--units \"mm,N,V\""),
        ("exchanged", |[x, y, fx, fy, fz]| [y, x, fy, fx, fz], 1.0, "another frame", "--frame \"y,x\""),
    ];
    for (name, label, channels, what, argument) in cases {
        rewrite(folder, &format!("{name}.csv"), label, channels);
        for line in [
            format!("adapt --method inverse --measured {name}.csv --out {name}.decoder"),
            format!("adapt --method linear --measured {name}.csv --out {name}.decoder"),
            format!("evaluate --measured {name}.csv"),
        ] {
            let why = refused(folder, &line);
            assert!(
                why.contains(&format!("{name}.csv: ")) && why.contains(what) && why.contains(argument),
                "{why}"
            );
            assert!(!folder.join(format!("{name}.decoder")).exists(), "{line}");
        }
        let evaluated =
            json(folder, &format!("evaluate --measured {name}.csv --json {}", argument.replace('"', "")));
        for error in ["position_mae_mm", "force_mae_n"] {
            let [one, other] = [&evaluated, &as_meant].map(|it| it[error].as_f64().unwrap());
            assert!((one / other - 1.0).abs() < 0.01, "{name}: {error} {one} {other}");
        }
    }
}

#[test]
fn arguments_that_say_nothing_are_refused_with_what_to_write() {
    let folder = tempfile::tempdir().unwrap();
    for (argument, way_out) in
        [("--frame x", "turn=120"), ("--sign fx,fy", "fx,fy,-fz"), ("--units mm", "in,lbf,mV")]
    {
        let why = refused(folder.path(), &format!("evaluate --measured m.csv {argument}"));
        assert!(why.contains(way_out), "{why}");
    }
}

/// A measured table of the nominal pad with 4 µV of noise, whose labels are written as `written` makes them of the row and of all true ones.
fn measured(folder: &Path, name: &str, written: impl Fn(usize, &[[f64; 5]]) -> [f64; 5]) {
    let mut random = SplitMix64::new(7);
    let mut within = |low: f64, high: f64| low + (high - low) * f64::from(random.fraction());
    let contact = |_| {
        let (radius_mm, angle) = (20.0 * within(0.0, 1.0).sqrt(), within(0.0, std::f64::consts::TAU));
        let fz_n = within(1.5, 5.0);
        let shear = |of: f64| 0.2 * fz_n * of;
        [
            radius_mm * angle.cos(),
            radius_mm * angle.sin(),
            shear(within(-1.0, 1.0)),
            shear(within(-1.0, 1.0)),
            fz_n,
        ]
    };
    let contacts: Vec<[f64; 5]> = (0..400).map(contact).collect();
    let text = |labels: &[f64; 5]| labels.map(|number| number.to_string()).join(",");
    let header = "x_mm,y_mm,fx_n,fy_n,fz_n";
    let lines: Vec<String> = contacts.iter().map(text).collect();
    fs::write(folder.join("contacts.csv"), format!("{header}\n{}\n", lines.join("\n"))).unwrap();
    assert!(tactpad(folder, "simulate --contacts contacts.csv --out read.csv").status.success());
    let read = fs::read_to_string(folder.join("read.csv")).unwrap();
    let (names, rows) = read.split_once('\n').unwrap();
    let is_channel: Vec<bool> = names.split(',').map(|name| name.ends_with("_uv")).collect();
    let channels = |line: &str| -> Vec<String> {
        line.split(',')
            .map(str::to_owned)
            .zip(&is_channel)
            .filter(|(_, it)| **it)
            .map(|(cell, _)| cell)
            .collect()
    };
    let mut table = format!("{header},{}\n", channels(names).join(","));
    for (at, line) in rows.lines().enumerate() {
        let noisy = channels(line).into_iter().map(|cell| {
            let uv: f64 = cell.parse().unwrap();
            format!("{:.3}", uv + 4.0 * f64::from(random.normal()))
        });
        table += &format!("{},{}\n", text(&written(at, &contacts)), noisy.collect::<Vec<_>>().join(","));
    }
    fs::write(folder.join(name), table).unwrap();
}

#[test]
fn labels_that_stand_still_or_are_rounded_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let found = |name: &str| -> Vec<(String, String)> {
        let found = json(folder, &format!("diagnose --measured {name} --json"));
        let texts =
            |it: &serde_json::Value| ["effect", "target"].map(|key| it[key].as_str().unwrap().to_owned());
        found["findings"]
            .as_array()
            .unwrap()
            .iter()
            .map(texts)
            .map(|[effect, target]| (effect, target))
            .collect()
    };
    let is = |effect: &str, targets: &[&str]| -> Vec<(String, String)> {
        targets.iter().map(|target| (effect.to_owned(), (*target).to_owned())).collect()
    };
    measured(folder, "sound.csv", |at, all| all[at]);
    assert_eq!(found("sound.csv"), []);
    measured(folder, "rounded.csv", |at, all| {
        let [x_mm, y_mm, fx_n, fy_n, fz_n] = all[at];
        [x_mm.round(), y_mm.round(), fx_n, fy_n, fz_n]
    });
    assert_eq!(found("rounded.csv"), is("label_rounded", &["x_mm", "y_mm"]));
    measured(folder, "stuck.csv", |at, all| {
        let mut label = all[at];
        label[4] = all[if (100..150).contains(&at) { 100 } else { at }][4];
        label
    });
    assert_eq!(found("stuck.csv"), is("label_stuck", &["fz_n"]));
    let why = refused(folder, "adapt --method inverse --measured stuck.csv --out none.decoder");
    assert!(why.contains("fz_n stands still in 50 of 400 contacts, lines 102 to 151"), "{why}");
    measured(folder, "never.csv", |at, all| {
        let mut label = all[at];
        label[4] = 2.0;
        label
    });
    let why = refused(folder, "diagnose --measured never.csv");
    assert!(why.contains("fz_n is the same in all rows") && why.lines().count() == 1, "{why}");
}
