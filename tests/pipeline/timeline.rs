//! Timelines: what is done to the pad, and which edges must come out.
//!
//! A file in `tests/pipeline/timeline` holds cases of three blocks each, separated by empty lines; `#` starts a
//! comment line.
//!
//! ```text
//! case a short press taps
//! profile super-mario                  a shipped profile
//! set dpad.hysteresis_deg = 10         changes or adds a line; button.1.press_n is the first button's
//! remove button.1                      takes a button away
//! add [[button]]                       a line at the end
//! output keyboard                      play the keyboard's bindings
//! watch presses                        what becomes of presses is expected, too, see below
//!
//! 0ms x=20 y=0 fz=1.0                  one sample; fx, fy, fz, x, y are 0 if absent
//! 5ms angle=30 r=20 fz=1.0             the place in polar coordinates
//! 10ms..100ms angle=0..90 r=20 fz=1.0  one sample each millisecond, values on a straight line
//! 110ms lift                           the contact ends; `fault` cancels; `switch NAME` plays another
//!
//! 0ms ABS_HAT0X 1                      the expected edges, releases first, or the word `nothing`;
//! 0ms bridge panic                     what is asked of the bridge comes after them,
//! 0ms accepted button 1                and what becomes of presses after that: `rejected left slow`, `rest`
//! ```

#![allow(clippy::expect_used, reason = "a timeline that cannot be read must fail its test")]

use std::fs;
use std::path::Path;

use tactpad::pipeline::mapping::live::engine::Engine;
use tactpad::pipeline::mapping::live::intent::Intents;
use tactpad::pipeline::mapping::live::verdict::{Reason, VerdictEvent};
use tactpad::pipeline::mapping::profile::{Command, Profile};
use tactpad::pipeline::mapping::read::check::{OutputChoice, read};
use tactpad::pipeline::mapping::read::shipped;
use tactpad::quantity::Contact;
use tactpad::time::StreamInstant;

/// The text of a profile with `assignment` (`table.key = value`) put in place of the old line or added.
fn assigned(text: &str, assignment: &str) -> String {
    let (path, value) = assignment.split_once('=').expect("set PATH = VALUE");
    let (wanted, key) = path.trim().rsplit_once('.').unwrap_or(("", path.trim()));
    let starts = |line: &str| line.split_once('=').is_some_and(|(name, _)| name.trim() == key);
    let (mut table, mut buttons, mut lines, mut end) = (String::new(), 0, Vec::new(), None);
    for line in text.lines() {
        if line.starts_with("[[button]]") {
            buttons += 1;
            table = format!("button.{buttons}");
        } else if let Some(name) = line.strip_prefix('[') {
            table = name.trim_end_matches(']').to_owned();
        }
        if table != wanted || !starts(line) {
            lines.push(line.to_owned());
        }
        if table == wanted && !line.is_empty() {
            end = Some(lines.len());
        }
    }
    lines.insert(end.expect("the table is in the profile"), format!("{key} ={value}"));
    lines.join("\n")
}

/// The text of a profile without a button (`button.1` is the first one).
fn without(text: &str, button: &str) -> String {
    let number: usize = button.strip_prefix("button.").and_then(|n| n.parse().ok()).expect("remove button.N");
    let mut parts: Vec<&str> = text.split("[[button]]").collect();
    assert!((1..parts.len()).contains(&number), "{button} is in the profile");
    parts.remove(number);
    parts.join("[[button]]")
}

fn profile(text: &str, output: OutputChoice) -> Profile {
    let (profile, found) = read(text, output);
    profile.unwrap_or_else(|| panic!("{found:?}\n{text}"))
}

/// A case: its name, its profile, and whether what becomes of presses is expected.
fn head(block: &[&str]) -> (String, Profile, bool) {
    let (mut name, mut text, mut output) = (String::new(), String::new(), OutputChoice::AsWritten);
    let mut is_watched = false;
    for line in block {
        match line.split_once(' ').expect("a word and its value") {
            ("case", rest) => name = rest.to_owned(),
            ("profile", shipped) => text = shipped::text(shipped).expect("a shipped profile").to_owned(),
            ("set", assignment) => text = assigned(&text, assignment),
            ("remove", button) => text = without(&text, button),
            ("add", line) => text = format!("{}\n{line}\n", text.trim_end()),
            ("output", "keyboard") => output = OutputChoice::Keyboard,
            ("watch", "presses") => is_watched = true,
            other => panic!("unknown line {other:?}"),
        }
    }
    (name, profile(&text, output), is_watched)
}

/// A value that runs from its first to its last over the samples of a line.
fn ramp(text: &str) -> (f64, f64) {
    let number = |text: &str| text.parse().unwrap_or_else(|_| panic!("{text} is no number"));
    text.split_once("..")
        .map_or_else(|| (number(text), number(text)), |(from, to)| (number(from), number(to)))
}

