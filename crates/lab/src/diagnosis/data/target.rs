//! Where a cause acts.

use std::fmt;

use tactpad_core::pad::device::Side;

/// Columns of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LabelColumns {
    /// All labels.
    All,
    /// x and y.
    Places,
    /// Fx, Fy and Fz.
    Forces,
    /// The channels.
    Channels,
    /// One of x, y, Fx, Fy, Fz.
    One(usize),
}

/// The columns of the labels, in their order.
pub(crate) const LABELS: [&str; 5] = ["x_mm", "y_mm", "fx_n", "fy_n", "fz_n"];

impl LabelColumns {
    /// Its name in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::All => "labels",
            Self::Places => "places",
            Self::Forces => "forces",
            Self::Channels => "channels",
            Self::One(column) => LABELS[column],
        }
    }
}

/// Where a cause acts. Channels and modules are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// All of the pad.
    Pad,
    /// Rig that measured it.
    Rig,
    /// All channels, or all labels, of a sensor that nothing more is known of.
    All,
    /// A channel.
    Channel(usize),
    /// A channel, by another one.
    Channels {
        /// The receiving one.
        into: usize,
        /// The source.
        from: usize,
    },
    /// A module.
    Module(usize),
    /// A module, by another one.
    Modules {
        /// The receiving one.
        into: usize,
        /// The source.
        from: usize,
    },
    /// A module, on one of its sides.
    ModuleSide(usize, Side),
    /// The labels, or some columns.
    Labels(LabelColumns),
}

impl Target {
    /// The module that it is about: that of a channel of a pad, or the receiving one; none of the whole pad and of the rig.
    pub fn module(&self) -> Option<usize> {
        match *self {
            Self::Channel(channel) | Self::Channels { into: channel, .. } => Some(channel / 3),
            Self::Module(module) | Self::Modules { into: module, .. } | Self::ModuleSide(module, _) => {
                Some(module)
            }
            Self::Pad | Self::Rig | Self::All | Self::Labels(_) => None,
        }
    }

    /// Its name in reports, where channels have these names.
    pub fn name(&self, channels: &[String]) -> String {
        match *self {
            Self::Pad => "pad".to_owned(),
            Self::Rig => "rig".to_owned(),
            Self::All => "all".to_owned(),
            Self::Labels(columns @ LabelColumns::One(_)) => columns.name().to_owned(),
            Self::Labels(_) => "labels".to_owned(),
            Self::Channel(channel) | Self::Channels { into: channel, .. } => channel_name(channels, channel),
            Self::Module(module) | Self::Modules { into: module, .. } | Self::ModuleSide(module, _) => {
                format!("module{module}")
            }
        }
    }

    /// Which other part it names, if any.
    pub fn with(&self, channels: &[String]) -> Option<String> {
        match *self {
            Self::Channels { from, .. } => Some(channel_name(channels, from)),
            Self::Modules { from, .. } => Some(format!("module{from}")),
            Self::Labels(columns) if !matches!(columns, LabelColumns::All | LabelColumns::One(_)) => {
                Some(columns.name().to_owned())
            }
            _ => None,
        }
    }

    /// The side that it names, if any.
    pub const fn side(&self) -> Option<Side> {
        match *self {
            Self::ModuleSide(_, side) => Some(side),
            _ => None,
        }
    }
}

fn channel_name(channels: &[String], channel: usize) -> String {
    channels.get(channel).cloned().unwrap_or_else(|| format!("channel {channel}"))
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name(&[]))
    }
}
