//! `tactpad ctl weigh` from end to end: an old pad, a known weight, the answer, the capture of it all, and the command that keeps it.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use tactpad::pipeline::contact::Decoder;
use tactpad::pipeline::shipped;
use tactpad::quantity::Contact;

use crate::control::await_status;
use crate::guest::in_guest;
use crate::running::Running;

const TACTPAD: &str = env!("CARGO_BIN_EXE_tactpad");
/// A pad that has lost 9 % after 5,000 cycles.
const OLD: &str = "[ageing]\nshare = [0.09, 0.09, 0.09, 0.09, 0.09, 0.09, 0.09, 0.09, 0.09]\ncycles = 5000\n\
                   [noise]\nadditive_uv = 5.0\n";

fn tactpad(folder: &Path, line: &str) -> Output {
    let output = Command::new(TACTPAD).args(line.split(' ')).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    output
}

fn text(bytes: Vec<u8>) -> String {
    String::from_utf8(bytes).unwrap()
}

#[test]
fn an_old_pad_is_weighed_on_kept_and_replayed() {
    in_guest("weighing::an_old_pad_is_weighed_on_kept_and_replayed", weighed_kept_and_replayed);
}

fn weighed_kept_and_replayed() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path().to_owned();
    fs::write(at.join("old.toml"), OLD).unwrap();
    fs::write(at.join("my.decoder"), shipped::bytes(shipped::INVERSE).unwrap()).unwrap();
    tactpad(
        &at,
        "twin --imperfections old.toml --cycles 5000 --plan presses --seconds 5 --within-mm 5 --weight-g 200 --weights w.csv \
         --out old.cap",
    );
    let mut program = Running::program(TACTPAD, &at);
    let arguments = "record again.cap --pad capture:old.cap --decoder my.decoder --output log:events";
    program.args(arguments.split(' '));
    let mut bridge = Running::start(folder, program);
    await_status(&bridge, "plays", |status| status["state"] == "playing");
    let wrong = bridge.ctl("weigh 2");
    assert_eq!((wrong.status.code(), text(wrong.stderr).contains("30 to 1000 g")), (Some(2), true));

    let answer = bridge.ctl("weigh 200");
    let said = text(answer.stdout);
    assert!(answer.status.success(), "{}", text(answer.stderr));
    assert!(
        said.contains("the pad reads 9.") && said.contains("% less than when it was calibrated"),
        "{said}"
    );
    let status = bridge.status();
    let factor = status["gain"].as_f64().unwrap();
    assert!((factor - 0.91).abs() < 0.005, "{status}");
    assert_eq!((&status["weighing"]["number"], &status["weighing"]["state"]), (&1.into(), &"weighed".into()));
    assert!(text(bridge.ctl("status").stdout).contains("\ngain     the pad reads 9."));

    assert!(bridge.ctl("quit").status.success());
    assert!(bridge.ends().is_some_and(|status| status.success()));
    assert_eq!(text(tactpad(&at, "replay again.cap").stdout), fs::read_to_string(at.join("events")).unwrap());

    let command = said.lines().find_map(|line| line.strip_prefix("To keep it: tactpad ")).unwrap();
    tactpad(&at, command);
    let (kept, note) = Decoder::from_bytes(&fs::read(at.join("my.decoder")).unwrap()).unwrap();
    let press = Contact { x_mm: 5.0, fz_n: 1.0, ..Contact::default() };
    let found = kept.decode(&shipped::decoder().inverse().unwrap().field().strain_uv(&press));
    assert!((f64::from(found.fz_n) * factor - 1.0).abs() < 0.002 && note.contains("times as much"), "{note}");
}
