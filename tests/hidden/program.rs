//! The program, from outside.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

use crate::plan::Contact;
use crate::truth::CHANNELS;

/// A folder of its own below the tests' temporary one.
pub(crate) fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("hidden").join(name);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// What the simulator reads for the contacts, on a device (`--device`) or with imperfections (`--imperfections`) of this
/// text.
pub(crate) fn simulated(contacts: &[Contact], pad: Option<(&str, &str)>) -> Vec<[f64; 9]> {
    let folder = tempfile::tempdir().unwrap();
    let [places, out, device] =
        ["places.csv", "signals.csv", "pad.toml"].map(|name| folder.path().join(name));
    let mut table = String::from("x_mm,y_mm,fx_n,fy_n,fz_n\n");
    for Contact { place: [x, y], force: [fx, fy, fz] } in contacts {
        writeln!(table, "{x},{y},{fx},{fy},{fz}").unwrap();
    }
    fs::write(&places, table).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.args(["simulate", "--contacts"]).arg(&places).arg("--out").arg(&out);
    if let Some((option, text)) = pad {
        fs::write(&device, text).unwrap();
        command.arg(option).arg(&device);
    }
    done(command.output().unwrap());
    channels(&fs::read_to_string(&out).unwrap())
}

fn channels(table: &str) -> Vec<[f64; 9]> {
    let header: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let column = |channel: &str| header.iter().position(|name| *name == format!("{channel}_uv")).unwrap();
    let columns = CHANNELS.map(column);
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        columns.map(|column| cells[column].parse().unwrap())
    };
    table.lines().skip(1).map(row).collect()
}

/// The plan as the program writes it.
pub(crate) fn protocol(name: &str, seed: u64) -> String {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("plan.csv");
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.args(["protocol", name, "--seed", &seed.to_string(), "--out"]).arg(&file);
    done(command.output().unwrap());
    fs::read_to_string(file).unwrap()
}

/// A diagnosis of a measured table, and how the program ended. `more` are further options.
pub(crate) fn diagnosed(measured: &Path, more: &[&str]) -> Result<Value, String> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.args(["diagnose", "--json", "--measured"]).arg(measured).args(more);
    document(command, measured)
}

/// The same of several measurements, and the plan that the program writes for the next one; none where it has none to propose.
pub(crate) fn diagnosed_together(measured: &[PathBuf], plan: &Path) -> (Value, Option<String>) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.args(["diagnose", "--json", "--next"]).arg(plan);
    measured.iter().for_each(|path| {
        command.arg("--measured").arg(path);
    });
    let diagnosis = document(command, plan).unwrap();
    (diagnosis, fs::read_to_string(plan).ok())
}

/// What the program says of a pad that it calibrates; the decoder is written.
pub(crate) fn calibrated(measured: &Path, decoder: &Path) -> Value {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.args(["adapt", "--method", "inverse", "--json", "--measured"]).arg(measured);
    command.arg("--out").arg(decoder);
    document(command, measured).unwrap()
}

/// A decoder's errors on a table whose true contacts are known.
pub(crate) fn evaluated(decoder: &Path, measured: &Path, truth: &Path) -> Value {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.args(["evaluate", "--json", "--decoder"]).arg(decoder);
    command.arg("--measured").arg(measured).arg("--truth").arg(truth);
    document(command, measured).unwrap()
}

/// The program's JSON, or what it said instead.
fn document(mut command: Command, about: &Path) -> Result<Value, String> {
    // Several run side by side.
    let output = command.env("RAYON_NUM_THREADS", "1").output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!said.contains("panicked"), "{}: {said}", about.display());
    if !output.status.success() {
        return Err(said.into_owned());
    }
    serde_json::from_slice(&output.stdout).map_err(|fault| format!("{fault} in the program's JSON"))
}

fn done(output: Output) {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}
