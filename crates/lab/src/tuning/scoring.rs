//! Outcomes of a profile for each label.

use super::labels::Labels;
use super::trace::Trace;
use super::vocabulary::in_order;
use tactpad_core::pipeline::control::{Code, OutputEvent};
use tactpad_core::pipeline::mapping::profile::{Binding, Profile};

/// What comes up to so much after a label's end, beside the delay that is allowed, is still its own: a tap comes when the press ends.
pub const AFTER_US: u64 = 100_000;

/// Outcome for one label.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LabelOutcome {
    /// What that class means, once each, and nothing else.
    Class(usize),
    /// What was meant, but something of it more than once, and nothing else.
    Repeated,
    /// Anything else.
    Other,
}

/// Outcomes, label by label.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Score {
    came: Vec<LabelOutcome>,
    correct: usize,
    strays: usize,
}

impl Score {
    /// Plays the trace with a profile. An event belongs to the last label that has begun, up to `after_us` after that label's end.
    pub fn of(profile: &Profile, trace: &Trace, labels: &Labels, after_us: u64) -> Self {
        let mut pressed: Vec<Vec<Binding>> = vec![Vec::new(); labels.labels().len()];
        let mut strays = 0;
        let mut at = 0;
        trace.play(profile, |event| {
            let Some(binding) = down(event) else { return };
            let now_us = event.at.as_us();
            while labels.labels().get(at).is_some_and(|label| label.begin_us <= now_us) {
                at += 1;
            }
            let begun =
                at.checked_sub(1).and_then(|last| Some((labels.labels().get(last)?, pressed.get_mut(last)?)));
            match begun {
                Some((label, pressed)) if now_us <= label.end_us.saturating_add(after_us) => {
                    pressed.push(binding);
                }
                _ => strays += 1,
            }
        });
        let came: Vec<_> = labels
            .labels()
            .iter()
            .zip(pressed)
            .map(|(label, pressed)| classified(labels, label.class, pressed))
            .collect();
        let is_correct = |(came, class): &(&LabelOutcome, usize)| **came == LabelOutcome::Class(*class);
        let correct =
            came.iter().zip(labels.labels().iter().map(|label| label.class)).filter(is_correct).count();
        Self { came, correct, strays }
    }

    /// Outcomes, label by label.
    pub fn came(&self) -> &[LabelOutcome] {
        &self.came
    }

    /// For how many labels exactly what was meant came down, once, and nothing else; for `none`: nothing.
    pub const fn correct(&self) -> usize {
        self.correct
    }

    /// How many controls came down where no label was.
    pub const fn strays(&self) -> usize {
        self.strays
    }

    /// The share of labels that are correct.
    pub fn share(&self) -> f64 {
        self.correct as f64 / self.came.len().max(1) as f64
    }
}

/// Control that went down with an event, if one did.
pub(super) fn down(event: &OutputEvent) -> Option<Binding> {
    let OutputEvent { device, code, value, .. } = *event;
    let is_down = value != 0 && !matches!(code, Code::Relative(_));
    is_down.then_some(Binding { device, code, value })
}

fn classified(labels: &Labels, meant: usize, pressed: Vec<Binding>) -> LabelOutcome {
    let count = pressed.len();
    let pressed = in_order(pressed);
    let class = labels.classes().iter().position(|class| class.controls == pressed);
    match class {
        Some(class) if pressed.len() == count => LabelOutcome::Class(class),
        Some(class) if class == meant => LabelOutcome::Repeated,
        _ => LabelOutcome::Other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tuning::confusion::Confusion;
    use crate::tuning::trace::{TraceEvents, TracePoint};
    use tactpad_core::pipeline::mapping::read::check::{OutputChoice, read};
    use tactpad_core::pipeline::mapping::read::shipped;
    use tactpad_core::quantity::Contact;
    use tactpad_core::time::StreamInstant;

    /// Presses with a place, a force and a begin and end in milliseconds.
    fn trace(presses: &[([f32; 2], f32, u64, u64)]) -> Trace {
        let moment = |ms: u64| {
            let press = presses.iter().find(|(_, _, from, to)| (*from..*to).contains(&ms));
            let contact = |&([x_mm, y_mm], fz_n, ..): &([f32; 2], f32, u64, u64)| Contact {
                x_mm,
                y_mm,
                fz_n,
                ..Contact::default()
            };
            let heard = press.map_or(TraceEvents::Nothing, |press| TraceEvents::Contact(contact(press)));
            TracePoint { at: StreamInstant::from_us(1_000 * ms), heard }
        };
        Trace::new((0..4_000).map(moment).collect())
    }

    fn scored(presses: &[([f32; 2], f32, u64, u64)], table: &str) -> (Vec<LabelOutcome>, usize, String) {
        let profile = read(shipped::text("super-mario").unwrap(), OutputChoice::AsWritten).0.unwrap();
        let labels = Labels::read(&format!("begin_s,end_s,meant\n{table}"), &profile).unwrap();
        let score = Score::of(&profile, &trace(presses), &labels, 100_000);
        (score.came().to_vec(), score.strays(), Confusion::of(&labels, &score).to_string())
    }

    const MIDDLE: [f32; 2] = [0.0, 0.0];
    const RIGHT: [f32; 2] = [15.0, 0.0];

    #[test]
    fn exactly_what_was_meant_counts() {
        let presses = [(RIGHT, 1.0, 1_000, 1_200), (MIDDLE, 1.0, 1_500, 1_600), (RIGHT, 3.0, 2_000, 2_200)];
        let table = "0.9,1.3,right\n1.4,1.7,none\n1.9,2.3,right\n2.5,2.6,none\n3,3.5,BTN_SOUTH\n";
        let (came, strays, shown) = scored(&presses, table);
        let [right, none] = [1, 2].map(LabelOutcome::Class);
        assert_eq!(came, [right, none, LabelOutcome::Other, none, none]);
        assert_eq!(strays, 0);
        let wanted = "\
meant      BTN_SOUTH  right  none  something else
BTN_SOUTH          ·      ·     1               ·
right              ·      1     ·               1
none               ·      ·     2               ·";
        assert_eq!(shown, wanted);
    }

    #[test]
    fn once_is_once() {
        let presses = [(MIDDLE, 3.0, 1_000, 1_100), (MIDDLE, 3.0, 1_300, 1_400)];
        assert_eq!(scored(&presses, "0.9,1.6,BTN_SOUTH\n").0, [LabelOutcome::Repeated]);
        assert_eq!(scored(&presses, "0.9,1.2,BTN_SOUTH\n1.2,1.6,BTN_SOUTH\n").0, [LabelOutcome::Class(0); 2]);
    }

    #[test]
    fn a_tap_after_the_label_is_its_own_for_a_while() {
        // It comes when the force is gone: at 1.1 s.
        let presses = [(MIDDLE, 3.0, 1_000, 1_100)];
        assert_eq!(scored(&presses, "0.9,1,BTN_SOUTH\n").0, [LabelOutcome::Class(0)]);
        let (came, strays, _) = scored(&presses, "0.9,0.999,BTN_SOUTH\n");
        assert_eq!((came, strays), (vec![LabelOutcome::Class(1)], 1));
        assert_eq!(
            scored(&presses, "0.9,1.05,none\n1.08,1.2,BTN_SOUTH\n").0,
            [LabelOutcome::Class(1), LabelOutcome::Class(0)]
        );
    }
}
