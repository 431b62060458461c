//! The guides lead from step to step.

use serde_json::Value;

use crate::browser::Browser;
use crate::finger::Finger;
use crate::running::comes_true;
use crate::shown::Shown;

fn guide(shown: &Shown, id: &str) -> Value {
    let guides = shown.ask("GET /api/guides", "").json();
    guides["guides"].as_array().unwrap().iter().find(|guide| guide["id"] == id).unwrap().clone()
}

fn act(shown: &Shown, id: &str, action: &str) -> (u16, Value) {
    let answer = shown.ask(&format!("POST /api/guides/{id}"), &serde_json::json!({"do": action}).to_string());
    (answer.status, answer.json())
}

fn states(guide: &Value) -> Vec<&str> {
    guide["steps"].as_array().unwrap().iter().map(|step| step["state"].as_str().unwrap()).collect()
}

#[test]
fn the_first_run_goes_from_the_pad_to_the_third_press() {
    let finger = Finger::start();
    let shown = Shown::start(&finger.address(), "contra");
    let Some(browser) = Browser::open(&shown.url) else { return };
    shown.wait_until_playing();
    browser.view("guides");
    browser.wait("document.getElementById('guides').innerText.includes('First run')");
    assert_eq!(act(&shown, "first-run", "start").0, 200);
    browser.wait("document.getElementById('guides').innerText.includes('0 of 3 touches')");
    for touches in 1..=3 {
        finger.press(0.0, 0.0, 1.0);
        assert!(comes_true(|| shown.status()["contact"] != Value::Null));
        finger.lift();
        assert!(comes_true(|| shown.status()["contact"] == Value::Null), "touch {touches}");
    }
    assert!(comes_true(|| guide(&shown, "first-run")["state"] == "done"), "{}", guide(&shown, "first-run"));
    assert_eq!(states(&guide(&shown, "first-run")), ["done"; 4]);
    assert_eq!(act(&shown, "first-run", "dance").0, 409);
    assert_eq!(act(&shown, "no-guide", "start").0, 404);
}

/// Presses again and again for so long: five times in three seconds.
fn press_for(finger: &Finger, shown: &Shown, seconds: u32, fz_n: f32, until: impl Fn() -> bool) {
    for _ in 0..2 * seconds {
        if until() {
            return;
        }
        finger.press(0.0, 0.0, fz_n);
        assert!(comes_true(|| shown.status()["contact"] != Value::Null));
        finger.stays(200);
        finger.lift();
        finger.stays(200);
    }
}

#[test]
#[ignore = "proof: 65 s: the guide listens for a minute of real time"]
fn half_a_minute_of_presses_gives_a_draft_with_the_forces_of_the_hand() {
    let finger = Finger::start();
    let shown = Shown::start(&finger.address(), "contra");
    let Some(browser) = Browser::open(&shown.url) else { return };
    shown.wait_until_playing();
    browser.view("guides");
    assert_eq!(act(&shown, "force-range", "start").0, 200);
    let is_hard = || states(&guide(&shown, "force-range"))[1] == "doing";
    press_for(&finger, &shown, 30, 0.6, is_hard);
    assert_eq!(states(&guide(&shown, "force-range")), ["done", "doing", "todo"]);
    press_for(&finger, &shown, 30, 4.0, || guide(&shown, "force-range")["steps"][1]["state"] != "doing");
    assert!(
        comes_true(|| guide(&shown, "force-range")["state"] == "done"),
        "{}",
        guide(&shown, "force-range")
    );
    let result = guide(&shown, "force-range")["result"].clone();
    let draft = result["draft"]["text"].as_str().unwrap_or_else(|| panic!("{result}"));
    assert!(draft.contains("# ") && !draft.contains("press_n = 2.0"), "{draft}");
    assert_eq!(result["draft"]["profile"], "contra");
    assert!(!shown.profile("contra").exists(), "nothing is kept before people say so");
    browser.click_button("#guides", "Open contra with it in the editor");
    browser.wait("document.getElementById('profile-text')?.value.length > 0");
    let text = browser.run("return document.getElementById('profile-text').value");
    assert_eq!(text.as_str(), Some(draft));
}

#[test]
fn cues_ask_for_what_the_profile_can_and_are_stopped_at_any_time() {
    let finger = Finger::start();
    let shown = Shown::start(&finger.address(), "contra");
    let Some(_browser) = Browser::open(&shown.url) else { return };
    shown.wait_until_playing();
    let (status, begun) = act(&shown, "tune", "start");
    assert_eq!((status, begun["state"].as_str()), (200, Some("running")));
    assert!(comes_true(|| guide(&shown, "tune")["steps"][0]["cue"]
        .as_str()
        .is_some_and(|cue| cue.contains("right"))));
    assert!(comes_true(|| guide(&shown, "tune")["steps"][0]["cue"]
        .as_str()
        .is_some_and(|cue| cue.contains("up"))));
    assert_eq!(act(&shown, "tune", "stop").1["state"], "idle");
}