fn contact(words: &[&str], share: f64) -> Contact {
    let value = |key: &str| {
        let text = words.iter().find_map(|word| word.strip_prefix(key)?.strip_prefix('='))?;
        let (from, to) = ramp(text);
        Some(from + (to - from) * share)
    };
    let force = |key| value(key).unwrap_or(0.0) as f32;
    let (x, y) = match (value("angle"), value("r")) {
        (Some(angle), Some(r)) => (r * angle.to_radians().cos(), r * angle.to_radians().sin()),
        _ => (value("x").unwrap_or(0.0), value("y").unwrap_or(0.0)),
    };
    Contact { x_mm: x as f32, y_mm: y as f32, fx_n: force("fx"), fy_n: force("fy"), fz_n: force("fz") }
}

/// The edges between what was held and what is held now.
fn edges(ms: u64, old: &Intents, new: &Intents) -> Vec<String> {
    let same = |a: &Intents, code| a.iter().any(|level| level.code == code);
    let released = old.iter().filter(|level| !same(new, level.code)).map(|level| (level.code, 0));
    let pressed = new.iter().filter(|level| !old.contains(level)).map(|level| (level.code, level.value));
    released.chain(pressed).map(|(code, value)| format!("{ms}ms {code} {value}")).collect()
}

fn milliseconds(text: &str) -> u64 {
    text.strip_suffix("ms").and_then(|n| n.parse().ok()).unwrap_or_else(|| panic!("{text} is no time"))
}

/// A command as a profile writes it.
fn shown(command: &Command) -> String {
    match command {
        Command::NextProfile => "next-profile".into(),
        Command::Profile(name) => format!("profile {name}"),
        Command::TogglePause => "pause".into(),
        Command::Panic => "panic".into(),
        Command::Tare => "tare".into(),
    }
}

/// What became of a press.
fn judged(told: &VerdictEvent) -> String {
    let (whose, rejected) = match told {
        VerdictEvent::Button { number, rejected } => (format!("button {number}"), rejected),
        VerdictEvent::Direction { direction, rejected } => (direction.name().to_owned(), rejected),
        VerdictEvent::Rest => return "rest".into(),
    };
    match rejected {
        None => format!("accepted {whose}"),
        Some(Reason::Slow) => format!("rejected {whose} slow"),
        Some(Reason::Bounce) => format!("rejected {whose} bounce"),
        Some(Reason::Dwell) => format!("rejected {whose} dwell"),
    }
}

/// The steps that one input line stands for, each with the levels after it and what is asked of the bridge, or told.
fn play(engine: &mut Engine, is_watched: bool, line: &str) -> Vec<(u64, Intents, Vec<String>)> {
    let words: Vec<_> = line.split_whitespace().collect();
    let (time, action) = words.split_first().expect("a time");
    let (from, to) = time.split_once("..").unwrap_or((time, time));
    let (from, to) = (milliseconds(from), milliseconds(to));
    let mut step = |ms: u64, contact: Option<&Contact>| {
        let levels = engine.step(StreamInstant::from_us(ms * 1_000), contact);
        let asked = engine.commands().iter().map(|command| format!("{ms}ms bridge {}", shown(command)));
        let told = engine.verdicts().iter().filter(|_| is_watched);
        let asked = asked.chain(told.map(|verdict| format!("{ms}ms {}", judged(&verdict.told)))).collect();
        engine.forget_verdicts();
        (ms, levels, asked)
    };
    match action {
        ["fault"] => {
            engine.cancel();
            vec![(from, Intents::new(), Vec::new())]
        }
        ["switch", name] => {
            engine.replace_profile(profile(
                shipped::text(name).expect("a shipped profile"),
                OutputChoice::AsWritten,
            ));
            Vec::new()
        }
        ["lift"] => (from..=to).map(|ms| step(ms, None)).collect(),
        _ => {
            let share = |ms: u64| (ms - from) as f64 / (to - from).max(1) as f64;
            (from..=to).map(|ms| step(ms, Some(&contact(action, share(ms))))).collect()
        }
    }
}

fn played(profile: Profile, is_watched: bool, input: &[&str]) -> Vec<String> {
    let mut engine = Engine::new(profile);
    let mut held = Intents::new();
    let mut found = Vec::new();
    for line in input {
        for (ms, levels, asked) in play(&mut engine, is_watched, line) {
            found.extend(edges(ms, &held, &levels));
            found.extend(asked);
            held = levels;
        }
    }
    found
}

#[test]
fn timelines() {
    let mut cases = 0;
    let mut failures = String::new();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pipeline/timeline");
    let mut paths: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    for path in paths {
        let text = fs::read_to_string(&path).unwrap();
        let lines: Vec<_> = text.lines().map(str::trim).filter(|line| !line.starts_with('#')).collect();
        let blocks: Vec<_> = lines.split(|line| line.is_empty()).filter(|block| !block.is_empty()).collect();
        assert_eq!(blocks.len() % 3, 0, "{}: three blocks per case", path.display());
        for case in blocks.chunks(3) {
            let (name, profile, is_watched) = head(case[0]);
            let expected: Vec<_> = case[2].iter().filter(|line| **line != "nothing").copied().collect();
            let found = played(profile, is_watched, case[1]);
            cases += 1;
            if found != expected {
                failures +=
                    &format!("{}: {name}\n  expected {expected:?}\n  found    {found:?}\n", path.display());
            }
        }
    }
    assert!(failures.is_empty(), "{failures}");
    assert!(cases >= 120, "only {cases} cases were found");
}
