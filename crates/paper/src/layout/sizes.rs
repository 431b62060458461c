//! How large and how thick a pad should be: the paper's open question, by the simulator.
//!
//! The modules keep their size and stand at the same share of the plate's radius; the contacts reach as near to the rim as
//! on the device (its patch keeps its size, too). Materials, gauges, bridges and noise stay.
//!
//! [`SizeStudy`] holds what each pad can do and the laws that hold for those whose plate is stiff beside its modules.

use std::f64::consts::TAU;

use serde::Serialize;

use super::precision::Precision;
use tactpad_core::pad::device::Device;
use tactpad_numeric::linear::Factor;

/// Diameters of the grid.
pub const DIAMETERS_MM: [f64; 8] = [30.0, 40.0, 50.0, 60.0, 80.0, 100.0, 120.0, 150.0];

/// Thicknesses of the grid.
pub const THICKNESSES_MM: [f64; 5] = [0.5, 1.0, 1.5, 2.0, 3.0];

/// Conversions per second of the wire's usual stream, beside which a pad's bandwidth is told.
pub const CONVERTER_HZ: f64 = 1_000.0;

/// A plate is stiff if it alone would bend at so many times the pad's first natural frequency or more. Two parts in series of
/// which one is twice as fast as the pad lower it by some eighth (S. Dunkerley's rule, 1894): 1 − √(1 − 1/2²) = 13 %.
pub const STIFF: f64 = 2.0;

/// ω a² √(ϱh/D) of a free round plate's slowest motion at ν = 0.33; with ν = 0.25 to 0.4 it moves by 3 %. Source: A. W. Leissa, Vibration
/// of Plates, NASA SP-160 (1969), table 2.5.
const FREE_PLATE: f64 = 5.253;

/// A plate's size.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Size {
    /// Its diameter.
    pub diameter_mm: f64,
    /// Its thickness.
    pub thickness_mm: f64,
}

impl Size {
    /// All of the grid: by diameter, then by thickness.
    pub fn all() -> impl Iterator<Item = Self> {
        DIAMETERS_MM.into_iter().flat_map(|diameter_mm| {
            THICKNESSES_MM.into_iter().map(move |thickness_mm| Self { diameter_mm, thickness_mm })
        })
    }

    /// The device with a plate of this size; nothing if it could not be built, by the rules for device files.
    pub fn on(self, device: &Device) -> Option<Device> {
        let mut sized = device.clone();
        let share = self.diameter_mm / device.plate.diameter_mm;
        let margin_mm = device.plate.radius_mm() - device.contact.max_centre_radius_mm;
        sized.name = format!("{}, {} x {} mm", device.name, self.diameter_mm, self.thickness_mm);
        (sized.plate.diameter_mm, sized.plate.thickness_mm) = (self.diameter_mm, self.thickness_mm);
        sized.sites.centre_radius_mm *= share;
        sized.contact.max_centre_radius_mm = sized.plate.radius_mm() - margin_mm;
        Device::from_toml(&sized.to_toml()).0
    }

    /// What its device file is called.
    pub fn file_name(self) -> String {
        format!("pad-{}x{}.toml", self.diameter_mm, self.thickness_mm)
    }

    /// Where a free plate of this size alone would ring first, of the device's plate's material, by Kirchhoff's theory: Hz.
    ///
    /// f = 5.253/(2π a²) √(D/(ϱh)), D = E h³/(12 (1−ν²)).
    pub fn plate_hz(self, device: &Device) -> f64 {
        let material = device.material.plate;
        let (radius_m, thickness_m) = (self.diameter_mm / 2e3, self.thickness_mm / 1e3);
        let rigidity =
            1e6 * material.e_mpa * thickness_m.powi(3) / (12.0 * (1.0 - material.nu * material.nu));
        let root = (rigidity / (material.density_kg_m3 * thickness_m)).sqrt();
        FREE_PLATE * root / (TAU * radius_m * radius_m)
    }
}

/// What a pad of some size can do.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SizedPad {
    /// Its plate.
    #[serde(flatten)]
    pub size: Size,
    /// Where its modules stand.
    pub centre_radius_mm: f64,
    /// Sum of the three z channels under a press of 1 N in the middle.
    pub sensitivity_uv_per_n: f64,
    /// How much the channels change per newton and millimetre when that press moves: √(Σ (∂s/∂x)²) over all nine.
    pub change_uv_per_n_mm: f64,
    /// The smallest error with which a press of 1 N can be located.
    pub precision: Precision,
    /// Its first natural frequency.
    pub first_hz: f64,
    /// What the plate does there.
    pub first_kind: &'static str,
    /// Where the plate alone, and free, would ring first.
    pub plate_hz: f64,
    /// Up to where it follows within ±3 dB.
    pub bandwidth_hz: f64,
    /// The same as a share of half of [`CONVERTER_HZ`]: above 1, the converter is the slower one.
    pub bandwidth_of_converters: f64,
    /// The press at the worst place by which a module's foot sinks by the height of its frame: farther down, the film would
    /// lie on the base.
    pub grounding_n: f64,
}

