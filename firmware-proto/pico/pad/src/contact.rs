//! The contact that nine counts tell, by the balance of forces and moments: for hosts that do not decode.
//!
//! The chip has no unit for floating point, so it is whole numbers: forces, and the moments that tell the place, are sums of counts
//! times constants. They come of the numbers in models/statics.toml and of the law that is described there, as the host's decoder of
//! that name has it.

use firmware_proto::CHANNELS;

use crate::CONVERTERS;
use crate::excitation::PICOVOLTS_PER_COUNT;
use crate::zero::Zero;

/// Numbers of the nominal pad.
mod statics {
    include!(concat!(env!("OUT_DIR"), "/statics.rs"));
}

/// A touch begins at this normal force, and ends below the other one, in millinewtons: those of the host's own decoders.
const ON_MN: i64 = 150;
const OFF_MN: i64 = 100;

/// A touch that stays below this, in millinewtons, for as long as that, in milliseconds, is drift.
const GUARD_MN: i64 = 300;
const GUARD_MS: u32 = 10_000;

/// Standard deviations that are told: on a pad as the paper's figures make it, statics are off by so much (docs/decoding.md).
pub const PLACE_DEVIATION_UM: u16 = 1_330;
/// The same of forces.
pub const FORCE_DEVIATION_MN: u16 = 331;

/// Constants have so many binary digits after the point.
const SHIFT: u32 = 16;

/// Cosine and sine of the modules' places: 0°, 120° and 240°.
const OUTWARD: [(f64, f64); CONVERTERS] =
    [(1.0, 0.0), (-0.5, 0.866_025_403_784_438_6), (-0.5, -0.866_025_403_784_438_6)];

/// What each count adds to a sum.
type Row = [i32; CHANNELS];

/// Forces in micronewtons along x and y and into the plate, and the moments that place them, in micronewton-millimetres.
const ROWS: [Row; 5] = {
    let uv = PICOVOLTS_PER_COUNT as f64 * 1e-6;
    let (height, share) = (statics::CONTACT_HEIGHT_MM, statics::FALSE_SHEAR_PER_MM);
    let mut rows = [[0; CHANNELS]; 5];
    let mut channel = 0;
    while channel < CHANNELS {
        let (cos, sin) = OUTWARD[channel / 3];
        // Forces of a count in newtons, and its moments p about the centre.
        let (raw_x, raw_y, normal) = match channel % 3 {
            0 => (-sin * uv / statics::TANGENTIAL_UV_PER_N, cos * uv / statics::TANGENTIAL_UV_PER_N, 0.0),
            1 => (cos * uv / statics::RADIAL_UV_PER_N, sin * uv / statics::RADIAL_UV_PER_N, 0.0),
            _ => (0.0, 0.0, uv / statics::NORMAL_UV_PER_N),
        };
        let (p_x, p_y) = (statics::MODULE_RADIUS_MM * cos * normal, statics::MODULE_RADIUS_MM * sin * normal);
        let kept = 1.0 - share * height;
        let (x, y) = ((raw_x - share * p_x) / kept, (raw_y - share * p_y) / kept);
        let sums = [x, y, normal, p_x - height * x, p_y - height * y];
        let mut row = 0;
        while row < 5 {
            let scaled = sums[row] * 1e6 * (1_u32 << SHIFT) as f64;
            rows[row][channel] = (if scaled < 0.0 { scaled - 0.5 } else { scaled + 0.5 }) as i32;
            row += 1;
        }
        channel += 1;
    }
    rows
};

/// A contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Touch {
    /// In micrometres from the centre. It may lie beyond the plate: the host moves it to the rim.
    pub place_um: [i32; 2],
    /// Along x, along y, and into the plate, in millinewtons.
    pub force_mn: [i32; 3],
}

/// Decodes, and says what a touch is.
#[derive(Clone, Debug, Default)]
pub struct Decoder {
    zero: Zero,
    is_touched: bool,
    /// Samples of a touch that may be drift.
    doubtful: u32,
}

impl Decoder {
    /// The contact of these counts, of which `rate_hz` come in a second; `None` while nothing touches, while the zero is not known, and
    /// without counts that can be trusted.
    pub fn decode(&mut self, counts: Option<&[i32; CHANNELS]>, rate_hz: u16) -> Option<Touch> {
        let touch = counts.and_then(|counts| {
            let zero = self.zero.at()?;
            let mut strain = [0; CHANNELS];
            for ((strain, count), zero) in strain.iter_mut().zip(counts).zip(zero) {
                *strain = count.saturating_sub(zero);
            }
            Some(balance(&strain))
        });
        let normal_mn = touch.map_or(0, |touch| i64::from(touch.force_mn[2]));
        self.is_touched = normal_mn >= if self.is_touched { OFF_MN } else { ON_MN };
        self.doubtful = if self.is_touched && normal_mn < GUARD_MN { self.doubtful + 1 } else { 0 };
        if self.doubtful > u32::from(rate_hz) * (GUARD_MS / 1_000) {
            self.zero = Zero::default();
            self.doubtful = 0;
            self.is_touched = false;
        }
        self.zero.see(counts.filter(|_| !self.is_touched), rate_hz);
        touch.filter(|_| self.is_touched)
    }
}

/// The contact whose force and moment these counts, without their zero, are.
fn balance(strain: &[i32; CHANNELS]) -> Touch {
    let [x_un, y_un, normal_un, moment_x, moment_y] = ROWS.map(|row| {
        let sum: i64 = row.iter().zip(strain).map(|(row, count)| i64::from(*row) * i64::from(*count)).sum();
        (sum + (1 << (SHIFT - 1))) >> SHIFT
    });
    // Where nothing presses there is no place; what is read of it counts for nothing.
    let place = |moment: i64| rounded(moment * 1_000, if normal_un == 0 { i64::MAX } else { normal_un });
    let force = |un: i64| rounded(un, 1_000);
    Touch {
        place_um: [place(moment_x), place(moment_y)],
        force_mn: [force(x_un), force(y_un), force(normal_un)],
    }
}

