//! The first set-up, answered over a pipe, and what `run` plays after it.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::io::{Read, Write};
use std::path::Path;
use std::process::{Command, Output, Stdio};

use rustix::process::{Pid, Signal, kill_process};
use tempfile::TempDir;

/// The program with a home of its own.
fn program(home: &Path, line: &str) -> Command {
    let mut program = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    program.args(line.split_whitespace()).current_dir(home).env("HOME", home).env("XDG_RUNTIME_DIR", home);
    program.env("XDG_STATE_HOME", home).env("XDG_CONFIG_HOME", home).env_remove("DISPLAY");
    program.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    program
}

/// What it does with these answers.
fn answered(home: &Path, line: &str, answers: &str) -> Output {
    let mut child = program(home, line).spawn().unwrap();
    // It may have ended before it took them all.
    let _ = child.stdin.take().unwrap().write_all(answers.as_bytes());
    child.wait_with_output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// What is kept: the files' names.
fn kept(home: &Path) -> Vec<String> {
    let files = fs::read_dir(home.join("tactpad")).into_iter().flatten().flatten();
    let mut names: Vec<String> = files.map(|entry| entry.file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// The questions that were asked, by their numbers.
fn questions(said: &str) -> Vec<&str> {
    said.lines().filter(|line| line.starts_with(|first: char| first.is_ascii_digit())).collect()
}

/// Whether `run`, with these words and for a moment, says that it plays so.
fn plays(home: &Path, words: &str, title: [&str; 2]) -> bool {
    let ran = program(home, &format!("run {words} --seconds 0.3 --output none")).output().unwrap();
    let told = text(&ran.stderr);
    let first = told.lines().next().unwrap_or_default();
    assert!(ran.status.success() && title.iter().all(|part| first.contains(part)), "{told}");
    true
}

fn home() -> TempDir {
    tempfile::tempdir().unwrap()
}

#[test]
fn answers_over_a_pipe_lead_to_what_run_plays() {
    let home = home();
    // The first answers the question of permission, where that is asked.
    let asked = answered(home.path(), "setup --pad serial:/dev/ttyOfMine", "maybe\nmaybe\nno\n99\ntetris\n");
    let said = text(&asked.stdout);
    assert!(asked.status.success(), "{said}{}", text(&asked.stderr));
    assert!(said.contains("Answer yes or no") && said.contains("there is no profile \"99\""), "{said}");
    assert!(said.contains("\n  tactpad run\n"), "{said}");
    assert!(plays(home.path(), "", ["serial:/dev/ttyOfMine", "Tetris"]));
    let waits = program(home.path(), "run --seconds 0.3 --output none").output().unwrap();
    assert!(text(&waits.stderr).contains("waiting for the pad: plug it in"), "{}", text(&waits.stderr));
    assert!(plays(home.path(), "--pad virtual", ["virtual", "Tetris"]));
    assert!(plays(home.path(), "--profile contra", ["serial:/dev/ttyOfMine", "Contra"]));
}

#[test]
fn enter_takes_what_is_in_brackets_and_there_are_five_questions_at_most() {
    let home = home();
    let asked = answered(home.path(), "setup --try no", "\n\n\n\n\n");
    let said = text(&asked.stdout);
    assert!(asked.status.success(), "{said}{}", text(&asked.stderr));
    assert!((2..=5).contains(&questions(&said).len()), "{said}");
    // A game that is installed stands before the others.
    let is_usual = |name: &&str| said.contains(&format!("[{name}]: "));
    let usual = ["supertux", "btanks", "vitetris", "super-mario"].into_iter().find(is_usual);
    assert!(said.contains("[1]: ") && usual.is_some(), "{said}");
    assert_eq!(said.contains("Games that are installed here:"), usual != Some("super-mario"), "{said}");
    let by_options = answered(home.path(), "setup --pad virtual --try no --profile contra --yes", "");
    assert!(by_options.status.success(), "{}", text(&by_options.stderr));
    assert!(text(&by_options.stdout).contains("\n  tactpad run\n"));
    assert!(plays(home.path(), "", ["virtual", "Contra"]), "a pad of software is kept, too");
    let doctor = text(&program(home.path(), "doctor").output().unwrap().stdout);
    assert!(doctor.contains("plays with the pad virtual, profile contra, output auto"), "{doctor}");
}

#[test]
fn the_demo_plays_the_profile_that_was_chosen_and_says_where_it_cannot() {
    let home = home();
    let chosen = |name: &str| {
        fs::create_dir_all(home.path().join("tactpad")).unwrap();
        fs::write(home.path().join("tactpad/last-profile"), format!("{name}\n")).unwrap();
        program(home.path(), "demo --seconds 2").output().unwrap()
    };
    assert!(text(&chosen("one-button").stdout).contains("The profile types keys"));
    let gone = chosen("gone");
    assert!(!text(&gone.stdout).contains("The profile types keys"));
    assert!(text(&gone.stderr).contains("gone, cannot be used any more: playing super-mario"));
}

#[test]
fn what_ends_before_its_end_keeps_nothing() {
    let home = home();
    for answers in ["", "1\n", "1\n\n", "1\n\nno\n", "1\n\nno\ntet"] {
        let asked = answered(home.path(), "setup --pad virtual", answers);
        assert_eq!(asked.status.code(), Some(1), "{answers:?}: {}", text(&asked.stdout));
        assert!(text(&asked.stderr).contains("nothing was kept"), "{answers:?}");
        assert_eq!(kept(home.path()), [""; 0]);
    }
    let mut child = program(home.path(), "setup").spawn().unwrap();
    let mut said = Vec::new();
    let mut byte = [0];
    while !said.ends_with(b"[1]: ") {
        assert_eq!(child.stdout.as_mut().unwrap().read(&mut byte).unwrap(), 1, "{}", text(&said));
        said.push(byte[0]);
    }
    kill_process(Pid::from_child(&child), Signal::INT).unwrap();
    assert!(!child.wait().unwrap().success());
    assert_eq!(kept(home.path()), [""; 0], "Ctrl-C");
}

#[test]
fn what_names_nothing_is_refused_before_any_question() {
    let home = home();
    fs::write(home.path().join("bad.toml"), "schema = 1\n").unwrap();
    for (line, told) in [
        ("--profile nonsense", "there is no profile \"nonsense\""),
        ("--pad nonsense:/dev/ttyUSB0", "there is no description \"nonsense\""),
        ("--pad mine:/dev/ttyUSB0 --source bad.toml", "bad.toml"),
        ("--source bad.toml", "--pad"),
        ("--pad nonsense", "names no pad"),
    ] {
        let refused = answered(home.path(), &format!("setup {line}"), "1\n\nno\n\n");
        assert_eq!((refused.status.code(), text(&refused.stdout).as_str()), (Some(2), ""), "{line}");
        assert!(text(&refused.stderr).contains(told), "{line}: {}", text(&refused.stderr));
        assert_eq!(kept(home.path()), [""; 0], "{line}");
    }
}

#[test]
fn a_description_of_ones_own_is_kept_with_its_pad() {
    let home = home();
    let shown = program(home.path(), "source new my-board").output().unwrap();
    fs::write(home.path().join("my-board.toml"), shown.stdout).unwrap();
    let line = "setup --pad my-board:/dev/ttyOfMine --source my-board.toml --try no --profile tetris --yes";
    let asked = answered(home.path(), line, "");
    assert!(asked.status.success(), "{}", text(&asked.stderr));
    let elsewhere = home.path().join("elsewhere");
    fs::create_dir(&elsewhere).unwrap();
    let ran =
        program(home.path(), "run --seconds 0.3 --output none").current_dir(elsewhere).output().unwrap();
    let told = text(&ran.stderr);
    assert!(ran.status.success() && told.contains("my-board:/dev/ttyOfMine"), "{told}");
}

#[test]
fn it_is_tried_by_the_demo_where_there_is_no_pad() {
    let home = home();
    let asked = answered(home.path(), "setup --pad virtual --try yes --profile tetris --yes", "");
    let said = text(&asked.stdout);
    assert!(asked.status.success(), "{}", text(&asked.stderr));
    // How it went is the demo's affair, on a machine that may do other things.
    let is_told = said.contains("are those that the player meant") || said.contains("That did not go well");
    assert!(is_told && said.contains(" frames, "), "{said}");
}
