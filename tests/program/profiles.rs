//! The verb `profile`: what it prints, and the folder of one's own profiles.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use rustix::fs::{Mode, OFlags, open};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use serde_json::{Value, json};

use crate::undisturbed::undisturbed;

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    command.args(arguments).current_dir(folder).stdin(Stdio::null()).env("RUST_BACKTRACE", "1");
    command.env("XDG_CONFIG_HOME", folder).env_remove("VISUAL").env_remove("EDITOR");
    command
}

fn tactpad(folder: &Path, line: &str) -> Output {
    let output = command(folder, &line.split(' ').collect::<Vec<_>>()).output().unwrap();
    assert!(!said(&output).contains("panicked"), "{}", said(&output));
    output
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn printed(output: &Output) -> String {
    assert!(output.status.success(), "{}", said(output));
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn own(folder: &Path, name: &str) -> PathBuf {
    folder.join("tactpad/profiles").join(name)
}

fn refuses(folder: &Path, line: &str, words: &[&str]) {
    let output = tactpad(folder, line);
    assert_eq!(output.status.code(), Some(2), "{line}: {}", said(&output));
    assert!(words.iter().all(|word| said(&output).contains(word)), "{line}: {}", said(&output));
}

#[test]
fn a_finding_shows_its_line_with_the_place_underlined() {
    let folder = tempfile::tempdir().unwrap();
    let text = "schema = 1\nname = \"Mine\"\noutput = \"gamepad\"\n\n[dpad]\nmode = \"5way\" # odd\n\
                \tmin_force_n = -1\nrotate = 3\n[[button]]\nforce = \"fz\"\nout = { pointer = \"BTN_LEFT\" }\n";
    fs::write(folder.path().join("mine.toml"), text).unwrap();
    let checked = tactpad(folder.path(), "profile check mine.toml");
    let told = String::from_utf8(checked.stdout).unwrap();
    let wanted = "\
mine.toml:6:8: error: \"mode\" cannot be \"5way\"
  6 | mode = \"5way\" # odd
    |        ^^^^^^
  help: did you mean \"4way\"?
mine.toml:7:16: error: \"min_force_n\" is -1; it must be 0.05 to 50
  7 |     min_force_n = -1
    |                   ^^
mine.toml:8:1: error: unknown key \"rotate\" in [dpad]
  8 | rotate = 3
    | ^^^^^^
  help: known here: mode, ";
    assert!(told.starts_with(wanted), "{told}");
    let lacks = "
mine.toml:9:1: error: button 1 lacks \"press_n\"
  9 | [[button]]
    | ^^^^^^^^^^
  help: write the force in newtons that presses it, as press_n = 2.0
";
    assert!(told.ends_with(lacks), "{told}");
    let report: Value =
        serde_json::from_slice(&tactpad(folder.path(), "profile check mine.toml --json").stdout).unwrap();
    let finding = json!({
        "severity": "error", "message": "\"mode\" cannot be \"5way\"", "line": 6, "column": 8,
        "help": "did you mean \"4way\"?",
    });
    assert_eq!(report["diagnostics"][0], finding);
}

#[test]
fn a_new_profile_is_printed_or_saved_once() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let text = printed(&tactpad(folder, "profile new my-game"));
    assert!(text.starts_with("#:schema ") && text.contains("name = \"my-game\"\n"), "{text}");
    assert!(!folder.join("tactpad").exists(), "nothing is written");
    let saved = printed(&tactpad(folder, "profile new my-game --save"));
    let path = own(folder, "my-game.toml");
    assert_eq!(saved.trim(), path.display().to_string());
    assert_eq!(fs::read_to_string(&path).unwrap(), text);
    let schema = fs::read_to_string(own(folder, "profile.schema.json")).unwrap();
    assert_eq!(schema, printed(&tactpad(folder, "profile schema")));
    assert!(schema.contains("2020-12"));
    fs::write(&path, format!("{text}# mine\n")).unwrap();
    refuses(folder, "profile new my-game --save", &["my-game.toml is there already", "profile edit"]);
    assert!(fs::read_to_string(&path).unwrap().ends_with("# mine\n"));
    let checked = printed(&tactpad(folder, "profile check my-game"));
    assert_eq!(checked, format!("{}: my-game is in order\n", path.display()));
    assert!(printed(&tactpad(folder, "profile show my-game")).ends_with("# mine\n"));
    for name in ["../x", "a/b", "x.toml", "a\"b", "", "x\ny"] {
        for save in [&[][..], &["--save"]] {
            let arguments = [&["profile", "new", name][..], save].concat();
            let output = command(folder, &arguments).output().unwrap();
            assert_eq!(output.status.code(), Some(2), "{name:?}: {}", said(&output));
        }
    }
    assert_eq!(fs::read_dir(own(folder, "")).unwrap().count(), 2);
}

#[test]
fn a_profile_is_told_in_plain_words_and_on_a_sheet() {
    let folder = tempfile::tempdir().unwrap();
    let told = printed(&tactpad(folder.path(), "profile show contra --plain"));
    assert!(told.starts_with("Contra, played on the gamepad\n"), "{told}");
    assert!(told.contains("A: jump") && told.contains("press force 2 N, let-go force 1.4 N"), "{told}");
    assert!(!told.contains('_'), "{told}");
    let page = printed(&tactpad(folder.path(), "profile sheet contra"));
    assert!(page.starts_with("<!doctype html>") && page.contains("<title>Contra, tactpad</title>"), "{page}");
    for (name, begin) in [("c.svg", "<svg"), ("c.pdf", "%PDF-1.4"), ("c.HTML", "<!doctype html>")] {
        assert_eq!(printed(&tactpad(folder.path(), &format!("profile sheet contra --out {name}"))), "");
        let sheet = String::from_utf8(fs::read(folder.path().join(name)).unwrap()).unwrap();
        assert!(sheet.starts_with(begin) && sheet.contains("A: jump"), "{name}");
    }
    refuses(folder.path(), "profile sheet contra --out c.txt", &["c.txt", ".html, .svg or .pdf"]);
}

#[test]
fn ones_own_profile_stands_before_the_shipped_one() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let shipped = printed(&tactpad(folder, "profile show contra"));
    let list = printed(&tactpad(folder, "profile list"));
    assert_eq!(
        list,
        "super-mario\ntetris\ntank-battle\ncontra\npointer\none-button\nsuper-mario-left\nsuper-mario-light\n\
         supertux\nvitetris\nbtanks\ntablet\ntouchpad\nboard-seated\nboard-standing\n\
         vitetris-board\n"
    );
    let edited = tactpad(folder, "profile edit contra");
    let path = own(folder, "contra.toml");
    assert_eq!(printed(&edited).trim(), path.display().to_string());
    assert!(said(&edited).contains("stands before the contra inside the program"), "{}", said(&edited));
    assert_eq!(fs::read_to_string(&path).unwrap(), shipped);
    fs::write(&path, shipped.replace("name = \"Contra\"", "name = \"Mine\"")).unwrap();
    let again = tactpad(folder, "profile edit contra");
    assert_eq!((printed(&again).trim(), said(&again)), (&*path.display().to_string(), String::new()));
    assert!(printed(&tactpad(folder, "profile show contra")).contains("name = \"Mine\""), "it stays");
    printed(&tactpad(folder, "profile new zelda --save"));
    fs::write(own(folder, "my.game.toml"), "").unwrap();
    let list = printed(&tactpad(folder, "profile list"));
    let line =
        |name: &str| list.lines().find(|line| line.split(' ').next() == Some(name)).unwrap_or_default();
    assert!(line("contra").ends_with(" your own, before the shipped one"), "{list}");
    assert!(line("zelda").ends_with(" your own") && line("pointer") == "pointer", "{list}");
    assert_eq!(list.lines().count(), 17, "{list}");
    let list: Value = serde_json::from_str(&printed(&tactpad(folder, "profile list --json"))).unwrap();
    assert_eq!(list["folder"], own(folder, "").to_str().unwrap().trim_end_matches('/'));
    let contra = json!({ "name": "contra", "own": true, "shipped": true, "file": path.to_str().unwrap() });
    let tetris = json!({ "name": "tetris", "own": false, "shipped": true, "file": null });
    assert_eq!((&list["profiles"][3], &list["profiles"][1]), (&contra, &tetris));
    let demo = undisturbed(|| tactpad(folder, "demo --seconds 2 --output none --profile contra"));
    assert!(demo.status.success(), "{}", said(&demo));
    // What is written must not be the profile that is read.
    let log = format!("demo --seconds 2 --profile contra --output log:{}", path.display());
    refuses(folder, &log, &["is the profile and would be written over"]);
    fs::write(&path, "schema = 2\n").unwrap();
    let place = format!("{}:1:10: error", path.display());
    refuses(folder, "demo --seconds 2 --profile contra", &[&place, "1 | schema = 2"]);
    refuses(folder, "replay --contacts c.csv --profile contra", &[&place, "cannot be used"]);
}

