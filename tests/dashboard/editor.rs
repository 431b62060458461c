//! The profile editor: the picture, the text and the bridge say the same.

use std::fs;

use serde_json::Value;
use tactpad::pipeline::mapping::read::check::{OutputChoice, read};
use tactpad::pipeline::mapping::read::shipped;

use crate::browser::{Browser, CONTROL, ENTER};
use crate::finger::{Finger, PULSE_MS};
use crate::running::comes_true;
use crate::shown::Shown;

/// Where the threshold of the first button is drawn.
const THRESHOLD: &str = "[data-handle='button.0.press_n']";

/// An editor with Contra, whose first button needs 2 N, on a pad that is pressed with less.
fn editor(finger: &Finger) -> Option<(Shown, Browser)> {
    let shown = Shown::start(&finger.address(), "contra");
    let browser = Browser::open(&shown.url)?;
    shown.wait_until_playing();
    browser.view("profile");
    browser.wait(&format!("document.querySelector(\"{THRESHOLD}\")"));
    Some((shown, browser))
}

fn text(browser: &Browser) -> String {
    browser.run("return document.getElementById('profile-text').value").as_str().unwrap().to_owned()
}

fn write(browser: &Browser, text: &str) {
    let text = serde_json::to_string(text).unwrap();
    browser.run(&format!(
        "const area = document.getElementById('profile-text'); area.value = {text}; area.dispatchEvent(new Event('input', {{ bubbles: true }}))"
    ));
}

/// The first button's threshold; `None` of a profile that has errors, as one may have half a number long.
fn press_n(text: &str) -> Option<f32> {
    read(text, OutputChoice::AsWritten).0.map(|profile| profile.buttons[0].press_n)
}

fn is_held(shown: &Shown, control: &str) -> bool {
    shown.status()["held"].as_array().is_some_and(|held| held.iter().any(|it| it == control))
}

/// Whether nothing presses it any more, for much longer than the finger takes from one press to the next.
fn rests(shown: &Shown, control: &str) -> bool {
    let samples = || shown.status()["health"]["samples"].as_u64().unwrap();
    let until = samples() + 10 * PULSE_MS;
    comes_true(|| is_held(shown, control) || samples() >= until) && !is_held(shown, control)
}

/// From the last movement of a drag until it is played.
const DRAG_LIMIT_MS: f64 = 100.0;

/// So often it is tried.
const DRAGS: usize = 20;

/// Drags the threshold below the finger's force, from above it; milliseconds until that is played.
fn drag_and_wait(shown: &Shown, browser: &Browser) -> f64 {
    if browser.run("return window.took") != Value::Null {
        browser.drag(THRESHOLD, [120, 0]);
        assert!(comes_true(|| rests(shown, "BTN_SOUTH")), "{}", text(browser));
        browser.run("window.took = null; window.moved = 0");
    }
    browser.drag(THRESHOLD, [-120, 0]);
    browser.wait("window.took !== null");
    browser.run("return window.took").as_f64().unwrap()
}

