//! Which columns a table has, and where they stand.

use crate::quantity::{CHANNEL_NAMES, CHANNELS};

/// Kind of a table: which of its columns count, and which it must have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableKind {
    /// Contacts, all of one time series: `t_s` and the label. Whatever else a table has is not read.
    Contacts,
    /// Contacts that are to be measured: everything but the channels.
    Plan,
    /// Measured contacts: everything, and the channels must be there.
    Measured,
}

/// A column that a table may lack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// `trial`: a text.
    Trial,
    /// `session`: a text.
    Session,
    /// `t_s`.
    Time,
    /// `temp_c`.
    Temperature,
    /// `cycle`.
    Cycle,
    /// `m0x_uv` to `m2z_uv`: nine columns, all or none.
    Channels,
    /// `dwell_s`.
    Dwell,
    /// `approach`: `loading` or `unloading`.
    Approach,
    /// `turned_deg`.
    Turned,
    /// `weight_g`.
    Weight,
    /// Those that a table carries without knowing what they are.
    Others,
}

/// The columns that every table has.
pub const LABEL: [&str; 5] = ["x_mm", "y_mm", "fx_n", "fy_n", "fz_n"];

impl Column {
    /// All of them, in the order in which they are written; the label stands before the channels.
    pub const ALL: [Self; 11] = [
        Self::Trial,
        Self::Session,
        Self::Time,
        Self::Temperature,
        Self::Cycle,
        Self::Channels,
        Self::Dwell,
        Self::Approach,
        Self::Turned,
        Self::Weight,
        Self::Others,
    ];

    /// Its name in a file; none if it stands for several.
    pub const fn name(self) -> Option<&'static str> {
        match self {
            Self::Trial => Some("trial"),
            Self::Session => Some("session"),
            Self::Time => Some("t_s"),
            Self::Temperature => Some("temp_c"),
            Self::Cycle => Some("cycle"),
            Self::Dwell => Some("dwell_s"),
            Self::Approach => Some("approach"),
            Self::Turned => Some("turned_deg"),
            Self::Weight => Some("weight_g"),
            Self::Channels | Self::Others => None,
        }
    }
}

/// The names of the channels' columns.
pub(super) fn channel_columns() -> [String; CHANNELS] {
    CHANNEL_NAMES.map(|name| format!("{name}_uv"))
}

impl TableKind {
    /// Whether this column counts.
    pub(super) fn reads(self, column: Column) -> bool {
        match self {
            Self::Contacts => column == Column::Time,
            Self::Plan => column != Column::Channels,
            Self::Measured => true,
        }
    }
}
