//! The statics decoder: its numbers come from the nominal field; what it decodes is held against an independent
//! finite-element solution of the whole pad.
#![expect(clippy::unwrap_used, reason = "a test may stop at what it did not expect")]

use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::PadField;
use tactpad_core::pipeline::contact::statics::{Statics, StaticsModel};
use tactpad_core::quantity::{CHANNELS, Contact, MODULES, Strain};

const TABLE: &str = include_str!("reference/nominal.csv");
const MODULE_RADIUS_MM: f64 = 20.0;

/// One place of the plate; `gain[channel][axis]` in µV/N.
struct Place {
    x_mm: f64,
    y_mm: f64,
    gain: [[f64; 3]; CHANNELS],
}

fn table() -> Vec<Place> {
    let row = |line: &str| {
        let numbers: Vec<f64> = line.split(',').map(|number| number.parse().unwrap()).collect();
        let gain = std::array::from_fn(|channel| std::array::from_fn(|axis| numbers[2 + 3 * channel + axis]));
        Place { x_mm: numbers[0], y_mm: numbers[1], gain }
    };
    let places: Vec<Place> = TABLE.lines().skip(1).map(row).collect();
    assert_eq!(places.len(), 1 + 29 * 72);
    places
}

/// The same places, with the gains of the shipped field.
fn field() -> Vec<Place> {
    let field = PadField::nominal();
    let gain = |x_mm: f64, y_mm: f64| field.signals.gains(x_mm as f32, y_mm as f32).value;
    table().into_iter().map(|place| Place { gain: gain(place.x_mm, place.y_mm), ..place }).collect()
}

fn outward(module: usize) -> (f64, f64) {
    let angle = (120.0 * module as f64).to_radians();
    (angle.cos(), angle.sin())
}

impl Place {
    fn decoded(&self, statics: &Statics, force_n: [f64; 3]) -> Contact {
        let uv = self.gain.map(|gain| (0..3).map(|axis| gain[axis] * force_n[axis]).sum::<f64>() as f32);
        statics.decode(&Strain { uv })
    }

    /// Shear and overturning moment (Fx, Fy, px, py) per newton along `axis`, without any correction.
    fn raw(&self, fit: &Fit, axis: usize) -> [f64; 4] {
        let mut sum = [0.0; 4];
        for module in 0..MODULES {
            let (cos, sin) = outward(module);
            let tangential = self.gain[3 * module][axis] / fit.tangential;
            let radial = self.gain[3 * module + 1][axis] / fit.radial;
            let normal = self.gain[3 * module + 2][axis] / fit.normal;
            sum[0] += radial * cos - tangential * sin;
            sum[1] += radial * sin + tangential * cos;
            sum[2] += MODULE_RADIUS_MM * cos * normal;
            sum[3] += MODULE_RADIUS_MM * sin * normal;
        }
        sum
    }
}

#[derive(Default)]
struct Fit {
    tangential: f64,
    radial: f64,
    normal: f64,
    height: f64,
    false_shear: f64,
}

/// The factor that brings `model` closest to `observed` in the sense of least squares.
fn factor(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (mut product, mut square) = (0.0, 0.0);
    for (model, observed) in pairs {
        product += model * observed;
        square += model * model;
    }
    product / square
}

/// Sensitivities from equal shares of a shear load and from the sum of the normal channels; then the height
/// from the moment of a shear load, and the false shear from the shear that a normal load reports.
fn fitted(places: &[Place]) -> Fit {
    let mut fit = Fit::default();
    let all_modules = || (0..MODULES).flat_map(|m| places.iter().flat_map(move |p| [(p, m, 0), (p, m, 1)]));
    fit.tangential = factor(all_modules().map(|(place, module, axis)| {
        let (cos, sin) = outward(module);
        ([-sin, cos][axis] / 3.0, place.gain[3 * module][axis])
    }));
    fit.radial = factor(all_modules().map(|(place, module, axis)| {
        let (cos, sin) = outward(module);
        ([cos, sin][axis] / 3.0, place.gain[3 * module + 1][axis])
    }));
    fit.normal = factor(places.iter().map(|p| (1.0, p.gain[2][2] + p.gain[5][2] + p.gain[8][2])));
    let loads = || places.iter().flat_map(|place| [(place, 0), (place, 1)]);
    fit.height = factor(loads().map(|(place, axis)| (1.0, place.raw(&fit, axis)[2 + axis])));
    fit.false_shear = factor(loads().map(|(place, axis)| {
        let raw = place.raw(&fit, 2);
        (raw[2 + axis], raw[axis])
    }));
    fit
}

