//! The rules of ARCHITECTURE.md that a program can check.

#[path = "tidy/circles.rs"]
mod circles;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Rooms by row: the folders and files right below `src/`. A room imports only rows above its own, never a sibling.
const ROWS: &[&[&str]] = &[
    &["bytes", "numeric", "plot", "quantity", "time", "toml_text"],
    &["network", "pad"],
    &["mechanics", "pipeline"],
    &["tables", "virtual_pad"],
    &["bridge", "lab"],
    &["dashboard", "tray"],
    &["cli"],
];

/// Rows of rooms that do no I/O and read no clock.
const PURE_ROWS: usize = 4;

/// What the pure rooms may not say: clocks, I/O, threads, logs, panics, hash maps. (Lints watch over `unwrap`.)
const BANNED_IN_PURE_ROWS: &[&str] = &[
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
const BANNED_FILE_NAMES: &[&str] =
    &["manager", "helper", "helpers", "util", "utils", "common", "handler", "data", "info", "base"];

const FILE_LINES_MAX: usize = 450;
const FUNCTION_LINES_MAX: usize = 45;
const FUNCTION_LINES_P90: usize = 20;
const FUNCTION_LINES_MEDIAN: usize = 8;
/// Files and folders right below `src/`: what is seen at a glance.
const ROOMS_MAX: usize = 19;

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

/// The program's own sources, as (module, path, text before the tests).
fn sources() -> Vec<(String, PathBuf, String)> {
    let src = root().join("src");
    let read = |path: PathBuf| {
        let inside = path.strip_prefix(&src).ok()?;
        let first = inside.components().next()?.as_os_str().to_string_lossy().into_owned();
        let module = first.trim_end_matches(".rs").to_owned();
        let text = fs::read_to_string(&path).ok()?;
        let code = text.split("#[cfg(test)]\nmod tests").next()?.to_owned();
        Some((module, path, code))
    };
    files(&src, "rs").into_iter().filter_map(read).collect()
}

fn row(module: &str) -> Option<usize> {
    ROWS.iter().position(|row| row.contains(&module))
}

/// The rooms that a source names through `crate::`.
fn imports(code: &str) -> Vec<&str> {
    let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
    let after = lines.flat_map(|line| line.split("crate::").skip(1));
    after.map(|rest| rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or("")).collect()
}

#[test]
fn a_row_imports_only_rows_above_it() {
    let mut wrong = Vec::new();
    for (module, path, code) in sources() {
        if ["lib", "main"].contains(&module.as_str()) {
            continue;
        }
        let Some(own) = row(&module) else {
            wrong.push(format!("{} is in no row", path.display()));
            continue;
        };
        for import in imports(&code).into_iter().filter(|import| *import != module) {
            if row(import).is_none_or(|other| other >= own) {
                wrong.push(format!("{} imports {import}", path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn pure_rooms_have_no_clock_io_or_panic() {
    let mut wrong = Vec::new();
    for (module, path, code) in sources() {
        if row(&module).is_none_or(|row| row >= PURE_ROWS) {
            continue;
        }
        for (number, line) in code.lines().enumerate() {
            let line = line.split("//").next().unwrap_or("");
            for word in BANNED_IN_PURE_ROWS.iter().filter(|word| line.contains(**word)) {
                wrong.push(format!("{}:{}: {word}", path.display(), number + 1));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// A crate's files as modules, with their texts before the tests; without its root.
fn modules(src: &Path) -> Vec<(circles::Module, String)> {
    let module = |path: PathBuf| {
        let inside = path.strip_prefix(src).ok()?.with_extension("");
        let mut names: circles::Module =
            inside.components().map(|name| name.as_os_str().to_string_lossy().into_owned()).collect();
        names.pop_if(|last| ["mod", "lib", "main"].contains(&last.as_str()));
        let code = fs::read_to_string(&path).ok()?.split("#[cfg(test)]\nmod tests").next()?.to_owned();
        (!names.is_empty()).then_some((names, code))
    };
    files(src, "rs").into_iter().filter_map(module).collect()
}

#[test]
fn no_file_imports_one_that_leads_back_to_it() {
    let mut wrong = Vec::new();
    for (name, src) in [("tactpad", "src"), ("firmware_proto", "firmware-proto/src")] {
        wrong.extend(circles::circles(&circles::imports(name, &modules(&root().join(src)))));
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
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

#[test]
fn functions_are_short() {
    let mut lengths = Vec::new();
    let mut wrong = Vec::new();
    let proto = files(&root().join("firmware-proto/src"), "rs");
    let proto = proto.into_iter().filter_map(|path| {
        let text = fs::read_to_string(&path).ok()?;
        Some((String::new(), path, text.split("#[cfg(test)]\nmod tests").next()?.to_owned()))
    });
    for (_, path, code) in sources().into_iter().chain(proto) {
        for (line, length) in function_lengths(&code) {
            lengths.push(length);
            if length > FUNCTION_LINES_MAX {
                wrong.push(format!("{}:{line}: {length} lines", path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    lengths.sort_unstable();
    let (median, p90) = (lengths[lengths.len() / 2], lengths[lengths.len() * 9 / 10]);
    println!("{} functions, median {median} lines, p90 {p90}", lengths.len());
    assert!(median <= FUNCTION_LINES_MEDIAN && p90 <= FUNCTION_LINES_P90, "median {median}, p90 {p90}");
}

#[test]
fn the_house_is_seen_at_a_glance() {
    let rooms = fs::read_dir(root().join("src")).map(Iterator::count).unwrap_or_default();
    assert!((1..=ROOMS_MAX).contains(&rooms), "{rooms} entries in src/");
}

#[test]
fn files_are_short_and_well_named() {
    let mut wrong = Vec::new();
    for (_, path, code) in sources() {
        let lines = code.lines().count();
        if lines > FILE_LINES_MAX {
            wrong.push(format!("{}: {lines} lines before its tests", path.display()));
        }
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if BANNED_FILE_NAMES.contains(&name.as_str()) {
            wrong.push(format!("{}: a name that says nothing", path.display()));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
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

/// What is compiled, with its features, by cargo's own word.
fn compiled(edges: &str) -> BTreeSet<String> {
    let mut tree = Command::new(env!("CARGO"));
    tree.args([
        "tree",
        "--workspace",
        "--locked",
        "--offline",
        "--prefix",
        "none",
        "-f",
        "{p} {f}",
        "-e",
        edges,
    ]);
    let output = tree.current_dir(root()).output().unwrap_or_else(|error| panic!("cargo tree: {error}"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    text.lines().map(|line| line.trim_end_matches(" (*)").to_owned()).collect()
}

/// What tests depend on may ask for more features of what the program depends on, too. Then that is built once for each, and
/// so is all above it, up to the program.
#[test]
fn nothing_is_built_anew_for_the_tests() {
    let (program, tests) = (compiled("normal,build"), compiled("normal,build,dev"));
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
fn places_that_pages_name_are_there() {
    let mut wrong = Vec::new();
    for path in files(&root(), "md") {
        let text = fs::read_to_string(&path).unwrap_or_default();
        let quoted = text.split('`').skip(1).step_by(2);
        for place in quoted.filter(|quoted| quoted.starts_with("src/") || quoted.starts_with("tests/")) {
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
