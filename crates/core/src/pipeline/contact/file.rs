//! Decoders as files of the program's own: what `adapt` writes, and `run` and `evaluate` read. Networks are ONNX instead.

use std::fmt;

use super::field_error::{ErrorMode, FieldError, MODES_MAX, NUMBERS};
use super::inverse::{CROSSTALK_MAX, Crosstalk, Inverse};
use super::neighbours::{LabelledContact, Neighbours};
use super::regression::{Regression, Target};
use super::uncertainty::Noise;
use super::{Decoder, Method};
use crate::bytes::{FormatError, Reader, push_floats, push_text, sealed, unsealed};
use crate::network::Zero;
use crate::pad::influence::InfluenceField;
use crate::pipeline::compensation::Compensation;
use crate::pipeline::compensation::hysteresis::{Hysteresis, NO_HYSTERESIS};
use crate::pipeline::compensation::thermal::Thermal;
use crate::quantity::{CHANNELS, Contact};
use tactpad_numeric::memory::Relaxation;

/// First bytes of a file; the number grows with every change of the form.
pub const MAGIC: &[u8] = b"tactpad decoder 5\n";

const INVERSE: &[u8] = b"inverse";
const LINEAR: &[u8] = b"linear";
const WRENCH: &[u8] = b"wrench";
const NEIGHBOURS: &[u8] = b"knn";

/// Why bytes are no decoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
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
    /// The file's bytes: the kind, a note for people, the kind's own numbers. `None` for a decoder that has another form, and
    /// for one with a compensation, for which only the inverse decoder's form has room.
    pub fn to_bytes(&self, note: &str) -> Option<Vec<u8>> {
        let mut body = Vec::new();
        let mut begin = |kind: &[u8]| {
            push_text(&mut body, kind);
            push_text(&mut body, note.as_bytes());
        };
        match &self.method {
            Method::Inverse(inverse) => {
                begin(INVERSE);
                push_noise(&mut body, inverse.noise());
                push_compensation(&mut body, &self.compensation);
                inverse.field().write(&mut body);
                push_floats(&mut body, inverse.crosstalk().as_flattened());
                let modes = inverse.field_error().modes().iter();
                push_floats(&mut body, &modes.flat_map(ErrorMode::numbers).collect::<Vec<f32>>());
            }
            _ if self.compensation != Compensation::NONE => return None,
            Method::Regression(regression) => {
                let Regression { zero, target, functions, reach_mm } = regression.as_ref();
                begin(if *target == Target::Wrench { WRENCH } else { LINEAR });
                push_text(&mut body, zero.name().as_bytes());
                push_numbers(&mut body, functions.as_flattened().iter().chain([reach_mm]));
            }
            Method::Neighbours(neighbours) => {
                begin(NEIGHBOURS);
                push_text(&mut body, neighbours.zero.name().as_bytes());
                push_neighbours(&mut body, neighbours);
            }
            Method::Statics(_) | Method::Balance(_) | Method::Told | Method::Network(_) => return None,
            #[cfg(feature = "foreign-onnx")]
            Method::Foreign(_) => return None,
        }
        Some(sealed(MAGIC, &body))
    }

    /// Reads a file, with the note for people that is in it.
    ///
    /// # Errors
    /// Bytes that [`Self::to_bytes`] did not write.
    pub fn from_bytes(bytes: &[u8]) -> Result<(Self, String), DecoderFileError> {
        let body = unsealed(MAGIC, bytes).map_err(|broken| match broken {
            FormatError::Magic => DecoderFileError::Version,
            FormatError::Damaged => DecoderFileError::Damaged,
        })?;
        read(&mut Reader::new(body)).ok_or(DecoderFileError::Damaged)
    }
}

fn read(from: &mut Reader<'_>) -> Option<(Decoder, String)> {
    let kind = from.text()?;
    let note = String::from_utf8_lossy(from.text()?).into_owned();
    let decoder = match kind {
        INVERSE => read_inverse(from)?,
        LINEAR => read_regression(from, Target::Contact)?.into(),
        WRENCH => read_regression(from, Target::Wrench)?.into(),
        NEIGHBOURS => read_neighbours(from)?.into(),
        _ => return None,
    };
    from.is_at_end().then_some((decoder, note))
}

fn read_inverse(from: &mut Reader<'_>) -> Option<Decoder> {
    let (noise, compensation) = (read_noise(from)?, read_compensation(from)?);
    let field = InfluenceField::read(from)?;
    let crosstalk = read_crosstalk(from)?;
    let inverse =
        Inverse::new(field, noise).with_crosstalk(crosstalk).with_field_error(read_field_error(from)?);
    Some(Decoder::from(inverse).compensated_by(compensation))
}

