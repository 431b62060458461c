//! The measuring rig: where the stage really puts a contact, and what the reference writes down.

use super::errors::turned;
use tactpad_core::pad::device::behaviour::Rig;
use tactpad_core::tables::measured::Label;
use tactpad_numeric::random::SplitMix64;

/// A stage with a force sensor under, or above, the pad.
#[derive(Clone, Debug)]
pub(super) struct LoadingStage {
    rig: Rig,
    approaches: SplitMix64,
    reference: SplitMix64,
    /// By how much the pad is turned on it.
    turned_deg: f64,
    /// A known weight lies on the pad: nothing presses or reads that could be wrong.
    is_weight: bool,
    /// This approach's own error of place and relative error of force.
    place_mm: [f64; 2],
    force_share: f64,
}

impl LoadingStage {
    pub(super) fn new(rig: Rig, seed: u64) -> Self {
        let approaches = SplitMix64::named(seed, "approach");
        let reference = SplitMix64::named(seed, "sensor");
        Self {
            rig,
            approaches,
            reference,
            turned_deg: 0.0,
            is_weight: false,
            place_mm: [0.0; 2],
            force_share: 0.0,
        }
    }

    /// The pad is clamped so, counter-clockwise, and a known weight is put down or the stage presses.
    pub(super) const fn set_up(&mut self, turned_deg: f64, is_weight: bool) {
        (self.turned_deg, self.is_weight) = (turned_deg, is_weight);
    }

    /// Comes to a contact anew.
    pub(super) fn approach(&mut self) {
        self.place_mm = [0; 2].map(|_| self.rig.stage_scatter_mm * f64::from(self.approaches.normal()));
        self.force_share = self.rig.force_scatter_share * f64::from(self.approaches.normal());
    }

    /// The contact that is, where this one is meant.
    pub(super) fn truth(&self, meant: &Label) -> Label {
        let Rig { stage_x_mm, stage_y_mm, stage_rotation_deg, stage_scale, .. } = self.rig;
        // Place, in the stage's frame: offset + scale R(turn) meant + scatter. Force: (1 + scatter) meant.
        let force = if self.is_weight { 1.0 } else { 1.0 + self.force_share };
        let [x_mm, y_mm] = turned(turned([meant.x_mm, meant.y_mm], self.turned_deg), stage_rotation_deg)
            .map(|mm| stage_scale * mm);
        let on_stage = [stage_x_mm + x_mm + self.place_mm[0], stage_y_mm + y_mm + self.place_mm[1]];
        let [x_mm, y_mm] = turned(on_stage, -self.turned_deg);
        Label { x_mm, y_mm, fx_n: force * meant.fx_n, fy_n: force * meant.fy_n, fz_n: force * meant.fz_n }
    }

    /// The label of a contact: the place that was meant, the force as the reference reads it.
    pub(super) fn written(&mut self, meant: &Label, truth: &Label) -> Label {
        if self.is_weight {
            return *meant;
        }
        // Reading, in the stage's frame: gain R F + zero + noise.
        let [fx_n, fy_n] = turned([truth.fx_n, truth.fy_n], self.turned_deg);
        let [fx_n, fy_n, fz_n] = self.tilted([fx_n, fy_n, truth.fz_n]);
        let [x, y, z] = self.rig.reference_zero_n;
        let mut read = |force_n: f64, zero_n: f64| {
            let noise_n = self.rig.reference_noise_n * f64::from(self.reference.normal());
            self.rig.reference_gain * force_n + zero_n + noise_n
        };
        let [fx_n, fy_n, fz_n] = [read(fx_n, x), read(fy_n, y), read(fz_n, z)];
        let [fx_n, fy_n] = turned([fx_n, fy_n], -self.turned_deg);
        Label { x_mm: meant.x_mm, y_mm: meant.y_mm, fx_n, fy_n, fz_n }
    }