#[test]
fn names_that_nothing_has_are_refused_with_a_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    printed(&tactpad(folder, "profile new zelda --save"));
    refuses(folder, "profile check nope", &["there is no profile \"nope\"", "vitetris-board, zelda"]);
    refuses(folder, "profile edit nope", &["no profile \"nope\"", "`tactpad profile new --save \"nope\"`"]);
    refuses(folder, "profile edit ./x.toml", &["./x.toml is a file: open it in an editor"]);
    // A name with a slash is a file from here on, not from the folder.
    refuses(folder, "profile show ../profiles/zelda", &["cannot be read: No such file"]);
    fs::create_dir(own(folder, "odd.toml")).unwrap();
    refuses(folder, "profile show odd", &["odd.toml cannot be read: it is a directory"]);
    let homeless = command(folder, &["profile", "new", "x", "--save"]);
    let mut homeless = homeless;
    let output = homeless.env_remove("XDG_CONFIG_HOME").env_remove("HOME").output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("set HOME or XDG_CONFIG_HOME"), "{}", said(&output));
    fs::write(folder.join("file"), "").unwrap();
    let mut blocked = command(folder, &["profile", "new", "x", "--save"]);
    let output = blocked.env("XDG_CONFIG_HOME", folder.join("file")).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(said(&output).contains("x.toml cannot be written: Not a directory"), "{}", said(&output));
}

