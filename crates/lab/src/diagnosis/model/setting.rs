//! What a pad and a measurement offer: which causes can be asked for, and where.

use super::memory::Dwells;
use crate::diagnosis::data::target::Target;
use tactpad_core::pad::device::{Device, Side};

/// A way in which the field may change, by the mechanics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Change {
    /// A number of the device's file.
    Number {
        /// Its name.
        name: &'static str,
        /// Its value in the pad that the field is of.
        own: f64,
        /// Its value in the pad that is held to be right.
        nominal: f64,
        /// Whether it is a modulus, or multiplies one.
        is_stiffness: bool,
    },
    /// The frame of a module is missing on a side.
    FrameOpen(usize, Side),
    /// A share of the bond's area of a module has come off from a side.
    Debonded(usize, Side, f64),
}

impl Change {
    /// The weight of a number that is `factor` times the nominal one; of the nominal one where that is no stiffness.
    pub(crate) fn weight(&self, factor: f64) -> f64 {
        match *self {
            // What gives way adds up, in series: first order in 1/k, with the slope k ∂/∂k at the field's own k.
            Self::Number { own, nominal, is_stiffness: true, .. } => own * (1.0 - own / (nominal * factor)),
            Self::Number { own, nominal, .. } => nominal - own,
            Self::FrameOpen(..) | Self::Debonded(..) => 0.0,
        }
    }
}

/// What there is to ask.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Setting {
    /// How many channels.
    pub(crate) channels: usize,
    /// How many modules, of three channels each; none where channels mean nothing to each other.
    pub(crate) modules: usize,
    /// The field's changes, in the order of their weights.
    pub(crate) changes: Vec<Change>,
    /// Whether the channels answer to a field and forces.
    pub(crate) has_field: bool,
    /// The part of a frame's area that lies on each side.
    pub(crate) side_shares: [(Side, f64); 4],
    /// Radius of the load's patch in the model.
    pub(crate) patch_radius_mm: f64,
    /// Whether time goes on from row to row.
    pub(crate) has_time: bool,
    /// Whether the temperature differs from row to row.
    pub(crate) has_temperature: bool,
    /// Whether the cycles of load differ from row to row.
    pub(crate) has_cycles: bool,
    /// Whether any rows are a time series.
    pub(crate) has_series: bool,
    /// Whether loads were reached from both sides.
    pub(crate) has_both_ways: bool,
    /// What is known of how long static loads were held.
    pub(crate) dwells: Dwells,
}

impl Setting {
    /// Every channel.
    pub(crate) fn each_channel(&self) -> impl Iterator<Item = Target> + use<> {
        (0..self.channels).map(Target::Channel)
    }

    /// Every module.
    pub(crate) fn each_module(&self) -> impl Iterator<Item = Target> + use<> {
        (0..self.modules).map(Target::Module)
    }

    /// Every side of every module.
    pub(crate) fn each_side(&self) -> Vec<Target> {
        (0..self.modules).flat_map(|module| Side::ALL.map(|side| Target::ModuleSide(module, side))).collect()
    }

    /// The rig, where there is a field to hold it against.
    pub(crate) fn rig(&self) -> Vec<Target> {
        if self.has_field { vec![Target::Rig] } else { Vec::new() }
    }

    /// The weight of an open frame, and the part of its area that is then missing.
    pub(crate) fn frame_open(&self, module: usize, side: Side) -> Option<(usize, f64)> {
        let at = self.changes.iter().position(|change| *change == Change::FrameOpen(module, side))?;
        let (_, share) = self.side_shares.iter().find(|(of, _)| *of == side)?;
        Some((at, *share))
    }

    /// The weights of the changes by which a bond has lost a share of its area: Lagrange's polynomials through the known
    /// shares and none.
    pub(crate) fn debonded(&self, module: usize, side: Side, share: f64) -> Vec<(usize, f64)> {
        let known = self.changes.iter().enumerate().filter_map(|(at, change)| match *change {
            Change::Debonded(of, from, known) if (of, from) == (module, side) => Some((at, known)),
            _ => None,
        });
        let known: Vec<(usize, f64)> = known.collect();
        let weight = |(at, own): &(usize, f64)| {
            let others = known.iter().filter(|(other, _)| other != at);
            // Π (s − sⱼ)/(sᵢ − sⱼ), none among the sⱼ.
            let factors = others.map(|(_, other)| (share - other) / (own - other));
            (*at, share / own * factors.product::<f64>())
        };
        known.iter().map(weight).collect()
    }

    /// A number of the device: its weight's place, and what is known of it.
    pub(crate) fn number(&self, wanted: &str) -> Option<(usize, Change)> {
        let is_wanted = |change: &Change| matches!(change, Change::Number { name, .. } if *name == wanted);
        self.changes.iter().position(is_wanted).map(|at| (at, self.changes[at]))
    }

    /// The weights by which the pad that is held to be right differs from the field's own.
    pub(crate) fn own_weights(&self, nominal: &Device, own: &Device) -> Vec<f64> {
        let mut weights: Vec<f64> = self.changes.iter().map(|change| change.weight(1.0)).collect();
        for (device, sign) in [(nominal, 1.0), (own, -1.0)] {
            for (module, state) in device.modules.iter().enumerate() {
                let open = state.frame_open.and_then(|side| self.frame_open(module, side));
                open.into_iter().for_each(|(at, _)| weights[at] += sign);
                let debonded = state.debonded().map(|(side, share)| self.debonded(module, side, share));
                debonded.into_iter().flatten().for_each(|(at, weight)| weights[at] += sign * weight);
            }
        }
        weights
    }
}
