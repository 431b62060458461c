//! The instructions of each step, in lines of a terminal.

use tactpad::lab::play::guide::{GuideStep, LoadOnPad, REST_S, STILL_S};
use tactpad::lab::play::words;

/// Cells of a bar.
const CELLS: usize = 12;

/// The instruction, and the step that it belongs to.
pub(super) fn instruction(step: &GuideStep, weight_g: Option<f64>) -> String {
    let steps = if weight_g.is_some() { 3 } else { 2 };
    let what = words::instruction(step, weight_g);
    match step {
        GuideStep::Rest { .. } => format!("step 1 of {steps}: {what}"),
        GuideStep::Press { .. } => format!("step 2 of {steps}: {what}"),
        GuideStep::Put { .. } | GuideStep::TakeAway { .. } => format!("step 3 of 3: {what}"),
        GuideStep::Done => what,
    }
}

/// How far it is.
pub(super) fn progress(step: &GuideStep) -> String {
    let how_far = words::progress(step);
    match step {
        GuideStep::Rest { rested_s } => bar(rested_s / REST_S),
        GuideStep::Press { pressed_s, of_s, .. } => format!("{} {how_far}", bar(pressed_s / of_s)),
        GuideStep::Put { lying: LoadOnPad::Still { still_s }, .. } => {
            format!("{} {how_far}", bar(still_s / STILL_S))
        }
        GuideStep::Put { .. } | GuideStep::TakeAway { .. } | GuideStep::Done => how_far,
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
    fn each_step_has_its_number_and_its_bar() {
        let put = GuideStep::Put { mark: 1, lying: LoadOnPad::Nothing };
        assert_eq!(
            instruction(&put, Some(200.0)),
            "step 3 of 3: put the weight of 200 g on mark 2 of 5 (right)"
        );
        let press = GuideStep::Press { pressed_s: 30.0, of_s: 60.0, next: "the left rim", missing: 3 };
        assert_eq!(progress(&press), "[######------] 30 of 60 s; not yet: the left rim, and 2 more");
    }

    #[test]
    fn lines_fit_an_ordinary_terminal() {
        let press = GuideStep::Press {
            pressed_s: 89.0,
            of_s: 90.0,
            next: "half way to the upper right",
            missing: 13,
        };
        let put = |lying| GuideStep::Put { mark: 4, lying };
        let steps = [
            press,
            put(LoadOnPad::Still { still_s: 1.9 }),
            put(LoadOnPad::OtherForce { force_n: 4.9 }),
            put(LoadOnPad::Beside { place_mm: [-15.0, -15.0] }),
            put(LoadOnPad::TakenTooEarly),
            GuideStep::TakeAway { mark: 4 },
        ];
        for step in steps {
            let weight_g = Some(1000.0);
            let lines = [
                instruction(&step, weight_g),
                progress(&step),
                words::wrong(&step, weight_g).unwrap_or_default(),
            ];
            assert!(lines.iter().all(|line| line.chars().count() < 80), "{lines:#?}");
        }
    }
}
