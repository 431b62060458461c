//! A recording of any sensor as observations, and the labels that its channels are predicted by.

use super::columns::{Columns, extent};
use super::unfit::BLOCKS_MIN;
use tactpad_core::tables::measured::sheet::Sheet;
use tactpad_inference::observations::{Observations, Sample};
use tactpad_numeric::statistics::{correlation, median};

/// Places nearer to each other than this are one location.
const LOCATION_MM: f64 = 0.25;
/// A code for a missing weight: a negative one that recurs in this part of the rows, where no other is negative.
const CODE_SHARE: f64 = 0.01;
/// Rows without trial are one time series if they are so many and follow each other faster than this, or each label's correlation with
/// the one before is larger than this: a load that is driven, not contacts one by one.
const SERIES_ROWS: usize = 50;
const SERIES_STEP_S: f64 = 0.5;
const DRIVEN: f64 = 0.98;
/// A press begins above, and has ended below this part of the range of what varies most.
const PRESSED: [f64; 2] = [0.4, 0.6];
/// A long series of fewer presses is cut into so many equal parts, which are no presses.
const PRESSES_MIN: usize = BLOCKS_MIN;
const PARTS: usize = 8;
/// A label goes nowhere whose range is less than this part of the earlier one, and a channel as far as before whose range is more.
const NARROW: f64 = 0.05;
const AS_FAR: f64 = 0.5;
/// How a load from above is written.
const UNLOADING: &str = "unloading";
/// What stands for places where none varies: half the extent of whatever varies instead.
const HALF_SIDE_MM: f64 = 10.0;

/// A recording.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::diagnosis) struct Recording {
    /// The readings as they are. Samples have their row's number as block.
    pub(in crate::diagnosis) observations: Observations,
    /// For each row, the labels.
    pub(in crate::diagnosis) inputs: Vec<Vec<f64>>,
    /// For each row, its number in the table.
    pub(in crate::diagnosis) table_rows: Vec<usize>,
    /// For each row its cluster.
    pub(in crate::diagnosis) blocks: Vec<usize>,
    /// How many rows had no label.
    pub(in crate::diagnosis) unlabelled: usize,
    /// Whether it has enough places or presses to tell what a sensor does by itself from one to the next.
    pub(in crate::diagnosis) is_repeated: bool,
}

impl Recording {
    pub(in crate::diagnosis) fn of(sheet: &Sheet, columns: &Columns) -> Self {
        let labels: Vec<Vec<f64>> = columns.inputs.iter().map(|name| label(sheet, name)).collect();
        let is_written = |row: &usize| labels.iter().all(|label| label[*row].is_finite());
        let rows: Vec<usize> = (0..sheet.rows()).filter(is_written).collect();
        let of = |name: &str| columns.numbers(sheet, name);
        let finite = |name: &str, row: usize| of(name).map(|all| all[row]).filter(|it| it.is_finite());
        let trials = trials(sheet, columns, &labels);
        let sessions = numbered(columns.texts(sheet, "session").unwrap_or_default());
        let inputs: Vec<Vec<f64>> =
            rows.iter().map(|row| labels.iter().map(|label| label[*row]).collect()).collect();
        let sample = |(at, row): (usize, &usize)| Sample {
            session: sessions.get(*row).copied().flatten().unwrap_or(0),
            trial: trials[*row],
            t_s: finite("t_s", *row),
            label_t_s: finite("label_t_s", *row),
            temp_c: finite("temp_c", *row),
            cycle: finite("cycle", *row),
            dwell_s: sheet.numbers("dwell_s").map(|all| all[*row]).filter(|it| it.is_finite()),
            is_unloading: sheet.texts("approach").is_some_and(|all| all[*row] == UNLOADING),
            block: Some(at),
            ..Sample::default()
        };
        let samples: Vec<Sample> = rows.iter().enumerate().map(sample).collect();
        let reading = |name: &String| -> Vec<f64> {
            rows.iter().map(|row| sheet.numbers(name).map_or(f64::NAN, |all| all[*row])).collect()
        };
        let readings: Vec<Vec<f64>> = columns.channels.iter().map(reading).collect();
        let mut recording = Self {
            observations: Observations {
                channels: columns.channels.clone(),
                is_told: vec![vec![true; rows.len()]; readings.len()],
                readings,
                numbers: (0..samples.len()).collect(),
                samples,
            },
            inputs,
            unlabelled: sheet.rows() - rows.len(),
            table_rows: rows,
            blocks: Vec::new(),
            is_repeated: false,
        };
        let draws;
        (recording.blocks, draws) = recording.clusters(columns);
        recording.is_repeated = draws >= BLOCKS_MIN;
        recording
    }

