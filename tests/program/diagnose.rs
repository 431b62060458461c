//! `tactpad diagnose`: which tables and arguments it refuses, before any long work.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use tactpad::numeric::random::SplitMix64;
use tactpad::quantity::{CHANNEL_NAMES, CHANNELS};

const LABEL: &str = "x_mm,y_mm,fx_n,fy_n,fz_n";

fn diagnose(folder: &Path, line: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.env("XDG_STATE_HOME", folder);
    command.arg("diagnose").args(line.split_whitespace()).current_dir(folder).stdin(Stdio::null());
    let output = command.env("RUST_BACKTRACE", "1").output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!said.contains("panicked") && !said.contains("stack backtrace"), "{said}");
    output
}

fn refused(folder: &Path, line: &str) -> String {
    let output = diagnose(folder, line);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{line}: {said}");
    said
}

/// A measured table with these labels; its channels read a little of everything.
fn table(labels: impl Iterator<Item = [f64; 5]>) -> String {
    let names = CHANNEL_NAMES.map(|name| format!(",{name}_uv")).concat();
    let row = |label: [f64; 5]| {
        let uv: [String; CHANNELS] =
            std::array::from_fn(|k| (10.0 * label.iter().sum::<f64>() + k as f64).to_string());
        format!("{},{}\n", label.map(|number| number.to_string()).join(","), uv.join(","))
    };
    format!("{LABEL}{names}\n{}", labels.map(row).collect::<String>())
}

/// Places on a grid, all pressed alike.
fn grid(fz_n: f64) -> impl Iterator<Item = [f64; 5]> {
    (0..400).map(move |at| [f64::from(at % 20) - 10.0, f64::from(at / 20) - 10.0, 0.0, 0.0, fz_n])
}

#[test]
fn a_table_that_shows_nothing_is_refused_by_its_name() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("untouched.csv"), table(grid(0.0))).unwrap();
    fs::write(folder.path().join("short.csv"), table(grid(2.0).take(3))).unwrap();
    for file in ["untouched.csv", "short.csv"] {
        for more in ["", "--json", "--save-device e.toml"] {
            let said = refused(folder.path(), &format!("--measured {file} {more}"));
            let why = said.strip_prefix(&format!("tactpad: {file}: ")).unwrap_or_else(|| panic!("{said}"));
            assert!(why.contains(' ') && why.lines().count() == 1, "{said}");
        }
    }
    assert!(!folder.path().join("e.toml").exists());
}

#[test]
fn tables_and_arguments_that_cannot_be_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("plan.csv", &format!("{LABEL}\n0,0,0,0,1\n"));
    write("partly.csv", &format!("{LABEL},m0x_uv\n0,0,0,0,1,5\n"));
    write("placeless.csv", "fx_n,fy_n,fz_n\n0,0,1\n");
    write("m.csv", &table(grid(2.0)));
    write("far.csv", &table([[59.0, 0.0, 0.0, 0.0, 1.0]].into_iter()));
    let heavy = table([[0.0, 0.0, 0.0, 0.0, 1.0]].into_iter());
    let (names, row) = heavy.trim_end().split_once('\n').unwrap();
    write("heavy.csv", &format!("{names},weight_g\n{row},-5\n"));
    write("typo.toml", "[nois]\nadditive_uv = 3\n");
    for (line, wanted) in [
        ("--measured plan.csv", "plan.csv:1: no column is a channel"),
        ("--measured partly.csv", "partly.csv:1: no column is named m0y_uv"),
        ("--measured placeless.csv", "placeless.csv:1: no column is named x_mm, y_mm"),
        ("--measured far.csv", "far.csv:2: x_mm is 59"),
        ("--measured none.csv", "none.csv cannot be read"),
        ("--measured m.csv --imperfections typo.toml", "did you mean \"noise\"?"),
        ("--measured m.csv --device none.toml", "device none.toml cannot be read"),
        ("--measured m.csv --save-device m.csv", "m.csv is the measured table"),
        ("--measured m.csv --next m.csv", "m.csv is the measured table"),
        ("--measured m.csv --next - --json", "--next -"),
        ("--measured m.csv --next new.csv --save-device new.csv", "--next and --save-device"),
        ("--measured m.csv --measured m.csv", "m.csv is given twice"),
        ("--measured m.csv --measured n.csv --against m.csv", "--against and --model take one table"),
        ("--measured m.csv --measured far.csv", "far.csv:2: x_mm is 59"),
        ("--measured heavy.csv", "heavy.csv:2: weight_g is -5"),
        ("--measured m.csv --device typo.toml --save-device typo.toml", "typo.toml is the device"),
        ("--measured m.csv --save-device no/e.toml", "cannot be written"),
        ("--measured m.csv --save-device - --json", "both print"),
        ("--measured m.csv --against none.csv", "none.csv cannot be read"),
        ("--measured m.csv --against plan.csv", "no channel in common"),
        ("--measured m.csv --against m.csv --labels x_mm,q", "has no column q"),
        ("--measured m.csv --against m.csv --save-device e.toml", "--against knows no model"),
        ("--measured m.csv --labels x_mm", "--against"),
        ("", "--measured <M.csv>"),
    ] {
        let said = refused(folder.path(), line);
        assert!(said.contains(wanted), "{line}: {said}");
    }
}

