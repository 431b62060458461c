//! Profiles with mistakes, each annotated with what must be said about it.
//!
//! A file in `tests/pipeline/diagnostics` holds comment lines `# error: LINE:COLUMN message` and `# warning:
//! LINE:COLUMN message`, each optionally followed by `# help: text`, for everything that the profile is
//! expected to raise, in order.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use tactpad::pipeline::mapping::read::check::{OutputChoice, read};
use tactpad::pipeline::mapping::read::shipped;
use tactpad::toml_text::TEXT_BYTES_MAX;
use tactpad::toml_text::diag::{Diagnostic, Severity};

#[cfg(target_os = "linux")]
use crate::worked::worked;

fn folder(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

fn annotation(finding: &Diagnostic) -> String {
    let Diagnostic { severity, message, line, column, help, .. } = finding;
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
    let mut paths: Vec<_> = fs::read_dir(folder("tests/pipeline/diagnostics"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
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

/// Texts of the longest length that is read, full of what costs the checker most.
fn endless_texts() -> Vec<String> {
    let numbered = |line: fn(usize) -> String| {
        (0..TEXT_BYTES_MAX).map(line).scan(0, |length, line| {
            *length += line.len();
            (*length <= TEXT_BYTES_MAX).then_some(line)
        })
    };
    let button =
        "[[button]]\nforce = \"fz\"\npress_n = 1\nout = { gamepad = \"BTN_A\", keyboard = \"KEY_A\" }\n";
    vec![
        numbered(|number| format!("press_{number} = {number}\n")).collect(),
        numbered(|_| "= = [\n".to_owned()).collect(),
        numbered(|_| "a = 1\n".to_owned()).collect(),
        format!("a = [{}", "1,".repeat(TEXT_BYTES_MAX / 2 - 3)),
        format!("{}b = 1", "a.".repeat(TEXT_BYTES_MAX / 2 - 3)),
        button.repeat(TEXT_BYTES_MAX / button.len()),
    ]
}

#[cfg(target_os = "linux")]
#[test]
fn checking_is_bounded_whatever_the_text() {
    let mut texts = endless_texts();
    assert!(texts.iter().all(|text| (TEXT_BYTES_MAX - 300..=TEXT_BYTES_MAX).contains(&text.len())));
    texts.push("key = 1\n".repeat(1_000_000 / 8));
    for text in texts {
        let start = worked();
        let (profile, found) = read(&text, OutputChoice::AsWritten);
        let (took, shown) = (worked() - start, &text[..20]);
        assert!(profile.is_none() && (1..=51).contains(&found.len()), "{shown}: {} findings", found.len());
        // A slow machine needs a third of this; a checker that is not linear would need minutes.
        assert!(took < Duration::from_secs(1), "{shown}: {took:?}");
    }
}

#[test]
fn a_text_is_read_up_to_its_limit() {
    let shown = shipped::text("contra").unwrap();
    let filled = |length: usize| format!("{shown}{}", " ".repeat(length - shown.len()));
    assert_eq!(read(&filled(TEXT_BYTES_MAX), OutputChoice::AsWritten).1, vec![]);
    let (profile, found) = read(&filled(TEXT_BYTES_MAX + 1), OutputChoice::AsWritten);
    assert!(profile.is_none() && found[0].message.contains("longer than 256 kB"), "{found:?}");
}
