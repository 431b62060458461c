//! What is said at each step.

use tactpad::lab::bench::deed::{Deed, PlateAxis};
use tactpad::lab::bench::guide::{BenchStep, BenchTrouble, REST_S};
use tactpad::lab::bench::touch::{HOLD_S, Touch};

/// A weight has lain long enough.
const LAIN_S: f64 = 2.0;

/// Whether the weight may be taken away.
pub(super) fn is_time_to_take_away(step: &BenchStep) -> bool {
    matches!(step, BenchStep::Weigh { touch: Touch::Held { held_s } } if *held_s >= LAIN_S)
}

/// Whether a message of the bridge is of the cable, and not of channels that are judged here.
pub(super) fn is_of_line(line: &str) -> bool {
    let of_zero_and_channels = ["channel", "finger", "zero", "decoder", "playing", "paused"];
    of_zero_and_channels.iter().all(|word| !line.contains(word))
}

/// What to do, and what is wrong with what was done.
pub(super) fn lines(step: &BenchStep, weight_g: Option<f64>, trouble: Option<BenchTrouble>) -> Vec<String> {
    let mut lines = Vec::new();
    match trouble {
        Some(BenchTrouble::Supply) => lines.push(
            "the pad says that its excitation or its reference is wrong: measure both, as docs/build.md says"
                .into(),
        ),
        Some(BenchTrouble::OtherChannels) => {
            lines.push("the pad has another number of channels than nine: nothing is measured of it".into());
        }
        None => {}
    }
    match step {
        BenchStep::Rest { is_again: false, .. } => {
            lines.push(format!("leave the pad alone for {REST_S:.0} s"));
        }
        BenchStep::Rest { is_again: true, .. } => {
            lines.push(format!("something moved the pad: leave it, and the table, alone for {REST_S:.0} s"));
        }
        BenchStep::Weigh { touch } => {
            let weight_g = weight_g.unwrap_or_default();
            lines.push(format!("put the weight of {weight_g} g on the middle and let go of it"));
            if is_time_to_take_away(step) {
                lines.push("take it away".into());
            }
            lines.extend(too_short(touch));
        }
        BenchStep::Do { deed, touch, is_again } => {
            let again = if *is_again { "once more: " } else { "" };
            lines.push(format!("{again}{}", instruction(*deed)));
            lines.extend(too_short(touch));
        }
        BenchStep::Done => {}
    }
    lines
}

fn too_short(touch: &Touch) -> Option<String> {
    (*touch == Touch::TooShort).then(|| format!("that was too short: hold it for {HOLD_S} s or longer"))
}

fn instruction(deed: Deed) -> String {
    match deed {
        Deed::Press { module } => {
            let place = ["right", "upper left", "lower left"][module.min(2)];
            format!("press firmly above module {module} ({place}), straight down, for two seconds, and lift")
        }
        Deed::Push { axis: PlateAxis::X } => {
            "press in the middle and push to the right, as if to slide the plate, for two seconds, and lift"
                .into()
        }
        Deed::Push { axis: PlateAxis::Y } => {
            "press in the middle and push up, away from you, for two seconds, and lift".into()
        }
    }
}
