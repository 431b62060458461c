//! The history of profiles on the page; profiles are renamed, deleted and brought back, exported and imported.

use std::fs;

use crate::browser::{Browser, ENTER};
use crate::finger::Finger;
use crate::running::comes_true;
use crate::shown::Shown;

fn editor(shown: &Shown) -> Option<Browser> {
    let browser = Browser::open(&shown.url)?;
    shown.wait_until_playing();
    browser.view("profile");
    browser.wait("document.querySelector('.history li')");
    Some(browser)
}

/// Saves the profile with another threshold, as somebody who types does.
fn save(shown: &Shown, browser: &Browser, name: &str, press_n: &str) {
    browser.run(&format!(
        "const area = document.getElementById('profile-text'); \
         area.value = area.value.replace(/^press_n = .*$/m, 'press_n = {press_n}'); \
         area.dispatchEvent(new Event('input', {{ bubbles: true }}))"
    ));
    browser.wait("document.getElementById('draft-state').textContent === '● not saved'");
    browser.run("document.getElementById('save').click()");
    let is_saved = || text(shown, name).is_some_and(|text| text.contains(&format!("press_n = {press_n}\n")));
    assert!(comes_true(is_saved));
    browser.wait("document.getElementById('draft-state').textContent === '✓ saved'");
}

fn text(shown: &Shown, name: &str) -> Option<String> {
    fs::read_to_string(shown.profile(name)).ok()
}

fn history(browser: &Browser) -> String {
    browser.run("return document.querySelector('.history').innerText").as_str().unwrap().to_owned()
}

/// Opens a row of the history by its number from the top.
fn open(browser: &Browser, row: usize) {
    browser.run(&format!("document.querySelectorAll('.history button:last-of-type')[{row}].click()"));
    browser.wait("document.getElementById('draft-state').textContent === '● not saved'");
}

/// Answers a dialog that asks for a name.
fn name(browser: &Browser, name: &str) {
    browser.wait("document.activeElement.id === 'new-name'");
    browser.run(&format!("document.activeElement.value = '{name}'"));
    browser.keys(&[], &[ENTER]);
    browser.wait(&format!("document.getElementById('profile-open').value === '{name}'"));
}

#[test]
fn an_earlier_save_and_the_shipped_profile_come_back_as_drafts() {
    let finger = Finger::start();
    let shown = Shown::start(&finger.address(), "contra");
    let Some(browser) = editor(&shown) else { return };
    assert!(history(&browser).contains("None yet"));
    save(&shown, &browser, "contra", "2.5");
    save(&shown, &browser, "contra", "2.75");
    browser.wait("document.querySelectorAll('.history li').length === 3");
    let told = history(&browser);
    assert!(told.contains("A: jump, press force from 2.5 N to 2.75 N"), "{told}");
    assert!(told.contains("A: jump, press force from 2 N to 2.5 N"), "{told}");
    open(&browser, 1);
    let shows = |press_n: &str| {
        browser.wait(&format!(
            "document.getElementById('profile-text').value.includes('press_n = {press_n}\\n')"
        ));
    };
    shows("2.5");
    assert!(comes_true(|| shown.status()["preview"] == true), "it is tried before it is kept");
    browser.run("document.getElementById('undo').click()");
    shows("2.75");
    // What was changed once more since is as before that save, too.
    let undo = |row: usize, press_n: &str, told: &str| {
        browser.run(&format!("document.querySelectorAll('.history [aria-label^=Undo]')[{row}].click()"));
        shows(press_n);
        let says = "document.querySelector('.editor-message').textContent";
        browser
            .wait(&format!("/{told}/.test({says}) && {says}.endsWith('Save keeps it, Undo takes it back.')"));
        browser.run("document.getElementById('undo').click()");
        shows("2.75");
    };
    undo(
        1,
        "2.0",
        "^A: jump, press force is 2 N again, as before today, [^.]*\\. It had become 2.75 N since\\.",
    );
    undo(0, "2.5", "^A: jump, press force is 2.5 N again, as before today, [^.]*\\. Save");
    // What it belonged to is gone: what to do is told.
    browser.run("document.querySelector('[data-group=\"button.0\"] > .remove').click()");
    browser.wait("document.getElementById('draft-state').textContent === '● not saved'");
    browser.run("document.querySelectorAll('.history [aria-label^=Undo]')[0].click()");
    browser.wait("document.getElementById('profile').innerText.includes('was removed, and that is not saved yet. First press Undo at the top')");
    browser.run("document.getElementById('undo').click()");
    shows("2.75");
    open(&browser, 2);
    shows("2.0");
    browser.run("document.getElementById('save').click()");
    assert!(comes_true(|| text(&shown, "contra").is_some_and(|text| text.contains("press_n = 2.0\n"))));
    browser.wait("document.querySelectorAll('.history li').length === 4");
}

