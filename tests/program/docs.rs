//! The figures in README.md and docs/: each stands under the command that makes it.
//!
//! ```text
//! <!-- tactpad layout -->              what it prints is the block of text below, up to its closing fence
//! <!-- tactpad layout --figures @ -->  the image below is of the same name in the folder @
//! ```
//!
//! `docs/make` writes them anew and `docs/make --check` says which are stale. As some take a minute, a plain test run holds only
//! that every figure has its command. Besides, README.md is short, docs/README.md is an index of all pages, and docs/verbs.md has
//! each verb in one group.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may stop at what it did not expect")]

mod stale;

use std::collections::BTreeMap;
#[cfg(target_os = "linux")]
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use stale::{differs, drawing_differs};

/// Set by `docs/make`: `write` or `check`.
const MODE: &str = "TACTPAD_DOCS";
/// Set by `docs/make PAGE...`: these alone, as `docs/size.md`.
const PAGES: &str = "TACTPAD_DOCS_PAGES";

const MARK: &str = "<!-- tactpad ";
const MARK_END: &str = " -->";
const FENCE: &str = "```";

/// A folder in which a command finds what others made before it, and `@` in its arguments.
const FOLDER: &str = "@";

/// What that folder is called where a command prints its name.
const SHOWN_FOLDER: &str = "figures";

/// README.md is read in one go.
const README_LINES_MAX: usize = 130;

/// What stands under a command in a page.
#[derive(Debug, PartialEq, Eq)]
enum Shown {
    /// Lines of the page, from and up to these, between fences.
    Text { from: usize, to: usize },
    /// An image beside the page.
    Image(String),
}

/// A command in a page, and what stands under it.
#[derive(Debug, PartialEq, Eq)]
struct Made {
    command: String,
    shown: Shown,
}

/// All that a page says of what is made, or the line of a mark under which there is nothing of that kind.
fn made(lines: &[&str]) -> Result<Vec<Made>, usize> {
    let marks = lines.iter().enumerate().filter_map(|(at, line)| {
        let command = line.strip_prefix(MARK)?.strip_suffix(MARK_END)?;
        let below = lines.get(at + 1).copied().unwrap_or_default();
        let shown = match below.strip_prefix("![").and_then(|image| image.split_once("](")) {
            Some((_, name)) => Some(Shown::Image(name.trim_end_matches(')').to_owned())),
            None if below.starts_with(FENCE) => lines[at + 2..]
                .iter()
                .position(|line| *line == FENCE)
                .map(|length| Shown::Text { from: at + 2, to: at + 2 + length }),
            None => None,
        };
        Some(shown.map(|shown| Made { command: command.to_owned(), shown }).ok_or(at + 1))
    });
    marks.collect()
}

fn pages() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut pages: Vec<PathBuf> = fs::read_dir(root.join("docs"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "md"))
        .collect();
    pages.push(root.join("README.md"));
    pages.sort();
    pages
}

fn asked_pages() -> Vec<PathBuf> {
    let asked = std::env::var(PAGES).unwrap_or_default();
    let asked: Vec<PathBuf> =
        asked.split_whitespace().map(|page| Path::new(env!("CARGO_MANIFEST_DIR")).join(page)).collect();
    let pages = pages();
    asked.iter().for_each(|page| assert!(pages.contains(page), "{} is no page", page.display()));
    if asked.is_empty() { pages } else { asked }
}

/// Commands that were run, with what they printed and the folder that is their `@`.
struct Runs {
    folder: tempfile::TempDir,
    done: BTreeMap<String, (String, PathBuf)>,
}

impl Runs {
    fn of(&mut self, command: &str) -> &(String, PathBuf) {
        let index = self.done.len();
        let root = self.folder.path();
        self.done.entry(command.to_owned()).or_insert_with(|| {
            let figures = root.join(index.to_string());
            // A command that writes one figure, not a folder of them, makes no folder.
            fs::create_dir_all(&figures).unwrap();
            let words = command.split(' ').map(|word| word.replace(FOLDER, &figures.to_string_lossy()));
            println!("tactpad {command}");
            let mut program = Command::new(env!("CARGO_BIN_EXE_tactpad"));
            let output = program.args(words).current_dir(root).output().unwrap();
            let complaint = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "tactpad {command}: {complaint}");
            let printed = String::from_utf8(output.stdout).unwrap();
            (printed.replace(&*figures.to_string_lossy(), SHOWN_FOLDER), figures)
        })
    }
}

