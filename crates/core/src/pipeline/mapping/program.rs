//! For which programs a profile is.

use crate::toml_text::diag::Findings;
use crate::toml_text::section::Section;

/// The most programs that a profile can name.
pub const PROGRAMS_MAX: usize = 16;

pub(super) const PROGRAM_KEYS: [&str; 2] = ["class", "executable"];

/// The longest name of a class or an executable; a path is the longest of these.
const CHARS_MAX: usize = 256;

/// A program, by what its windows and its process say of it. What is not named may be anything.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Program {
    /// A word of the window's class (`WM_CLASS`), in any case.
    pub class: Option<String>,
    /// The name of the executable, or its whole path.
    pub executable: Option<String>,
}

impl Program {
    /// Whether a window with these words for its class is this program's, whose process runs the executable with this path, if that is
    /// known.
    pub fn is(&self, classes: &[&str], executable: Option<&str>) -> bool {
        let has_class =
            |wanted: &String| classes.iter().any(|class| class.to_lowercase() == wanted.to_lowercase());
        let runs = |wanted: &String| {
            let name = executable.map(|path| path.rsplit('/').next().unwrap_or(path));
            if wanted.contains('/') { executable == Some(wanted) } else { name == Some(wanted) }
        };
        self.class.as_ref().is_none_or(has_class) && self.executable.as_ref().is_none_or(runs)
    }
}

/// Reads all `[[program]]`s.
pub(super) fn read(tables: &[Section<'_>], findings: &mut Findings<'_>) -> Vec<Program> {
    if let Some(extra) = tables.get(PROGRAMS_MAX) {
        findings.error(
            extra.at,
            format!("a profile names at most {PROGRAMS_MAX} programs"),
            "remove this one",
        );
    }
    tables.iter().map(|table| read_one(table, findings)).collect()
}

fn read_one(table: &Section<'_>, findings: &mut Findings<'_>) -> Program {
    if table.is_empty() {
        findings.misplaced(
            table.at,
            format!("{} names no program", table.title),
            "write class = \"…\", as `xprop WM_CLASS` tells it of the window that you click, or executable = \"…\"",
        );
    }
    let [class, executable] = PROGRAM_KEYS.map(|key| read_word(table, key, findings));
    Program { class, executable }
}

fn read_word(table: &Section<'_>, key: &str, findings: &mut Findings<'_>) -> Option<String> {
    let word = table.text(key, findings)?;
    let text = word.value.trim();
    if text.is_empty() || text.chars().count() > CHARS_MAX || text.chars().any(char::is_control) {
        findings.error(word.at, format!("\"{key}\" must be one line of 1 to {CHARS_MAX} characters"), "");
        return None;
    }
    Some(text.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn program(class: &str, executable: &str) -> Program {
        let named = |text: &str| (!text.is_empty()).then(|| text.to_owned());
        Program { class: named(class), executable: named(executable) }
    }

    #[test]
    fn all_that_is_named_must_fit() {
        let tetris = (["quadra", "Quadrapassel"], Some("/usr/games/quadrapassel"));
        for (class, executable, fits) in [
            ("quadrapassel", "", true),
            ("QUADRA", "", true),
            ("quad", "", false),
            ("", "quadrapassel", true),
            ("", "/usr/games/quadrapassel", true),
            ("", "/opt/quadrapassel", false),
            ("", "Quadrapassel", false),
            ("Quadrapassel", "quadrapassel", true),
            ("Quadrapassel", "other", false),
            ("Other", "quadrapassel", false),
        ] {
            assert_eq!(program(class, executable).is(&tetris.0, tetris.1), fits, "{class:?} {executable:?}");
        }
        assert!(!program("", "x").is(&["x"], None), "an executable that is not known is none");
        assert!(program("x", "").is(&["x"], None));
    }
}
