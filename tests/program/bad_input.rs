//! Bad input of every kind: one clear sentence, exit 2, no panic, nothing on standard output.
//!
//! The sentences are pinned by the words that a user needs: what is wrong, where, and the way out.

#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, Write};
use std::os::unix::ffi::OsStringExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use rustix::fs::{CWD, FileType, Mode, OFlags, mknodat, open};
use rustix::process::{Pid, Signal, kill_process};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};
use tempfile::TempDir;

use crate::recorded;
use crate::undisturbed::undisturbed;

mod cut_off;
mod decoders;

/// The program, with backtraces on, so that a panic shows.
fn tactpad() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.env("RUST_BACKTRACE", "1").env("XDG_CONFIG_HOME", "/no-such-folder").stdin(Stdio::null());
    command
}

/// What the program said to its standard error, after seeing that it did not panic.
fn said(output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!text.contains("panicked") && !text.contains("stack backtrace"), "{text}");
    text
}

/// Sees that the arguments are refused with exit 2 and a sentence that holds all of the words.
fn refuses<A: AsRef<OsStr>>(arguments: &[A], words: &[&str]) {
    let output = tactpad().args(arguments).output().unwrap();
    let arguments: Vec<_> = arguments.iter().map(AsRef::as_ref).collect();
    let text = said(&output);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
    assert!(output.stdout.is_empty(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stdout));
    for word in words {
        assert!(text.contains(word), "{arguments:?} lacks {word:?}: {text}");
    }
}

/// Sees that a shell line of plain words is refused.
fn refuses_line(line: &str, words: &[&str]) {
    let arguments: Vec<_> = line.split(' ').collect();
    refuses(&arguments, words);
}

/// A folder with one file in it.
fn with_file(name: &str, bytes: &[u8]) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    (folder, path)
}

#[test]
fn a_port_that_is_no_pad_is_refused() {
    let (_folder, regular) = with_file("regular", b"hello\n");
    for (port, word) in [
        ("/dev/no-such-port", "does not exist"),
        ("/dev/null", "is not a serial port"),
        ("/tmp", "is not a serial port"),
        (regular.to_str().unwrap(), "is not a serial port"),
    ] {
        refuses_line(&format!("run --output none --pad serial:{port}"), &[port, word]);
    }
    refuses_line("run --output none --wait --pad serial:/dev/null", &["is not a serial port"]);
}

#[test]
fn a_pad_that_names_nothing_is_refused() {
    for (pad, words) in [
        ("tcp:1", ["names no pad", "serial:PATH"]),
        ("serial:", ["lacks the port's path", "/dev/ttyACM0"]),
        ("serial:/dev/null@abc", ["abc", "bits per second"]),
        ("serial:/dev/null@0", ["`0`", "bits per second"]),
        ("serial:/dev/null@99999999999", ["99999999999", "bits per second"]),
    ] {
        refuses_line(&format!("run --output none --pad {pad}"), &words);
    }
}

#[test]
fn an_output_that_cannot_be_is_refused() {
    refuses_line("run --pad virtual --output bogus", &["bogus", "log:FILE"]);
    refuses_line("run --pad virtual --output log:", &["log:FILE"]);
    for place in ["/no-such-folder/log", "/tmp"] {
        let line = format!("run --pad virtual --output log:{place}");
        refuses_line(&line, &[place, "cannot be written", "name another file"]);
    }
}

#[test]
fn a_full_disk_ends_the_run_with_its_name() {
    let mut run = tactpad();
    run.args(["run", "--pad", "virtual", "--output", "log:/dev/full", "--seconds", "5"]);
    let output = run.output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let text = said(&output);
    assert!(text.contains("/dev/full cannot be written"), "{text}");
}

#[test]
fn a_profile_that_is_missing_is_refused() {
    for line in
        ["run --pad virtual --output none --profile", "demo --profile", "profile show", "profile check"]
    {
        refuses_line(&format!("{line} nope"), &["nope", "super-mario, tetris, tank-battle, contra"]);
    }
    let line = "run --pad virtual --output none --profile";
    for (place, why) in [
        ("./nope.toml", "No such file"),
        ("/tmp", "it is a directory"),
        ("/dev/zero", "it is a device"),
        ("/dev/null", "it is a device"),
    ] {
        refuses_line(&format!("{line} {place}"), &[place, "cannot be read", why, "super-mario, tetris"]);
    }
}

