//! `tactpad simulate` on pads other than the nominal one, and the cache of their fields.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::LazyLock;

use tactpad::mechanics::simulator::PLATE_DEGREE;
use tactpad::numeric::zernike::jets;
use tactpad::pad::changes::FieldChanges;
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;
use tempfile::TempDir;

/// A folder with three contacts, `c.csv`.
fn scene() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let contacts = "x_mm,y_mm,fx_n,fy_n,fz_n\n0,0,0.5,-1,5\n20,0,0,0,3\n-9,21,1,1,1\n";
    fs::write(folder.path().join("c.csv"), contacts).unwrap();
    folder
}

/// Runs `simulate` with its cache in `folder/cache`.
fn simulate(folder: &Path, line: &str) -> Output {
    tactpad(folder, &format!("simulate {line}"))
}

/// Runs a verb with its cache in `folder/cache`.
fn tactpad(folder: &Path, line: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.args(line.split(' ')).current_dir(folder).stdin(Stdio::null());
    command.env("XDG_CACHE_HOME", folder.join("cache")).output().unwrap()
}

/// What the channels read for the three contacts on the pad of these arguments.
fn channels_uv(folder: &Path, pad: &str) -> Vec<[f64; 9]> {
    let output = simulate(folder, format!("--contacts c.csv --out - {pad}").trim());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let table = String::from_utf8(output.stdout).unwrap();
    let row = |line: &str| -> [f64; 9] {
        let cells: Vec<f64> = line.split(',').skip(5).map(|cell| cell.parse().unwrap()).collect();
        cells.try_into().unwrap()
    };
    table.lines().skip(1).map(row).collect()
}

fn assert_near(found: &[[f64; 9]], wanted: &[[f64; 9]]) {
    assert_eq!(found.len(), wanted.len());
    for (found, wanted) in found.as_flattened().iter().zip(wanted.as_flattened()) {
        assert!((found - wanted).abs() < 0.002, "{found} instead of {wanted}");
    }
}

#[test]
fn gains_and_offsets_are_the_modules() {
    let folder = scene();
    let mut wanted = channels_uv(folder.path(), "");
    let text = "[[module]]\nindex = 1\ngain = [1.0, 1.5, 1.0]\n\n[[module]]\nindex = 2\noffset_uv = [0.0, 0.0, -300.0]\n";
    fs::write(folder.path().join("i.toml"), text).unwrap();
    for row in &mut wanted {
        row[4] *= 1.5;
        row[8] -= 300.0;
    }
    assert_near(&channels_uv(folder.path(), "--imperfections i.toml"), &wanted);
    assert!(!folder.path().join("cache").exists(), "the program has the nominal field");
}

#[test]
fn exact_bridges_are_those_of_the_fields_sums() {
    let folder = scene();
    let exact =
        Device::nominal().to_toml().replace("bridge_nonlinearity = false", "bridge_nonlinearity = true");
    fs::write(folder.path().join("d.toml"), exact).unwrap();
    let linear = channels_uv(folder.path(), "");
    let sums = PadField::nominal().sums;
    let contacts = [[0.0, 0.0, 0.5, -1.0, 5.0], [20.0, 0.0, 0.0, 0.0, 3.0], [-9.0, 21.0, 1.0, 1.0, 1.0]];
    let exact = |([x_mm, y_mm, fx_n, fy_n, fz_n], linear): ([f32; 5], &[f64; 9])| -> [f64; 9] {
        let contact = tactpad::quantity::Contact { x_mm, y_mm, fx_n, fy_n, fz_n };
        let sum_uv = sums.strain_uv(&contact).uv;
        std::array::from_fn(|k| linear[k] / (1.0 + 0.5 * f64::from(sum_uv[k]) / 2.8e6))
    };
    let wanted: Vec<_> = contacts.into_iter().zip(&linear).map(exact).collect();
    let found = channels_uv(folder.path(), "--device d.toml");
    assert_near(&found, &wanted);
    let differs = found.as_flattened().iter().zip(linear.as_flattened()).any(|(a, b)| (a - b).abs() > 0.1);
    assert!(differs, "5 N bend the bridges");
}

/// A pad with a thicker plate as `d.toml`, and the file that its field is kept in.
fn thicker(folder: &Path) -> (Device, PathBuf) {
    let text = Device::nominal().to_toml().replace("thickness_mm = 1.0 ", "thickness_mm = 1.15 ");
    fs::write(folder.join("d.toml"), &text).unwrap();
    let device = Device::from_toml(&text).0.unwrap();
    assert_eq!(device.plate.thickness_mm, 1.15);
    let name = format!("{:016x}.field", device.fingerprint());
    (device, folder.join("cache/tactpad").join(name))
}

