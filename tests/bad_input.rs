//! Bad input of every kind: one clear sentence, exit 2, no panic, nothing on standard output.
//!
//! The sentences are pinned by the words that a user needs: what is wrong, where, and the way out.

#![cfg(all(target_os = "linux", feature = "live"))]
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::io::{self, Write};
use std::os::unix::ffi::OsStringExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use rustix::fs::{Mode, OFlags, open};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};
use tempfile::TempDir;

/// The program, with backtraces on, so that a panic shows.
fn tactpad() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.env("RUST_BACKTRACE", "1").stdin(Stdio::null());
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
        ("usb:1", ["names no pad", "serial:PATH"]),
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
    refuses_line(&format!("{line} ./nope.toml"), &["./nope.toml", "cannot be read"]);
    refuses_line(&format!("{line} /tmp"), &["/tmp", "cannot be read"]);
}

#[test]
fn a_profile_that_is_no_text_is_refused() {
    let (_folder, binary) = with_file("binary.toml", &[0x7f, b'E', b'L', b'F', 0xff, 0xfe, 0, 0]);
    let path = binary.to_str().unwrap();
    refuses_line(&format!("profile check {path}"), &[path, "UTF-8"]);
    refuses_line(&format!("run --pad virtual --output none --profile {path}"), &[path, "UTF-8"]);
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
    let recorded = tactpad().args(["record", name, "--seconds", "2"]).output().unwrap();
    assert_eq!(recorded.status.code(), Some(0), "{}", said(&recorded));
    let whole = tactpad().args(["replay", name]).output().unwrap();
    let bytes = fs::read(&path).unwrap();
    fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    let half = tactpad().args(["replay", name]).output().unwrap();
    assert!(said(&half).contains(&format!("{name} is cut off at byte")), "{}", said(&half));
    let first_lines = |output: &Output, lines: usize| -> Vec<String> {
        String::from_utf8_lossy(&output.stdout).lines().take(lines).map(str::to_owned).collect()
    };
    // The last event may be the letting go at the cut.
    let kept = first_lines(&half, usize::MAX).len().saturating_sub(1);
    assert!(kept > 0, "half of the recording holds no event");
    assert_eq!(first_lines(&half, kept), first_lines(&whole, kept));
    fs::write(&path, [&bytes[..], b"\xff\xff\xff\xff\xff\xff\xff\xff\xff"].concat()).unwrap();
    let longer = tactpad().args(["replay", name]).output().unwrap();
    assert!(said(&longer).contains(name), "what follows the capture is not passed over: {}", said(&longer));
}

#[test]
fn contacts_that_are_no_table_of_numbers_are_refused_with_file_and_line() {
    let header = "t_s,x_mm,y_mm,fx_n,fy_n,fz_n";
    for (text, line, word) in [
        (format!("{header}\n0,0,0,0,0,1\n0.5,15,0,0,0,abc\n"), "line: 3", "float"),
        (format!("{header}\n0,0,0,0,0,1\n0.5,15,0,0,0,\n"), "line: 3", "empty"),
        (format!("{header}\n0,0,0,0,0,1\n0.5,15,0,0\n"), "line: 3", "4 fields"),
        ("t_s,y_mm,fx_n,fy_n,fz_n\n0,0,0,0,1\n".to_owned(), "line: 2", "x_mm"),
        (format!("x_mm,{header}\n0,0,0,0,0,0,1\n"), "line: 2", "x_mm"),
    ] {
        let (_folder, path) = with_file("contacts.csv", text.as_bytes());
        let path = path.to_str().unwrap();
        refuses_line(&format!("replay --profile contra --contacts {path}"), &[path, line, word]);
    }
    refuses_line("replay --profile contra --contacts /no-such.csv", &["/no-such.csv"]);
    refuses_line("replay --contacts any.csv", &["--profile"]);
}

#[test]
fn a_time_that_is_none_is_refused() {
    for seconds in ["-1", "nan", "inf", "1e300", "86401"] {
        refuses_line(&format!("demo --seconds={seconds}"), &["--seconds", "between 0 and 86400"]);
    }
    for verb in ["demo", "run --pad virtual --output none", "record /no-such-folder/game.cap", "latency"] {
        refuses_line(&format!("{verb} --seconds abc"), &["abc", "--seconds"]);
        refuses_line(&format!("{verb} --seconds="), &["--seconds"]);
    }
}

#[test]
fn a_capture_that_cannot_be_written_is_refused() {
    for place in ["/no-such-folder/game.cap", "/tmp"] {
        refuses_line(&format!("record {place} --seconds 1"), &[place, "cannot be written"]);
    }
}

#[test]
fn a_recording_without_a_pad_leaves_the_old_capture() {
    let (_folder, path) = with_file("old.cap", b"precious");
    refuses_line(&format!("record {} --pad serial:/dev/null", path.display()), &["is not a serial port"]);
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
        "demo --seconds 1 --output none",
        "demo --seconds 1 --output none --json",
        "latency --seconds 1 --output none",
    ] {
        let (reader, writer) = io::pipe().unwrap();
        drop(reader);
        let output = tactpad().args(line.split(' ')).stdout(writer).stderr(Stdio::piped()).spawn().unwrap();
        let output = output.wait_with_output().unwrap();
        let text = said(&output);
        // As with other programs, a reader that has seen enough is no failure.
        assert_eq!(output.status.code(), Some(0), "{line}: {text}");
    }
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
