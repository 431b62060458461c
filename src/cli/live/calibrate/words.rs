//! What people are told in each step.

use tactpad::lab::play::guide::{Lying, PRESSED_S, REST_S, STILL_S, Step};
use tactpad::pad::marks::{MARK_NAMES, MARKS_MM};
use tactpad::quantity::WEIGHT_N_PER_G;

/// Cells of a bar.
const CELLS: usize = 12;

/// What is said where no weight is given.
pub(super) const WITHOUT_WEIGHT: &str = "without --weight-g GRAMS no weight is asked for, and the force's scale stays unknown: presses alone never tell it";

/// Which mark it is about.
pub(super) const fn mark_of(step: &Step) -> Option<usize> {
    match step {
        Step::Put { mark, .. } | Step::TakeAway { mark } => Some(*mark),
        _ => None,
    }
}

/// What to do.
pub(super) fn instruction(step: &Step, weight_g: Option<f64>) -> String {
    let steps = if weight_g.is_some() { 3 } else { 2 };
    let (weight_g, marks) = (weight_g.unwrap_or_default(), MARKS_MM.len());
    match step {
        Step::Rest { .. } => format!("step 1 of {steps}: leave the pad alone for a second"),
        Step::Press { of_s, .. } => {
            let presses = if *of_s > PRESSED_S { "press some more" } else { "press again and again" };
            format!("step 2 of {steps}: {presses}, anywhere, lightly and hard; lift between")
        }
        Step::Put { mark, .. } => {
            format!(
                "step 3 of 3: put the weight of {weight_g} g on mark {} of {marks} ({})",
                mark + 1,
                MARK_NAMES[*mark]
            )
        }
        Step::TakeAway { mark } => format!("step 3 of 3: take the weight away from mark {}", mark + 1),
        Step::Done => "nothing is left to do".into(),
    }
}

/// How far it is.
pub(super) fn progress(step: &Step) -> String {
    match step {
        Step::Rest { rested_s } => bar(rested_s / REST_S),
        Step::Press { pressed_s, of_s, next, missing } => {
            let parts = match missing {
                0 => format!("pressed least: {next}"),
                1 => format!("not yet: {next}"),
                _ => format!("not yet: {next}, and {} more", missing - 1),
            };
            format!("{} {pressed_s:.0} of {of_s:.0} s; {parts}", bar(pressed_s / of_s))
        }
        Step::Put { lying: Lying::Still { still_s }, .. } => {
            format!("{} it lies still", bar(still_s / STILL_S))
        }
        Step::Put { lying: Lying::Moving, .. } => "it is being put down".into(),
        Step::Put { lying: Lying::Nothing, .. } => "nothing lies on the pad".into(),
        Step::Put { .. } | Step::TakeAway { .. } | Step::Done => String::new(),
    }
}

/// What is wrong with what lies on the pad.
pub(super) fn wrong(step: &Step, weight_g: Option<f64>) -> Option<String> {
    let Step::Put { mark, lying } = step else { return None };
    let number = mark + 1;
    match lying {
        Lying::OtherForce { force_n } => {
            let about_g = force_n / WEIGHT_N_PER_G;
            Some(format!(
                "it presses like {about_g:.0} g, not {:.0} g: put the weight alone on the mark",
                weight_g.unwrap_or_default()
            ))
        }
        Lying::Beside { place_mm: [x_mm, y_mm] } => Some(format!(
            "it lies near ({x_mm:.0}, {y_mm:.0}) mm, far from mark {number} at ({}, {}) mm: move it",
            MARKS_MM[*mark][0], MARKS_MM[*mark][1]
        )),
        Lying::TakenTooEarly => {
            Some(format!("it was taken away too early: put it on mark {number} once more"))
        }
        Lying::Nothing | Lying::Moving | Lying::Still { .. } => None,
    }
}

fn bar(share: f64) -> String {
    let cells = (share * CELLS as f64).clamp(0.0, CELLS as f64) as usize;
    format!("[{}{}]", "#".repeat(cells), "-".repeat(CELLS - cells))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_step_says_what_to_do_and_what_is_wrong() {
        let put = |lying| Step::Put { mark: 1, lying };
        let weight_g = Some(200.0);
        assert_eq!(
            instruction(&put(Lying::Nothing), weight_g),
            "step 3 of 3: put the weight of 200 g on mark 2 of 5 (right)"
        );
        assert_eq!(wrong(&put(Lying::Nothing), weight_g), None);
        let other = wrong(&put(Lying::OtherForce { force_n: 0.980_665 }), weight_g).unwrap_or_default();
        assert!(other.contains("like 100 g, not 200 g"), "{other}");
        let beside = wrong(&put(Lying::Beside { place_mm: [-14.6, 0.2] }), weight_g).unwrap_or_default();
        assert!(beside.contains("(-15, 0) mm, far from mark 2 at (15, 0) mm"), "{beside}");
        let press = Step::Press { pressed_s: 30.0, of_s: 60.0, next: "the left rim", missing: 3 };
        assert_eq!(progress(&press), "[######------] 30 of 60 s; not yet: the left rim, and 2 more");
    }

    #[test]
    fn lines_fit_an_ordinary_terminal() {
        let press =
            Step::Press { pressed_s: 89.0, of_s: 90.0, next: "half way to the upper right", missing: 13 };
        let put = |lying| Step::Put { mark: 4, lying };
        let steps = [
            press,
            put(Lying::Still { still_s: 1.9 }),
            put(Lying::OtherForce { force_n: 4.9 }),
            put(Lying::Beside { place_mm: [-15.0, -15.0] }),
            put(Lying::TakenTooEarly),
            Step::TakeAway { mark: 4 },
        ];
        for step in steps {
            let weight_g = Some(1000.0);
            let lines =
                [instruction(&step, weight_g), progress(&step), wrong(&step, weight_g).unwrap_or_default()];
            assert!(lines.iter().all(|line| line.chars().count() < 80), "{lines:#?}");
        }
    }
}
