//! The page is used without a mouse, and without seeing well.

use std::fs;
use std::path::PathBuf;

use rustix::process::Signal;
use serde_json::{Value, json};

use crate::browser::{Browser, CONTROL, ENTER, LEFT, RIGHT, SHIFT, TAB};
use crate::finger::Finger;
use crate::running::comes_true;
use crate::shown::Shown;
use crate::support::leave_out;

const VIEWS: [&str; 5] = ["live", "profile", "guides", "reports", "doctor"];

/// The accessibility checker axe-core, where `TACTPAD_AXE` says that its file is.
fn axe() -> Option<String> {
    let path = std::env::var_os("TACTPAD_AXE").map(PathBuf::from);
    let text = path.and_then(|path| fs::read_to_string(path).ok());
    if text.is_none() {
        leave_out("axe-core", "npm install axe-core && export TACTPAD_AXE=node_modules/axe-core/axe.min.js");
    }
    text
}

/// Sizes of windows: a phone, half a screen, small and large screens.
const SIZES: [[u32; 2]; 4] = [[400, 900], [800, 900], [1280, 900], [1920, 1080]];

/// Chooses the colours.
fn choose(browser: &Browser, theme: &str) {
    browser.run(&format!(
        "const theme = document.getElementById('setting-theme'); theme.value = '{theme}'; theme.dispatchEvent(new Event('change', {{ bubbles: true }}))"
    ));
    browser.wait(&format!("document.documentElement.dataset.theme === '{theme}'"));
}

/// Everything is opened that can be, a number is wrong, and there are saves.
fn fill_editor(browser: &Browser) {
    browser.view("profile");
    browser.wait("document.querySelector('[data-handle]') && document.querySelector('.history li')");
    browser.run(
        "document.getElementById('save-as').click(); document.getElementById('new-name').value = 'mine'; \
         document.querySelector('dialog .primary').click()",
    );
    browser.wait("document.getElementById('profile-open').value === 'mine' && document.querySelector('.history button')");
    browser.run(
        "for (const fold of document.querySelectorAll('#profile details')) fold.open = true; \
         const it = document.querySelector('.number[data-field=\"button.0.press_n\"]'); it.focus(); it.value = '99'; \
         it.dispatchEvent(new Event('input', { bubbles: true })); it.blur()",
    );
}

/// Names of files in the view that is shown: of the kernel's controls, and keys of profiles. The profile's text and commands are asked for.
fn names_of_files(browser: &Browser) -> Value {
    browser.run(
        "const view = document.querySelector('main > section:not([hidden])'); const asked = 'textarea, code, .text-pane'; \
         const said = [...view.querySelectorAll('*')].filter((it) => it.checkVisibility() && !it.closest(asked)).flatMap((it) => [it.getAttribute('aria-label'), \
         it.tagName === 'INPUT' ? it.value : null, ...[...it.childNodes].filter((node) => node.nodeType === 3).map((node) => node.textContent)]); \
         return said.filter((text) => text !== null && /\\b([A-Z]{3}_\\w+|[a-z]+_[a-z_]+|-?f[xyz])\\b/.test(text))",
    )
}

/// What axe finds in the view that is shown.
fn findings(browser: &Browser, what: &str) -> Vec<String> {
    let found = browser.run("return axe.run().then((found) => [found.passes.length, found.violations])");
    assert!(found[0].as_u64() > Some(5), "{what}: nothing was checked");
    let violations = found[1].as_array().unwrap();
    violations
        .iter()
        .map(|it| format!("{what}: {} {} {}", it["id"], it["help"], it["nodes"][0]["html"]))
        .collect()
}

