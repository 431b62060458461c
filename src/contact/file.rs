//! Decoders as files of the program's own: what `adapt` writes, and `run` and `evaluate` read. Networks are ONNX instead.

use std::fmt;

use super::Decoder;
use super::creep::Creep;
use super::friction::{Friction, NO_FRICTION};
use super::inverse::Inverse;
use super::neighbours::{Known, Neighbours};
use super::regression::{Regression, Target};
use super::thermal::Thermal;
use super::uncertainty::Noise;
use crate::bytes::{Broken, Reader, push_floats, push_text, sealed, unsealed};
use crate::influence::InfluenceField;
use crate::network::Zero;
use crate::quantity::{CHANNELS, Contact};

/// First bytes of a file; the number grows with every change of the form.
pub const MAGIC: &[u8] = b"tactpad decoder 4\n";

const INVERSE: &[u8] = b"inverse";
const LINEAR: &[u8] = b"linear";
const WRENCH: &[u8] = b"wrench";
const NEIGHBOURS: &[u8] = b"knn";

/// Why bytes are no decoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DecoderFileError {
    /// They are another kind of file, or of another version.
    Version,
    /// They are damaged.
    Damaged,
}

impl fmt::Display for DecoderFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Version => "is no decoder file of this version; make one with `tactpad adapt`",
            Self::Damaged => "is damaged; make it anew with `tactpad adapt`",
        })
    }
}

impl std::error::Error for DecoderFileError {}

impl Decoder {
    /// The file's bytes: the kind, a note for people, the kind's own numbers. `None` for a decoder that has another form.
    pub fn to_bytes(&self, note: &str) -> Option<Vec<u8>> {
        let mut body = Vec::new();
        let mut begin = |kind: &[u8]| {
            push_text(&mut body, kind);
            push_text(&mut body, note.as_bytes());
        };
        match self {
            Self::Inverse(inverse) => {
                begin(INVERSE);
                push_noise(&mut body, inverse.noise());
                let friction = inverse.friction().iter();
                let numbers = friction.flat_map(|play| play.threshold_uv.iter().chain(&play.share));
                body.extend(numbers.flat_map(|number| number.to_le_bytes()));
                push_pad(&mut body, inverse);
                inverse.field().write(&mut body);
            }
            Self::Regression(regression) => {
                let Regression { zero, target, functions, reach_mm } = regression.as_ref();
                begin(if *target == Target::Wrench { WRENCH } else { LINEAR });
                push_text(&mut body, zero.name().as_bytes());
                let numbers = functions.as_flattened().iter().chain([reach_mm]);
                body.extend(numbers.flat_map(|number| number.to_le_bytes()));
            }
            Self::Neighbours(neighbours) => {
                begin(NEIGHBOURS);
                push_text(&mut body, neighbours.zero.name().as_bytes());
                push_neighbours(&mut body, neighbours);
            }
            Self::Statics(_) | Self::Network(_) => return None,
            #[cfg(feature = "foreign-onnx")]
            Self::Foreign(_) => return None,
        }
        Some(sealed(MAGIC, &body))
    }

    /// Reads a file, with the note for people that is in it.
    ///
    /// # Errors
    /// Bytes that [`Self::to_bytes`] did not write.
    pub fn from_bytes(bytes: &[u8]) -> Result<(Self, String), DecoderFileError> {
        let body = unsealed(MAGIC, bytes).map_err(|broken| match broken {
            Broken::Magic => DecoderFileError::Version,
            Broken::Damaged => DecoderFileError::Damaged,
        })?;
        read(&mut Reader::new(body)).ok_or(DecoderFileError::Damaged)
    }
}

fn read(from: &mut Reader<'_>) -> Option<(Decoder, String)> {
    let kind = from.text()?;
    let note = String::from_utf8_lossy(from.text()?).into_owned();
    let decoder = match kind {
        INVERSE => Decoder::Inverse(Box::new(read_inverse(from)?)),
        LINEAR => Decoder::Regression(Box::new(read_regression(from, Target::Contact)?)),
        WRENCH => Decoder::Regression(Box::new(read_regression(from, Target::Wrench)?)),
        NEIGHBOURS => Decoder::Neighbours(read_neighbours(from)?),
        _ => return None,
    };
    from.is_at_end().then_some((decoder, note))
}

