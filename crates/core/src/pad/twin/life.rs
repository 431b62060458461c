//! The life of one pad, from one use to the next: its state, what surrounds it, and the bytes of both.

use std::fmt;

use super::pad::{Circumstances, TwinPad};
use super::state::PadState;
use crate::bytes::{FormatError, Reader, push_doubles, sealed, unsealed};
use crate::pad::device::Device;
use crate::pad::field::PadField;
use crate::quantity::Contact;

/// Time of a cycle of load that is only counted.
pub const CYCLE_S: f64 = 1.0;

/// First bytes of a file. The number grows with every change of the form.
const MAGIC: &[u8] = b"tactpad twin state 1\n";

/// A pad and what it has behind it.
#[derive(Clone, Debug)]
pub struct Life {
    /// What of the pad goes on in time.
    pub state: PadState,
    /// Its temperature, and the cycles of load behind it.
    pub around: Circumstances,
}

/// Why bytes are no pad's life.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LifeError {
    /// They are something else, or of another version.
    Version,
    /// They are damaged.
    Damaged,
    /// They are of a pad that is made otherwise.
    Device,
}

impl fmt::Display for LifeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Version => "it is no state of a twin's pad, or one of another version",
            Self::Damaged => "it is damaged",
            Self::Device => "it is of another pad than --device and --imperfections say",
        })
    }
}

impl std::error::Error for LifeError {}

impl Life {
    /// A new pad of this device, drawn from the seed, where its temperature is the device's reference.
    pub fn new(device: &Device, seed: u64) -> Self {
        let temperature_c = device.behaviour.thermal.reference_c;
        Self { state: PadState::new(device, seed), around: Circumstances { temperature_c, cycles: 0.0 } }
    }

    /// The same pad after `cycles` more cycles of load, a second each. `field` is that of `device`.
    ///
    /// Loads that are only counted age the pad; they leave no strain in its memory.
    #[must_use]
    pub fn after_cycles(self, cycles: f64, device: &Device, field: &PadField) -> Self {
        let around = Circumstances { cycles: self.around.cycles + cycles, ..self.around };
        let mut pad = TwinPad::going_on(device, field, self.state);
        pad.read(CYCLE_S * cycles, &Contact::default(), &around);
        Self { state: pad.into_state(), around }
    }

    /// The bytes of a file that keeps it. Numbers are little-endian.
    ///
    /// After the magic: the fingerprint of the device's pad (u64), temperature and cycles (f64), then the state, number by
    /// number; last, the sum of everything between magic and sum (FNV-1a, u64).
    pub fn to_bytes(&self, device: &Device) -> Vec<u8> {
        let mut body = device.pad_fingerprint().to_le_bytes().to_vec();
        push_doubles(&mut body, &[self.around.temperature_c, self.around.cycles]);
        self.state.write(&mut body);
        sealed(MAGIC, &body)
    }

    /// Reads the life of a pad of `device`.
    ///
    /// # Errors
    /// Bytes that are not what [`Self::to_bytes`] wrote for a device with the same pad. The hand and the rig in it may be
    /// others.
    pub fn from_bytes(bytes: &[u8], device: &Device) -> Result<Self, LifeError> {
        let body = unsealed(MAGIC, bytes).map_err(|broken| match broken {
            FormatError::Magic => LifeError::Version,
            FormatError::Damaged => LifeError::Damaged,
        })?;
        let mut from = Reader::new(body);
        if from.bits().ok_or(LifeError::Damaged)? != device.pad_fingerprint() {
            return Err(LifeError::Device);
        }
        life(&mut from, device).filter(|_| from.is_at_end()).ok_or(LifeError::Damaged)
    }
}

fn life(from: &mut Reader<'_>, device: &Device) -> Option<Life> {
    let (temperature_c, cycles) = (from.finite()?, from.finite()?);
    let state = PadState::read(from, device)?;
    (cycles >= 0.0 && state.at_s >= 0.0)
        .then_some(Life { state, around: Circumstances { temperature_c, cycles } })
}
