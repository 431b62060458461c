//! Numbers cannot be mistyped: what a field cannot take is told beside it, and neither written nor played.

use serde_json::Value;
use tactpad::pipeline::mapping::read::check::{OutputChoice, read};

use crate::browser::{Browser, ENTER, TAB};
use crate::finger::Finger;
use crate::running::comes_true;
use crate::shown::Shown;

/// What people type, and the number that it is.
const TYPED: [(&str, Option<f64>); 7] = [
    ("1,5", Some(1.5)),
    ("", None),
    ("1e3", None),
    ("99", Some(99.0)),
    ("-1", Some(-1.0)),
    ("text", None),
    ("0.7", Some(0.7)),
];

/// Tables that a profile which has all others still lacks.
const ADDED: [&str; 7] = ["button", "zone", "stick", "trigger", "layer", "macro", "program"];

fn editor(shown: &Shown) -> Option<Browser> {
    let browser = Browser::open(&shown.url)?;
    shown.wait_until_playing();
    browser.view("profile");
    browser.wait("document.querySelector('.number')");
    browser.run("for (const fold of document.querySelectorAll('#profile details')) fold.open = true");
    Some(browser)
}

fn text(browser: &Browser) -> String {
    browser.run("return document.getElementById('profile-text').value").as_str().unwrap().to_owned()
}

fn focus(browser: &Browser) -> String {
    let name = "const it = document.activeElement; return it.dataset.field ?? it.dataset.add ?? it.parentElement?.dataset.group ?? it.tagName";
    browser.run(name).as_str().unwrap_or_default().to_owned()
}

/// Adds one table; whether the focus is in it then.
fn add(browser: &Browser, table: &str) {
    browser.run(&format!("document.querySelector('[data-add={table}]').focus()"));
    browser.keys(&[], &[ENTER]);
    if table == "button" {
        browser.wait("document.querySelector('dialog select')");
        let add = "document.querySelector('dialog .primary').click()";
        browser.run(add);
        let says = |sentence: &str| {
            browser.wait(&format!("document.querySelector('dialog').innerText.includes({sentence:?})"));
        };
        says("Still to choose: “What your finger does” and “What comes of it”.");
        browser.run(
            "const [how, , what] = document.querySelectorAll('dialog select'); \
             for (const [select, value] of [[how, '-fy'], [what, 'BTN_START']]) { select.value = value; select.dispatchEvent(new Event('change')); }",
        );
        says("It counts from 1 N on");
        says("it is space there");
        browser.run(add);
        browser.wait(
            "document.querySelector('.editor-message').textContent === 'Added: push down → Start, from 1 N.'",
        );
    }
    assert!(
        comes_true(|| focus(browser).starts_with(&format!("{table}."))),
        "{table}: {} has the focus",
        focus(browser)
    );
}

fn assert_valid(text: &str, why: &str) {
    let (profile, findings) = read(text, OutputChoice::AsWritten);
    assert!(profile.is_some(), "{why}: {findings:?}\n{text}");
}

/// Types into the field of this name and leaves it; what it says then, and the key's value in the text.
fn typed(browser: &Browser, field: &str, text: &str) -> Value {
    browser.run(&format!(
        "const it = document.querySelector('.number[data-field=\"{field}\"]'); it.focus(); it.value = '{text}'; \
         it.dispatchEvent(new Event('input', {{ bubbles: true }})); it.blur(); \
         const error = it.closest('.field').querySelector('.number-error'); \
         return [it.getAttribute('aria-invalid') === 'true', error.hidden ? '' : error.textContent, \
         Number(it.getAttribute('aria-valuemin')), Number(it.getAttribute('aria-valuemax'))]"
    ))
}

/// The number at a place such as `button.0.press_n`.
fn value_at(text: &str, field: &str) -> Option<f64> {
    let mut value = toml::Value::Table(toml::from_str(text).ok()?);
    for part in field.split('.') {
        let next =
            part.parse::<usize>().map_or_else(|_| value.get(part).cloned(), |at| value.get(at).cloned());
        value = next?;
    }
    value.as_float().or_else(|| Some(value.as_integer()? as f64))
}

/// The draft's text once everything was answered that was asked.
fn settled(browser: &Browser) -> String {
    browser.run(
        "const area = document.getElementById('profile-text'); let before = null; \
         return new Promise((done) => { const look = () => { if (area.value === before) return done(area.value); \
         before = area.value; setTimeout(look, 60); }; look(); })",
    ).as_str().unwrap().to_owned()
}

