//! The rules of ARCHITECTURE.md that a program can check.

#[path = "tidy/circles.rs"]
mod circles;
#[path = "tidy/supply.rs"]
mod supply;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Folders of sources: the program's, those of the crates, the wire's.
const SOURCES: &[&str] = &[
    "src",
    "crates/core/src",
    "crates/numeric/src",
    "crates/plot/src",
    "crates/mechanics/src",
    "crates/inference/src",
    "crates/lab/src",
    "crates/paper/src",
    "crates/bridge/src",
    "crates/desktop/src",
    "firmware-proto/src",
];

/// Of them those that do no I/O and read no clock.
const PURE: &[&str] = &[
    "crates/core/src",
    "crates/inference/src",
    "crates/mechanics/src",
    "crates/numeric/src",
    "crates/plot/src",
    "firmware-proto/src",
];

/// The one file of them that keeps what it computed on the disk.
const KEEPS_FIELDS: &str = "crates/mechanics/src/field_cache.rs";

/// What they may not say: clocks, I/O, threads, logs, panics, hash maps. (Lints watch over `unwrap`.)
const BANNED_IN_PURE: &[&str] = &[
    "std::time",
    "std::fs",
    "std::net",
    "std::thread",
    "std::env",
    "std::process",
    "println!",
    "panic!(",
    "unreachable!(",
    "HashMap",
    "HashSet",
];

const BANNED_WORDS: &[&str] = &["TODO", "FIXME", "XXX", "todo!(", "unimplemented!("];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_path_buf()
}

