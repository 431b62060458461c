//! Tables of measured contacts, and the plans by which they are measured.
//!
//! A row is what the reference wrote down about a contact (its label), and what the nine channels read, raw: offset and
//! temperature included. Rows of one trial are one time series in order; a row without trial is a static sample. A plan is
//! the same table without channels.
//!
//! As a file a table is CSV: [`mod@read`] and [`mod@write`] turn texts into tables and back. Whoever calls opens the files.

pub mod columns;
pub mod ending;
pub mod error;
mod layout;
mod lines;
pub mod read;
pub mod rows;
pub mod sheet;
pub mod write;
pub mod zero;

use self::columns::Column;
use self::ending::OpenEnd;
use crate::pad::weight::weight_n;
use crate::quantity::{CHANNELS, Contact};

/// Dwell of a static load before it is read, where a row does not say.
pub const DWELL_S: f64 = 1.0;
/// Time over which it is read: its channels are means over that, and its time is the end.
pub const READ_S: f64 = 1.0;
/// A load that is reached downwards comes from this much more than itself at least.
const OVERLOAD_MIN: f64 = 1.2;

/// Label of a contact: place, mm, and force, N, on the plate, not the truth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Label {
    /// Along +x.
    pub x_mm: f64,
    /// Along +y.
    pub y_mm: f64,
    /// Along +x.
    pub fx_n: f64,
    /// Along +y.
    pub fy_n: f64,
    /// Pressing in.
    pub fz_n: f64,
}

impl Label {
    /// x, y, Fx, Fy, Fz.
    pub const fn numbers(&self) -> [f64; 5] {
        [self.x_mm, self.y_mm, self.fx_n, self.fy_n, self.fz_n]
    }

    /// The same place under a weight of so many grams, 0 for none: (0, 0, m g).
    #[must_use]
    pub fn under_weight(&self, weight_g: f64) -> Self {
        Self { fx_n: 0.0, fy_n: 0.0, fz_n: weight_n(weight_g), ..*self }
    }

    /// The magnitude of the force.
    pub fn resultant_n(&self) -> f64 {
        libm::hypot(libm::hypot(self.fx_n, self.fy_n), self.fz_n)
    }

    /// From how many times this load it is reached downwards: from full scale, but for the largest loads. Nothing is from nothing.
    pub fn overload(&self, full_scale_n: f64) -> f64 {
        let force_n = self.resultant_n();
        if force_n > 0.0 { (full_scale_n / force_n).max(OVERLOAD_MIN) } else { 1.0 }
    }
}

/// How a static load is reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Approach {
    /// From rest.
    Loading,
    /// From a higher load.
    Unloading,
}

impl From<Label> for Contact {
    fn from(label: Label) -> Self {
        let [x_mm, y_mm, fx_n, fy_n, fz_n] =
            [label.x_mm, label.y_mm, label.fx_n, label.fy_n, label.fz_n].map(|number| number as f32);
        Self { x_mm, y_mm, fx_n, fy_n, fz_n }
    }
}

impl Approach {
    /// As files write it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Loading => "loading",
            Self::Unloading => "unloading",
        }
    }
}

/// One line of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Its line in the file, from 1; 0 for a row that comes from no file.
    pub line: usize,
    /// Index of its table, where several were joined.
    pub measurement: u16,
    /// Index of its trial in [`Table::trials`].
    pub trial: Option<usize>,
    /// Index of its session in [`Table::sessions`].
    pub session: Option<usize>,
    /// Time on the pad's clock.
    pub t_s: Option<f64>,
    /// Temperature of the pad.
    pub temp_c: Option<f64>,
    /// Cycles of load that the pad has behind it.
    pub cycle: Option<f64>,
    /// How long a static load is held before it is read; only plans have it.
    pub dwell_s: Option<f64>,
    /// From where a static load comes; only plans have it.
    pub approach: Option<Approach>,
    /// By how much the pad was turned on the stage, counter-clockwise seen from above. Labels are in the pad's frame.
    pub turned_deg: Option<f64>,
    /// Grams of the known weight that lay there, 0 for an untouched pad; then the label's force is its, whatever the reference wrote.
    pub weight_g: Option<f64>,
    /// What the reference wrote.
    pub label: Label,
    /// The channels, in the order of [`CHANNEL_NAMES`](crate::quantity::CHANNEL_NAMES); none in a plan.
    pub uv: Option<[f64; CHANNELS]>,
}

