//! The simulator against solutions of an independent program: `crates/mechanics/tests/mechanics/reference/README.md`.

#![expect(clippy::unwrap_used, clippy::print_stdout, reason = "a test may stop at what it did not expect")]

use std::fs;
use std::path::Path;

use tactpad_core::pad::device::{Device, Side};
use tactpad_core::pad::field::{ForceMaps, PadField};
use tactpad_core::pad::influence::MAPS;
use tactpad_core::quantity::CHANNELS;
use tactpad_mechanics::simulator::PLATE_DEGREE;
use tactpad_numeric::zernike::jets;

use crate::standard::SIMULATOR;

fn signals(device: &Device) -> [ForceMaps; CHANNELS] {
    SIMULATOR.lock().unwrap().pad(device).unwrap().signals()
}

fn read(file: &str) -> Vec<Vec<String>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/mechanics/reference").join(file);
    let text = fs::read_to_string(path).unwrap();
    text.lines().skip(1).map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

/// Rows of a field's table: place, and the 27 readings per newton.
fn table(file: &str) -> Vec<([f64; 2], [f64; MAPS])> {
    let row = |row: Vec<String>| {
        let numbers: Vec<f64> = row.iter().map(|number| number.parse().unwrap()).collect();
        ([numbers[0], numbers[1]], numbers[2..].try_into().unwrap())
    };
    read(file).into_iter().map(row).collect()
}

fn at(maps: &[ForceMaps; CHANNELS], place_mm: [f64; 2]) -> [f64; MAPS] {
    let jets = jets(PLATE_DEGREE, place_mm.map(|mm| mm / 30.0));
    let mut values = [0.0; MAPS];
    values.iter_mut().zip(maps.iter().flatten()).for_each(|(value, map)| *value = map.value(&jets));
    values
}

/// Sums of squares of errors and of the reference, by channel type and load axis.
#[derive(Default)]
struct Errors {
    error: [[f64; 3]; 3],
    size: [[f64; 3]; 3],
}

impl Errors {
    fn add(&mut self, kind: usize, axis: usize, value: f64, wanted: f64) {
        self.error[kind][axis] += (value - wanted).powi(2);
        self.size[kind][axis] += wanted * wanted;
    }

    fn check(&self, what: &str) {
        for kind in 0..3 {
            for axis in 0..3 {
                let share = (self.error[kind][axis] / self.size[kind][axis]).sqrt();
                let (signal, load) = (["Sx", "Sy", "Sz"][kind], ["Fx", "Fy", "Fz"][axis]);
                println!("{what}: {signal} under {load}: {:.2} %", 100.0 * share);
                let bar = if (kind, axis) == (0, 2) { 0.03 } else { 0.015 };
                assert!(share < bar, "{what}: {signal} under {load}: {share}");
            }
        }
    }
}

#[test]
fn the_reference_points_are_met() {
    let maps = signals(&Device::nominal());
    let field = PadField::nominal().signals;
    let (mut polynomials, mut splines) = (Errors::default(), Errors::default());
    for row in read("points.csv") {
        let place: [f64; 2] = [row[0].parse().unwrap(), row[1].parse().unwrap()];
        let axis = ["x", "y", "z"].iter().position(|name| *name == row[2]).unwrap();
        let (values, gains) = (at(&maps, place), field.gains(place[0] as f32, place[1] as f32));
        for channel in 0..CHANNELS {
            let wanted: f64 = row[3 + channel].parse().unwrap();
            polynomials.add(channel % 3, axis, values[3 * channel + axis], wanted);
            splines.add(channel % 3, axis, gains.value[channel][axis], wanted);
        }
    }
    polynomials.check("simulator");
    splines.check("shipped field");
}

#[test]
fn the_reference_field_is_met_everywhere() {
    let field = PadField::nominal().signals;
    let mut errors = Errors::default();
    for ([x, y], wanted) in table("nominal.csv") {
        let gains = field.gains(x as f32, y as f32);
        for (map, wanted) in wanted.into_iter().enumerate() {
            errors.add(map / 3 % 3, map % 3, gains.value[map / 3][map % 3], wanted);
        }
    }
    errors.check("whole field");
}

/// The error of a change, over all channels, loads and places, as a share of the change.
fn error_of_change(file: &str, change: impl Fn(&mut Device)) -> f64 {
    let nominal = Device::nominal();
    let mut device = nominal.clone();
    change(&mut device);
    let (before, after) = (signals(&nominal), signals(&device));
    let reference = table("nominal.csv");
    let (mut error, mut size) = (0.0, 0.0);
    for (place, changed) in table(file) {
        let (_, original) = reference.iter().find(|(other, _)| *other == place).unwrap();
        let (here, there) = (at(&before, place), at(&after, place));
        for map in 0..MAPS {
            let wanted = changed[map] - original[map];
            error += (there[map] - here[map] - wanted).powi(2);
            size += wanted * wanted;
        }
    }
    let share = (error / size).sqrt();
    println!("{file}: {:.2} % of the change", 100.0 * share);
    share
}

#[test]
fn a_thicker_plate_changes_the_channels_as_in_the_reference() {
    assert!(error_of_change("plate_1p15.csv", |device| device.plate.thickness_mm = 1.15) < 0.05);
}

#[test]
fn a_moved_module_changes_the_channels_as_in_the_reference() {
    let moved = |device: &mut Device| {
        (device.modules[0].radial_mm, device.modules[0].tangential_mm) = (-0.7, 0.9);
    };
    assert!(error_of_change("m0_moved.csv", moved) < 0.05);
}

#[test]
fn a_turned_module_changes_the_channels_as_in_the_reference() {
    assert!(error_of_change("m1_turned.csv", |device| device.modules[1].rotation_deg = -5.0) < 0.05);
}

#[test]
#[ignore = "proof: 10 s: another module to solve for; an open frame is one, and stays a test"]
fn a_softer_frame_changes_the_channels_as_in_the_reference() {
    assert!(error_of_change("m2_soft_frame.csv", |device| device.modules[2].frame_e_factor = 0.6) < 0.05);
}

#[test]
fn an_open_frame_changes_the_channels_as_in_the_reference() {
    let open = |device: &mut Device| device.modules[0].frame_open = Some(Side::MinusX);
    assert!(error_of_change("m0_open_frame.csv", open) < 0.05);
}
