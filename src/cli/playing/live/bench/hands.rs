//! The virtual pad's hands, which do what is asked.

use std::sync::mpsc::Sender;

use crate::cli::failure::Failure;
use crate::cli::files::device::PadOptions;
use crate::cli::playing::live::guided_pad::{self, Touch};
use tactpad::bridge::opening::OpenedPad;
use tactpad::lab::bench::deed::Deed;
use tactpad::lab::bench::guide::BenchStep;
use tactpad::pad::device::Device;
use tactpad::virtual_pad::freehand::Calibrator;

/// Seed of the hands' movements.
const SEED: u64 = 1;

/// The hands.
pub(super) struct Hands {
    calibrator: Calibrator,
    device: Device,
    to: Sender<Touch>,
}

/// The virtual pad, which nothing touches yet, and the hands.
pub(super) fn open(pad: &PadOptions) -> Result<(OpenedPad, Hands), Failure> {
    let (opened, to) = guided_pad::open(pad)?;
    Ok((opened, Hands { calibrator: Calibrator::new(SEED), device: pad.designed()?, to }))
}

impl Hands {
    /// Does what a step asks for; called when it begins.
    pub(super) fn obey(&mut self, step: &BenchStep, weight_g: Option<f64>) {
        let touch = match step {
            BenchStep::Rest { .. } | BenchStep::Done => Touch::Finger(Calibrator::rest()),
            BenchStep::Weigh { .. } => {
                Touch::Weight(self.calibrator.lay([0.0; 2], weight_g.unwrap_or_default()))
            }
            BenchStep::Do { deed, .. } => Touch::Finger(self.press(*deed)),
        };
        // A pad that is gone feels nothing.
        let _ = self.to.send(touch);
    }

    /// Takes the weight away.
    pub(super) fn take_away(&mut self) {
        let _ = self.to.send(Touch::Weight(self.calibrator.take_away()));
    }

    fn press(&mut self, deed: Deed) -> tactpad::virtual_pad::script::Script {
        let meant = deed.meant(&self.device);
        let place_mm = [meant.x_mm, meant.y_mm].map(f64::from);
        self.calibrator.press_at(place_mm, [meant.fx_n, meant.fy_n].map(f64::from))
    }
}
