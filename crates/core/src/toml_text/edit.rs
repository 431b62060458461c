//! Changes of single values in a text that people wrote: comments, layout and everything else stay as they are.

use toml_edit::{DocumentMut, Item, Table as Written, TableLike, Value as WrittenValue};

/// The table that a key stands in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Table {
    /// The text itself.
    Root,
    /// `[name]`; it is made if there is none.
    Named(&'static str),
    /// One of the tables `[[name]]`, from 0; it must be there.
    Listed(&'static str, usize),
}

/// What a key says.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number with a decimal point.
    Real(f64),
    /// A whole number.
    Whole(i64),
    /// True or false.
    Flag(bool),
    /// Text.
    Text(String),
}

/// One change.
#[derive(Clone, Debug, PartialEq)]
pub struct Edit {
    /// Where the key stands.
    pub table: Table,
    /// The key.
    pub key: &'static str,
    /// What it says from now on; without a value the key goes.
    pub value: Option<Value>,
}

/// A step on the way to a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TablePathStep {
    /// Into the table of this key.
    Key(String),
    /// Into the table of this number in a list, from 0.
    Index(usize),
}

/// One change of a table that is found step by step.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// The way to the table; nothing for the text itself. A last key that is not there is made.
    pub table: Vec<TablePathStep>,
    /// The key.
    pub key: String,
    /// What it says from now on; without a value the key goes.
    pub value: Option<Value>,
}

/// Why a text cannot be changed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unedited {
    /// It is no TOML.
    Broken(String),
    /// It has no such table, or something else of that name.
    NoTable(String),
}

impl std::fmt::Display for Unedited {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Broken(why) => write!(f, "the text is no TOML: {why}"),
            Self::NoTable(name) => write!(f, "the text has no table {name}"),
        }
    }
}

/// The text with these changes, one after the other.
///
/// # Errors
/// It is no TOML, or a list has no such table.
pub fn edited(text: &str, edits: &[Edit]) -> Result<String, Unedited> {
    let mut document = parsed(text)?;
    for Edit { table, key, value } in edits {
        match value {
            Some(value) => set(open(document.as_table_mut(), *table)?, key, value),
            None if has(&document, *table) => {
                open(document.as_table_mut(), *table)?.remove(key);
            }
            None => {}
        }
    }
    Ok(document.to_string())
}

/// The text with these changes, one after the other.
///
/// # Errors
/// It is no TOML, or there is no such table.
pub fn changed(text: &str, changes: &[Change]) -> Result<String, Unedited> {
    let mut document = parsed(text)?;
    for Change { table, key, value } in changes {
        let (found, way) = follow(document.as_item_mut(), table)?;
        match value {
            Some(value) => set(opened(found, way, table.len() > 1)?, key, value),
            None => {
                if let Some(table) = way.is_empty().then(|| found.as_table_like_mut()).flatten() {
                    table.remove(key);
                }
            }
        }
    }
    Ok(document.to_string())
}

/// Goes as far as there is something; what is left of the way is one key at most.
fn follow<'i, 'w>(
    root: &'i mut Item,
    way: &'w [TablePathStep],
) -> Result<(&'i mut Item, &'w [TablePathStep]), Unedited> {
    let mut item = root;
    for (index, step) in way.iter().enumerate() {
        let rest = way.get(index..).unwrap_or_default();
        let is_last_key = matches!(rest, [TablePathStep::Key(_)]);
        let is_there = match step {
            TablePathStep::Key(key) => item.as_table_like().is_some_and(|table| table.contains_key(key)),
            TablePathStep::Index(index) => item.get(*index).is_some(),
        };
        if !is_there && is_last_key && item.is_table_like() {
            return Ok((item, rest));
        }
        let next = match step {
            TablePathStep::Key(key) => item.as_table_like_mut().and_then(|table| table.get_mut(key)),
            TablePathStep::Index(index) => item.get_mut(*index),
        };
        item = next.ok_or_else(|| no_table(way))?;
    }
    if item.is_table_like() { Ok((item, &[])) } else { Err(no_table(way)) }
}

/// The table itself; one that is not there is made: beside others with a line of its own, inside another one in its line.
fn opened<'i>(
    found: &'i mut Item,
    way: &[TablePathStep],
    is_inside: bool,
) -> Result<&'i mut dyn TableLike, Unedited> {
    let table = found.as_table_like_mut().ok_or_else(|| no_table(way))?;
    let [TablePathStep::Key(key)] = way else { return Ok(table) };
    let new = if is_inside { toml_edit::value(toml_edit::InlineTable::new()) } else { Item::Table(begun()) };
    table.entry(key).or_insert(new).as_table_like_mut().ok_or_else(|| no_table(way))
}

fn no_table(way: &[TablePathStep]) -> Unedited {
    let name = |step: &TablePathStep| match step {
        TablePathStep::Key(key) => key.clone(),
        TablePathStep::Index(index) => (index + 1).to_string(),
    };
    Unedited::NoTable(way.iter().map(name).collect::<Vec<_>>().join(" "))
}

/// What a key says, if it is written as one of these.
pub fn written(text: &str, table: Table, key: &str) -> Option<Value> {
    let mut document = parsed(text).ok()?;
    if !has(&document, table) {
        return None;
    }
    match open(document.as_table_mut(), table).ok()?.get(key)?.as_value()? {
        WrittenValue::Float(value) => Some(Value::Real(*value.value())),
        WrittenValue::Integer(value) => Some(Value::Whole(*value.value())),
        WrittenValue::Boolean(value) => Some(Value::Flag(*value.value())),
        WrittenValue::String(value) => Some(Value::Text(value.value().clone())),
        _ => None,
    }
}

