//! The statics decoder: forces and moments of three modules, and one contact that balances them.
//!
//! Each module reports a force along its three axes. Their sum is the contact's force, and their moment about
//! the pad's centre tells where a force of that size must act. There is nothing to train: five numbers
//! describe the pad.
//!
//! Source: A. Bicchi, J. K. Salisbury and D. L. Brock, "Contact sensing from force measurements",
//! International Journal of Robotics Research 12(3), 1993: the contact on a known surface (here a plane) from
//! force and moment.

use std::f32::consts::TAU;
use std::fmt;

use serde::Deserialize;

use crate::quantity::{Contact, MODULES, Strain};

/// A normal force closer to zero than this has no place: it is the pad's force resolution (Wu et al., Sensors
/// 2026, 26(4), 1378).
pub const FORCE_RESOLUTION_N: f32 = 0.005;

/// The nominal pad's numbers as their file has them.
pub const NOMINAL: &str = include_str!("../../../../../models/statics.toml");

/// The decoder's numbers, as they stand in `models/statics.toml`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StaticsModel {
    /// Version of the file's form: 1.
    pub schema: u32,
    /// Signal of a module's x channel per newton along `x_local` (tangential), in µV/N.
    pub tangential_uv_per_n: f32,
    /// Signal of a module's y channel per newton along `y_local` (radial), in µV/N.
    pub radial_uv_per_n: f32,
    /// Signal of a module's z channel per newton pressing down, in µV/N.
    pub normal_uv_per_n: f32,
    /// Height of the contact above the plane in which the posts carry shear, in mm.
    pub contact_height_mm: f32,
    /// Shear that a normal load pretends, per N·mm of its moment about the centre.
    pub false_shear_per_mm: f32,
    /// Distance of the modules from the centre, in mm.
    pub module_radius_mm: f32,
    /// Radius of the plate, in mm. No contact is farther out.
    pub plate_radius_mm: f32,
}

/// Why a statics model cannot be used; the text is one sentence.
#[derive(Debug, PartialEq, Eq)]
pub struct ModelError {
    message: String,
}

impl fmt::Display for ModelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "statics model: {}", self.message)
    }
}

impl std::error::Error for ModelError {}

/// From strain to a contact by the balance of forces and moments.
#[derive(Clone, Debug)]
pub struct Statics {
    model: StaticsModel,
    /// Outward unit vector (cos, sin) of each module.
    outward: [(f32, f32); MODULES],
}

/// Wrench that the three modules carry together, N and N mm, before the correction of false shear.
#[derive(Clone, Copy, Default)]
struct RawWrench {
    fx_n: f32,
    fy_n: f32,
    fz_n: f32,
    /// Σ x·Fz and Σ y·Fz over the modules.
    overturning_x_nmm: f32,
    overturning_y_nmm: f32,
}

impl StaticsModel {
    /// Reads the form of `models/statics.toml`.
    ///
    /// # Errors
    /// The text is not TOML, a key is missing or unknown; the message names the line.
    pub fn from_toml(text: &str) -> Result<Self, ModelError> {
        toml::from_str(text).map_err(|error| {
            let before = error.span().and_then(|span| text.get(..span.start)).unwrap_or_default();
            let line = before.matches('\n').count() + 1;
            ModelError { message: format!("line {line}: {}", error.message()) }
        })
    }

    fn check(&self) -> Result<(), ModelError> {
        let sensitivities = [self.tangential_uv_per_n, self.radial_uv_per_n, self.normal_uv_per_n];
        let problem = if self.schema != 1 {
            "schema must be 1; this program reads no other"
        } else if !sensitivities.iter().all(|uv_per_n| uv_per_n.is_normal()) {
            "the three sensitivities must be numbers other than zero"
        } else if !(self.module_radius_mm.is_normal() && self.plate_radius_mm.is_normal()) {
            "the two radii must be numbers other than zero"
        } else if !(self.plate_radius_mm > 0.0 && self.module_radius_mm > 0.0) {
            "the two radii must be positive"
        } else if !(self.contact_height_mm.is_finite() && (0.0..1.0).contains(&self.shear_feedback())) {
            "contact_height_mm times false_shear_per_mm must be at least 0 and less than 1"
        } else {
            return Ok(());
        };
        Err(ModelError { message: problem.to_owned() })
    }

    /// The part of a shear that comes back as false shear through the moment of its height.
    fn shear_feedback(&self) -> f32 {
        self.false_shear_per_mm * self.contact_height_mm
    }
}

impl Statics {
    /// The decoder of the nominal pad.
    #[expect(clippy::expect_used, reason = "the file is part of the program and a test reads it")]
    pub fn nominal() -> Self {
        let model = StaticsModel::from_toml(NOMINAL).expect("models/statics.toml is complete");
        Self::new(model).expect("models/statics.toml passes its checks")
    }

