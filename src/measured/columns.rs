//! Which columns a table has, and where they stand.

use super::error::Fault;
use crate::quantity::{CHANNEL_NAMES, CHANNELS};

/// What a table is read as: which of its columns count, and which it must have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
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
    /// Those that a table carries without knowing what they are.
    Others,
}

/// The columns that every table has.
pub const LABEL: [&str; 5] = ["x_mm", "y_mm", "fx_n", "fy_n", "fz_n"];

impl Column {
    /// All of them, in the order in which they are written; the label stands before the channels.
    pub const ALL: [Self; 9] = [
        Self::Trial,
        Self::Session,
        Self::Time,
        Self::Temperature,
        Self::Cycle,
        Self::Channels,
        Self::Dwell,
        Self::Approach,
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
            Self::Channels | Self::Others => None,
        }
    }
}

/// The names of the channels' columns.
pub(super) fn channel_columns() -> [String; CHANNELS] {
    CHANNEL_NAMES.map(|name| format!("{name}_uv"))
}

/// Where the columns of a file stand, from 0.
#[derive(Debug)]
pub(super) struct Layout {
    /// How many there are.
    pub(super) width: usize,
    /// The label's.
    pub(super) label: [usize; LABEL.len()],
    /// The channels'.
    pub(super) channels: Option<[usize; CHANNELS]>,
    /// Those that are carried along, and their names.
    pub(super) others: Vec<(usize, String)>,
    /// Those with a name of their own, in the order of [`Column::ALL`].
    optional: [Option<usize>; Column::ALL.len()],
}

impl Layout {
    /// Finds the columns by the names in a table's first line.
    pub(super) fn of(names: &[&str], kind: Kind) -> Result<Self, Fault> {
        let place = |wanted: &str| names.iter().position(|name| *name == wanted);
        let missing: Vec<_> = LABEL.into_iter().filter(|name| place(name).is_none()).collect();
        if let ([one], true) = (names, !missing.is_empty())
            && one.contains([';', '\t'])
        {
            return Err(Fault::Separator);
        }
        if !missing.is_empty() {
            return Err(Fault::MissingColumns { names: missing.join(", "), kind });
        }
        let channels = if kind == Kind::Measured { Some(channels(place)?) } else { None };
        let optional = Column::ALL.map(|column| column.name().filter(|_| kind.reads(column)).and_then(place));
        let known = |name: &str| {
            LABEL.contains(&name) || Column::ALL.iter().any(|column| column.name() == Some(name))
        };
        let channel_names = channel_columns();
        let is_channel = |name: &str| channel_names.iter().any(|channel| channel == name);
        for (index, name) in names.iter().enumerate() {
            let counts = known(name) || (is_channel(name) && kind == Kind::Measured);
            if counts && names.iter().take(index).any(|before| before == name) {
                return Err(Fault::DoubledColumn((*name).to_owned()));
            }
        }
        let is_other = |name: &str| kind.reads(Column::Others) && !known(name) && !is_channel(name);
        let others = names.iter().enumerate().filter(|(_, name)| is_other(name));
        Ok(Self {
            width: names.len(),
            // None is missing.
            label: LABEL.map(|name| place(name).unwrap_or_default()),
            channels,
            others: others.map(|(index, name)| (index, (*name).to_owned())).collect(),
            optional,
        })
    }

    /// Where a column with a name of its own stands.
    pub(super) fn place(&self, wanted: Column) -> Option<usize> {
        let index = Column::ALL.iter().position(|column| *column == wanted)?;
        self.optional.get(index).copied().flatten()
    }
}

impl Kind {
    /// Whether this column counts.
    fn reads(self, column: Column) -> bool {
        match self {
            Self::Contacts => column == Column::Time,
            Self::Plan => column != Column::Channels,
            Self::Measured => true,
        }
    }
}

/// Where all nine channels stand.
fn channels(place: impl Fn(&str) -> Option<usize>) -> Result<[usize; CHANNELS], Fault> {
    let names = channel_columns();
    let missing: Vec<_> = names.iter().filter(|name| place(name).is_none()).map(String::as_str).collect();
    match missing.len() {
        0 => Ok(names.each_ref().map(|name| place(name).unwrap_or_default())),
        CHANNELS => Err(Fault::NoChannels),
        _ => Err(Fault::MissingChannels(missing.join(", "))),
    }
}