/// Series of saves that are drawn: numbers are changed, buttons and zones come, go and are named, help is added.
const SERIES: usize = 100;
/// So many are looked at in one go.
const PIECE: usize = 20;

#[test]
fn a_save_is_undone_as_if_it_had_never_been_and_what_was_changed_once_more_is_as_before_it() {
    let finger = Finger::start();
    let shown = Shown::start(&finger.address(), "contra");
    let Some(browser) = editor(&shown) else { return };
    let (mut commuting, mut again) = (0, 0);
    // A script may not take long.
    for first in (0..SERIES).step_by(PIECE) {
        let ends = [("FIRST", first), ("END", first + PIECE)];
        let script = ends.iter().fold(include_str!("undo_series.js").to_owned(), |script, (name, number)| {
            script.replace(name, &number.to_string())
        });
        let told = browser.run(&format!("return (async () => {{ {script} }})()"));
        assert_eq!(told["wrong"], serde_json::json!([]));
        let count = |what: &str| told[what].as_u64().unwrap() as usize;
        (commuting, again) = (commuting + count("commuting"), again + count("again"));
    }
    assert!(again >= SERIES / 20, "{again} of {SERIES} series change once more what is undone");
    assert!((SERIES / 2..SERIES).contains(&commuting), "{commuting} of {SERIES} series commute");
}

#[test]
fn what_cannot_be_undone_by_itself_is_asked_about_and_not_played() {
    let finger = Finger::start();
    let shown = Shown::start(&finger.address(), "contra");
    let Some(browser) = editor(&shown) else { return };
    save(&shown, &browser, "contra", "2.5");
    // Buttons in one line: a text that is not known how to put a table back into.
    let inline = "schema = 1\\nname = \\\"One line\\\"\\noutput = \\\"gamepad\\\"\\nbutton = [{ force = \\\"fz\\\", press_n = 2.0, out = { gamepad = \\\"BTN_SOUTH\\\", keyboard = \\\"KEY_Z\\\" } }]\\n";
    let write = |script: &str| {
        browser.run(&format!(
            "const area = document.getElementById('profile-text'); area.value = {script}; \
             area.dispatchEvent(new Event('input', {{ bubbles: true }}))"
        ));
        browser.wait("document.getElementById('draft-state').textContent === '● not saved'");
        browser.wait("document.getElementById('save').getAttribute('aria-disabled') === 'false'");
        browser.click("#save");
        browser.wait("document.getElementById('draft-state').textContent === '✓ saved'");
    };
    write(&format!("\"{inline}\""));
    write(
        "area.value.replace('button = [', 'button = [{ force = \"fy\", press_n = 1.0, out = { gamepad = \"BTN_EAST\", keyboard = \"KEY_X\" } }, ')",
    );
    browser.wait("document.querySelectorAll('.history li').length === 4");
    browser.run("document.querySelectorAll('.history [aria-label^=Undo]')[0].click()");
    browser.wait("document.querySelector('dialog')?.innerText.includes('what is not saved yet')");
    browser.click_button("dialog", "Open the older profile");
    browser.wait("!document.getElementById('profile-text').value.includes('BTN_EAST')");
    browser.wait(
        "document.querySelector('.editor-message').textContent.includes('It is not played before you tick')",
    );
    assert_eq!(browser.run("return document.getElementById('preview').checked"), false);
    assert_eq!(shown.status()["preview"], false);
}