#[test]
fn a_dragged_threshold_is_played_within_100_ms_kept_by_save_and_undone_by_revert() {
    let finger = Finger::start();
    let Some((shown, browser)) = editor(&finger) else { return };
    finger.pulse(15.0, 0.0, 1.8);
    assert!(comes_true(|| is_held(&shown, "ABS_HAT0X")) && rests(&shown, "BTN_SOUTH"));
    // From the last movement of the pointer before the key is down to the page that shows it.
    browser.run(
        "window.took = null; window.moved = 0; \
         addEventListener('pointermove', () => { if (window.took === null) window.moved = performance.now(); }, true); \
         const socket = WebSocket.prototype; const real = Object.getOwnPropertyDescriptor(MessageEvent.prototype, 'data').get; \
         Object.defineProperty(MessageEvent.prototype, 'data', { get() { const data = real.call(this); \
         if (window.took === null && window.moved > 0 && typeof data === 'string' && data.startsWith('{\"kind\":\"frame\"') \
         && JSON.parse(data).held.includes('BTN_SOUTH')) window.took = performance.now() - window.moved; return data; } });",
    );
    let before = text(&browser);
    // A machine that does other work may be late once, and not each time.
    let took_ms: Vec<f64> =
        (0..DRAGS).map(|_| drag_and_wait(&shown, &browser)).take_while(|ms| *ms >= DRAG_LIMIT_MS).collect();
    assert!(took_ms.len() < DRAGS, "a drag is played after {took_ms:?} ms");
    assert!(shown.log().contains("\"BTN_SOUTH\",\"value\":1"), "{}", shown.log());
    assert_eq!(shown.status()["preview"], true);
    assert!(!shown.profile("contra").exists(), "a preview is not kept");

    let dragged = text(&browser);
    assert!(press_n(&dragged).is_some_and(|force_n| force_n < 1.7), "{dragged}");
    browser.click("#save");
    assert!(comes_true(|| shown.profile("contra").exists()));
    assert!(comes_true(|| shown.status()["preview"] == false));
    let kept = fs::read_to_string(shown.profile("contra")).unwrap();
    assert_eq!(kept, dragged);
    let comments = |text: &str| text.matches('#').count();
    assert_eq!(comments(&kept), comments(&before), "comments are kept");

    browser.drag(THRESHOLD, [150, 0]);
    assert!(comes_true(|| rests(&shown, "BTN_SOUTH")), "{}", text(&browser));
    browser.click("#revert");
    browser.wait("document.getElementById('profile-text').value.length > 0");
    assert!(comes_true(|| text(&browser) == kept && is_held(&shown, "BTN_SOUTH")));
    assert_eq!(fs::read_to_string(shown.profile("contra")).unwrap(), kept);
}

#[test]
fn a_broken_text_shows_what_the_check_says_and_changes_nothing() {
    let finger = Finger::start();
    let Some((shown, browser)) = editor(&finger) else { return };
    let broken = text(&browser).replace("8way", "9way").replace("press_n = 2.0", "press_n = \"two\"");
    write(&browser, &broken);
    let (_, expected) = read(&broken, OutputChoice::AsWritten);
    assert!(expected.len() >= 2);
    browser.wait(&format!(
        "document.getElementById('diagnostics').innerText.includes({:?})",
        expected[0].message
    ));
    let shows = browser.run("return document.getElementById('diagnostics').innerText");
    let shows = shows.as_str().unwrap();
    for finding in &expected {
        let place = format!("{}:{}", finding.line, finding.column);
        assert!(shows.contains(&finding.message) && shows.contains(&place), "{finding:?}\n{shows}");
        assert!(finding.help.as_ref().is_none_or(|help| shows.contains(help)), "{finding:?}\n{shows}");
    }
    browser.run("document.getElementById('save').click()");
    assert_eq!(shown.status()["profile"], "Contra");
    assert!(!shown.profile("contra").exists());
    write(&browser, &broken.replace("9way", "8way").replace("\"two\"", "2.5"));
    browser.wait("!/error/i.test(document.getElementById('diagnostics').innerText)");
}

/// The text after a drag that changes it: the bridge makes it anew for each step of the drag, the last one after the drag's end.
fn rested_text(browser: &Browser, before: &str) -> String {
    let (mut last, mut same) = (before.to_owned(), 0);
    let is_at_rest = comes_true(|| {
        let now = text(browser);
        same = if now == last && now != before { same + 1 } else { 0 };
        last = now;
        same == 20
    });
    assert!(is_at_rest, "{last}");
    last
}

#[test]
fn undo_and_redo_go_through_all_changes_of_text_and_picture() {
    let finger = Finger::start();
    let Some((_shown, browser)) = editor(&finger) else { return };
    let first = text(&browser);
    browser.drag(THRESHOLD, [60, 0]);
    let second = rested_text(&browser, &first);
    browser.drag("[data-handle='dpad.centre_radius_mm']", [20, 0]);
    let third = rested_text(&browser, &second);
    browser.click("#undo");
    assert!(comes_true(|| text(&browser) == second), "{}", text(&browser));
    browser.click("#undo");
    assert!(comes_true(|| text(&browser) == first), "each drag is one step");
    browser.click("#redo");
    browser.click("#redo");
    assert!(comes_true(|| text(&browser) == third));
    browser.keys(&[CONTROL], &["z"]);
    assert!(comes_true(|| text(&browser) == second));
}

