//! What was meant when: a table `begin_s,end_s,meant` that people write.

use std::borrow::Cow;
use std::fmt;

use super::vocabulary::{NONE, Vocabulary};
use tactpad_core::pipeline::mapping::profile::{Binding, Profile};
use tactpad_core::tables::measured::ending::OpenEnd;
use tactpad_core::tables::measured::error::{Fault, ReadError};
use tactpad_core::tables::measured::rows::Rows;
use tactpad_core::toml_text::diag::quoted;

/// The table's first line.
pub const HEADER: &str = "begin_s,end_s,meant";

/// A label more than this long after the recording's begin is a mistake: a day.
const S_MAX: f64 = 86_400.0;

/// A time in which something was meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Label {
    /// It begins, counted from the recording's first sample by the pad's clock,
    pub begin_us: u64,
    /// and ends.
    pub end_us: u64,
    /// Number of the class that was meant.
    pub class: usize,
}

/// Class of a label.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Class {
    /// Its name for people.
    pub name: String,
    /// What should come down; nothing for `none`.
    pub controls: Vec<Binding>,
}

/// Labels in order of time, and what they can mean. The last class is `none`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Labels {
    labels: Vec<Label>,
    classes: Vec<Class>,
    open_end: Option<OpenEnd>,
}

/// Why a table of labels cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LabelsError {
    /// The line that is wrong, from 1.
    pub line: usize,
    /// What is wrong with it, and what to write.
    pub what: String,
}

impl fmt::Display for LabelsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.line, self.what)
    }
}

impl Labels {
    /// Reads a table for a profile.
    ///
    /// # Errors
    /// Says what is wrong with the first line that cannot be used.
    pub fn read(text: &str, profile: &Profile) -> Result<Self, LabelsError> {
        let vocabulary = Vocabulary::of(profile);
        let refused = |error: ReadError| LabelsError { line: error.line, what: error.fault.to_string() };
        let other_header =
            |header: &str| Fault::Row(format!("the first line must be {HEADER}, not {}", quoted(header)));
        let mut rows = Rows::begin(text.as_bytes(), other_header("")).map_err(refused)?;
        let header = rows.names().join(",");
        if header != HEADER {
            return Err(refused(rows.error(other_header(&header))));
        }
        let mut meant: Vec<(usize, [u64; 2], Vec<Binding>)> = Vec::new();
        let read = rows.each(|line, cells| {
            let (times_us, controls) = read_row(cells, &vocabulary).map_err(Fault::Row)?;
            meant.push((line, times_us, controls));
            Ok(())
        });
        let open_end = read.map_err(refused)?;
        if meant.is_empty() {
            return Err(LabelsError {
                line: 2,
                what: "the table has no labels: write a line for each press".into(),
            });
        }
        meant.sort_by_key(|(_, times_us, _)| *times_us);
        for pair in meant.windows(2) {
            if let [(before, [_, end_us], _), (line, [begin_us, _], _)] = pair
                && begin_us < end_us
            {
                let what = format!("it begins before that of line {before} ends: no two may overlap");
                return Err(LabelsError { line: *line, what });
            }
        }
        let meant = meant.into_iter().map(|(_, times_us, controls)| (times_us, controls)).collect();
        Ok(Self { open_end, ..Self::new(&vocabulary, meant) })
    }

    fn new(vocabulary: &Vocabulary, meant: Vec<([u64; 2], Vec<Binding>)>) -> Self {
        let mut classes: Vec<Vec<Binding>> = Vec::new();
        for (_, controls) in meant.iter().filter(|(_, controls)| !controls.is_empty()) {
            if !classes.contains(controls) {
                classes.push(controls.clone());
            }
        }
        classes.sort_by_key(|controls| {
            (controls.len(), controls.iter().map(|it| (it.device, it.code, it.value)).collect::<Vec<_>>())
        });
        classes.push(Vec::new());
        let class =
            |controls: &Vec<Binding>| classes.iter().position(|it| it == controls).unwrap_or_default();
        let labels = meant.iter().map(|([begin_us, end_us], controls)| Label {
            begin_us: *begin_us,
            end_us: *end_us,
            class: class(controls),
        });
        Self {
            labels: labels.collect(),
            classes: classes
                .into_iter()
                .map(|controls| Class { name: vocabulary.name(&controls), controls })
                .collect(),
            open_end: None,
        }
    }

    /// In order of time; no two overlap.
    pub fn labels(&self) -> &[Label] {
        &self.labels
    }

