//! Tables of contacts as a decoder takes them: relative to the untouched pad, without hysteresis and creep.
//!
//! Rows are read in their order, as hysteresis depends on it; each table begins at rest. Before each static sample the pad was
//! released, and one that is reached by unloading came from full scale. The zeros are readings with hysteresis, too, so states
//! count relative to those of the untouched pad.

use crate::pipeline::compensation::Compensation;
use crate::pipeline::compensation::creep::{Creep, Crept, NO_CREEP};
use crate::pipeline::compensation::hysteresis::{History, Hysteresis, NO_HYSTERESIS, PLAYS};
use crate::pipeline::compensation::thermal::Thermal;
use crate::pipeline::contact::Decoder;
use crate::quantity::CHANNELS;
use crate::tables::measured::zero::{self, Zeros};
use crate::tables::measured::{Approach, DWELL_S, READ_S, Row, Table};

/// Rounds of the fixed-point iteration between strains and their lags.
const ROUNDS: usize = 4;

/// For each play operator and channel: its state beside the strain, relative to the same of the untouched pad.
pub type Lags = [[f64; CHANNELS]; PLAYS];

/// A reading of the untouched pad: its row, and the channels.
pub type Untouched = (usize, [f64; CHANNELS]);

/// Tables, one after the other.
#[derive(Clone, Debug)]
pub struct Recording {
    /// All rows, less what the untouched pad reads; of names only those of the first table.
    tared: Table,
    parts: Vec<Part>,
    full_scale_n: f64,
}

/// A table of the recording.
#[derive(Clone, Debug)]
struct Part {
    /// Its first row in the recording.
    first: usize,
    rows: usize,
    /// None in a table that never reads the untouched pad: there, channels are raw, or less a zero that is known otherwise.
    zeros: Option<Zeros>,
    /// What the untouched pad reads in the rows of the zeros.
    readings: Vec<Untouched>,
    /// Places of what a decoder is fitted to, from the part's first row on.
    contacts: Vec<usize>,
}

/// How long a row's load is held before the middle of its reading and after, and how long the pad rests before; `None` where that
/// is unknown and counts as long.
struct Stay {
    rest_s: Option<f64>,
    before_s: f64,
    after_s: f64,
}

impl Stay {
    fn of(row: &Row, previous: Option<&Row>) -> Self {
        // rest = (t − t_previous) − dwell − reading.
        let passed_s = previous.and_then(|previous| Some(row.t_s? - previous.t_s?)).filter(|s| *s >= 0.0);
        if row.trial.is_some() && previous.is_some_and(|previous| previous.trial == row.trial) {
            return Self { rest_s: Some(0.0), before_s: passed_s.unwrap_or(0.0), after_s: 0.0 };
        }
        let read_s = if row.trial.is_none() { READ_S } else { 0.0 };
        // Times in which the dwell has no room are no times of this kind: some count rows.
        let rest_s = passed_s.zip(row.dwell_s).map(|(passed_s, dwell_s)| passed_s - dwell_s - read_s);
        Self {
            rest_s: rest_s.filter(|rest_s| *rest_s >= 0.0),
            before_s: row.dwell_s.unwrap_or(DWELL_S) + read_s / 2.0,
            after_s: read_s / 2.0,
        }
    }
}

impl Recording {
    /// `None` if the table never reads the untouched pad. `full_scale_n` is the pad's largest force.
    pub fn of(raw: Table, full_scale_n: f64) -> Option<Self> {
        let zeros = Zeros::of(&raw)?;
        Some(Self::by(raw, zeros, full_scale_n))
    }

    fn by(mut table: Table, zeros: Zeros, full_scale_n: f64) -> Self {
        let (rows, contacts) = (table.rows.len(), zero::contacts(&table));
        let readings = zeros.tare(&mut table);
        let part = Part { first: 0, rows, zeros: Some(zeros), readings, contacts };
        Self { tared: table, parts: vec![part], full_scale_n }
    }

    /// A table that need not read the untouched pad. Its channels stay raw.
    pub fn raw(raw: Table, full_scale_n: f64) -> Self {
        let (rows, contacts) = (raw.rows.len(), zero::contacts(&raw));
        let part = Part { first: 0, rows, zeros: None, readings: Vec::new(), contacts };
        Self { tared: raw, parts: vec![part], full_scale_n }
    }

    /// Relative to the untouched pad if the table reads it, else raw.
    pub fn tared_or_raw(table: Table, full_scale_n: f64) -> Self {
        match Zeros::of(&table) {
            Some(zeros) => Self::by(table, zeros, full_scale_n),
            None => Self::raw(table, full_scale_n),
        }
    }

