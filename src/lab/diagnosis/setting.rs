//! What a pad and a measurement offer: which causes can be asked for, and where.

use super::target::Target;
use crate::pad::device::Side;

/// A way in which the field may change, by the mechanics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Change {
    /// A number of the device's file.
    Number {
        /// Its name.
        name: &'static str,
        /// Its value in the pad that the field is of.
        own: f64,
        /// Its value in the pad that is held to be right.
        nominal: f64,
    },
    /// The frame of a module is missing on a side.
    FrameOpen(usize, Side),
}

/// What there is to ask.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Setting {
    /// How many channels.
    pub(super) channels: usize,
    /// How many modules, of three channels each; none where channels mean nothing to each other.
    pub(super) modules: usize,
    /// The field's changes, in the order of their weights.
    pub(super) changes: Vec<Change>,
    /// Whether the channels answer to a field and forces.
    pub(super) has_field: bool,
    /// The part of a frame's area that lies on each side.
    pub(super) side_shares: [(Side, f64); 4],
    /// Radius of the load's patch in the model.
    pub(super) patch_radius_mm: f64,
    /// Whether time goes on from row to row.
    pub(super) has_time: bool,
    /// Whether the temperature differs from row to row.
    pub(super) has_temperature: bool,
    /// Whether the cycles of load differ from row to row.
    pub(super) has_cycles: bool,
}

impl Setting {
    /// Every channel.
    pub(super) fn each_channel(&self) -> impl Iterator<Item = Target> + use<> {
        (0..self.channels).map(Target::Channel)
    }

    /// Every module.
    pub(super) fn each_module(&self) -> impl Iterator<Item = Target> + use<> {
        (0..self.modules).map(Target::Module)
    }

    /// The rig, where there is a field to hold it against.
    pub(super) fn rig(&self) -> Vec<Target> {
        if self.has_field { vec![Target::Rig] } else { Vec::new() }
    }

    /// The weight of an open frame, and the part of its area that is then missing.
    pub(super) fn frame_open(&self, module: usize, side: Side) -> Option<(usize, f64)> {
        let at = self.changes.iter().position(|change| *change == Change::FrameOpen(module, side))?;
        let (_, share) = self.side_shares.iter().find(|(of, _)| *of == side)?;
        Some((at, *share))
    }

    /// The weight of a number of the device, its value in the field's own pad, and the nominal one.
    pub(super) fn number(&self, wanted: &str) -> Option<(usize, f64, f64)> {
        self.changes.iter().enumerate().find_map(|(at, change)| match *change {
            Change::Number { name, own, nominal } if name == wanted => Some((at, own, nominal)),
            _ => None,
        })
    }
}