/// Looks at each of these views in all sizes, light and dark; keeps pictures where `TACTPAD_VIEWS` names a folder.
fn look(browser: &Browser, views: &[&str], state: &str) {
    let folder = std::env::var_os("TACTPAD_VIEWS").map(PathBuf::from);
    for [width, height] in SIZES {
        browser.show_in(width, height);
        for theme in ["light", "dark"] {
            choose(browser, theme);
            for view in views {
                browser.view(view);
                let what = format!("{view}-{state}-{width}-{theme}");
                if *view == "live" {
                    // Folded away in the one, there in the other.
                    browser.run(&format!(
                        "document.getElementById('measurements').open = {}; scrollTo(0, 0)",
                        theme == "dark"
                    ));
                }
                if *view == "doctor" {
                    // It knows the bridge that it is asked from, and each finding can be copied.
                    browser
                        .wait("document.getElementById('doctor').innerText.includes('a bridge is running')");
                    browser.wait("[...document.querySelectorAll('#doctor li')].every((it) => it.querySelector('button'))");
                }
                let beside = browser.run("return document.documentElement.scrollWidth - innerWidth");
                assert!(beside.as_f64() <= Some(0.0), "{what}: {beside} pixels are beside the window");
                assert_eq!(findings(browser, &what), Vec::<String>::new());
                if *view != "doctor" && *view != "reports" {
                    assert_eq!(names_of_files(browser), json!([]), "{what}");
                }
                if let Some(folder) = &folder {
                    fs::write(folder.join(format!("{what}.png")), browser.picture()).unwrap();
                }
            }
        }
    }
}

#[test]
fn axe_finds_nothing_on_any_view_in_any_size_light_and_dark_with_a_bridge_and_without() {
    let Some(axe) = axe() else { return };
    let mut shown = Shown::start("virtual", "super-mario");
    let Some(browser) = Browser::open(&shown.url) else { return };
    shown.wait_until_playing();
    browser.run(&axe);
    fill_editor(&browser);
    look(&browser, &VIEWS, "playing");
    shown.running.signal(Signal::KILL);
    shown.running.ends();
    browser.wait("document.getElementById('connection').textContent !== ''");
    look(&browser, &["live", "profile", "guides"], "ended");
}

/// What has the focus, as its id or what names it.
fn focus(browser: &Browser) -> String {
    let name = "const it = document.activeElement; return it.id || it.dataset.handle || it.dataset.field || it.getAttribute('href') || it.textContent";
    browser.run(name).as_str().unwrap_or_default().to_owned()
}

/// Goes on with Tab until this has the focus.
fn tab_to(browser: &Browser, wanted: &str) {
    let mut passed = Vec::new();
    for _ in 0..200 {
        if focus(browser) == wanted {
            return;
        }
        passed.push(focus(browser));
        browser.keys(&[], &[TAB]);
    }
    panic!("Tab does not lead to {wanted}: {passed:?}");
}

#[test]
fn a_profile_is_changed_tried_and_kept_by_keys_alone() {
    let finger = Finger::start();
    let shown = Shown::start(&finger.address(), "contra");
    let Some(browser) = Browser::open(&shown.url) else { return };
    shown.wait_until_playing();
    finger.pulse(15.0, 0.0, 1.8);
    tab_to(&browser, "#profile");
    browser.keys(&[], &[ENTER]);
    browser.wait("document.querySelector(\"[data-handle='button.0.press_n']\")");
    tab_to(&browser, "button.0.press_n");
    let value = || {
        browser
            .run("return document.activeElement.getAttribute('aria-valuenow')")
            .as_str()
            .unwrap()
            .parse::<f64>()
            .unwrap()
    };
    assert_eq!(value(), 2.0);
    for _ in 0..100 {
        if value() < 1.6 {
            break;
        }
        browser.keys(&[], &[LEFT]);
    }
    assert!(comes_true(|| value() < 1.6));
    let text = browser.run("return document.activeElement.getAttribute('aria-valuetext')");
    assert!(text.as_str().is_some_and(|text| text.contains('N')), "{text}");
    assert!(comes_true(|| shown.status()["held"].to_string().contains("BTN_SOUTH")), "{}", shown.status());
    browser.keys(&[], &[RIGHT]);
    browser.keys(&[CONTROL], &["s"]);
    assert!(comes_true(|| shown.profile("contra").exists()));
    browser.keys(&[SHIFT], &[TAB]);
    assert_ne!(focus(&browser), "button.0.press_n", "the focus is not caught");
}

