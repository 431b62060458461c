//! The checksum of the program's own files, so that a damaged weight is found: a property of the model, its last field.
//!
//! Its value is the sum of all bytes before it. A file without it is one of another program, of an earlier tactpad, or one
//! that was changed on purpose: then the property has to be taken out.

use super::error::OnnxError;
use super::graph::text_field;
use super::wire::{Fields, Value, push_bytes};
use crate::bytes::fnv1a;

/// Field of a model's properties.
const PROPERTY: u64 = 14;

const KEY: &str = "tactpad.checksum";

/// Closes a model with its checksum.
pub(super) fn push(model: &mut Vec<u8>) {
    let sum = text(model);
    push_property(model, KEY, &sum);
}

/// Adds a property to a model.
pub(super) fn push_property(model: &mut Vec<u8>, key: &str, value: &str) {
    let mut property = Vec::new();
    push_bytes(&mut property, 1, key.as_bytes());
    push_bytes(&mut property, 2, value.as_bytes());
    push_bytes(model, PROPERTY, &property);
}

/// Whether a model has a checksum, which then is right.
pub(super) fn is_there(model: &[u8]) -> Result<bool, OnnxError> {
    let mut fields = Fields::of(model);
    loop {
        let before = model.len() - fields.left();
        let Some(field) = fields.next() else { return Ok(false) };
        let (PROPERTY, Value::Bytes(property)) = field.ok_or(OnnxError::Damaged)? else { continue };
        if text_field(property, 1)? == KEY.as_bytes() {
            let summed = model.get(..before).unwrap_or_default();
            let is_right = fields.left() == 0 && text_field(property, 2)? == text(summed).as_bytes();
            return if is_right { Ok(true) } else { Err(OnnxError::Checksum) };
        }
    }
}

fn text(bytes: &[u8]) -> String {
    format!("{:016x}", fnv1a(bytes))
}
