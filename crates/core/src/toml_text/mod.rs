//! TOML texts that people write: what is in them, and everything that is wrong with them, at its place.
//!
//! A reader walks the text's tree table by table and collects all findings, so that one reading tells them
//! all.

use toml::Spanned;
use toml::de::DeTable;

use self::diag::Findings;

pub mod diag;
#[cfg(feature = "lab")]
pub mod edit;
mod excerpt;
pub(crate) mod section;
pub mod spelling;
mod token;

/// A longer text is not read; the limit bounds what reading one can cost.
pub const TEXT_BYTES_MAX: usize = 256_000;

/// What is wrong with a text above [`TEXT_BYTES_MAX`].
pub fn too_long() -> String {
    format!("the text is longer than {} kB", TEXT_BYTES_MAX / 1_000)
}

/// The text's tree as far as it can be parsed; every fault is reported. `None` (and a finding with `help`) for
/// one above [`TEXT_BYTES_MAX`].
pub(crate) fn parse<'t>(
    text: &'t str,
    help: &str,
    findings: &mut Findings<'_>,
) -> Option<Spanned<DeTable<'t>>> {
    if text.len() > TEXT_BYTES_MAX {
        findings.unreadable(too_long(), help);
        return None;
    }
    let (tree, faults) = DeTable::parse_recoverable(text);
    for fault in faults {
        let span = fault.span().unwrap_or_default();
        let message = match fault.message() {
            "duplicate key" => doubled(text.get(span.clone())),
            message => message.to_owned(),
        };
        findings.broken(span.start, &message);
    }
    Some(tree)
}

/// What is wrong where a key stands a second time.
fn doubled(key: Option<&str>) -> String {
    key.map_or_else(|| "duplicate key".to_owned(), |key| format!("duplicate key {}", diag::quoted(key)))
}

/// Whether the text is UTF-16, by its byte order mark or its zeros.
pub fn is_utf16(bytes: &[u8]) -> bool {
    match bytes {
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => true,
        [first, second, third, fourth, ..] => {
            let zeros = [first, second, third, fourth].map(|byte| *byte == 0);
            zeros == [false, true, false, true] || zeros == [true, false, true, false]
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toml_text::diag::Diagnostic;

    fn found(text: &str) -> Vec<Diagnostic> {
        let mut findings = Findings::new(text);
        parse(text, "", &mut findings);
        findings.finish()
    }

    #[test]
    fn a_decimal_comma_is_told_from_other_commas() {
        for (text, wanted) in
            [("press_n = 2,0\n", "2.0"), ("[dpad]\na = -12,75 # mm\n", "-12.75"), ("a = 0,5", "0.5")]
        {
            let [found] = &found(text)[..] else { panic!("{text}: {:?}", found(text)) };
            assert_eq!(found.help, Some(format!("write a decimal point: {wanted}")), "{text}");
        }
        for text in ["a = 2,\n", "a = \"x\",1\n", "a = ,5\n"] {
            let has_comma =
                |found: &Diagnostic| found.help.as_ref().is_some_and(|help| help.contains("decimal"));
            assert!(!found(text).iter().any(has_comma), "{text}: {:?}", found(text));
        }
        assert_eq!(found("a = [1,0]\n"), []);
    }

    #[test]
    fn a_doubled_key_is_named() {
        for (text, name) in
            [("name = 1\nname = 2\n", "name"), ("a = { b = 1, b = 2 }\n", "b"), ("[dpad]\n[dpad]\n", "dpad")]
        {
            let [found] = &found(text)[..] else { panic!("{text}: {:?}", found(text)) };
            assert_eq!(found.message, format!("duplicate key \"{name}\""), "{text}");
        }
    }

    #[test]
    fn utf16_is_told_with_and_without_its_mark() {
        for bytes in [&b"\xff\xfea\0"[..], b"\xfe\xff\0a", b"a\0b\0c\0", b"\0a\0b"] {
            assert!(is_utf16(bytes), "{bytes:?}");
        }
        for bytes in [&b""[..], b"a", b"abcd", b"\xef\xbb\xbfa", b"a\0bc", "äö".as_bytes()] {
            assert!(!is_utf16(bytes), "{bytes:?}");
        }
    }
}