#[test]
fn every_number_field_takes_its_range_and_tells_what_is_wrong_with_the_rest() {
    let shown = Shown::start("virtual", "contra");
    let Some(browser) = editor(&shown) else { return };
    browser.click("#preview");
    for table in ADDED {
        add(&browser, table);
        assert_valid(&settled(&browser), table);
    }
    browser.run("for (const fold of document.querySelectorAll('#profile details')) fold.open = true");
    let fields = browser
        .run("return [...document.querySelectorAll('.number[data-field]')].map((it) => it.dataset.field)");
    let fields: Vec<&str> = fields.as_array().unwrap().iter().map(|it| it.as_str().unwrap()).collect();
    assert!(fields.len() > 50, "{fields:?}");
    let mut taken = 0;
    for field in fields {
        let before = settled(&browser);
        for (input, number) in TYPED {
            let why = format!("{field}: {input:?}");
            let said = typed(&browser, field, input);
            let now = settled(&browser);
            let (is_invalid, sentence) = (said[0] == true, said[1].as_str().unwrap());
            let [min, max] = [2, 3].map(|at| said[at].as_f64().unwrap());
            if !is_invalid {
                assert!(
                    sentence.is_empty() && number.is_some_and(|it| (min..=max).contains(&it)),
                    "{why} {said}"
                );
                taken += 1;
                assert_eq!(value_at(&now, field), number, "{why}\n{now}");
                if now != before {
                    browser.run("document.getElementById('undo').click()");
                    assert_eq!(settled(&browser), before, "{why} is one step back");
                }
                continue;
            }
            // What can be taken may still need another key; what cannot leaves a text that can be played.
            assert_eq!(now, before, "{why}");
            assert!(sentence.contains(&format!("{min} to {max}")), "{why} {said}");
            let in_range = number.is_some_and(|it| (min..=max).contains(&it));
            assert!(!in_range || sentence.contains("no whole number"), "{why} {said}");
        }
        typed(&browser, field, "text");
        browser.run(&format!("document.querySelector('.number[data-field=\"{field}\"]').focus()"));
        browser.keys(&[], &["\u{e00c}"]);
        assert_eq!(
            browser.run("return document.activeElement.getAttribute('aria-invalid')"),
            "false",
            "{field}: Escape brings back what was there"
        );
    }
    assert!(taken > 50, "{taken}");
}

#[test]
fn a_number_out_of_range_is_told_in_the_live_region_and_not_played() {
    let finger = Finger::start();
    let shown = Shown::start(&finger.address(), "contra");
    let Some(browser) = editor(&shown) else { return };
    let field = "document.querySelector('.number[data-field=\"button.0.press_n\"]')";
    browser.run(&format!("{field}.focus(); {field}.select()"));
    browser.keys(&[], &["-", "1"]);
    browser.wait(&format!("{field}.getAttribute('aria-invalid') === 'true'"));
    browser.wait("document.getElementById('announcer').textContent.includes('-1 is out of range')");
    let described = browser.run(&format!(
        "return {field}.getAttribute('aria-describedby').split(' ').map((id) => document.getElementById(id).textContent).join(' ')"
    ));
    assert!(described.as_str().unwrap().contains("-1 is out of range"), "{described}");
    assert_eq!(shown.status()["preview"], false);
    browser.keys(&[], &[TAB]);
    assert_eq!(browser.run(&format!("return {field}.value")), "-1", "what was typed stays to be mended");
}

#[test]
fn the_focus_goes_to_the_neighbour_of_what_was_removed() {
    let shown = Shown::start("virtual", "contra");
    let Some(browser) = editor(&shown) else { return };
    let remove = |group: &str| {
        browser.run(&format!(
            "const all = document.querySelectorAll('[data-group=\"{group}\"] > .remove'); const it = all[all.length - 1]; it.focus(); it.click()"
        ));
    };
    let goes_to = |place: &str| comes_true(|| focus(&browser) == place);
    add(&browser, "button");
    add(&browser, "button");
    let buttons = text(&browser).matches("[[button]]").count();
    remove("button.0");
    assert!(goes_to("button.0"), "{}", focus(&browser));
    remove(&format!("button.{}", buttons - 2));
    assert!(goes_to(&format!("button.{}", buttons - 3)), "{}", focus(&browser));
    browser.wait("document.getElementById('announcer').textContent.includes('Removed: Button')");
    add(&browser, "zone");
    remove("zone.0");
    assert!(goes_to("zone"), "{}", focus(&browser));
    browser.run("document.querySelector('.number[data-field=\"dpad.centre_radius_mm\"]').closest('.field').querySelector('.back').focus()");
    browser.keys(&[], &[ENTER]);
    assert!(goes_to("dpad.centre_radius_mm"), "{}", focus(&browser));
}

#[test]
fn enter_in_a_name_does_what_the_button_does() {
    let shown = Shown::start("virtual", "contra");
    let Some(browser) = editor(&shown) else { return };
    browser.click("#save-as");
    browser.wait("document.activeElement.id === 'new-name'");
    browser.run("document.activeElement.select()");
    browser.keys(&[], &["m", "i", "n", "e", ENTER]);
    assert!(comes_true(|| shown.profile("mine").exists()));
    browser.wait("document.getElementById('profile-open').value === 'mine'");
}
