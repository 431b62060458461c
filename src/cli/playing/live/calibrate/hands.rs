//! The virtual pad's hands, which do what the guide asks.

use std::sync::mpsc::{Receiver, Sender, channel};

use crate::cli::failure::Failure;
use crate::cli::files::device::PadOptions;
use crate::cli::playing::live::playing::{not_opened, virtual_pad};
use tactpad::bridge::opening::OpenedPad;
use tactpad::bridge::transport::virtual_pad::PadFirmware;
use tactpad::lab::play::guide::GuideStep;
use tactpad::pad::marks::MARKS_MM;
use tactpad::virtual_pad::firmware::VirtualPad;
use tactpad::virtual_pad::freehand::Calibrator;
use tactpad::virtual_pad::script::Script;

/// Seed of the hands' movements.
const SEED: u64 = 1;

/// An object that touches the pad.
enum Touch {
    Finger(Script),
    /// It stays where it is put, as no finger does.
    Weight(Script),
}

/// The hands.
pub(super) struct Hands {
    calibrator: Calibrator,
    to: Sender<Touch>,
}

/// A pad on which they play what they are asked for.
struct GuidedPad {
    pad: VirtualPad,
    touches: Receiver<Touch>,
}

/// The virtual pad, which nothing touches yet, and the hands.
pub(super) fn open(pad: &PadOptions) -> Result<(OpenedPad, Hands), Failure> {
    let (to, touches) = channel();
    let pad = GuidedPad { pad: virtual_pad(pad, Calibrator::rest())?, touches };
    let opened = OpenedPad::simulated(pad).map_err(not_opened)?;
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

impl PadFirmware for GuidedPad {
    fn receive(&mut self, bytes: &[u8]) {
        self.pad.receive(bytes);
    }

    fn due_us(&self) -> u64 {
        self.pad.due_us()
    }

    fn emit(&mut self, now_us: u64, bytes: &mut Vec<u8>) {
        for touch in self.touches.try_iter() {
            match touch {
                Touch::Finger(script) => self.pad.play(script),
                Touch::Weight(script) => self.pad.lay(script),
            };
        }
        self.pad.emit(now_us, bytes);
    }
}
