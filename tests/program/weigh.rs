//! `tactpad weigh`: a pad that has aged, its decoder mended by one weight in a table and in a capture, and what is refused.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::path::Path;

use serde_json::Value;
use tactpad::pipeline::shipped;

use crate::ran::{json, printed, refused};

/// Ages, and has noise; its field is the nominal one.
const PAD: &str =
    "[ageing]\nshare = [0.19, 0.19, 0.19, 0.19, 0.19, 0.19, 0.19, 0.19, 0.19]\n[noise]\nadditive_uv = 10.0\n";

/// A table and a capture of 200 g on a pad that has lost 19 %, and contacts of it by which decoders are judged.
fn measured(folder: &Path) {
    fs::write(folder.join("pad.toml"), PAD).unwrap();
    fs::write(folder.join("plan.csv"), "x_mm,y_mm,fx_n,fy_n,fz_n\n0,0,0,0,0\n-9,12,0,0,1.96133\n0,0,0,0,0\n")
        .unwrap();
    fs::write(folder.join("my.decoder"), shipped::bytes(shipped::INVERSE).unwrap()).unwrap();
    let twin = "twin --imperfections pad.toml --state pad.life --json";
    json(folder, &format!("{twin} --cycles 50000 --plan plan.csv --out w.csv"));
    json(folder, &format!("{twin} --plan presses --seconds 5 --weight-g 200 --weights at.csv --out w.cap"));
    json(folder, &format!("{twin} --plan recommended --out m.csv --truth t.csv"));
}

fn force_mae_n(folder: &Path, decoder: &str) -> f64 {
    let found = json(folder, &format!("evaluate --decoder {decoder} --measured m.csv --truth t.csv --json"));
    found["truth"]["force_mae_n"].as_f64().unwrap()
}

#[test]
fn a_decoder_is_mended_by_a_table_a_capture_or_what_was_told() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    measured(folder);
    let before_n = force_mae_n(folder, "my.decoder");
    let weigh = "weigh --decoder my.decoder --json";
    let table = json(folder, &format!("{weigh} --weight-g 200 --measured w.csv --out table.decoder"));
    let capture = json(folder, &format!("{weigh} --weight-g 200 --play w.cap --out capture.decoder"));
    for found in [&table, &capture] {
        assert!((found["factor"].as_f64().unwrap() - 0.81).abs() < 0.005, "{found}");
    }
    assert_eq!((&table["readings"], &table["at_s"]), (&1.into(), &Value::Null));
    assert!(capture["at_s"].as_f64().unwrap() > 5.0, "{capture}");
    let [factor, deviation] = ["factor", "deviation"].map(|key| table[key].as_f64().unwrap());
    let told = format!("{weigh} --factor {factor} --deviation {deviation} --out told.decoder");
    assert_eq!(json(folder, &told)["factor"], factor);
    for decoder in ["table.decoder", "capture.decoder", "told.decoder"] {
        let after_n = force_mae_n(folder, decoder);
        assert!(after_n < 0.15 * before_n, "{decoder}: {before_n} N, then {after_n} N");
    }
    let words = printed(folder, "weigh --decoder my.decoder --weight-g 200 --play w.cap --out my.decoder");
    assert!(words.starts_with("The weight that rested until "), "{words}");
    assert!(
        words.contains("% less than when it was calibrated (±") && words.contains("my.decoder is written"),
        "{words}"
    );
    // It is mended now, so that the same weight finds nothing more.
    let again = json(folder, &format!("{weigh} --weight-g 200 --measured w.csv --out again.decoder"));
    assert!((again["factor"].as_f64().unwrap() - 1.0).abs() < 0.005, "{again}");
}

#[test]
fn what_is_no_weighing_is_refused_in_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    measured(folder);
    let rows = fs::read_to_string(folder.join("w.csv")).unwrap();
    let loads: Vec<&str> =
        rows.lines().enumerate().filter(|(at, _)| [0, 2].contains(at)).map(|(_, row)| row).collect();
    fs::write(folder.join("none.csv"), loads.join("\n")).unwrap();
    json(folder, "twin --imperfections pad.toml --plan presses --seconds 5 --out none.cap --json");
    let weigh = "weigh --decoder my.decoder --weight-g 200 --out o.decoder";
    for (line, said) in [
        (
            "weigh --decoder my.decoder --weight-g 5 --measured w.csv --out o.decoder",
            "--weight-g: 5 g is no weight",
        ),
        (
            "weigh --decoder my.decoder --weight-g 900 --measured w.csv --out o.decoder",
            "w.csv: what lies there reads as 1.5",
        ),
        (
            "weigh --decoder my.decoder --weight-g 900 --play w.cap --out o.decoder",
            "w.cap: what lies there reads as 1.5",
        ),
        (
            "weigh --decoder statics --weight-g 200 --measured w.csv --out o.decoder",
            "statics: only inverse decoders",
        ),
        ("weigh --decoder my.decoder --factor 3 --deviation 0.01 --out o.decoder", "--factor"),
        ("weigh --decoder my.decoder --factor 0.9 --deviation 0 --out o.decoder", "--deviation"),
        ("weigh --decoder my.decoder --factor 0.9 --out o.decoder", "--deviation"),
        ("weigh --decoder my.decoder --weight-g 200 --measured w.csv --out w.csv", "is the measured table"),
        (
            &format!("{weigh} --measured none.csv"),
            "none.csv: no row without force says what the untouched pad reads",
        ),
        (&format!("{weigh} --play none.cap"), "none.cap: no load rests in it for two seconds"),
        (&format!("{weigh} --play w.csv"), "w.csv is not a capture"),
        (&format!("{weigh} --play w.cap --measured w.csv"), "cannot be used with"),
        (weigh, "--play"),
    ] {
        let told = refused(folder, line);
        assert!(told.contains(said), "{line}: {told}");
    }
    assert!(!folder.join("o.decoder").exists());
}