impl Row {
    /// A static sample that comes from no file, of which nothing but the label is known.
    pub const fn of(label: Label) -> Self {
        Self {
            line: 0,
            measurement: 0,
            trial: None,
            session: None,
            t_s: None,
            temp_c: None,
            cycle: None,
            dwell_s: None,
            approach: None,
            turned_deg: None,
            weight_g: None,
            label,
            uv: None,
        }
    }
}

/// Rows, and the names of their trials and sessions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// In the file's order.
    pub rows: Vec<Row>,
    /// Names of the trials, in the order in which they first appear.
    pub trials: Vec<String>,
    /// Names of the sessions, in the order in which they first appear.
    pub sessions: Vec<String>,
    /// Columns that nobody knows.
    pub others: ExtraColumns,
    /// Its last line in the file, if that may be cut off.
    pub open_end: Option<OpenEnd>,
}

/// Columns that are carried along: they belong to the lines of the file that they were read from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExtraColumns {
    /// Their names.
    pub names: Vec<String>,
    /// A row's [`line`](Row::line), and its cells as CSV; sorted by line.
    pub texts: Vec<(usize, String)>,
}

impl Table {
    /// The rows of several tables, one measurement after the other. Time series stay apart, sessions of one name are one; columns that nobody
    /// knows are left out.
    pub fn joined(tables: impl IntoIterator<Item = Self>) -> Self {
        let mut all = Self::default();
        for (measurement, Self { rows, trials, sessions, open_end, .. }) in (0..).zip(tables) {
            let first_trial = all.trials.len();
            all.trials.extend(trials);
            let places: Vec<usize> = sessions.into_iter().map(|name| all.place_of_session(name)).collect();
            all.rows.extend(rows.into_iter().map(|row| Row {
                measurement,
                trial: row.trial.map(|trial| first_trial + trial),
                session: row.session.and_then(|session| places.get(session).copied()),
                ..row
            }));
            all.open_end = all.open_end.or(open_end);
        }
        all
    }

    fn place_of_session(&mut self, name: String) -> usize {
        if let Some(place) = self.sessions.iter().position(|known| *known == name) {
            return place;
        }
        self.sessions.push(name);
        self.sessions.len() - 1
    }

    /// The rows at these places, in this order; none for a place beyond the last.
    pub fn rows_at(&self, places: &[usize]) -> Vec<Row> {
        places.iter().filter_map(|at| self.rows.get(*at).copied()).collect()
    }

    /// The columns that any row has a value for, in the order of a file.
    pub fn columns(&self) -> Vec<Column> {
        let any = |has: fn(&Row) -> bool| self.rows.iter().any(has);
        let is_there = |column: &Column| match column {
            Column::Trial => any(|row| row.trial.is_some()),
            Column::Session => any(|row| row.session.is_some()),
            Column::Time => any(|row| row.t_s.is_some()),
            Column::Temperature => any(|row| row.temp_c.is_some()),
            Column::Cycle => any(|row| row.cycle.is_some()),
            Column::Channels => any(|row| row.uv.is_some()),
            Column::Dwell => any(|row| row.dwell_s.is_some()),
            Column::Approach => any(|row| row.approach.is_some()),
            Column::Turned => any(|row| row.turned_deg.is_some()),
            Column::Weight => any(|row| row.weight_g.is_some()),
            Column::Others => !self.others.names.is_empty(),
        };
        Column::ALL.into_iter().filter(is_there).collect()
    }
}
