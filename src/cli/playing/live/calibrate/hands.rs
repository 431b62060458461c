//! The virtual pad's hands, which do what the guide asks.

use std::sync::mpsc::Sender;

use crate::cli::failure::Failure;
use crate::cli::files::device::PadOptions;
use crate::cli::playing::live::guided_pad::{self, Touch};
use tactpad::bridge::opening::OpenedPad;
use tactpad::lab::play::guide::GuideStep;
use tactpad::pad::marks::MARKS_MM;
use tactpad::virtual_pad::freehand::Calibrator;

/// Seed of the hands' movements.
const SEED: u64 = 1;

/// The hands.
pub(super) struct Hands {
    calibrator: Calibrator,
    to: Sender<Touch>,
}

/// The virtual pad, which nothing touches yet, and the hands.
pub(super) fn open(pad: &PadOptions) -> Result<(OpenedPad, Hands), Failure> {
    let (opened, to) = guided_pad::open(pad)?;
    Ok((opened, Hands { calibrator: Calibrator::new(SEED), to }))
}

impl Hands {
    /// Does what a step asks for; called when it begins.
    pub(super) fn obey(&mut self, step: &GuideStep, weight_g: Option<f64>) {
        let touch = match step {
            GuideStep::Rest { .. } | GuideStep::Done => Touch::Finger(Calibrator::rest()),
            GuideStep::Press { .. } => Touch::Finger(self.calibrator.press()),
            GuideStep::Put { mark, .. } => {
                Touch::Weight(self.calibrator.lay(MARKS_MM[*mark], weight_g.unwrap_or_default()))
            }
            GuideStep::TakeAway { .. } => Touch::Weight(self.calibrator.take_away()),
        };
        // A pad that is gone feels nothing.
        let _ = self.to.send(touch);
    }
}