#[test]
fn a_bridge_is_paused_and_goes_on_by_keys_alone() {
    let shown = Shown::start("virtual", "contra");
    let Some(browser) = Browser::open(&shown.url) else { return };
    shown.wait_until_playing();
    tab_to(&browser, "pause");
    browser.keys(&[], &[ENTER]);
    assert!(comes_true(|| shown.status()["state"] == "paused"));
    browser.wait("document.getElementById('state').textContent.includes('paused')");
    browser.keys(&[], &[" "]);
    assert!(comes_true(|| shown.status()["state"] == "playing"), "{}", shown.status());
}

#[test]
fn at_four_hundred_percent_nothing_is_beside_the_window_and_targets_are_large() {
    let shown = Shown::start("virtual", "contra");
    let Some(browser) = Browser::open(&shown.url) else { return };
    for view in VIEWS {
        browser.view(view);
        if view == "profile" {
            browser.wait("document.querySelector('[data-handle]')");
        }
        // A window of 1280 pixels at 400 % has 320; headless windows are not made smaller than 500.
        browser.run("document.documentElement.style.width = '320px'; document.body.style.width = '320px'");
        let beside = "return Math.max(document.documentElement.scrollWidth, document.body.scrollWidth) - Math.max(500, innerWidth)";
        assert!(browser.run(beside).as_f64().unwrap() <= 0.0, "{view}");
        browser.run("document.documentElement.style.width = ''; document.body.style.width = ''");
        let small = "return [...document.querySelectorAll('button, select, input, textarea, a, summary, [role=slider]')] \
                     .filter((it) => it.checkVisibility()).map((it) => [it.getBoundingClientRect(), it]) \
                     .filter(([box]) => box.width > 0 && (box.width < 24 || box.height < 24)) \
                     .filter(([, it]) => !it.closest('.skip')).map(([box, it]) => `${it.outerHTML.slice(0, 90)} ${box.width}x${box.height}`)";
        let small = browser.run(small);
        assert_eq!(small.as_array().map(Vec::len), Some(0), "{view}: {small}");
    }
}

#[test]
fn presses_are_told_to_screen_readers_at_most_once_a_second_and_can_be_switched_off() {
    let finger = Finger::start();
    let shown = Shown::start(&finger.address(), "contra");
    let Some(browser) = Browser::open(&shown.url) else { return };
    shown.wait_until_playing();
    browser.run(
        "window.told = []; new MutationObserver(() => { const text = document.getElementById('announcer').textContent; \
         if (text) window.told.push([performance.now(), text]); }).observe(document.getElementById('announcer'), { childList: true, characterData: true, subtree: true })",
    );
    let press = || {
        finger.press(0.0, 0.0, 3.0);
        assert!(comes_true(|| shown.status()["held"].to_string().contains("BTN_SOUTH")));
        finger.lift();
        assert!(comes_true(|| !shown.status()["held"].to_string().contains("BTN_SOUTH")));
    };
    (0..8).for_each(|_| press());
    browser.wait("window.told.length > 0");
    let told = browser.run("return window.told");
    let times: Vec<f64> = told.as_array().unwrap().iter().map(|it| it[0].as_f64().unwrap()).collect();
    assert!(times.windows(2).all(|pair| pair[1] - pair[0] > 950.0), "{told}");
    assert!(told.to_string().contains("A: jump accepted"), "{told}");
    browser.run("document.getElementById('settings').open = true; document.getElementById('setting-announce').click()");
    let before = browser.run("return window.told.length");
    (0..3).for_each(|_| press());
    browser.run("return new Promise((done) => setTimeout(done, 1500))");
    assert_eq!(browser.run("return window.told.length"), before, "{}", browser.run("return window.told"));
}
