//! `mappings/profile.schema.json` and the reader of profiles say the same: keys, ranges, words, defaults.
//!
//! The schema is walked table by table, and the reader is asked about each key. A new key needs its entry in the schema
//! and nothing here; a new table that must hold something to be read needs a place in [`base`].
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::collections::BTreeSet;

use serde_json::{Map, Value, json};
use tactpad::pipeline::control::names::{GAMEPAD_BUTTONS, HAT_AXES, POINTER_BUTTONS};
use tactpad::pipeline::mapping::plain::settings::{self, SETTINGS, Unit};
use tactpad::pipeline::mapping::plain::values::CHOICES;
use tactpad::pipeline::mapping::profile::Profile;
use tactpad::pipeline::mapping::read::check::{OutputChoice, read};
use tactpad::pipeline::mapping::read::shipped::{self, SCHEMA_LINE};

use crate::validation::{faults, merged};

/// No key is near to it, so that the reader lists those that it knows.
const STRANGER: &str = "qqqqqqqqqqqq";

fn schema() -> Value {
    serde_json::from_str(shipped::schema()).unwrap()
}

/// A profile with every table that others stand in.
fn base() -> Value {
    json!({
        "schema": 1,
        "name": "Test",
        "output": "gamepad",
        "program": [{ "class": "Game", "executable": "game" }],
        "access": { "tremor_hz": 1, "rest_n": 1 },
        "gain": {},
        "dpad": {},
        "pointer": {},
        "zone": [{ "name": "top" }],
        "stick": [{ "stick": "left" }, { "stick": "right", "from": "shear", "centre_n": 0.2, "full_n": 2 }],
        "trigger": [{ "trigger": "left" }],
        "layer": [{ "name": "menu" }],
        "macro": [{ "name": "jump", "steps": [{ "gamepad": "BTN_MODE", "keyboard": "KEY_G" }] }],
        "button": [
            {
                "force": "fz",
                "press_n": 2,
                "tap": { "gamepad": "BTN_SOUTH", "keyboard": "KEY_A" },
                "double": { "gamepad": "BTN_EAST", "keyboard": "KEY_B" },
                "hold": { "gamepad": "BTN_WEST", "keyboard": "KEY_C" },
            },
            {
                "force": "fx",
                "press_n": 2,
                "dwell_ms": 800,
                "dwell_mm": 3,
                "out": { "gamepad": "BTN_TL", "keyboard": "KEY_D" },
            },
            {
                "force": "-fx",
                "press_n": 2,
                "light": { "gamepad": "BTN_TR", "keyboard": "KEY_E" },
                "hard": { "gamepad": "BTN_START", "keyboard": "KEY_F" },
                "hard_press_n": 3,
                "hard_release_n": 2,
                "skip": "may",
                "skip_ms": 150,
            },
        ],
    })
}

/// Where a key stands; [`ITEM`] is a table of the list before it.
type Place = Vec<String>;

const ITEM: &str = "[]";

fn shown(place: &[String]) -> String {
    if place.is_empty() { "the profile".into() } else { place.join(".") }
}

fn below(place: &[String], key: &str) -> Place {
    place.iter().map(String::as_str).chain([key]).map(str::to_owned).collect()
}

/// What stands at a place; tables on the way there are made. Of a list's tables it is the first one that has the next
/// key, else the first.
fn at<'d>(document: &'d mut Value, place: &[String]) -> &'d mut Value {
    let [step, rest @ ..] = place else { return document };
    if step == ITEM {
        let items = document.as_array_mut().unwrap();
        let has_next = |item: &Value| rest.first().is_some_and(|key| item.get(key).is_some());
        let index = items.iter().position(has_next).unwrap_or(0);
        return at(&mut items[index], rest);
    }
    let empty = if rest.first().is_some_and(|next| next == ITEM) { json!([{}]) } else { json!({}) };
    at(document.as_object_mut().unwrap().entry(step).or_insert(empty), rest)
}

/// [`base`] with `value` at a place.
fn with(place: &[String], value: Value) -> Value {
    let mut document = base();
    *at(&mut document, place) = value;
    document
}