#[test]
fn a_profile_is_duplicated_renamed_deleted_and_brought_back() {
    let finger = Finger::start();
    let shown = Shown::start(&finger.address(), "contra");
    let Some(browser) = editor(&shown) else { return };
    assert_eq!(browser.run("return document.getElementById('delete').disabled"), true);
    browser.click("#duplicate");
    name(&browser, "mine");
    save(&shown, &browser, "mine", "2.5");
    browser.click("#rename");
    name(&browser, "yours");
    assert!(comes_true(|| text(&shown, "mine").is_none()));
    browser.wait("document.querySelectorAll('.history li').length === 2");
    let kept = text(&shown, "yours").unwrap();
    browser.click("#delete");
    browser.wait("document.activeElement.id === 'undelete'");
    assert_eq!(text(&shown, "yours"), None);
    browser.keys(&[], &[ENTER]);
    browser.wait("document.getElementById('profile-open').value === 'yours'");
    assert_eq!(text(&shown, "yours").unwrap(), kept);
    // What plays has to have something that plays in its place.
    let play = shown.ask("POST /api/play", "{\"name\":\"yours\"}");
    assert_eq!(play.status, 200);
    assert!(comes_true(|| shown.status()["profile_id"] != "contra"));
    let refused = shown.ask("DELETE /api/profile/yours", "");
    assert_eq!((refused.status, text(&shown, "yours")), (409, Some(kept)));
    browser.click("#rename");
    name(&browser, "again");
    assert!(comes_true(|| shown.ask("GET /api/profiles", "").json()["playing"] == "again"));
}

#[test]
fn a_profile_is_exported_and_imported_under_another_name() {
    let finger = Finger::start();
    let shown = Shown::start(&finger.address(), "contra");
    let Some(browser) = editor(&shown) else { return };
    let decoders = shown.profile("x").parent().unwrap().with_file_name("decoders");
    fs::create_dir_all(&decoders).unwrap();
    let bytes = tactpad::pipeline::shipped::bytes("statics").unwrap();
    fs::write(decoders.join("PAD-1.decoder"), &bytes).unwrap();
    save(&shown, &browser, "contra", "2.5");
    browser.wait("document.querySelector('#export-decoder option[value=\"PAD-1\"]')");
    browser.run(
        "document.getElementById('export').addEventListener('click', (event) => event.preventDefault())",
    );
    browser.click("#export");
    browser.wait("document.getElementById('export').closest('.commands').nextElementSibling.innerText.includes('contra.tactpad is downloaded')");
    browser.run("const choice = document.getElementById('export-decoder'); choice.value = 'PAD-1'; choice.dispatchEvent(new Event('change'))");
    let exported = "return fetch(document.getElementById('export').href).then((answer) => answer.text())";
    let exported = browser.run(exported).as_str().unwrap().to_owned();
    browser.run(&format!(
        "const file = new File([{}], 'contra.tactpad'); const all = new DataTransfer(); all.items.add(file); \
         const field = document.getElementById('import'); field.files = all.files; field.dispatchEvent(new Event('change'))",
        serde_json::to_string(&exported).unwrap()
    ));
    browser.wait("document.getElementById('new-name')?.value === 'contra'");
    name(&browser, "imported");
    assert!(comes_true(|| text(&shown, "imported") == text(&shown, "contra")));
    assert_eq!(fs::read(decoders.join("imported.decoder")).unwrap(), bytes.as_ref());
    let again = serde_json::json!({"document": exported, "name": "imported"}).to_string();
    let broken = serde_json::json!({"document": "{}", "name": "new"}).to_string();
    let out = serde_json::json!({"document": exported, "name": "../out"}).to_string();
    for asked in [again, broken, out] {
        let refused = shown.ask("POST /api/import", &asked);
        assert_eq!(refused.status, 400, "{refused:?}");
    }
}
