//! The verb `tune`, and `replay` as a difference, on a recording of the virtual pad.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use firmware_proto::ENCODED_MAX;
use firmware_proto::frame::Message;
use firmware_proto::link::encode_message;
use firmware_proto::sample::{Sample, Status};
use serde_json::Value;
use tactpad::pad::field::PadField;
use tactpad::pipeline::call::Call;
use tactpad::pipeline::capture::head::Head;
use tactpad::pipeline::capture::writer::CaptureWriter;
use tactpad::quantity::Contact;
use tactpad::time::HostInstant;

use crate::recorded;

fn tactpad(folder: &Path, line: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.args(line.split(' ')).current_dir(folder).stdin(Stdio::null());
    command.env("RUST_BACKTRACE", "1").env("XDG_CONFIG_HOME", folder);
    let output = command.output().unwrap();
    assert!(!said(&output).contains("panicked"), "{}", said(&output));
    output
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn printed(output: &Output) -> String {
    assert!(output.status.success(), "{}", said(output));
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn json(folder: &Path, line: &str) -> Value {
    serde_json::from_str(&printed(&tactpad(folder, line))).unwrap()
}

/// What the events of a replay meant, as somebody would write it down who saw them: from one rest to the next.
fn table(log: &str) -> String {
    let mut held = BTreeMap::new();
    let (mut begin_us, mut meant) = (0, Vec::new());
    let mut lines = vec!["begin_s,end_s,meant".to_owned()];
    let events: Vec<Value> = log.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    for (index, event) in events.iter().enumerate() {
        let (code, value) = (event["code"].as_str().unwrap().to_owned(), event["value"].as_i64().unwrap());
        match value {
            0 => held.remove(&code),
            value => {
                let side = if value < 0 { "-" } else { "+" };
                meant.push(if code.starts_with("ABS") { format!("{code}{side}") } else { code.clone() });
                held.insert(code, value)
            }
        };
        // A finger that rolls from one direction to the next changes both at once.
        let goes_on = events.get(index + 1).is_some_and(|next| next["t_us"] == event["t_us"]);
        if held.is_empty() && !goes_on {
            // The recording's first sample is the pad's first one: its clock begins there.
            let end_us = event["t_us"].as_u64().unwrap() + 20_000;
            lines.push(format!("{},{},{}", begin_us as f64 * 1e-6, end_us as f64 * 1e-6, meant.join("+")));
            (begin_us, meant) = (end_us, Vec::new());
        }
    }
    lines.join("\n")
}

#[test]
fn a_profile_that_does_not_fit_is_fitted_and_written() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    recorded::write(&folder.join("game.cap"), "inverse", 12);
    fs::write(folder.join("game.csv"), table(&printed(&tactpad(folder, "replay game.cap")))).unwrap();
    let shipped = printed(&tactpad(folder, "profile show super-mario"));
    let odd = shipped
        .replace("press_n = 2.0", "press_n = 4.4 # far too hard")
        .replace("release_n = 1.4", "release_n = 3.5");
    let odd = odd.replace("rotation_deg = 0.0 ", "rotation_deg = 50.0 ");
    fs::write(folder.join("odd.toml"), &odd).unwrap();
    let fits = json(folder, "tune --labelled game.csv --profile super-mario --json");
    assert_eq!((&fits["share"]["before"], &fits["changes"]), (&1.0.into(), &Value::Array(vec![])), "{fits}");
    let found = json(folder, "tune game.cap --labelled game.csv --profile odd.toml --write fitted --json");
    let [before, after] = ["before", "after"].map(|when| found["share"][when].as_f64().unwrap());
    assert!(before <= 0.2 && after >= 0.9, "{found}");
    assert!(found["delay_ms"]["after"].as_f64().unwrap() <= 200.0, "{found}");
    let written = fs::read_to_string(found["written"].as_str().unwrap()).unwrap();
    assert!(written.contains("# far too hard") && !written.contains("4.4"), "{written}");
    let lines = |text: &str| text.lines().filter(|line| line.starts_with('#')).count();
    assert_eq!(lines(&written), lines(&odd));
    printed(&tactpad(folder, "profile check fitted"));
    let again = json(folder, "tune --labelled game.csv --profile fitted --json");
    assert_eq!(again["share"]["before"], found["share"]["after"]);
    let told = printed(&tactpad(folder, "tune --labelled game.csv --profile odd.toml --write mine.toml"));
    assert!(
        told.contains("button 1: a press begins at ") && told.ends_with("mine.toml is written\n"),
        "{told}"
    );
    assert_eq!(fs::read_to_string(folder.join("mine.toml")).unwrap(), written);
    refuses(folder, "tune --labelled game.csv --profile odd.toml --write fitted", "is there already");
    refuses(folder, "tune --labelled game.csv --profile odd.toml --write game.cap", "is the recording");
    refuses(folder, "tune --labelled game.csv --profile odd.toml --write - --json", "both print");
    compares(folder);
    fs::write(folder.join("late.csv"), "begin_s,end_s,meant\n99,100,up\n").unwrap();
    refuses(folder, "tune game.cap --labelled late.csv --profile odd.toml", "late.csv has a label at 99.0 s");
}

/// The difference between the profile that fits and one that does not.
fn compares(folder: &Path) {
    let same = printed(&tactpad(folder, "replay game.cap --profile super-mario --compare super-mario"));
    assert!(same.ends_with("; 0 only with the old profile (-), 0 only with the new one (+)\n"), "{same}");
    let told = printed(&tactpad(folder, "replay game.cap --profile super-mario --compare odd.toml"));
    let taps =
        told.lines().filter(|line| line.starts_with("+ ") && line.contains(" s  BTN_SOUTH  for 0.040 s"));
    assert!(taps.count() >= 2, "{told}");
    let found = json(folder, "replay game.cap --profile super-mario --compare odd.toml --json");
    let only = found["only"].as_array().unwrap();
    let is_tap = |it: &&Value| it["with"] == "new" && it["code"] == "BTN_SOUTH" && it["device"] == "gamepad";
    assert!(only.iter().filter(is_tap).count() >= 2, "{found}");
    assert_eq!(only.len(), told.lines().count() - 1);
    refuses(folder, "replay game.cap --compare super-mario", "--profile");
}

fn refuses(folder: &Path, line: &str, words: &str) {
    let output = tactpad(folder, line);
    assert_eq!(output.status.code(), Some(2), "{line}: {}", said(&output));
    assert!(said(&output).contains(words), "{line}: {}", said(&output));
}

#[test]
fn what_cannot_be_used_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("a.csv"), "begin_s,end_s,meant\n1,2,rigth\n").unwrap();
    fs::write(folder.join("b.csv"), "begin_s,end_s,meant\n1,2,right\n").unwrap();
    for (line, words) in [
        ("tune --labelled none.csv --profile super-mario", "none.csv cannot be read"),
        (
            "tune --labelled a.csv --profile super-mario",
            "a.csv:2: the profile has nothing that is called \"rigth\": did you mean \"right\"?",
        ),
        ("tune --labelled b.csv --profile super-mario", "there is no b.cap beside the table"),
        ("tune b.csv --labelled b.csv --profile super-mario", "b.csv "),
        ("tune --labelled b.csv --profile nothing", "there is no profile \"nothing\""),
        ("tune --labelled b.csv --profile super-mario --delay-ms 9999", "delay-ms"),
    ] {
        refuses(folder, line, words);
    }
}