fn rounded(number: i64, divisor: i64) -> i32 {
    let half = divisor.abs() / 2;
    let number = if number < 0 { number - half } else { number + half };
    (number / divisor).clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: u16 = 1_000;

    fn counts(uv: f64) -> i32 {
        (uv / (f64::from(PICOVOLTS_PER_COUNT) * 1e-6)).round() as i32
    }

    /// Channels of a press of so many newtons at the middle of a module.
    fn press(module: usize, n: f64) -> [i32; CHANNELS] {
        let mut strain = [0; CHANNELS];
        strain[3 * module + 2] = counts(n * statics::NORMAL_UV_PER_N);
        strain
    }

    /// A decoder that knows its zero.
    fn ready(zero: [i32; CHANNELS]) -> Decoder {
        let mut decoder = Decoder::default();
        for _ in 0..300 {
            assert_eq!(decoder.decode(Some(&zero), RATE_HZ), None);
        }
        decoder
    }

    #[test]
    fn a_module_that_alone_is_pressed_is_where_the_contact_is() {
        for (module, (cos, sin)) in OUTWARD.into_iter().enumerate() {
            let touch = balance(&press(module, 2.0));
            // A load on one module pretends shear; its moment about the height of the contact moves the place.
            let shear_n = -statics::FALSE_SHEAR_PER_MM * statics::MODULE_RADIUS_MM * 2.0
                / (1.0 - statics::FALSE_SHEAR_PER_MM * statics::CONTACT_HEIGHT_MM);
            let radius_um = 1e3 * (statics::MODULE_RADIUS_MM - statics::CONTACT_HEIGHT_MM * shear_n / 2.0);
            for (told, wanted) in touch.place_um.into_iter().zip([radius_um * cos, radius_um * sin]) {
                assert!((f64::from(told) - wanted).abs() < 3.0, "{touch:?}");
            }
            assert!((touch.force_mn[2] - 2_000).abs() <= 1, "{touch:?}");
            assert!((f64::from(touch.force_mn[0]) - 1e3 * shear_n * cos).abs() < 1.0, "{touch:?}");
        }
    }

    #[test]
    fn shear_is_told_along_both_axes() {
        // A newton along +y at the contact's height, and two into the plate at its centre.
        let mut strain = [0; CHANNELS];
        for (module, (cos, sin)) in OUTWARD.into_iter().enumerate() {
            strain[3 * module] = counts(statics::TANGENTIAL_UV_PER_N * cos / 3.0);
            strain[3 * module + 1] = counts(statics::RADIAL_UV_PER_N * sin / 3.0);
            let moment = 2.0 * statics::CONTACT_HEIGHT_MM * sin / statics::MODULE_RADIUS_MM;
            // What the moment pretends of shear comes on top of what the posts carry.
            strain[3 * module + 2] = counts(statics::NORMAL_UV_PER_N * (2.0 + moment) / 3.0);
        }
        let raw = balance(&strain);
        let false_n = statics::FALSE_SHEAR_PER_MM * statics::CONTACT_HEIGHT_MM;
        let wanted_mn = 1e3 * (1.0 - false_n) / (1.0 - false_n);
        assert!(
            (f64::from(raw.force_mn[1]) - wanted_mn).abs() < 2.0 && raw.force_mn[0].abs() <= 1,
            "{raw:?}"
        );
        assert!(raw.place_um.into_iter().all(|um| um.abs() < 5), "{raw:?}");
    }

    #[test]
    fn a_touch_begins_and_ends_with_hysteresis() {
        let offsets = [9_000, -50_000, 3, 4, 5, 6, 7, 100_000, -9];
        let mut decoder = ready(offsets);
        let mut touched = |mn: i32| {
            let mut all = press(1, f64::from(mn) * 1e-3);
            all.iter_mut().zip(offsets).for_each(|(count, offset)| *count += offset);
            decoder.decode(Some(&all), RATE_HZ).is_some()
        };
        assert_eq!(
            [100, 145, 155, 145, 105, 95, 145].map(&mut touched),
            [false, false, true, true, true, false, false]
        );
    }

    #[test]
    fn counts_that_cannot_be_trusted_are_no_touch_and_change_no_zero() {
        let mut decoder = ready([0; CHANNELS]);
        assert!(decoder.decode(Some(&press(0, 1.0)), RATE_HZ).is_some());
        assert_eq!(decoder.decode(None, RATE_HZ), None);
        let again = decoder.decode(Some(&press(0, 1.0)), RATE_HZ).unwrap();
        assert!((again.force_mn[2] - 1_000).abs() <= 1);
    }

    #[test]
    fn a_light_touch_that_never_ends_is_drift() {
        let mut decoder = ready([0; CHANNELS]);
        let samples = (0..20_000).filter(|_| decoder.decode(Some(&press(2, 0.2)), RATE_HZ).is_some()).count();
        assert!((9_990..=10_001).contains(&samples), "{samples}");
        let firm = (0..20_000).all(|_| decoder.decode(Some(&press(2, 2.2)), RATE_HZ).is_some());
        assert!(firm, "a firm one is none");
    }

    #[test]
    fn any_counts_are_numbers() {
        for count in [i32::MIN, i32::MAX] {
            let mut decoder = ready([0; CHANNELS]);
            let _ = decoder.decode(Some(&[count; CHANNELS]), RATE_HZ);
            let mut mixed = [count; CHANNELS];
            mixed[2] = 0;
            let _ = balance(&mixed);
        }
    }
}
