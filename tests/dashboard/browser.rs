//! A headless browser, driven through chromedriver by the WebDriver protocol.

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

use serde_json::{Value, json};

use crate::http;
use crate::running::comes_true;
use crate::support::require;

/// What Chromium is started with: no window, nothing that it would look for elsewhere.
const FLAGS: [&str; 11] = [
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
    "--force-device-scale-factor=1",
    "--window-size=1280,900",
];

/// The key by which WebDriver tells an element.
const ELEMENT: &str = "element-6066-11e4-a52e-4f735466cecf";

/// Keys as WebDriver has them.
pub(crate) const TAB: &str = "\u{e004}";
pub(crate) const ENTER: &str = "\u{e007}";
pub(crate) const SHIFT: &str = "\u{e008}";
pub(crate) const CONTROL: &str = "\u{e009}";
pub(crate) const LEFT: &str = "\u{e012}";
pub(crate) const RIGHT: &str = "\u{e014}";

/// A browser with one page; it is closed when this is dropped.
pub(crate) struct Browser {
    driver: Child,
    host: String,
    session: String,
}

impl Browser {
    /// A browser with this page; `None` where there is none on this machine, which is told.
    pub(crate) fn open(url: &str) -> Option<Self> {
        if !require("chromedriver", "apt install chromium chromium-driver")
            || !require("chromium", "apt install chromium")
        {
            return None;
        }
        // It looks for a free port first and takes it then: another one may have been faster.
        let (driver, port) = (0..5).find_map(|_| start_driver()).unwrap();
        let mut browser = Self { driver, host: format!("127.0.0.1:{port}"), session: String::new() };
        let binary =
            if std::path::Path::new("/usr/bin/chromium").exists() { "/usr/bin/chromium" } else { "chromium" };
        let options = json!({"goog:chromeOptions": {"binary": binary, "args": FLAGS}});
        let begun = browser.ask("POST /session", &json!({"capabilities": {"alwaysMatch": options}}));
        browser.session = begun["sessionId"].as_str().unwrap_or_else(|| panic!("{begun}")).to_owned();
        browser.post("url", &json!({"url": url}));
        Some(browser)
    }

    fn ask(&self, request: &str, body: &Value) -> Value {
        let head = ["Content-Type: application/json"];
        let body = if body.is_null() { String::new() } else { body.to_string() };
        let answer = http::ask(&self.host, request, &head, body.as_bytes());
        let value = answer.json()["value"].clone();
        assert_eq!(answer.status, 200, "{request}: {value}");
        value
    }

    fn post(&self, command: &str, body: &Value) -> Value {
        self.ask(&format!("POST /session/{}/{command}", self.session), body)
    }

    /// Runs a function's body in the page; gives what it returns, or what its promise comes to.
    pub(crate) fn run(&self, script: &str) -> Value {
        self.post("execute/sync", &json!({"script": script, "args": []}))
    }

    /// Waits until an expression is true in the page.
    pub(crate) fn wait(&self, expression: &str) {
        let holds = comes_true(|| self.run(&format!("return Boolean({expression})")) == true);
        assert!(
            holds,
            "{expression} does not come true; the page shows {}",
            self.run("return document.body.innerText")
        );
    }

    /// Loads the page of this tab anew.
    pub(crate) fn reload(&self) {
        self.post("refresh", &json!({}));
    }

    /// Opens another tab with this page and goes on in it; gives what [`Browser::tab`] takes to go back.
    pub(crate) fn open_tab(&self, url: &str) -> String {
        let handle = |value: Value| value.as_str().unwrap().to_owned();
        let before = handle(self.ask(&format!("GET /session/{}/window", self.session), &Value::Null));
        let new = self.post("window/new", &json!({"type": "tab"}));
        self.tab(&handle(new["handle"].clone()));
        self.post("url", &json!({"url": url}));
        before
    }

    /// Goes on in this tab.
    pub(crate) fn tab(&self, handle: &str) {
        self.post("window", &json!({"handle": handle}));
    }

    /// Goes to a view by its address.
    pub(crate) fn view(&self, name: &str) {
        self.run(&format!("location.hash = '#{name}'"));
        self.wait(&format!("!document.querySelector('main section:not([hidden])')?.hidden && document.querySelector('main section:not([hidden])').id.includes('{name}')"));
    }

