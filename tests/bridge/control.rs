//! `tactpad ctl` and a bridge that plays on a virtual pad.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead, BufReader};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::Path;
use std::process::{Command, Stdio};

use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;

use crate::guest::in_guest;
use crate::presses;
use crate::running::{Running, comes_true};
use crate::support::{leave_out, require};

const TACTPAD: &str = env!("CARGO_BIN_EXE_tactpad");

fn tactpad(folder: &Path) -> Command {
    Running::program(TACTPAD, folder)
}

/// A bridge that logs its events.
fn start(arguments: &[&str]) -> Running {
    let folder = tempfile::tempdir().unwrap();
    let mut program = tactpad(folder.path());
    program.arg("run").args(arguments).args(["--output", "log:events"]);
    Running::start(folder, program)
}

/// Waits until the status satisfies `holds`.
pub(crate) fn await_status(bridge: &Running, what: &str, holds: impl Fn(&Value) -> bool) -> Value {
    let mut status = Value::Null;
    let found = comes_true(|| {
        status = bridge.status();
        holds(&status)
    });
    assert!(found, "{what}: {status}");
    status
}

fn events(bridge: &Running) -> usize {
    fs::read_to_string(bridge.folder.path().join("events")).unwrap_or_default().lines().count()
}

/// Whether the log has something, and has let go of it.
fn is_released(bridge: &Running) -> bool {
    let text = fs::read_to_string(bridge.folder.path().join("events")).unwrap();
    let mut last = BTreeMap::new();
    for event in text.lines().map_while(|line| serde_json::from_str::<Value>(line).ok()) {
        last.insert(event["code"].to_string(), event["value"].clone());
    }
    !last.is_empty() && last.values().all(|value| *value == 0)
}

#[test]
fn a_bridge_is_asked_paused_changed_and_ended() {
    let mut bridge = start(&["--pad", "virtual"]);
    let status = await_status(&bridge, "plays", |status| {
        status["state"] == "playing" && status["held"] != Value::Array(vec![])
    });
    assert_eq!((&status["pad"], &status["profile"]), (&"VIRTUAL-0001".into(), &"Super Mario".into()));
    assert_eq!(status["decoder"], "inverse");
    assert_eq!(status["health"]["frames_lost"], 0);

    assert!(bridge.ctl("pause").status.success());
    let status = await_status(&bridge, "pauses", |status| status["state"] == "paused");
    assert_eq!(status["held"], Value::Array(vec![]));
    // The log is written by a thread of its own.
    assert!(comes_true(|| is_released(&bridge)));
    let before = events(&bridge);
    await_status(&bridge, "goes on hearing", |status| status["health"]["samples"].as_u64() > Some(3_000));
    assert_eq!(events(&bridge), before, "a paused bridge emits nothing");
    assert!(bridge.ctl("resume").status.success());
    await_status(&bridge, "plays again", |status| status["state"] == "playing" && events(&bridge) > before);

    assert!(bridge.ctl("profile contra").status.success());
    assert_eq!(bridge.status()["profile"], "Contra");
    let refused = bridge.ctl("profile no-such-game");
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("no-such-game"));
    assert_eq!(bridge.status()["profile"], "Contra");

    assert!(bridge.ctl("panic").status.success());
    assert!(bridge.ctl("tare").status.success());
    assert!(bridge.ctl("quit").status.success());
    assert!(bridge.ends().is_some_and(|status| status.success()));
    let gone = bridge.ctl("status");
    assert_eq!(gone.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&gone.stderr).contains("tactpad run"));
}

#[test]
fn a_profile_of_ones_own_stands_before_the_shipped_one_in_the_bridge_too() {
    let bridge = start(&["--pad", "virtual"]);
    let folder = bridge.folder.path();
    await_status(&bridge, "plays", |status| status["state"] == "playing");
    // A file of this name where `ctl` is asked is not what the name means.
    fs::write(folder.join("contra"), "nothing").unwrap();
    let chosen = tactpad(folder).args(["ctl", "profile", "contra"]).status().unwrap();
    assert!(chosen.success());
    assert_eq!(bridge.status()["profile"], "Contra");
    let edited = tactpad(folder).args(["profile", "edit", "contra"]).stdout(Stdio::piped()).output().unwrap();
    let path = String::from_utf8(edited.stdout).unwrap();
    let path = Path::new(path.trim());
    assert!(path.starts_with(folder), "{path:?}");
    let text = fs::read_to_string(path).unwrap();
    fs::write(path, text.replace("name = \"Contra\"", "name = \"My Contra\"")).unwrap();
    assert!(bridge.ctl("reload").status.success());
    assert_eq!(bridge.status()["profile"], "My Contra");
    fs::write(path, text.replace("press_n = 2.0", "press_n = 99")).unwrap();
    let refused = bridge.ctl("profile contra");
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(said.contains(&format!("{}:", path.display())) && said.contains("| press_n = 99\n"), "{said}");
    assert_eq!(bridge.status()["profile"], "My Contra");
}

