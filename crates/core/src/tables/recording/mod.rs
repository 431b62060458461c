//! Tables of contacts as a decoder takes them: relative to the untouched pad, without hysteresis and creep.
//!
//! Rows are read in their order, as hysteresis depends on it; each table begins at rest. Before each static sample the pad was
//! released, and one that is reached by unloading came from full scale. The zeros are readings with hysteresis, too, so states
//! count relative to those of the untouched pad.

mod part;

pub use self::part::UntouchedReading;
use self::part::{Follow, RecordingPart};
use crate::pipeline::compensation::Compensation;
use crate::pipeline::compensation::hysteresis::{Hysteresis, NO_HYSTERESIS, PLAYS};
use crate::pipeline::compensation::thermal::Thermal;
use crate::pipeline::contact::Decoder;
use crate::quantity::CHANNELS;
use crate::tables::measured::zero::{self, Zeros};
use crate::tables::measured::{Row, Table};
use tactpad_numeric::memory::Relaxation;

/// Rounds of the fixed-point iteration between strains and their lags.
const ROUNDS: usize = 4;

/// Tables, one after the other.
#[derive(Clone, Debug)]
pub struct Recording {
    /// All rows, less what the untouched pad reads; of names only those of the first table.
    tared: Table,
    parts: Vec<RecordingPart>,
    full_scale_n: f64,
}

impl Recording {
    /// `None` if the table never reads the untouched pad. `full_scale_n` is the pad's largest force.
    pub fn of(raw: Table, full_scale_n: f64) -> Option<Self> {
        let zeros = Zeros::of(&raw)?;
        Some(Self::by(raw, zeros, full_scale_n))
    }

    /// A time series of which it is known otherwise when nothing touches the pad: in these rows, in order. `None` if that is
    /// never.
    pub fn series(raw: Table, untouched: Vec<usize>, full_scale_n: f64) -> Option<Self> {
        let zeros = Zeros::at_rows(&raw, untouched)?;
        Some(Self::by(raw, zeros, full_scale_n))
    }

    fn by(mut table: Table, zeros: Zeros, full_scale_n: f64) -> Self {
        let (rows, contacts) = (table.rows.len(), zero::contacts(&table));
        let readings = zeros.tare(&mut table);
        let part = RecordingPart { first: 0, rows, zeros: Some(zeros), readings, contacts };
        Self { tared: table, parts: vec![part], full_scale_n }
    }

    /// A table that need not read the untouched pad. Its channels stay raw.
    pub fn raw(raw: Table, full_scale_n: f64) -> Self {
        let (rows, contacts) = (raw.rows.len(), zero::contacts(&raw));
        let part = RecordingPart { first: 0, rows, zeros: None, readings: Vec::new(), contacts };
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
        let moved = |part: RecordingPart| RecordingPart { first: part.first + rows, ..part };
        self.parts.extend(other.parts.into_iter().map(moved));
        self
    }

