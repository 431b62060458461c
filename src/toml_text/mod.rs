//! TOML texts that people write: what is in them, and everything that is wrong with them, at its place.
//!
//! A reader walks the text's tree table by table and collects all findings, so that one reading tells them
//! all.

use toml::Spanned;
use toml::de::DeTable;

use self::diag::Findings;

pub mod diag;
pub(crate) mod section;
pub mod spelling;

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
        findings.error(0, too_long(), help);
        return None;
    }
    let (tree, faults) = DeTable::parse_recoverable(text);
    for fault in faults {
        findings.broken(fault.span().map_or(0, |span| span.start), fault.message());
    }
    Some(tree)
}
