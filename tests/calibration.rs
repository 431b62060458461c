//! Calibration from measured contacts: the twin's pads, of which the truth is known.

use std::sync::OnceLock;

use tactpad::calibration::fit::{Calibration, fit};
use tactpad::contact::inverse::Inverse;
use tactpad::device::Device;
use tactpad::device::behaviour::Crosstalk;
use tactpad::field::PadField;
use tactpad::measured::{Label, Table, zero};
use tactpad::protocol;
use tactpad::quantity::{CHANNELS, Contact, Strain};
use tactpad::twin::measurement::{Measurement, carry_out};

fn field() -> &'static PadField {
    static FIELD: OnceLock<PadField> = OnceLock::new();
    FIELD.get_or_init(PadField::nominal)
}

/// The nominal pad with a sibling pad's gains, offsets, a little crosstalk, and the noise of the study.
fn pad() -> Device {
    let mut device = Device::nominal();
    let gains = [[1.262, 1.331, 0.834], [1.285, 1.262, 0.994], [1.270, 1.330, 0.840]];
    for (module, gain) in device.modules.iter_mut().zip(gains) {
        (module.gain, module.offset_uv) = (gain, [300.0, -200.0, 500.0]);
    }
    device.behaviour.crosstalk = vec![Crosstalk { channel: 5, with: 2, share: 0.02 }];
    device.behaviour.noise.additive_uv = [60.0; CHANNELS];
    device.behaviour.noise.share = [0.013; CHANNELS];
    device
}

/// Mean errors of x and y, and of the three forces, over the loaded static rows.
fn errors(decoder: &Inverse, Measurement { table, truth }: &Measurement) -> [f64; 2] {
    let tared = zero::tared(table).unwrap();
    let loaded = tared.rows.iter().zip(truth).filter(|(row, truth)| row.trial.is_none() && truth.fz_n > 0.0);
    let (mut sums, mut count) = ([0.0; 2], 0.0);
    for (row, truth) in loaded {
        let found = decoder.decode(&Strain { uv: row.uv.unwrap().map(|uv| uv as f32) });
        let wanted: Contact = Label::into(*truth);
        sums[0] += f64::from((found.x_mm - wanted.x_mm).abs() + (found.y_mm - wanted.y_mm).abs()) / 2.0;
        let off = (found.fx_n - wanted.fx_n).abs()
            + (found.fy_n - wanted.fy_n).abs()
            + (found.fz_n - wanted.fz_n).abs();
        sums[1] += f64::from(off) / 3.0;
        count += 1.0;
    }
    sums.map(|sum| sum / count)
}

fn calibrated(rows: usize) -> Calibration {
    let device = pad();
    let patch = &device.contact;
    let mut plan = protocol::paper::plan(patch);
    // Every so many-th contact, and all zeros.
    let every = 648 / rows;
    let mut loaded = 0;
    plan.rows.retain(|row| {
        let is_zero = row.label.fz_n == 0.0;
        loaded += usize::from(!is_zero);
        is_zero || (loaded * 7) % every == 0
    });
    let plan = Table { ..plan };
    let measured = carry_out(&plan, &device, field(), 1);
    fit(&measured.table, &Device::nominal(), field()).unwrap()
}

#[test]
fn it_locates() {
    let device = pad();
    let unseen = carry_out(&protocol::recommended::plan(&device.contact, 9), &device, field(), 2);
    for rows in [648, 216, 72, 24] {
        let calibration = calibrated(rows);
        let errors = errors(&calibration.decoder(), &unseen);
        println!(
            "{} contacts: {:.3} mm, {:.4} N; background {}, gains {:.3?}, noise {:.1?} {:.4?}",
            calibration.contacts,
            errors[0],
            errors[1],
            calibration.background,
            calibration.gain,
            calibration.noise.additive_uv,
            calibration.noise.share
        );
        for (parameter, value, deviation) in &calibration.physical {
            print!("{} {value:.3}±{deviation:.3}; ", parameter.name());
        }
        println!();
    }
}