#[test]
fn on_a_terminal_a_profile_is_opened_and_checked() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("editor"), "test \"$1\" = --wait && echo 'press = 1' >> \"$2\"\n").unwrap();
    let device = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    grantpt(&device).unwrap();
    unlockpt(&device).unwrap();
    let path = ptsname(&device, Vec::new()).unwrap().into_string().unwrap();
    let host = || File::from(open(Path::new(&path), OFlags::RDWR | OFlags::NOCTTY, Mode::empty()).unwrap());
    let held = host();
    for (editor, code, words) in [
        ("", 0, ""),
        ("no-such-editor", 1, "the editor \"no-such-editor\" cannot be started"),
        ("false", 1, "false ended with exit status: 1"),
        ("sh ./editor --wait", 1, "contra.toml has errors"),
    ] {
        let mut edit = command(folder, &["profile", "edit", "contra"]);
        edit.env("EDITOR", editor).stdin(host()).stdout(host());
        let output = edit.output().unwrap();
        assert_eq!(output.status.code(), Some(code), "{editor}: {}", said(&output));
        assert!(said(&output).contains(words), "{editor}: {}", said(&output));
    }
    drop(held);
    assert!(fs::read_to_string(own(folder, "contra.toml")).unwrap().ends_with("press = 1\n"));
}