    /// What can be meant; the last is `none`.
    pub fn classes(&self) -> &[Class] {
        &self.classes
    }

    /// The table's last line, if it may be cut off.
    pub const fn open_end(&self) -> Option<&OpenEnd> {
        self.open_end.as_ref()
    }

    /// Those that begin from one time on and before another.
    #[must_use]
    pub fn between(&self, from_us: u64, to_us: u64) -> Self {
        let is_in = |label: &&Label| (from_us..to_us).contains(&label.begin_us);
        let labels = self.labels.iter().filter(is_in).copied().collect();
        Self { labels, classes: self.classes.clone(), open_end: None }
    }
}

fn read_row(cells: &[Cow<'_, str>], vocabulary: &Vocabulary) -> Result<([u64; 2], Vec<Binding>), String> {
    let [begin, end, meant] = cells else {
        return Err(format!("write {HEADER}, as 12.5,13.2,left"));
    };
    let meant = meant.trim();
    let (begin_us, end_us) = (microseconds("begin_s", begin.trim())?, microseconds("end_s", end.trim())?);
    if begin_us >= end_us {
        return Err(format!("it ends at {end} s, which is not after its begin at {begin} s"));
    }
    if meant.is_empty() {
        return Err(format!("it does not say what was meant: write a control's name, or {NONE}"));
    }
    Ok(([begin_us, end_us], vocabulary.meant(meant)?))
}

fn microseconds(name: &str, cell: &str) -> Result<u64, String> {
    let seconds = cell.parse::<f64>().ok().filter(|seconds| (0.0..=S_MAX).contains(seconds));
    let seconds = seconds.ok_or_else(|| {
        format!("{name} is {}; write seconds since the recording's first sample, as 12.5", quoted(cell))
    })?;
    Ok((seconds * 1e6).round() as u64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_core::pipeline::mapping::read::check::{OutputChoice, read};
    use tactpad_core::pipeline::mapping::read::shipped;

    fn labels(lines: &str) -> Result<Labels, String> {
        let profile = read(shipped::text("super-mario").unwrap(), OutputChoice::AsWritten).0.unwrap();
        Labels::read(lines, &profile).map_err(|why| why.to_string())
    }

    #[test]
    fn people_write_names_as_they_like() {
        let table = "\u{feff}begin_s, end_s, meant\r\n\n3,4.5,Right\n1,2,\"btn_a\"\n5,6,right + button 1 tap\n\
                     6,7,ABS_HAT0X++BTN_SOUTH\n7,8,None\n8,9,ABS_HAT0X+\n9,10,button  1  hold\n10,11,east\n";
        let read = labels(table).unwrap();
        let names: Vec<_> =
            read.labels().iter().map(|label| read.classes()[label.class].name.as_str()).collect();
        let both = "BTN_SOUTH+right";
        assert_eq!(names, ["BTN_SOUTH", "right", both, both, "none", "right", "BTN_EAST", "BTN_EAST"]);
        assert_eq!((read.labels()[0].begin_us, read.labels()[1].end_us), (1_000_000, 4_500_000));
        assert_eq!(read.classes().last().unwrap().controls, []);
    }

    #[test]
    fn what_cannot_be_used_is_said_with_its_line() {
        for (lines, told) in [
            ("", "1: the first line must be begin_s,end_s,meant"),
            ("begin,end,meant\n", "1: the first line must be begin_s,end_s,meant"),
            ("begin_s,end_s,meant\n", "2: the table has no labels"),
            ("begin_s,end_s,meant\n1,2\n", "2: 2 values where the header names 3 columns"),
            ("begin_s,end_s,meant\n1,2,up\n2,1,up\n", "3: it ends at 1 s, which is not after"),
            ("begin_s,end_s,meant\nx,2,up\n", "2: begin_s is \"x\"; write seconds"),
            ("begin_s,end_s,meant\n1,inf,up\n", "2: end_s is \"inf\"; write seconds"),
            ("begin_s,end_s,meant\n1,2,\n", "2: it does not say what was meant"),
            (
                "begin_s,end_s,meant\n1,2,rigth\n",
                "2: the profile has nothing that is called \"rigth\": did you mean \"right\"?",
            ),
            ("begin_s,end_s,meant\n1,2,button 2\n", "2: the profile has nothing that is called \"button 2\""),
            ("begin_s,end_s,meant\n1,2,up\n5,6,up\n1.5,3,up\n", "4: it begins before that of line 2 ends"),
        ] {
            let why = labels(lines).unwrap_err();
            assert!(why.starts_with(told), "{why}");
        }
    }
}