    /// This recording, and then another one.
    #[must_use]
    pub fn then(mut self, other: Self) -> Self {
        let rows = self.tared.rows.len();
        // Trials of two tables are never the same one, whatever their indices are.
        self.tared.rows.extend(other.tared.rows);
        let moved = |part: Part| Part { first: part.first + rows, ..part };
        self.parts.extend(other.parts.into_iter().map(moved));
        self
    }

    /// Less what the untouched pad reads, where that is known otherwise than from the tables.
    #[must_use]
    pub fn less(mut self, zero_uv: &[f64; CHANNELS]) -> Self {
        for uv in self.tared.rows.iter_mut().filter_map(|row| row.uv.as_mut()) {
            uv.iter_mut().zip(zero_uv).for_each(|(uv, zero_uv)| *uv -= zero_uv);
        }
        self
    }

    /// Corrected to the reference temperature, where rows have their temperature. Between two readings of the untouched pad
    /// the zero then follows the temperature.
    #[must_use]
    pub fn at_reference(mut self, thermal: &Thermal) -> Self {
        for part in &mut self.parts {
            let rows = &mut self.tared.rows[part.first..][..part.rows];
            let temperatures: Vec<Option<f64>> = rows.iter().map(|row| row.temp_c).collect();
            let zero_uv = |at: usize| thermal.zero_uv(temperatures[at]);
            for (at, row) in rows.iter_mut().enumerate() {
                let taken_uv = part.zeros.as_ref().map_or([0.0; CHANNELS], |zeros| zeros.at(at, zero_uv));
                let (here_uv, gain) = (zero_uv(at), thermal.gain(row.temp_c));
                for (k, uv) in row.uv.iter_mut().flatten().enumerate() {
                    // (s − z(T) + z₀)/(1 + α ΔT): z(T) is the zero's thermal part here, z₀ that of the zero which was taken off.
                    *uv = (*uv - here_uv[k] + taken_uv[k]) / gain[k];
                }
            }
            for (at, uv) in &mut part.readings {
                uv.iter_mut().zip(zero_uv(*at)).for_each(|(uv, zero_uv)| *uv -= zero_uv);
            }
        }
        self
    }

    /// The tables relative to the untouched pad.
    pub const fn tared(&self) -> &Table {
        &self.tared
    }

    /// Whether each table reads the untouched pad.
    pub fn is_tared(&self) -> bool {
        self.parts.iter().all(|part| part.zeros.is_some())
    }

    /// Places of the rows that a decoder is fitted to.
    pub fn contacts(&self) -> Vec<usize> {
        self.parts.iter().flat_map(|part| part.contacts.iter().map(|at| part.first + at)).collect()
    }

    /// The raw readings of the untouched pad, with their places; for each table on its own.
    pub fn zeros(&self) -> impl Iterator<Item = Vec<Untouched>> {
        let moved = |part: &Part| part.readings.iter().map(|(at, uv)| (part.first + at, *uv)).collect();
        self.parts.iter().map(moved)
    }

    /// Without creep.
    #[must_use]
    pub fn without_creep(mut self, creep: &Creep) -> Self {
        if *creep == NO_CREEP {
            return self;
        }
        // Creep follows the strain without creep: a second round of the fixed-point iteration is near enough.
        let mut free: Vec<Option<[f64; CHANNELS]>> = self.tared.rows.iter().map(|row| row.uv).collect();
        for _ in 0..2 {
            let known = |at: usize| free[at].filter(|_| !self.is_zero(at));
            let crept = self.relative(&self.crept(creep.time_s, known));
            let without = |(row, [state_uv]): (&Row, [[f64; CHANNELS]; 1])| {
                let added_uv = Crept { state_uv }.added_uv(creep);
                row.uv.map(|uv| std::array::from_fn(|k| uv[k] - added_uv[k]))
            };
            free = self.tared.rows.iter().zip(crept).map(without).collect();
        }
        self.tared.rows.iter_mut().zip(free).for_each(|(row, uv)| row.uv = uv);
        self
    }

    fn is_zero(&self, at: usize) -> bool {
        self.parts.iter().any(|part| (part.first..part.first + part.rows).contains(&at) && part.is_zero(at))
    }

    /// The tables as a decoder takes them: at its pad's temperature, without creep and hysteresis. The untouched pad is that of
    /// the tables; where they never read it, see [`Recording::less`]. A decoder that takes raw channels takes
    /// [`Recording::raw`].
    pub fn taken(&self, decoder: &Decoder) -> Table {
        self.clone().into_taken(decoder)
    }