fn parsed(text: &str) -> Result<DocumentMut, Unedited> {
    text.parse::<DocumentMut>().map_err(|error| Unedited::Broken(error.message().to_owned()))
}

/// Whether there is anything of the table's name.
fn has(document: &DocumentMut, table: Table) -> bool {
    match table {
        Table::Root => true,
        Table::Named(name) | Table::Listed(name, _) => document.contains_key(name),
    }
}

/// The table to change; a named one is made if there is none.
fn open(root: &mut Written, table: Table) -> Result<&mut dyn TableLike, Unedited> {
    match table {
        Table::Root => Ok(root),
        Table::Named(name) => {
            let item = root.entry(name).or_insert_with(|| Item::Table(begun()));
            item.as_table_like_mut().ok_or_else(|| Unedited::NoTable(format!("[{name}]")))
        }
        Table::Listed(name, index) => {
            let found = match root.get_mut(name) {
                Some(Item::ArrayOfTables(tables)) => {
                    tables.get_mut(index).map(|table| table as &mut dyn TableLike)
                }
                Some(Item::Value(WrittenValue::Array(tables))) => {
                    let table = tables.get_mut(index).and_then(WrittenValue::as_inline_table_mut);
                    table.map(|table| table as &mut dyn TableLike)
                }
                _ => None,
            };
            found.ok_or_else(|| Unedited::NoTable(format!("[[{name}]] {}", index + 1)))
        }
    }
}

/// A new table, with an empty line before it.
fn begun() -> Written {
    let mut table = Written::new();
    table.decor_mut().set_prefix("\n");
    table
}

/// Sets a key. What stands around an old value, as a comment behind it, stays.
fn set(table: &mut dyn TableLike, key: &str, value: &Value) {
    let mut new = match value {
        Value::Real(value) => WrittenValue::from(*value),
        Value::Whole(value) => WrittenValue::from(*value),
        Value::Flag(value) => WrittenValue::from(*value),
        Value::Text(value) => WrittenValue::from(value.as_str()),
    };
    match table.get_mut(key).and_then(Item::as_value_mut) {
        Some(old) => {
            *new.decor_mut() = old.decor().clone();
            *old = new;
        }
        None => {
            table.insert(key, Item::Value(new));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "\
# Mine.
name = \"x\"   # for people

[dpad]  # directions
rotation_deg = 0.0      # turn this
min_force_n=0.3

# The first one.
[[button]]
press_n = 2.0 # hard
tap = { gamepad = \"BTN_SOUTH\" }

[[button]]
press_n = 1
";

    fn real(table: Table, key: &'static str, value: f64) -> Edit {
        Edit { table, key, value: Some(Value::Real(value)) }
    }

    #[test]
    fn comments_and_layout_stay() {
        let edits = [
            real(Table::Named("dpad"), "rotation_deg", -20.0),
            real(Table::Named("dpad"), "hysteresis_mm", 2.5),
            real(Table::Listed("button", 0), "press_n", 0.35),
            real(Table::Listed("button", 1), "release_n", 0.2),
            real(Table::Root, "centre_x_mm", 5.0),
            Edit { table: Table::Named("access"), key: "slow_ms", value: Some(Value::Whole(100)) },
            Edit { table: Table::Named("dpad"), key: "min_force_n", value: None },
            Edit { table: Table::Named("gain"), key: "up", value: None },
        ];
        let wanted = "\
# Mine.
name = \"x\"   # for people
centre_x_mm = 5.0

[dpad]  # directions
rotation_deg = -20.0      # turn this
hysteresis_mm = 2.5

# The first one.
[[button]]
press_n = 0.35 # hard
tap = { gamepad = \"BTN_SOUTH\" }

[[button]]
press_n = 1
release_n = 0.2

[access]
slow_ms = 100
";
        assert_eq!(edited(TEXT, &edits).unwrap(), wanted);
        assert_eq!(edited(TEXT, &[]).unwrap(), TEXT);
    }

    #[test]
    fn tables_on_one_line_are_tables_too() {
        let text = "dpad = { mode = \"4way\" } # d\nbutton = [{ press_n = 2 }, { press_n = 3 }]\n";
        let edits = [
            real(Table::Named("dpad"), "rotation_deg", 5.5),
            real(Table::Listed("button", 1), "press_n", 0.5),
        ];
        let wanted = "dpad = { mode = \"4way\" , rotation_deg = 5.5 } # d\nbutton = [{ press_n = 2 }, { press_n = 0.5 }]\n";
        let made = edited(text, &edits).unwrap();
        assert_eq!(made.replace(" , ", ", "), wanted.replace(" , ", ", "));
        assert_eq!(written(&made, Table::Listed("button", 1), "press_n"), Some(Value::Real(0.5)));
    }

    #[test]
    fn what_is_written_is_told() {
        for (table, key, wanted) in [
            (Table::Root, "name", Some(Value::Text("x".into()))),
            (Table::Named("dpad"), "rotation_deg", Some(Value::Real(0.0))),
            (Table::Listed("button", 1), "press_n", Some(Value::Whole(1))),
            (Table::Listed("button", 2), "press_n", None),
            (Table::Named("gain"), "up", None),
            (Table::Root, "dpad", None),
        ] {
            assert_eq!(written(TEXT, table, key), wanted, "{table:?} {key}");
        }
    }

    #[test]
    fn what_cannot_be_changed_is_said() {
        let edit = |table| edited(TEXT, &[real(table, "x", 1.0)]).unwrap_err().to_string();
        assert_eq!(edit(Table::Listed("button", 2)), "the text has no table [[button]] 3");
        assert_eq!(edit(Table::Named("name")), "the text has no table [name]");
        assert!(edited("a = ", &[]).unwrap_err().to_string().starts_with("the text is no TOML: "));
    }
}
