//! Names that one part of a profile gives, and another asks for: of zones, layers and macros.

use crate::toml_text::diag::{Findings, quoted};
use crate::toml_text::section::{Placed, Section};
use crate::toml_text::spelling;

/// Reads the name of a `kind` of table; one that is taken already is reported.
pub(crate) fn read(
    table: &Section<'_>,
    kind: &str,
    is_taken: impl Fn(&str) -> bool,
    findings: &mut Findings<'_>,
) -> Option<String> {
    table.require("name", &format!("write name = \"…\", by which buttons ask for the {kind}"), findings);
    let name = table.name("name", findings)?;
    if is_taken(name) {
        let message = format!("a {kind} {} stands above already", quoted(name));
        findings.error(table.place_of("name")?, message, "give this one another name");
    }
    Some(name.to_owned())
}

/// Which one of `known` is asked for; none (and a finding) where there is no such one.
pub(crate) fn find(
    Placed { value: name, at }: Placed<&str>,
    kind: &str,
    known: &[&str],
    findings: &mut Findings<'_>,
) -> Option<usize> {
    let found = known.iter().position(|it| *it == name);
    if found.is_none() {
        let help = match spelling::nearest(name, known.iter().copied()) {
            Some(near) => format!("did you mean \"{near}\"?"),
            None if known.is_empty() => format!("write a [[{kind}]] of that name"),
            None => format!("known here: {}", known.join(", ")),
        };
        findings.error(at, format!("there is no {kind} {}", quoted(name)), help);
    }
    found
}

/// Reports the first of more than `most` tables of a `kind`.
pub(crate) fn check_count(tables: &[Section<'_>], kind: &str, most: usize, findings: &mut Findings<'_>) {
    if let Some(extra) = tables.get(most) {
        findings.error(extra.at, format!("a profile has at most {most} {kind}s"), "remove this one");
    }
}