    /// The same, for a recording that nobody needs any more.
    pub fn into_taken(self, decoder: &Decoder) -> Table {
        let Compensation { thermal, creep, hysteresis, .. } = &decoder.compensation;
        let recording = match thermal {
            Some(thermal) => self.at_reference(thermal),
            None => self,
        };
        let recording = recording.without_creep(creep);
        if *hysteresis == NO_HYSTERESIS { recording.tared } else { recording.without_hysteresis(hysteresis) }
    }

    /// How far each row's channels have crept with this relaxation time. Loads are held for their dwell, and what they leave
    /// behind fades until the next one; where rows have no times, it has faded. Strains are those of `known`, else the row's
    /// channels.
    pub fn crept(
        &self,
        time_s: f64,
        known: impl Fn(usize) -> Option<[f64; CHANNELS]>,
    ) -> Vec<[[f64; CHANNELS]; 1]> {
        let known: &dyn Fn(usize) -> Option<[f64; CHANNELS]> = &known;
        self.parts.iter().flat_map(|part| self.crept_part(part, time_s, known)).collect()
    }

    fn crept_part(
        &self,
        part: &Part,
        time_s: f64,
        known: &dyn Fn(usize) -> Option<[f64; CHANNELS]>,
    ) -> Vec<[[f64; CHANNELS]; 1]> {
        let mut crept = Crept::default();
        let mut previous: Option<&Row> = None;
        let mut follow = |at: usize| {
            let row = &self.tared.rows[at];
            let Stay { rest_s, before_s, after_s } = Stay::of(row, previous.replace(row));
            match rest_s {
                Some(rest_s) => crept.hold(&[0.0; CHANNELS], rest_s, time_s),
                None => crept = Crept::default(),
            }
            let read_uv = || row.uv.filter(|_| !part.is_zero(at));
            let strain_uv = known(at).or_else(read_uv).unwrap_or_default();
            crept.hold(&strain_uv, before_s, time_s);
            let state_uv = crept.state_uv;
            crept.hold(&strain_uv, after_s, time_s);
            [state_uv]
        };
        (part.first..part.first + part.rows).map(&mut follow).collect()
    }

    /// The tables relative to the untouched pad and without hysteresis.
    pub fn without_hysteresis(&self, hysteresis: &Hysteresis) -> Table {
        let mut table = self.tared.clone();
        let lags = self.relative(&self.states(hysteresis, |_| None));
        for (row, lags) in table.rows.iter_mut().zip(lags) {
            row.uv = row.uv.map(|uv| without(uv, hysteresis, &lags));
        }
        table
    }

    /// Each row's states of the play operators less its strains. The strains are those of `known`, else the row's channels
    /// without hysteresis: where a reading is to be explained, its own noise must not explain it.
    pub fn states(
        &self,
        hysteresis: &Hysteresis,
        known: impl Fn(usize) -> Option<[f64; CHANNELS]>,
    ) -> Vec<Lags> {
        let mut states = vec![[[0.0; CHANNELS]; PLAYS]; self.tared.rows.len()];
        for _ in 0..ROUNDS {
            states = self.follow_load_path(hysteresis, &self.relative(&states), &known);
        }
        states
    }

    /// These states relative to those of the untouched pad. What hysteresis or creep added to a row's tared channels is the sum
    /// of shares times this.
    pub fn relative<const N: usize>(&self, states: &[[[f64; CHANNELS]; N]]) -> Vec<[[f64; CHANNELS]; N]> {
        let relative = |part: &Part| -> Vec<[[f64; CHANNELS]; N]> {
            let states = &states[part.first..][..part.rows];
            (0..part.rows).map(|at| part.relative(states, at)).collect()
        };
        self.parts.iter().flat_map(relative).collect()
    }

    /// The states if these lags are taken off the channels.
    fn follow_load_path(
        &self,
        hysteresis: &Hysteresis,
        lags: &[Lags],
        known: impl Fn(usize) -> Option<[f64; CHANNELS]>,
    ) -> Vec<Lags> {
        let known: &dyn Fn(usize) -> Option<[f64; CHANNELS]> = &known;
        self.parts.iter().flat_map(|part| self.follow_part(part, hysteresis, lags, known)).collect()
    }