    fn element(&self, css: &str) -> String {
        let found = self.post("element", &json!({"using": "css selector", "value": css}));
        found[ELEMENT].as_str().unwrap().to_owned()
    }

    /// Clicks an element.
    pub(crate) fn click(&self, css: &str) {
        let element = self.element(css);
        self.post(&format!("element/{element}/click"), &json!({}));
    }

    /// Clicks the button of an element that reads so, once the page shows it: the page follows the bridge a little behind.
    pub(crate) fn click_button(&self, within: &str, label: &str) {
        let buttons = format!("[...document.querySelectorAll({:?})]", format!("{within} button"));
        let is_it = format!("(it) => it.textContent.trim() === {label:?}");
        self.wait(&format!("{buttons}.some({is_it})"));
        self.run(&format!("{buttons}.find({is_it}).click()"));
    }

    /// Presses keys one after the other, each up again before the next; those of `held` are down meanwhile.
    pub(crate) fn keys(&self, held: &[&str], keys: &[&str]) {
        let key = |kind: &str, key: &str| json!({"type": kind, "value": key});
        let down = held.iter().map(|it| key("keyDown", it));
        let pressed = keys.iter().flat_map(|it| [key("keyDown", it), key("keyUp", it)]);
        let up = held.iter().rev().map(|it| key("keyUp", it));
        let actions: Vec<Value> = down.chain(pressed).chain(up).collect();
        self.post("actions", &json!({"actions": [{"type": "key", "id": "keys", "actions": actions}]}));
    }

    /// Drags an element by so many pixels, in steps over 200 ms.
    pub(crate) fn drag(&self, css: &str, [x, y]: [i32; 2]) {
        let origin = json!({ELEMENT: self.element(css)});
        let moved = |part: i32| json!({"type": "pointerMove", "duration": 20, "x": x * part / 10, "y": y * part / 10, "origin": origin});
        // The element moves with the pointer: further places count from where the pointer is.
        let step =
            json!({"type": "pointerMove", "duration": 20, "x": x / 10, "y": y / 10, "origin": "pointer"});
        let mut actions = vec![moved(0), json!({"type": "pointerDown", "button": 0})];
        actions.extend((0..10).map(|_| step.clone()));
        actions.push(json!({"type": "pointerUp", "button": 0}));
        let pointer = json!({"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": actions});
        self.post("actions", &json!({"actions": [pointer]}));
    }

    /// What the window shows, as PNG.
    pub(crate) fn picture(&self) -> Vec<u8> {
        let picture = self.ask(&format!("GET /session/{}/screenshot", self.session), &Value::Null);
        from_base64(picture.as_str().unwrap())
    }

    /// Lets the page have so many pixels, also fewer than a window can have.
    pub(crate) fn show_in(&self, width: u32, height: u32) {
        let params = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
        let command = json!({"cmd": "Emulation.setDeviceMetricsOverride", "params": params});
        self.post("goog/cdp/execute", &command);
    }

    /// Makes the window so large.
    pub(crate) fn resize(&self, width: u32, height: u32) {
        self.post("window/rect", &json!({"width": width, "height": height}));
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        if !self.session.is_empty() && !std::thread::panicking() {
            self.ask(&format!("DELETE /session/{}", self.session), &json!({}));
        }
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}

/// A driver, and its port.
fn start_driver() -> Option<(Child, u16)> {
    let mut command = Command::new("chromedriver");
    let mut driver = command.arg("--port=0").stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let mut told = BufReader::new(driver.stdout.take().unwrap()).lines().map_while(Result::ok);
    let port = told.find_map(|line| {
        let port = line.split("successfully on port ").nth(1)?;
        port.trim_end_matches('.').parse().ok()
    });
    let Some(port) = port else {
        let _ = driver.wait();
        return None;
    };
    // Whatever it tells later must not stop it.
    std::thread::spawn(move || told.count());
    Some((driver, port))
}

/// The bytes of a text in base 64.
fn from_base64(text: &str) -> Vec<u8> {
    const DIGITS: &str = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let digits: Vec<u32> = text.chars().filter_map(|it| DIGITS.find(it)).map(|it| it as u32).collect();
    let group = |four: &[u32]| {
        let bits = (0..4).fold(0, |bits, index| bits << 6 | four.get(index).copied().unwrap_or(0));
        bits.to_be_bytes()[1..four.len()].to_vec()
    };
    digits.chunks(4).flat_map(group).collect()
}