impl SizedPad {
    /// Whether its plate is [`STIFF`].
    pub fn is_stiff(&self) -> bool {
        self.plate_hz >= STIFF * self.first_hz
    }
}

/// A power law y = c (diameter/60 mm)ᵖ (thickness/1 mm)^q for pads whose plate is stiff, by least squares of ln y.
///
/// A rigid plate on three springs has p = q = 0 for the sensitivity, as springs share a press whatever the size; p = −1 and
/// q = 0 for its change by place, which is told by a lever of the radius; p = 1 and q = 0 for the error; and p = −1,
/// q = −½ for frequencies: k a²/(m a²) with m as diameter² thickness.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Law {
    /// What it gives.
    pub quantity: &'static str,
    /// In which unit.
    pub unit: &'static str,
    /// c: at 60 mm and 1 mm.
    pub factor: f64,
    /// p.
    pub diameter_power: f64,
    /// q.
    pub thickness_power: f64,
    /// Pads with a stiff plate, by which it was fitted.
    pub pads: usize,
    /// The farthest of these from it, in percent.
    pub residual_percent: f64,
    /// The farthest of all other pads from it, in percent: what it is worth outside its range.
    pub outside_percent: f64,
}

impl Law {
    /// Its value for a size.
    pub fn at(&self, size: Size) -> f64 {
        self.factor * shape(size, self.diameter_power, self.thickness_power)
    }

    fn fitted(
        (quantity, unit): (&'static str, &'static str),
        pads: &[SizedPad],
        value: fn(&SizedPad) -> f64,
    ) -> Option<Self> {
        let stiff: Vec<&SizedPad> = pads.iter().filter(|pad| pad.is_stiff()).collect();
        let (mut normal, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
        for pad in &stiff {
            let row = [1.0, (pad.size.diameter_mm / NOMINAL_MM).ln(), pad.size.thickness_mm.ln()];
            for i in 0..3 {
                right[i] += row[i] * value(pad).ln();
                (0..3).for_each(|j| normal[i][j] += row[i] * row[j]);
            }
        }
        let [log, diameter_power, thickness_power] = Factor::of(&normal)?.solve(&right);
        let mut law = Self {
            quantity,
            unit,
            factor: log.exp(),
            diameter_power,
            thickness_power,
            pads: stiff.len(),
            residual_percent: 0.0,
            outside_percent: 0.0,
        };
        let off = |pad: &SizedPad| 100.0 * (value(pad) / law.at(pad.size) - 1.0).abs();
        let worst = |is_stiff: bool| {
            pads.iter().filter(|pad| pad.is_stiff() == is_stiff).map(off).fold(0.0, f64::max)
        };
        (law.residual_percent, law.outside_percent) = (worst(true), worst(false));
        Some(law)
    }

    /// All of them.
    fn all(pads: &[SizedPad]) -> Vec<Self> {
        let laws = [
            Self::fitted(SENSITIVITY, pads, |pad| pad.sensitivity_uv_per_n),
            Self::fitted(CHANGE, pads, |pad| pad.change_uv_per_n_mm),
            Self::fitted(ERROR, pads, |pad| pad.precision.worst_mm),
            Self::fitted(FREQUENCY, pads, |pad| pad.first_hz),
        ];
        laws.into_iter().flatten().collect()
    }
}

/// What laws are about, with its unit.
const SENSITIVITY: (&str, &str) = ("sensitivity", "µV/N");
pub(super) const CHANGE: (&str, &str) = ("change by place", "µV/N/mm");
pub(super) const ERROR: (&str, &str) = ("worst error at 1 N", "mm");
pub(super) const FREQUENCY: (&str, &str) = ("first natural frequency", "Hz");

/// The diameter at which laws have their factor; the thickness is 1 mm.
const NOMINAL_MM: f64 = 60.0;

fn shape(size: Size, diameter_power: f64, thickness_power: f64) -> f64 {
    (size.diameter_mm / NOMINAL_MM).powf(diameter_power) * size.thickness_mm.powf(thickness_power)
}

/// Who presses, how large a plate that takes, and how hard.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct User {
    /// Who.
    pub name: &'static str,
    /// The plate that the part of the body rests on: a thumb rolls and slides on the smallest, the breadth of a hand is 85 mm, that of a
    /// foot 100 mm and more. Source: DIN 33402-2, medians of men.
    pub diameter_mm: f64,
    /// A firm press: chosen, for comparison with where a module grounds.
    pub press_n: f64,
}

/// Those that the study answers.
pub const USERS: [User; 3] = [
    User { name: "thumb", diameter_mm: 30.0, press_n: 10.0 },
    User { name: "hand", diameter_mm: 100.0, press_n: 50.0 },
    User { name: "foot", diameter_mm: 150.0, press_n: 400.0 },
];

/// The pad for a user.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RecommendedPad {
    /// Who.
    pub user: User,
    /// The thinnest plate of the user's diameter that is stiff, as thinner ones answer faster; the thickest where none is.
    pub pad: SizedPad,
    /// Whether it is stiff.
    pub stiff: bool,
    /// Whether the modules bear the press.
    pub bears: bool,
}