fn toml(value: &Value) -> String {
    match value {
        Value::Object(table) => {
            let keys = table.iter().map(|(key, value)| format!("{key} = {}", toml(value)));
            format!("{{ {} }}", keys.collect::<Vec<_>>().join(", "))
        }
        Value::Array(items) => format!("[{}]", items.iter().map(toml).collect::<Vec<_>>().join(", ")),
        other => other.to_string(),
    }
}

/// What the reader makes of a document: the profile, and its findings as `message; help`.
fn asked(document: &Value) -> (Option<Profile>, Vec<String>) {
    let lines = document.as_object().unwrap().iter().map(|(key, value)| format!("{key} = {}\n", toml(value)));
    let (profile, found) = read(&lines.collect::<String>(), OutputChoice::AsWritten);
    let told = found.into_iter().map(|it| format!("{}; {}", it.message, it.help.unwrap_or_default()));
    (profile, told.collect())
}

fn says(document: &Value, words: &str) -> bool {
    asked(document).1.iter().any(|told| told.contains(words))
}

/// The tables of the schema, with where they stand.
fn tables() -> Vec<(Place, Map<String, Value>)> {
    fn walk(root: &Value, node: &Value, place: &[String], tables: &mut Vec<(Place, Map<String, Value>)>) {
        let Value::Object(table) = merged(root, node) else { return };
        for (key, property) in table.get("properties").and_then(Value::as_object).into_iter().flatten() {
            walk(root, property, &below(place, key), tables);
        }
        if let Some(item) = table.get("items") {
            walk(root, item, &below(place, ITEM), tables);
        }
        if table.contains_key("properties") {
            tables.push((place.to_vec(), table));
        }
    }
    let (root, mut tables) = (schema(), Vec::new());
    walk(&root, &root, &[], &mut tables);
    tables
}

/// Every key of the schema: where it stands, its name, and what is said of it.
fn keys() -> Vec<(Place, String, Value)> {
    let root = schema();
    let mut keys = Vec::new();
    for (place, table) in tables() {
        for (key, property) in table["properties"].as_object().unwrap() {
            keys.push((below(&place, key), key.clone(), merged(&root, property)));
        }
    }
    keys
}

fn words(list: &Value) -> BTreeSet<String> {
    list.as_array().into_iter().flatten().map(|word| word.as_str().unwrap().to_owned()).collect()
}

