//! Typed reads from a table of the text; every failed read is reported at its place.

use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;

use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use super::diag::{Findings, quoted, shortened};
use crate::toml_text::spelling;

/// A value and the byte offset where it is written (or, for a default, where the table starts that lacks it).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Placed<T> {
    pub(crate) value: T,
    pub(crate) at: usize,
}

/// The allowed values of a number, ends included, and what an absent key means.
#[derive(Clone, Copy)]
pub(crate) struct Bounds<T> {
    pub(crate) low: T,
    pub(crate) high: T,
    pub(crate) default: T,
}

/// Numbers with a fraction: what a profile counts in `f32` and a device in `f64`.
pub(crate) trait Real: Copy + PartialOrd + fmt::Display + FromStr {
    /// Whether it is neither infinite nor NaN.
    fn is_finite(self) -> bool;
}

impl Real for f32 {
    fn is_finite(self) -> bool {
        self.is_finite()
    }
}

impl Real for f64 {
    fn is_finite(self) -> bool {
        self.is_finite()
    }
}

/// The longest name for people.
const NAME_CHARS_MAX: usize = 64;

/// One table of the text.
pub(crate) struct Section<'t> {
    /// How messages name it, as `[dpad]`.
    pub(crate) title: String,
    /// Byte offset of its header.
    pub(crate) at: usize,
    table: &'t DeTable<'t>,
    known: Vec<&'static str>,
    /// Those of `known` that keys which are not among them were probably meant to be.
    misspelt: Vec<&'static str>,
}