    /// The same with other readings in the place of each, from a row on.
    #[must_use]
    pub fn changed(mut self, first: usize, other_uv: impl Fn(&[f64; CHANNELS]) -> [f64; CHANNELS]) -> Self {
        for uv in self.tared.rows.iter_mut().skip(first).filter_map(|row| row.uv.as_mut()) {
            *uv = other_uv(uv);
        }
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
            for channel in 0..CHANNELS {
                let of_zeros = |zeros: &Zeros| {
                    let values: Vec<[f64; 1]> =
                        zeros.rows().iter().map(|at| [zero_uv(*at)[channel]]).collect();
                    zeros.of_channel(channel, &values)
                };
                let taken = part.zeros.as_ref().map(of_zeros);
                for (at, row) in rows.iter_mut().enumerate() {
                    let Some(uv) = &mut row.uv else { continue };
                    let [taken_uv] = taken.as_ref().map_or([0.0], |taken| taken[at]);
                    // (s − z(T) + z₀)/(1 + α ΔT): z(T) is the zero's thermal part here, z₀ that of the zero which was taken off.
                    uv[channel] =
                        (uv[channel] - zero_uv(at)[channel] + taken_uv) / thermal.gain(row.temp_c)[channel];
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
    pub fn zeros(&self) -> impl Iterator<Item = Vec<UntouchedReading>> {
        let moved =
            |part: &RecordingPart| part.readings.iter().map(|(at, uv)| (part.first + at, *uv)).collect();
        self.parts.iter().map(moved)
    }

    /// Without creep.
    #[must_use]
    pub fn without_creep(mut self, creep: &Relaxation) -> Self {
        if *creep == Relaxation::NONE {
            return self;
        }
        for channel in 0..CHANNELS {
            let read_uv = |row: &Row| row.uv.map_or(0.0, |uv| uv[channel]);
            let mut free_uv: Vec<f64> = self.tared.rows.iter().map(read_uv).collect();
            // Creep follows the strain without creep: a second round of the fixed-point iteration is near enough.
            for _ in 0..2 {
                let crept = self.crept_by(creep, |at, is_zero| if is_zero { 0.0 } else { free_uv[at] });
                let rows = self.tared.rows.iter().zip(self.relative(channel, crept));
                free_uv.iter_mut().zip(rows).for_each(|(free_uv, (row, [crept_uv]))| {
                    *free_uv = read_uv(row) - creep.added(crept_uv);
                });
            }
            self.set(channel, &free_uv);
        }
        self
    }

    fn set(&mut self, channel: usize, uv: &[f64]) {
        let rows = self.tared.rows.iter_mut().zip(uv);
        rows.for_each(|(row, uv)| row.uv.iter_mut().for_each(|channels| channels[channel] = *uv));
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

    /// How far a channel has crept in each row with this relaxation time. Loads are held for their dwell, and what they leave
    /// behind fades until the next one; where rows have no times, it has faded. Strains are those of `known`, else the row's
    /// channel.
    pub fn crept(
        &self,
        channel: usize,
        creep: &Relaxation,
        known: impl Fn(usize) -> Option<f64>,
    ) -> Vec<[f64; 1]> {
        let read_uv = |at: usize| self.tared.rows[at].uv.map_or(0.0, |uv| uv[channel]);
        self.crept_by(creep, |at, is_zero| {
            known(at).unwrap_or_else(|| if is_zero { 0.0 } else { read_uv(at) })
        })
    }

    /// The same by the strain of each row, which is told whether it is one of the untouched pad.
    fn crept_by(&self, creep: &Relaxation, strain_uv: impl Fn(usize, bool) -> f64) -> Vec<[f64; 1]> {
        let mut states = Vec::with_capacity(self.tared.rows.len());
        for part in &self.parts {
            part.crept(&self.tared.rows, creep, &strain_uv, |state| states.push(state));
        }
        states
    }

    /// The tables relative to the untouched pad and without hysteresis.
    #[must_use]
    pub fn without_hysteresis(mut self, hysteresis: &Hysteresis) -> Table {
        for channel in 0..CHANNELS {
            let lags = self.relative(channel, self.states(channel, hysteresis, |_| None));
            for (row, lags) in self.tared.rows.iter_mut().zip(lags) {
                row.uv
                    .iter_mut()
                    .for_each(|uv| uv[channel] = without(uv[channel], hysteresis, channel, &lags));
            }
        }
        self.tared
    }

    /// A channel's states of the play operators less its strain, in each row. The strains are those of `known`, else the row's
    /// channel without hysteresis: where a reading is to be explained, its own noise must not explain it.
    pub fn states(
        &self,
        channel: usize,
        hysteresis: &Hysteresis,
        known: impl Fn(usize) -> Option<f64>,
    ) -> Vec<[f64; PLAYS]> {
        let rows = &self.tared.rows;
        let mut states = vec![[0.0; PLAYS]; rows.len()];
        for _ in 0..ROUNDS {
            states = self.relative(channel, states);
            let free_uv = |at: usize, is_zero: bool, lags: &[f64; PLAYS]| {
                let read_uv = || {
                    rows[at].uv.filter(|_| !is_zero).map(|uv| without(uv[channel], hysteresis, channel, lags))
                };
                known(at).or_else(read_uv).unwrap_or_default()
            };
            let follow = Follow { rows, full_scale_n: self.full_scale_n, hysteresis, channel };
            self.parts.iter().for_each(|part| part.follow(&follow, &mut states, free_uv));
        }
        states
    }

    /// These states of a channel relative to those of the untouched pad. What hysteresis or creep added to a row's tared channel is the sum
    /// of shares times this.
    #[must_use]
    pub fn relative<const N: usize>(&self, channel: usize, mut states: Vec<[f64; N]>) -> Vec<[f64; N]> {
        self.parts.iter().for_each(|part| part.relative(channel, &mut states));
        states
    }
}

fn without(uv: f64, hysteresis: &Hysteresis, channel: usize, lags: &[f64; PLAYS]) -> f64 {
    uv - hysteresis.iter().zip(lags).map(|(plays, lag_uv)| plays[channel].share * lag_uv).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::measured::Label;
    use tactpad_numeric::memory::PlayOperator;

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
        let play = PlayOperator { threshold: 100.0, share: 0.1 };
        let hysteresis = [[play; CHANNELS], [PlayOperator::NONE; CHANNELS]];
        let tables = [table(&[(0.0, 10.0), (4.0, 2000.0)]), table(&[(1.0, 600.0), (0.0, 90.0)])];
        let recordings = tables.map(|table| Recording::of(table, 5.0).unwrap());
        let alone: Vec<Row> =
            recordings.iter().flat_map(|it| it.clone().without_hysteresis(&hysteresis).rows).collect();
        let [first, second] = recordings;
        let joined = first.then(second);
        assert_eq!(joined.contacts(), [1, 2]);
        assert_eq!(joined.zeros().map(|zeros| zeros[0].0).collect::<Vec<_>>(), [0, 3]);
        assert_eq!(joined.without_hysteresis(&hysteresis).rows, alone);
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
