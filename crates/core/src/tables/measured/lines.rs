//! The lines of a table, and their cells.

use std::borrow::Cow;
use std::io::{BufRead, Read};

use super::error::{Fault, ReadError};
use crate::toml_text::is_utf16;

/// A longer line is no row of a table; without a limit `/dev/zero` would be one endless line.
pub(super) const LINE_BYTES_MAX: usize = 1 << 20;

/// What files begin with that gzip, ZIP, xz, bzip2 and Zstandard have written.
const PACKED: [&[u8]; 5] = [b"\x1f\x8b", b"PK\x03\x04", b"\xfd7zXZ", b"BZh", b"\x28\xb5\x2f\xfd"];

/// Lines, counted from 1.
pub(super) struct Lines<R> {
    from: R,
    line: Vec<u8>,
    number: usize,
}

impl<R: BufRead> Lines<R> {
    pub(super) const fn new(from: R) -> Self {
        Self { from, line: Vec::new(), number: 0 }
    }

    /// The next line that is not empty, and its number.
    ///
    /// What is no UTF-8 becomes replacement characters: they are no number, and no column's name.
    pub(super) fn next_line(&mut self) -> Result<Option<(usize, Cow<'_, str>)>, ReadError> {
        loop {
            self.line.clear();
            let mut limited = self.from.by_ref().take(LINE_BYTES_MAX as u64 + 1);
            let read = limited.read_until(b'\n', &mut self.line);
            if read.map_err(|error| self.error(Fault::Io(error)))? == 0 {
                return Ok(None);
            }
            self.number += 1;
            if self.number == 1 && PACKED.iter().any(|begin| self.line.starts_with(begin)) {
                return Err(self.error(Fault::Packed));
            }
            if self.number == 1 && is_utf16(&self.line) {
                return Err(self.error(Fault::Utf16));
            }
            if self.line.contains(&0) {
                return Err(self.error(Fault::Zeros));
            }
            if self.line.len() > LINE_BYTES_MAX {
                return Err(self.error(Fault::LongLine));
            }
            if self.number == 1 && self.line.starts_with("\u{feff}".as_bytes()) {
                self.line.drain(.."\u{feff}".len());
            }
            if self.line.trim_ascii_end().contains(&b'\r') {
                return Err(self.error(Fault::CarriageReturn));
            }
            if !self.line.trim_ascii().is_empty() {
                break;
            }
        }
        Ok(Some((self.number, String::from_utf8_lossy(&self.line))))
    }

    /// What is wrong with the line read last.
    pub(super) fn error(&self, fault: Fault) -> ReadError {
        ReadError { line: self.number.max(1), fault }
    }
}

/// The cells of a line: what stands between commas, without the spaces around it; of a quoted cell, what is quoted.
///
/// None, if a quotation mark does not close its cell.
pub(super) fn cells(line: &str) -> Option<Vec<Cow<'_, str>>> {
    if !line.contains('"') {
        return Some(line.split(',').map(|cell| Cow::Borrowed(cell.trim())).collect());
    }
    let mut cells = Vec::new();
    let mut rest = Some(line);
    while let Some(text) = rest {
        let (cell, after) = match text.trim_start().strip_prefix('"') {
            Some(quoted) => until_quote(quoted)?,
            None => match text.split_once(',') {
                Some((cell, after)) => (Cow::Borrowed(cell.trim()), Some(after)),
                None => (Cow::Borrowed(text.trim()), None),
            },
        };
        cells.push(cell);
        rest = after;
    }
    Some(cells)
}

/// What stands before the closing quotation mark, and what follows the comma after it.
fn until_quote(quoted: &str) -> Option<(Cow<'_, str>, Option<&str>)> {
    let mut from = 0;
    let end = loop {
        let at = from + quoted.get(from..)?.find('"')?;
        if !quoted.get(at + 1..)?.starts_with('"') {
            break at;
        }
        from = at + 2;
    };
    let (inside, after) = (quoted.get(..end)?, quoted.get(end + 1..)?.trim());
    let after = if after.is_empty() { None } else { Some(after.strip_prefix(',')?) };
    let is_doubled = inside.contains('"');
    Some((if is_doubled { inside.replace("\"\"", "\"").into() } else { inside.into() }, after))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_what_stands_between_commas() {
        for (line, wanted) in [
            ("", &[""][..]),
            (" a ,b\r\n", &["a", "b"]),
            (",,", &["", "", ""]),
            ("\"a,b\" , c", &["a,b", "c"]),
            ("\" a \"\"b\"\"\",\"\"", &[" a \"b\"", ""]),
            ("3\" pad, \"x\"\r\n", &["3\" pad", "x"]),
            ("\"\",", &["", ""]),
        ] {
            assert_eq!(cells(line).unwrap(), wanted, "{line:?}");
        }
        for line in ["\"a", "\"a\"\"", "\"a\"b", "1,\"\"\"", "\"a\" \"b\""] {
            assert_eq!(cells(line), None, "{line:?}");
        }
    }
}
