//! Colours: two maps for values, one list for series.
//!
//! The maps are straight lines between a few points of the colour space Oklab, in which equal distances look
//! equally large. The points were chosen by us, evenly spaced along each map and inside sRGB. Source of the space
//! and its matrices: B. Ottosson, "A perceptual color space for image processing", 2020.

/// An opaque colour in sRGB.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rgb {
    /// Red, green, blue.
    pub levels: [u8; 3],
}

/// How values become colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColourMap {
    /// From pale yellow (low) over green and blue to dark violet (high): for quantities with one sign.
    Sequential,
    /// From blue (negative) over white to red (positive), equally dark on both sides.
    Diverging,
}

type Lab = [f64; 3];

/// Low to high, in Oklab.
const SEQUENTIAL: [Lab; 9] = [
    [0.9750, -0.0096, 0.0336],
    [0.8986, -0.0551, 0.0554],
    [0.8165, -0.0920, 0.0330],
    [0.7331, -0.1053, -0.0058],
    [0.6486, -0.0974, -0.0441],
    [0.5630, -0.0752, -0.0734],
    [0.4763, -0.0460, -0.0911],
    [0.3885, -0.0154, -0.0985],
    [0.3000, 0.0139, -0.0990],
];

/// From −1 to 1, in Oklab; lightness is symmetric.
const DIVERGING: [Lab; 11] = [
    [0.3600, -0.0160, -0.1139],
    [0.4868, -0.0312, -0.1270],
    [0.6150, -0.0425, -0.1184],
    [0.7402, -0.0415, -0.0898],
    [0.8593, -0.0248, -0.0476],
    [0.9750, 0.0000, 0.0000],
    [0.8593, 0.0344, 0.0539],
    [0.7402, 0.0778, 0.0904],
    [0.6150, 0.1158, 0.0962],
    [0.4868, 0.1285, 0.0778],
    [0.3600, 0.1088, 0.0507],
];

/// Colours that people with any colour vision tell apart.
///
/// Source: M. Okabe and K. Ito, "Color universal design", 2008; without its yellow, which is too pale for lines.
const SERIES: [Rgb; 7] = [
    Rgb::new(0x00, 0x72, 0xb2),
    Rgb::new(0xd5, 0x5e, 0x00),
    Rgb::new(0x00, 0x9e, 0x73),
    Rgb::new(0xcc, 0x79, 0xa7),
    Rgb::new(0xe6, 0x9f, 0x00),
    Rgb::new(0x56, 0xb4, 0xe9),
    Rgb::new(0x33, 0x33, 0x33),
];

impl Rgb {
    /// White, the page.
    pub const WHITE: Self = Self::new(255, 255, 255);

    /// A colour of three levels.
    pub const fn new(red: u8, green: u8, blue: u8) -> Self {
        Self { levels: [red, green, blue] }
    }

    /// The colour of the series with this number; after the seventh they start again.
    pub fn of_series(index: usize) -> Self {
        SERIES.get(index % SERIES.len()).copied().unwrap_or(Self::WHITE)
    }

    /// Relative luminance in 0..=1. Source: IEC 61966-2-1 (sRGB).
    pub fn luminance(self) -> f64 {
        let [r, g, b] = self.levels.map(|level| linear(f64::from(level) / 255.0));
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }
}

impl ColourMap {
    /// The colour at `t` in 0..=1; outside, and where `t` is not a number, that of the nearer end (NaN: of 0).
    pub fn at(self, t: f64) -> Rgb {
        match self {
            Self::Sequential => between(&SEQUENTIAL, t),
            Self::Diverging => between(&DIVERGING, t),
        }
    }
}

fn between(points: &[Lab], t: f64) -> Rgb {
    let last = points.len().saturating_sub(1);
    let along = if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) * last as f64 };
    let index = (along.floor() as usize).min(last.saturating_sub(1));
    match points.get(index..) {
        Some([from, to, ..]) => {
            let share = along - index as f64;
            srgb([0, 1, 2].map(|k| from[k] + share * (to[k] - from[k])))
        }
        _ => Rgb::WHITE,
    }
}