#[test]
fn the_shipped_numbers_are_the_least_squares_fit() {
    let (model, fit) = (*Statics::nominal().model(), fitted(&field()));
    let numbers = [
        ("tangential_uv_per_n", model.tangential_uv_per_n, fit.tangential),
        ("radial_uv_per_n", model.radial_uv_per_n, fit.radial),
        ("normal_uv_per_n", model.normal_uv_per_n, fit.normal),
        ("contact_height_mm", model.contact_height_mm, fit.height),
        ("false_shear_per_mm", model.false_shear_per_mm, fit.false_shear),
    ];
    numbers
        .iter()
        .for_each(|(name, shipped, fitted)| println!("{name}: {shipped} shipped, {fitted:.8} fitted"));
    let off = |(_, shipped, fitted): &(&str, f32, f64)| (f64::from(*shipped) / fitted - 1.0).abs();
    assert!(numbers.iter().all(|number| off(number) < 2e-6));
}

#[test]
fn the_geometry_is_the_device_files() {
    let device = Device::nominal();
    let model = *Statics::nominal().model();
    assert_eq!(f64::from(model.module_radius_mm), device.sites.centre_radius_mm);
    assert_eq!(f64::from(model.plate_radius_mm), device.plate.radius_mm());
}

fn mean_and_worst(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (mut sum, mut worst, mut count) = (0.0, 0.0_f64, 0.0);
    for value in values {
        sum += value;
        worst = worst.max(value);
        count += 1.0;
    }
    (sum / count, worst)
}

fn distance_mm(place: &Place, contact: &Contact) -> f64 {
    (f64::from(contact.x_mm) - place.x_mm).hypot(f64::from(contact.y_mm) - place.y_mm)
}

#[test]
fn a_normal_load_reads_as_little_shear() {
    let (statics, places) = (Statics::nominal(), table());
    let shear = |statics: &Statics, component: fn(&Contact) -> f32| {
        mean_and_worst(
            places.iter().map(|p| f64::from(component(&p.decoded(statics, [0.0, 0.0, 1.0])).abs())),
        )
    };
    let (fx, fx_worst) = shear(&statics, |contact| contact.fx_n);
    let (fy, fy_worst) = shear(&statics, |contact| contact.fy_n);
    println!("false shear per N of Fz: mean |Fx| {fx:.4}, mean |Fy| {fy:.4}");
    println!("its worst, at the rim: |Fx| {fx_worst:.3}, |Fy| {fy_worst:.3}");
    assert!(fx < 0.03 && fy < 0.03, "{fx} {fy}");
    assert!(fx_worst < 0.19 && fy_worst < 0.19, "{fx_worst} {fy_worst}");

    let near = places.iter().filter(|place| place.x_mm.hypot(place.y_mm) < 25.5);
    let (_, near_worst) = mean_and_worst(near.map(|place| {
        let seen = place.decoded(&statics, [0.0, 0.0, 1.0]);
        f64::from(seen.fx_n).hypot(f64::from(seen.fy_n))
    }));
    println!("its worst within 25 mm: {near_worst:.3}");
    assert!(near_worst < 0.12, "the virtual pad's player counts on this");

    let plain = StaticsModel { false_shear_per_mm: 0.0, ..*statics.model() };
    let (uncorrected, _) = shear(&Statics::new(plain).unwrap(), |contact| contact.fx_n);
    println!("without the correction: mean |Fx| {uncorrected:.3}");
    assert!(uncorrected > 5.0 * fx, "the correction earns its place");
}

