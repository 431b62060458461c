//! Presses anywhere on the plate, as of somebody who tries the pad out.

use super::course::{FORCE_MAX_N, GestureHistory, Move};
use super::draw::{Draw, at, microseconds, towards, within};
use crate::virtual_pad::script::Script;

/// Median of the force, deviation of its logarithm, and the lightest press.
const FORCE_N: f32 = 1.5;
const FORCE_SPREAD: f32 = 0.5;
const FORCE_MIN_N: f32 = 0.4;
/// Shear is at most this share of the normal force,
const SHEAR_SHARE_MAX: f32 = 0.3;
/// and mostly goes the way that the hand drags, give or take so much.
const DRAG_SPREAD_DEG: f32 = 30.0;
/// From the touch to the lift.
const LASTS_MS: [f32; 2] = [150.0, 800.0];
/// The part of that in which the force comes, or goes.
const RAMP_SHARE: [f32; 2] = [0.15, 0.3];
/// So many of the presses slide, so far.
const SLIDE_SHARE: f32 = 0.2;
const SLIDE_MM: [f32; 2] = [3.0, 15.0];
const PAUSE_MS: [f32; 2] = [150.0, 600.0];

/// Presses over a disc around the centre, evenly, for `duration_us`; the seed draws them.
pub fn presses(duration_us: u64, within_mm: f32, seed: u64) -> Script {
    let mut draw = Draw::new(seed, "presses");
    let mut course = GestureHistory::new(duration_us);
    let drag_deg = draw.between([0.0, 360.0]);
    loop {
        let (moves, lift_us) = press(&mut draw, drag_deg, within_mm);
        if !course.touch(draw.us(PAUSE_MS), &moves, lift_us) {
            return course.script();
        }
    }
}

/// One press, and how long its lift takes.
fn press(draw: &mut Draw, drag_deg: f32, within_mm: f32) -> (Vec<Move>, u64) {
    let place = draw.in_disc(within_mm);
    let fz_n = draw.log_normal(FORCE_N, FORCE_SPREAD).clamp(FORCE_MIN_N, FORCE_MAX_N);
    let shear_n = fz_n * draw.between([0.0, SHEAR_SHARE_MAX]);
    let shear = towards(drag_deg + draw.normal(DRAG_SPREAD_DEG)).map(|part| shear_n * part);
    let lasts_ms = draw.between(LASTS_MS);
    let [ramp_us, lift_us] = [0; 2].map(|_| microseconds(lasts_ms * draw.between(RAMP_SHARE)));
    let stay_us = microseconds(lasts_ms) - ramp_us - lift_us;
    let to = at(place, shear, fz_n);
    if !draw.chance(SLIDE_SHARE) {
        return (vec![Move { to, ramp_us, stay_us }], lift_us);
    }
    let [cos, sin] = towards(draw.between([0.0, 360.0]));
    let way_mm = draw.between(SLIDE_MM);
    let end = within([place[0] + way_mm * cos, place[1] + way_mm * sin], within_mm);
    let slide = Move { to: at(end, shear, fz_n), ramp_us: stay_us / 2, stay_us: stay_us / 4 };
    (vec![Move { to, ramp_us, stay_us: stay_us - slide.ramp_us - slide.stay_us }, slide], lift_us)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_cover_the_disc_and_keep_to_their_ranges() {
        let script = presses(600_000_000, 20.0, 3);
        let contacts: Vec<_> =
            script.keyframes().iter().map(|it| it.contact).filter(|it| it.fz_n > 0.0).collect();
        assert!(contacts.len() > 900, "{}", contacts.len());
        for it in &contacts {
            assert!(libm::hypotf(it.x_mm, it.y_mm) <= 20.001, "{it:?}");
            assert!((0.4..=5.0).contains(&it.fz_n), "{it:?}");
            assert!(libm::hypotf(it.fx_n, it.fy_n) <= 0.301 * it.fz_n, "{it:?}");
        }
        // Half of a disc's area lies within 1/√2 of its radius.
        let inner = contacts.iter().filter(|it| libm::hypotf(it.x_mm, it.y_mm) < 14.14).count();
        let share = inner as f32 / contacts.len() as f32;
        assert!((share - 0.5).abs() < 0.08, "{share}");
        assert!(script.keyframes()[0].at_us >= 1_000_000);
        assert!(script.keyframes().last().unwrap().at_us <= 599_500_000);
    }
}
