//! `tactpad adapt`: which tables a decoder is made of, which are refused, of what it warns, and what it names.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::path::Path;
use std::process::Output;

use tactpad::numeric::random::SplitMix64;
use tactpad::quantity::{CHANNEL_NAMES, CHANNELS};

use crate::ran::{said, tactpad};

/// A pad with unequal gains, offsets, noise and a drifting zero, whose field is the nominal one.
const PAD: &str = "[[module]]\nindex = 0\ngain = [1.26, 1.33, 0.83]\noffset_uv = [300, -200, 500]\n\
    [[module]]\nindex = 1\ngain = [1.29, 1.26, 0.99]\noffset_uv = [-150, 80, 900]\n\
    [thermal]\nzero_uv_per_c = [30, 25, 20, 15, 10, 5, -5, -10, -15]\n[noise]\nadditive_uv = 30.0\n";

/// A table as it stands in a file: what is before the channels, the channels, what is behind.
#[derive(Clone)]
struct Table {
    header: String,
    rows: Vec<(String, [f64; CHANNELS], String)>,
}

impl Table {
    fn of_twin(folder: &Path, plan: &str, seed: u64) -> Self {
        fs::write(folder.join("pad.toml"), PAD).unwrap();
        let line = format!("twin --plan {plan} --seed {seed} --imperfections pad.toml --out twin.csv");
        assert!(tactpad(folder, &line).status.success());
        let text = fs::read_to_string(folder.join("twin.csv")).unwrap();
        let (header, rows) = text.split_once('\n').unwrap();
        let first = header.split(',').position(|name| name == "m0x_uv").unwrap();
        let row = |line: &str| {
            let cells: Vec<&str> = line.split(',').collect();
            let uv = std::array::from_fn(|k| cells[first + k].parse().unwrap());
            (cells[..first].join(","), uv, cells[first + CHANNELS..].join(","))
        };
        Self { header: header.into(), rows: rows.lines().map(row).collect() }
    }

    fn with(&self, mut change: impl FnMut(&mut [f64; CHANNELS])) -> Self {
        let mut table = self.clone();
        table.rows.iter_mut().for_each(|(_, uv, _)| change(uv));
        table
    }

    /// Without the readings of the untouched pad and without time series.
    fn raw(&self) -> Self {
        let mut table = self.clone();
        table.rows.retain(|(label, ..)| label.contains("calibration,") || label.contains("spread,"));
        table
    }

    fn write(&self, path: &Path) {
        let row = |(before, uv, behind): &(String, [f64; CHANNELS], String)| {
            let uv: Vec<String> = uv.iter().map(f64::to_string).collect();
            format!("{before},{},{behind}\n", uv.join(","))
        };
        fs::write(path, format!("{}\n{}", self.header, self.rows.iter().map(row).collect::<String>()))
            .unwrap();
    }
}

/// Adapts to the table; the decoder is there only if it was written.
fn adapted(folder: &Path, table: &Table, options: &str) -> (Output, bool) {
    table.write(&folder.join("m.csv"));
    let decoder = folder.join("pad.decoder");
    let _ = fs::remove_file(&decoder);
    let output = tactpad(folder, &format!("adapt --measured m.csv --out pad.decoder {options}"));
    (output, decoder.exists())
}

const METHODS: [&str; 5] = ["inverse", "wrench", "linear", "knn", "scdf --from scdf"];

/// On a pad of this seed and with these choices of rows.
fn passes_without_a_word(folder: &Path, seed: u64, choices: &[&str]) {
    for plan in ["paper", "recommended"] {
        let table = Table::of_twin(folder, plan, seed);
        for (table, zeros) in [(&table, "tared"), (&table.raw(), "raw")] {
            for rows in choices {
                let (output, is_written) = adapted(folder, table, &format!("--method wrench {rows}"));
                assert!(output.status.success() && is_written, "{}", said(&output));
                let said = said(&output);
                assert!(!said.contains("warning"), "{plan} {seed} {zeros} {rows}: {said}");
            }
        }
    }
}

