//! Calibration from measured contacts, on pads whose truth is known: the inverse decoder beside what needs no physics.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may stop at what it did not expect")]

use std::sync::OnceLock;

use tactpad::calibration::fit::{Calibration, fit};
use tactpad::calibration::regression::{neighbours, regression};
use tactpad::contact::Decoder;
use tactpad::contact::recording::Recording;
use tactpad::contact::regression::Target;
use tactpad::device::Device;
use tactpad::device::behaviour::{Crosstalk, Play};
use tactpad::evaluation::{Errors, coverage95, decoded, errors};
use tactpad::field::PadField;
use tactpad::measured::{Label, Row, Table};
use tactpad::protocol;
use tactpad::quantity::CHANNELS;
use tactpad::twin::measurement::{Measurement, carry_out};

fn field() -> &'static PadField {
    static FIELD: OnceLock<PadField> = OnceLock::new();
    FIELD.get_or_init(PadField::nominal)
}

/// The nominal pad with a sibling pad's gains, offsets, a little crosstalk, and noise: 1 % of a typical reading, and 1.3 %
/// of its own.
fn pad() -> Device {
    let mut device = Device::nominal();
    let gains = [[1.262, 1.331, 0.834], [1.285, 1.262, 0.994], [1.270, 1.330, 0.840]];
    for (module, gain) in device.modules.iter_mut().zip(gains) {
        (module.gain, module.offset_uv) = (gain, [300.0, -200.0, 500.0]);
    }
    device.behaviour.crosstalk = vec![Crosstalk { channel: 5, with: 2, share: 0.02 }];
    device.behaviour.noise.additive_uv = [60.0; CHANNELS];
    (device.behaviour.noise.share, device.behaviour.noise.share_time_s) = ([0.013; CHANNELS], 3.0);
    device
}

/// What the twin measured, as a decoder takes it, and the truths.
struct Measured {
    recording: Recording,
    truths: Vec<Label>,
}

impl Measured {
    fn of(device: &Device, plan: &Table, seed: u64) -> Self {
        let Measurement { table, truth: truths } = carry_out(plan, device, field(), seed);
        Self { recording: Recording::of(table, device.contact.full_scale_n).unwrap(), truths }
    }

    /// Contacts of the paper's plan.
    fn calibration(device: &Device) -> Self {
        Self::of(device, &protocol::paper::plan(&device.contact), 1)
    }

    /// Others.
    fn unseen(device: &Device) -> Self {
        Self::of(device, &protocol::recommended::plan(&device.contact, 9), 2)
    }

    /// So many of the contacts, all over the plate.
    fn some(&self, count: usize) -> Vec<usize> {
        let places = self.recording.contacts();
        (0..count).map(|index| places[index * 251 % places.len()]).collect()
    }

    fn inverse(&self, count: usize) -> Calibration {
        fit(&self.recording, &self.some(count), &Device::nominal(), field(), None).unwrap()
    }

    /// The same, begun with another pad's decoder.
    fn from(&self, count: usize, earlier: &Decoder) -> Decoder {
        let Decoder::Inverse(earlier) = earlier else { panic!("only an inverse decoder tells of its pad") };
        let found = fit(&self.recording, &self.some(count), &Device::nominal(), field(), Some(earlier));
        Decoder::Inverse(Box::new(found.unwrap().decoder()))
    }

    fn rows(&self, count: usize) -> Vec<Row> {
        self.some(count).iter().map(|at| self.recording.tared().rows[*at]).collect()
    }

    /// Contacts as the decoder takes them, and their truths.
    fn taken(&self, decoder: &Decoder) -> (Vec<Row>, Vec<Label>) {
        let freed = self.recording.freed(decoder.friction());
        self.recording.contacts().iter().map(|at| (freed.rows[*at], self.truths[*at])).unzip()
    }
}

fn inverse(measured: &Measured, count: usize) -> Decoder {
    Decoder::Inverse(Box::new(measured.inverse(count).decoder()))
}

fn wrench(measured: &Measured, count: usize) -> Decoder {
    Decoder::Regression(Box::new(regression(&measured.rows(count), Target::Wrench, 29.0).unwrap()))
}

fn errors_of(decoder: &Decoder, measured: &Measured) -> Errors {
    let (rows, truths) = measured.taken(decoder);
    errors(&decoded(decoder, &rows), &truths)
}