#[test]
fn a_control_is_named_and_seen_by_that_name() {
    let finger = Finger::start();
    let Some((shown, browser)) = editor(&finger) else { return };
    let write = |field: &str, words: &str| {
        browser.run(&format!(
            "const it = document.querySelector('[data-field=\"button.0.out.{field}\"]'); it.value = '{words}'; \
             it.dispatchEvent(new Event('change', {{ bubbles: true }}))"
        ));
    };
    write("label", "hop");
    assert!(
        comes_true(|| text(&browser).contains("keyboard = \"KEY_Z\", label = \"hop\" }")),
        "{}",
        text(&browser)
    );
    // Words are taken as they are shown, and names of files, too.
    for (words, written) in
        [("left bumper", "BTN_TL"), ("Up + x", "ABS_HAT0Y-+BTN_NORTH"), ("BTN_SOUTH", "BTN_SOUTH")]
    {
        write("gamepad", words);
        assert!(
            comes_true(|| text(&browser).contains(&format!("gamepad = \"{written}\", keyboard = \"KEY_Z\""))),
            "{words}"
        );
    }
    browser.run("window.print = () => { window.printed = true; }");
    browser.click("#print");
    browser.wait("document.querySelector('dialog .sheet-shown svg')");
    browser.run("document.querySelector('dialog .primary').click()");
    browser.wait("window.printed && document.querySelector('#sheet > svg').textContent.includes('A: hop')");
    browser.view("live");
    finger.press(0.0, 3.0, 3.0);
    browser.wait("document.querySelector('#live .chips').innerText.includes('A: hop')");
    assert_eq!(shown.status()["held_names"], serde_json::json!(["A: hop"]));
    finger.lift();
    browser.view("profile");
    bind_on_the_plate(&finger, &shown, &browser);
}

/// Press there, then the key: on the pad, and in the picture.
fn bind_on_the_plate(finger: &Finger, shown: &Shown, browser: &Browser) {
    let says = |sentence: &str| {
        browser.wait(&format!("document.querySelector('.binding').innerText.includes({sentence:?})"));
    };
    let bind = |key: &str, written: &str| {
        browser.keys(&[], &[key]);
        assert!(comes_true(|| text(browser).contains(written)), "{written}: {}", text(browser));
    };
    let press = |x_mm: f32, y_mm: f32, fz_n: f32| {
        browser.click("#bind");
        says("First the place");
        finger.press(x_mm, y_mm, fz_n);
        assert!(comes_true(|| shown.status()["held"].as_array().is_some_and(|held| !held.is_empty())));
        finger.lift();
    };
    // A finger on the pad may be anybody's: nothing listens before the page was told.
    press(15.0, 0.0, 1.0);
    says("The pad was pressed there.");
    browser.click_button(".binding", "right");
    says("right: press its key");
    bind("j", "right = \"KEY_J\"");
    says("right is J on the keyboard now. This profile plays the gamepad");
    // Where the whole press does something, that is meant.
    press(0.0, 15.0, 3.0);
    says("The pad was pressed there.");
    browser.click_button(".binding", "A: hop");
    says("A: hop: press its key");
    bind("k", "keyboard = \"KEY_K\", label = \"hop\"");
    // In the picture all that counts there may be meant.
    browser.click("#bind");
    says("First the place");
    browser.run("const plate = document.querySelector('#profile .plate'); const box = plate.getBoundingClientRect(); \
         plate.dispatchEvent(new MouseEvent('click', { clientX: box.x + box.width / 2, clientY: box.y + box.height / 2, bubbles: true }))");
    says("Which one?");
    browser.click_button(".binding", "B: fire");
    says("B: fire: press its key");
    bind("l", "\"KEY_L\"");
    // What is left stays as it was.
    let before = text(browser);
    browser.click("#bind");
    browser.keys(&[], &["\u{e00c}"]);
    says("Nothing was changed.");
    assert_eq!(text(browser), before);
}

