//! Changes of a pad's channels, µV/N, where a part of a module has come off: changes of the field that are not small.
//!
//! Each is the difference of two solutions: of a pad whose module 0 has the flaw, and of the pad as it is. The nominal pad's are
//! part of the program; others lie in a cache, beside the fields.

use std::fmt;
use std::str::FromStr;

use crate::bytes::{Reader, push_text, sealed};
use crate::pad::device::{Device, Module, Side};
use crate::pad::field::{FieldFileError, ForceMaps, body_of, read_maps, write_maps};
use crate::quantity::CHANNELS;

const NOMINAL: &[u8] = include_bytes!("../../../../models/sstid.changes");

/// First bytes of a file. The number grows with every change of the form or of the simulator's numbers.
const MAGIC: &[u8] = b"tactpad changes 1\n";

/// Shares of a bond's area at which the change is solved. Between these, and none, it is interpolated: on the nominal pad it is
/// then off by 1 % of itself at most, but at a share of 0.9 by 15 %.
pub const DEBONDED_SHARES: [f64; 3] = [0.1, 0.4, 0.75];

/// Flaw of a module: the part that it lacks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Flaw {
    /// The frame on a side.
    FrameOpen(Side),
    /// A share of the bond's area, from a side inwards.
    Debonded(Side, f64),
}

impl Flaw {
    /// All whose changes are kept.
    pub fn all() -> impl Iterator<Item = Self> {
        let debonded = |side| DEBONDED_SHARES.map(|share| Self::Debonded(side, share));
        Side::ALL.into_iter().map(Self::FrameOpen).chain(Side::ALL.into_iter().flat_map(debonded))
    }

    /// The device with the flaw in its module 0.
    #[must_use]
    pub fn on(self, device: &Device) -> Device {
        let mut flawed = device.clone();
        let [module, ..] = &mut flawed.modules;
        *module = match self {
            Self::FrameOpen(side) => Module { frame_open: Some(side), ..*module },
            Self::Debonded(side, share) => {
                Module { debonded_side: Some(side), debonded_share: share, ..*module }
            }
        };
        flawed
    }
}

/// As files and progress lines write it: `frame open +x`, `debonded -y 0.4`.
impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::FrameOpen(side) => write!(f, "frame open {}", side.name()),
            Self::Debonded(side, share) => write!(f, "debonded {} {share:?}", side.name()),
        }
    }
}

impl FromStr for Flaw {
    type Err = FieldFileError;

    fn from_str(text: &str) -> Result<Self, FieldFileError> {
        Self::all().find(|flaw| flaw.to_string() == text).ok_or(FieldFileError::Version)
    }
}

/// A flaw of module 0, and what it changes.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldChange {
    /// The flaw.
    pub flaw: Flaw,
    /// Change of the channels against the whole pad, µV/N.
    pub maps: [ForceMaps; CHANNELS],
}

/// The changes by all flaws.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldChanges(pub Vec<FieldChange>);

impl FieldChanges {
    /// Those of the pad in `models/sstid.toml`.
    #[expect(clippy::expect_used, reason = "the file is part of the program and a test reads it")]
    pub fn nominal() -> Self {
        Self::from_bytes(NOMINAL, &Device::nominal()).expect("models/sstid.changes is the nominal pad's")
    }

    /// Reads the changes of `device`.
    ///
    /// # Errors
    /// Bytes that are not what [`Self::to_bytes`] wrote for an equal device.
    pub fn from_bytes(bytes: &[u8], device: &Device) -> Result<Self, FieldFileError> {
        let mut reader = body_of(MAGIC, bytes, device)?;
        let count = reader.length().ok_or(FieldFileError::Damaged)?;
        let changes = (0..count).map(|_| change(&mut reader)).collect::<Option<_>>();
        changes.filter(|_| reader.is_at_end()).map(Self).ok_or(FieldFileError::Damaged)
    }

    /// The bytes of the file: after the magic the device's canonical text with its length (u32), the number of changes (u32), each
    /// as the flaw's text with its length and its maps as in a field's file; last, the sum of everything between magic and sum.
    pub fn to_bytes(&self, device: &Device) -> Vec<u8> {
        let mut body = Vec::new();
        push_text(&mut body, device.field_text().as_bytes());
        body.extend((self.0.len() as u32).to_le_bytes());
        for FieldChange { flaw, maps } in &self.0 {
            push_text(&mut body, flaw.to_string().as_bytes());
            write_maps(&mut body, maps);
        }
        sealed(MAGIC, &body)
    }
}

fn change(from: &mut Reader<'_>) -> Option<FieldChange> {
    let flaw = std::str::from_utf8(from.text()?).ok()?.parse().ok()?;
    Some(FieldChange { flaw, maps: read_maps(from)? })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nominal_pads_have_all_flaws_and_are_small() {
        assert!(NOMINAL.len() < 1_000_000, "{}", NOMINAL.len());
        let flaws: Vec<Flaw> = FieldChanges::nominal().0.iter().map(|change| change.flaw).collect();
        assert_eq!(flaws, Flaw::all().collect::<Vec<_>>());
    }

    #[test]
    fn another_device_and_damage_are_told() {
        let mut device = Device::nominal();
        device.plate.thickness_mm = 1.15;
        assert_eq!(FieldChanges::from_bytes(NOMINAL, &device).err(), Some(FieldFileError::Device));
        let mut bytes = NOMINAL.to_vec();
        bytes[NOMINAL.len() / 2] ^= 1;
        let damaged = FieldChanges::from_bytes(&bytes, &Device::nominal());
        assert_eq!(damaged.err(), Some(FieldFileError::Damaged));
        assert_eq!(
            FieldChanges::from_bytes(b"tactpad field 1\n", &Device::nominal()).err(),
            Some(FieldFileError::Version)
        );
    }

    #[test]
    fn a_flaw_is_module_0s_and_reads_back() {
        let device = Flaw::Debonded(Side::MinusY, 0.4).on(&Device::nominal());
        assert_eq!(device.modules[0].debonded(), Some((Side::MinusY, 0.4)));
        assert_eq!(device.modules[1], Module::NOMINAL);
        for flaw in Flaw::all() {
            assert_eq!(flaw.to_string().parse(), Ok(flaw));
        }
    }
}