#[test]
fn a_field_that_is_kept_is_used() {
    let folder = scene();
    let (device, path) = thicker(folder.path());
    let nominal = PadField::nominal();
    let mut halved = nominal.signals.coefficients();
    halved.iter_mut().for_each(|c| *c /= 2.0);
    let [spacing_mm, radius_mm] = [nominal.signals.spacing_mm(), nominal.signals.radius_mm()];
    let signals =
        tactpad::pad::influence::InfluenceField::from_coefficients(spacing_mm, radius_mm, &halved).unwrap();
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(&path, PadField { signals, ..nominal }.to_bytes(&device)).unwrap();
    let mut wanted = channels_uv(folder.path(), "");
    wanted.as_flattened_mut().iter_mut().for_each(|uv| *uv /= 2.0);
    assert_near(&channels_uv(folder.path(), "--device d.toml"), &wanted);
}

/// The field of the thicker pad, as the program keeps it. A solution takes seconds.
static COMPUTED: LazyLock<Vec<u8>> = LazyLock::new(computed_instead_of_a_damaged_file);

fn computed_instead_of_a_damaged_file() -> Vec<u8> {
    let folder = scene();
    let (device, path) = thicker(folder.path());
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    let mut bytes = PadField::nominal().to_bytes(&device);
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&path, &bytes).unwrap();
    let (nominal, found) =
        (channels_uv(folder.path(), "")[0], channels_uv(folder.path(), "--device d.toml")[0]);
    // The contact in the middle; the slope at the nominal pad is right to first order.
    let slopes = PadField::nominal().sensitivities;
    let slope = slopes.iter().find(|slope| slope.parameter.name() == "plate.thickness_mm").unwrap();
    let here = jets(PLATE_DEGREE, [0.0; 2]);
    let expected = slope
        .maps
        .each_ref()
        .map(|[x, y, z]| 0.15 * (0.5 * x.value(&here) - y.value(&here) + 5.0 * z.value(&here)));
    let largest = expected.iter().copied().map(f64::abs).fold(0.0, f64::max);
    for channel in 0..9 {
        let change = found[channel] - nominal[channel];
        assert!((change - expected[channel]).abs() < 0.25 * largest, "{channel}: {change} {expected:?}");
    }
    assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 1, "nothing unfinished is left");
    fs::read(&path).unwrap()
}

#[test]
fn a_damaged_file_is_computed_anew_and_replaced() {
    let (device, _) = thicker(scene().path());
    let field = PadField::from_bytes(&COMPUTED, &device).unwrap();
    assert_eq!(field.sensitivities.len(), PadField::nominal().sensitivities.len());
}

/// Sensitivities are rounded in the file, so a run that computes a field must not go on with finer ones. What flaws change in it takes a
/// minute more; it is kept already, or computed as well.
fn calibrates_as_the_field_that_is_kept(are_changes_kept: bool) {
    let folder = scene();
    let (device, path) = thicker(folder.path());
    let done = |line: &str| {
        let output = tactpad(folder.path(), line);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    };
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(&path, &*COMPUTED).unwrap();
    if are_changes_kept {
        fs::write(path.with_extension("changes"), FieldChanges::nominal().to_bytes(&device)).unwrap();
    }
    done("twin --plan paper --seed 1 --device d.toml --out m.csv");
    fs::remove_file(&path).unwrap();
    for out in ["computed", "kept"] {
        done(&format!("adapt --method inverse --measured m.csv --rows 20 --device d.toml --out {out}"));
        assert!(path.exists());
    }
    let [computed, kept] = ["computed", "kept"].map(|out| fs::read(folder.path().join(out)).unwrap());
    assert!(computed == kept, "the first run wrote another decoder than the second");
}

#[test]
#[ignore = "proof: 12 s: another solution of a module; that a damaged field is computed anew stays a test"]
fn a_field_that_was_just_computed_calibrates_as_the_one_that_is_kept() {
    calibrates_as_the_field_that_is_kept(true);
}

#[test]
#[ignore = "proof: 60 s: what flaws change in the field is computed, too"]
fn a_field_and_changes_that_were_just_computed_calibrate_as_those_that_are_kept() {
    calibrates_as_the_field_that_is_kept(false);
}

#[test]
fn the_pads_files_are_not_written_over() {
    let folder = scene();
    thicker(folder.path());
    fs::write(folder.path().join("i.toml"), "[[module]]\nindex = 1\nradial_mm = 0.1\n").unwrap();
    for (out, what) in [("d.toml", "is the device"), ("./i.toml", "is the file of imperfections")] {
        let line = format!("--contacts c.csv --device d.toml --imperfections i.toml --out {out}");
        let (before, output) = (fs::read(folder.path().join(out)).unwrap(), simulate(folder.path(), &line));
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(&format!("{out} {what} and would be written over")), "{said}");
        assert_eq!(fs::read(folder.path().join(out)).unwrap(), before);
    }
}

#[test]
fn a_device_that_cannot_be_is_refused_before_anything_is_written() {
    let folder = scene();
    fs::write(folder.path().join("d.toml"), "[plate]\ndiameter_mm = -1\n").unwrap();
    let output = simulate(folder.path(), "--contacts c.csv --device d.toml --out new.csv");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("device d.toml cannot be used"), "{said}");
    assert!(!folder.path().join("new.csv").exists());
}
