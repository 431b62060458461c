//! The systematic errors of a measuring rig: what turns a written label into the contact that was.
//!
//! ```text
//! place = d + c R(φ) written        force = R(tilt)⁻¹ (written − zero)/gain
//! ```
//!
//! That is so in the stage's frame. Labels are in the pad's, which may be turned on the stage: they are turned to the stage's
//! frame, and the contact is turned back.

use tactpad_core::pad::device::behaviour::Rig;

/// The errors of a rig; angles are counter-clockwise and right-handed in the pad's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigErrors {
    /// True minus written place.
    pub offset_mm: [f64; 2],
    /// From written to true place, counter-clockwise.
    pub rotation_deg: f64,
    /// True over written distance from the axis.
    pub scale: f64,
    /// Turn of the reference about x and y, from true to written force.
    pub tilt_deg: [f64; 2],
    /// Written over true force.
    pub gain: f64,
    /// Written minus true force.
    pub zero_n: [f64; 3],
    /// By how much all that is late.
    pub lag_s: f64,
    /// By how much the pad is turned on the stage, counter-clockwise. That is no error.
    pub turned_deg: f64,
}

impl RigErrors {
    /// A rig that writes the truth.
    pub const NONE: Self = Self {
        offset_mm: [0.0; 2],
        rotation_deg: 0.0,
        scale: 1.0,
        tilt_deg: [0.0; 2],
        gain: 1.0,
        zero_n: [0.0; 3],
        lag_s: 0.0,
        turned_deg: 0.0,
    };

    /// Those of a device file.
    pub const fn of(rig: &Rig) -> Self {
        Self {
            offset_mm: [rig.stage_x_mm, rig.stage_y_mm],
            rotation_deg: rig.stage_rotation_deg,
            scale: rig.stage_scale,
            tilt_deg: [rig.reference_tilt_x_deg, rig.reference_tilt_y_deg],
            gain: rig.reference_gain,
            zero_n: rig.reference_zero_n,
            lag_s: 1e-3 * rig.label_lag_ms,
            turned_deg: 0.0,
        }
    }

    /// The true place.
    pub fn place_mm(&self, written_mm: [f64; 2]) -> [f64; 2] {
        let [x_mm, y_mm] = turned(turned(written_mm, self.turned_deg), self.rotation_deg);
        let [dx_mm, dy_mm] = self.offset_mm;
        turned([dx_mm + self.scale * x_mm, dy_mm + self.scale * y_mm], -self.turned_deg)
    }

    /// The true force.
    pub fn force_n(&self, written_n: [f64; 3]) -> [f64; 3] {
        let [fx, fy, fz] = written_n;
        let [fx, fy] = turned([fx, fy], self.turned_deg);
        let mut force_n = [fx, fy, fz];
        force_n.iter_mut().zip(self.zero_n).for_each(|(n, zero_n)| *n = (*n - zero_n) / self.gain);
        // Written = R_y R_x true, with the pad's z up and Fz down; so the true one is turned back about y, then about x.
        let [fx, fy, fz] = force_n;
        let (sin, cos) = (libm::sin(self.tilt_deg[1].to_radians()), libm::cos(self.tilt_deg[1].to_radians()));
        let (fx, fz) = (cos * fx + sin * fz, cos * fz - sin * fx);
        let (sin, cos) = (libm::sin(self.tilt_deg[0].to_radians()), libm::cos(self.tilt_deg[0].to_radians()));
        let [fx, fy, fz] = [fx, cos * fy - sin * fz, cos * fz + sin * fy];
        let [fx, fy] = turned([fx, fy], -self.turned_deg);
        [fx, fy, fz]
    }

    /// The same rig with the pad turned on the stage. A known weight has no reference that could be wrong.
    #[must_use]
    pub const fn of_row(self, turned_deg: f64, is_weight: bool) -> Self {
        if is_weight {
            let Self { tilt_deg, gain, zero_n, .. } = Self::NONE;
            return Self { turned_deg, tilt_deg, gain, zero_n, ..self };
        }
        Self { turned_deg, ..self }
    }
}

/// A vector turned counter-clockwise.
pub(super) fn turned([x, y]: [f64; 2], deg: f64) -> [f64; 2] {
    let (sin, cos) = (libm::sin(deg.to_radians()), libm::cos(deg.to_radians()));
    [cos * x - sin * y, sin * x + cos * y]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rig::stage::LoadingStage;
    use tactpad_core::pad::device::behaviour::Behaviour;
    use tactpad_core::tables::measured::Label;

    #[test]
    fn they_undo_what_the_twins_rig_does() {
        let rig = Rig {
            stage_x_mm: 0.5,
            stage_y_mm: -0.3,
            stage_rotation_deg: 2.0,
            stage_scale: 1.02,
            reference_tilt_x_deg: 3.0,
            reference_tilt_y_deg: -2.0,
            reference_gain: 1.05,
            reference_zero_n: [0.1, -0.2, 0.3],
            ..Behaviour::IDEAL.rig
        };
        let meant = Label { x_mm: 10.0, y_mm: -4.0, fx_n: 0.5, fy_n: 0.2, fz_n: 2.0 };
        let mut stage = LoadingStage::new(rig, 1);
        for turned_deg in [0.0, 120.0, -75.0] {
            stage.set_up(turned_deg, false);
            let truth = stage.truth(&meant);
            let written = stage.written(&meant, &truth);
            let errors = RigErrors::of(&rig).of_row(turned_deg, false);
            let place_mm = errors.place_mm([written.x_mm, written.y_mm]);
            let force_n = errors.force_n([written.fx_n, written.fy_n, written.fz_n]);
            let found = place_mm.into_iter().chain(force_n);
            found.zip(truth.numbers()).for_each(|(found, wanted)| assert!((found - wanted).abs() < 1e-12));
        }
    }

    #[test]
    fn an_offset_turns_back_with_the_pad() {
        let rig = RigErrors { offset_mm: [1.0, 0.0], ..RigErrors::NONE };
        // The pad stands a quarter turn counter-clockwise: the stage's +x is its −y.
        let [x_mm, y_mm] = rig.of_row(90.0, false).place_mm([3.0, 4.0]);
        assert!((x_mm - 3.0).abs() < 1e-12 && (y_mm - 3.0).abs() < 1e-12, "{x_mm} {y_mm}");
    }
}
