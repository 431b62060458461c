//! `profile history`, `restore`, `delete`, `export` and `import`: each save comes back, whatever ended the program.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use tactpad::pipeline::mapping::read::shipped;

/// A user's settings.
struct Home(tempfile::TempDir);

impl Home {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
        command.arg("profile").args(line.split(' ')).current_dir(self.path()).stdin(Stdio::null());
        command.env("XDG_CONFIG_HOME", self.path()).env("XDG_STATE_HOME", self.path());
        command.env_remove("VISUAL").env_remove("EDITOR");
        command
    }

    fn run(&self, line: &str) -> Output {
        let output = self.command(line).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(!said.contains("panicked"), "{line}: {said}");
        output
    }

    fn done(&self, line: &str) -> String {
        let output = self.run(line);
        assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    }

    fn refused(&self, line: &str) -> String {
        let output = self.run(line);
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{line}");
        String::from_utf8_lossy(&output.stderr).into_owned()
    }

    fn file(&self, name: &str) -> PathBuf {
        self.path().join(format!("tactpad/profiles/{name}.toml"))
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.file(name)).unwrap()
    }

    fn history(&self, name: &str) -> Vec<Value> {
        serde_json::from_str(&self.done(&format!("history {name} --json"))).unwrap()
    }
}

/// Contra with another threshold of its first button.
fn contra(press_n: f64) -> String {
    shipped::text("contra").unwrap().replacen("press_n = 2.0", &format!("press_n = {press_n}"), 1)
}

#[test]
fn each_save_has_its_date_and_its_changes_and_comes_back() {
    let home = Home::new();
    home.done("edit contra");
    // An editor that knows nothing of histories.
    fs::write(home.file("contra"), contra(2.5)).unwrap();
    let told = home.done("history contra");
    assert!(told.contains(" UTC  A: jump, press force from 2 N to 2.5 N\n"), "{told}");
    home.done("restore contra");
    assert_eq!(home.text("contra"), shipped::text("contra").unwrap());
    home.done("restore contra");
    assert_eq!(home.text("contra"), contra(2.5), "restored once more");
    home.done("delete contra");
    assert!(!home.file("contra").exists());
    home.done("restore contra");
    assert_eq!(home.text("contra"), contra(2.5));
    home.done("rename contra mine");
    assert!(!home.file("contra").exists() && home.text("mine") == contra(2.5));
    assert!(home.done("history mine").contains("press force from 2 N to 2.5 N"));
    assert!(home.refused("rename mine mine").contains("there already"));
    home.done("rename mine contra");
    home.done("restore contra --shipped");
    assert!(!home.file("contra").exists(), "the one inside the program plays");
    home.done("restore contra 1");
    assert_eq!(home.text("contra"), contra(2.5));
}

#[test]
fn the_last_twenty_saves_are_kept() {
    let home = Home::new();
    home.done("edit contra");
    for save in 1..=24 {
        fs::write(home.file("contra"), contra(2.0 + f64::from(save) * 0.25)).unwrap();
        home.done("history contra");
    }
    let saves = home.history("contra");
    assert_eq!(saves.len(), 20);
    assert_eq!(saves[0]["changes"][0], "A: jump, press force from 7.75 N to 8 N");
    assert_eq!(saves[19]["changes"], serde_json::json!([]), "what was before is no longer kept");
    let ids: Vec<u64> = saves.iter().map(|save| save["id"].as_u64().unwrap()).collect();
    assert_eq!(ids, (6..=25).rev().collect::<Vec<u64>>());
}

#[test]
fn a_kill_at_any_moment_leaves_a_whole_profile_and_every_text_in_the_history() {
    let home = Home::new();
    home.done("edit contra");
    fs::write(home.file("contra"), contra(2.5)).unwrap();
    home.done("history contra");
    let texts = [shipped::text("contra").unwrap().to_owned(), contra(2.5)];
    let (mut killed, mut ended, mut patience) = (0, 0, 0);
    // Later and later, until it often ends by itself; how late that is does not matter.
    while ended < 10 {
        patience += 40;
        let mut restore = home.command("restore contra");
        let mut child = restore.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        let is_over = (0..patience).any(|_| child.try_wait().unwrap().is_some());
        child.kill().unwrap();
        child.wait().unwrap();
        if is_over {
            ended += 1;
        } else {
            killed += 1;
        }
        assert!(texts.contains(&home.text("contra")), "{}", home.text("contra"));
        let kept: Vec<String> = fs::read_dir(home.path().join("tactpad/profile-history/contra"))
            .unwrap()
            .flatten()
            .filter(|entry| entry.path().extension().is_some_and(|extension| extension == "toml"))
            .map(|entry| fs::read_to_string(entry.path()).unwrap())
            .collect();
        assert!(kept.iter().all(|text| texts.contains(text)), "{kept:?}");
        assert!(texts.iter().all(|text| kept.contains(text)), "{kept:?}");
    }
    assert!(killed > 20, "{killed} were killed, {ended} ended by themselves");
    home.done("restore contra");
}

