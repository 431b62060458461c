//! The guide that calibrates a pad at home.

use std::path::PathBuf;
use std::{env, fs};

use serde_json::{Value, json};

use crate::browser::{Browser, ENTER};
use crate::finger::Finger;
use crate::running::comes_true;
use crate::shown::Shown;

const GUIDE: &str = "at-home";
const MARKS_MM: [[f32; 2]; 5] = [[0.0, 0.0], [15.0, 0.0], [-15.0, 0.0], [0.0, 15.0], [0.0, -15.0]];

fn guide(shown: &Shown) -> Value {
    let guides = shown.ask("GET /api/guides", "").json();
    guides["guides"].as_array().unwrap().iter().find(|guide| guide["id"] == GUIDE).unwrap().clone()
}

fn act(shown: &Shown, action: &Value) -> (u16, Value) {
    let answer = shown.ask(&format!("POST /api/guides/{GUIDE}"), &action.to_string());
    (answer.status, answer.json())
}

/// The step that is done now.
fn doing(shown: &Shown) -> Value {
    let guide = guide(shown);
    let steps = guide["steps"].as_array().unwrap();
    steps.iter().find(|step| step["state"] == "doing").cloned().unwrap_or(Value::Null)
}

fn is_doing(shown: &Shown, step: &str) -> bool {
    doing(shown)["id"] == step
}

/// Seconds that were pressed, as the guide tells them.
fn pressed_s(shown: &Shown) -> f64 {
    let step = doing(shown);
    let detail = step["detail"].as_str().unwrap_or_default().split(' ').next().unwrap_or_default();
    if step["id"] == "press" { detail.parse().unwrap_or(0.0) } else { 0.0 }
}

fn decoder(shown: &Shown) -> PathBuf {
    shown.running.folder.path().join("tactpad/decoders/pad.decoder")
}

/// Presses here for a while, then lifts.
fn press(finger: &Finger, [x_mm, y_mm]: [f32; 2], fz_n: f32, for_ms: u64) {
    finger.press(x_mm, y_mm, fz_n);
    finger.stays(for_ms);
    finger.lift();
    finger.stays(200);
}

/// Presses a button of the guide's card.
fn choose(browser: &Browser, label: &str) {
    browser.click_button("[aria-labelledby=guide-at-home]", label);
}

#[test]
fn it_takes_grams_hears_presses_of_a_paused_game_is_stopped_and_goes_on() {
    let finger = Finger::start();
    let shown = Shown::start(&finger.address(), "contra");
    let Some(browser) = Browser::open(&shown.url) else { return };
    shown.wait_until_playing();
    browser.view("guides");
    choose(&browser, "Start");
    browser.wait(
        "document.querySelector('#guides input.number')?.labels[0].textContent.includes('Weight in grams')",
    );
    browser.run("document.querySelector('#guides input.number').focus()");
    browser.keys(&[], &["2", ENTER]);
    browser.wait("document.querySelector('#guides .number-error').textContent.includes('30 to 1000 g')");
    assert_ne!(shown.status()["state"], "paused");
    browser.keys(&[], &["0", "0", ENTER]);
    assert!(comes_true(|| shown.status()["state"] == "paused"), "{}", shown.status());
    browser.wait(
        "document.querySelector('#guides .cue:not([hidden])')?.textContent.includes('press again and again')",
    );
    let log = shown.log();
    let is_pressed = comes_true(|| {
        press(&finger, [0.0, 0.0], 3.0, 1_000);
        pressed_s(&shown) >= 3.0
    });
    assert!(is_pressed, "{}", doing(&shown));
    assert!(doing(&shown)["detail"].as_str().unwrap().contains("not yet: half way"), "{}", doing(&shown));
    assert_eq!(shown.log(), log, "nothing is pressed in the game");
    // Somebody lets the game go on: it stays paused.
    assert_eq!(shown.ask("POST /api/resume", "").status, 200);
    assert!(comes_true(|| shown.status()["state"] == "paused"));
    let heard_s = pressed_s(&shown);
    choose(&browser, "Stop");
    assert!(comes_true(|| shown.status()["state"] == "playing"), "{}", shown.status());
    browser.wait("document.getElementById('guides').innerText.includes('it goes on from there')");
    assert!(!decoder(&shown).exists() && decoder(&shown).with_extension("decoder.cap").exists());

    choose(&browser, "Start");
    browser.wait(
        "document.getElementById('guides').innerText.includes('What was heard of this pad earlier is kept')",
    );
    choose(&browser, "Begin without a weight");
    assert!(comes_true(|| pressed_s(&shown) >= heard_s), "{}", doing(&shown));
    assert!(guide(&shown)["steps"].as_array().unwrap().iter().all(|step| step["id"] != "marks"));
    // Who closes the page stops it.
    drop(browser);
    assert!(comes_true(|| guide(&shown)["state"] == "idle"), "{}", guide(&shown));
    assert!(comes_true(|| shown.status()["state"] == "playing"), "{}", shown.status());
}

