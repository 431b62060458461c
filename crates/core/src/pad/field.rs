//! Everything that the simulator found out about a pad, and the file that keeps it.
//!
//! The nominal pad's file is part of the program; others lie in a cache, under their device's fingerprint.

use std::fmt;

use crate::bytes::{FormatError, Reader, push_text, sealed, unsealed};
use crate::pad::device::Device;
use crate::pad::device::parameter::Parameter;
use crate::pad::influence::{InfluenceField, MAPS};
use crate::quantity::CHANNELS;
use tactpad_numeric::zernike::{Polynomial, count, norms};

/// Sensitivity of one channel, µV/N, along +x, along +y and pressing, as polynomials over the plate in the place
/// divided by its radius.
pub type ForceMaps = [Polynomial; 3];

/// Largest loss of a sensitivity's maps in a file, as a share of their mean square over the plate.
const LOST_SHARE: f64 = 1e-4;

/// Highest degree of the polynomials that are kept of a sensitivity: where a module stands matters most over its foot,
/// and smaller detail than a foot is not kept.
const DEGREE_MAX: usize = 36;

const NOMINAL: &[u8] = include_bytes!("../../../../models/sstid.field");

/// First bytes of a file. The number grows with every change of the form or of the simulator's numbers, so that what
/// an older program kept is computed anew.
const MAGIC: &[u8] = b"tactpad field 1\n";

/// Derivatives of the nine channels' maps by a parameter of the device.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivity {
    /// The number.
    pub parameter: Parameter,
    /// µV/N per unit of the number.
    pub maps: [ForceMaps; CHANNELS],
}

/// A pad's answer to contacts.
#[derive(Clone, Debug, PartialEq)]
pub struct PadField {
    /// The signals, µV/N.
    pub signals: InfluenceField,
    /// The bridges' sums in the same unit, µV/N: see `readout`.
    pub sums: InfluenceField,
    /// The signals' derivatives by the device's parameters.
    pub sensitivities: Vec<Sensitivity>,
}

/// Why a file of a field is of no use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FieldFileError {
    /// It is no such file, or one of another version.
    Version,
    /// Its bytes are damaged.
    Damaged,
    /// It belongs to another device.
    Device,
}

impl fmt::Display for FieldFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Version => "not a field of this version",
            Self::Damaged => "the file is damaged",
            Self::Device => "the field of another device",
        })
    }
}

impl std::error::Error for FieldFileError {}

impl PadField {
    /// The field of the pad in `models/sstid.toml`.
    #[expect(clippy::expect_used, reason = "the file is part of the program and a test reads it")]
    pub fn nominal() -> Self {
        Self::from_bytes(NOMINAL, &Device::nominal()).expect("models/sstid.field is the nominal pad's")
    }

    /// Reads the field of `device`.
    ///
    /// # Errors
    /// Bytes that are not what [`Self::to_bytes`] wrote for an equal device.
    pub fn from_bytes(bytes: &[u8], device: &Device) -> Result<Self, FieldFileError> {
        let mut from = body_of(MAGIC, bytes, device)?;
        field(&mut from).filter(|_| from.is_at_end()).ok_or(FieldFileError::Damaged)
    }

    /// The bytes of the field's file. Numbers are little-endian.
    ///
    /// After the magic: the device's canonical text with its length (u32); the signals and the sums, each as spacing,
    /// radius (f32), number of coefficients (u32) and coefficients (f32); the number of sensitivities (u32), each as
    /// name with length, degree (u32) and, for each of the 27 maps, a scale (f32) and coefficients as multiples of it
    /// (i16); last, the sum of everything between magic and sum (FNV-1a, u64). A sensitivity so kept is rounded to
    /// 1/65,000 of each map's largest coefficient, and loses what is finer than its degree: 1 % at most, except the finest
    /// detail over the feet where a module moves.
    pub fn to_bytes(&self, device: &Device) -> Vec<u8> {
        let mut body = Vec::new();
        push_text(&mut body, device.field_text().as_bytes());
        [&self.signals, &self.sums].into_iter().for_each(|field| field.write(&mut body));
        body.extend((self.sensitivities.len() as u32).to_le_bytes());
        for Sensitivity { parameter, maps } in &self.sensitivities {
            push_text(&mut body, parameter.name().as_bytes());
            write_maps(&mut body, maps);
        }
        sealed(MAGIC, &body)
    }
}

/// Bytes that follow the device's text in the body of a file that begins with `magic`.
pub(super) fn body_of<'b>(
    magic: &[u8],
    bytes: &'b [u8],
    device: &Device,
) -> Result<Reader<'b>, FieldFileError> {
    let body = unsealed(magic, bytes).map_err(|broken| match broken {
        FormatError::Magic => FieldFileError::Version,
        FormatError::Damaged => FieldFileError::Damaged,
    })?;
    let mut reader = Reader::new(body);
    let text = reader.text().ok_or(FieldFileError::Damaged)?;
    if text == device.field_text().as_bytes() { Ok(reader) } else { Err(FieldFileError::Device) }
}

/// Writes a change of the maps: its degree, then map by map.
pub(super) fn write_maps(to: &mut Vec<u8>, maps: &[ForceMaps; CHANNELS]) {
    let degree = kept_degree(maps);
    to.extend((degree as u32).to_le_bytes());
    maps.iter().flatten().for_each(|map| write_map(to, map, degree));
}

