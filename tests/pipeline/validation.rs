//! JSON Schema as far as the profiles' schema uses it. A keyword beyond that is an error of the test, not passed over.

use serde_json::{Map, Value};

/// The node with what it refers to: its own words win, and `properties` of both hold.
pub(crate) fn merged(root: &Value, node: &Value) -> Value {
    let Some(target) = node.get("$ref").and_then(Value::as_str) else { return node.clone() };
    let target =
        root.pointer(target.trim_start_matches('#')).unwrap_or_else(|| panic!("{target} is not there"));
    let (Value::Object(mut whole), Some(own)) = (merged(root, target), node.as_object()) else {
        panic!("{target:?} is no schema")
    };
    for (word, value) in own.iter().filter(|(word, _)| *word != "$ref") {
        match (whole.get_mut(word).and_then(Value::as_object_mut), value.as_object()) {
            (Some(properties), Some(more)) if word == "properties" => properties.extend(more.clone()),
            _ => {
                whole.insert(word.clone(), value.clone());
            }
        }
    }
    Value::Object(whole)
}

/// Why `value` does not fit the schema `root`.
pub(crate) fn faults(root: &Value, value: &Value) -> Vec<String> {
    let mut faults = Vec::new();
    check(root, root, value, "", &mut faults);
    faults
}

fn check(root: &Value, node: &Value, value: &Value, place: &str, faults: &mut Vec<String>) {
    let table = match merged(root, node) {
        Value::Bool(true) => return,
        Value::Object(table) => table,
        _ => return faults.push(format!("{place} may not be there")),
    };
    for (word, said) in &table {
        if let Some(why) = why_not(root, (word, said), value) {
            faults.push(format!("{place} {why}"));
        }
    }
    let (properties, strangers) = (table.get("properties"), table.get("additionalProperties"));
    for (key, value) in value.as_object().into_iter().flatten() {
        let below = if place.is_empty() { key.clone() } else { format!("{place}.{key}") };
        match properties.and_then(|properties| properties.get(key)) {
            Some(property) => check(root, property, value, &below, faults),
            None if strangers == Some(&Value::Bool(false)) => {
                faults.push(format!("{place} has a strange key {key}"));
            }
            None => {}
        }
    }
    for (number, value) in value.as_array().into_iter().flatten().enumerate() {
        if let Some(item) = table.get("items") {
            check(root, item, value, &format!("{place}.{number}"), faults);
        }
    }
}

/// Why `value` does not fit one word of a schema.
fn why_not(root: &Value, (word, said): (&str, &Value), value: &Value) -> Option<String> {
    let count = said.as_u64().unwrap_or_default() as usize;
    let fitting = || {
        let ways = said.as_array().into_iter().flatten();
        ways.filter(|way| {
            let mut faults = Vec::new();
            check(root, way, value, "", &mut faults);
            faults.is_empty()
        })
        .count()
    };
    let letters = || value.as_str().map(|text| text.chars().count());
    let table = value.as_object();
    match word {
        "$schema"
        | "$defs"
        | "title"
        | "description"
        | "default"
        | "properties"
        | "additionalProperties"
        | "items" => None,
        "type" => {
            (!is_of_type(value, said.as_str()?)).then(|| format!("is no {}", said.as_str().unwrap_or("")))
        }
        "const" => (value != said).then(|| format!("is not {said}")),
        "enum" => (!said.as_array()?.contains(value)).then(|| format!("is none of {said}")),
        "minimum" => (value.as_f64()? < said.as_f64()?).then(|| format!("is below {said}")),
        "maximum" => (value.as_f64()? > said.as_f64()?).then(|| format!("is above {said}")),
        "minLength" => (letters()? < count).then(|| "is too short".into()),
        "maxLength" => (letters()? > count).then(|| "is too long".into()),
        "minItems" => (value.as_array()?.len() < count).then(|| format!("has less than {count}")),
        "maxItems" => (value.as_array()?.len() > count).then(|| format!("has more than {count}")),
        "minProperties" => (table?.len() < count).then(|| format!("has less than {count}")),
        "required" => lacking(table?, said),
        "dependentRequired" => {
            let needed =
                said.as_object()?.iter().filter(|(key, _)| table.is_some_and(|it| it.contains_key(*key)));
            needed.filter_map(|(_, keys)| lacking(table?, keys)).next()
        }
        "anyOf" => (fitting() == 0).then(|| "fits none".into()),
        "oneOf" => {
            Some(fitting()).filter(|fitting| *fitting != 1).map(|fitting| format!("fits {fitting} of {said}"))
        }
        other => panic!("the test does not know the schema's word {other}"),
    }
}

fn lacking(table: &Map<String, Value>, keys: &Value) -> Option<String> {
    let mut keys = keys.as_array()?.iter().filter_map(Value::as_str);
    keys.find(|key| !table.contains_key(*key)).map(|key| format!("lacks {key}"))
}

fn is_of_type(value: &Value, kind: &str) -> bool {
    match kind {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        other => panic!("the test does not know the type {other}"),
    }
}
