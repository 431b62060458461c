//! The paper's two stages: what is learnt from the simulated pad, and what a few measured contacts change.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::OnceLock;

use serde_json::Value;
use tactpad::lab::scdf::adaptation::{self, BETAS, ROWS_MIN, TooFew};
use tactpad::lab::scdf::simulation::{examples, pretrain};
use tactpad::network::training::score::Scores;
use tactpad::network::{Example, Network, Zero, onnx};
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;
use tactpad::tables::measured::columns::TableKind;
use tactpad::tables::measured::{read, zero};

/// Contacts that the small network of these tests learns from.
const CONTACTS: usize = 3_000;

fn simulated(seed: u64) -> Vec<Example> {
    let mut examples = examples(&Device::nominal(), &PadField::nominal(), seed);
    examples.truncate(CONTACTS);
    examples
}

/// A small network after stage I.
fn small() -> &'static Network {
    static NETWORK: OnceLock<Network> = OnceLock::new();
    NETWORK.get_or_init(|| pretrain(&[24, 24], simulated(1), 2, |_| ()).trained.network)
}

/// As another pad reads them: its channels have gains.
fn of_another_pad(mut examples: Vec<Example>) -> Vec<Example> {
    let gains = [1.26, 1.33, 0.83, 1.29, 1.26, 0.99, 1.27, 1.33, 0.84];
    for example in &mut examples {
        example.uv.iter_mut().zip(gains).for_each(|(uv, gain)| *uv *= gain);
    }
    examples
}

#[test]
fn stage_one_learns_the_pad() {
    let mut epochs = 0;
    let learnt = pretrain(&[24, 24], simulated(1), 2, |_| epochs += 1);
    assert_eq!((epochs, learnt.trained.curve.len(), learnt.test.len()), (300, 300, CONTACTS / 10));
    // A fifth of the contacts and a twentieth of the weights come to the paper's figures, too.
    assert!(learnt.scores.all.mse < 0.02 && learnt.scores.all.r2 > 0.98, "{:?}", learnt.scores.all);
    assert_eq!(&learnt.trained.network, small(), "the same seeds give the same network");
}

#[test]
fn stage_two_takes_to_another_pad_and_few_contacts_are_refused() {
    let pad = of_another_pad(simulated(4));
    let (known, unknown) = pad.split_at(600);
    let before = Scores::of(small(), unknown).all;
    let adapted = adaptation::adapt(small(), known.to_vec(), 1, |_, _| ()).unwrap();
    let after = Scores::of(&adapted.trained.network, unknown).all;
    assert!(after.mse < 0.5 * before.mse && after.mae < 0.6 * before.mae, "{before:?} {after:?}");
    assert_eq!(adapted.sweep.map(|(beta, _)| beta), BETAS);
    assert!(adapted.sweep.iter().all(|(_, mse)| *mse >= adapted.trained.validation_mse));
    let few = adaptation::adapt(small(), known[..ROWS_MIN - 1].to_vec(), 1, |_, _| ());
    assert_eq!(few.err(), Some(TooFew(ROWS_MIN - 1)));
}

fn tactpad(folder: &Path, line: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    let output =
        command.args(line.split(' ')).current_dir(folder).env("RUST_BACKTRACE", "1").output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!said.contains("panicked"), "{said}");
    output
}

/// Runs a line that is refused as unusable, and gives what is said.
fn refused(folder: &Path, line: &str) -> String {
    let output = tactpad(folder, line);
    assert_eq!(output.status.code(), Some(2), "{line}");
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn adapt_writes_a_network_that_fits_the_measured_pad_better() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("start.onnx"), onnx::write(small())).unwrap();
    assert!(tactpad(folder, "twin --plan paper --seed 1 --out m.csv").status.success());
    let line = "adapt --method scdf --measured m.csv --from start.onnx --out mine.onnx --json";
    let output = tactpad(folder, line);
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (&report["rows"], &report["tared"], &report["method"]),
        (&648.into(), &true.into(), &"scdf".into())
    );
    let bytes = fs::read(folder.join("mine.onnx")).unwrap();
    assert!(tactpad(folder, line).status.success() && bytes == fs::read(folder.join("mine.onnx")).unwrap());
    let mine = onnx::read(&bytes).unwrap();
    let table = fs::read(folder.join("m.csv")).unwrap();
    let table = zero::tared(&read::table(&table[..], TableKind::Measured, 30.0).unwrap()).unwrap();
    let rows = table.rows_at(&zero::contacts(&table));
    let pad = adaptation::examples(&rows);
    let [before, after] = [small(), &mine].map(|network| Scores::of(network, &pad).all.mse);
    assert!(after < 0.5 * before, "{before} {after}");
}

#[test]
fn a_table_without_zeros_is_taken_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("start.onnx"), onnx::write(small())).unwrap();
    let contacts: String = (0..20).map(|k| format!("{k},{},0,0.5,{}\n", -k, 1 + k % 4)).collect();
    fs::write(folder.join("c.csv"), format!("x_mm,y_mm,fx_n,fy_n,fz_n\n{contacts}")).unwrap();
    assert!(tactpad(folder, "simulate --contacts c.csv --out m.csv").status.success());
    let output =
        tactpad(folder, "adapt --method scdf --measured m.csv --from start.onnx --out mine.onnx --rows 12");
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(
        said.starts_with("12 contacts, channels raw, as the table has no reading of the untouched pad"),
        "{said}"
    );
    let mine = onnx::read(&fs::read(folder.join("mine.onnx")).unwrap()).unwrap();
    assert_eq!(mine.zero, Zero::Raw);
}

#[test]
fn what_cannot_be_used_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("start.onnx"), onnx::write(small())).unwrap();
    fs::write(folder.join("c.csv"), "x_mm,y_mm,fx_n,fy_n,fz_n\n1,2,0,0,1\n").unwrap();
    assert!(tactpad(folder, "simulate --contacts c.csv --out m.csv").status.success());
    let adapt = |rest: &str| refused(folder, &format!("adapt --method scdf --measured m.csv {rest}"));
    assert!(adapt("--out o.onnx").contains("give it as --from scdf.onnx"));
    assert!(adapt("--from start.onnx --out m.csv").contains("m.csv is the measured table"));
    assert!(
        adapt("--from start.onnx --out o.onnx").contains("m.csv: the network needs at least 10 contacts")
    );
    assert!(adapt("--from c.csv --out o.onnx").contains("decoder c.csv cannot be read: it is no ONNX model"));
    assert!(adapt("--from none.onnx --out o.onnx").contains("No such file"));
    assert!(adapt("--from start.onnx --out - --json").contains("both print"));
    assert!(refused(folder, "train --out - --json").contains("both print"));
    assert!(!folder.join("o.onnx").exists());
}