#[test]
fn a_bridge_without_a_pad_waits_and_says_so() {
    let bridge = start(&["--pad", "serial:pad", "--wait", "--decoder", "scdf"]);
    let status = await_status(&bridge, "waits", |status| status["state"] == "waiting");
    await_status(&bridge, "says so", |_| bridge.told().contains("waiting for the pad"));
    assert_eq!(status["decoder"], "network (scdf)");
    let listed = bridge.ctl("status").stdout;
    assert!(String::from_utf8_lossy(&listed).contains("decoder  network (scdf)"));
    let found = tactpad(bridge.folder.path()).arg("doctor").stdout(Stdio::piped()).output().unwrap().stdout;
    assert!(String::from_utf8_lossy(&found).contains("decoder network (scdf)"));
}

#[test]
fn each_further_bridge_has_a_number_and_a_dead_ones_socket_is_taken_over() {
    let first = start(&["--pad", "serial:pad", "--wait"]);
    await_status(&first, "waits", |status| status["state"] == "waiting");
    let folder = first.folder.path().to_owned();
    let asked = |line: &str| {
        let answer =
            tactpad(&folder).arg("ctl").args(line.split(' ')).stdout(Stdio::piped()).output().unwrap();
        [answer.stdout, answer.stderr].map(|told| String::from_utf8(told).unwrap())
    };
    let begun = |arguments: &[&str]| {
        tactpad(&folder).args(arguments).args(["--output", "none"]).stderr(Stdio::piped()).spawn().unwrap()
    };
    let second = begun(&["run", "--pad", "virtual"]);
    assert!(comes_true(|| asked("status --name 2 --json")[0].contains("\"state\":\"playing\"")));
    assert_eq!(first.status()["state"], "waiting");
    let [_, refused] = asked("next-profile --name 2");
    assert!(refused.contains("tactpad ctl profile NAME") && refused.contains("next-profile"), "{refused}");
    let demo = begun(&["demo", "--seconds", "600"]);
    assert!(comes_true(|| asked("status --name demo --json")[0].contains("\"state\":\"playing\"")));
    // Without the first, a bridge is asked by its name, or by none if it is the only one.
    asked("quit");
    assert!(comes_true(|| !folder.join("tactpad.sock").exists()));
    let [_, which] = asked("status");
    assert!(which.contains("say which one by `--name 2` or `--name demo`"), "{which}");
    asked("quit --name demo");
    assert!(!demo.wait_with_output().unwrap().status.success(), "what was interrupted is no proof");
    assert!(comes_true(|| asked("status --json")[0].contains("\"state\":\"playing\"")));
    asked("quit");
    let second = second.wait_with_output().unwrap();
    assert!(String::from_utf8_lossy(&second.stderr).contains("(tactpad ctl --name 2)"));
    assert!(second.status.success());

    let socket = folder.join("tactpad.sock");
    drop(UnixListener::bind(&socket).unwrap());
    let third = tactpad(first.folder.path())
        .args(["run", "--pad", "virtual", "--output", "none", "--seconds", "1"])
        .output()
        .unwrap();
    assert!(third.status.success() && !String::from_utf8_lossy(&third.stderr).contains("does not reach"));
}

#[test]
fn two_bridges_with_names_are_asked_each_by_its_own() {
    let left = start(&["--name", "left", "--pad", "serial:pad", "--wait"]);
    let ctl = |line: &str| {
        let output =
            tactpad(left.folder.path()).args(line.split(' ')).stdout(Stdio::piped()).output().unwrap();
        (output.status.success(), String::from_utf8(output.stdout).unwrap())
    };
    let state = |line: &str| ctl(line).1.contains("\"state\":\"paused\"");
    assert!(comes_true(|| ctl("ctl --name left status").0));
    let arguments = ["run", "--name", "right", "--pad", "serial:other", "--wait", "--output", "none"];
    let mut right = tactpad(left.folder.path()).args(arguments).stderr(Stdio::null()).spawn().unwrap();
    assert!(comes_true(|| ctl("ctl status --name right").0));
    assert!(ctl("ctl --name left pause").0);
    assert_eq!(
        [state("ctl --name left status --json"), state("ctl --name right status --json")],
        [true, false]
    );
    assert!(!ctl("ctl status").0, "nobody has no name");
    assert!(!ctl("ctl --name a/b status").0);
    assert!(ctl("ctl --name right quit").0);
    assert!(right.wait().unwrap().success());
}