    /// The rows at these places.
    pub(in crate::diagnosis) fn picked(&self, rows: &[usize]) -> Self {
        let mut observations = self.observations.picked(rows);
        observations.samples.iter_mut().enumerate().for_each(|(at, sample)| sample.block = Some(at));
        Self {
            observations,
            inputs: rows.iter().map(|row| self.inputs[*row].clone()).collect(),
            table_rows: rows.iter().map(|row| self.table_rows[*row]).collect(),
            blocks: rows.iter().map(|row| self.blocks[*row]).collect(),
            unlabelled: self.unlabelled,
            is_repeated: self.is_repeated,
        }
    }

    /// What checks have mended, which may have put rows in another order.
    pub(in crate::diagnosis) fn mended(&self, observations: &Observations) -> Self {
        let order: Vec<usize> = observations.samples.iter().filter_map(|sample| sample.block).collect();
        let mut mended = self.picked(&order);
        mended.observations = observations.clone();
        mended
    }

    /// Places and loads as the inference takes them: those that are there, or whatever varies. `extents` are each input's least and
    /// greatest value.
    pub(in crate::diagnosis) fn placed(&mut self, columns: &Columns, extents: &[[f64; 2]]) {
        let is_place = ["x_mm", "y_mm"].map(|name| columns.input(name));
        let forces = ["fx_n", "fy_n", "fz_n"].map(|name| columns.input(name));
        let unit = |row: &[f64], at: usize| {
            let [low, high] = extents[at];
            HALF_SIDE_MM * (2.0 * row[at] - low - high) / (high - low)
        };
        for (sample, row) in self.observations.samples.iter_mut().zip(&self.inputs) {
            sample.place_mm = if is_place.iter().any(Option::is_some) {
                is_place.map(|at| at.map_or(0.0, |at| row[at]))
            } else {
                [0, 1].map(|at| if at < row.len() { unit(row, at) } else { 0.0 })
            };
            sample.load = if forces.iter().any(Option::is_some) {
                forces.map(|at| at.map_or(0.0, |at| row[at]))
            } else {
                [1.0, 0.0, 0.0]
            };
        }
    }

    /// A label that goes next to nowhere in a later recording whose channels go as far as here: it is stuck, or in another unit.
    pub(in crate::diagnosis) fn unused_label(&self, later: &Self) -> Option<usize> {
        let range = |values: &mut dyn Iterator<Item = f64>| {
            let [low, high] = extent(values.filter(|it| it.is_finite()));
            high - low
        };
        let of_label = |of: &Self, at: usize| range(&mut of.inputs.iter().map(|row| row[at]));
        let channels = self.observations.readings.iter().zip(&later.observations.readings);
        let goes_as_far = |(before, after): (&Vec<f64>, &Vec<f64>)| {
            range(&mut after.iter().copied()) > AS_FAR * range(&mut before.iter().copied())
        };
        let far = channels.filter(|pair| goes_as_far(*pair)).count();
        let is_narrow = |at: &usize| of_label(later, *at) < NARROW * of_label(self, *at);
        // Where other labels vary they may be why.
        let narrow: Vec<usize> = (0..self.inputs.first().map_or(0, Vec::len)).filter(is_narrow).collect();
        let is_complete = narrow.len() == self.inputs.first().map_or(0, Vec::len);
        narrow.first().copied().filter(|_| is_complete && 2 * far > self.observations.readings.len())
    }

    /// Rows that share their errors: those of one location and session, or of one press of a series, or of a part of one without presses;
    /// and how many there are, such a series counted once.
    fn clusters(&self, columns: &Columns) -> (Vec<usize>, usize) {
        let places: Vec<usize> = ["x_mm", "y_mm"].iter().filter_map(|name| columns.input(name)).collect();
        let steps = |mm: f64| libm::round(mm / LOCATION_MM) as i64;
        let (presses, cut) = self.presses();
        let key = |(row, sample): (usize, &Sample)| match presses[row] {
            Some((trial, press)) => (0, [trial as i64, press as i64]),
            None if places.is_empty() => (1, [row as i64, 0]),
            None => {
                let place = |at: usize| places.get(at).map_or(0, |at| steps(self.inputs[row][*at]));
                (2 + sample.session, [place(0), place(1)])
            }
        };
        let keys: Vec<(usize, [i64; 2])> = self.observations.samples.iter().enumerate().map(key).collect();
        let mut sorted = keys.clone();
        sorted.sort_unstable();
        sorted.dedup();
        let clusters = keys.iter().map(|key| sorted.partition_point(|it| it < key)).collect();
        (clusters, sorted.len() - cut * (PARTS - 1))
    }

