//! `tactpad layout --sizes`: the device files that it writes, simulated by another verb, have the study's figures.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::Value;

use super::ran::{refused, tactpad};

const NOISE_UV: f64 = 6.0;

/// A step along the plate for slopes.
const STEP_MM: f64 = 0.2;

/// Runs a verb with its cache in `folder/cache`, and says what it prints.
fn printed(folder: &Path, line: &str) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.args(line.split(' ')).current_dir(folder).stdin(Stdio::null());
    let output = command.env("XDG_CACHE_HOME", folder.join("cache")).output().unwrap();
    assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// What the nine channels read, by `simulate` on a device file, for contacts [x, y, Fx, Fy, Fz].
fn simulated(folder: &Path, device: &str, contacts: &[[f64; 5]]) -> Vec<[f64; 9]> {
    let mut text = "x_mm,y_mm,fx_n,fy_n,fz_n\n".to_owned();
    for [x, y, fx, fy, fz] in contacts {
        writeln!(text, "{x:.6},{y:.6},{fx},{fy},{fz}").unwrap();
    }
    fs::write(folder.join("c.csv"), text).unwrap();
    let table = printed(folder, &format!("simulate --contacts c.csv --out - --device {device}"));
    let row = |line: &str| -> [f64; 9] {
        let cells: Vec<f64> = line.split(',').skip(5).map(|cell| cell.parse().unwrap()).collect();
        cells.try_into().unwrap()
    };
    table.lines().skip(1).map(row).collect()
}

/// σ √(trace of the x, y block of (JᵀJ)⁻¹), by Gauss and Jordan's elimination of JᵀJ beside the identity.
fn location_error_mm(columns: &[[f64; 9]; 5]) -> f64 {
    let dot = |a: &[f64; 9], b: &[f64; 9]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut rows: Vec<Vec<f64>> = (0..5)
        .map(|i| {
            let normal = (0..5).map(|j| dot(&columns[i], &columns[j]));
            normal.chain((0..5).map(|j| f64::from(u8::from(i == j)))).collect()
        })
        .collect();
    for k in 0..5 {
        let pivot = rows[k].clone();
        for (i, row) in rows.iter_mut().enumerate() {
            let factor = if i == k { 1.0 - 1.0 / pivot[k] } else { row[k] / pivot[k] };
            row.iter_mut().zip(&pivot).for_each(|(value, of_pivot)| *value -= factor * of_pivot);
        }
    }
    NOISE_UV * (rows[0][5] + rows[1][6]).sqrt()
}

/// Sensitivity and smallest error of a device file at a place, from what `simulate` says alone.
fn figures(folder: &Path, device: &str, [x, y]: [f64; 2]) -> [f64; 2] {
    // Two directions at right angles, both inwards: the place may be the farthest that a contact can have.
    let radius = x.hypot(y);
    let [u, v] = if radius > 0.0 { [-x / radius, -y / radius] } else { [1.0, 0.0] };
    let inwards = |turn_deg: f64| {
        let (sin, cos) = turn_deg.to_radians().sin_cos();
        [u * cos - v * sin, u * sin + v * cos]
    };
    let mut contacts =
        vec![[0.0, 0.0, 0.0, 0.0, 1.0], [x, y, 1.0, 0.0, 0.0], [x, y, 0.0, 1.0, 0.0], [x, y, 0.0, 0.0, 1.0]];
    for [u, v] in [inwards(45.0), inwards(-45.0)] {
        for steps in [1.0, 2.0] {
            contacts.push([x + steps * STEP_MM * u, y + steps * STEP_MM * v, 0.0, 0.0, 1.0]);
        }
    }
    let uv = simulated(folder, device, &contacts);
    // (−3 f(0) + 4 f(h) − f(2h))/(2h).
    let slope = |first: usize| -> [f64; 9] {
        std::array::from_fn(|c| (-3.0 * uv[3][c] + 4.0 * uv[first][c] - uv[first + 1][c]) / (2.0 * STEP_MM))
    };
    let sensitivity = uv[0][2] + uv[0][5] + uv[0][8];
    [sensitivity, location_error_mm(&[slope(4), slope(6), uv[1], uv[2], uv[3]])]
}

/// Of the pads that are chosen.
fn have_the_studys_figures(chosen: impl Fn(f64, f64) -> bool) {
    let folder = tempfile::tempdir().unwrap();
    let document = printed(folder.path(), "layout --sizes --devices pads --figures pictures --json");
    let study: Value = serde_json::from_str(&document).unwrap();
    let pads = study["pads"].as_array().unwrap();
    assert_eq!(pads.len(), 40);
    assert_eq!(fs::read_dir(folder.path().join("pads")).unwrap().count(), 40);
    for name in ["size-sensitivity", "size-error", "size-frequency"] {
        assert!(folder.path().join(format!("pictures/{name}.svg")).is_file(), "{name}");
    }
    for pad in pads {
        let number = |key: &str| pad[key].as_f64().unwrap();
        let (diameter_mm, thickness_mm) = (number("diameter_mm"), number("thickness_mm"));
        if !chosen(diameter_mm, thickness_mm) {
            continue;
        }
        let worst = &pad["precision"];
        let place = [0, 1].map(|axis: usize| worst["worst_at_mm"][axis].as_f64().unwrap());
        let device = format!("pads/pad-{diameter_mm}x{thickness_mm}.toml");
        let [sensitivity, error_mm] = figures(folder.path(), &device, place);
        let wanted = [number("sensitivity_uv_per_n"), worst["worst_mm"].as_f64().unwrap()];
        assert!((sensitivity / wanted[0] - 1.0).abs() < 1e-3, "{device}: {sensitivity} for {}", wanted[0]);
        assert!((error_mm / wanted[1] - 1.0).abs() < 0.01, "{device}: {error_mm} for {}", wanted[1]);
    }
    for law in study["laws"].as_array().unwrap() {
        assert!(law["pads"].as_u64().unwrap() >= 10, "{law}");
    }
}

#[test]
#[ignore = "proof: 60 s: the study of forty pads, and five of them solved for: the nominal one and corners of the grid"]
fn device_files_of_the_study_have_its_figures() {
    let chosen = [(30.0, 0.5), (30.0, 3.0), (60.0, 1.0), (150.0, 0.5), (150.0, 3.0)];
    have_the_studys_figures(|diameter_mm, thickness_mm| chosen.contains(&(diameter_mm, thickness_mm)));
}

#[test]
#[ignore = "proof: 300 s: all forty pads of the study are solved for"]
fn all_device_files_of_the_study_have_its_figures() {
    have_the_studys_figures(|_, _| true);
}

#[test]
fn the_study_takes_no_radii() {
    let folder = tempfile::tempdir().unwrap();
    assert!(refused(folder.path(), "layout --sizes --radii 33,33,33").contains("cannot be used with"));
    assert!(refused(folder.path(), "layout --devices pads").contains("--sizes"));
    let output = tactpad(folder.path(), "layout --sizes --noise-uv 0");
    assert_eq!(output.status.code(), Some(2));
}