#[test]
fn idle_clients_do_not_keep_others_from_asking() {
    let bridge = start(&["--pad", "serial:pad", "--wait"]);
    await_status(&bridge, "waits", |status| status["state"] == "waiting");
    let socket = bridge.folder.path().join("tactpad.sock");
    let idle: Vec<_> = (0..1_000).map(|_| UnixStream::connect(&socket).unwrap()).collect();
    for request in ["status", "panic", "status"] {
        let answer = bridge.ctl(request);
        assert!(answer.status.success(), "{}", String::from_utf8_lossy(&answer.stderr));
    }
    let open = fs::read_dir(format!("/proc/{}/fd", bridge.id())).unwrap().count();
    assert!(open < 100, "{open} descriptors for {} clients that say nothing", idle.len());
}

#[test]
fn a_bridge_that_does_not_answer_is_one_sentence() {
    let bridge = start(&["--pad", "serial:pad", "--wait"]);
    await_status(&bridge, "waits", |status| status["state"] == "waiting");
    bridge.signal(Signal::STOP);
    let answer = bridge.ctl("status");
    let text = String::from_utf8(answer.stderr).unwrap();
    assert_eq!(answer.status.code(), Some(1), "{text}");
    assert!(text.contains("does not answer") && text.contains("`fg`"), "{text}");
    assert!(!text.contains("os error") && text.trim_end().lines().count() == 1, "{text}");
}

/// A bridge that plays presses of which some are accepted and some rejected.
fn start_with_presses() -> Running {
    let folder = tempfile::tempdir().unwrap();
    let capture = format!("capture:{}", presses::write_capture(folder.path()).display());
    let text = "schema = 1\nname = \"Mine\"\noutput = \"gamepad\"\n[access]\nbounce_ms = 4000\n\
                [[button]]\nforce = \"fy\"\npress_n = 1\nout = { gamepad = \"BTN_EAST\", keyboard = \"KEY_X\" }\n\
                [[button]]\nforce = \"fz\"\npress_n = 1\nout = { gamepad = \"BTN_SOUTH\", keyboard = \"KEY_Z\" }\n\
                [[button]]\nforce = \"fz\"\npress_n = 1\ndwell_ms = 9000\nout = { gamepad = \"BTN_TL\", keyboard = \"KEY_A\" }\n";
    fs::write(folder.path().join("mine.toml"), text).unwrap();
    let mut program = tactpad(folder.path());
    program.args(["run", "--profile", "mine.toml", "--output", "none", "--pad", &capture]);
    let bridge = Running::start(folder, program);
    await_status(&bridge, "plays", |status| status["state"] != "waiting" && !status["state"].is_null());
    bridge
}

#[test]
fn each_press_that_is_accepted_or_rejected_is_told_to_who_watches() {
    in_guest("control::each_press_that_is_accepted_or_rejected_is_told_to_who_watches", who_watches_is_told);
}

fn who_watches_is_told() {
    let mut bridge = start_with_presses();
    let mut watching = tactpad(bridge.folder.path());
    let mut watching = watching.args(["ctl", "watch"]).stdout(Stdio::piped()).spawn().unwrap();
    let lines = BufReader::new(watching.stdout.take().unwrap()).lines().map(Result::unwrap);
    let told: Vec<Value> = lines.take(5).map(|line| serde_json::from_str(&line).unwrap()).collect();
    let seen: Vec<_> = told
        .iter()
        .map(|told| {
            (told["button"].as_u64().unwrap(), told["press"].as_str().unwrap(), told["reason"].as_str())
        })
        .collect();
    let [accepted, bounced, moved] =
        [(2, "accepted", None), (2, "rejected", Some("bounce")), (3, "rejected", Some("dwell"))];
    // The first press may have begun before anybody watched.
    let expected = [accepted, moved, bounced, moved, accepted, moved];
    let from = usize::from(seen[0] != accepted);
    assert_eq!(seen, expected[from..from + 5]);
    let times: Vec<_> = told.iter().map(|told| told["t_us"].as_u64().unwrap()).collect();
    assert!(times.is_sorted(), "{times:?}");
    assert!(bridge.ctl("quit").status.success());
    assert!(bridge.ends().is_some());
    assert!(watching.wait().unwrap().code().is_some());
}

