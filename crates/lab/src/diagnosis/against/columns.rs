//! Which columns of two tables are labels and which are channels.

use super::unfit::ComparisonError;
use crate::effect::Effect;
use tactpad_core::tables::measured::sheet::Sheet;
use tactpad_inference::regression::Group;

/// Labels by which channels are predicted: those of a group share one length.
const PLACES: [&[&str]; 2] = [&["x_mm", "y_mm"], &["z_mm"]];
const LOADS: [&[&str]; 3] = [&["fx_n", "fy_n", "fz_n"], &["mx_nm", "my_nm", "mz_nm"], &["scale_g"]];
/// Labels that say when and how.
const CIRCUMSTANCES: [&str; 6] = ["t_s", "label_t_s", "temp_c", "cycle", "trial", "session"];
/// What plans write beside them.
pub(in crate::diagnosis) const PLANNED: [&str; 2] = ["dwell_s", "approach"];

/// What varies by less than this part of itself stays the same.
const LAST_DIGITS: f64 = 1e-5;

/// Selection of columns; empty: whatever both tables have.
#[derive(Clone, Copy, Debug, Default)]
pub struct ColumnSelection<'a> {
    /// Names of the labels.
    pub labels: &'a [String],
    /// Names of the channels.
    pub channels: &'a [String],
    /// Effects that are not asked for.
    pub without: &'a [Effect],
}

impl ColumnSelection<'_> {
    pub(in crate::diagnosis) fn asks_for(&self, effect: Effect) -> bool {
        self.without.iter().all(|other| *other != effect)
    }
}

/// The columns that both tables have.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::diagnosis) struct Columns {
    /// Labels that the channels are predicted by: they vary in the earlier table.
    pub(in crate::diagnosis) inputs: Vec<String>,
    /// The inputs' groups.
    pub(in crate::diagnosis) groups: Vec<Group>,
    pub(in crate::diagnosis) channels: Vec<String>,
    /// Circumstances that may be used.
    circumstances: Vec<&'static str>,
}

impl Columns {
    pub(super) fn of(
        earlier: &Sheet,
        later: &Sheet,
        asked: &ColumnSelection<'_>,
    ) -> Result<Self, ComparisonError> {
        for name in asked.labels.iter().chain(asked.channels) {
            let is_text = ["trial", "session"].contains(&name.as_str());
            for (sheet, which) in [(earlier, "the earlier recording"), (later, "the measured table")] {
                if !sheet.has(name) {
                    return Err(ComparisonError::Missing { name: name.clone(), which });
                }
                if !is_text && sheet.numbers(name).is_none() {
                    return Err(ComparisonError::NoNumbers { name: name.clone(), which });
                }
            }
        }
        let is_label = |name: &str| {
            if asked.labels.is_empty() { is_known(name) } else { asked.labels.iter().any(|it| it == name) }
        };
        let both: Vec<&str> = earlier.numeric().filter(|name| later.numbers(name).is_some()).collect();
        let channels: Vec<String> = if asked.channels.is_empty() {
            let is_free = |name: &&&str| !is_label(name) && !is_known(name) && !PLANNED.contains(name);
            both.iter()
                .filter(is_free)
                .filter(|name| varies(earlier, name))
                .map(|name| (*name).to_owned())
                .collect()
        } else {
            asked.channels.to_vec()
        };
        if channels.is_empty() {
            return Err(ComparisonError::Channels);
        }
        let is_input = |name: &&str| {
            both.contains(name)
                && is_label(name)
                && !channels.iter().any(|it| it == name)
                && varies(earlier, name)
        };
        let mut columns = Self {
            inputs: Vec::new(),
            groups: Vec::new(),
            channels: channels.clone(),
            circumstances: Vec::new(),
        };
        for (names, is_load) in PLACES.iter().map(|it| (it, false)).chain(LOADS.iter().map(|it| (it, true))) {
            columns.add(names.iter().copied().filter(is_input), is_load);
        }
        let is_other = |name: &&str| !is_known(name) && is_input(name);
        both.iter().copied().filter(is_other).for_each(|name| columns.add([name].into_iter(), false));
        columns.circumstances = CIRCUMSTANCES.into_iter().filter(|name| is_label(name)).collect();
        if !both.iter().any(|name| is_label(name) && !CIRCUMSTANCES.contains(name)) {
            return Err(match asked.labels {
                [] => ComparisonError::Labels,
                labels => ComparisonError::Circumstances(labels.join(", ")),
            });
        }
        if columns.inputs.is_empty() { Err(ComparisonError::Constant) } else { Ok(columns) }
    }

    /// These channels, and what varies of these labels beside them in the measured table. All circumstances may be used.
    pub(in crate::diagnosis) fn beside(channels: Vec<String>, measured: &Sheet, labels: &[String]) -> Self {
        let is_input = |name: &&str| !channels.iter().any(|it| it == name) && varies(measured, name);
        let mut columns = Self {
            inputs: Vec::new(),
            groups: Vec::new(),
            channels: channels.clone(),
            circumstances: CIRCUMSTANCES.to_vec(),
        };
        for (names, is_load) in PLACES.iter().map(|it| (it, false)).chain(LOADS.iter().map(|it| (it, true))) {
            columns.add(names.iter().copied().filter(is_input), is_load);
        }
        let others = labels.iter().map(String::as_str).filter(|name| !is_known(name)).filter(is_input);
        others.for_each(|name| columns.add([name].into_iter(), false));
        columns
    }

    fn add<'n>(&mut self, names: impl Iterator<Item = &'n str>, is_load: bool) {
        let first = self.inputs.len();
        self.inputs.extend(names.map(str::to_owned));
        if self.inputs.len() > first {
            self.groups.push(Group { inputs: (first..self.inputs.len()).collect(), is_load });
        }
    }

    /// The place of an input among the inputs.
    pub(in crate::diagnosis) fn input(&self, name: &str) -> Option<usize> {
        self.inputs.iter().position(|input| input == name)
    }

    /// The numbers of a circumstance.
    pub(super) fn numbers<'s>(&self, sheet: &'s Sheet, name: &str) -> Option<&'s [f64]> {
        sheet.numbers(name).filter(|_| self.circumstances.contains(&name))
    }

    /// The texts of a circumstance.
    pub(super) fn texts<'s>(&self, sheet: &'s Sheet, name: &str) -> Option<&'s [String]> {
        sheet.texts(name).filter(|_| self.circumstances.contains(&name))
    }

    /// Whether a load is written.
    pub(super) fn has_loads(&self) -> bool {
        self.groups.iter().any(|group| group.is_load)
    }
}

/// Whether a column of this name is a label, or says when and how.
pub(in crate::diagnosis) fn is_known(name: &str) -> bool {
    CIRCUMSTANCES.contains(&name) || PLACES.iter().chain(&LOADS).any(|names| names.contains(&name))
}

/// Whether a column varies by more than its last digits.
pub(in crate::diagnosis) fn varies(sheet: &Sheet, name: &str) -> bool {
    let numbers =
        || sheet.numbers(name).unwrap_or_default().iter().copied().filter(|number| number.is_finite());
    let [low, high] = extent(numbers());
    high - low > LAST_DIGITS * high.abs().max(low.abs())
}

/// The least and the greatest value.
pub(in crate::diagnosis) fn extent(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
}
