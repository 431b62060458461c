//! Requests that nobody thought of, in a drawn order: to the page's server, through its websocket and to the control socket. Each well-formed one is
//! answered, and the bridge plays on.
//!
//! `TACTPAD_REQUESTS=N` draws so many instead of a few, `TACTPAD_SEED=N` others. What fails prints the last request.

use std::env;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::os::unix::net::UnixStream;
use std::time::Duration;

use serde_json::{Value, json};
use tactpad::numeric::random::SplitMix64;
use tactpad::pipeline::mapping::read::shipped;

use crate::http::ask;
use crate::shown::Shown;

const REQUESTS: u64 = 400;
/// So often the bridge is asked whether it plays.
const EVERY: u64 = 25;
/// No answer takes longer.
const LIMIT: Duration = Duration::from_secs(60);

/// Paths of the server; `*` stands for a name.
const PATHS: [&str; 25] = [
    "/",
    "/open",
    "/handshake",
    "/page/main.js",
    "/page/*",
    "/report/*",
    "/sheet/*",
    "/api/keys",
    "/api/status",
    "/api/schema",
    "/api/words",
    "/api/profiles",
    "/api/profile/*",
    "/api/profile/*/history",
    "/api/profile/*/history/*",
    "/api/profile/*/rename",
    "/api/profile/*/export",
    "/api/import",
    "/api/play",
    "/api/draft",
    "/api/preview",
    "/api/rewind",
    "/api/sheet",
    "/api/guides/*",
    "/api/*",
];
const METHODS: [&str; 6] = ["GET", "POST", "PUT", "DELETE", "PATCH", "OPTIONS"];
const NAMES: [&str; 16] = [
    "contra",
    "mine",
    "super-mario",
    "%00",
    "..%2f..",
    "a%20b",
    "%F0%9F%8E%AE",
    "0",
    "18446744073709551615",
    "pause",
    "resume",
    "panic",
    "tare",
    "force-range",
    "cues",
    "first-run",
];
/// Keys that bodies have.
const KEYS: [&str; 14] = [
    "text", "changes", "table", "key", "value", "name", "to", "document", "do", "number", "date", "saved",
    "nonce", "kind",
];
/// Lines of the control socket but for `quit`.
const LINES: [&str; 10] =
    ["status", "dashboard", "pause", "resume", "panic", "tare", "next-profile", "reload", "profile", "weigh"];

struct Drawn {
    random: SplitMix64,
}

impl Drawn {
    fn below(&mut self, count: usize) -> usize {
        (self.random.next_bits() % count as u64) as usize
    }

    fn of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }

    fn text(&mut self) -> String {
        let profile = shipped::text("contra").unwrap();
        match self.below(8) {
            0 => String::new(),
            1 => "x".repeat(self.below(70_000)),
            2 => profile.chars().take(self.below(profile.len())).collect(),
            3 => profile.replacen(
                '=',
                self.of(&["==", "= -1e308 #", "= [[[", "= nan #", "= \"", "= 9e999"]),
                1 + self.below(3),
            ),
            4 => (0..self.below(40))
                .map(|_| self.of(&['"', '\\', '\n', '\u{0}', '[', '}', '\u{202e}', '9', '.']))
                .collect(),
            5 => self.of(&NAMES).to_owned(),
            6 => self
                .of(&["start", "stop", "next", "skip", "again", "pause", "accept", "up", "KEY_SPACE"])
                .to_owned(),
            _ => profile.to_owned(),
        }
    }

    fn value(&mut self, depth: usize) -> Value {
        match self.below(if depth == 0 { 6 } else { 9 }) {
            0 => Value::Null,
            1 => json!(self.of(&[0.0, -1.0, 0.5, 1e308, -1e-308, 4_294_967_296.0])),
            2 => json!(self.random.next_bits()),
            3 => json!(self.of(&[true, false])),
            4 | 5 => Value::String(self.text()),
            6 => (0..self.below(4)).map(|_| self.value(depth - 1)).collect(),
            _ => (0..self.below(4))
                .map(|_| (self.of(&KEYS).to_owned(), self.value(depth - 1)))
                .collect::<serde_json::Map<_, _>>()
                .into(),
        }
    }

    /// A body that a page could send, with something in it that it would not.
    fn body(&mut self) -> Vec<u8> {
        let text = self.text();
        let mut body = match self.below(8) {
            0 => json!({"text": text, "changes": [{"table": [self.of(&["dpad", "button", "access"]), self.below(3)], "key": self.of(&KEYS), "value": self.value(1)}]}),
            1 => json!({"text": text, "changes": [self.value(3)]}),
            2 => json!({"name": self.of(&NAMES), "document": text, "to": self.of(&NAMES)}),
            3 => json!({"do": text, "number": self.value(0)}),
            4 => json!({"text": text, "date": self.text(), "saved": self.value(0)}),
            5 => json!({"nonce": "0123456789abcdef".repeat(self.below(5))}),
            _ => self.value(3),
        }
        .to_string()
        .into_bytes();
        for _ in 0..self.of(&[0, 0, 1, 5]) {
            if !body.is_empty() {
                let (at, byte) = (self.below(body.len()), self.random.next_bits() as u8);
                body[at] = byte;
            }
        }
        body
    }

    fn path(&mut self) -> String {
        let mut path = String::new();
        for piece in self.of(&PATHS).split('*') {
            path += piece;
            if path.ends_with('/') && path != "/" {
                path += self.of(&NAMES);
            }
        }
        path + self.of(&["", "", "", "?token=0", "?a=%ff", "/"])
    }
}