    /// For each row of a series, its trial and its press there; and how many series are cut into parts for want of presses.
    fn presses(&self) -> (Vec<Option<(usize, usize)>>, usize) {
        let samples = &self.observations.samples;
        let (mut presses, mut cut) = (vec![None; samples.len()], 0);
        let mut begin = 0;
        while begin < samples.len() {
            let trial = samples[begin].trial;
            let length = samples[begin..].iter().take_while(|sample| sample.trial == trial).count();
            if let Some(trial) = trial {
                let (pressed, is_cut) = pressed(&self.inputs[begin..begin + length]);
                cut += usize::from(is_cut);
                presses
                    .iter_mut()
                    .skip(begin)
                    .zip(pressed)
                    .for_each(|(to, press)| *to = Some((trial, press)));
            }
            begin += length;
        }
        (presses, cut)
    }
}

/// The number of its press for each row of a series: another begins where what varies most has come back. Or that of its part, and true.
fn pressed(rows: &[Vec<f64>]) -> (Vec<usize>, bool) {
    let inputs = rows.first().map_or(0, Vec::len);
    // How often it goes through the middle of its range tells which label is pressed by.
    let runs = |at: usize| {
        let of = || rows.iter().map(|row| row[at]);
        let (low, high) = (of().fold(f64::INFINITY, f64::min), of().fold(f64::NEG_INFINITY, f64::max));
        let (mut is_up, mut press) = (false, 0);
        let number = |value: f64| {
            let part = if high > low { (value - low) / (high - low) } else { 0.0 };
            if is_up && part < PRESSED[0] {
                (is_up, press) = (false, press + 1);
            } else if part > PRESSED[1] {
                is_up = true;
            }
            press
        };
        of().map(number).collect::<Vec<usize>>()
    };
    let all = (0..inputs).map(runs);
    let most = all.max_by_key(|runs| runs.last().copied().unwrap_or(0)).unwrap_or_default();
    if most.last().is_some_and(|last| *last >= PRESSES_MIN) || rows.len() < SERIES_ROWS * PARTS {
        return (most, false);
    }
    ((0..rows.len()).map(|row| row * PARTS / rows.len()).collect(), true)
}

/// A label's numbers, without codes for missing ones.
fn label(sheet: &Sheet, name: &str) -> Vec<f64> {
    let mut numbers = sheet.numbers(name).unwrap_or_default().to_vec();
    if name == "scale_g" {
        let negative = || numbers.iter().copied().filter(|number| *number < 0.0);
        let code = negative().next().filter(|first| negative().all(|number| number == *first));
        if let Some(code) = code.filter(|_| negative().count() as f64 > CODE_SHARE * numbers.len() as f64) {
            numbers.iter_mut().filter(|number| **number == code).for_each(|number| *number = f64::NAN);
        }
    }
    numbers
}

/// For each row its time series. Rows without trials are one if they follow each other fast enough, or their labels go on.
fn trials(sheet: &Sheet, columns: &Columns, labels: &[Vec<f64>]) -> Vec<Option<usize>> {
    if let Some(texts) = columns.texts(sheet, "trial") {
        return numbered(texts);
    }
    let t_s = columns.numbers(sheet, "t_s").unwrap_or_default();
    let step = median(t_s.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| step.is_finite()));
    let goes_on = |label: &Vec<f64>| {
        let pairs = label.iter().zip(label.iter().skip(1));
        let (one, next): (Vec<f64>, Vec<f64>) =
            pairs.filter(|(one, next)| one.is_finite() && next.is_finite()).unzip();
        correlation(&one, &next) > DRIVEN
    };
    let is_series = t_s.len() >= SERIES_ROWS
        && step.is_some_and(|step| step > 0.0 && (step < SERIES_STEP_S || labels.iter().all(goes_on)));
    vec![is_series.then_some(0); sheet.rows()]
}

/// The number of each text among all, by the order in which they come; none where there is none.
fn numbered(texts: &[String]) -> Vec<Option<usize>> {
    let mut known: std::collections::BTreeMap<&str, usize> = std::collections::BTreeMap::new();
    let mut numbers = Vec::new();
    for text in texts {
        let next = known.len();
        numbers.push((!text.is_empty()).then(|| *known.entry(text.as_str()).or_insert(next)));
    }
    numbers
}