#[test]
fn a_normal_load_is_found() {
    let statics = Statics::nominal();
    let error = |place: &Place| distance_mm(place, &place.decoded(&statics, [0.0, 0.0, 2.0]));
    let (mean, worst) = mean_and_worst(table().iter().map(error));
    let inside = |place: &&Place| place.x_mm.hypot(place.y_mm) < 20.5;
    let (_, worst_inside) = mean_and_worst(table().iter().filter(inside).map(error));
    println!(
        "pure Fz: mean {mean:.3} mm, worst {worst:.3} mm, within the modules' circle {worst_inside:.3} mm"
    );
    assert!(mean < 0.15 && worst < 0.65 && worst_inside < 0.25, "{mean} {worst} {worst_inside}");
}

#[test]
fn mixed_loads_are_found() {
    let statics = Statics::nominal();
    let tilted = StaticsModel { contact_height_mm: 0.0, ..*statics.model() };
    let flat = Statics::new(tilted).unwrap();
    for step in 0..12 {
        let angle = f64::from(step) * std::f64::consts::TAU / 12.0;
        let force = [angle.cos(), angle.sin(), 2.0];
        assert_forces(&statics, &field(), force, [(0.06, 0.38), (0.06, 0.38), (0.001, 0.001)]);
        // The independent solution has 0.6 % less in Sz.
        assert_forces(&statics, &table(), force, [(0.06, 0.4), (0.06, 0.4), (0.015, 0.015)]);
        let places = table();
        let (mean, worst) =
            mean_and_worst(places.iter().map(|p| distance_mm(p, &p.decoded(&statics, force))));
        assert!(mean < 0.16 && worst < 0.7, "{mean} {worst}");
        let (without_height, _) =
            mean_and_worst(places.iter().map(|p| distance_mm(p, &p.decoded(&flat, force))));
        assert!(without_height > 1.0, "the contact height earns its place: {without_height}");
    }
}

/// Asserts the mean and the worst error of each force.
fn assert_forces(statics: &Statics, places: &[Place], force: [f64; 3], bounds: [(f64, f64); 3]) {
    let components: [fn(&Contact) -> f32; 3] = [|c| c.fx_n, |c| c.fy_n, |c| c.fz_n];
    for (axis, (component, bound)) in components.iter().zip(bounds).enumerate() {
        let off = |p: &Place| (f64::from(component(&p.decoded(statics, force))) - force[axis]).abs();
        let (mean, worst) = mean_and_worst(places.iter().map(off));
        assert!(mean < bound.0 && worst < bound.1, "axis {axis}: {mean} {worst}");
    }
}

#[test]
fn a_third_of_a_turn_turns_the_contact() {
    let (statics, places) = (Statics::nominal(), table());
    let (cos, sin) = outward(1);
    let turn = |x: f32, y: f32| (cos as f32 * x - sin as f32 * y, sin as f32 * x + cos as f32 * y);
    let mut uneven: f32 = 0.0;
    for place in &places {
        let here = place.decoded(&statics, [0.4, -0.3, 1.5]);
        let uv = place.gain.map(|gain| (0.4 * gain[0] - 0.3 * gain[1] + 1.5 * gain[2]) as f32);
        let there = statics.decode(&Strain { uv: std::array::from_fn(|k| uv[(k + 6) % CHANNELS]) });
        let (x, y) = turn(here.x_mm, here.y_mm);
        let (fx, fy) = turn(here.fx_n, here.fy_n);
        for off in [there.x_mm - x, there.y_mm - y, there.fx_n - fx, there.fy_n - fy, there.fz_n - here.fz_n]
        {
            uneven = uneven.max(off.abs());
        }
    }
    assert!(uneven < 1e-4, "{uneven}");
}
