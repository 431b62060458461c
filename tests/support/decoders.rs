//! One decoder of each kind, fitted to the nominal pad.

use tactpad::lab::calibration::regression::{neighbours, regression};
use tactpad::network::Zero;
use tactpad::pad::field::PadField;
use tactpad::pad::influence::{InfluenceField, MAPS};
use tactpad::pipeline::contact::field_error::{ErrorMode, FieldError, MODES_MAX};
use tactpad::pipeline::contact::inverse::Inverse;
use tactpad::pipeline::contact::regression::Target;
use tactpad::pipeline::contact::uncertainty::Noise;
use tactpad::pipeline::contact::{Decoder, read};
use tactpad::pipeline::shipped;
use tactpad::quantity::CHANNELS;
use tactpad::tables::measured::{Label, Row};

/// Contacts that the fitted ones know; the paper has as many.
const CONTACTS: u32 = 648;

/// The decoder and its name.
pub(crate) fn each() -> Vec<(&'static str, Decoder)> {
    let field = PadField::nominal().signals;
    let rows: Vec<Row> = (0..CONTACTS).map(|index| row(&field, index)).collect();
    let fitted = |target| regression(&rows, Zero::Tared, target, 29.0).map(Decoder::from);
    let of_the_program = |name| shipped::bytes(name).and_then(|bytes| read::playing(&bytes).ok());
    let noise = Noise::of_channels([5.0; CHANNELS], [0.01; CHANNELS]);
    let decoders = [
        of_the_program("statics"),
        fitted(Target::Wrench).ok(),
        fitted(Target::Contact).ok(),
        neighbours(&rows, Zero::Tared).map(Decoder::from).ok(),
        of_the_program("scdf"),
        FieldError::of(vec![mode(); MODES_MAX])
            .map(|error| Decoder::from(Inverse::new(field, noise).with_field_error(error))),
    ];
    let decoders: Vec<_> = decoders.into_iter().flatten().map(|decoder| (decoder.name(), decoder)).collect();
    assert_eq!(decoders.len(), 6, "each was made");
    decoders
}

/// Each channel may be off by a thousandth of all, and by up to 2 µV/N.
fn mode() -> ErrorMode {
    let maps = std::array::from_fn(|term| [2.0 / (1 + term) as f32; MAPS]);
    ErrorMode { mixture: [[1e-3; CHANNELS]; CHANNELS], maps }
}

/// A press on a spiral over the plate.
fn row(field: &InfluenceField, index: u32) -> Row {
    let turn = f64::from(index) * 2.4;
    let radius_mm = 29.0 * (f64::from(index) / f64::from(CONTACTS)).sqrt();
    let label = Label {
        x_mm: radius_mm * libm::cos(turn),
        y_mm: radius_mm * libm::sin(turn),
        fx_n: libm::sin(3.0 * turn),
        fy_n: libm::cos(5.0 * turn),
        fz_n: 0.5 + f64::from(index % 10) / 2.0,
    };
    let uv = field.strain_uv(&label.into()).uv.map(f64::from);
    Row { uv: Some(uv), ..Row::of(label) }
}
