//! Openings of the page beside a user who reads all that every user of the machine can: the arguments of all processes.
//!
//! Environments, `/proc/PID/environ`, only their own user can read; arguments everybody.

use std::collections::BTreeSet;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use crate::http::ask;
use crate::running::comes_true;
use crate::security::asked_by_another_user;
use crate::shown::Shown;

const OPENINGS: usize = 1_000;

/// What is shorter can be no token.
const TOKEN_LETTERS_MIN: usize = 16;

/// Does what a browser does: asks at the address in its arguments, goes where it is led, and asks there with the token that it
/// got. All of it within one process, so nothing else is in any arguments.
const BROWSER: &str = r#"#!/bin/bash
rest=${1#http://} host=${1#http://}
host=${host%%/*} rest=/${rest#*/}
ask() {
    exec 3<>"/dev/tcp/${host%:*}/${host#*:}"
    printf 'GET %s HTTP/1.1\r\nHost: %s\r\nConnection: close\r\n\r\n' "$1" "$host" >&3
}
ask "${rest%%#*}"
while IFS= read -r line <&3 && line=${line%$'\r'} && [[ -n $line ]]; do
    [[ ${line,,} == location:* ]] && page=${line#*: }
done
ask "/api/status?${page#*\?}"
read -r _ status _ <&3
[[ $status == 200 ]]
"#;

/// What the other user saw and came to.
#[derive(Default)]
struct Spied {
    /// How often the page's address was seen in arguments.
    addresses: usize,
    /// Everything that could be a token.
    words: BTreeSet<String>,
    /// By what it got in.
    ways_in: Vec<String>,
}

impl Spied {
    /// Looks at all processes once.
    fn look(&mut self, host: &str) {
        for process in fs::read_dir("/proc").unwrap().flatten() {
            let arguments = fs::read(process.path().join("cmdline")).unwrap_or_default();
            let arguments = String::from_utf8_lossy(&arguments);
            let is_part = |letter: char| letter.is_ascii_alphanumeric() || "-_".contains(letter);
            for word in arguments.split(|letter| !is_part(letter)) {
                if word.len() >= TOKEN_LETTERS_MIN && self.words.insert(word.to_owned()) {
                    let status =
                        ask(host, "GET /api/status", &[&format!("Authorization: Bearer {word}")], b"").status;
                    self.ways_in.extend((status != 401).then(|| word.to_owned()));
                }
            }
            let address = format!("http://{host}");
            for path in arguments.split('\0').filter_map(|argument| argument.strip_prefix(&address)) {
                self.addresses += 1;
                let path = path.split('#').next().unwrap_or_default();
                let answer = asked_by_another_user(host, &format!("GET {path}"));
                self.ways_in.extend(answer.filter(|line| line != "HTTP/1.1 403 Forbidden"));
            }
        }
    }
}

/// A place for programs that stand before the system's, with that browser.
fn path_with_browser(folder: &Path) -> String {
    let program = folder.join("xdg-open");
    fs::write(&program, BROWSER).unwrap();
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    format!("{}:{}", folder.display(), std::env::var("PATH").unwrap())
}

/// Opens the page so often, as `tactpad` on a desktop does, beside the other user; how many openings came to the page.
fn opened(openings: usize) -> (usize, Spied) {
    let shown = Shown::start("virtual", "contra");
    shown.wait_until_playing();
    let folder = tempfile::tempdir().unwrap();
    let path = path_with_browser(folder.path());
    let open = || {
        let mut program = Command::new(env!("CARGO_BIN_EXE_tactpad"));
        program
            .env("XDG_RUNTIME_DIR", shown.running.folder.path())
            .env("DISPLAY", ":none")
            .env("PATH", &path);
        program.status().is_ok_and(|status| status.success())
    };
    let is_done = AtomicBool::new(false);
    let (came, spied) = thread::scope(|scope| {
        let spy = scope.spawn(|| {
            let mut spied = Spied::default();
            while !is_done.load(Ordering::Relaxed) {
                spied.look(&shown.host);
            }
            spied
        });
        let came = (0..openings).filter(|_| open()).count();
        is_done.store(true, Ordering::Relaxed);
        (came, spy.join().unwrap())
    });
    assert!(!spied.words.contains(&shown.token));
    (came, spied)
}

#[test]
fn a_token_in_arguments_would_be_found() {
    let shown = Shown::start("virtual", "contra");
    let mut holder = Command::new("sh");
    let mut holder = holder.args(["-c", "read line", &shown.token]).stdin(Stdio::piped()).spawn().unwrap();
    let mut spied = Spied::default();
    let is_found = comes_true(|| {
        spied.look(&shown.host);
        spied.ways_in == [shown.token.as_str()]
    });
    drop(holder.stdin.take());
    holder.wait().unwrap();
    assert!(is_found, "{:?}", spied.ways_in);
}

#[test]
#[ignore = "proof: 150 s: a thousand openings; that no token is in the arguments is a unit test"]
fn a_thousand_openings_let_in_nobody_who_reads_all_arguments() {
    let (came, spied) = opened(OPENINGS);
    println!("{came} openings, {} addresses seen, {} words tried", spied.addresses, spied.words.len());
    assert_eq!(came, OPENINGS);
    assert!(spied.addresses > OPENINGS / 10, "the other user sees too little: {}", spied.addresses);
    assert_eq!(spied.ways_in, Vec::<String>::new());
}