#[test]
fn help_has_all_options_and_an_example() {
    let output = diagnose(Path::new("."), "--help");
    let help = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0));
    for word in [
        "--measured",
        "--device",
        "--imperfections",
        "--save-device",
        "--report",
        "--json",
        "--against",
        "Example: tactpad diagnose --measured",
    ] {
        assert!(help.contains(word), "{word}: {help}");
    }
}

/// A table of a sensor that is no pad: places, and three channels that are smooth there, with noise; the second has this gain.
fn other_sensor(seed: u64, gain: f64) -> String {
    let mut state = seed;
    let mut draw = || {
        // D. E. Knuth's MMIX generator.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / f64::from(1_u32 << 24)
    };
    let row = |_: usize| {
        let [x, y] = [draw(), draw()].map(|share| 20.0 * share - 10.0);
        let mut noise = || (0..4).map(|_| draw() - 0.5).sum::<f64>();
        let a = 300.0 + 90.0 * (x / 7.0).sin() + 5.0 * y + noise();
        let b = 40.0 + gain * (60.0 * (y / 6.0).cos() - 4.0 * x) + noise();
        let c = -80.0 + 7.0 * x + 50.0 * (0.1 * (x + y)).sin() + noise();
        format!("{x},{y},{a},{b},{c}\n")
    };
    format!("x_mm,y_mm,left,middle,right\n{}", (0..200).map(row).collect::<String>())
}

#[test]
fn what_changed_in_any_sensor_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("before.csv", &other_sensor(1, 1.0));
    write("same.csv", &other_sensor(2, 1.0));
    write("weaker.csv", &other_sensor(3, 0.85));
    let found = |file: &str| -> Value {
        let output = diagnose(folder.path(), &format!("--measured {file} --against before.csv --json"));
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let same = found("same.csv");
    assert_eq!(
        (same["verdict"].as_str(), same["findings"].as_array().unwrap().len()),
        (Some("no_discrepancy"), 0),
        "{same}"
    );
    let weaker = found("weaker.csv");
    let [finding] = weaker["findings"].as_array().unwrap().as_slice() else { panic!("{weaker}") };
    assert_eq!(
        [&finding["status"], &finding["effect"], &finding["target"]],
        ["NAMED", "channel_gain", "middle"]
    );
    let gain = finding["parameters"]["gain"]["value"].as_f64().unwrap();
    assert!((gain - 0.85).abs() < 0.03, "{gain}");
}

/// A sensor of two channels under one load, in so many rows.
fn sensor(rows: usize, channels: &str, number: impl Fn(usize, usize) -> String) -> String {
    let row = |at: usize| {
        let cells = (0..channels.split(',').count()).map(|channel| number(at, channel));
        cells.collect::<Vec<_>>().join(",") + "\n"
    };
    format!("{channels}\n{}", (0..rows).map(row).collect::<String>())
}