#[test]
#[ignore = "proof: 10 s: three pads with four choices of rows instead of one with two"]
fn tables_of_many_sound_pads_pass_without_a_word() {
    let folder = tempfile::tempdir().unwrap();
    for seed in 1..=3 {
        passes_without_a_word(folder.path(), seed, &["", "--rows 20", "--rows 10", "--rows 60 --seed 7"]);
    }
}

#[test]
fn tables_of_sound_pads_pass_without_a_word() {
    let folder = tempfile::tempdir().unwrap();
    passes_without_a_word(folder.path(), 1, &["", "--rows 10"]);
    let table = Table::of_twin(folder.path(), "paper", 4);
    for method in METHODS {
        let (output, is_written) = adapted(folder.path(), &table, &format!("--method {method} --rows 30"));
        assert!(
            output.status.success() && is_written && !said(&output).contains("warning"),
            "{}",
            said(&output)
        );
    }
}

/// Tables whose channels follow no contact: constant, each its noise, all the same noise, readings of other contacts.
fn rubbish(table: &Table, seed: u64) -> [Table; 4] {
    let mut random = SplitMix64::new(seed);
    let constant = table.with(|uv| *uv = [120.0; CHANNELS]);
    let noise = table.with(|uv| *uv = [0; CHANNELS].map(|_| 1000.0 * f64::from(random.normal())));
    let together = table.with(|uv| *uv = [1000.0 * f64::from(random.normal()); CHANNELS]);
    let mut channels: Vec<_> = table.rows.iter().map(|(_, uv, _)| *uv).collect();
    random.shuffle(&mut channels);
    let mut channels = channels.into_iter();
    let shuffled = table.with(|uv| *uv = channels.next().unwrap());
    [constant, noise, together, shuffled]
}

fn is_refused_by_every_method(folder: &Path, rubbish: &Table, rows: &str) {
    for method in METHODS {
        let (output, is_written) = adapted(folder, rubbish, &format!("--method {method} {rows}"));
        let said = said(&output);
        assert_eq!(output.status.code(), Some(2), "{method} {rows}: {said}");
        assert!(said.contains("m.csv: ") && said.contains("measure again"), "{said}");
        assert!(!is_written && output.stdout.is_empty());
    }
}

#[test]
fn channels_that_follow_no_contact_are_refused_by_every_method() {
    let folder = tempfile::tempdir().unwrap();
    let table = Table::of_twin(folder.path(), "paper", 1);
    for rubbish in rubbish(&table, 1) {
        is_refused_by_every_method(folder.path(), &rubbish, "");
    }
}

#[test]
#[ignore = "proof: 10 s: both plans, with zeros and without, all rows and few, instead of one of each"]
fn channels_that_follow_no_contact_are_refused_in_any_table() {
    let folder = tempfile::tempdir().unwrap();
    for (plan, seed) in [("paper", 1), ("recommended", 2)] {
        let table = Table::of_twin(folder.path(), plan, seed);
        for rubbish in rubbish(&table, seed) {
            for rows in ["", "--rows 20"] {
                is_refused_by_every_method(folder.path(), &rubbish, rows);
                is_refused_by_every_method(folder.path(), &rubbish.raw(), rows);
            }
        }
    }
}

/// Faults of a channel, and what is said of them.
fn faults(table: &Table, channel: usize, seed: u64) -> [(Table, String); 4] {
    let (name, other) = (CHANNEL_NAMES[channel], (channel + 4) % CHANNELS);
    let mut pair = [channel, other];
    pair.sort_unstable();
    let [low, high] = pair.map(|channel| CHANNEL_NAMES[channel]);
    let mut random = SplitMix64::new(seed);
    [
        (table.with(|uv| uv[channel] = 12.5), format!("channel {name} does not answer: ")),
        (
            table.with(|uv| uv[channel] = 20.0 * f64::from(random.normal())),
            format!("channel {name} does not answer: "),
        ),
        (table.with(|uv| uv[channel] = -uv[channel]), format!("channel {name} has the reverse sign: ")),
        (table.with(|uv| uv.swap(channel, other)), format!("channels {low} and {high} are swapped: ")),
    ]
}

