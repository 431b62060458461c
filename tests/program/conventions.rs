//! Labels that are meant otherwise: no decoder comes of them unasked, and each argument brings the table back.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::path::Path;

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