    /// The force turned about x, then about y; right-handed in the pad's frame, where Fz presses along −z.
    fn tilted(&self, [fx_n, fy_n, fz_n]: [f64; 3]) -> [f64; 3] {
        let [about_x, about_y] =
            [self.rig.reference_tilt_x_deg, self.rig.reference_tilt_y_deg].map(f64::to_radians);
        // With the pad's z up and Fz down: about x (Fy, −Fz) ← (c Fy − s (−Fz), s Fy + c (−Fz)), about y (Fx, −Fz) ← (c Fx +
        // s (−Fz), c (−Fz) − s Fx).
        let (sin, cos) = (libm::sin(about_x), libm::cos(about_x));
        let (fy_n, fz_n) = (cos * fy_n + sin * fz_n, cos * fz_n - sin * fy_n);
        let (sin, cos) = (libm::sin(about_y), libm::cos(about_y));
        [cos * fx_n - sin * fz_n, fy_n, cos * fz_n + sin * fx_n]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_core::pad::device::behaviour::Behaviour;

    const MEANT: Label = Label { x_mm: 10.0, y_mm: 0.0, fx_n: 0.0, fy_n: 0.0, fz_n: 2.0 };

    fn stage(change: impl Fn(&mut Rig)) -> LoadingStage {
        let mut rig = Behaviour::IDEAL.rig;
        change(&mut rig);
        LoadingStage::new(rig, 1)
    }

    fn near(left: [f64; 5], right: [f64; 5]) {
        assert!(left.iter().zip(right).all(|(one, other)| (one - other).abs() < 1e-12), "{left:?} {right:?}");
    }

    const fn numbers(label: &Label) -> [f64; 5] {
        [label.x_mm, label.y_mm, label.fx_n, label.fy_n, label.fz_n]
    }

    #[test]
    fn a_rig_without_faults_writes_the_truth() {
        let mut stage = stage(|_| ());
        stage.approach();
        let truth = stage.truth(&MEANT);
        assert_eq!(truth, MEANT);
        assert_eq!(stage.written(&MEANT, &truth), MEANT);
    }

    #[test]
    fn the_stage_scales_turns_and_shifts() {
        let stage = stage(|rig| {
            (rig.stage_x_mm, rig.stage_y_mm) = (0.5, -0.25);
            (rig.stage_rotation_deg, rig.stage_scale) = (90.0, 1.1);
        });
        near(numbers(&stage.truth(&MEANT)), [0.5, 11.0 - 0.25, 0.0, 0.0, 2.0]);
    }

    #[test]
    fn a_tilted_reference_sees_pressing_as_shear() {
        let truth = MEANT;
        let angle = 2.0_f64.to_radians();
        // About x, right-handed: a force along −z turns towards +y. About y: towards −x.
        let about_x = stage(|rig| rig.reference_tilt_x_deg = 2.0).written(&MEANT, &truth);
        near(numbers(&about_x), [10.0, 0.0, 0.0, 2.0 * angle.sin(), 2.0 * angle.cos()]);
        let about_y = stage(|rig| rig.reference_tilt_y_deg = 2.0).written(&MEANT, &truth);
        near(numbers(&about_y), [10.0, 0.0, -2.0 * angle.sin(), 0.0, 2.0 * angle.cos()]);
    }

    #[test]
    fn a_known_weight_is_written_as_it_is_by_whatever_reference() {
        let mut stage = stage(|rig| {
            (rig.reference_gain, rig.reference_tilt_x_deg, rig.force_scatter_share) = (1.05, 2.0, 0.1);
            (rig.stage_x_mm, rig.reference_zero_n) = (0.5, [0.1; 3]);
        });
        stage.set_up(0.0, true);
        stage.approach();
        let truth = stage.truth(&MEANT);
        assert_eq!(truth, Label { x_mm: 10.5, ..MEANT });
        assert_eq!(stage.written(&MEANT, &truth), MEANT);
    }

    #[test]
    fn gain_and_zero_are_the_references() {
        let mut stage = stage(|rig| (rig.reference_gain, rig.reference_zero_n) = (1.05, [0.1, -0.2, 0.3]));
        near(numbers(&stage.written(&MEANT, &MEANT)), [10.0, 0.0, 0.1, -0.2, 2.4]);
    }

    #[test]
    fn approaches_and_readings_scatter_by_as_much_as_is_said() {
        let mut stage = stage(|rig| {
            (rig.stage_scatter_mm, rig.force_scatter_share, rig.reference_noise_n) = (0.2, 0.05, 0.01);
        });
        let mut squares = [0.0; 4];
        for _ in 0..20_000 {
            stage.approach();
            let truth = stage.truth(&MEANT);
            let written = stage.written(&MEANT, &truth);
            let off = [truth.x_mm - 10.0, truth.y_mm, truth.fz_n / 2.0 - 1.0, written.fz_n - truth.fz_n];
            squares.iter_mut().zip(off).for_each(|(square, off)| *square += off * off / 2e4);
        }
        for (square, wanted) in squares.into_iter().zip([0.2, 0.2, 0.05, 0.01_f64]) {
            assert!((square.sqrt() / wanted - 1.0).abs() < 0.03, "{} {wanted}", square.sqrt());
        }
    }
}