#[test]
fn without_a_pad_it_says_why_it_does_not_begin() {
    let shown = Shown::start("auto:NO-SUCH-PAD", "contra");
    let (status, refused) = act(&shown, &json!({"do": "start"}));
    assert_eq!(status, 409, "{refused}");
    let why = refused["error"].as_str().unwrap();
    assert!(why.contains("no pad to calibrate") && why.contains("plug it in"), "{why}");
    assert_eq!(guide(&shown)["state"], "idle");
}

#[test]
fn the_sheet_is_a_file_to_keep() {
    let shown = Shown::start("virtual", "contra");
    for (name, begin) in [("marks.pdf", "%PDF"), ("marks.svg", "<svg")] {
        let sheet = shown.ask(&format!("GET /sheet/{name}"), "");
        assert_eq!(sheet.status, 200);
        assert!(String::from_utf8_lossy(&sheet.body).contains(begin), "{name}");
        let kept = format!("content-disposition: attachment; filename=\"{name}\"");
        assert!(sheet.head.contains(&kept), "{:?}", sheet.head);
        assert_eq!(crate::http::ask(&shown.host, &format!("GET /sheet/{name}"), &[], b"").status, 401);
    }
    assert_eq!(shown.ask("GET /sheet/marks.txt", "").status, 404);
}

/// Places all over the plate, one after the other: golden angles, evenly by area.
fn place(number: usize) -> [f32; 2] {
    let (angle, radius_mm) = (2.4 * number as f32, 26.0 * ((number % 29) as f32 / 29.0).sqrt());
    let (sin, cos) = libm::sincosf(angle);
    [radius_mm * cos, radius_mm * sin]
}

/// Presses all over the plate, then puts the weight where it is asked for.
fn obey(finger: &Finger, shown: &Shown) {
    for number in 0..400 {
        if !is_doing(shown, "press") {
            break;
        }
        press(finger, place(number), [1.0, 2.0, 4.0][number % 3], 400);
    }
    for (number, [x_mm, y_mm]) in MARKS_MM.into_iter().enumerate() {
        let asks =
            |what: &str| comes_true(|| doing(shown)["cue"].as_str().is_some_and(|cue| cue.contains(what)));
        assert!(asks(&format!("on mark {}", number + 1)), "{}", doing(shown));
        finger.press(x_mm, y_mm, 0.2 * 9.806_65);
        assert!(asks("take the weight away"), "{}", doing(shown));
        finger.lift();
    }
}

#[test]
#[ignore = "proof: 180 s: two to three minutes of real time, and pictures of the page where a folder is named"]
fn a_whole_calibration_ends_in_a_decoder() {
    let folder = env::var_os("TACTPAD_CALIBRATE").map(PathBuf::from);
    let finger = Finger::start();
    let shown = Shown::start(&finger.address(), "contra");
    let Some(browser) = Browser::open(&shown.url) else { return };
    shown.wait_until_playing();
    browser.resize(1100, 1500);
    browser.view("guides");
    let picture = |name: &str| {
        browser.run("document.querySelector('[aria-labelledby=guide-at-home]').scrollIntoView()");
        if let Some(folder) = &folder {
            fs::write(folder.join(name), browser.picture()).unwrap();
        }
    };
    choose(&browser, "Start");
    browser.wait("document.querySelector('#guides input.number')");
    picture("choosing.png");
    browser.run("document.querySelector('#guides input.number').focus()");
    browser.keys(&[], &["2", "0", "0", ENTER]);
    assert!(comes_true(|| is_doing(&shown, "press")), "{}", guide(&shown));
    (0..9).for_each(|number| press(&finger, place(number), 3.0, 600));
    picture("pressing.png");
    obey(&finger, &shown);
    assert!(comes_true(|| is_doing(&shown, "fit")), "{}", guide(&shown));
    assert!(comes_true(|| shown.status()["state"] == "playing"), "{}", shown.status());
    picture("fitting.png");
    assert!(comes_true(|| guide(&shown)["state"] == "done"), "{}", guide(&shown));
    browser.wait("document.querySelector('#guides .result table')?.rows.length === 14");
    picture("result.png");
    let result = guide(&shown)["result"].clone();
    let path = decoder(&shown).display().to_string();
    assert!(result["text"].as_str().unwrap().contains(&path), "{result}");
    assert_eq!(result["commands"][0]["text"], format!("tactpad run --decoder {path}"));
    assert!(tactpad::pipeline::contact::read::playing(&fs::read(decoder(&shown)).unwrap()).is_ok());
    assert_eq!(shown.status()["decoder"], "inverse", "what plays stays");
}