#[test]
fn a_dragged_word_turns_all_directions_and_the_bar_saves_drops_and_says_what_is_in_play() {
    let finger = Finger::start();
    let Some((shown, browser)) = editor(&finger) else { return };
    let before = text(&browser);
    let turned = |text: &str| read(text, OutputChoice::AsWritten).0.unwrap().dpad.unwrap().rotation_deg;
    browser.drag("#profile [data-direction='2']", [-60, 20]);
    let after = rested_text(&browser, &before);
    assert!(turned(&after) > 10.0, "{after}");
    browser.wait(&format!(
        "document.querySelector('.editor-message').textContent === 'All directions are turned by {}°.'",
        turned(&after)
    ));
    browser.wait("document.getElementById('preview-notice').innerText.includes('not saved yet')");
    assert_eq!(
        browser.run("return [...document.querySelectorAll('#preview-notice button')].map((it) => it.textContent + it.className)"),
        serde_json::json!(["Savemain primary", "Drop what I changedmain"])
    );
    browser.click_button("#preview-notice", "Drop what I changed");
    assert!(comes_true(|| text(&browser) == before && shown.status()["preview"] == false));
    browser.click("#undo");
    assert!(comes_true(|| text(&browser) == after));
    browser.click("#pause");
    assert!(comes_true(|| shown.status()["state"] == "paused"));
    browser.click_button("#preview-notice", "Save");
    let says = |sentence: &str| {
        browser.wait(&format!("document.querySelector('.editor-message').textContent === {sentence:?}"));
    };
    says("Saved. tactpad is paused: Go on plays it.");
    browser.click("#pause");
    says("Saved, and in play.");
    browser.run("scrollTo(0, 1e6)");
    browser.wait("document.getElementById('pause').getBoundingClientRect().top >= 0");
    browser.wait("document.getElementById('announcer').textContent === ''");
}

/// A long press goes, and what it did comes to another press; a let-go force follows, or says that it does not.
#[test]
fn a_press_that_is_turned_off_is_put_elsewhere_and_a_let_go_force_follows_or_says_why() {
    let finger = Finger::start();
    let shown = Shown::start(&finger.address(), "super-mario");
    let Some(browser) = Browser::open(&shown.url) else { return };
    shown.wait_until_playing();
    browser.view("profile");
    browser.wait("document.querySelector('[data-part=\"button.0.hold\"]')");
    browser.run("for (const fold of document.querySelectorAll('#profile .group')) fold.open = true");
    finger.press(0.0, 0.0, 0.8);
    let field = |key: &str| format!("document.querySelector('input.number[data-field=\"button.0.{key}\"]')");
    let beside = |key: &str| format!("{}.closest('.field').innerText", field(key));
    browser.wait(&format!("/your last press: 0\\.[78]\\d N/.test({})", beside("press_n")));
    finger.lift();
    let typed = |key: &str, value: &str| {
        browser.run(&format!(
            "{it}.focus(); {it}.select(); document.execCommand('insertText', false, '{value}'); {it}.blur()",
            it = field(key)
        ));
    };
    let forces = || {
        let text = text(&browser);
        let profile = read(&text, OutputChoice::AsWritten).0;
        profile.map(|profile| [profile.buttons[0].press_n, profile.buttons[0].release_n])
    };
    typed("press_n", "3");
    assert!(comes_true(|| forces() == Some([3.0, 2.1])), "{:?}", forces());
    typed("release_n", "1.4");
    browser.wait(&format!(
        "{}.includes('It stays at 1.4 N; the usual share of 3 N is 2.1 N.')",
        beside("release_n")
    ));
    typed("press_n", "2.5");
    assert!(comes_true(|| forces() == Some([2.5, 1.4])), "{:?}", forces());
    browser.click_button(".field:has([data-field='button.0.release_n'])", "Set it to 1.75 N");
    assert!(comes_true(|| forces() == Some([2.5, 1.75])), "{:?}", forces());
    browser.click_button("[data-part='button.0.hold']", "Turn off the long press");
    let says = |sentence: &str| {
        browser.wait(&format!("document.querySelector('.editor-message').textContent === {sentence:?}"));
    };
    says("The long press is turned off: B: run and fire is on no button now. Undo brings it back.");
    browser.click_button(".offered", "Put B: run and fire elsewhere …");
    browser.run(
        "const [how] = document.querySelectorAll('dialog select'); how.value = 'fy'; how.dispatchEvent(new Event('change')); \
         document.querySelector('dialog .primary').click()",
    );
    says("Added: push up → B: run and fire, from 1 N.");
    browser.wait(
        "document.getElementById('undo').title.includes('Added: push up → B: run and fire, from 1 N.')",
    );
}