#[test]
fn a_profile_that_waits_or_never_ends_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let fifo = folder.path().join("fifo");
    mknodat(CWD, &fifo, FileType::Fifo, Mode::RWXU, 0).unwrap();
    refuses_line(&format!("profile check {}", fifo.display()), &["fifo", "a device or a pipe"]);
    let (_folder, long) = with_file("long.toml", &b"# \n".repeat(100_000));
    refuses_line(
        &format!("profile check {}", long.display()),
        &["long.toml", "longer than 256 kB", "name another"],
    );
}

#[test]
fn a_profile_full_of_mistakes_ends_with_and_more() {
    let text: String = (0..10_000).map(|key| format!("key{key} = {key}\n")).collect();
    let (_folder, path) = with_file("many.toml", text.as_bytes());
    let checked = tactpad().args(["profile", "check", path.to_str().unwrap()]).output().unwrap();
    assert_eq!(checked.status.code(), Some(1));
    let answer = String::from_utf8(checked.stdout).unwrap();
    let findings: Vec<_> = answer.lines().filter(|line| line.contains(": error: ")).collect();
    assert_eq!(findings.len(), 51);
    assert!(findings[50].contains("and more"), "{}", findings[50]);
}

#[test]
fn a_profile_that_is_no_text_is_refused() {
    let (_folder, binary) = with_file("binary.toml", b"schema = 1\nELF\xff\xfe\0\0");
    let path = binary.to_str().unwrap();
    let words = [path, "it is not text", "byte 15 in line 2 is not UTF-8", "name another file"];
    refuses_line(&format!("profile check {path}"), &words);
    refuses_line(&format!("run --pad virtual --output none --profile {path}"), &words);
}

#[test]
fn a_profile_with_errors_says_each_with_its_place() {
    let text =
        "schema = 1\nname = \"Mine\"\noutput = \"mouse\"\n\n[dpad]\nmode = \"5way\"\nmin_force_n = -1.0\n";
    let (_folder, mine) = with_file("mine.toml", text.as_bytes());
    let path = mine.to_str().unwrap();
    let places = [":3:10: error", ":6:8: error", ":7:15: error"].map(|place| format!("{path}{place}"));
    let places = places.each_ref().map(String::as_str);
    refuses_line(&format!("run --pad virtual --output none --profile {path}"), &places);
    // Checking it is no misuse: the answer is no.
    let checked = tactpad().args(["profile", "check", path]).output().unwrap();
    assert_eq!(checked.status.code(), Some(1));
    let answer = said(&checked) + &String::from_utf8_lossy(&checked.stdout);
    assert!(places.iter().all(|place| answer.contains(place)), "{answer}");
}