/// Oklab to sRGB, cut to its range.
fn srgb([l, a, b]: Lab) -> Rgb {
    let cone = |a_share: f64, b_share: f64| (l + a_share * a + b_share * b).powi(3);
    let long = cone(0.396_337_777_4, 0.215_803_757_3);
    let medium = cone(-0.105_561_345_8, -0.063_854_172_8);
    let short = cone(-0.089_484_177_5, -1.291_485_548_0);
    let levels = [
        4.076_741_662_1 * long - 3.307_711_591_3 * medium + 0.230_969_929_2 * short,
        -1.268_438_004_6 * long + 2.609_757_401_1 * medium - 0.341_319_396_5 * short,
        -0.004_196_086_3 * long - 0.703_418_614_7 * medium + 1.707_614_701_0 * short,
    ];
    Rgb { levels: levels.map(|level| (companded(level) * 255.0).round().clamp(0.0, 255.0) as u8) }
}

fn companded(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

fn linear(companded: f64) -> f64 {
    if companded <= 0.040_45 { companded / 12.92 } else { ((companded + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// CIE 1976 lightness, 0..=100: another formula than Oklab's.
    fn lightness(colour: Rgb) -> f64 {
        116.0 * colour.luminance().cbrt() - 16.0
    }

    fn distance(from: Lab, to: Lab) -> f64 {
        (0..3).map(|k| (from[k] - to[k]).powi(2)).sum::<f64>().sqrt()
    }

    #[test]
    fn oklab_gives_the_known_colours() {
        assert_eq!(srgb([1.0, 0.0, 0.0]), Rgb::WHITE);
        assert_eq!(srgb([0.0, 0.0, 0.0]), Rgb::new(0, 0, 0));
        assert_eq!(srgb([0.627_955, 0.224_863, 0.125_846]), Rgb::new(255, 0, 0));
        assert_eq!(srgb([0.452_014, -0.032_457, -0.311_528]), Rgb::new(0, 0, 255));
    }

    #[test]
    fn the_maps_step_evenly() {
        for points in [&SEQUENTIAL[..], &DIVERGING[..]] {
            let steps: Vec<f64> = points.windows(2).map(|pair| distance(pair[0], pair[1])).collect();
            let mean = steps.iter().sum::<f64>() / steps.len() as f64;
            assert!(steps.iter().all(|step| (step / mean - 1.0).abs() < 0.05), "{steps:?}");
        }
    }

    #[test]
    fn lightness_falls_all_along() {
        let along = |map: ColourMap, from: f64, to: f64| -> Vec<f64> {
            (0..=50).map(|k| lightness(map.at(from + (to - from) * f64::from(k) / 50.0))).collect()
        };
        for light in [
            along(ColourMap::Sequential, 0.0, 1.0),
            along(ColourMap::Diverging, 0.5, 1.0),
            along(ColourMap::Diverging, 0.5, 0.0),
        ] {
            assert!(light.windows(2).all(|pair| pair[1] < pair[0]), "{light:?}");
            assert!(light[0] - light[50] > 55.0, "{light:?}");
        }
    }

    #[test]
    fn both_signs_are_equally_dark() {
        for k in 0..=10 {
            let t = f64::from(k) / 20.0;
            let [minus, plus] = [0.5 - t, 0.5 + t].map(|t| lightness(ColourMap::Diverging.at(t)));
            assert!((minus - plus).abs() < 5.0, "{minus} and {plus} at {t}");
        }
    }

    #[test]
    fn outside_the_ends_count() {
        for map in [ColourMap::Sequential, ColourMap::Diverging] {
            assert_eq!(map.at(-3.0), map.at(0.0));
            assert_eq!(map.at(f64::INFINITY), map.at(1.0));
            assert_eq!(map.at(f64::NAN), map.at(0.0));
        }
        assert_eq!(Rgb::of_series(7), Rgb::of_series(0));
    }
}