#[test]
fn a_decimal_comma_is_a_decimal_point_and_with_two_separators_nobody_knows() {
    let finger = Finger::start();
    let Some((_shown, browser)) = editor(&finger) else { return };
    let field = "document.querySelector('input.number[data-field=\"button.0.press_n\"]')";
    browser.run(&format!("{field}.closest('details').open = true; {field}.focus(); {field}.select();"));
    browser.keys(&[], &["1", ",", "5"]);
    assert!(comes_true(|| press_n(&text(&browser)) == Some(1.5)), "{}", text(&browser));
    browser.run(&format!("{field}.select()"));
    browser.keys(&[], &["2", ",", "5", " ", "N", ENTER]);
    assert!(comes_true(|| press_n(&text(&browser)) == Some(2.5)), "{}", text(&browser));
    browser.run(&format!("{field}.select(); document.execCommand('insertText', false, '1.234,5')"));
    browser.wait(&format!(
        "{field}.getAttribute('aria-invalid') === 'true' && document.getElementById('announcer').textContent.includes('is no number')"
    ));
    assert_eq!(press_n(&text(&browser)), Some(2.5));
}

#[test]
fn a_preview_ends_with_its_page() {
    let finger = Finger::start();
    let Some((shown, browser)) = editor(&finger) else { return };
    finger.pulse(15.0, 0.0, 1.8);
    browser.drag(THRESHOLD, [-120, 0]);
    assert!(comes_true(|| is_held(&shown, "BTN_SOUTH")));
    drop(browser);
    assert!(comes_true(|| shown.status()["preview"] == false && rests(&shown, "BTN_SOUTH")));
}

#[test]
fn the_last_minute_is_played_once_more_with_the_draft() {
    let shown = Shown::start("virtual", "super-mario");
    shown.wait_until_playing();
    let text = shipped::text("super-mario").unwrap();
    let rewind = |draft: &str| -> Value {
        let asked = serde_json::json!({"text": draft, "saved": text}).to_string();
        shown.ask("POST /api/rewind", &asked).json()
    };
    // Until a button was pressed: the player begins with directions.
    let is_pressed = |answer: &Value| answer["now"]["presses"]["BTN_SOUTH"].as_u64() > Some(0);
    assert!(comes_true(|| is_pressed(&rewind(text))), "{}", shown.log());
    let same = rewind(text);
    assert!(same["ok"] == true && is_pressed(&same), "{same}");
    assert_eq!(
        (same["only_now"].as_array().map(Vec::len), same["only_draft"].as_array().map(Vec::len)),
        (Some(0), Some(0))
    );
    let deaf = rewind(
        &text.replace("press_n = 2.0", "press_n = 30.0").replace("release_n = 1.4", "release_n = 20.0"),
    );
    assert_eq!(deaf["draft"]["presses"]["BTN_SOUTH"], Value::Null, "{deaf}");
    assert!(
        deaf["only_now"].as_array().is_some_and(|only| only.iter().any(|press| press["code"] == "BTN_SOUTH")),
        "{deaf}"
    );
    assert_eq!(rewind("name = 1")["ok"], false);
}
