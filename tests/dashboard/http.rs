//! Plain requests, written by hand so that each header is what the test says.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::time::Duration;

use serde_json::Value;

/// No answer takes longer.
const LIMIT: Duration = Duration::from_secs(60);

/// What a server answers.
#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) status: u16,
    /// Each line of the head in small letters.
    pub(crate) head: Vec<String>,
    pub(crate) body: Vec<u8>,
}

impl Answer {
    pub(crate) fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }
}

/// Asks the server at `host`; `head` are further lines of the head.
pub(crate) fn ask(host: &str, request: &str, head: &[&str], body: &[u8]) -> Answer {
    let mut stream = TcpStream::connect(host).unwrap();
    stream.set_read_timeout(Some(LIMIT)).unwrap();
    let mut lines = vec![format!("{request} HTTP/1.1"), "Connection: close".into()];
    if !head.iter().any(|line| line.starts_with("Host:")) {
        lines.push(format!("Host: {host}"));
    }
    if !head.iter().any(|line| line.starts_with("Transfer-Encoding:")) {
        lines.push(format!("Content-Length: {}", body.len()));
    }
    lines.extend(head.iter().map(|line| (*line).to_owned()));
    stream.write_all((lines.join("\r\n") + "\r\n\r\n").as_bytes()).unwrap();
    // A server that refuses a body does not take it all.
    let _ = stream.write_all(body);
    answer(stream)
}

fn answer(stream: TcpStream) -> Answer {
    let mut reader = BufReader::new(stream);
    let mut head = Vec::new();
    loop {
        let mut line = String::new();
        reader.read_line(&mut line).unwrap();
        if line.trim_end().is_empty() {
            break;
        }
        head.push(line.trim_end().to_lowercase());
    }
    let status = head.first().and_then(|line| line.split(' ').nth(1)?.parse().ok()).unwrap_or(0);
    let length = head.iter().find_map(|line| line.strip_prefix("content-length:")?.trim().parse().ok());
    let mut body = vec![0; length.unwrap_or(0)];
    match length {
        Some(_) => reader.read_exact(&mut body).unwrap(),
        None => drop(reader.read_to_end(&mut body)),
    }
    Answer { status, head, body }
}