#[test]
fn the_inverse_is_several_times_better_than_what_needs_no_physics() {
    let device = pad();
    let (measured, unseen) = (Measured::calibration(&device), Measured::unseen(&device));
    let said = |name: &str, errors: &Errors| {
        println!("{name}: {:.3} mm, {:.4} N", errors.position_mae_mm, errors.force_mae_n);
    };
    for count in [20, 73, 216, 648] {
        let [by_inverse, by_wrench] =
            [inverse(&measured, count), wrench(&measured, count)].map(|it| errors_of(&it, &unseen));
        said(&format!("inverse, {count}"), &by_inverse);
        said(&format!("wrench, {count}"), &by_wrench);
        // With 73 contacts and more both places are as good as the noise allows; the force still gains.
        let share = if count == 20 { 0.6 } else { 1.0 };
        assert!(by_inverse.position_mae_mm < share * by_wrench.position_mae_mm);
        assert!(by_inverse.force_mae_n < 0.6 * by_wrench.force_mae_n);
        assert!(by_inverse.position_mae_mm < 0.3);
    }
    let rows = measured.rows(648);
    let linear = Decoder::Regression(Box::new(regression(&rows, Target::Contact, 29.0).unwrap()));
    said("linear", &errors_of(&linear, &unseen));
    said("neighbours", &errors_of(&Decoder::Neighbours(neighbours(&rows).unwrap()), &unseen));
}

#[test]
fn it_says_how_sure_it_is() {
    let device = pad();
    let decoder = inverse(&Measured::calibration(&device), 648);
    let (rows, truths) = Measured::unseen(&device).taken(&decoder);
    let covered = coverage95(&decoder, &rows, &truths).unwrap();
    assert!((0.92..=0.98).contains(&covered), "{covered}");
}

#[test]
fn friction_is_found_and_taken_off() {
    let mut device = pad();
    device.behaviour.noise.additive_uv = [10.0; CHANNELS];
    device.behaviour.hysteresis =
        vec![Play { channels: [true; CHANNELS], threshold_uv: 800.0, share: 0.0625 }];
    let (measured, unseen) = (Measured::calibration(&device), Measured::unseen(&device));
    for (count, allowed_uv) in [(20, 12.0), (648, 4.0)] {
        let calibration = measured.inverse(count);
        let kept = |channel: usize| {
            let plays = calibration.friction.iter();
            plays.map(|play| play.share[channel] * play.threshold_uv[channel]).sum::<f64>()
        };
        println!("{count}: kept at rest {:.1?} µV", std::array::from_fn::<f64, CHANNELS, _>(kept));
        let truly = |channel: usize| 50.0 * device.modules[channel / 3].gain[channel % 3];
        assert!((0..CHANNELS).all(|channel| (kept(channel) - truly(channel)).abs() < allowed_uv));
        let [by_inverse, by_wrench] =
            [inverse(&measured, count), wrench(&measured, count)].map(|it| errors_of(&it, &unseen));
        assert!(by_inverse.position_mae_mm < 0.5 * by_wrench.position_mae_mm, "{by_inverse:?}");
        assert!(by_inverse.force_mae_n < 0.4 * by_wrench.force_mae_n, "{by_inverse:?}");
    }
}

#[test]
fn another_pad_of_the_kind_needs_twenty_contacts() {
    let mut other = pad();
    for (k, gain) in other.modules.iter_mut().flat_map(|module| &mut module.gain).enumerate() {
        *gain *= 1.0 + 0.1 * [1.0, -0.4, 0.2, -1.3, 0.6, 0.9, -0.7, -0.2, 1.1][k];
    }
    other.behaviour.crosstalk = vec![Crosstalk { channel: 1, with: 8, share: -0.015 }];
    let earlier = inverse(&Measured::calibration(&pad()), 648);
    let (measured, unseen) = (Measured::calibration(&other), Measured::unseen(&other));
    let [few, all] =
        [measured.from(20, &earlier), inverse(&measured, 648)].map(|decoder| errors_of(&decoder, &unseen));
    println!("20: {few:?}\n648: {all:?}");
    assert!(few.position_mae_mm < 1.5 * all.position_mae_mm);
    assert!(few.force_mae_n < 1.5 * all.force_mae_n);
}
