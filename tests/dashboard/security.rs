//! Who may ask, and what nobody may.

use std::fs;
use std::io::{Read, Write};
use std::net::{SocketAddrV4, TcpStream};
use std::process::Command;

use tactpad::pipeline::mapping::read::shipped;

use crate::http::ask;
use crate::running::comes_true;
use crate::shown::Shown;

fn shown() -> Shown {
    Shown::start("virtual", "contra")
}

#[test]
fn without_the_token_nothing_is_told_and_nothing_is_done() {
    let shown = shown();
    let wrong = "Authorization: Bearer 00000000000000000000000000000000";
    for request in
        ["GET /api/status", "POST /api/pause", "PUT /api/profile/contra", "GET /api/live", "GET /report/0"]
    {
        for head in [&[][..], &[wrong]] {
            let answer = ask(&shown.host, request, head, b"");
            assert_eq!(answer.status, 401, "{request} {answer:?}");
        }
    }
    assert_ne!(shown.status()["state"], "paused");
    assert_eq!(shown.ask("POST /api/pause", "").status, 200);
    assert_eq!(shown.status()["state"], "paused");
}

#[test]
fn another_page_and_another_name_are_refused_even_with_the_token() {
    let shown = shown();
    let token = format!("Authorization: Bearer {}", shown.token);
    let origins = ["Origin: http://evil.example", "Origin: null", "Sec-Fetch-Site: cross-site"];
    for head in origins {
        assert_eq!(ask(&shown.host, "POST /api/pause", &[&token, head], b"").status, 403, "{head}");
    }
    let upgrade = [&token, "Origin: http://evil.example", "Upgrade: websocket", "Connection: Upgrade"];
    assert_eq!(ask(&shown.host, "GET /api/live", &upgrade, b"").status, 403);
    for host in ["Host: evil.example", "Host: 127.0.0.1", "Host: 127.0.0.1:1"] {
        for request in ["GET /", "GET /page/main.js", "GET /api/status"] {
            assert_eq!(ask(&shown.host, request, &[&token, host], b"").status, 403, "{host} {request}");
        }
    }
    assert_ne!(shown.status()["state"], "paused");
}

#[test]
fn no_name_leads_out_of_the_folder_of_profiles() {
    let shown = shown();
    let text = shipped::text("contra").unwrap();
    let secret = shown.running.folder.path().join("secret.toml");
    fs::write(&secret, text).unwrap();
    for name in [
        "..%2F..%2Fsecret",
        "../../secret",
        "..%2f..%2fsecret.toml",
        "%2Fetc%2Fpasswd",
        "secret.toml",
        ".",
        "..",
        "a%00b",
    ] {
        for (method, body) in [("GET", ""), ("PUT", text)] {
            let answer = shown.ask(&format!("{method} /api/profile/{name}"), body);
            assert!((400..500).contains(&answer.status), "{method} {name}: {answer:?}");
            assert!(!String::from_utf8_lossy(&answer.body).contains("Contra"), "{name}");
        }
        let answer = shown.ask("POST /api/play", &serde_json::json!({"name": name}).to_string());
        assert_eq!(answer.status, 404, "{name}");
    }
    let path = secret.display().to_string();
    assert_eq!(shown.ask("POST /api/play", &serde_json::json!({"name": path}).to_string()).status, 404);
    assert_eq!(fs::read_to_string(&secret).unwrap(), text);
    assert!(!shown.profile("contra").exists());
}

#[test]
fn a_body_of_100_megabytes_is_refused_whether_its_length_is_told_or_not() {
    let shown = shown();
    let token = format!("Authorization: Bearer {}", shown.token);
    let body = vec![b'x'; 100 << 20];
    assert_eq!(ask(&shown.host, "PUT /api/profile/big", &[&token], &body).status, 413);
    let mut chunks = Vec::new();
    for chunk in body.chunks(1 << 16) {
        chunks.extend_from_slice(format!("{:x}\r\n", chunk.len()).as_bytes());
        chunks.extend_from_slice(chunk);
        chunks.extend_from_slice(b"\r\n");
    }
    let head = [token.as_str(), "Transfer-Encoding: chunked"];
    assert_eq!(ask(&shown.host, "PUT /api/profile/big", &head, &chunks).status, 413);
    assert_eq!(
        ask(&shown.host, "POST /api/draft", &[&token, "Content-Type: application/json"], &body).status,
        413
    );
    assert_eq!(shown.ask("GET /api/status", "").status, 200);
}

#[test]
fn nothing_changes_by_a_get() {
    let shown = shown();
    for path in [
        "/api/pause",
        "/api/resume",
        "/api/panic",
        "/api/tare",
        "/api/play",
        "/api/preview",
        "/api/draft",
        "/api/rewind",
    ] {
        assert_eq!(shown.ask(&format!("GET {path}"), "").status, 405, "{path}");
    }
}