fn read_crosstalk(from: &mut Reader<'_>) -> Option<Crosstalk> {
    let numbers = from.floats()?;
    let (lines, []) = numbers.as_chunks() else { return None };
    let crosstalk: Crosstalk = lines.try_into().ok()?;
    let is_sound = |(into, line): (usize, &[f32; CHANNELS])| {
        line[into] == 0.0 && line.iter().all(|share| share.abs() <= CROSSTALK_MAX)
    };
    crosstalk.iter().enumerate().all(is_sound).then_some(crosstalk)
}

fn read_field_error(from: &mut Reader<'_>) -> Option<FieldError> {
    let numbers = from.floats()?;
    let (modes, rest) = numbers.as_chunks::<NUMBERS>();
    let is_sound = rest.is_empty() && modes.len() <= MODES_MAX;
    is_sound.then_some(())?;
    FieldError::of(modes.iter().map(ErrorMode::of).collect::<Option<_>>()?)
}

fn push_numbers<'n>(to: &mut Vec<u8>, numbers: impl IntoIterator<Item = &'n f64>) {
    to.extend(numbers.into_iter().flat_map(|number| number.to_le_bytes()));
}

/// What may be missing begins with how many there are of it.
fn push_compensation(to: &mut Vec<u8>, compensation: &Compensation) {
    let Compensation { zero_uv, thermal, creep: Relaxation { time_s, share }, hysteresis } = compensation;
    for plays in hysteresis {
        push_numbers(
            to,
            plays.iter().map(|play| &play.threshold).chain(plays.iter().map(|play| &play.share)),
        );
    }
    push_numbers(to, &[f64::from(u8::from(zero_uv.is_some()))]);
    push_numbers(to, zero_uv.iter().flatten());
    push_numbers(to, &[f64::from(u8::from(thermal.is_some()))]);
    if let Some(Thermal { reference_c, zero_uv_per_c, gain_per_c }) = thermal {
        push_numbers(to, [reference_c].into_iter().chain(zero_uv_per_c).chain(gain_per_c));
    }
    push_numbers(to, [time_s, share]);
}