/// A player that writes down what it plays and its number, and then stands still until it is continued.
fn write_player(folder: &Path) {
    let (played, numbers) = (folder.join("played"), folder.join("numbers"));
    let text = format!(
        "#!/bin/sh\necho \"$*\" >> '{}'\necho $$ >> '{}'\nkill -STOP $$\n",
        played.display(),
        numbers.display()
    );
    let player = folder.join("paplay");
    fs::write(&player, text).unwrap();
    fs::set_permissions(&player, fs::Permissions::from_mode(0o755)).unwrap();
}

/// The lines of a file that may not be there yet; one that is being written is none.
fn lines(path: &Path) -> Vec<String> {
    let text = fs::read_to_string(path).unwrap_or_default();
    text.split_inclusive('\n').filter_map(|line| Some(line.strip_suffix('\n')?.to_owned())).collect()
}

#[test]
fn presses_sound_one_at_a_time_and_hold_up_no_line() {
    in_guest("control::presses_sound_one_at_a_time_and_hold_up_no_line", presses_sound);
}

fn presses_sound() {
    let mut bridge = start_with_presses();
    let folder = bridge.folder.path().to_owned();
    write_player(&folder);
    let mut watching = Command::new(TACTPAD);
    watching.args(["ctl", "watch", "--sound", "all"]).env("PATH", &folder).env("XDG_RUNTIME_DIR", &folder);
    let mut watching = watching.stdout(Stdio::piped()).spawn().unwrap();
    let mut told = BufReader::new(watching.stdout.take().unwrap()).lines().map(Result::unwrap);
    let mut press = || -> Value { serde_json::from_str(&told.next().unwrap()).unwrap() };
    let [played, numbers] = ["played", "numbers"].map(|name| folder.join(name));
    // While a sound stands still, more presses are told.
    for (count, others) in [(1, 1), (2, 2)] {
        let heard = press()["press"].as_str().unwrap().to_owned();
        assert!(comes_true(|| lines(&numbers).len() == count), "{:?}", lines(&played));
        let wanted = folder.join(format!("tactpad-{heard}.wav"));
        assert_eq!(lines(&played)[count - 1], wanted.display().to_string());
        assert_eq!(fs::read(wanted).unwrap()[..4], *b"RIFF");
        (0..others).for_each(|_| {
            press();
        });
        assert_eq!(lines(&played).len(), count);
        if count == 2 {
            // So that none is left standing at the end.
            fs::remove_file(folder.join("paplay")).unwrap();
        }
        let number = lines(&numbers)[count - 1].clone();
        let player = Pid::from_raw(number.parse().unwrap()).unwrap();
        kill_process(player, Signal::CONT).unwrap();
        // It is gone, and no trace is left.
        assert!(comes_true(|| !Path::new("/proc").join(&number).exists()));
    }
    assert!(bridge.ctl("quit").status.success());
    assert!(bridge.ends().is_some());
    assert!(watching.wait().unwrap().code().is_some());
}

#[test]
fn without_a_player_there_is_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let mut watching = Command::new(TACTPAD);
    watching
        .args(["ctl", "watch", "--sound"])
        .env("PATH", folder.path())
        .env("XDG_RUNTIME_DIR", folder.path());
    let output = watching.output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("install one of pw-play (pipewire-bin)") && said.lines().count() == 1, "{said}");
}

/// Says one line to a socket and prints what comes back.
const STRANGER: &str = "import socket, sys\nit = socket.socket(socket.AF_UNIX)\nit.connect(sys.argv[1])\nit.sendall(b'pause\\n')\nprint(it.recv(99))";

#[test]
fn another_user_gets_no_answer_even_where_the_socket_is_open_to_all() {
    if !rustix::process::getuid().is_root() {
        leave_out("the right to become another user", "sudo cargo test");
        return;
    }
    if !require("setpriv", "apt install util-linux") || !require("python3", "apt install python3") {
        return;
    }
    let bridge = start(&["--pad", "virtual"]);
    await_status(&bridge, "plays", |status| status["state"] == "playing");
    let socket = bridge.folder.path().join("tactpad.sock");
    for (path, mode) in [(bridge.folder.path(), 0o755), (&socket, 0o777)] {
        fs::set_permissions(path, fs::Permissions::from_mode(mode)).unwrap();
    }
    let said = |user: &str| {
        let mut stranger = Command::new("setpriv");
        stranger.args([&format!("--reuid={user}"), "--clear-groups", "python3", "-c", STRANGER]).arg(&socket);
        stranger.output().unwrap()
    };
    let heard = said("65534");
    assert!(!String::from_utf8_lossy(&heard.stdout).contains("ok"), "{heard:?}");
    assert_eq!(bridge.status()["state"], "playing");
    assert!(String::from_utf8_lossy(&said("0").stdout).contains("ok"), "its own user is heard");
    assert_eq!(bridge.status()["state"], "paused");
}