/// The study.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SizeStudy {
    /// Standard deviation of each channel.
    pub noise_uv: f64,
    /// Conversions per second.
    pub converter_hz: f64,
    /// By diameter, then by thickness. Sizes on which the device's modules find no room are left out.
    pub pads: Vec<SizedPad>,
    /// Laws of the stiff ones; none where no plate is stiff.
    pub laws: Vec<Law>,
    /// Which pad a thumb, a hand, a foot wants.
    pub answers: Vec<RecommendedPad>,
}

impl SizeStudy {
    /// What follows from the pads.
    pub fn of_pads(pads: Vec<SizedPad>, noise_uv: f64) -> Self {
        let laws = Law::all(&pads);
        let answers = USERS.iter().filter_map(|user| answer(user, &pads)).collect();
        Self { noise_uv, converter_hz: CONVERTER_HZ, pads, laws, answers }
    }
}

fn answer(user: &User, pads: &[SizedPad]) -> Option<RecommendedPad> {
    let large: Vec<&SizedPad> = pads.iter().filter(|pad| pad.size.diameter_mm == user.diameter_mm).collect();
    let pad = **large.iter().find(|pad| pad.is_stiff()).or(large.last())?;
    Some(RecommendedPad { user: *user, pad, stiff: pad.is_stiff(), bears: pad.grounding_n >= user.press_n })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pad that keeps the laws, with a share of their signals and errors.
    fn pad(size: Size, off: f64) -> SizedPad {
        let first_hz = 600.0 * shape(size, -1.0, -0.5);
        SizedPad {
            size,
            centre_radius_mm: size.diameter_mm / 3.0,
            sensitivity_uv_per_n: 1_900.0 * off,
            change_uv_per_n_mm: 55.0 * off * shape(size, -1.0, 0.0),
            precision: Precision {
                worst_mm: 0.2 * off * shape(size, 1.0, 0.0),
                worst_at_mm: [0.0; 2],
                rms_mm: 0.1,
                largest_uv: 2_000.0,
            },
            first_hz,
            first_kind: "tilts",
            plate_hz: size.plate_hz(&Device::nominal()),
            bandwidth_hz: 0.54 * first_hz,
            bandwidth_of_converters: 0.54 * first_hz / 500.0,
            grounding_n: 25.0,
        }
    }

    #[test]
    fn the_nominal_size_is_the_nominal_device() {
        let nominal = Device::nominal();
        let found = Size { diameter_mm: 60.0, thickness_mm: 1.0 }.on(&nominal).unwrap();
        assert_eq!(Device { name: nominal.name.clone(), ..found }, nominal);
    }

    #[test]
    fn every_size_of_the_grid_can_be_built() {
        let nominal = Device::nominal();
        for size in Size::all() {
            let device = size.on(&nominal).unwrap();
            assert_eq!(device.plate.diameter_mm, size.diameter_mm);
            assert!((device.sites.centre_radius_mm / device.plate.radius_mm() - 2.0 / 3.0).abs() < 1e-12);
            assert_eq!(device.contact.max_centre_radius_mm, device.plate.radius_mm() - 1.0);
        }
        assert_eq!(
            Size { diameter_mm: 20.0, thickness_mm: 1.0 }.on(&nominal),
            None,
            "the films would overlap"
        );
        assert_eq!(Size { diameter_mm: 60.0, thickness_mm: 0.5 }.file_name(), "pad-60x0.5.toml");
    }

    #[test]
    fn laws_are_found_where_they_hold_and_their_residual_is_told() {
        let exact = SizeStudy::of_pads(Size::all().map(|size| pad(size, 1.0)).collect(), 6.0);
        assert_eq!(exact.laws.len(), 4);
        for (law, factor) in exact.laws.iter().zip([1_900.0, 55.0, 0.2, 600.0]) {
            assert!((law.factor / factor - 1.0).abs() < 1e-9 && law.residual_percent < 1e-7, "{law:?}");
        }
        let stiff = |size: Size| pad(size, 1.0).is_stiff();
        let bent = Size::all().map(|size| pad(size, if stiff(size) { 1.0 } else { 0.5 }));
        let found = SizeStudy::of_pads(bent.collect(), 6.0);
        let [law, ..] = found.laws[..] else { panic!("no law") };
        assert!(law.residual_percent < 1e-7 && (law.outside_percent - 50.0).abs() < 1e-6, "{law:?}");
        assert_eq!(SizeStudy::of_pads(vec![], 6.0).laws, vec![]);
    }

    #[test]
    fn users_get_the_thinnest_stiff_plate() {
        let found = SizeStudy::of_pads(Size::all().map(|size| pad(size, 1.0)).collect(), 6.0);
        for answer in &found.answers {
            let thinner = found.pads.iter().filter(|pad| {
                pad.size.diameter_mm == answer.user.diameter_mm
                    && pad.size.thickness_mm < answer.pad.size.thickness_mm
            });
            assert!(thinner.into_iter().all(|pad| !pad.is_stiff()) && answer.stiff);
        }
        let bears: Vec<bool> = found.answers.iter().map(|answer| answer.bears).collect();
        assert_eq!(bears, [true, false, false]);
    }
}