#[test]
fn predictions_of_other_rows_or_channels_are_refused_by_what_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: String| fs::write(folder.path().join(name), text).unwrap();
    let number = |at: usize, channel: usize| {
        (if channel == 0 { at as f64 } else { channel as f64 * (at % 17) as f64 }).to_string()
    };
    let read = |at: usize, channel: usize| match channel {
        0 => at.to_string(),
        _ => (channel as f64 * (at % 17) as f64 + 0.1 * ((7 * at + channel) % 5) as f64).to_string(),
    };
    write("m.csv", sensor(100, "fz_n,a,b", read));
    write("shorter.csv", sensor(99, "fz_n,a,b", number));
    write("other.csv", sensor(100, "fz_n,a,b", |at, channel| number(at + usize::from(at == 41), channel)));
    write(
        "gap.csv",
        sensor(100, "fz_n,a,b", |at, k| if (at, k) == (6, 2) { String::new() } else { number(at, k) }),
    );
    write("names.csv", sensor(100, "fz_n,c,d", number));
    write("p.csv", sensor(100, "fz_n,a,b", number));
    for (model, words) in [
        ("shorter.csv", ["100", "99"]),
        ("other.csv", ["row 42", "fz_n"]),
        ("gap.csv", ["row 7", "b"]),
        ("names.csv", ["no channel", "name"]),
        ("missing.csv", ["missing.csv", "CSV"]),
    ] {
        let said = refused(folder.path(), &format!("--measured m.csv --model {model}"));
        assert!(words.iter().all(|word| said.contains(word)) && said.lines().count() == 1, "{model}: {said}");
    }
    let effects = folder.path().join("effects");
    fs::create_dir(&effects).unwrap();
    let asked = "--measured m.csv --model p.csv --effects effects";
    assert!(refused(folder.path(), asked).contains("effects.toml"));
    let section = |low: &str, family: &str| {
        format!(
            "[gap]\nunit = \"mm\"\nlow = {low}\nhigh = 1.0\nprior_deviation = 0.1\nfamily = \"{family}\"\n"
        )
    };
    for (text, word) in [
        (section("-1.0", "mechanics"), "family"),
        (section("0.5", "mechanical"), "[gap]"),
        (section("-1.0", "mechanical").replace("[gap]", "[creep]"), "[creep]"),
        (section("-1.0", "mechanical"), "gap.csv"),
    ] {
        fs::write(effects.join("effects.toml"), text).unwrap();
        let said = refused(folder.path(), asked);
        assert!(said.contains(word) && said.contains("effects"), "{said}");
    }
    for (table, words) in [
        (sensor(7, "a,b", number), ["7 rows", "100"]),
        (sensor(100, "c,d", number), ["a, b", "channel"]),
        (sensor(100, "a", |at, _| if at == 3 { "?".to_owned() } else { "1".to_owned() }), ["row 4", "a"]),
    ] {
        fs::write(effects.join("gap.csv"), table).unwrap();
        let said = refused(folder.path(), asked);
        assert!(words.iter().all(|word| said.contains(word)) && said.contains("gap.csv"), "{said}");
    }
    assert!(refused(folder.path(), "--measured m.csv --effects effects").contains("--model"));
    assert!(refused(folder.path(), "--measured m.csv --model p.csv --against p.csv").contains("--against"));
    for other in ["--model", "--against"] {
        let said = refused(folder.path(), &format!("--measured m.csv {other} p.csv --units mm,kg,uV"));
        assert!(said.contains("--units") && said.lines().count() == 1, "{said}");
    }
}

/// A scale and three channels that follow it, with this deviation of their noise.
fn weighed(seed: u64, noise: f64, label: impl Fn(f64) -> f64) -> String {
    let mut random = SplitMix64::new(seed);
    let mut text = String::from("scale_g,a,b,c\n");
    for _ in 0..300 {
        let load = 800.0 * f64::from(random.fraction());
        let channels = [(900.0, -1.2), (500.0, -0.5), (40.0, 0.6)].map(|(zero, slope): (f64, f64)| {
            let bent = slope * load * (1.0 + 1e-4 * load);
            format!("{:.4}", zero + bent + noise * f64::from(random.normal()))
        });
        text += &format!("{:.4},{}\n", label(load), channels.join(","));
    }
    text
}

#[test]
fn noise_that_grew_in_all_channels_and_labels_that_go_nowhere_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: String| fs::write(folder.path().join(name), text).unwrap();
    write("earlier.csv", weighed(1, 4.0, |load| load));
    write("same.csv", weighed(2, 4.0, |load| load));
    write("loud.csv", weighed(3, 40.0, |load| load));
    write("kilograms.csv", weighed(4, 4.0, |load| load / 1000.0));
    write("stuck.csv", weighed(5, 4.0, |_| 61.1));
    let said = |file: &str| -> Value {
        let output = diagnose(folder.path(), &format!("--json --measured {file} --against earlier.csv"));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    assert_eq!(said("same.csv")["verdict"], "no_discrepancy");
    let loud = said("loud.csv");
    let found: Vec<_> =
        loud["findings"].as_array().unwrap().iter().map(|it| (&it["effect"], &it["target"])).collect();
    let all = ["a", "b", "c"].map(|channel| ("noise_excess", channel));
    assert!(
        found.len() == 3 && all.iter().all(|it| found.iter().any(|of| *of.0 == it.0 && *of.1 == it.1)),
        "{found:?}"
    );
    for file in ["kilograms.csv", "stuck.csv"] {
        let why = refused(folder.path(), &format!("--measured {file} --against earlier.csv"));
        assert!(why.contains("scale_g") && why.contains("unit") && why.lines().count() == 1, "{why}");
    }
}