    fn follow_part(
        &self,
        part: &Part,
        hysteresis: &Hysteresis,
        lags: &[Lags],
        known: &dyn Fn(usize) -> Option<[f64; CHANNELS]>,
    ) -> Vec<Lags> {
        let mut history = History::default();
        let mut previous: Option<usize> = None;
        let mut states = Vec::with_capacity(part.rows);
        for at in part.first..part.first + part.rows {
            let (row, lags) = (&self.tared.rows[at], &lags[at]);
            let read_uv = || row.uv.filter(|_| !part.is_zero(at)).map(|uv| without(uv, hysteresis, lags));
            let free_uv = known(at).or_else(read_uv).unwrap_or_default();
            if row.trial.is_none() || row.trial != previous {
                history.follow(hysteresis, &[0.0; CHANNELS]);
            }
            if row.trial.is_none() && row.approach == Some(Approach::Unloading) {
                let factor = row.label.overload(self.full_scale_n);
                history.follow(hysteresis, &free_uv.map(|uv| factor * uv));
            }
            history.follow(hysteresis, &free_uv);
            previous = row.trial;
            states.push(history.state_uv.map(|states| std::array::from_fn(|k| states[k] - free_uv[k])));
        }
        states
    }
}

impl Part {
    fn is_zero(&self, at: usize) -> bool {
        let rows = self.zeros.as_ref().map_or(&[][..], Zeros::rows);
        rows.binary_search(&(at - self.first)).is_ok()
    }

    /// A state relative to that of the untouched pad, which without its reading is one at rest.
    fn relative<const N: usize>(&self, states: &[[[f64; CHANNELS]; N]], at: usize) -> [[f64; CHANNELS]; N] {
        std::array::from_fn(|term| {
            let zero_uv =
                self.zeros.as_ref().map_or([0.0; CHANNELS], |zeros| zeros.at(at, |zero| states[zero][term]));
            std::array::from_fn(|channel| states[at][term][channel] - zero_uv[channel])
        })
    }
}

fn without(uv: [f64; CHANNELS], hysteresis: &Hysteresis, lags: &Lags) -> [f64; CHANNELS] {
    std::array::from_fn(|k| {
        uv[k] - hysteresis.iter().zip(lags).map(|(play, lags)| play.share[k] * lags[k]).sum::<f64>()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::compensation::hysteresis::Play;
    use crate::tables::measured::Label;

    /// Rows of (Fz, µV).
    fn table(rows: &[(f64, f64)]) -> Table {
        let row = |(fz_n, uv): &(f64, f64)| Row {
            uv: Some([*uv; CHANNELS]),
            ..Row::of(Label { fz_n: *fz_n, ..Label::default() })
        };
        Table { rows: rows.iter().map(row).collect(), ..Table::default() }
    }

    #[test]
    fn each_table_has_its_own_zeros_and_begins_at_rest() {
        let play = Play { threshold_uv: [100.0; CHANNELS], share: [0.1; CHANNELS] };
        let hysteresis = [play, Play::NONE];
        let tables = [table(&[(0.0, 10.0), (4.0, 2000.0)]), table(&[(1.0, 600.0), (0.0, 90.0)])];
        let recordings = tables.map(|table| Recording::of(table, 5.0).unwrap());
        let alone: Vec<Row> =
            recordings.iter().flat_map(|it| it.without_hysteresis(&hysteresis).rows).collect();
        let [first, second] = recordings;
        let joined = first.then(second);
        assert_eq!(joined.without_hysteresis(&hysteresis).rows, alone);
        assert_eq!(joined.contacts(), [1, 2]);
        assert_eq!(joined.zeros().map(|zeros| zeros[0].0).collect::<Vec<_>>(), [0, 3]);
    }

    #[test]
    fn the_zero_follows_the_temperature_and_gains_divide() {
        let mut table = table(&[(0.0, 100.0), (2.0, 1500.0)]);
        (table.rows[0].temp_c, table.rows[1].temp_c) = (Some(20.0), Some(30.0));
        let thermal =
            Thermal { reference_c: 25.0, zero_uv_per_c: [40.0; CHANNELS], gain_per_c: [0.01; CHANNELS] };
        let first = |recording: Recording| recording.at_reference(&thermal).tared().rows[1].uv.unwrap()[0];
        // 1500 − (100 + 400), and five degrees above the reference.
        assert!((first(Recording::of(table.clone(), 5.0).unwrap()) - 1000.0 / 1.05).abs() < 1e-9);
        // The zero at the reference is 300.
        assert!((first(Recording::raw(table, 5.0).less(&[300.0; CHANNELS])) - 1000.0 / 1.05).abs() < 1e-9);
    }
}