#[test]
fn each_answer_says_what_the_browser_may_do() {
    let shown = shown();
    for request in ["GET /", "GET /page/style.css", "GET /api/status", "GET /nothing"] {
        let answer = shown.ask(request, "");
        let told =
            |name: &str| answer.head.iter().find(|line| line.starts_with(name)).cloned().unwrap_or_default();
        let policy = told("content-security-policy");
        assert!(
            policy.contains("default-src 'none'") && policy.contains("frame-ancestors 'none'"),
            "{request}: {policy}"
        );
        assert!(!policy.contains("unsafe"), "{policy}");
        assert!(told("x-content-type-options").contains("nosniff"), "{request}");
        assert!(told("cache-control").contains("no-store"), "{request}");
        assert!(!answer.head.iter().any(|line| line.starts_with("access-control-allow")), "{request}");
    }
}

/// The first line of what another user is answered.
pub(crate) fn asked_by_another_user(host: &str, request: &str) -> Option<String> {
    let (address, port) = host.split_once(':').unwrap();
    let script = format!(
        "exec 3<>/dev/tcp/{address}/{port}; \
         printf '{request} HTTP/1.1\\r\\nHost: {host}\\r\\nConnection: close\\r\\n\\r\\n' >&3; head -1 <&3"
    );
    let mut other = Command::new("setpriv");
    other.args(["--reuid=65534", "--clear-groups", "bash", "-c", &script]);
    let output = other.output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8_lossy(&output.stdout).trim_end().to_owned())
}

#[test]
fn the_page_opens_for_this_user_without_a_token_and_for_no_other() {
    let shown = shown();
    let opened = ask(&shown.host, "GET /open", &[], b"");
    assert_eq!(opened.status, 303);
    let location = opened.head.iter().find(|line| line.to_lowercase().starts_with("location:")).unwrap();
    assert!(location.contains(&shown.token), "{location}");
    assert_eq!(ask(&shown.host, "GET /open", &["Sec-Fetch-Site: cross-site"], b"").status, 401);
    // Only root can be another user, too.
    for _ in 0..20 {
        for request in ["GET /open", "POST /handshake"] {
            match asked_by_another_user(&shown.host, request) {
                Some(line) => assert_eq!(line, "HTTP/1.1 403 Forbidden"),
                None => assert!(!rustix::process::getuid().is_root(), "setpriv"),
            }
        }
    }
}

#[test]
fn connections_that_ask_for_nothing_keep_nobody_out() {
    let shown = shown();
    // More than are let in, and no more than other tests of this process can spare.
    let idle: Vec<_> = (0..300).filter_map(|_| TcpStream::connect(shown.host.as_str()).ok()).collect();
    assert!(idle.len() > 200, "{}", idle.len());
    assert!(shown.running.ctl("status").status.success());
    assert!(comes_true(|| {
        let mut stream = TcpStream::connect(shown.host.as_str()).unwrap();
        let request = format!("GET / HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n\r\n", shown.host);
        let mut answer = String::new();
        let _ =
            stream.write_all(request.as_bytes()).and_then(|()| stream.read_to_string(&mut answer).map(drop));
        answer.starts_with("HTTP/1.1 200")
    }));
    drop(idle);
}

#[test]
fn it_listens_on_loopback_alone() {
    let shown = shown();
    let address: SocketAddrV4 = shown.host.parse().unwrap();
    let [ip, port] = [u32::from_ne_bytes(address.ip().octets()), u32::from(address.port())];
    assert!(address.ip().is_loopback(), "{address}");
    let table = fs::read_to_string("/proc/net/tcp").unwrap();
    let listening = |ip: u32| table.contains(&format!(" {ip:08X}:{port:04X} 00000000:0000 0A"));
    assert!(listening(ip), "{table}");
    assert!(!listening(0));
    let sixth = fs::read_to_string("/proc/net/tcp6").unwrap_or_default();
    assert!(!sixth.contains(&format!(":{port:04X} 00000000000000000000000000000000:0000 0A")), "{sixth}");
    assert!(TcpStream::connect(address).is_ok());
}

#[test]
fn a_profile_is_kept_only_as_it_was_seen_and_without_errors() {
    let shown = shown();
    let read = shown.ask("GET /api/profile/contra", "").json();
    let (text, version) = (read["text"].as_str().unwrap(), read["version"].as_str().unwrap());
    let token = format!("Authorization: Bearer {}", shown.token);
    let put = |name: &str, head: &str, text: &str| {
        ask(&shown.host, &format!("PUT /api/profile/{name}"), &[&token, head], text.as_bytes())
    };
    let broken = put("contra", &format!("If-Match: {version}"), &text.replace("8way", "9way"));
    assert_eq!((broken.status, broken.json()["diagnostics"][0]["severity"].as_str()), (422, Some("error")));
    assert!(!shown.profile("contra").exists(), "a shipped profile is copied only when it is kept");
    let changed = text.replace("press_n = 2.0", "press_n = 2.5");
    assert_eq!(put("contra", &format!("If-Match: {version}"), &changed).status, 200);
    assert_eq!(fs::read_to_string(shown.profile("contra")).unwrap(), changed);
    let stale = put("contra", &format!("If-Match: {version}"), text);
    assert_eq!((stale.status, fs::read_to_string(shown.profile("contra")).unwrap()), (412, changed.clone()));
    assert_eq!(put("contra", "If-None-Match: *", text).status, 412);
    assert_eq!(put("mine", "If-None-Match: *", text).status, 200);
    assert_eq!(put("not%20a/name", "If-None-Match: *", text).status, 404);
}
