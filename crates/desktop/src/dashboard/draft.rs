//! A profile while it is edited: changes of single values, what is wrong with it, and how it is drawn.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Number, Value};

use super::stale_comments::marked;
use tactpad_core::pipeline::mapping::profile::sketch::Sketch;
use tactpad_core::pipeline::mapping::read::check::{self, OutputChoice};
use tactpad_core::pipeline::mapping::read::shear::bound_to_shear;
use tactpad_core::toml_text::diag::Diagnostic;
use tactpad_core::toml_text::edit::{self, Change, TablePathStep};

/// A text, and what is to be changed in it.
#[derive(Debug, Deserialize)]
pub(super) struct Draft {
    text: String,
    #[serde(default)]
    changes: Vec<RequestedChange>,
}

/// One change: where the table stands, the key, and what it says from now on; null takes it away.
#[derive(Debug, Deserialize)]
struct RequestedChange {
    table: Vec<Value>,
    key: String,
    value: Value,
}

/// The text after the changes, and what there is to say of it.
#[derive(Debug, Serialize)]
pub(super) struct DraftAnswer {
    /// Whether it can be played.
    ok: bool,
    text: String,
    diagnostics: Vec<Diagnostic>,
    /// The text as a document; nothing if it is no TOML.
    document: Option<Value>,
    sketch: Option<Sketch>,
    /// Why the changes could not be made; the text is then as it was.
    error: Option<String>,
}

impl Draft {
    /// Makes the changes and reads what came of them.
    pub(super) fn answer(self, output: OutputChoice, pad_has_shear: bool) -> DraftAnswer {
        let changes: Result<Vec<_>, _> = self.changes.into_iter().map(RequestedChange::read).collect();
        let changed = changes
            .and_then(|changes| edit::changed(&self.text, &changes).map_err(|error| error.to_string()));
        let (text, error) = match changed {
            Ok(text) => (marked(&self.text, &text), None),
            Err(error) => (self.text, Some(error)),
        };
        let (profile, diagnostics) = check::read(&text, output);
        let diagnostics = for_pad(diagnostics, &text, pad_has_shear);
        let document = toml::from_str::<toml::Table>(&text).ok().map(|table| json(toml::Value::Table(table)));
        DraftAnswer {
            ok: profile.is_some(),
            diagnostics,
            document,
            sketch: profile.as_ref().map(Sketch::of),
            text,
            error,
        }
    }
}

/// The findings about a text, and what of it does nothing on the pad, in the text's order.
pub(super) fn for_pad(mut found: Vec<Diagnostic>, text: &str, pad_has_shear: bool) -> Vec<Diagnostic> {
    if !pad_has_shear {
        found.extend(bound_to_shear(text));
        found.sort_by_key(|found| (found.line, found.column));
    }
    found
}

impl RequestedChange {
    fn read(self) -> Result<Change, String> {
        let step = |step: Value| match step {
            Value::String(key) => Ok(TablePathStep::Key(key)),
            Value::Number(index) => {
                let index = index.as_u64().and_then(|index| usize::try_from(index).ok());
                index.map(TablePathStep::Index).ok_or("a table's number is 0 or more")
            }
            _ => Err("a table is named by keys and numbers"),
        };
        let table = self.table.into_iter().map(step).collect::<Result<_, _>>()?;
        let value = match self.value {
            Value::Null => None,
            Value::Bool(flag) => Some(edit::Value::Flag(flag)),
            Value::String(text) => Some(edit::Value::Text(text)),
            Value::Number(number) => Some(number_of(&self.key, &number).ok_or("this number is too large")?),
            Value::Array(_) | Value::Object(_) => {
                return Err("a value is a number, a text, or true or false".into());
            }
        };
        Ok(Change { table, key: self.key, value })
    }
}

/// A number as profiles write it: milliseconds, samples and the schema are whole ones.
fn number_of(key: &str, number: &Number) -> Option<edit::Value> {
    let is_whole = key.ends_with("_ms") || ["filter_samples", "schema"].contains(&key);
    let number = number.as_f64()?;
    Some(if is_whole && number.fract() == 0.0 && number.abs() < 1e15 {
        edit::Value::Whole(number as i64)
    } else {
        edit::Value::Real(number)
    })
}

