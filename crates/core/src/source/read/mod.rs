//! From a description's text to a [`Source`]: names, types, ranges, and how the numbers stand to each other.
//!
//! `models/sources/README.md` documents every key for people. All findings are reported at once.

mod measures;
mod origin;
mod reach;
#[cfg(test)]
mod tests;
mod units;

use toml::de::DeTable;

use super::{Measures, Source};
use crate::toml_text;
use crate::toml_text::diag::{Diagnostic, Findings};
use crate::toml_text::section::{Bounds, Placed, Section};
use measures::{Drafted, read_measures};
use origin::{ORIGINS, read_origin};
use reach::{read_reach, refuse_reach};

const ROOT_KEYS: [&str; 11] =
    ["schema", "name", "title", "lines", "wire", "evdev", "area", "force", "cell", "wrench", "contact"];

const SCHEMA: Bounds<u32> = Bounds { low: 1, high: 1, default: 1 };

/// Whether a text is meant as a description, sound or not: it has a table that says where numbers come from.
pub fn is_meant(text: &str) -> bool {
    let (tree, _) = DeTable::parse_recoverable(text);
    ORIGINS.iter().any(|origin| tree.get_ref().contains_key(*origin))
}

/// Reads a description from TOML text.
///
/// Returns what there is to say about the text, in its order; after 50 findings a closing one says that there is more. The description
/// is `None` exactly if there is an error among it. A text above [`toml_text::TEXT_BYTES_MAX`] is not read.
pub fn read(text: &str) -> (Option<Source>, Vec<Diagnostic>) {
    let mut findings = Findings::new(text);
    let Some(tree) = toml_text::parse(text, "a description is a few lines of TOML", &mut findings) else {
        return (None, findings.finish());
    };
    let root = Section::root(&tree, "the description", &ROOT_KEYS, &mut findings);
    root.require("schema", "write schema = 1", &mut findings);
    root.whole("schema", SCHEMA, &mut findings);
    let name = read_name(&root, &mut findings);
    root.require("title", "write title = \"…\", what the pad is", &mut findings);
    let title = root.name("title", &mut findings).map(str::to_owned);
    let measures = read_measures(&root, &mut findings);
    let origin = read_origin(&root, measures.as_ref().map(Drafted::channels), &mut findings);
    let reach = match &measures {
        Some(Drafted::Contact(_)) => {
            refuse_reach(&root, &mut findings);
            None
        }
        channels => read_reach(&root, channels.as_ref(), &mut findings),
    };
    let source = (|| {
        let measures = match measures? {
            Drafted::Cells(cells) => Measures::Cells(cells, reach?),
            Drafted::Wrench(wrench, _) => Measures::Wrench(wrench, reach?),
            Drafted::Contact(touching) => Measures::Contact(touching),
        };
        Some(Source { name: name?, title: title?, origin: origin?, measures })
    })();
    let source = source.filter(|_| !findings.failed());
    (source, findings.finish())
}

fn read_name(root: &Section<'_>, findings: &mut Findings<'_>) -> Option<String> {
    root.require("name", "write name = \"my-pad\", as it is called behind --pad", findings);
    let Placed { value, at } = root.text("name", findings)?;
    let is_plain = |letter: char| letter.is_ascii_lowercase() || letter.is_ascii_digit() || letter == '-';
    let is_name = (1..=32).contains(&value.len()) && value.chars().all(is_plain) && !value.starts_with('-');
    if !is_name {
        findings.error(
            at,
            "\"name\" must be 1 to 32 small letters, digits and -",
            "as in name = \"my-board\"",
        );
    }
    is_name.then(|| value.to_owned())
}
