//! `tactpad adapt`: which tables a decoder is made of, which are refused, and of what it warns.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use tactpad::numeric::random::SplitMix64;
use tactpad::quantity::{CHANNEL_NAMES, CHANNELS};

/// A pad with unequal gains, offsets, noise and a drifting zero, whose field is the nominal one.
const PAD: &str = "[[module]]\nindex = 0\ngain = [1.26, 1.33, 0.83]\noffset_uv = [300, -200, 500]\n\
    [[module]]\nindex = 1\ngain = [1.29, 1.26, 0.99]\noffset_uv = [-150, 80, 900]\n\
    [thermal]\nzero_uv_per_c = [30, 25, 20, 15, 10, 5, -5, -10, -15]\n[noise]\nadditive_uv = 30.0\n";

fn tactpad(folder: &Path, line: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.args(line.split_whitespace()).current_dir(folder).stdin(Stdio::null());
    let output = command.env("RUST_BACKTRACE", "1").output().unwrap();
    assert!(!said(&output).contains("panicked"), "{}", said(&output));
    output
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

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

#[test]
fn tables_of_sound_pads_pass_without_a_word() {
    let folder = tempfile::tempdir().unwrap();
    for plan in ["paper", "recommended"] {
        for seed in 1..=3 {
            let table = Table::of_twin(folder.path(), plan, seed);
            for (table, zeros) in [(&table, "tared"), (&table.raw(), "raw")] {
                for rows in ["", "--rows 20", "--rows 10", "--rows 60 --seed 7"] {
                    let (output, is_written) =
                        adapted(folder.path(), table, &format!("--method wrench {rows}"));
                    assert!(output.status.success() && is_written, "{}", said(&output));
                    assert!(
                        !said(&output).contains("warning"),
                        "{plan} {seed} {zeros} {rows}: {}",
                        said(&output)
                    );
                }
            }
        }
    }
    let table = Table::of_twin(folder.path(), "paper", 4);
    for method in METHODS {
        let (output, is_written) = adapted(folder.path(), &table, &format!("--method {method} --rows 60"));
        assert!(
            output.status.success() && is_written && !said(&output).contains("warning"),
            "{}",
            said(&output)
        );
    }
}

#[test]
fn channels_that_follow_no_contact_are_refused_by_every_method() {
    let folder = tempfile::tempdir().unwrap();
    for (plan, seed) in [("paper", 1), ("recommended", 2)] {
        let table = Table::of_twin(folder.path(), plan, seed);
        let mut random = SplitMix64::new(seed);
        let constant = table.with(|uv| *uv = [120.0; CHANNELS]);
        let noise = table.with(|uv| *uv = [0; CHANNELS].map(|_| 1000.0 * f64::from(random.normal())));
        let together = table.with(|uv| *uv = [1000.0 * f64::from(random.normal()); CHANNELS]);
        let mut channels: Vec<_> = table.rows.iter().map(|(_, uv, _)| *uv).collect();
        random.shuffle(&mut channels);
        let mut channels = channels.into_iter();
        let shuffled = table.with(|uv| *uv = channels.next().unwrap());
        for rubbish in [constant, noise, together, shuffled] {
            for rubbish in [rubbish.raw(), rubbish] {
                for method in METHODS {
                    for rows in ["", "--rows 20"] {
                        let (output, is_written) =
                            adapted(folder.path(), &rubbish, &format!("--method {method} {rows}"));
                        let said = said(&output);
                        assert_eq!(output.status.code(), Some(2), "{plan} {method} {rows}: {said}");
                        assert!(said.contains("m.csv: ") && said.contains("measure again"), "{said}");
                        assert!(!is_written && output.stdout.is_empty());
                    }
                }
            }
        }
    }
}

#[test]
fn one_fault_is_told_by_name_and_the_decoder_is_written() {
    let folder = tempfile::tempdir().unwrap();
    for (plan, seed) in [("paper", 3), ("recommended", 4)] {
        let table = Table::of_twin(folder.path(), plan, seed);
        for channel in 0..CHANNELS {
            let (name, other) = (CHANNEL_NAMES[channel], (channel + 4) % CHANNELS);
            let mut pair = [channel, other];
            pair.sort_unstable();
            let [low, high] = pair.map(|channel| CHANNEL_NAMES[channel]);
            let mut random = SplitMix64::new(seed);
            let faults = [
                (table.with(|uv| uv[channel] = 12.5), format!("channel {name} does not answer: ")),
                (
                    table.with(|uv| uv[channel] = 20.0 * f64::from(random.normal())),
                    format!("channel {name} does not answer: "),
                ),
                (
                    table.with(|uv| uv[channel] = -uv[channel]),
                    format!("channel {name} has the reverse sign: "),
                ),
                (
                    table.with(|uv| uv.swap(channel, other)),
                    format!("channels {low} and {high} are swapped: "),
                ),
            ];
            for (index, (faulty, wanted)) in faults.iter().enumerate() {
                let method = METHODS[1 + (channel + index) % 3];
                let (output, is_written) =
                    adapted(folder.path(), faulty, &format!("--method {method} --rows 100 --json"));
                assert!(output.status.success() && is_written, "{}", said(&output));
                assert!(said(&output).contains(&format!("warning: m.csv: {wanted}")), "{}", said(&output));
                let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
                assert_eq!(told["warnings"].as_array().map(Vec::len), Some(1), "{told}");
            }
        }
        let reversed = table.with(|uv| uv[7] = -uv[7]);
        for method in ["inverse", "scdf --from scdf"] {
            let (output, is_written) =
                adapted(folder.path(), &reversed, &format!("--method {method} --rows 30"));
            assert!(output.status.success() && is_written, "{}", said(&output));
            assert!(said(&output).contains("m2y has the reverse sign"), "{}", said(&output));
        }
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
        (&turned, &["are swapped", "mend the wiring or the columns"]),
    ] {
        let (output, is_written) = adapted(folder.path(), faulty, "--method linear");
        assert!(output.status.code() == Some(2) && !is_written, "{}", said(&output));
        assert!(words.iter().all(|word| said(&output).contains(word)), "{}", said(&output));
    }
}
