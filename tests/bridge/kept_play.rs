//! Play that a bridge keeps: private, bounded, held against the decoder, told by `ctl status`, taken by the verbs.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use firmware_proto::identity::SerialNumber;
use tactpad::lab::play::kept::KeptPlay;
use tactpad::lab::play::reader::Reader;
use tactpad::pad::field::PadField;
use tactpad::pipeline::capture::reader::CaptureReader;
use tactpad::pipeline::contact::Decoder;
use tactpad::pipeline::contact::field_error::{ErrorMode, FieldError, TERMS};
use tactpad::pipeline::contact::inverse::Inverse;
use tactpad::pipeline::contact::uncertainty::Noise;
use tactpad::quantity::CHANNELS;

use crate::control::await_status;
use crate::guest::in_guest;
use crate::running::{Running, comes_true};

const TACTPAD: &str = env!("CARGO_BIN_EXE_tactpad");
/// A pad whose module 1 has lost a tenth.
const WORN: &str = "[noise]\nadditive_uv = 5.0\n[[module]]\nindex = 1\ngain = [0.9, 0.9, 0.9]\n";

/// The nominal pad as if it had been calibrated: its z channels may be off by a thousandth.
fn decoder() -> Decoder {
    let mut mode = ErrorMode { mixture: [[0.0; CHANNELS]; CHANNELS], maps: [[0.0; 27]; TERMS] };
    [2, 5, 8].into_iter().for_each(|channel| mode.mixture[channel][channel] = 1e-3);
    let noise = Noise::of_channels([6.0; CHANNELS], [0.01; CHANNELS]);
    let error = FieldError::of(vec![mode]).unwrap();
    Decoder::from(Inverse::new(PadField::nominal().signals, noise).with_field_error(error))
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("my.decoder"), decoder().to_bytes("a test's").unwrap()).unwrap();
    folder
}

fn bridge(folder: tempfile::TempDir, more: &str) -> Running {
    let mut program = Running::program(TACTPAD, folder.path());
    let line = format!("run --pad virtual --decoder my.decoder --output none{more}");
    program.args(line.split(' ')).env("XDG_STATE_HOME", folder.path().join("state"));
    Running::start(folder, program)
}

/// Plays for a moment, and ends.
fn played(folder: tempfile::TempDir, more: &str) -> tempfile::TempDir {
    let mut bridge = bridge(folder, more);
    await_status(&bridge, "plays", |status| status["presses"]["accepted"].as_u64() > Some(0));
    assert!(bridge.ctl("quit").status.success());
    assert!(bridge.ends().is_some_and(|status| status.success()));
    std::mem::replace(&mut bridge.folder, tempfile::tempdir().unwrap())
}

fn tactpad(folder: &Path, words: &[&str]) -> Output {
    Command::new(TACTPAD).args(words).current_dir(folder).output().unwrap()
}

/// The only file of kept play.
fn kept_file(folder: &Path) -> Option<PathBuf> {
    let files = fs::read_dir(folder.join("state/tactpad/play")).ok()?;
    let files: Vec<_> = files.map(|it| it.unwrap().path()).collect();
    assert_eq!(files.len(), 1, "{files:?}");
    files.into_iter().next()
}

/// Makes of the kept file one with three minutes on the worn pad.
fn wear(folder: &Path, file: &Path) {
    fs::write(folder.join("worn.toml"), WORN).unwrap();
    let line = "twin --plan play --seconds 240 --imperfections worn.toml --out worn.cap";
    assert!(tactpad(folder, &line.split(' ').collect::<Vec<_>>()).status.success());
    let bytes = fs::read(folder.join("worn.cap")).unwrap();
    let mut capture = CaptureReader::new(bytes.as_slice()).unwrap();
    let profile = capture.head().profile.as_ref().unwrap().profile().clone();
    let mut reader = Reader::new(decoder(), profile);
    while let Some(call) = capture.next_call() {
        let (now, call) = call.unwrap();
        reader.apply(now, call);
    }
    let was = KeptPlay::from_bytes(&fs::read(file).unwrap()).unwrap();
    let mut kept = KeptPlay::new(was.pad, was.decoder);
    kept.add(&reader.finish());
    fs::write(file, kept.to_bytes()).unwrap();
}

#[test]
fn play_is_kept_in_private_and_what_changed_is_told() {
    // What is played until the comparison begins counts in it.
    in_guest("kept_play::play_is_kept_in_private_and_what_changed_is_told", kept_and_told);
}

fn kept_and_told() {
    let folder = played(folder(), "");
    let file = kept_file(folder.path()).unwrap();
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
    assert_eq!((mode(&file), mode(file.parent().unwrap())), (0o600, 0o700));
    let kept = KeptPlay::from_bytes(&fs::read(&file).unwrap()).unwrap();
    assert_eq!((kept.pad.as_str(), kept.windows().is_empty()), ("VIRTUAL-0001", false));

    wear(folder.path(), &file);
    let mut bridge = bridge(folder, "");
    let told = |bridge: &Running| bridge.status()["changes"]["text"].as_str().map(str::to_owned);
    assert!(comes_true(|| told(&bridge).is_some()), "{}", bridge.status());
    let changes = bridge.status()["changes"].clone();
    let text = changes["text"].as_str().unwrap();
    assert!(text.contains("module 1 has lost ") && text.contains(": tactpad diagnose --play "), "{text}");
    assert_eq!(changes["findings"][0]["effect"], "module_gain");
    assert!(changes["since"].as_str().unwrap().ends_with("/my.decoder"), "{changes}");
    let said = String::from_utf8(bridge.ctl("status").stdout).unwrap();
    assert!(said.contains(&format!("\nchanges  {text}\n")), "{said}");
    assert!(bridge.ctl("quit").status.success());
    assert!(bridge.ends().is_some_and(|status| status.success()));
    // The command that it says finds the same.
    let command = text.split_once(": tactpad ").unwrap().1;
    let found = tactpad(bridge.folder.path(), &command.split(' ').collect::<Vec<_>>());
    let found = String::from_utf8(found.stdout).unwrap();
    assert!(found.contains("module 1 has lost ") && found.contains("--from"), "{found}");
}

#[test]
fn nothing_is_kept_where_nobody_wants_it_or_nothing_is_known_of_the_pad() {
    let folder = played(folder(), " --keep-play no");
    assert_eq!(kept_file(folder.path()), None);
    fs::write(folder.path().join("my.decoder"), tactpad::pipeline::shipped::bytes("inverse").unwrap())
        .unwrap();
    let folder = played(folder, "");
    assert_eq!(kept_file(folder.path()), None, "the nominal decoder is of no pad");
}

#[test]
fn kept_play_that_is_damaged_is_refused_in_one_sentence() {
    let folder = folder();
    let bytes = KeptPlay::new(SerialNumber::from_ascii("PAD-1").unwrap(), 7).to_bytes();
    let cut = folder.path().join("cut.play");
    for (length, wanted) in [(bytes.len() - 1, "is damaged"), (20, "is damaged")] {
        fs::write(&cut, &bytes[..length]).unwrap();
        for verb in
            ["diagnose --play cut.play --against my.decoder", "adapt --play cut.play --out new.decoder"]
        {
            let refused = tactpad(folder.path(), &verb.split(' ').collect::<Vec<_>>());
            let said = String::from_utf8(refused.stderr).unwrap();
            assert_eq!(refused.status.code(), Some(2), "{said}");
            assert!(said.contains(wanted) && said.lines().count() == 1, "{said}");
        }
    }
}
