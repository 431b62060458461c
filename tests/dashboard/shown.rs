//! A bridge that shows its page, with a folder of its own.

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::http::{self, Answer};
use crate::running::{Running, comes_true};

/// A running bridge, and where its page is.
pub(crate) struct Shown {
    pub(crate) running: Running,
    pub(crate) url: String,
    pub(crate) host: String,
    pub(crate) token: String,
}

impl Shown {
    /// Plays `profile` on the pad at this address into an event log.
    pub(crate) fn start(pad: &str, profile: &str) -> Self {
        Self::start_in(tempfile::tempdir().unwrap(), pad, profile)
    }

    /// The same with further arguments.
    pub(crate) fn start_with(pad: &str, profile: &str, further: &[&str]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let home = folder.path().to_owned();
        Self::start_at_with(&home, folder, pad, profile, further)
    }

    /// The same in a folder that is there, into the event log `log` in it.
    pub(crate) fn start_in(folder: tempfile::TempDir, pad: &str, profile: &str) -> Self {
        let home = folder.path().to_owned();
        Self::start_at(&home, folder, pad, profile)
    }

    /// The same for a user whose settings and whose state are in `home`.
    pub(crate) fn start_at(home: &Path, folder: tempfile::TempDir, pad: &str, profile: &str) -> Self {
        Self::start_at_with(home, folder, pad, profile, &[])
    }

    fn start_at_with(
        home: &Path,
        folder: tempfile::TempDir,
        pad: &str,
        profile: &str,
        further: &[&str],
    ) -> Self {
        let mut program = Running::program(env!("CARGO_BIN_EXE_tactpad"), folder.path());
        program
            .args(["run", "--pad", pad, "--profile", profile, "--dashboard"])
            .args(further)
            .arg("--output");
        program.arg(format!("log:{}", folder.path().join("log").display()));
        program.env("XDG_STATE_HOME", home).env("XDG_CONFIG_HOME", home);
        let running = Running::start(folder, program);
        let mut url = String::new();
        let told = comes_true(|| {
            let told = running.told();
            url =
                told.lines().find_map(|line| line.strip_prefix("Dashboard: ")).unwrap_or_default().to_owned();
            !url.is_empty()
        });
        assert!(told, "{}", running.told());
        let rest = url.strip_prefix("http://").unwrap();
        let (host, token) = rest.split_once("/?token=").unwrap();
        Self { host: host.to_owned(), token: token.to_owned(), url, running }
    }

    /// Asks with the token.
    pub(crate) fn ask(&self, request: &str, body: &str) -> Answer {
        let token = format!("Authorization: Bearer {}", self.token);
        http::ask(&self.host, request, &[&token, "Content-Type: application/json"], body.as_bytes())
    }

    /// A page that looks on, and reads no more than that it may.
    pub(crate) fn live_page(&self) -> TcpStream {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        let Self { host, token, .. } = self;
        write!(
            stream,
            "GET /api/live HTTP/1.1\r\nHost: {host}\r\nAuthorization: Bearer {token}\r\nUpgrade: websocket\r\n\
             Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
        )
        .unwrap();
        let mut line = String::new();
        BufReader::new(&stream).read_line(&mut line).unwrap();
        assert!(line.contains(" 101 "), "{line}");
        stream
    }

    pub(crate) fn status(&self) -> Value {
        self.ask("GET /api/status", "").json()
    }

    /// Waits until the bridge plays.
    pub(crate) fn wait_until_playing(&self) {
        assert!(comes_true(|| self.status()["state"] == "playing"), "{}", self.status());
    }

    /// The file of the user's own profile of this name.
    pub(crate) fn profile(&self, name: &str) -> PathBuf {
        self.running.folder.path().join("tactpad/profiles").join(format!("{name}.toml"))
    }

    /// The event log.
    pub(crate) fn log(&self) -> String {
        fs::read_to_string(self.running.folder.path().join("log")).unwrap_or_default()
    }
}
