//! What came for each thing that was meant.

use super::labels::Labels;
use super::trace::Trace;
use super::vocabulary::in_order;
use crate::pipeline::control::{Code, OutputEvent};
use crate::pipeline::mapping::profile::{Binding, Profile};

/// What comes up to so much after a label's end, beside the delay that is allowed, is still its own: a tap comes when the press ends.
pub const AFTER_US: u64 = 100_000;

/// What came for one label.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Came {
    /// What that class means, once each, and nothing else.
    Class(usize),
    /// What was meant, but something of it more than once, and nothing else.
    Repeated,
    /// Anything else.
    Other,
}

/// What came for each label.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Score {
    came: Vec<Came>,
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
                    pressed.push(binding)
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
        let is_correct = |(came, class): &(&Came, usize)| **came == Came::Class(*class);
        let correct =
            came.iter().zip(labels.labels().iter().map(|label| label.class)).filter(is_correct).count();
        Self { came, correct, strays }
    }

    /// What came, label by label.
    pub fn came(&self) -> &[Came] {
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

/// What came down with an event, if it did.
pub(super) fn down(event: &OutputEvent) -> Option<Binding> {
    let OutputEvent { device, code, value, .. } = *event;
    let is_down = value != 0 && !matches!(code, Code::Relative(_));
    is_down.then_some(Binding { device, code, value })
}

fn classified(labels: &Labels, meant: usize, pressed: Vec<Binding>) -> Came {
    let count = pressed.len();
    let pressed = in_order(pressed);
    let class = labels.classes().iter().position(|class| class.controls == pressed);
    match class {
        Some(class) if pressed.len() == count => Came::Class(class),
        Some(class) if class == meant => Came::Repeated,
        _ => Came::Other,
    }
}
