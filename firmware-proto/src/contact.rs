//! One contact of a pad that decodes on its own.

use crate::cursor::{Reader, Writer};
use crate::sample::Status;

/// What touches the plate now, as the pad itself makes it out. The README tells its place in the payload byte by byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ContactSample {
    /// One more than the sample before; after `u32::MAX` comes 0. A gap counts the samples lost on the way.
    pub sequence: u32,
    /// Microseconds of the pad's own clock, counted from its start, when the contact was measured.
    pub time_us: u64,
    /// Place on the plate in micrometres from its centre: +x to the right, +y up.
    pub place_um: [i32; 2],
    /// Force on the plate along x, y, and into it, in millinewtons.
    pub force_mn: [i32; 3],
    /// Standard deviation of x and of y, in micrometres; [`UNKNOWN`] if the pad cannot tell.
    pub place_deviation_um: u16,
    /// Standard deviation of the forces along x and y, in millinewtons; [`UNKNOWN`] if the pad cannot tell.
    pub shear_deviation_mn: u16,
    /// Standard deviation of the force into the plate, in millinewtons; [`UNKNOWN`] if the pad cannot tell.
    pub normal_deviation_mn: u16,
    /// Whether anything touches the plate. If not, place and forces mean nothing.
    pub is_touched: bool,
    /// Whether the pad measures forces along the plate. If not, they are zero.
    pub has_shear: bool,
    /// What the pad knows to be wrong: the bits of a restart and of a fault of the whole pad, no others.
    pub status: Status,
}

/// A deviation that the pad cannot tell.
pub const UNKNOWN: u16 = u16::MAX;

const TOUCHED: u16 = 1 << 0;
const SHEAR: u16 = 1 << 1;

impl ContactSample {
    /// The kind byte.
    pub const KIND: u8 = 0x05;

    /// Bytes of the payload.
    pub const PAYLOAD_LEN: usize = 4 + 8 + 2 * 4 + 3 * 4 + 3 * 2 + 2 + 2;

    /// A sample in which nothing touches the plate and nothing is wrong.
    #[must_use]
    pub const fn untouched(sequence: u32, time_us: u64) -> Self {
        Self {
            sequence,
            time_us,
            place_um: [0; 2],
            force_mn: [0; 3],
            place_deviation_um: UNKNOWN,
            shear_deviation_mn: UNKNOWN,
            normal_deviation_mn: UNKNOWN,
            is_touched: false,
            has_shear: false,
            status: Status::OK,
        }
    }

    pub(crate) fn write(&self, out: &mut Writer) {
        out.put(&self.sequence.to_le_bytes());
        out.put(&self.time_us.to_le_bytes());
        for number in self.place_um.iter().chain(&self.force_mn) {
            out.put(&number.to_le_bytes());
        }
        for deviation in [self.place_deviation_um, self.shear_deviation_mn, self.normal_deviation_mn] {
            out.put(&deviation.to_le_bytes());
        }
        let touched = if self.is_touched { TOUCHED } else { 0 };
        let shear = if self.has_shear { SHEAR } else { 0 };
        out.put(&(touched | shear).to_le_bytes());
        out.put(&self.status.of_whole_pad().0.to_le_bytes());
    }

    pub(crate) fn read(payload: &mut Reader) -> Option<Self> {
        let sequence = payload.u32()?;
        let time_us = payload.u64()?;
        let place_um = [payload.i32()?, payload.i32()?];
        let force_mn = [payload.i32()?, payload.i32()?, payload.i32()?];
        let [place_deviation_um, shear_deviation_mn, normal_deviation_mn] =
            [payload.u16()?, payload.u16()?, payload.u16()?];
        let state = payload.u16()?;
        let status = Status(payload.u16()?).of_whole_pad();
        Some(Self {
            sequence,
            time_us,
            place_um,
            force_mn,
            place_deviation_um,
            shear_deviation_mn,
            normal_deviation_mn,
            is_touched: state & TOUCHED != 0,
            has_shear: state & SHEAR != 0,
            status,
        })
    }
}

const _: () = assert!(ContactSample::PAYLOAD_LEN == 42);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_that_mean_nothing_are_neither_sent_nor_read() {
        let sample = ContactSample { status: Status(u16::MAX), ..ContactSample::untouched(1, 2) };
        let mut bytes = [0; ContactSample::PAYLOAD_LEN];
        sample.write(&mut Writer::new(&mut bytes));
        assert_eq!(bytes[38..], [0, 0, 0x00, 0x0C]);
        bytes[38..].fill(0xFF);
        let read = ContactSample::read(&mut Reader::new(&bytes)).unwrap();
        assert!(read.is_touched && read.has_shear);
        assert_eq!(read.status, Status(0x0C00));
    }
}
