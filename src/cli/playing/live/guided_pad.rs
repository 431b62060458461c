//! The virtual pad of a verb that leads somebody: what touches it is told while it goes on.

use std::sync::mpsc::{Receiver, Sender, channel};

use super::playing::{not_opened, virtual_pad};
use crate::cli::failure::Failure;
use crate::cli::files::device::PadOptions;
use tactpad::bridge::opening::OpenedPad;
use tactpad::bridge::transport::virtual_pad::PadFirmware;
use tactpad::virtual_pad::firmware::VirtualPad;
use tactpad::virtual_pad::freehand::Calibrator;
use tactpad::virtual_pad::script::Script;

/// An object that touches the pad.
pub(super) enum Touch {
    Finger(Script),
    /// It stays where it is put, as no finger does.
    Weight(Script),
}

/// A pad on which it is played what was told.
struct GuidedPad {
    pad: VirtualPad,
    touches: Receiver<Touch>,
}

/// The virtual pad, which nothing touches yet, and the way to tell it what does.
pub(super) fn open(pad: &PadOptions) -> Result<(OpenedPad, Sender<Touch>), Failure> {
    let (to, touches) = channel();
    let pad = GuidedPad { pad: virtual_pad(pad, Calibrator::rest())?, touches };
    let opened = OpenedPad::simulated(pad).map_err(not_opened)?;
    Ok((opened, to))
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