/// The least degree to which the maps can be cut.
fn kept_degree(maps: &[ForceMaps; CHANNELS]) -> usize {
    let norms = norms(DEGREE_MAX);
    let square_from = |first: usize| -> f64 {
        let maps = maps.iter().flatten();
        let squares = maps.map(|map| -> f64 {
            map.coefficients.iter().zip(&norms).skip(first).map(|(c, norm)| c * c * norm).sum()
        });
        squares.sum()
    };
    let all = square_from(0);
    (0..DEGREE_MAX).find(|degree| square_from(count(*degree)) <= LOST_SHARE * all).unwrap_or(DEGREE_MAX)
}

fn write_map(to: &mut Vec<u8>, map: &Polynomial, degree: usize) {
    let kept = || (0..count(degree)).map(|k| map.coefficients.get(k).copied().unwrap_or(0.0));
    let largest = kept().fold(0.0_f64, |largest, c| largest.max(c.abs()));
    let scale = (largest / f64::from(i16::MAX)) as f32;
    to.extend(scale.to_le_bytes());
    let steps = |c: f64| if scale > 0.0 { (c / f64::from(scale)).round() as i16 } else { 0 };
    to.extend(kept().flat_map(|c| steps(c).to_le_bytes()));
}

/// Reads a field's file, after the device's text.
fn field(from: &mut Reader<'_>) -> Option<PadField> {
    let (signals, sums) = (InfluenceField::read(from)?, InfluenceField::read(from)?);
    let sensitivities = (0..from.length()?).map(|_| sensitivity(from)).collect::<Option<_>>()?;
    Some(PadField { signals, sums, sensitivities })
}

fn sensitivity(from: &mut Reader<'_>) -> Option<Sensitivity> {
    let parameter = std::str::from_utf8(from.text()?).ok()?.parse().ok()?;
    Some(Sensitivity { parameter, maps: read_maps(from)? })
}

/// Reads what [`write_maps`] wrote.
pub(super) fn read_maps(from: &mut Reader<'_>) -> Option<[ForceMaps; CHANNELS]> {
    let degree = from.length().filter(|degree| *degree <= DEGREE_MAX)?;
    let maps: Vec<Polynomial> = (0..MAPS).map(|_| map(from, degree)).collect::<Option<_>>()?;
    let mut maps = maps.into_iter();
    let none = || Polynomial { coefficients: Vec::new() };
    Some(std::array::from_fn(|_| std::array::from_fn(|_| maps.next().unwrap_or_else(none))))
}

fn map(from: &mut Reader<'_>, degree: usize) -> Option<Polynomial> {
    let scale = f64::from(from.float().filter(|scale| scale.is_finite())?);
    let steps = from.take(2 * count(degree))?.as_chunks().0;
    Some(Polynomial {
        coefficients: steps.iter().map(|s| scale * f64::from(i16::from_le_bytes(*s))).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nominal_field_reads_back_and_is_small() {
        assert!(NOMINAL.len() < 1_000_000, "{}", NOMINAL.len());
        let (device, field) = (Device::nominal(), PadField::nominal());
        let again = PadField::from_bytes(&field.to_bytes(&device), &device).unwrap();
        assert!(again.signals == field.signals && again.sums == field.sums);
        for (again, first) in again.sensitivities.iter().zip(&field.sensitivities) {
            assert_eq!(again.parameter, first.parameter);
            for (again, first) in again.maps.iter().flatten().zip(first.maps.iter().flatten()) {
                let largest = first.coefficients.iter().fold(0.0_f64, |largest, c| largest.max(c.abs()));
                // What was cut once may be cut a little shorter the next time.
                let lost = again.coefficients.iter().zip(&first.coefficients).map(|(a, b)| (a - b).abs());
                assert!(lost.fold(0.0, f64::max) <= 1e-4 * largest);
            }
        }
    }

    #[test]
    fn damage_is_found() {
        let device = Device::nominal();
        let refused = |bytes: &[u8]| PadField::from_bytes(bytes, &device).unwrap_err();
        assert_eq!(refused(b"tactpad field 0\n"), FieldFileError::Version);
        assert_eq!(refused(&NOMINAL[..MAGIC.len()]), FieldFileError::Damaged);
        assert_eq!(refused(&NOMINAL[..NOMINAL.len() - 1]), FieldFileError::Damaged);
        for at in [MAGIC.len(), NOMINAL.len() / 2, NOMINAL.len() - 1] {
            let mut bytes = NOMINAL.to_vec();
            bytes[at] ^= 1;
            assert_eq!(refused(&bytes), FieldFileError::Damaged, "byte {at}");
        }
    }

    #[test]
    fn another_device_is_told_apart() {
        let mut device = Device::nominal();
        device.plate.thickness_mm = 1.15;
        assert_eq!(PadField::from_bytes(NOMINAL, &device).err(), Some(FieldFileError::Device));
        let mut renamed = Device::nominal();
        renamed.name = "mine".into();
        renamed.modules[1].gain = [1.1, 1.0, 1.0];
        assert!(PadField::from_bytes(NOMINAL, &renamed).is_ok());
    }
}
