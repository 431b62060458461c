//! Protocol buffers, as far as ONNX needs them: fields one after the other, each with its number.
//!
//! Source: "Encoding", protobuf.dev/programming-guides/encoding.

const VARINT: u64 = 0;
const FIXED64: u64 = 1;
const BYTES: u64 = 2;
const FIXED32: u64 = 5;

/// More than ten bytes are no number of 64 bits.
const VARINT_BYTES_MAX: usize = 10;

/// Value of a protobuf field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Value<'b> {
    Number(u64),
    Float(f32),
    Bytes(&'b [u8]),
    /// Eight bytes, which no field has that is read here.
    Long,
}

/// The fields of a message: numbers and values. The last one is `None` where the bytes are no message.
#[derive(Clone, Debug)]
pub(super) struct Fields<'b> {
    rest: &'b [u8],
}

impl<'b> Fields<'b> {
    pub(super) const fn of(message: &'b [u8]) -> Self {
        Self { rest: message }
    }

    /// How many bytes are not read yet.
    pub(super) const fn left(&self) -> usize {
        self.rest.len()
    }

    fn take(&mut self, count: usize) -> Option<&'b [u8]> {
        let (taken, rest) = self.rest.split_at_checked(count)?;
        self.rest = rest;
        Some(taken)
    }

    fn field(&mut self) -> Option<(u64, Value<'b>)> {
        let key = varint(&mut self.rest)?;
        let value = match key & 7 {
            VARINT => Value::Number(varint(&mut self.rest)?),
            FIXED64 => self.take(8).map(|_| Value::Long)?,
            BYTES => {
                let length = usize::try_from(varint(&mut self.rest)?).ok()?;
                Value::Bytes(self.take(length)?)
            }
            FIXED32 => Value::Float(f32::from_le_bytes(*self.take(4)?.first_chunk()?)),
            _ => return None,
        };
        Some((key >> 3, value))
    }
}

impl<'b> Iterator for Fields<'b> {
    type Item = Option<(u64, Value<'b>)>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let field = self.field();
        if field.is_none() {
            self.rest = &[];
        }
        Some(field)
    }
}

/// Reads a number off the front.
pub(super) fn varint(rest: &mut &[u8]) -> Option<u64> {
    let length = 1 + rest.iter().take(VARINT_BYTES_MAX).position(|byte| byte & 0x80 == 0)?;
    let (taken, after) = rest.split_at_checked(length)?;
    *rest = after;
    Some(taken.iter().rev().fold(0, |number, byte| number << 7 | u64::from(byte & 0x7f)))
}

fn push_varint(to: &mut Vec<u8>, mut number: u64) {
    while number >= 0x80 {
        to.push(number as u8 | 0x80);
        number >>= 7;
    }
    to.push(number as u8);
}

/// Writes a number's field.
pub(super) fn push_number(to: &mut Vec<u8>, field: u64, number: u64) {
    push_varint(to, field << 3 | VARINT);
    push_varint(to, number);
}

/// Writes the field of a text, or of a message inside.
pub(super) fn push_bytes(to: &mut Vec<u8>, field: u64, bytes: &[u8]) {
    push_varint(to, field << 3 | BYTES);
    push_varint(to, bytes.len() as u64);
    to.extend(bytes);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_read_as_they_were_written() {
        let mut message = Vec::new();
        push_number(&mut message, 1, 300);
        push_bytes(&mut message, 16, b"testing");
        push_number(&mut message, 2, u64::MAX);
        // 300 is AC 02 in the format's own description, "testing" its example of a text.
        assert!(message.starts_with(&[0x08, 0xac, 0x02, 0x82, 0x01, 0x07, b't']));
        message.extend([0x1d, 0, 0, 0x80, 0x3f]);
        let wanted = [
            (1, Value::Number(300)),
            (16, Value::Bytes(b"testing")),
            (2, Value::Number(u64::MAX)),
            (3, Value::Float(1.0)),
        ];
        assert!(Fields::of(&message).eq(wanted.map(Some)));
    }

    #[test]
    fn what_is_no_message_ends() {
        for bytes in
            [&[0x08][..], &[0x0a, 5, 1], &[0x0d, 1], &[0x0b], &[0xff; 12], &[0x0a, 0xff, 0xff, 0xff, 0xff]]
        {
            assert_eq!(Fields::of(bytes).last(), Some(None), "{bytes:?}");
        }
    }
}
