//! Profiles with mistakes, each annotated with what must be said about it.
//!
//! A file in `tests/diagnostics` holds comment lines `# error: LINE:COLUMN message` and `# warning:
//! LINE:COLUMN message`, each optionally followed by `# help: text`, for everything that the profile is
//! expected to raise, in order.

use std::fs;
use std::path::{Path, PathBuf};

use tactpad::mapping::check::{OutputChoice, read};
use tactpad::mapping::diag::{Diagnostic, Severity};
use tactpad::mapping::shipped;

fn folder(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

fn annotation(finding: &Diagnostic) -> String {
    let Diagnostic { severity, message, line, column, help } = finding;
    let help = help.as_ref().map(|help| format!("\n# help: {help}")).unwrap_or_default();
    format!("# {severity}: {line}:{column} {message}{help}")
}

fn annotations(text: &str) -> String {
    let marked =
        |line: &&str| ["# error: ", "# warning: ", "# help: "].iter().any(|mark| line.starts_with(mark));
    text.lines().filter(marked).collect::<Vec<_>>().join("\n")
}

#[test]
fn annotated_profiles_raise_exactly_what_they_say() {
    let mut paths: Vec<_> =
        fs::read_dir(folder("tests/diagnostics")).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    assert!(paths.len() >= 10, "only {} files", paths.len());
    let mut failures = String::new();
    for path in paths {
        let text = fs::read_to_string(&path).unwrap();
        let (profile, found) = read(&text, OutputChoice::AsWritten);
        let shown = found.iter().map(annotation).collect::<Vec<_>>().join("\n");
        if shown != annotations(&text) {
            failures +=
                &format!("{}\nexpected:\n{}\nfound:\n{shown}\n\n", path.display(), annotations(&text));
        }
        let failed = found.iter().any(|finding| finding.severity == Severity::Error);
        assert_eq!(profile.is_none(), failed, "{}: a profile exactly without errors", path.display());
    }
    assert!(failures.is_empty(), "{failures}");
}

#[test]
fn shipped_profiles_raise_nothing_on_either_output() {
    for name in shipped::names() {
        for output in [OutputChoice::AsWritten, OutputChoice::Keyboard] {
            let (profile, found) = read(shipped::text(name).unwrap(), output);
            assert_eq!((profile.is_some(), found), (true, vec![]), "{name}");
        }
    }
}
