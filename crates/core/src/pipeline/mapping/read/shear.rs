//! What of a profile can do nothing on a pad that measures no forces along the plate.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::toml_text;
use crate::toml_text::diag::{Diagnostic, Findings};

/// Words for forces along the plate, as values of a profile.
const SHEAR_WORDS: [&str; 5] = ["fx", "-fx", "fy", "-fy", "shear"];

/// Warnings about each place of a profile's text that asks for a force along the plate; none for a text that is no TOML.
pub fn bound_to_shear(text: &str) -> Vec<Diagnostic> {
    let mut findings = Findings::new(text);
    if let Some(tree) = toml_text::parse(text, "", &mut findings) {
        look_at_table(tree.get_ref(), &mut findings);
    }
    findings.finish()
}

fn look_at_table(table: &DeTable<'_>, findings: &mut Findings<'_>) {
    for (key, value) in table {
        // Names may be any words.
        if key.get_ref() != "name" {
            look_at(key.get_ref(), value, findings);
        }
    }
}

fn look_at(key: &str, value: &Spanned<DeValue<'_>>, findings: &mut Findings<'_>) {
    match value.get_ref() {
        DeValue::String(word) if SHEAR_WORDS.contains(&word.as_ref()) => findings.warning(
            value.span().start,
            format!("\"{key}\" is \"{word}\", and this pad measures no force along the plate: it does nothing"),
            "take \"fz\" with another threshold, a zone or a long press, or a profile without it, as super-mario",
        ),
        DeValue::Table(table) => look_at_table(table, findings),
        DeValue::Array(values) => values.iter().for_each(|value| look_at(key, value, findings)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::super::shipped;
    use super::*;

    #[test]
    fn each_binding_of_shear_is_told_with_its_line() {
        let text = shipped::text("contra").unwrap();
        let line = 1 + text.lines().position(|line| line == "force = \"fy\"").unwrap();
        let found = bound_to_shear(text);
        assert_eq!(found.iter().map(|found| found.line).collect::<Vec<_>>(), [line]);
        assert!(
            found[0]
                .message
                .starts_with("\"force\" is \"fy\", and this pad measures no force along the plate")
        );
        assert_eq!(bound_to_shear(shipped::text("super-mario").unwrap()), []);
        assert_eq!(bound_to_shear("name = \"fx\"\n[[button]]\nname = \"fy\"\n"), []);
        assert_eq!(bound_to_shear("[stick]\nfrom = \"shear\"\n").len(), 1);
    }
}