fn read_inverse(from: &mut Reader<'_>) -> Option<Inverse> {
    let (noise, friction) = (read_noise(from)?, read_friction(from)?);
    let zero_uv = read_option(from, read_channels)?;
    let thermal = read_option(from, read_thermal)?;
    let creep = read_creep(from)?;
    Some(Inverse::new(InfluenceField::read(from)?, noise, friction).of_pad(zero_uv, thermal, creep))
}

/// What a pad has that not every decoder knows. What may be missing begins with how many there are of it.
fn push_pad(to: &mut Vec<u8>, inverse: &Inverse) {
    let mut push = |numbers: &[f64]| to.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
    push(&[f64::from(u8::from(inverse.zero_uv().is_some()))]);
    push(inverse.zero_uv().map_or(&[], |zero_uv| &zero_uv[..]));
    push(&[f64::from(u8::from(inverse.thermal().is_some()))]);
    if let Some(Thermal { reference_c, zero_uv_per_c, gain_per_c }) = inverse.thermal() {
        push(&[*reference_c]);
        push(zero_uv_per_c);
        push(gain_per_c);
    }
    let Creep { time_s, share } = *inverse.creep();
    push(&[time_s, share]);
}

/// `None` for damaged bytes.
fn read_option<T>(from: &mut Reader<'_>, read: fn(&mut Reader<'_>) -> Option<T>) -> Option<Option<T>> {
    match from.double()? {
        0.0 => Some(None),
        1.0 => read(from).map(Some),
        _ => None,
    }
}

fn read_channels(from: &mut Reader<'_>) -> Option<[f64; CHANNELS]> {
    let mut channels = [0.0; CHANNELS];
    for number in &mut channels {
        *number = from.double().filter(|number| number.is_finite())?;
    }
    Some(channels)
}

fn read_thermal(from: &mut Reader<'_>) -> Option<Thermal> {
    let thermal = Thermal {
        reference_c: from.double()?,
        zero_uv_per_c: read_channels(from)?,
        gain_per_c: read_channels(from)?,
    };
    Some(thermal).filter(Thermal::is_sound)
}

fn read_creep(from: &mut Reader<'_>) -> Option<Creep> {
    Some(Creep {
        time_s: from.double().filter(|time_s| time_s.is_finite() && *time_s >= 0.0)?,
        share: from.double().filter(|share| share.abs() < 1.0)?,
    })
}

fn read_zero(from: &mut Reader<'_>) -> Option<Zero> {
    let name = from.text()?;
    [Zero::Tared, Zero::Raw].into_iter().find(|zero| zero.name().as_bytes() == name)
}

fn push_noise(to: &mut Vec<u8>, noise: &Noise) {
    let Noise { additive_uv, share, force_uv_per_n, field_uv_per_n, gain, by_field } = noise;
    let channels = [additive_uv, share, force_uv_per_n, field_uv_per_n];
    let numbers = channels.into_iter().flatten().chain([gain]).chain(by_field.as_flattened());
    to.extend(numbers.flat_map(|number| number.to_le_bytes()));
}

fn read_noise(from: &mut Reader<'_>) -> Option<Noise> {
    let mut noise = Noise::of_channels([0.0; CHANNELS], [0.0; CHANNELS]);
    let Noise { additive_uv, share, force_uv_per_n, field_uv_per_n, gain, by_field } = &mut noise;
    let channels = [additive_uv, share, force_uv_per_n, field_uv_per_n];
    for number in channels.into_iter().flatten().chain([gain]) {
        *number = from.double().filter(|number| number.is_finite() && *number >= 0.0)?;
    }
    for number in by_field.as_flattened_mut() {
        *number = from.double().filter(|number| number.is_finite())?;
    }
    let scatters = noise.additive_uv.iter().all(|uv| *uv > 0.0);
    scatters.then_some(noise)
}

fn read_friction(from: &mut Reader<'_>) -> Option<Friction> {
    let mut friction = NO_FRICTION;
    for play in &mut friction {
        for number in &mut play.threshold_uv {
            *number = from.double().filter(|number| number.is_finite() && *number >= 0.0)?;
        }
        for number in &mut play.share {
            *number = from.double().filter(|number| number.is_finite())?;
        }
    }
    let shares = |channel: usize| friction.iter().map(|play| play.share[channel].abs()).sum::<f64>();
    (0..CHANNELS).all(|channel| shares(channel) < 1.0).then_some(friction)
}