fn read_compensation(from: &mut Reader<'_>) -> Option<Compensation> {
    Some(Compensation {
        hysteresis: read_hysteresis(from)?,
        zero_uv: read_option(from, read_channels)?,
        thermal: read_option(from, read_thermal)?,
        creep: read_creep(from)?,
    })
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

fn read_creep(from: &mut Reader<'_>) -> Option<Relaxation> {
    Some(Relaxation {
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
    push_numbers(to, channels.into_iter().flatten().chain([gain]).chain(by_field.as_flattened()));
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

fn read_hysteresis(from: &mut Reader<'_>) -> Option<Hysteresis> {
    let mut hysteresis = NO_HYSTERESIS;
    for plays in &mut hysteresis {
        for number in plays.iter_mut().map(|play| &mut play.threshold) {
            *number = from.double().filter(|number| number.is_finite() && *number >= 0.0)?;
        }
        for number in plays.iter_mut().map(|play| &mut play.share) {
            *number = from.double().filter(|number| number.is_finite())?;
        }
    }
    let shares = |channel: usize| hysteresis.iter().map(|plays| plays[channel].share.abs()).sum::<f64>();
    (0..CHANNELS).all(|channel| shares(channel) < 1.0).then_some(hysteresis)
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
    let row = |known: &LabelledContact| {
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
        Some(LabelledContact { channels: *channels, contact: Contact { x_mm, y_mm, fx_n, fy_n, fz_n } })
    };
    let known: Vec<LabelledContact> = rows.iter().map(known).collect::<Option<_>>()?;
    let is_sound = rest.is_empty() && numbers.iter().all(|number| number.is_finite()) && !known.is_empty();
    is_sound.then_some(Neighbours { zero, deviation_uv, known })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pad::field::PadField;
    use crate::pipeline::contact::inverse::NO_CROSSTALK;
    use crate::pipeline::contact::statics::Statics;
    use crate::quantity::Strain;
    use tactpad_numeric::memory::PlayOperator;

    const COMPENSATION: Compensation = Compensation {
        zero_uv: Some([-120.0; CHANNELS]),
        thermal: Some(Thermal {
            reference_c: 25.0,
            zero_uv_per_c: [40.0; CHANNELS],
            gain_per_c: [1e-3; CHANNELS],
        }),
        creep: Relaxation { time_s: 8.0, share: 0.01 },
        hysteresis: [
            [PlayOperator { threshold: 700.0, share: 0.05 }; CHANNELS],
            [PlayOperator::NONE; CHANNELS],
        ],
    };

    /// A field that may be off by so many modes.
    fn uncertain(modes: usize) -> Inverse {
        let mode =
            |at: usize| ErrorMode::of(&std::array::from_fn(|k| (1 + at) as f32 / (1 + k) as f32)).unwrap();
        let noise = Noise::of_channels([5.0; CHANNELS], [0.01; CHANNELS]);
        let error = FieldError::of((0..modes).map(mode).collect()).unwrap();
        let mut crosstalk = NO_CROSSTALK;
        (crosstalk[0][5], crosstalk[7][2]) = (0.02, -0.01);
        Inverse::new(PadField::nominal().signals, noise).with_field_error(error).with_crosstalk(crosstalk)
    }

    fn decoders() -> Vec<Decoder> {
        let noise = Noise::of_channels([5.0; CHANNELS], [0.01; CHANNELS]);
        let mut functions = [[1e-3; CHANNELS + 1]; 5];
        functions[4][2] = 2e-3;
        let regression =
            |target| Decoder::from(Regression { zero: Zero::Raw, target, functions, reach_mm: 29.0 });
        let known = LabelledContact {
            channels: [1.0; CHANNELS],
            contact: Contact { fz_n: 2.0, ..Contact::default() },
        };
        vec![
            Decoder::from(Inverse::new(PadField::nominal().signals, noise)),
            Decoder::from(Inverse::new(PadField::nominal().signals, noise)).compensated_by(COMPENSATION),
            Decoder::from(uncertain(2)),
            regression(Target::Wrench),
            regression(Target::Contact),
            Decoder::from(Neighbours {
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
            assert_eq!(again.compensation, decoder.compensation);
            let estimate = |it: &Decoder| it.inverse().map(|inverse| inverse.estimate(&strain).unwrap());
            assert_eq!(estimate(&again), estimate(&decoder));
            assert_eq!(again.inverse().map(Inverse::crosstalk), decoder.inverse().map(Inverse::crosstalk));
        }
        assert!(Decoder::from(Statics::nominal()).to_bytes("").is_none());
    }

    #[test]
    fn a_compensation_that_the_form_has_no_room_for_is_not_left_out() {
        for decoder in decoders() {
            let is_inverse = decoder.inverse().is_some();
            assert_eq!(decoder.compensated_by(COMPENSATION).to_bytes("").is_some(), is_inverse);
        }
    }

    #[test]
    fn the_largest_field_error_adds_less_than_200_kilobytes() {
        let length = |modes| Decoder::from(uncertain(modes)).to_bytes("").unwrap().len();
        assert!(length(MODES_MAX) - length(0) < 200_000);
    }

    #[test]
    fn a_field_error_that_makes_no_sense_is_refused() {
        let file = Decoder::from(uncertain(0)).to_bytes("").unwrap();
        let (body, count) = unsealed(MAGIC, &file).unwrap().split_last_chunk::<4>().unwrap();
        assert_eq!(*count, [0; 4], "the modes come last");
        let with = |count: usize, numbers: &[f32]| {
            let numbers: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
            let body = [body, &(count as u32).to_le_bytes(), &numbers].concat();
            Decoder::from_bytes(&sealed(MAGIC, &body))
        };
        let mode = [1.0; NUMBERS];
        assert!(with(mode.len(), &mode).is_ok());
        let too_many = mode.repeat(MODES_MAX + 1);
        let mut infinite = mode;
        infinite[77] = f32::INFINITY;
        for (count, numbers) in [
            (mode.len() - 1, &mode[1..]),
            (mode.len() + 1, &mode),
            (u32::MAX as usize, &mode),
            (too_many.len(), &too_many),
            (infinite.len(), &infinite),
        ] {
            assert_eq!(with(count, numbers).err(), Some(DecoderFileError::Damaged), "{count}");
        }
    }

    #[test]
    fn crosstalk_that_no_pad_has_is_refused() {
        for (into, from, share) in [(3, 4, 0.5), (3, 3, 0.01), (0, 8, f32::NAN)] {
            let mut crosstalk = NO_CROSSTALK;
            crosstalk[into][from] = share;
            let file = Decoder::from(uncertain(1).with_crosstalk(crosstalk)).to_bytes("").unwrap();
            assert_eq!(Decoder::from_bytes(&file).err(), Some(DecoderFileError::Damaged), "{into} {from}");
        }
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