#[test]
fn a_profile_and_its_decoder_are_the_same_on_another_machine() {
    let (here, there) = (Home::new(), Home::new());
    here.done("edit contra");
    fs::write(here.file("contra"), contra(2.5)).unwrap();
    let out = here.path().join("contra.tactpad").display().to_string();
    here.done(&format!("export contra --decoder statics --out {out}"));
    let path = there.done(&format!("import {out} --name mine"));
    assert_eq!(path.trim_end(), there.file("mine").display().to_string());
    assert_eq!(there.text("mine"), contra(2.5));
    let decoder = fs::read(there.path().join("tactpad/decoders/mine.decoder")).unwrap();
    assert_eq!(decoder, tactpad::pipeline::shipped::bytes("statics").unwrap().into_owned());
    let plays = |home: &Home, profile: &str| {
        let contacts = home.path().join("contacts.csv");
        let rows: String = (0..400)
            .map(|row| {
                let fz_n = if row / 40 % 2 == 0 { 0.0 } else { 2.6 };
                format!("{},15,0,0,0,{fz_n}\n", f64::from(row) * 0.005)
            })
            .collect();
        fs::write(&contacts, format!("t_s,x_mm,y_mm,fx_n,fy_n,fz_n\n{rows}")).unwrap();
        let mut replay = Command::new(env!("CARGO_BIN_EXE_tactpad"));
        replay.args(["replay", "--contacts"]).arg(&contacts).args(["--profile", profile]);
        let output = replay.env("XDG_CONFIG_HOME", home.path()).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        output.stdout
    };
    let (first, second) = (plays(&here, "contra"), plays(&there, "mine"));
    assert!(String::from_utf8_lossy(&first).contains("BTN_SOUTH"));
    assert_eq!(first, second);
    assert!(there.refused(&format!("import {out} --name mine")).contains("choose another name"));
    assert_eq!(
        fs::read_dir(there.path().join("tactpad/decoders")).unwrap().count(),
        1,
        "nothing is left of it"
    );
}

#[test]
fn what_cannot_be_done_is_refused_in_one_sentence_with_the_way_out() {
    let home = Home::new();
    let file = home.path().join("broken.tactpad");
    for (text, words) in [
        ("", "no profile that `tactpad profile export` wrote"),
        ("{\"tactpad_profile\":9,\"name\":\"x\",\"text\":\"\"}", "take a newer program"),
        ("{\"tactpad_profile\":1,\"name\":\"../x\",\"text\":\"\"}", "cannot be the name"),
        ("{\"tactpad_profile\":1,\"name\":\"x\",\"text\":\"schema = 1\"}", "cannot be used"),
    ] {
        fs::write(&file, text).unwrap();
        let said = home.refused("import broken.tactpad");
        assert!(said.contains(words) && said.contains("broken.tactpad"), "{said}");
    }
    let whole = |decoder: &str| {
        let text = serde_json::to_string(&contra(2.5)).unwrap();
        format!("{{\"tactpad_profile\":1,\"name\":\"x\",\"text\":{text},\"decoder\":\"{decoder}\"}}")
    };
    for decoder in ["0", "zz", "00ff", "é"] {
        fs::write(&file, whole(decoder)).unwrap();
        assert!(home.refused("import broken.tactpad").contains("export the profile again"), "{decoder}");
    }
    assert!(!home.file("x").exists());
    for line in [
        "history nobody",
        "restore nobody",
        "delete contra",
        "restore nobody --shipped",
        "export ./x.toml --out y",
        "import none",
    ] {
        assert_eq!(home.refused(line).lines().count(), 1, "{line}");
    }
    home.done("edit contra");
    assert!(home.refused("restore contra 7").contains("choose 1 to 1"));
}
