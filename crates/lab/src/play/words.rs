//! Texts of each step of a calibration at home.

use std::mem::discriminant;

use crate::play::guide::{GuideStep, LoadOnPad, PRESSED_S};
use tactpad_core::pad::marks::{MARK_NAMES, MARKS_MM};
use tactpad_core::quantity::WEIGHT_N_PER_G;

/// What is said where no weight is given.
pub const WITHOUT_WEIGHT: &str = "the force's scale stays unknown: presses alone never tell it";

/// Something else is read of what lies there if its force changed by this share, or its place by so many millimetres.
const NEWS_SHARE: f64 = 0.1;
const NEWS_MM: f64 = 2.0;

/// Which mark it is about.
pub const fn mark_of(step: &GuideStep) -> Option<usize> {
    match step {
        GuideStep::Put { mark, .. } | GuideStep::TakeAway { mark } => Some(*mark),
        _ => None,
    }
}

/// Whether it is another step, not the same one farther on.
pub fn is_other(one: &GuideStep, other: &GuideStep) -> bool {
    discriminant(one) != discriminant(other) || mark_of(one) != mark_of(other)
}

/// Whether something else is to be done or mended, not the same with slightly other numbers.
pub fn is_news(before: &GuideStep, now: &GuideStep) -> bool {
    if is_other(before, now) {
        return true;
    }
    match (before, now) {
        (GuideStep::Put { lying: before, .. }, GuideStep::Put { lying: now, .. }) => {
            lies_otherwise(before, now)
        }
        _ => false,
    }
}

fn lies_otherwise(before: &LoadOnPad, now: &LoadOnPad) -> bool {
    match (before, now) {
        (LoadOnPad::OtherForce { force_n: before_n }, LoadOnPad::OtherForce { force_n: now_n }) => {
            (before_n - now_n).abs() > NEWS_SHARE * before_n.abs()
        }
        (LoadOnPad::Beside { place_mm: before_mm }, LoadOnPad::Beside { place_mm: now_mm }) => {
            (before_mm[0] - now_mm[0]).hypot(before_mm[1] - now_mm[1]) > NEWS_MM
        }
        (before, now) => discriminant(before) != discriminant(now),
    }
}

/// What to do.
pub fn instruction(step: &GuideStep, weight_g: Option<f64>) -> String {
    let (weight_g, marks) = (weight_g.unwrap_or_default(), MARKS_MM.len());
    match step {
        GuideStep::Rest { .. } => "leave the pad alone for a second".into(),
        GuideStep::Press { of_s, .. } => {
            let presses = if *of_s > PRESSED_S { "press some more" } else { "press again and again" };
            format!("{presses}, anywhere, lightly and hard; lift between")
        }
        GuideStep::Put { mark, .. } => {
            format!("put the weight of {weight_g} g on mark {} of {marks} ({})", mark + 1, MARK_NAMES[*mark])
        }
        GuideStep::TakeAway { mark } => format!("take the weight away from mark {}", mark + 1),
        GuideStep::Done => "nothing is left to do".into(),
    }
}

/// How far it is, in words.
pub fn progress(step: &GuideStep) -> String {
    match step {
        GuideStep::Press { pressed_s, of_s, next, missing } => {
            let parts = match missing {
                0 => format!("pressed least: {next}"),
                1 => format!("not yet: {next}"),
                _ => format!("not yet: {next}, and {} more", missing - 1),
            };
            format!("{pressed_s:.0} of {of_s:.0} s; {parts}")
        }
        GuideStep::Put { lying: LoadOnPad::Still { .. }, .. } => "it lies still".into(),
        GuideStep::Put { lying: LoadOnPad::Moving, .. } => "it is being put down".into(),
        GuideStep::Put { lying: LoadOnPad::Nothing, .. } => "nothing lies on the pad".into(),
        GuideStep::Rest { .. } | GuideStep::Put { .. } | GuideStep::TakeAway { .. } | GuideStep::Done => {
            String::new()
        }
    }
}

/// What is wrong with what lies on the pad.
pub fn wrong(step: &GuideStep, weight_g: Option<f64>) -> Option<String> {
    let GuideStep::Put { mark, lying } = step else { return None };
    let number = mark + 1;
    match lying {
        LoadOnPad::OtherForce { force_n } => {
            let about_g = force_n / WEIGHT_N_PER_G;
            Some(format!(
                "it presses like {about_g:.0} g, not {:.0} g: put the weight alone on the mark",
                weight_g.unwrap_or_default()
            ))
        }
        LoadOnPad::Beside { place_mm: [x_mm, y_mm] } => Some(format!(
            "it lies near ({x_mm:.0}, {y_mm:.0}) mm, far from mark {number} at ({}, {}) mm: move it",
            MARKS_MM[*mark][0], MARKS_MM[*mark][1]
        )),
        LoadOnPad::TakenTooEarly => {
            Some(format!("it was taken away too early: put it on mark {number} once more"))
        }
        LoadOnPad::Nothing | LoadOnPad::Moving | LoadOnPad::Still { .. } => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn put(lying: LoadOnPad) -> GuideStep {
        GuideStep::Put { mark: 1, lying }
    }

    #[test]
    fn each_step_says_what_to_do_and_what_is_wrong() {
        let weight_g = Some(200.0);
        assert_eq!(
            instruction(&put(LoadOnPad::Nothing), weight_g),
            "put the weight of 200 g on mark 2 of 5 (right)"
        );
        assert_eq!(wrong(&put(LoadOnPad::Nothing), weight_g), None);
        let other = wrong(&put(LoadOnPad::OtherForce { force_n: 0.980_665 }), weight_g).unwrap_or_default();
        assert!(other.contains("like 100 g, not 200 g"), "{other}");
        let beside = wrong(&put(LoadOnPad::Beside { place_mm: [-14.6, 0.2] }), weight_g).unwrap_or_default();
        assert!(beside.contains("(-15, 0) mm, far from mark 2 at (15, 0) mm"), "{beside}");
        let press = GuideStep::Press { pressed_s: 30.0, of_s: 60.0, next: "the left rim", missing: 3 };
        assert_eq!(progress(&press), "30 of 60 s; not yet: the left rim, and 2 more");
    }

    #[test]
    fn numbers_that_tremble_are_no_news() {
        let force = |force_n| put(LoadOnPad::OtherForce { force_n });
        assert!(!is_news(&force(1.0), &force(1.05)) && is_news(&force(1.0), &force(1.2)));
        let beside = |x_mm| put(LoadOnPad::Beside { place_mm: [x_mm, 3.0] });
        assert!(!is_news(&beside(8.0), &beside(9.0)) && is_news(&beside(8.0), &beside(11.0)));
        assert!(is_news(&force(1.0), &beside(8.0)) && is_news(&force(1.0), &put(LoadOnPad::Nothing)));
        let still = |still_s| put(LoadOnPad::Still { still_s });
        assert!(!is_news(&still(0.5), &still(1.0)) && is_news(&still(1.0), &GuideStep::TakeAway { mark: 1 }));
    }
}