    /// A decoder for modules at 0°, 120° and 240°.
    ///
    /// # Errors
    /// A number with which no contact can be computed.
    pub fn new(model: StaticsModel) -> Result<Self, ModelError> {
        model.check()?;
        let outward = std::array::from_fn(|module| {
            let (sin, cos) = libm::sincosf(module as f32 * TAU / MODULES as f32);
            (cos, sin)
        });
        Ok(Self { model, outward })
    }

    /// The numbers it works with.
    pub fn model(&self) -> &StaticsModel {
        &self.model
    }

    /// The contact whose force and moment balance what the modules report.
    ///
    /// With the overturning moments `p` of the modules, contact height `h` and false shear `k`:
    /// `F = (F_raw − k·p) / (1 − k·h)` for both shears, then `x·Fz = p_x − h·Fx` and the same for y.
    ///
    /// Degenerate input: a normal force within ±[`FORCE_RESOLUTION_N`] has no place and reads as the centre;
    /// a place beyond the plate is moved to its rim along the ray; a pull (`fz_n < 0`) has a place like a
    /// push. Strain that is not finite, or so large that the result would not be, reads as no contact (all
    /// zero).
    pub fn decode(&self, strain: &Strain) -> Contact {
        let raw = self.raw_wrench(strain);
        let StaticsModel { contact_height_mm: height_mm, false_shear_per_mm: share, .. } = self.model;
        let kept = 1.0 - self.model.shear_feedback();
        let fx_n = (raw.fx_n - share * raw.overturning_x_nmm) / kept;
        let fy_n = (raw.fy_n - share * raw.overturning_y_nmm) / kept;
        let moment_x_nmm = raw.overturning_x_nmm - height_mm * fx_n;
        let moment_y_nmm = raw.overturning_y_nmm - height_mm * fy_n;
        let (x_mm, y_mm) = self.place(moment_x_nmm, moment_y_nmm, raw.fz_n);
        let all = [x_mm, y_mm, fx_n, fy_n, raw.fz_n, moment_x_nmm, moment_y_nmm];
        if all.iter().all(|value| value.is_finite()) {
            Contact { x_mm, y_mm, fx_n, fy_n, fz_n: raw.fz_n }
        } else {
            Contact::default()
        }
    }

    /// Sums the modules' forces in the pad frame. The local triad is left-handed, so its vectors are written
    /// out: `x_local` = (−sin, cos), `y_local` = (cos, sin).
    fn raw_wrench(&self, strain: &Strain) -> RawWrench {
        let model = &self.model;
        let mut sum = RawWrench::default();
        for ([x_uv, y_uv, z_uv], (cos, sin)) in strain.uv.as_chunks::<3>().0.iter().zip(self.outward) {
            let tangential_n = x_uv / model.tangential_uv_per_n;
            let radial_n = y_uv / model.radial_uv_per_n;
            let normal_n = z_uv / model.normal_uv_per_n;
            sum.fx_n += radial_n * cos - tangential_n * sin;
            sum.fy_n += radial_n * sin + tangential_n * cos;
            sum.fz_n += normal_n;
            sum.overturning_x_nmm += model.module_radius_mm * cos * normal_n;
            sum.overturning_y_nmm += model.module_radius_mm * sin * normal_n;
        }
        sum
    }

