//! The paper's Figure 11: six regions of the plate pressed one after the other, the force turning once round in each.
//!
//! The paper shows pictures; places, forces and times are ours.

use std::f64::consts::TAU;

use super::Subject;
use super::carried_out::ExecutedPlan;
use tactpad_core::pipeline::contact::Decoder;
use tactpad_core::quantity::Contact;
use tactpad_core::tables::measured::{Label, Row, Table, zero};
use tactpad_lab::evaluation;
use tactpad_lab::rig::measurement::RATE_HZ;

/// The regions in the paper's order, and their directions from the middle, counter-clockwise from +x.
pub const REGIONS: [(&str, f64); 6] = [
    ("right", 0.0),
    ("left", 180.0),
    ("bottom", 270.0),
    ("top", 90.0),
    ("top right", 45.0),
    ("bottom right", 315.0),
];

/// Time for which each is evaluated.
pub const TOUCH_S: f64 = 4.0;
/// Time in which the finger comes, and goes.
const RAMP_S: f64 = 0.5;
/// Time without a finger before and after.
const AWAY_S: f64 = 0.4;
/// Time in which shear grows outwards, and ends there; in between it turns.
const SHEAR_RAMP_S: f64 = 0.3;
/// Of the farthest place's distance from the middle.
const DISTANCE_SHARE: f64 = 0.7;
/// Of full scale.
const PRESS_SHARE: f64 = 0.6;
/// Of the press.
const SHEAR_SHARE: f64 = 0.35;

/// The six touches on the pad, and readings of the untouched pad before and after them.
#[derive(Clone, Debug)]
pub struct Touches {
    carried_out: ExecutedPlan,
}

/// A moment of the touches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchMoment {
    /// Since the first one.
    pub t_s: f64,
    /// The true contact.
    pub truth: Label,
    /// The decoded contact.
    pub found: Contact,
}

impl Touches {
    /// Presses the pad.
    pub fn of(subject: &Subject<'_>) -> Self {
        let patch = &subject.actual.device.contact;
        let plan = plan(patch.max_centre_radius_mm, patch.full_scale_n);
        Self { carried_out: ExecutedPlan::afterwards(subject, &plan, subject.seed) }
    }

    /// The decoded contacts, moment by moment.
    pub fn decoded(&self, decoder: &Decoder) -> Vec<TouchMoment> {
        let rows = self.carried_out.taken(decoder);
        let found = evaluation::decoded(decoder, &rows);
        let moments = rows.iter().zip(&self.carried_out.truths).zip(found);
        let moments = moments.filter(|((row, _), _)| row.trial.is_some()).enumerate();
        moments
            .map(|(index, ((_, truth), found))| TouchMoment {
                t_s: index as f64 / RATE_HZ,
                truth: *truth,
                found,
            })
            .collect()
    }
}

fn plan(reach_mm: f64, full_scale_n: f64) -> Table {
    let untouched = Row { session: Some(0), ..Row::of(Label::default()) };
    let count = (REGIONS.len() as f64 * TOUCH_S * RATE_HZ) as usize;
    let touched = (0..count).map(|index| {
        let t_s = index as f64 / RATE_HZ;
        Row { trial: Some(0), t_s: Some(t_s), ..Row::of(pressed(t_s, reach_mm, full_scale_n)) }
    });
    Table {
        rows: [untouched].into_iter().chain(touched).chain([untouched]).collect(),
        trials: vec!["regions".to_owned()],
        sessions: vec![zero::ZERO.to_owned()],
        ..Table::default()
    }
}

/// The contact that is meant at a time: the region's place, a press, and shear that turns from outwards once round.
fn pressed(t_s: f64, reach_mm: f64, full_scale_n: f64) -> Label {
    let region = ((t_s / TOUCH_S) as usize).min(REGIONS.len() - 1);
    let at_s = t_s - TOUCH_S * region as f64;
    let outwards = REGIONS[region].1.to_radians();
    let begins_s = AWAY_S + RAMP_S;
    let ends_s = TOUCH_S - begins_s;
    let fz_n = PRESS_SHARE * full_scale_n * plateau(at_s, [AWAY_S, TOUCH_S - AWAY_S], RAMP_S);
    let shear_n = SHEAR_SHARE * fz_n * plateau(at_s, [begins_s, ends_s], SHEAR_RAMP_S);
    let turns_s = [begins_s + SHEAR_RAMP_S, ends_s - SHEAR_RAMP_S];
    let turned = outwards + TAU * ((at_s - turns_s[0]) / (turns_s[1] - turns_s[0])).clamp(0.0, 1.0);
    let distance_mm = DISTANCE_SHARE * reach_mm;
    Label {
        x_mm: distance_mm * libm::cos(outwards),
        y_mm: distance_mm * libm::sin(outwards),
        fx_n: shear_n * libm::cos(turned),
        fy_n: shear_n * libm::sin(turned),
        fz_n,
    }
}

/// From 0 up to 1 and down again between two times.
fn plateau(at_s: f64, [from_s, to_s]: [f64; 2], ramp_s: f64) -> f64 {
    ((at_s - from_s).min(to_s - at_s) / ramp_s).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_region_is_pressed_in_its_turn_and_sheared_all_round() {
        let plan = plan(29.0, 5.0);
        let trial: Vec<&Row> = plan.rows.iter().filter(|row| row.trial.is_some()).collect();
        for (touch, (name, deg)) in trial.chunks(180).zip(REGIONS) {
            let held: Vec<&Label> = touch.iter().map(|row| &row.label).filter(|it| it.fz_n > 2.9).collect();
            assert!(held.len() > 90, "{name}");
            for label in &held {
                let found_deg = label.y_mm.atan2(label.x_mm).to_degrees().rem_euclid(360.0);
                assert!((found_deg - deg).abs() < 1e-9 || (found_deg - deg).abs() > 359.9, "{name}");
            }
            let most = |of: fn(&Label) -> f64| held.iter().map(|label| of(label)).fold(f64::MIN, f64::max);
            for of in
                [|it: &Label| it.fx_n, |it: &Label| -it.fx_n, |it: &Label| it.fy_n, |it: &Label| -it.fy_n]
            {
                assert!((1.0..1.06).contains(&most(of)), "{name}: {}", most(of));
            }
            assert_eq!((touch[0].label.fz_n, touch[179].label.fz_n), (0.0, 0.0));
        }
    }
}