impl<'t> Section<'t> {
    /// The whole text, which messages call `title`; every key that is not in `known` is reported.
    pub(crate) fn root(
        tree: &'t Spanned<DeTable<'t>>,
        title: &str,
        known: &[&'static str],
        findings: &mut Findings<'_>,
    ) -> Self {
        Self::closed(title.to_owned(), tree.span().start, tree.get_ref(), known, findings)
    }

    fn get(&self, key: &str) -> Option<&'t Spanned<DeValue<'t>>> {
        self.table.get(key)
    }

    /// Whether nothing stands in it.
    pub(crate) fn is_empty(&self) -> bool {
        self.table.is_empty()
    }

    /// The byte offset of `key`'s value, if it is written.
    pub(crate) fn place_of(&self, key: &str) -> Option<usize> {
        self.get(key).map(|value| value.span().start)
    }

    /// Whether `key` is this text; says nothing about another one.
    pub(crate) fn word_is(&self, key: &str, word: &str) -> bool {
        self.get(key).and_then(|value| value.get_ref().as_str()) == Some(word)
    }

    /// A table whose keys are checked: those that are not in `known` are reported.
    fn closed(
        title: String,
        at: usize,
        table: &'t DeTable<'t>,
        known: &[&'static str],
        findings: &mut Findings<'_>,
    ) -> Self {
        let mut section = Self { title, at, table, known: known.to_vec(), misspelt: Vec::new() };
        for key in table.keys().filter(|key| !known.contains(&key.get_ref().as_ref())) {
            section.refuse(key, findings);
            // A name is compared with all known ones, so a table full of strangers must not be.
            if findings.is_full() {
                break;
            }
        }
        section
    }

    fn refuse(&mut self, key: &Spanned<DeString<'_>>, findings: &mut Findings<'_>) {
        let name = key.get_ref().as_ref();
        let near = spelling::nearest(name, self.known.iter().copied());
        self.misspelt.extend(near);
        let help = near.map_or_else(
            || format!("known here: {}", self.known.join(", ")),
            |word| format!("did you mean \"{word}\"?"),
        );
        findings.misplaced(key.span().start, format!("unknown key {} in {}", quoted(name), self.title), help);
    }

    /// Reports it if `key` is not there; `help` says what to write. A misspelt one is reported already.
    pub(crate) fn require(&self, key: &'static str, help: &str, findings: &mut Findings<'_>) {
        if self.get(key).is_none() && !self.misspelt.contains(&key) {
            findings.misplaced(self.at, format!("{} lacks \"{key}\"", self.title), help);
        }
    }

    /// The number under `key`, whatever it is; `None` where it is absent, and where it is no number (which is
    /// reported).
    pub(crate) fn real<T: Real>(&self, key: &str, findings: &mut Findings<'_>) -> Option<Placed<T>> {
        let value = self.get(key)?;
        let number = as_real(value.get_ref()).or_else(|| wrong_type(key, value, "a number", findings))?;
        Some(Placed { value: number, at: value.span().start })
    }

    /// The number under `key`; the default where there is none, `None` (and a finding) where it is unusable.
    pub(crate) fn number<T: Real>(
        &self,
        key: &str,
        bounds: Bounds<T>,
        findings: &mut Findings<'_>,
    ) -> Option<Placed<T>> {
        if self.get(key).is_none() {
            return Some(Placed { value: bounds.default, at: self.at });
        }
        let Placed { value: number, at } = self.real::<T>(key, findings)?;
        let Bounds { low, high, .. } = bounds;
        if (low..=high).contains(&number) {
            return Some(Placed { value: number, at });
        }
        let message = if number.is_finite() {
            format!("\"{key}\" is {number}; it must be {low} to {high}")
        } else {
            format!("\"{key}\" must be {low} to {high}")
        };
        findings.error(at, message, "");
        None
    }

    /// The `count` numbers in the list under `key`; `None` where it is absent, and where it is no such list
    /// (reported).
    pub(crate) fn reals<T: Real>(
        &self,
        key: &str,
        count: usize,
        findings: &mut Findings<'_>,
    ) -> Option<Vec<Placed<T>>> {
        let wanted = format!("a list of {count} numbers");
        self.list(key, count..=count, &wanted, as_real, findings)
    }

    /// The same, or the one number that stands there instead of a list.
    pub(crate) fn reals_or_one<T: Real>(
        &self,
        key: &str,
        count: usize,
        findings: &mut Findings<'_>,
    ) -> Option<Vec<Placed<T>>> {
        let value = self.get(key)?;
        if let Some(number) = as_real(value.get_ref()) {
            return Some(vec![Placed { value: number, at: value.span().start }]);
        }
        let wanted = format!("a number or a list of {count}");
        self.list(key, count..=count, &wanted, as_real, findings)
    }

    /// The `count` texts in the list under `key`; `None` where it is absent, and where it is no such list
    /// (reported).
    pub(crate) fn texts(
        &self,
        key: &str,
        count: usize,
        findings: &mut Findings<'_>,
    ) -> Option<Vec<Placed<&'t str>>> {
        let wanted = format!("a list of {count} texts in quotation marks");
        self.list(key, count..=count, &wanted, |value| value.as_str(), findings)
    }

    /// The texts in the list under `key`, one at least and no more than `most`; `None` where it is absent, and where it is no such list
    /// (reported).
    pub(crate) fn some_texts(
        &self,
        key: &str,
        most: usize,
        findings: &mut Findings<'_>,
    ) -> Option<Vec<Placed<&'t str>>> {
        let wanted = format!("a list of 1 to {most} texts in quotation marks");
        self.list(key, 1..=most, &wanted, |value| value.as_str(), findings)
    }