#[test]
fn the_schema_and_the_reader_know_the_same_keys() {
    // Its layer and its macro are there for their keys alone.
    let told = asked(&base()).1;
    assert!(told.iter().all(|told| told.starts_with("nothing ")), "{told:?}");
    let mut wrong = String::new();
    for (place, table) in tables() {
        let told = asked(&with(&below(&place, STRANGER), json!(1))).1;
        let listed = told.iter().find_map(|told| told.split_once("known here: "));
        let (_, listed) = listed.unwrap_or_else(|| panic!("{}: {told:?}", shown(&place)));
        let read: BTreeSet<&str> = listed.split(", ").collect();
        let described: BTreeSet<&str> =
            table["properties"].as_object().unwrap().keys().map(String::as_str).collect();
        for key in read.difference(&described) {
            wrong += &format!("the schema lacks \"{key}\" in {}\n", shown(&place));
        }
        for key in described.difference(&read) {
            wrong += &format!("the reader does not know \"{key}\" in {}\n", shown(&place));
        }
        if table.get("additionalProperties") != Some(&Value::Bool(false)) {
            wrong += &format!("the schema takes strange keys in {}\n", shown(&place));
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn what_must_be_written_is_the_same() {
    for (place, table) in tables() {
        let one_of = table.get("oneOf").and_then(|ways| ways.get(0));
        let mut required = words(table.get("required").unwrap_or(&Value::Null));
        required.extend(words(one_of.and_then(|way| way.get("required")).unwrap_or(&Value::Null)));
        let told = asked(&with(&place, json!({}))).1;
        let lacks = told.iter().filter_map(|told| told.split("lacks \"").nth(1)?.split('"').next());
        // A table in a list is not the only one: the others lack nothing.
        let lacks: BTreeSet<String> = lacks.map(str::to_owned).collect();
        assert_eq!(lacks, required, "{}", shown(&place));
    }
}

#[test]
fn ranges_are_the_same() {
    let mut checked = 0;
    for (place, key, said) in keys() {
        let is_whole = match said.get("type").and_then(Value::as_str) {
            Some("integer") => true,
            Some("number") => false,
            _ => continue,
        };
        let [low, high] = ["minimum", "maximum"].map(|bound| {
            said.get(bound).and_then(Value::as_f64).unwrap_or_else(|| panic!("{place:?} has no {bound}"))
        });
        let step = if is_whole { 1.0 } else { 0.01 };
        let refusal = format!("it must be {low} to {high};");
        for (value, wanted) in [(low - step, true), (low, false), (high, false), (high + step, true)] {
            let written = if is_whole { json!(value as i64) } else { json!(value) };
            let told = asked(&with(&place, written)).1;
            let about =
                |told: &&String| told.starts_with(&format!("\"{key}\" is ")) && told.contains("must be");
            let ranges: Vec<_> = told.iter().filter(about).collect();
            assert_eq!(ranges.len(), usize::from(wanted), "{} = {value}: {told:?}", shown(&place));
            assert!(ranges.iter().all(|told| told.contains(&refusal)), "{}: {ranges:?}", shown(&place));
        }
        let whole_only = says(&with(&place, json!(low + 0.5)), &format!("\"{key}\" must be a whole number"));
        assert_eq!(whole_only, is_whole, "{}", shown(&place));
        checked += 1;
    }
    assert!(checked >= 20, "{checked}");
}

#[test]
fn types_and_words_are_the_same() {
    for (place, key, said) in keys() {
        if said == json!(false) {
            assert!(asked(&with(&place, json!(100))).0.is_none(), "{} is taken", shown(&place));
            continue;
        }
        let kind = said.get("type").and_then(Value::as_str);
        let (strange, wanted) = match (kind, said.get("const")) {
            (Some("number"), _) => (json!("x"), "a number"),
            (Some("integer"), _) | (None, Some(_)) => (json!("x"), "a whole number"),
            (Some("boolean"), _) => (json!("x"), "true or false"),
            (Some("object"), _) => (json!(1), "a table"),
            (Some("array"), _) => (json!(1), "a list"),
            // Words, and bindings.
            (Some("string") | None, _) => (json!(1), "text"),
            (Some(other), _) => panic!("{}: what is {other}?", shown(&place)),
        };
        let document = with(&place, strange);
        let told = asked(&document).1;
        assert!(says(&document, &format!("\"{key}\" must be {wanted}")), "{}: {told:?}", shown(&place));
        if let Some(only) = said.get("const").and_then(Value::as_u64) {
            assert!(
                says(&with(&place, json!(only + 1)), &format!("it must be {only};")),
                "{}",
                shown(&place)
            );
        }
        if let Some(listed) = said.get("enum") {
            let told = asked(&with(&place, json!(STRANGER))).1;
            let known = told.iter().find_map(|told| told.split_once("write one of: "));
            let (_, known) = known.unwrap_or_else(|| panic!("{}: {told:?}", shown(&place)));
            let known: BTreeSet<_> =
                known.split(", ").map(|word| word.trim_matches('"').to_owned()).collect();
            assert_eq!(words(listed), known, "{}", shown(&place));
        }
    }
}

#[test]
fn lengths_are_the_same() {
    for (place, key, said) in keys() {
        let bound = |name: &str| said.get(name).and_then(Value::as_u64).map(|bound| bound as usize);
        if let (Some(low), Some(high)) = (bound("minLength"), bound("maxLength")) {
            let refusal = format!("\"{key}\" must be one line of {low} to {high} characters");
            for (length, refused) in [(low - 1, true), (low, false), (high, false), (high + 1, true)] {
                let document = with(&place, json!("x".repeat(length)));
                assert_eq!(says(&document, &refusal), refused, "{}: {length}", shown(&place));
            }
        }
        if let Some(most) = bound("maxItems") {
            let item = at(&mut base(), &below(&place, ITEM)).clone();
            for (count, refused) in [(most, false), (most + 1, true)] {
                let told = says(&with(&place, json!(vec![item.clone(); count])), &format!("at most {most} "));
                assert_eq!(told, refused, "{}: {count}", shown(&place));
            }
        } else if said.get("type").and_then(Value::as_str) == Some("array") {
            panic!("{} has no end", shown(&place));
        }
    }
}

#[test]
fn defaults_are_the_same_and_every_key_is_described() {
    let without = asked(&base()).0;
    let mut checked = 0;
    for (place, key, said) in keys() {
        if said == json!(false) {
            continue;
        }
        let description = said.get("description").and_then(Value::as_str).unwrap_or_default();
        assert!(description.ends_with('.'), "{} has no description", shown(&place));
        if let Some(default) = said.get("default") {
            let (profile, told) = asked(&with(&place, default.clone()));
            assert!(profile.is_some(), "{}: {told:?}", shown(&place));
            assert_eq!(profile, without, "{}", shown(&place));
            checked += 1;
            continue;
        }
        let (_, table) = tables().into_iter().find(|(of, _)| of[..] == place[..place.len() - 1]).unwrap();
        let must = table.get("required").is_some_and(|required| words(required).contains(&key));
        let says_default = ["efault", "Without", "either"].iter().any(|word| description.contains(word));
        assert!(must || says_default, "{}: what holds where it is not written?", shown(&place));
    }
    assert!(checked >= 25, "{checked}");
}

#[test]
fn the_words_of_bindings_are_those_of_the_devices() {
    let root = schema();
    let listed = |name: &str| words(&root["$defs"][name]["anyOf"][0]["enum"]);
    let hat = HAT_AXES.iter().flat_map(|axis| [format!("{axis}-"), format!("{axis}+")]);
    let pad = GAMEPAD_BUTTONS.iter().map(ToString::to_string).chain(hat);
    assert_eq!(listed("gamepad"), pad.collect());
    let wheel = ["REL_WHEEL+", "REL_WHEEL-"].map(str::to_owned);
    let pointer = POINTER_BUTTONS.iter().map(ToString::to_string).chain(wheel);
    assert_eq!(listed("pointer_button"), pointer.collect());
}

/// A place as the plain words have it: numbers of tables in lists are left out, and a button's kinds of press are one.
fn plain_place(place: &[String]) -> String {
    place.iter().filter(|step| *step != ITEM).map(String::as_str).collect::<Vec<_>>().join(".")
}

#[test]
fn every_setting_has_a_plain_word_and_a_unit_or_says_why_none() {
    let keys: Vec<_> = keys().into_iter().filter(|(.., said)| *said != json!(false)).collect();
    for (place, _, said) in &keys {
        let name = plain_place(place);
        let setting = settings::find(&name).unwrap_or_else(|| panic!("{name} has no plain word"));
        let is_number = matches!(said.get("type").and_then(Value::as_str), Some("number" | "integer"));
        assert_eq!(setting.unit != Unit::NoNumber, is_number, "{name}: {:?}", setting.unit);
        for word in words(said.get("enum").or_else(|| said["anyOf"][0].get("enum")).unwrap_or(&Value::Null)) {
            let is_control = ["gamepad", "keyboard", "pointer", "up", "down", "left", "right"];
            let is_control =
                name != "output" && is_control.iter().any(|end| name.ends_with(&format!(".{end}")));
            let is_told = CHOICES.iter().any(|(place, words)| {
                settings::find(&name).is_some_and(|it| it.place == *place)
                    && words.iter().any(|(it, _)| *it == word)
            });
            assert!(is_told || is_control, "{name} = {word:?} has no plain word");
        }
    }
    for setting in SETTINGS {
        let is_there = keys.iter().any(|(place, ..)| {
            settings::find(&plain_place(place)).is_some_and(|it| it.place == setting.place)
        });
        assert!(is_there, "{} is no setting of a profile", setting.place);
    }
}

#[test]
fn descriptions_name_no_key_and_no_code_of_the_kernel() {
    let keys = keys();
    let is_key = |word: &str| word.contains('_') && keys.iter().any(|(_, key, _)| key == word);
    let bindings = ["gamepad", "keyboard", "pointer", "up", "down", "left", "right"];
    for (place, key, said) in &keys {
        let description = said.get("description").and_then(Value::as_str).unwrap_or_default();
        let mut words = description.split(|letter: char| !letter.is_alphanumeric() && letter != '_');
        let is_strange = |word: &&str| {
            is_key(word) || ["KEY_", "BTN_", "ABS_", "REL_"].iter().any(|it| word.starts_with(it))
        };
        let strange = words.find(is_strange);
        assert!(strange.is_none() || bindings.contains(&key.as_str()), "{}: {strange:?}", shown(place));
    }
}

#[test]
fn profiles_that_are_in_order_fit_the_schema() {
    let reference = include_str!("../../mappings/README.md");
    let examples = reference.split("```toml\n").skip(1).filter_map(|rest| rest.split("```").next());
    let whole = examples.filter(|example| example.contains("schema = 1"));
    let template = include_str!("../../src/cli/playing/profile/template.toml");
    let shipped: Vec<_> = shipped::names().filter_map(shipped::text).collect();
    assert!(shipped.len() >= 5 && shipped.iter().all(|text| text.starts_with(SCHEMA_LINE)));
    let texts: Vec<_> = shipped.into_iter().chain([template]).chain(whole).collect();
    assert!(texts.len() >= 7);
    for text in texts {
        let document: Value = ::toml::from_str(text).unwrap();
        assert_eq!(faults(&schema(), &document), Vec::<String>::new(), "{text}");
    }
    assert_eq!(faults(&schema(), &base()), Vec::<String>::new());
}

/// A button that asks for both ways of deciding a hold by another press.
fn both_holds() -> Value {
    let mut button = base()["button"][0].clone();
    for key in ["permissive_hold", "hold_on_other_key_press"] {
        button[key] = json!(true);
    }
    button
}

#[test]
fn slips_do_not_fit_the_schema() {
    let place = |place: &str| place.split('.').map(str::to_owned).collect::<Place>();
    for (at, value, words) in [
        ("filter_samples", json!(65), "filter_samples is above 64"),
        ("filter_samples", json!(1.5), "filter_samples is no integer"),
        ("schema", json!(2), "schema is not 1"),
        ("name", json!(""), "name is too short"),
        ("dpad.mode", json!("5way"), "dpad.mode is none of"),
        ("dpad.depth", json!(1), "dpad has a strange key depth"),
        ("button.[].out", json!({ "pointer": "BTN_LEFT" }), "button.0 fits 2 of"),
        ("button.[].tap.turbo_ms", json!(100), "button.0.tap.turbo_ms may not be there"),
        ("button.[].tap.pointer", json!("BTN_LEFT"), "button.0.tap fits"),
        ("button.[].tap", json!({ "gamepad": "BTN_SOUTH" }), "button.0.tap fits 0 of"),
        ("button.[].permissive_hold", json!(1), "button.0.permissive_hold is no boolean"),
        ("button.[]", both_holds(), "button.0 fits none"),
        ("button", json!([{ "force": "fz", "press_n": 1, "hold": { "pointer": "BTN_LEFT" } }]), "lacks tap"),
        ("button", json!([{ "force": "fz", "out": { "pointer": "BTN_LEFT" } }]), "button.0 lacks press_n"),
        ("button", json!(vec![base()["button"][1].clone(); 17]), "button has more than 16"),
    ] {
        // The first button taps: that is where these go.
        let mut document = base();
        document["button"].as_array_mut().unwrap().truncate(1);
        *self::at(&mut document, &place(at)) = value;
        let found = faults(&schema(), &document);
        assert!(found.iter().any(|fault| fault.contains(words)), "{words}: {found:?}");
        assert!(asked(&document).0.is_none(), "{at}: the reader takes it");
    }
}