/// TOML as JSON; a date is its text.
fn json(value: toml::Value) -> Value {
    match value {
        toml::Value::String(text) => Value::String(text),
        toml::Value::Integer(whole) => Value::from(whole),
        toml::Value::Float(real) => Number::from_f64(real).map_or(Value::Null, Value::Number),
        toml::Value::Boolean(flag) => Value::Bool(flag),
        toml::Value::Datetime(date) => Value::String(date.to_string()),
        toml::Value::Array(all) => all.into_iter().map(json).collect(),
        toml::Value::Table(table) => {
            Value::Object(table.into_iter().map(|(key, value)| (key, json(value))).collect::<Map<_, _>>())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_core::pipeline::mapping::read::shipped;

    fn answer(changes: Value) -> DraftAnswer {
        let asked = serde_json::json!({"text": shipped::text("contra").unwrap(), "changes": changes});
        serde_json::from_value::<Draft>(asked).unwrap().answer(OutputChoice::AsWritten, true)
    }

    #[test]
    fn a_change_keeps_the_comments_and_is_drawn() {
        let changes = serde_json::json!([
            {"table": ["dpad"], "key": "centre_radius_mm", "value": 10},
            {"table": ["button", 0], "key": "press_n", "value": 2.5},
            {"table": ["button", 0, "out"], "key": "keyboard", "value": "KEY_SPACE"},
            {"table": ["button", 0, "out"], "key": "label", "value": "hop"},
            {"table": ["dpad", "label"], "key": "up", "value": "aim up"},
            {"table": [], "key": "min_press_ms", "value": 50},
            {"table": ["access"], "key": "slow_ms", "value": 100},
        ]);
        let changed = answer(changes);
        assert!(changed.ok && changed.error.is_none(), "{:?}", changed.diagnostics);
        for line in [
            "centre_radius_mm = 10.0\n",
            "press_n = 2.5\n",
            "min_press_ms = 50\n",
            "slow_ms = 100\n",
            "# all eight zones are equally wide",
        ] {
            assert!(changed.text.contains(line), "{line}: {}", changed.text);
        }
        assert!(
            changed
                .text
                .contains("out = { gamepad = \"BTN_SOUTH\", keyboard = \"KEY_SPACE\", label = \"hop\" }"),
            "{}",
            changed.text
        );
        assert_eq!(changed.document.unwrap()["dpad"]["centre_radius_mm"], 10.0);
        let sketch = changed.sketch.unwrap();
        assert_eq!((sketch.buttons[0].press_n, sketch.buttons[0].word.as_str()), (2.5, "A: hop"));
        assert_eq!(sketch.dpad.unwrap().sectors[2].word, "up: aim up");
    }

    #[test]
    fn what_cannot_be_changed_leaves_the_text_and_says_why() {
        for (changes, why) in [
            (serde_json::json!([{"table": ["button", 9], "key": "press_n", "value": 1}]), "button"),
            (serde_json::json!([{"table": ["name"], "key": "press_n", "value": 1}]), "name"),
            (serde_json::json!([{"table": [], "key": "name", "value": []}]), "a value is"),
            (serde_json::json!([{"table": [{}], "key": "name", "value": 1}]), "a table is"),
        ] {
            let refused = answer(changes);
            assert_eq!(refused.text, shipped::text("contra").unwrap());
            assert!(refused.error.as_ref().is_some_and(|error| error.contains(why)), "{refused:?}");
        }
    }

    #[test]
    fn a_broken_text_has_the_findings_of_the_check() {
        let text = "schema = 1\nname = \"x\"\noutput = \"gamepad\"\n[dpad]\nmode = \"5way\"\n";
        let asked = serde_json::json!({"text": text});
        let broken = serde_json::from_value::<Draft>(asked).unwrap().answer(OutputChoice::AsWritten, true);
        assert_eq!((broken.ok, broken.sketch.is_none()), (false, true));
        assert_eq!(broken.diagnostics, check::read(text, OutputChoice::AsWritten).1);
    }

    #[test]
    fn what_does_nothing_on_the_pad_is_told_and_can_be_played() {
        let text = shipped::text("contra").unwrap();
        let told = |pad_has_shear| {
            let asked = serde_json::json!({ "text": text });
            serde_json::from_value::<Draft>(asked).unwrap().answer(OutputChoice::AsWritten, pad_has_shear)
        };
        assert_eq!(told(true).diagnostics, []);
        let warned = told(false);
        let line = 1 + text.lines().position(|line| line == "force = \"fy\"").unwrap();
        assert_eq!(warned.diagnostics.iter().map(|found| found.line).collect::<Vec<_>>(), [line]);
        assert!(warned.ok);
    }
}
