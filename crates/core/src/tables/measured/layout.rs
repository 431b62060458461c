//! Where the columns of a file stand.

use super::columns::{Column, LABEL, TableKind, channel_columns};
use super::error::Fault;
use crate::quantity::CHANNELS;

/// Where the columns of a file stand, from 0.
#[derive(Debug)]
pub(super) struct Layout {
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
    pub(super) fn of(names: &[&str], kind: TableKind) -> Result<Self, Fault> {
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
        let channels = if kind == TableKind::Measured { Some(channels(place)?) } else { None };
        let optional = Column::ALL.map(|column| column.name().filter(|_| kind.reads(column)).and_then(place));
        let known = |name: &str| {
            LABEL.contains(&name) || Column::ALL.iter().any(|column| column.name() == Some(name))
        };
        let channel_names = channel_columns();
        let is_channel = |name: &str| channel_names.iter().any(|channel| channel == name);
        for (index, name) in names.iter().enumerate() {
            let counts = known(name) || (is_channel(name) && kind == TableKind::Measured);
            if counts && names.iter().take(index).any(|before| before == name) {
                return Err(Fault::DoubledColumn((*name).to_owned()));
            }
        }
        let is_other = |name: &str| kind.reads(Column::Others) && !known(name) && !is_channel(name);
        let others = names.iter().enumerate().filter(|(_, name)| is_other(name));
        Ok(Self {
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
