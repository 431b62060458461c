//! docs/paper.md: a row for every figure and table of the paper, whose command is one of this program and whose
//! pictures are there.
#![allow(clippy::unwrap_used, reason = "a test may stop at what it did not expect")]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The paper's figures and tables.
const FIGURES: u32 = 12;
const TABLES: u32 = 7;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// A row of the page's tables.
struct Row {
    line: usize,
    /// What of the paper it is.
    of: String,
    command: String,
    text: String,
}

/// All rows that have a command. A row without one is no row: the page says what is missing in words instead.
fn rows() -> Vec<Row> {
    let page = fs::read_to_string(root().join("docs/paper.md")).unwrap();
    let mut rows = Vec::new();
    for (line, text) in (1..).zip(page.lines()) {
        let Some(cells) = text.strip_prefix("| ") else { continue };
        let command = cells.split('`').nth(1);
        let is_head = cells.starts_with("|");
        assert!(is_head || command.is_some(), "docs/paper.md:{line}: no command");
        if let Some(command) = command {
            let of = cells.split(" |").next().unwrap_or_default().to_owned();
            rows.push(Row { line, of, command: command.to_owned(), text: text.to_owned() });
        }
    }
    rows
}

/// What `tactpad VERB --help` prints, if there is such a verb.
fn help(verb: &str) -> Option<String> {
    let output =
        Command::new(env!("CARGO_BIN_EXE_tactpad")).args(verb.split(' ')).arg("--help").output().unwrap();
    output.status.success().then(|| String::from_utf8(output.stdout).unwrap())
}

/// Whether the program would take a command: its verbs are there, and its options are theirs.
fn is_taken(command: &str) -> Result<(), String> {
    let words: Vec<&str> = command.split(' ').collect();
    let options = words.iter().position(|word| word.starts_with("--")).unwrap_or(words.len());
    // `protocol paper`: what is no verb of its own is an argument of the one before it.
    let mut verbs = words[1..options].join(" ");
    let mut text = help(&verbs);
    if text.is_none() {
        verbs = words[1].to_owned();
        text = help(&verbs);
    }
    let text = text.ok_or_else(|| format!("no verb {verbs}"))?;
    let known: BTreeSet<&str> = text.split([' ', '\n', ',', '[', ']', '|', '=']).collect();
    let unknown = words[options..].iter().find(|word| word.starts_with("--") && !known.contains(*word));
    unknown.map_or(Ok(()), |option| Err(format!("{verbs} has no {option}")))
}

#[test]
fn every_figure_and_table_has_a_row() {
    let rows = rows();
    let numbers = |kind: &str| -> BTreeSet<u32> {
        let of_kind = rows.iter().filter_map(|row| row.of.strip_prefix(kind));
        let digits = |rest: &str| {
            let rest = rest.trim_start_matches("s").trim_start();
            rest.chars().take_while(char::is_ascii_digit).collect::<String>()
        };
        of_kind.map(|rest| digits(rest).parse().unwrap()).collect()
    };
    assert_eq!(numbers("Figure"), (1..=FIGURES).collect());
    assert_eq!(numbers("Table"), (1..=TABLES).collect());
}

#[test]
fn each_rows_command_is_one() {
    for Row { line, command, .. } in rows() {
        let taken = match command.strip_prefix("tactpad ") {
            Some(_) => is_taken(&command),
            None => {
                let script = command.split(' ').next().unwrap_or_default();
                let is_there = root().join(script).is_file();
                is_there.then_some(()).ok_or_else(|| format!("{script} is not there"))
            }
        };
        assert_eq!(taken, Ok(()), "docs/paper.md:{line}");
    }
}

#[test]
fn linked_pictures_are_there_and_on_a_page_that_makes_them() {
    let pages: Vec<String> = fs::read_dir(root().join("docs"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "md"))
        .map(|path| fs::read_to_string(path).unwrap())
        .collect();
    let mut pictures = 0;
    for Row { line, text, .. } in rows() {
        let links = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
        for picture in links.filter(|link| is_picture(link)) {
            assert!(root().join("docs").join(picture).is_file(), "docs/paper.md:{line}: {picture}");
            // There docs/make, or a script that the page names, makes it.
            let shown =
                pages.iter().any(|page| page.lines().any(|l| l.starts_with("![") && l.contains(picture)));
            assert!(shown, "docs/paper.md:{line}: no page shows {picture}");
            pictures += 1;
        }
    }
    assert!(pictures >= 4, "{pictures}");
}

fn is_picture(link: &str) -> bool {
    Path::new(link)
        .extension()
        .is_some_and(|extension| ["svg", "png", "webp"].iter().any(|kind| extension == *kind))
}

#[test]
fn commands_that_are_none_are_seen() {
    assert_eq!(is_taken("tactpad layout --radii 33,33,33"), Ok(()));
    assert_eq!(is_taken("tactpad protocol paper --out plan.csv"), Ok(()));
    assert_eq!(is_taken("tactpad layout --radius 33"), Err("layout has no --radius".to_owned()));
    assert_eq!(is_taken("tactpad lay --out"), Err("no verb lay".to_owned()));
}