/// Holds a page against what its commands make, and returns it as it should be; its stale figures go to `stale`.
fn renewed(page: &Path, runs: &mut Runs, stale: &mut Vec<String>) -> (String, Vec<(PathBuf, PathBuf)>) {
    let text = fs::read_to_string(page).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let (mut renewed, mut images, mut written) = (String::new(), Vec::new(), 0);
    for Made { command, shown } in made(&lines).unwrap() {
        let (printed, figures) = runs.of(&command);
        match shown {
            Shown::Text { from, to } => {
                if let Some(difference) = differs(&lines[from..to].join("\n"), printed.trim_end()) {
                    stale.push(format!("{}:{}: {difference}", page.display(), from + 1));
                }
                lines[written..from].iter().for_each(|line| renewed.extend([line, "\n"]));
                renewed.extend([printed.trim_end(), "\n"]);
                written = to;
            }
            Shown::Image(name) => {
                let (there, drawn) = (page.with_file_name(&name), figures.join(&name));
                let [before, now] = [&there, &drawn].map(|path| fs::read_to_string(path).unwrap_or_default());
                if drawing_differs(&before, &now) {
                    stale.push(format!("{}: {name}", page.display()));
                }
                images.push((drawn, there));
            }
        }
    }
    lines[written..].iter().for_each(|line| renewed.extend([line, "\n"]));
    (renewed, images)
}

/// Whether a line shows a drawing; a link to one that another page shows is none.
fn is_drawing(line: &str) -> bool {
    line.contains(".svg)") && line.starts_with("![")
}

#[test]
fn every_figure_has_its_command() {
    let mut images = 0;
    for page in pages() {
        let text = fs::read_to_string(&page).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        let made = made(&lines).unwrap_or_else(|line| panic!("{}:{line}: nothing under it", page.display()));
        for (at, line) in lines.iter().enumerate().filter(|(_, line)| is_drawing(line)) {
            let commanded =
                made.iter().any(|made| matches!(&made.shown, Shown::Image(name) if line.contains(name)));
            let by_hand = lines[at - 1].starts_with("<!-- by ");
            assert!(commanded || by_hand, "{}:{}: no command above it", page.display(), at + 1);
            images += 1;
        }
    }
    assert!(images > 5, "{images} images");
}

#[test]
fn figures_are_what_the_program_makes() {
    let Ok(mode) = std::env::var(MODE) else { return };
    assert!(mode == "write" || mode == "check", "{MODE} is write or check");
    let mut runs = Runs { folder: tempfile::tempdir().unwrap(), done: BTreeMap::new() };
    let mut stale = Vec::new();
    for page in asked_pages() {
        let before = stale.len();
        let (text, images) = renewed(&page, &mut runs, &mut stale);
        if mode == "write" && stale.len() > before {
            fs::write(&page, text).unwrap();
            images.iter().for_each(|(drawn, there)| {
                fs::copy(drawn, there).unwrap();
            });
        }
    }
    assert!(!runs.done.is_empty(), "the pages name commands");
    stale.iter().for_each(|stale| println!("stale: {stale}"));
    assert!(mode == "write" || stale.is_empty(), "docs/make writes them anew:\n{}", stale.join("\n"));
}

#[test]
fn marks_are_found_with_what_is_under_them() {
    let page = "a\n<!-- tactpad x -->\n```text\n1\n2\n```\n<!-- tactpad y @ -->\n![b](c.svg)";
    let lines: Vec<&str> = page.lines().collect();
    let text = Made { command: "x".into(), shown: Shown::Text { from: 3, to: 5 } };
    let image = Made { command: "y @".into(), shown: Shown::Image("c.svg".into()) };
    assert_eq!(made(&lines), Ok(vec![text, image]));
    assert_eq!(made(&["<!-- tactpad x -->", "nothing"]), Err(1));
}

fn page(name: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(name)).unwrap()
}

#[test]
fn the_readme_is_short() {
    let lines = page("README.md").lines().count();
    assert!(lines <= README_LINES_MAX, "{lines} lines");
}

#[test]
fn the_index_has_every_page() {
    let index = page("docs/README.md");
    for path in pages() {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let link = if name == "README.md" { "(../README.md)".to_owned() } else { format!("({name}") };
        assert!(index.contains(&link), "docs/README.md lacks {name}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn each_verb_is_in_one_group_of_its_page() {
    let text = page("docs/verbs.md");
    let mut groups: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for section in text.split("\n## ").skip(1) {
        let group = section.lines().next().unwrap_or_default();
        let rows = section.lines().filter_map(|line| line.strip_prefix("| `"));
        for verb in rows.filter_map(|row| row.split([' ', '`']).next()) {
            groups.entry(verb).or_default().insert(group);
        }
    }
    let output = Command::new(env!("CARGO_BIN_EXE_tactpad")).args(["completions", "fish"]).output().unwrap();
    let completions = String::from_utf8(output.stdout).unwrap();
    let named = completions.lines().filter(|line| line.contains("\"__fish_tactpad_needs_command\""));
    let named = named.filter_map(|line| line.split("-f -a \"").nth(1)?.split('"').next());
    let verbs: BTreeSet<&str> = named.filter(|verb| *verb != "help").collect();
    assert!(verbs.len() > 20, "{verbs:?}");
    assert_eq!(groups.keys().copied().collect::<BTreeSet<_>>(), verbs);
    let twice: Vec<_> = groups.iter().filter(|(_, groups)| groups.len() != 1).collect();
    assert!(twice.is_empty(), "{twice:?}");
}
