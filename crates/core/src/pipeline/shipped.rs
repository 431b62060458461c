//! The decoders that are inside the program.

use std::borrow::Cow;

use crate::pad::field::PadField;
use crate::pad::influence::InfluenceField;
use crate::pipeline::contact::Decoder;
use crate::pipeline::contact::inverse::Inverse;
use crate::pipeline::contact::statics::{NOMINAL, Statics};
use crate::pipeline::contact::uncertainty::Noise;
use crate::quantity::CHANNELS;

/// Plays unless another one is asked for: of those that know no pad but the nominal one, it is nearest to the truth.
/// `docs/decoding.md` has the figures.
pub const INVERSE: &str = "inverse";
/// Decoder of captures that name none.
pub const STATICS: &str = "statics";
/// The paper's network after its stage I.
const SCDF: &str = "scdf";

/// How far a pad's channels are from those of the nominal one, as a share of each: gains of a pad made by hand.
const PAD_SHARE: f64 = 0.1;
/// Crosstalk of a channel, µV/N: 1 % of what a z channel reads of a newton over its module.
const CROSSTALK_UV_PER_N: f64 = 20.0;
/// How far all its channels are together: the authors' earlier pad has gains of 0.83 to 1.33.
const PAD_GAIN: f64 = 0.2;
/// How far a place is moved by gains that differ.
const PLACE_MM: f64 = 1.0;
/// Of a single reading; mains are in it.
const READING_UV: f64 = 10.0;

/// The decoder that plays unless another one is asked for: the inverse one of the nominal pad.
pub fn decoder() -> Decoder {
    uncalibrated(PadField::nominal().signals)
}

/// The inverse decoder of a pad that was never measured, by the field that the simulator gives it.
pub fn uncalibrated(field: InfluenceField) -> Decoder {
    let mut noise = Noise::of_channels([READING_UV; CHANNELS], [PAD_SHARE; CHANNELS]);
    noise.gain = PAD_GAIN;
    noise.force_uv_per_n = [CROSSTALK_UV_PER_N; CHANNELS];
    for (k, line) in noise.by_field.iter_mut().enumerate() {
        line[k] = if k < 2 { PLACE_MM * PLACE_MM } else { PAD_SHARE * PAD_SHARE };
    }
    Inverse::new(field, noise).into()
}

/// The decoder by statics.
pub fn statics() -> Decoder {
    Statics::nominal().into()
}

/// Whether there is a decoder of this name.
pub fn is_known(name: &str) -> bool {
    [INVERSE, STATICS, SCDF].contains(&name)
}

/// The file of the decoder `name`, or `None` if there is none of that name.
pub fn bytes(name: &str) -> Option<Cow<'static, [u8]>> {
    match name {
        INVERSE => decoder().to_bytes("the nominal pad").map(Cow::Owned),
        STATICS => Some(Cow::Borrowed(NOMINAL.as_bytes())),
        SCDF => Some(Cow::Borrowed(include_bytes!("../../../../models/scdf.onnx"))),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::contact::read;
    use crate::quantity::Strain;

    #[test]
    fn each_plays_by_its_name() {
        let strain = Strain { uv: std::array::from_fn(|k| 300.0 - 55.0 * k as f32) };
        let decoded = |name: &str| {
            let decoder = read::playing(&bytes(name).unwrap()).unwrap();
            (decoder.name(), decoder.decode(&strain))
        };
        assert_eq!(decoded(INVERSE), ("inverse", decoder().decode(&strain)));
        assert_eq!(decoded(STATICS), ("statics", statics().decode(&strain)));
        assert_eq!(decoded(SCDF).0, "network");
        assert!([INVERSE, STATICS, SCDF].iter().all(|name| is_known(name)));
        assert!(!is_known("nope") && bytes("nope").is_none());
    }
}