fn is_told_by_name(folder: &Path, (faulty, wanted): &(Table, String), method: &str) {
    let (output, is_written) = adapted(folder, faulty, &format!("--method {method} --rows 100 --json"));
    assert!(output.status.success() && is_written, "{}", said(&output));
    assert!(said(&output).contains(&format!("warning: m.csv: {wanted}")), "{}", said(&output));
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(told["warnings"].as_array().map(Vec::len), Some(1), "{told}");
}

/// The same by the methods that take longer.
fn a_reversed_channel_is_told_by_name(folder: &Path, table: &Table) {
    let reversed = table.with(|uv| uv[7] = -uv[7]);
    for method in ["inverse", "scdf --from scdf"] {
        let (output, is_written) = adapted(folder, &reversed, &format!("--method {method} --rows 30"));
        assert!(output.status.success() && is_written, "{}", said(&output));
        assert!(said(&output).contains("m2y has the reverse sign"), "{}", said(&output));
    }
}

#[test]
fn one_fault_is_told_by_name_and_the_decoder_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let table = Table::of_twin(folder.path(), "paper", 3);
    for channel in 0..CHANNELS {
        let faults = faults(&table, channel, 3);
        is_told_by_name(folder.path(), &faults[channel % faults.len()], METHODS[1 + channel % 3]);
    }
    a_reversed_channel_is_told_by_name(folder.path(), &table);
}

#[test]
#[ignore = "proof: 10 s: each fault of each channel in both plans instead of one of each channel in one"]
fn any_one_fault_is_told_by_name_and_the_decoder_is_written() {
    let folder = tempfile::tempdir().unwrap();
    for (plan, seed) in [("paper", 3), ("recommended", 4)] {
        let table = Table::of_twin(folder.path(), plan, seed);
        for channel in 0..CHANNELS {
            for (index, fault) in faults(&table, channel, seed).iter().enumerate() {
                is_told_by_name(folder.path(), fault, METHODS[1 + (channel + index) % 3]);
            }
        }
        a_reversed_channel_is_told_by_name(folder.path(), &table);
    }
}

#[test]
fn two_faults_are_one_too_many() {
    let folder = tempfile::tempdir().unwrap();
    let table = Table::of_twin(folder.path(), "recommended", 5);
    let dead = table.with(|uv| (uv[1], uv[5]) = (3.0, -7.0));
    let turned = table.with(|uv| uv.rotate_left(3));
    for (faulty, words) in [
        (&dead, &["m0y does not answer", "m1z does not answer"][..]),
        // Cables in a circle read as labels in a turned frame do.
        (&turned, &["\"turn=-120\"", "the wiring is wrong"]),
    ] {
        let (output, is_written) = adapted(folder.path(), faulty, "--method linear");
        assert!(output.status.code() == Some(2) && !is_written, "{}", said(&output));
        assert!(words.iter().all(|word| said(&output).contains(word)), "{}", said(&output));
    }
}

/// A table of the paper's plan, measured on a pad of which one channel's gain is wrong.
fn one_gain_wrong(folder: &Path) {
    let pad = "[[module]]\nindex = 1\ngain = [1, 1, 1.12]\n[noise]\nadditive_uv = 10.0\n";
    fs::write(folder.join("one.toml"), pad).unwrap();
    let output = tactpad(folder, "twin --plan paper --seed 1 --imperfections one.toml --out m.csv");
    assert!(output.status.success(), "{}", said(&output));
}

/// What `adapt` finds by so many rows of it.
fn document(folder: &Path, rows: usize) -> serde_json::Value {
    let line = format!("adapt --method inverse --measured m.csv --out pad.decoder --rows {rows} --json");
    let output = tactpad(folder, &line);
    assert!(output.status.success(), "{}", said(&output));
    serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap()["pad"].clone()
}

fn all(value: &serde_json::Value) -> &[serde_json::Value] {
    value.as_array().unwrap_or_else(|| panic!("{value}"))
}

