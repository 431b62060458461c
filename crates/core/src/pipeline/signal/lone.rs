//! A channel that reads by itself.

use crate::quantity::CHANNELS;

/// Whatever presses on the plate, the third of the channels, by size, reads a larger share of the first than this: of 120,000
/// contacts of one and two fingers with any shear on the nominal pad 0.06 at the least. The rest is left to gains.
const THIRD_SHARE: f64 = 0.04;

/// The channel that reads the most, if that is no load, as all but two channels read next to nothing beside it.
pub fn lone_channel(uv: &[f64; CHANNELS]) -> Option<usize> {
    let mut by_size: [usize; CHANNELS] = std::array::from_fn(|k| k);
    by_size.sort_unstable_by(|one, other| uv[*other].abs().total_cmp(&uv[*one].abs()));
    let [first, _, third, ..] = by_size;
    (uv[third].abs() < THIRD_SHARE * uv[first].abs()).then_some(first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pad::field::PadField;
    use crate::quantity::Contact;
    use tactpad_numeric::random::SplitMix64;

    #[test]
    fn no_finger_reads_on_one_or_two_channels_alone() {
        let field = PadField::nominal().signals;
        let mut random = SplitMix64::new(5);
        let mut between = |low: f32, high: f32| low + (high - low) * random.fraction();
        for number in 0..20_000 {
            let mut uv = [0.0; CHANNELS];
            for _ in 0..=number % 2 {
                let (radius_mm, turn) =
                    (28.0 * between(0.0, 1.0).sqrt(), between(0.0, std::f32::consts::TAU));
                let fz_n = between(0.2, 4.0);
                let contact = Contact {
                    x_mm: radius_mm * libm::cosf(turn),
                    y_mm: radius_mm * libm::sinf(turn),
                    fx_n: fz_n * between(-1.0, 1.0),
                    fy_n: fz_n * between(-1.0, 1.0),
                    fz_n,
                };
                uv.iter_mut().zip(field.strain_uv(&contact).uv).for_each(|(sum, uv)| *sum += f64::from(uv));
            }
            assert_eq!(lone_channel(&uv), None, "{uv:?}");
        }
        let mut uv = [10.0; CHANNELS];
        (uv[4], uv[8]) = (-2_000.0, 900.0);
        assert_eq!(lone_channel(&uv), Some(4));
    }
}