/// All files below `folder` with this extension, without build output.
fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        let hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        if path.is_dir() && !path.ends_with("target") && !hidden {
            found.extend(files(&path, extension));
        } else if path.extension().is_some_and(|found| found == extension) {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// A source: its path, and its text before the tests.
struct Source {
    path: PathBuf,
    code: String,
}

/// The sources below these folders.
fn sources(folders: &[&str]) -> Vec<Source> {
    let read = |path: PathBuf| {
        let code = fs::read_to_string(&path).ok()?.split("#[cfg(test)]\nmod tests").next()?.to_owned();
        Some(Source { path, code })
    };
    folders.iter().flat_map(|folder| files(&root().join(folder), "rs")).filter_map(read).collect()
}

#[test]
fn every_crates_sources_are_looked_at() {
    let crates = fs::read_dir(root().join("crates")).into_iter().flatten().flatten();
    let missing: Vec<String> = crates
        .map(|entry| format!("crates/{}/src", entry.file_name().to_string_lossy()))
        .filter(|folder| !SOURCES.contains(&folder.as_str()))
        .collect();
    assert!(missing.is_empty(), "{missing:?} are in no list of this file");
    for folder in SOURCES {
        assert!(!sources(&[folder]).is_empty(), "{folder} has no sources");
    }
}

#[test]
fn pure_crates_have_no_clock_io_or_panic() {
    let mut wrong = Vec::new();
    let kept = root().join(KEEPS_FIELDS);
    for Source { path, code } in sources(PURE).into_iter().filter(|source| source.path != kept) {
        for (number, line) in code.lines().enumerate() {
            let line = line.split("//").next().unwrap_or("");
            for word in BANNED_IN_PURE.iter().filter(|word| line.contains(**word)) {
                wrong.push(format!("{}:{}: {word}", path.display(), number + 1));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// A crate's files as modules, with their texts before the tests; without its root.
fn modules(folder: &str) -> Vec<(circles::Module, String)> {
    let src = root().join(folder);
    let module = |source: Source| {
        let inside = source.path.strip_prefix(&src).ok()?.with_extension("");
        let mut names: circles::Module =
            inside.components().map(|name| name.as_os_str().to_string_lossy().into_owned()).collect();
        names.pop_if(|last| ["mod", "lib", "main"].contains(&last.as_str()));
        (!names.is_empty()).then_some((names, source.code))
    };
    sources(&[folder]).into_iter().filter_map(module).collect()
}

#[test]
fn no_file_imports_one_that_leads_back_to_it() {
    for folder in SOURCES {
        let circles = circles::circles(&circles::imports(&modules(folder)));
        assert!(circles.is_empty(), "{folder}: {circles:#?}");
    }
}

/// Lengths of functions, by indentation: from `fn` to the closing brace in the same column.
fn function_lengths(code: &str) -> Vec<(usize, usize)> {
    let lines: Vec<&str> = code.lines().collect();
    let mut lengths = Vec::new();
    for (number, line) in lines.iter().enumerate() {
        let indent = line.len() - line.trim_start().len();
        let words = line.trim_start().split('(').next().unwrap_or("");
        if !words.split_whitespace().any(|word| word == "fn") || words.starts_with("//") {
            continue;
        }
        let end = format!("{}}}", " ".repeat(indent));
        let signature_end = lines.iter().skip(number).find(|line| line.ends_with(['{', '}', ';']));
        match signature_end {
            Some(line) if line.ends_with('}') => lengths.push((number + 1, 1)),
            Some(line) if line.ends_with('{') => {
                let length = lines.iter().skip(number).position(|line| **line == end);
                lengths.extend(length.map(|length| (number + 1, length + 1)));
            }
            // A declaration without a body.
            _ => {}
        }
    }
    lengths
}

/// No limits: what a reader needs is cohesion, and limits only move code to where it does not belong.
/// `cargo test --release --test tidy lengths -- --nocapture` prints them.
#[test]
fn lengths_are_reported() {
    let sources = sources(SOURCES);
    let mut functions: Vec<(usize, String)> = Vec::new();
    let mut whole: Vec<(usize, String)> = Vec::new();
    for Source { path, code } in &sources {
        let of_file = function_lengths(code).into_iter();
        functions.extend(of_file.map(|(line, length)| (length, format!("{}:{line}", path.display()))));
        whole.push((code.lines().count(), path.display().to_string()));
    }
    for (what, lengths) in [("functions", &mut functions), ("files", &mut whole)] {
        lengths.sort();
        let at = |share: usize| lengths[(lengths.len() - 1) * share / 100].0;
        println!("{} {what}: median {} lines, p90 {}", lengths.len(), at(50), at(90));
        for (length, place) in lengths.iter().rev().take(10) {
            println!("  {length:4} {place}");
        }
    }
    assert!(functions.len() > 1_000 && whole.len() > 100, "the sources were read");
}

#[test]
fn nothing_is_left_for_later() {
    let mut wrong = Vec::new();
    for path in files(&root(), "rs").into_iter().filter(|path| !path.ends_with("tests/tidy.rs")) {
        let text = fs::read_to_string(&path).unwrap_or_default();
        for (number, line) in text.lines().enumerate() {
            for word in BANNED_WORDS.iter().filter(|word| line.contains(**word)) {
                wrong.push(format!("{}:{}: {word}", path.display(), number + 1));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// A test is left out of `cargo test` for one reason only: it is a proof, and `tests/proofs` reads its time, if it has one, and its
/// reason.
#[test]
fn what_is_ignored_is_a_proof_with_its_time_and_reason() {
    let is_in_form = |line: &str| {
        let words = line.trim_start().strip_prefix("#[ignore = \"proof: ")?.strip_suffix("\"]")?;
        let (seconds, reason) = words.split_once(" s: ").unwrap_or(("0", words));
        Some(seconds.parse::<u32>().is_ok() && reason.len() > 10 && !reason.contains('"'))
    };
    let mut wrong = Vec::new();
    for path in files(&root(), "rs").into_iter().filter(|path| !path.ends_with("tests/tidy.rs")) {
        let text = fs::read_to_string(&path).unwrap_or_default();
        let is_below_tests = path.components().any(|part| part.as_os_str() == "tests");
        let next = text.lines().skip(1).chain(Some(""));
        for (number, (line, next)) in text.lines().zip(next).enumerate() {
            let is_ignored =
                line.contains("#[ignore") || line.contains("cfg_attr") && line.contains("ignore");
            let is_read = is_below_tests && next.trim_start().starts_with("fn ");
            if is_ignored && (is_in_form(line) != Some(true) || !is_read) {
                wrong.push(format!("{}:{}: {line}", path.display(), number + 1));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Packages that are compiled, with their features, by cargo's own word; `arguments` say of which packages and edges.
fn compiled(arguments: &[&str]) -> BTreeSet<String> {
    let mut tree = Command::new(env!("CARGO"));
    tree.args(["tree", "--locked", "--offline", "--prefix", "none", "-f", "{p} {f}"]).args(arguments);
    let output = tree.current_dir(root()).output().unwrap_or_else(|error| panic!("cargo tree: {error}"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    text.lines().map(|line| line.trim_end_matches(" (*)").to_owned()).collect()
}

/// Tests, and what they depend on, may ask for more features of a package than the program does. Then it is built once for
/// each, and so is all above it, up to the program.
#[test]
fn nothing_is_built_anew_for_the_tests() {
    let program = compiled(&["-p", "tactpad", "-e", "normal,build"]);
    let tests = compiled(&["--workspace", "-e", "normal,build,dev"]);
    let anew: Vec<_> = program.difference(&tests).collect();
    assert!(program.len() > 100 && anew.is_empty(), "{anew:#?}");
}

#[test]
fn every_page_has_one_title_and_links_that_lead_somewhere() {
    let mut wrong = Vec::new();
    for path in files(&root(), "md") {
        let text = fs::read_to_string(&path).unwrap_or_default();
        let prose = outside_code(&text);
        let titles = prose.iter().filter(|line| line.starts_with("# ")).count();
        if titles != 1 {
            wrong.push(format!("{}: {titles} titles", path.display()));
        }
        for target in prose.iter().flat_map(|line| link_targets(line)) {
            let file = target.split('#').next().unwrap_or("");
            let there = path.parent().is_some_and(|folder| folder.join(file).exists());
            if !file.is_empty() && !file.contains("://") && !there {
                wrong.push(format!("{}: {target} leads nowhere", path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn each_fault_that_is_told_of_has_a_test_and_each_patch_a_place() {
    let page = fs::read_to_string(root().join("docs/faults.md")).unwrap_or_default();
    let rows: Vec<&str> =
        page.lines().filter(|line| line.starts_with("| ") && line.ends_with("` |")).collect();
    assert!(rows.len() > 20, "{rows:?}");
    let all: String = ["crates", "tests"]
        .iter()
        .flat_map(|folder| files(&root().join(folder), "rs"))
        .filter_map(|path| fs::read_to_string(path).ok())
        .collect();
    let cell = |row: &str, number| row.split('|').nth(number).unwrap_or_default().trim().to_owned();
    let name = |row: &&str| cell(row, 4).replace('`', "");
    let is_missing = |name: &String| !all.contains(&format!("fn {name}("));
    let missing: Vec<String> = rows.iter().map(name).filter(is_missing).collect();
    assert!(missing.is_empty(), "tests that docs/faults.md names are not there: {missing:#?}");
    let put_back: Vec<String> = rows.iter().map(|row| cell(row, 5)).collect();
    for patch in files(&root().join("tests/mutations"), "patch") {
        let name = format!("`{}`", patch.file_stem().unwrap_or_default().display());
        assert!(put_back.iter().any(|cell| cell.contains(&name)), "docs/faults.md has no row for {name}");
        let text = fs::read_to_string(&patch).unwrap_or_default();
        let lines = text.lines();
        let to = lines.clone().find_map(|line| line.strip_prefix("+++ b/")).unwrap_or_default();
        let source = fs::read_to_string(root().join(to)).unwrap_or_default();
        let old: String = lines
            .skip(3)
            .filter(|line| !line.starts_with('+'))
            .filter_map(|line| line.get(1..))
            .map(|line| format!("{line}\n"))
            .collect();
        assert!(source.contains(&old), "{} does not apply", patch.display());
    }
}

#[test]
fn places_that_pages_name_are_there() {
    let mut wrong = Vec::new();
    for path in files(&root(), "md") {
        let text = fs::read_to_string(&path).unwrap_or_default();
        let quoted = text.split('`').skip(1).step_by(2);
        let is_place = |quoted: &&str| ["src/", "crates/", "tests/"].iter().any(|it| quoted.starts_with(it));
        for place in quoted.filter(is_place) {
            let place = place.split([' ', '*']).next().unwrap_or("");
            if !root().join(place).exists() {
                wrong.push(format!("{}: {place} is not there", path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

fn outside_code(text: &str) -> Vec<&str> {
    let mut inside = false;
    let mut prose = Vec::new();
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            inside = !inside;
        } else if !inside {
            prose.push(line);
        }
    }
    prose
}

fn link_targets(line: &str) -> Vec<&str> {
    line.split("](").skip(1).filter_map(|rest| rest.split(')').next()).collect()
}