/// What the other end says until it closes; nothing where it only closes.
fn last_words(stream: &mut impl Read) -> Vec<u8> {
    let mut words = Vec::new();
    let _ = stream.read_to_end(&mut words);
    words
}

/// A whole request with the token: always an answer.
fn request(shown: &Shown, drawn: &mut Drawn) {
    let (method, path, body) = (drawn.of(&METHODS), drawn.path(), drawn.body());
    let token = format!("Authorization: Bearer {}", shown.token);
    let kind = drawn.of(&[
        "Content-Type: application/json",
        "Content-Type: application/json",
        "Content-Type: text/plain",
    ]);
    let request = format!("{method} {path}");
    let answer = ask(&shown.host, &request, &[&token, kind], &body);
    let said = String::from_utf8_lossy(&body);
    assert!(
        (200..=505).contains(&answer.status),
        "{request}: {} bytes, {answer:?}\n{said:.2000}",
        body.len()
    );
}

/// Bytes that are no request.
fn garbage(shown: &Shown, drawn: &mut Drawn) {
    let mut stream = TcpStream::connect(&shown.host).unwrap();
    stream.set_read_timeout(Some(LIMIT)).unwrap();
    let head = format!(
        "{} {} HTTP/1.{}\r\nHost: {}\r\n{}\r\n",
        drawn.of(&METHODS),
        drawn.path(),
        drawn.below(3),
        shown.host,
        drawn.of(&[
            "",
            "Content-Length: 99999999999\r\n",
            "Content-Length: -1\r\n",
            "Transfer-Encoding: chunked\r\n",
            "A: \u{0}\r\n"
        ])
    );
    let mut bytes = head.into_bytes();
    for _ in 0..drawn.below(6) {
        let (at, byte) = (drawn.below(bytes.len()), drawn.random.next_bits() as u8);
        bytes[at] = byte;
    }
    let _ = stream.write_all(&bytes);
    let _ = stream.shutdown(Shutdown::Write);
    last_words(&mut stream);
}

/// Frames of a page's websocket, sound and broken.
fn frames(shown: &Shown, drawn: &mut Drawn) {
    let mut stream = shown.live_page();
    for _ in 0..1 + drawn.below(4) {
        let text = drawn.of(&[r#"{"kind":"ping","id":1}"#, r#"{"kind":"ping","id":-1}"#, "{", "[[[[[[", ""]);
        let first = if drawn.below(3) == 0 { drawn.random.next_bits() as u8 } else { 0x81 };
        // A frame of a page is masked; by zeros it stays as it is.
        let mut frame = vec![first, 0x80 | text.len() as u8, 0, 0, 0, 0];
        frame.extend_from_slice(text.as_bytes());
        if drawn.below(4) == 0 {
            let (at, byte) = (drawn.below(frame.len()), drawn.random.next_bits() as u8);
            frame[at] = byte;
        }
        if stream.write_all(&frame).is_err() {
            return;
        }
    }
}

/// A line of the control socket: one line answers, whatever it says.
fn line(shown: &Shown, drawn: &mut Drawn) {
    let mut stream = UnixStream::connect(shown.running.folder.path().join("tactpad.sock")).unwrap();
    stream.set_read_timeout(Some(LIMIT)).unwrap();
    let mut line = drawn.of(&LINES).as_bytes().to_vec();
    if drawn.below(2) == 0 {
        line.extend_from_slice(
            drawn
                .of(&[" ", "  ", " 1e308", " -5", " nan", " 200", " contra", " ../x", "\0", "\t"])
                .as_bytes(),
        );
    }
    if drawn.below(4) == 0 {
        let (at, byte) = (drawn.below(line.len()), drawn.random.next_bits() as u8);
        line[at] = byte;
    }
    line.retain(|byte| *byte != b'\n');
    line.push(b'\n');
    stream.write_all(&line).unwrap();
    let mut answer = String::new();
    BufReader::new(stream).read_line(&mut answer).unwrap();
    let said = String::from_utf8_lossy(&line);
    assert!(serde_json::from_str::<Value>(&answer).is_ok_and(|it| it.is_object()), "{said:?}: {answer:?}");
}

#[test]
fn whatever_is_asked_is_answered_and_the_bridge_plays_on() {
    let number = |name: &str, usual| env::var(name).map_or(usual, |text| text.parse().unwrap());
    let (seed, count) = (number("TACTPAD_SEED", 1), number("TACTPAD_REQUESTS", REQUESTS));
    let shown = Shown::start("virtual", "contra");
    shown.wait_until_playing();
    let mut drawn = Drawn { random: SplitMix64::named(seed, "drawn requests") };
    for at in 0..count {
        let kind = drawn.below(8);
        println!("seed {seed}, request {at}, kind {kind}");
        match kind {
            0 => garbage(&shown, &mut drawn),
            1 => frames(&shown, &mut drawn),
            2 | 3 => line(&shown, &mut drawn),
            _ => request(&shown, &mut drawn),
        }
        if at % EVERY == EVERY - 1 {
            assert_eq!(shown.ask("POST /api/resume", "").status, 200);
            assert_eq!(shown.ask("POST /api/play", r#"{"name": "contra"}"#).status, 200);
            shown.wait_until_playing();
        }
    }
    let told = shown.running.told();
    assert!(!told.contains("panicked"), "{told}");
}