#[test]
fn only_what_a_diagnosis_names_has_a_name() {
    let folder = tempfile::tempdir().unwrap();
    one_gain_wrong(folder.path());
    let found = document(folder.path(), 200);
    let [finding, ..] = all(&found["findings"]) else { panic!("{found}") };
    assert_eq!(
        [&finding["status"], &finding["effect"], &finding["target"]],
        ["NAMED", "channel_gain", "m1z"]
    );
    assert!((finding["parameters"]["gain"]["value"].as_f64().unwrap() - 1.12).abs() < 0.005, "{finding}");
    let numbers = all(&found["numbers"]);
    // 9 gains, 30 poses and stiffnesses, 72 crosstalks, blur and ageing, 11 of the rig.
    assert!(numbers.len() >= 124, "{}", numbers.len());
    for number in numbers {
        let [deviation, prior] =
            ["deviation", "prior_deviation"].map(|key| number[key].as_f64().unwrap_or_default());
        // The prior of the rig's errors is a mixture: where the wide part is as likely, less is known than before.
        let is_of_rig = number["target"] == "rig" && number["name"] != "blur_mm2";
        let most = if is_of_rig { 1.5 } else { 1.001 };
        assert!(deviation > 0.0 && deviation < most * prior, "{number}");
        let told_by = if deviation <= 0.5 * prior { "data" } else { "prior" };
        assert_eq!(number["told_by"], told_by, "{number}");
        let is_the_gain = number["name"] == "gain" && number["target"] == "m1z";
        assert_eq!(number["named"], is_the_gain, "{number}");
    }
    let parameters = all(&found["parameters"]);
    assert!(parameters.len() == 30 && parameters.iter().all(|it| it["named"] == false), "{found}");
    // A frame that stretches a gauge less and a gauge of a smaller gain look alike.
    let apart = all(&found["not_told_apart"]);
    let correlation = |it: &serde_json::Value| it["correlation"].as_f64().unwrap().abs();
    assert!(!apart.is_empty() && apart.iter().all(|it| (0.9..1.0).contains(&correlation(it))), "{apart:?}");
}

#[test]
fn people_read_names_first_and_no_pose_or_stiffness_beside_a_size() {
    let folder = tempfile::tempdir().unwrap();
    one_gain_wrong(folder.path());
    let line = "adapt --method inverse --measured m.csv --out pad.decoder --rows 200";
    let output = tactpad(folder.path(), line);
    let text = String::from_utf8(output.stdout).unwrap();
    let (findings, coefficients) = text.split_once("The decoder's own coefficients.").unwrap();
    assert!(findings.contains("  channel_gain of m1z: gain 1.12"), "{text}");
    assert!(!text.contains("module.") && !findings.contains("module"), "{text}");
    let (coefficients, of_rig) = coefficients.split_once("\nWhether the stage stands").unwrap();
    assert!(of_rig.contains("A second session would"), "{text}");
    for line in coefficients.lines().filter(|line| line.contains('±') && !line.contains("± is")) {
        assert!(CHANNEL_NAMES.iter().any(|name| line.starts_with(name)), "{line}");
        assert!(!["stiffness", "tilt", "turn", "displacement"].iter().any(|it| line.contains(it)), "{line}");
    }
    assert_eq!(coefficients.lines().filter(|line| line.contains(" ± 0.0")).count(), CHANNELS, "{text}");
    assert!(coefficients.contains("30 poses and stiffnesses (") && coefficients.contains("no findings"));
    assert!(coefficients.contains("The data cannot tell "), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
}

#[test]
fn tables_that_tell_no_causes_apart_name_nothing_and_say_why() {
    let folder = tempfile::tempdir().unwrap();
    one_gain_wrong(folder.path());
    let found = document(folder.path(), 20);
    assert!(all(&found["findings"]).is_empty(), "{found}");
    assert!(all(&found["numbers"]).iter().all(|it| it["named"] == false), "{found}");
    let [why] = all(&found["not_diagnosed"]) else { panic!("{found}") };
    assert!(why.as_str().unwrap().contains("it takes 60 at least"), "{why}");
}