fn read_regression(from: &mut Reader<'_>, target: Target) -> Option<Regression> {
    let zero = read_zero(from)?;
    let mut regression = Regression { zero, target, functions: [[0.0; _]; 5], reach_mm: 0.0 };
    for number in regression.functions.as_flattened_mut().iter_mut().chain([&mut regression.reach_mm]) {
        *number = from.double().filter(|number| number.is_finite())?;
    }
    (regression.reach_mm > 0.0).then_some(regression)
}

fn push_neighbours(to: &mut Vec<u8>, neighbours: &Neighbours) {
    push_floats(to, &neighbours.deviation_uv);
    let row = |known: &Known| {
        let Contact { x_mm, y_mm, fx_n, fy_n, fz_n } = known.contact;
        known.channels.into_iter().chain([x_mm, y_mm, fx_n, fy_n, fz_n])
    };
    push_floats(to, &neighbours.known.iter().flat_map(row).collect::<Vec<f32>>());
}

fn read_neighbours(from: &mut Reader<'_>) -> Option<Neighbours> {
    let zero = read_zero(from)?;
    let deviation_uv = from.floats()?.try_into().ok()?;
    let numbers = from.floats()?;
    let (rows, rest) = numbers.as_chunks::<{ CHANNELS + 5 }>();
    let known = |row: &[f32; CHANNELS + 5]| {
        let (channels, contact) = row.split_first_chunk::<CHANNELS>()?;
        let [x_mm, y_mm, fx_n, fy_n, fz_n] = *contact.first_chunk()?;
        Some(Known { channels: *channels, contact: Contact { x_mm, y_mm, fx_n, fy_n, fz_n } })
    };
    let known: Vec<Known> = rows.iter().map(known).collect::<Option<_>>()?;
    let is_sound = rest.is_empty() && numbers.iter().all(|number| number.is_finite()) && !known.is_empty();
    is_sound.then_some(Neighbours { zero, deviation_uv, known })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::statics::Statics;
    use crate::field::PadField;
    use crate::quantity::Strain;

    fn decoders() -> Vec<Decoder> {
        let noise = Noise::of_channels([5.0; CHANNELS], [0.01; CHANNELS]);
        let mut functions = [[1e-3; CHANNELS + 1]; 5];
        functions[4][2] = 2e-3;
        let regression = |target| {
            Decoder::Regression(Box::new(Regression { zero: Zero::Raw, target, functions, reach_mm: 29.0 }))
        };
        let known = Known { channels: [1.0; CHANNELS], contact: Contact { fz_n: 2.0, ..Contact::default() } };
        vec![
            Decoder::Inverse(Box::new(Inverse::new(PadField::nominal().signals, noise, NO_FRICTION))),
            regression(Target::Wrench),
            regression(Target::Contact),
            Decoder::Neighbours(Neighbours {
                zero: Zero::Tared,
                deviation_uv: [300.0; CHANNELS],
                known: vec![known; 7],
            }),
        ]
    }

    #[test]
    fn they_decode_the_same_when_they_are_read_again() {
        let strain = Strain { uv: std::array::from_fn(|k| 300.0 - 55.0 * k as f32) };
        for decoder in decoders() {
            let (again, note) = Decoder::from_bytes(&decoder.to_bytes("a note").unwrap()).unwrap();
            assert_eq!(note, "a note");
            assert_eq!(again.decode(&strain), decoder.decode(&strain));
        }
        assert!(Decoder::Statics(Statics::nominal()).to_bytes("").is_none());
    }

    #[test]
    fn damaged_bytes_are_refused() {
        for decoder in decoders() {
            let bytes = decoder.to_bytes("").unwrap();
            for length in [0, 10, 18, 40, bytes.len() - 1] {
                assert!(Decoder::from_bytes(&bytes[..length]).is_err());
            }
        }
        // A sound sum over a body that makes no sense.
        for body in [&b""[..], b"\x03\0\0\0abc\0\0\0\0", b"\x06\0\0\0wrench\0\0\0\0\0\0"] {
            assert_eq!(Decoder::from_bytes(&sealed(MAGIC, body)).err(), Some(DecoderFileError::Damaged));
        }
    }
}