/// A recording of 30 s: presses of these forces in its first half and in its second, again and again.
fn write_presses(path: &Path, [light_n, hard_n]: [&[f32]; 2]) {
    let field = PadField::nominal().signals;
    let mut writer = CaptureWriter::begin(Vec::new(), HostInstant::default(), &Head::default()).unwrap();
    for sequence in 0..30_000 {
        let (second, ms) = (sequence as usize / 1_000, sequence % 1_000);
        let forces_n = if second < 15 { light_n } else { hard_n };
        let fz_n = forces_n[second % forces_n.len()];
        let is_down = second > 0 && (300..600).contains(&ms);
        let contact = Contact { fz_n: if is_down { fz_n } else { 0.0 }, ..Contact::default() };
        let counts = field.strain_uv(&contact).uv.map(|uv| (uv * 100.0) as i32);
        let time_us = u64::from(sequence) * 1_000;
        let sample = Sample { sequence, time_us, counts, temperature_centi_c: 2_500, status: Status::OK };
        let mut frame = [0; ENCODED_MAX];
        let length = encode_message(&Message::Sample(sample), &mut frame);
        let now = HostInstant::default().plus_us(time_us);
        writer.write(now, Call::Bytes(&frame[..length])).unwrap();
    }
    fs::write(path, writer.get_mut()).unwrap();
}