#[test]
fn an_empty_profile_says_what_it_lacks() {
    let (_folder, empty) = with_file("empty.toml", b"");
    let line = format!("run --pad virtual --output none --profile {}", empty.display());
    refuses_line(&line, &[r#"lacks "schema""#, r#"lacks "output""#, r#"lacks "name""#, "schema = 1"]);
}

#[test]
fn a_profile_that_nests_without_end_is_refused() {
    let text = format!("name = {}{}\n", "[".repeat(100_000), "]".repeat(100_000));
    let (_folder, deep) = with_file("deep.toml", text.as_bytes());
    let path = deep.to_str().unwrap();
    let place = format!("{path}:1:");
    refuses_line(&format!("run --pad virtual --output none --profile {path}"), &[&place, "error"]);
}

#[test]
fn a_capture_that_is_none_is_refused() {
    let (_folder, text) = with_file("text.cap", b"hello\n");
    let (_folder_of_empty, empty) = with_file("empty.cap", b"");
    for path in [text.to_str().unwrap(), empty.to_str().unwrap(), "/dev/null", "/dev/zero"] {
        refuses_line(&format!("replay {path}"), &[path, "is not a capture", "tactpad record"]);
        let line = format!("run --output none --pad capture:{path}");
        refuses_line(&line, &[path, "is not a capture", "tactpad record"]);
    }
    refuses_line("replay /no-such-capture", &["/no-such-capture", "cannot be read"]);
    refuses_line("replay /tmp", &["/tmp", "cannot be read"]);
    refuses_line("replay", &["<CAPTURE>"]);
}

#[test]
fn a_capture_cut_off_or_followed_by_other_data_says_so_and_gives_what_it_holds() {
    let (_folder, path) = with_file("game.cap", b"");
    let name = path.to_str().unwrap();
    recorded::write(&path, "statics", 2);
    let whole = tactpad().args(["replay", name]).output().unwrap();
    let bytes = fs::read(&path).unwrap();
    // Records have more bytes than one, so of two neighbouring cuts one at least goes through a record.
    let cut = |length: usize| {
        fs::write(&path, &bytes[..length]).unwrap();
        tactpad().args(["replay", name]).output().unwrap()
    };
    let halves = [bytes.len() / 2, bytes.len() / 2 + 1].map(cut);
    let is_told = |half: &&Output| said(half).contains(&format!("{name} is cut off at byte"));
    let half = halves.iter().find(is_told).unwrap_or_else(|| panic!("{}", said(&halves[0])));
    let first_lines = |output: &Output, lines: usize| -> Vec<String> {
        String::from_utf8_lossy(&output.stdout).lines().take(lines).map(str::to_owned).collect()
    };
    // The last event may be the letting go at the cut.
    let kept = first_lines(half, usize::MAX).len().saturating_sub(1);
    assert!(kept > 0, "half of the recording holds no event");
    assert_eq!(first_lines(half, kept), first_lines(&whole, kept));
    fs::write(&path, [&bytes[..], b"\xff\xff\xff\xff\xff\xff\xff\xff\xff"].concat()).unwrap();
    let longer = tactpad().args(["replay", name]).output().unwrap();
    assert!(said(&longer).contains(name), "what follows the capture is not passed over: {}", said(&longer));
    for cut in [18, 20, 60] {
        fs::write(&path, &bytes[..cut]).unwrap();
        for line in [format!("replay {name}"), format!("replay {name} --profile contra")] {
            refuses_line(&line, &[name, "holds no play", "tactpad record"]);
        }
        refuses_line(&format!("run --output none --pad capture:{name}"), &[name, "holds no play"]);
    }
}

#[test]
fn a_damaged_capture_gives_what_is_before_the_damage_and_says_where() {
    let (_folder, path) = with_file("game.cap", b"");
    let name = path.to_str().unwrap();
    recorded::write(&path, "statics", 2);
    let whole = tactpad().args(["replay", name]).output().unwrap().stdout;
    let mut bytes = fs::read(&path).unwrap();
    let place = bytes.len() * 3 / 4;
    bytes[place] ^= 0x10;
    fs::write(&path, &bytes).unwrap();
    let damaged = tactpad().args(["replay", name]).output().unwrap();
    assert_eq!(damaged.status.code(), Some(2));
    let text = said(&damaged);
    let told: usize =
        text.split("is damaged at byte ").nth(1).unwrap().split(',').next().unwrap().parse().unwrap();
    assert!((place - 4_200..=place).contains(&told), "byte {place} was changed: {text}");
    assert!(whole.starts_with(&damaged.stdout) && !damaged.stdout.is_empty());
    let (reader, writer) = io::pipe().unwrap();
    drop(reader);
    let unread = tactpad().args(["replay", name]).stdout(writer).output().unwrap();
    assert_eq!(unread.status.code(), Some(2), "{}", said(&unread));
    for line in
        [format!("run --output none --pad capture:{name}"), format!("record {name}.new --pad capture:{name}")]
    {
        refuses_line(&line, &[name, "is damaged at byte"]);
    }
    assert!(!Path::new(&format!("{name}.new")).exists());
}

#[test]
fn contacts_that_are_no_table_of_numbers_are_refused_with_file_and_line() {
    let header = "t_s,x_mm,y_mm,fx_n,fy_n,fz_n\n";
    let rows = |rows: &str| format!("{header}0,0,0,0,0,1\n\n{rows}\n").into_bytes();
    for (text, line, words) in [
        (vec![], 1, &["the file is empty", "x_mm, y_mm, fx_n, fy_n, fz_n"][..]),
        (b"\n \n".to_vec(), 2, &["the file is empty"]),
        (header.into(), 1, &["no contact follows"]),
        (
            b"t_s,y_mm,fx_n,fz_n\n0,0,0,1\n".to_vec(),
            1,
            &["no column is named x_mm, fy_n", "expected is", "t_s if"],
        ),
        (format!("x_mm,{header}0,0,0,0,0,0,1\n").into(), 1, &["two columns are named x_mm"]),
        (vec![0xff; 10_000], 1, &["no column is named"]),
        (rows("0.5,15,0,0,0,abc"), 4, &["fz_n is \"abc\", which is not a number"]),
        (rows("0.5,15,0,0,0,NaN"), 4, &["fz_n is \"NaN\", which is not a number"]),
        (rows("0.5,15,0,0,inf,1"), 4, &["fy_n is \"inf\", which is not a number"]),
        (rows("0.5,15,0,0,0,"), 4, &["fz_n is empty"]),
        (rows("0.5,15,0,0"), 4, &["4 values where the header names 6 columns"]),
        (rows("0.5,15,0,0,0,1,2"), 4, &["7 values where the header names 6 columns"]),
        (rows("0.5,0,0,0,0,1\n0.4,0,0,0,0,1"), 5, &["t_s goes back from 0.5 to 0.4"]),
        (rows("-0.5,0,0,0,0,1"), 4, &["t_s is -0.5, and the pad's are 0 to 1000000 s"]),
        (rows("1e7,0,0,0,0,1"), 4, &["t_s is 1e7, and"]),
        (rows("1,31,0,0,0,1"), 4, &["x_mm is 31, and the pad's are -30 to 30 mm"]),
        (rows("1,0,-31,0,0,1"), 4, &["y_mm is -31, and"]),
        (rows("1,0,0,0,0,101"), 4, &["fz_n is 101, and the pad's are -100 to 100 N"]),
    ] {
        let (_folder, path) = with_file("contacts.csv", &text);
        let path = path.to_str().unwrap();
        let place = format!("{path}:{line}: ");
        let words: Vec<_> = [&[place.as_str()], words].concat();
        refuses_line(&format!("replay --profile contra --contacts {path}"), &words);
    }
    for (place, words) in [
        ("/no-such.csv", ["cannot be read", "CSV"]),
        ("/tmp", ["cannot be read", "directory"]),
        ("/dev/null", ["/dev/null:1: ", "empty"]),
        ("/dev/zero", ["/dev/zero:1: ", "bytes that are zero"]),
    ] {
        refuses_line(
            &format!("replay --profile contra --contacts {place}"),
            &[&[place], &words[..]].concat(),
        );
    }
    refuses_line("replay --contacts any.csv", &["--profile"]);
}

#[test]
fn a_time_that_is_none_is_refused_before_a_file_is_touched() {
    let (_folder, path) = with_file("old", b"precious");
    let old = path.to_str().unwrap();
    for verb in [
        "demo",
        &format!("run --pad virtual --output log:{old}"),
        &format!("record {old} --output log:{old}.log"),
        "latency",
    ] {
        for seconds in ["-1", "-inf", "nan", "inf", "0", "1e300", "86401", "abc", ""] {
            for option in [&["--seconds", seconds][..], &[&format!("--seconds={seconds}")]] {
                let arguments: Vec<_> = verb.split(' ').chain(option.iter().copied()).collect();
                refuses(&arguments, &["--seconds", "write a number of seconds above 0 and up to 86400"]);
            }
        }
    }
    assert_eq!(fs::read(&path).unwrap(), b"precious");
    assert!(!Path::new(&format!("{old}.log")).exists());
}

#[test]
fn a_file_that_is_read_is_not_written_over() {
    let (folder, path) = with_file("game.cap", b"");
    let game = path.to_str().unwrap();
    recorded::write(&path, "inverse", 1);
    let (soft, hard) = (folder.path().join("soft"), folder.path().join("hard"));
    std::os::unix::fs::symlink(&path, &soft).unwrap();
    fs::hard_link(&path, &hard).unwrap();
    let profile = folder.path().join("mine.toml");
    let shown = tactpad().args(["profile", "show", "contra"]).output().unwrap();
    fs::write(&profile, &shown.stdout).unwrap();
    let (mine, new) = (profile.display(), folder.path().join("new"));
    let before = fs::read(&path).unwrap();
    for line in [
        format!("record {game} --pad capture:{game}"),
        format!("record {} --pad capture:{game}", soft.display()),
        format!("record {game} --pad capture:{}", hard.display()),
        format!("run --pad capture:{game} --output log:{}", soft.display()),
        format!("latency --pad capture:{game} --output log:{game}"),
        format!("record {mine} --profile {mine}"),
        format!("demo --profile {mine} --output log:{mine}"),
        format!("record {mine} --decoder {mine}"),
        format!("run --pad virtual --decoder {game} --output log:{}", soft.display()),
        format!("record {0} --output log:{0}", new.display()),
    ] {
        refuses_line(&line, &["would be written over", "name another file"]);
    }
    assert_eq!(fs::read(&path).unwrap(), before);
    assert_eq!(fs::read(&profile).unwrap(), shown.stdout);
    assert!(!new.exists());
}

#[test]
fn a_capture_that_cannot_be_written_is_refused() {
    for place in ["/no-such-folder/game.cap", "/tmp"] {
        let line = format!("record {place} --seconds 1");
        refuses_line(&line, &[place, "cannot be written"]);
        let output = tactpad().args(line.split(' ')).output().unwrap();
        assert!(!said(&output).contains("recording"), "{}", said(&output));
    }
}

#[test]
fn output_that_cannot_be_written_is_named() {
    for line in [
        "profile list",
        "profile show contra",
        "profile check contra --json",
        "demo --seconds 2 --output none",
    ] {
        let full = File::options().write(true).open("/dev/full").unwrap();
        let output = tactpad().args(line.split(' ')).stdout(full).output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{line}");
        assert_eq!(said(&output), "tactpad: cannot write stdout: No space left on device\n", "{line}");
    }
    let output = tactpad().args(["record", "/dev/full", "--seconds", "1"]).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(said(&output).contains("cannot write /dev/full: No space left on device"), "{}", said(&output));
}

#[test]
fn a_recording_without_a_pad_leaves_the_old_capture() {
    let (_folder, path) = with_file("old.cap", b"precious");
    refuses_line(
        &format!("record {} --force --pad serial:/dev/null", path.display()),
        &["is not a serial port"],
    );
    assert_eq!(fs::read(&path).unwrap(), b"precious");
}

#[test]
fn arguments_that_are_no_text_are_refused() {
    let strange = |before: &str| OsString::from_vec([before.as_bytes(), b"\xff\xfe"].concat());
    for arguments in [
        vec![strange("")],
        vec!["demo".into(), strange("")],
        vec!["run".into(), "--pad".into(), strange("serial:")],
        vec!["run".into(), "--pad".into(), "virtual".into(), "--output".into(), strange("")],
        vec!["run".into(), "--pad".into(), "virtual".into(), "--profile".into(), strange("")],
        vec!["run".into(), "--pad".into(), "virtual".into(), "--decoder".into(), strange("")],
        vec!["replay".into(), strange("/no-such-folder/")],
        vec!["profile".into(), "check".into(), strange("")],
    ] {
        refuses(&arguments, &[]);
    }
}

#[test]
fn a_reader_that_goes_away_is_no_panic() {
    for line in [
        "--help",
        "profile list",
        "profile show contra",
        "profile check contra",
        "demo --seconds 2 --output none",
        "demo --seconds 2 --output none --json",
        "demo --seconds 2 --output auto",
        "run --pad virtual --seconds 2 --output log:-",
        "latency --seconds 1 --output none",
    ] {
        let output = undisturbed(|| {
            let (reader, writer) = io::pipe().unwrap();
            drop(reader);
            tactpad().args(line.split(' ')).stdout(writer).output().unwrap()
        });
        let text = said(&output);
        // As with other programs, a reader that has seen enough is no failure.
        assert_eq!(output.status.code(), Some(0), "{line}: {text}");
    }
}

#[test]
fn a_demo_that_is_too_short_to_play_is_refused_and_one_that_plays_says_that_it_went_right() {
    refuses_line("demo --seconds 1 --output none", &["--seconds 1 is too short", "give it 2 or more"]);
    let played =
        undisturbed(|| tactpad().args(["demo", "--seconds", "2", "--output", "none"]).output().unwrap());
    let text = String::from_utf8(played.stdout).unwrap();
    assert_eq!(played.status.code(), Some(0), "{text}");
    assert!(text.contains(" events and ") && text.contains("are those that the player meant"), "{text}");
}

#[test]
fn a_verdict_is_given_even_if_nobody_reads() {
    let (_folder, bad) = with_file("bad.toml", b"schema = 1\n");
    for line in
        [format!("profile check {}", bad.display()), format!("profile check --json {}", bad.display())]
    {
        let (reader, writer) = io::pipe().unwrap();
        drop(reader);
        let output = tactpad().args(line.split(' ')).stdout(writer).output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{line}: {}", said(&output));
    }
}

#[test]
fn an_interrupted_demo_fails_even_if_nobody_reads() {
    for json in [&[][..], &["--json"]] {
        let folder = tempfile::tempdir().unwrap();
        let fifo = folder.path().join("events");
        mknodat(CWD, &fifo, FileType::Fifo, Mode::RWXU, 0).unwrap();
        let (reader, writer) = io::pipe().unwrap();
        drop(reader);
        let mut demo = tactpad();
        demo.args(["demo", "--seconds", "60", "--output", &format!("log:{}", fifo.display())]).args(json);
        let demo = demo.stdout(writer).stderr(Stdio::piped()).spawn().unwrap();
        let mut events = BufReader::new(File::open(&fifo).unwrap());
        // With the first event it is surely playing.
        events.read_line(&mut String::new()).unwrap();
        kill_process(Pid::from_child(&demo), Signal::TERM).unwrap();
        io::copy(&mut events, &mut io::sink()).unwrap();
        let output = demo.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{}", said(&output));
        assert!(said(&output).contains("interrupted"), "{}", said(&output));
    }
}

/// Interrupts a demo after its first event: whether that was while its key was held. A signal takes much less time, but who
/// sends it may be late.
fn is_interrupted_while_a_key_is_held() -> bool {
    let folder = tempfile::tempdir().unwrap();
    let fifo = folder.path().join("events");
    mknodat(CWD, &fifo, FileType::Fifo, Mode::RWXU, 0).unwrap();
    let mut demo = tactpad();
    demo.args(["demo", "--json", "--seconds", "60", "--output", &format!("log:{}", fifo.display())]);
    let demo = demo.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut events = BufReader::new(File::open(&fifo).unwrap());
    let mut first = String::new();
    events.read_line(&mut first).unwrap();
    kill_process(Pid::from_child(&demo), Signal::INT).unwrap();
    let rest: Vec<String> = events.lines().map(Result::unwrap).collect();
    let output = demo.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let count = |name: &str| summary[name].as_u64().unwrap() as usize;
    let is_up = |line: &str| line.contains(r#""value":0}"#);
    assert!(!is_up(&first), "{first}");
    let ups = rest.iter().filter(|line| is_up(line)).count();
    assert_eq!((count("downs"), count("ups")), (1 + rest.len() - ups, ups), "{first}{rest:?}");
    assert_eq!((count("downs"), count("held_at_end")), (ups, 0), "{first}{rest:?}");
    rest.len() == ups
}

#[test]
fn a_demo_that_is_interrupted_while_a_key_is_held_counts_its_release() {
    assert!((0..5).any(|_| is_interrupted_while_a_key_is_held()), "no key is held when it is interrupted");
}

/// A pseudo-terminal: what a device on a serial line is to the program.
struct Line {
    device: File,
    /// Kept open, so that the line does not hang up before and after the program has it.
    _host_side: File,
    path: String,
}

fn open_line() -> Line {
    let device = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    grantpt(&device).unwrap();
    unlockpt(&device).unwrap();
    let path = ptsname(&device, Vec::new()).unwrap().into_string().unwrap();
    let host_side = open(Path::new(&path), OFlags::RDWR | OFlags::NOCTTY, Mode::empty()).unwrap();
    let mut raw = tcgetattr(&host_side).unwrap();
    raw.make_raw();
    tcsetattr(&host_side, OptionalActions::Now, &raw).unwrap();
    Line { device: device.into(), _host_side: host_side.into(), path }
}

/// Sends the bytes every 20 ms, until told to stop.
fn send_on(mut device: File, bytes: &[u8], stop: &Receiver<()>) {
    while stop.recv_timeout(Duration::from_millis(20)) == Err(RecvTimeoutError::Timeout) {
        device.write_all(bytes).unwrap();
    }
}

/// Sees that `run` refuses a device that sends the bytes again and again.
fn refuses_device(bytes: &'static [u8], words: &[&str]) {
    let line = open_line();
    let (stop, stopped) = mpsc::channel();
    let device = line.device.try_clone().unwrap();
    let sending = thread::spawn(move || send_on(device, bytes, &stopped));
    refuses_line(&format!("run --output none --pad serial:{}", line.path), words);
    stop.send(()).unwrap();
    sending.join().unwrap();
}

#[test]
fn a_line_with_other_data_is_refused() {
    let sentence = b"$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n";
    refuses_device(sentence, &["not one tactpad frame", "another device, or another baud rate"]);
}

#[test]
fn a_line_without_data_is_refused() {
    refuses_device(b"", &["sent nothing", "powered", "--wait"]);
}

#[test]
fn a_newer_pad_is_refused_with_its_version() {
    // The body `02 01`, version 2 and an empty sample, with its checksum 0x04E840EB.
    refuses_device(b"\x07\x02\x01\xeb\x40\xe8\x04\x00", &["protocol version 2", "update tactpad"]);
}