    /// What the words in the list under `key` stand for, which are one at least and no more than there are `words`;
    /// `None` where it is absent, and where it is no such list or has another word (reported).
    pub(crate) fn words<T: Copy>(
        &self,
        key: &str,
        words: &[(&'static str, T)],
        findings: &mut Findings<'_>,
    ) -> Option<Vec<Placed<T>>> {
        let most = words.len();
        let wanted = format!("a list of 1 to {most} texts in quotation marks");
        let texts = self.list(key, 1..=most, &wanted, |value| value.as_str(), findings)?;
        texts.into_iter().map(|text| meant(key, text, words, findings)).collect()
    }

    /// The list under `key`, which must be as `wanted` says; `item` reads one of its values.
    fn list<T>(
        &self,
        key: &str,
        count: RangeInclusive<usize>,
        wanted: &str,
        item: impl Fn(&'t DeValue<'t>) -> Option<T>,
        findings: &mut Findings<'_>,
    ) -> Option<Vec<Placed<T>>> {
        let value = self.get(key)?;
        let list = value.get_ref().as_array().or_else(|| wrong_type(key, value, wanted, findings))?;
        let read = |value: &'t Spanned<DeValue<'t>>| {
            Some(Placed { value: item(value.get_ref())?, at: value.span().start })
        };
        let mut items = Vec::new();
        for value in list.iter().take(*count.end()) {
            items.push(read(value).or_else(|| wrong_type(key, value, wanted, findings))?);
        }
        if count.contains(&list.len()) {
            return Some(items);
        }
        findings.error(value.span().start, format!("\"{key}\" must be {wanted}, not of {}", list.len()), "");
        None
    }

    /// Whether the flag under `key` is set; `None` where it is absent, and where it is no flag (reported).
    pub(crate) fn flag(&self, key: &str, findings: &mut Findings<'_>) -> Option<bool> {
        let value = self.get(key)?;
        value.get_ref().as_bool().or_else(|| wrong_type(key, value, "true or false", findings))
    }

    /// The whole number under `key`; the default where there is none, `None` (and a finding) where it is
    /// unusable.
    pub(crate) fn whole(
        &self,
        key: &str,
        bounds: Bounds<u32>,
        findings: &mut Findings<'_>,
    ) -> Option<Placed<u32>> {
        let Some(value) = self.get(key) else { return Some(Placed { value: bounds.default, at: self.at }) };
        let at = value.span().start;
        let Some(number) = value.get_ref().as_integer() else {
            return wrong_type(key, value, "a whole number", findings);
        };
        let Bounds { low, high, .. } = bounds;
        match u32::from_str_radix(number.as_str(), number.radix()) {
            Ok(number) if (low..=high).contains(&number) => Some(Placed { value: number, at }),
            _ => {
                let allowed = if low == high { format!("{low}") } else { format!("{low} to {high}") };
                let number = shortened(number.as_str());
                findings.error(at, format!("\"{key}\" is {number}; it must be {allowed}"), "");
                None
            }
        }
    }

    /// Reports it if the first number is not less than the second, at whichever of them is written.
    pub(crate) fn require_less<T: PartialOrd + fmt::Display>(
        &self,
        (low_key, low): (&str, Option<Placed<T>>),
        (high_key, high): (&str, Option<Placed<T>>),
        findings: &mut Findings<'_>,
    ) {
        let (Some(low), Some(high)) = (low, high) else { return };
        if low.value >= high.value {
            let at = if self.place_of(low_key).is_some() { low.at } else { high.at };
            let message =
                format!("\"{low_key}\" ({}) must be less than \"{high_key}\" ({})", low.value, high.value);
            findings.error(at, message, "");
        }
    }

    /// The text under `key`; `None` where it is absent, and where it is no text (which is reported).
    pub(crate) fn text(&self, key: &str, findings: &mut Findings<'_>) -> Option<Placed<&'t str>> {
        let value = self.get(key)?;
        match value.get_ref().as_str() {
            Some(text) => Some(Placed { value: text, at: value.span().start }),
            None => wrong_type(key, value, "text in quotation marks", findings),
        }
    }

    /// The name for people under `key`; `None` where it is absent, and where it is no name (reported).
    pub(crate) fn name(&self, key: &str, findings: &mut Findings<'_>) -> Option<&'t str> {
        let Placed { value: name, at } = self.text(key, findings)?;
        let length = name.chars().count();
        if name.trim().is_empty() || length > NAME_CHARS_MAX || name.chars().any(char::is_control) {
            findings.error(at, format!("\"{key}\" must be one line of 1 to {NAME_CHARS_MAX} characters"), "");
            return None;
        }
        Some(name)
    }

    /// What the word under `key` stands for; `None` where it is absent, and where it is none of `words`
    /// (reported).
    pub(crate) fn word<T: Copy>(
        &self,
        key: &str,
        words: &[(&'static str, T)],
        findings: &mut Findings<'_>,
    ) -> Option<Placed<T>> {
        let text = self.text(key, findings)?;
        meant(key, text, words, findings)
    }

    /// The table under `key`, named `title`, with its `known` keys; `None` where it is absent, and where it
    /// is no table (reported).
    pub(crate) fn table(
        &self,
        key: &str,
        title: String,
        known: &[&'static str],
        findings: &mut Findings<'_>,
    ) -> Option<Self> {
        let value = self.get(key)?;
        let table = value.get_ref().as_table().or_else(|| wrong_type(key, value, "a table", findings))?;
        Some(Self::closed(title, value.span().start, table, known, findings))
    }

    /// The table or the tables under `key`, whatever stands in them; nothing is reported.
    pub(crate) fn inner(&self, key: &str) -> Vec<Self> {
        let view = |value: &'t Spanned<DeValue<'t>>| {
            let table = value.get_ref().as_table()?;
            let (known, misspelt) = (Vec::new(), Vec::new());
            Some(Self { title: key.to_owned(), at: value.span().start, table, known, misspelt })
        };
        let Some(value) = self.get(key) else { return Vec::new() };
        match value.get_ref().as_array() {
            Some(all) => all.iter().map(view).collect::<Option<_>>().unwrap_or_default(),
            None => view(value).into_iter().collect(),
        }
    }

    /// The first tables `[[key]]` in the text's order, at most `limit`, each named after `key` and its number
    /// from 1; others are reported.
    pub(crate) fn tables(
        &self,
        key: &str,
        known: &[&'static str],
        limit: usize,
        findings: &mut Findings<'_>,
    ) -> Vec<Self> {
        let Some(value) = self.get(key) else { return Vec::new() };
        let wanted = format!("a list of tables, each headed [[{key}]]");
        let Some(list) = value.get_ref().as_array().or_else(|| wrong_type(key, value, &wanted, findings))
        else {
            return Vec::new();
        };
        let mut tables = Vec::new();
        for (number, entry) in (1..).zip(list.iter().take(limit)) {
            let (title, at) = (format!("{key} {number}"), entry.span().start);
            let table = entry.get_ref().as_table().or_else(|| wrong_type(key, entry, &wanted, findings));
            tables.extend(table.map(|table| Self::closed(title, at, table, known, findings)));
        }
        tables
    }
}

/// What a text under `key` stands for; `None` (and a finding) if it is none of `words`.
fn meant<T: Copy>(
    key: &str,
    Placed { value: text, at }: Placed<&str>,
    words: &[(&'static str, T)],
    findings: &mut Findings<'_>,
) -> Option<Placed<T>> {
    if let Some((_, value)) = words.iter().find(|(word, _)| *word == text) {
        return Some(Placed { value: *value, at });
    }
    let known = words.iter().map(|(word, _)| *word);
    let help = spelling::nearest(text, known.clone()).map_or_else(
        || {
            format!(
                "write one of: {}",
                known.map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(", ")
            )
        },
        |word| format!("did you mean \"{word}\"?"),
    );
    findings.error(at, format!("\"{key}\" cannot be {}", quoted(text)), help);
    None
}

/// Integers count as numbers, too: nobody should have to write `2.0` for 2 N.
fn as_real<T: Real>(value: &DeValue<'_>) -> Option<T> {
    match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().parse().ok(),
        DeValue::Integer(integer) => {
            u64::from_str_radix(integer.as_str(), integer.radix()).ok()?.to_string().parse().ok()
        }
        _ => None,
    }
}

fn wrong_type<T>(
    key: &str,
    value: &Spanned<DeValue<'_>>,
    wanted: &str,
    findings: &mut Findings<'_>,
) -> Option<T> {
    let kind = match value.get_ref() {
        DeValue::String(_) => "text",
        DeValue::Integer(_) => "a whole number",
        DeValue::Float(_) => "a fraction",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    };
    findings.error(value.span().start, format!("\"{key}\" must be {wanted}, not {kind}"), "");
    None
}