#[test]
fn forces_are_fitted_to_presses_that_are_light_and_hard() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_presses(&folder.join("range.cap"), [&[0.5, 0.6, 0.7], &[1.5, 1.6]]);
    let line = "tune range.cap --force-range --profile super-mario --write mine --json";
    let found = json(folder, line);
    assert_eq!(found["presses"], serde_json::json!({ "light": 13, "hard": 14 }), "{found}");
    let [light, most, hard] =
        ["light_n", "light_most_n", "hard_n"].map(|key| found["range"][key].as_f64().unwrap());
    assert!((0.45..0.55).contains(&light) && (0.65..0.75).contains(&most), "{found}");
    assert!((1.45..1.55).contains(&hard), "{found}");
    let reach = |when: &str| &found["reach"][when];
    assert_eq!(
        reach("before"),
        &serde_json::json!({ "light_lowest": 13, "light_highest": 0, "hard_highest": 0 })
    );
    let after = serde_json::json!({ "light_lowest": 13, "light_highest": 0, "hard_highest": 14 });
    assert_eq!(reach("after"), &after);
    let later = serde_json::json!({ "light_lowest": 7, "light_highest": 0, "hard_highest": 7 });
    assert_eq!(found["held_out"]["reach"]["after"], later);
    assert_eq!(found["thresholds"][1]["key"], "button.1.press_n");
    let highest = found["thresholds"][1]["after"]["force_n"].as_f64().unwrap();
    let written = fs::read_to_string(found["written"].as_str().unwrap()).unwrap();
    assert!(written.contains(&format!("press_n = {highest}\n")) && written.contains("# or \"keyboard\""));
    printed(&tactpad(folder, "profile check mine"));
    let told = printed(&tactpad(folder, "tune range.cap --force-range --profile mine --write mine"));
    assert!(told.contains("nothing changes") && !told.contains("is written"), "{told}");
    let told = printed(&tactpad(folder, "tune range.cap --force-range --profile contra --write c.toml"));
    for words in ["13 light presses and 14 hard ones\n", "button.1.press_n    2.00 N", "c.toml is written\n"]
    {
        assert!(told.contains(words), "{told}");
    }
    assert!(told.lines().all(|line| line.chars().count() <= 80), "{told}");
    refuses(folder, line, "is there already");
}

#[test]
fn forces_that_cannot_be_fitted_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_presses(&folder.join("flat.cap"), [&[0.5, 0.8], &[0.9]]);
    let line = "tune flat.cap --force-range --profile super-mario --write mine.toml";
    refuses(folder, line, "choose a profile that needs one force, as one-button, or tell presses by time");
    assert!(!folder.join("mine.toml").exists());
    let told = printed(&tactpad(folder, "tune flat.cap --force-range --profile one-button"));
    assert!(told.contains("of 13 light presses are enough"), "{told}");
    write_presses(&folder.join("few.cap"), [&[0.0], &[2.0]]);
    refuses(
        folder,
        "tune few.cap --force-range --profile contra",
        "0 presses in its first half and 14 in its second",
    );
    fs::write(
        folder.join("flat.toml"),
        "schema = 1\nname = \"F\"\noutput = \"gamepad\"\n[[button]]\nforce = \"fx\"\npress_n = 1\n\
         out = { gamepad = \"BTN_TL\", keyboard = \"KEY_A\" }\n",
    )
    .unwrap();
    refuses(folder, "tune flat.cap --force-range --profile flat.toml", "asks for no normal force");
    refuses(folder, "tune --force-range --profile contra", "CAPTURE");
    refuses(folder, "tune flat.cap --profile contra", "--labelled");
    refuses(folder, "tune flat.cap --force-range --labelled a.csv --profile contra", "cannot be used with");
}
