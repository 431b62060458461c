//! What the virtual pad sends, as a capture: without a port, and without waiting.

use std::io::{self, Write};

use crate::pipeline::call::Call;
use crate::pipeline::capture::writer::CaptureWriter;
use crate::quantity::Contact;
use crate::time::HostInstant;
use crate::virtual_pad::firmware::VirtualPad;
use crate::virtual_pad::freehand::{Placement, Weights};

/// What was recorded.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recorded {
    /// Readings of the channels.
    pub samples: u64,
    /// Touches and placements that began.
    pub touches: u64,
}

/// Writes one call per sample, at the sample's own time, until `end_us` of pad time, and hands on each sample's time and true
/// contact.
///
/// # Errors
/// The capture, or `see`, does not take it.
pub fn record<W: Write>(
    pad: &mut VirtualPad,
    end_us: u64,
    capture: &mut CaptureWriter<W>,
    mut see: impl FnMut(u64, &Contact) -> io::Result<()>,
) -> io::Result<Recorded> {
    let (mut recorded, mut bytes, mut is_touched) = (Recorded::default(), Vec::new(), false);
    while pad.due_us() < end_us {
        let now_us = pad.due_us();
        bytes.clear();
        pad.emit(now_us, &mut bytes);
        capture.write(HostInstant::default().plus_us(now_us), Call::Bytes(&bytes))?;
        see(now_us, pad.contact())?;
        let was_touched = std::mem::replace(&mut is_touched, pad.contact().fz_n > 0.0);
        recorded.samples += 1;
        recorded.touches += u64::from(is_touched && !was_touched);
    }
    Ok(recorded)
}

/// The same of weights that are laid on the pad from the next sample on; placements are told in pad time.
///
/// # Errors
/// As with [`record`].
pub fn record_weights<W: Write>(
    pad: &mut VirtualPad,
    weights: &Weights,
    capture: &mut CaptureWriter<W>,
    see: impl FnMut(u64, &Contact) -> io::Result<()>,
) -> io::Result<(Recorded, Vec<Placement>)> {
    let begin_us = pad.lay(weights.script.clone());
    let recorded = record(pad, begin_us + weights.duration_us, capture, see)?;
    let in_pad_time = |it: &Placement| Placement { at_us: begin_us + it.at_us, ..*it };
    Ok((recorded, weights.placements.iter().map(in_pad_time).collect()))
}