    fn place(&self, moment_x_nmm: f32, moment_y_nmm: f32, fz_n: f32) -> (f32, f32) {
        if fz_n.abs() < FORCE_RESOLUTION_N {
            return (0.0, 0.0);
        }
        let (x_mm, y_mm) = (moment_x_nmm / fz_n, moment_y_nmm / fz_n);
        let radius_mm = libm::hypotf(x_mm, y_mm);
        if radius_mm > self.model.plate_radius_mm {
            let inward = self.model.plate_radius_mm / radius_mm;
            (x_mm * inward, y_mm * inward)
        } else {
            (x_mm, y_mm)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::CHANNELS;

    fn only(channel: usize, uv: f32) -> Strain {
        let mut strain = Strain::default();
        strain.uv[channel] = uv;
        strain
    }

    fn near(a: f32, b: f32) -> bool {
        (a - b).abs() < 1e-3
    }

    #[test]
    fn each_module_pulls_along_its_own_axes() {
        let mut model = *Statics::nominal().model();
        model.false_shear_per_mm = 0.0;
        let statics = Statics::new(model).unwrap();
        let half_root3 = 0.75_f32.sqrt();
        // (tangential, radial) unit vectors of the modules at 0°, 120°, 240°, from the frame's definition.
        let axes = [
            ((0.0, 1.0), (1.0, 0.0)),
            ((-half_root3, -0.5), (-0.5, half_root3)),
            ((half_root3, -0.5), (-0.5, -half_root3)),
        ];
        for (module, (tangential, radial)) in axes.into_iter().enumerate() {
            let pushed = statics.decode(&only(3 * module, 2.0 * model.tangential_uv_per_n));
            assert!(
                near(pushed.fx_n, 2.0 * tangential.0) && near(pushed.fy_n, 2.0 * tangential.1),
                "{pushed:?}"
            );
            let pushed = statics.decode(&only(3 * module + 1, 2.0 * model.radial_uv_per_n));
            assert!(near(pushed.fx_n, 2.0 * radial.0) && near(pushed.fy_n, 2.0 * radial.1), "{pushed:?}");
            let pressed = statics.decode(&only(3 * module + 2, 2.0 * model.normal_uv_per_n));
            assert!(near(pressed.fz_n, 2.0), "{pressed:?}");
            assert!(
                near(pressed.x_mm, 20.0 * radial.0) && near(pressed.y_mm, 20.0 * radial.1),
                "{pressed:?}"
            );
        }
    }

    #[test]
    fn shear_does_not_move_the_place() {
        let statics = Statics::nominal();
        let model = statics.model();
        let share = 1.0 / 3.0;
        // 2 N pressed at the centre and 1 N along +y at the contact height: a moment h·Fy on the modules.
        let (fz, moment) = (2.0, model.contact_height_mm);
        let mut strain = Strain::default();
        for (module, (cos, sin)) in statics.outward.into_iter().enumerate() {
            strain.uv[3 * module] = model.tangential_uv_per_n * cos * share;
            strain.uv[3 * module + 1] = model.radial_uv_per_n * sin * share;
            let normal = share * (fz + 2.0 * moment * sin / model.module_radius_mm);
            strain.uv[3 * module + 2] = model.normal_uv_per_n * normal;
        }
        let seen = statics.decode(&strain);
        // cos² + sin² of three equal shares: the modules carry the whole newton.
        assert!(near(seen.fz_n, 2.0) && near(seen.fx_n, 0.0) && near(seen.fy_n, 1.0), "{seen:?}");
        assert!(near(seen.x_mm, 0.0) && near(seen.y_mm, 0.0), "{seen:?}");
    }

    #[test]
    fn a_force_below_the_resolution_has_no_place() {
        let statics = Statics::nominal();
        let uv = |fz_n: f32| fz_n * statics.model().normal_uv_per_n;
        let below = statics.decode(&only(2, uv(0.0049)));
        assert!(below.x_mm == 0.0 && below.y_mm == 0.0 && near(below.fz_n, 0.0049));
        let above = statics.decode(&only(2, uv(0.0051)));
        let push = statics.decode(&only(2, uv(1.0)));
        assert!(push.x_mm > 19.0 && near(above.x_mm, push.x_mm), "{above:?} {push:?}");
        let pull = statics.decode(&only(2, uv(-1.0)));
        assert!(near(pull.x_mm, push.x_mm) && near(pull.fz_n, -1.0), "{pull:?}");
        assert_eq!(statics.decode(&Strain::default()), Contact::default());
    }

    #[test]
    fn a_place_beyond_the_plate_moves_to_the_rim() {
        let statics = Statics::nominal();
        let mut strain = only(2, 4.0 * statics.model().normal_uv_per_n);
        strain.uv[5] = -1.5 * statics.model().normal_uv_per_n;
        strain.uv[8] = -1.5 * statics.model().normal_uv_per_n;
        let seen = statics.decode(&strain);
        assert!(near(seen.x_mm, 30.0) && near(seen.y_mm, 0.0), "{seen:?}");
    }

    #[test]
    fn strain_that_is_not_finite_is_no_contact() {
        let statics = Statics::nominal();
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for channel in 0..CHANNELS {
                assert_eq!(statics.decode(&only(channel, bad)), Contact::default());
            }
        }
        for huge in [f32::MAX, f32::MIN] {
            let seen = statics.decode(&Strain { uv: [huge; CHANNELS] });
            assert!([seen.x_mm, seen.y_mm, seen.fx_n, seen.fy_n, seen.fz_n].iter().all(|v| v.is_finite()));
        }
    }

    #[test]
    fn a_model_that_cannot_work_is_refused() {
        let nominal = *Statics::nominal().model();
        let refused = |model: StaticsModel| Statics::new(model).unwrap_err().to_string();
        assert!(refused(StaticsModel { schema: 2, ..nominal }).contains("schema"));
        assert!(refused(StaticsModel { normal_uv_per_n: 0.0, ..nominal }).contains("sensitivities"));
        assert!(refused(StaticsModel { radial_uv_per_n: f32::NAN, ..nominal }).contains("sensitivities"));
        assert!(refused(StaticsModel { plate_radius_mm: -30.0, ..nominal }).contains("positive"));
        assert!(refused(StaticsModel { contact_height_mm: 40.0, ..nominal }).contains("less than 1"));
        let missing = NOMINAL.replace("contact_height_mm", "contact_heigth_mm");
        let message = StaticsModel::from_toml(&missing).unwrap_err().to_string();
        let line = 1 + missing.lines().position(|line| line.starts_with("contact_heigth")).unwrap();
        assert!(
            message.contains("contact_heigth_mm") && message.contains(&format!("line {line}:")),
            "{message}"
        );
    }
}
