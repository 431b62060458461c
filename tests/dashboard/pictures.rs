//! The pictures of the documentation: `tests/pictures/page` takes them.

use std::path::PathBuf;
use std::{env, fs};

use crate::browser::Browser;
use crate::running::comes_true;
use crate::shown::Shown;

/// A view, what of its window is taken, and the file.
const PICTURES: [(&str, [u32; 2], &str); 2] =
    [("live", [1280, 1010], "dashboard-live.png"), ("profile", [1280, 1010], "dashboard-profile.png")];

#[test]
fn each_view_is_taken_where_a_folder_is_named() {
    let Some(folder) = env::var_os("TACTPAD_PICTURES").map(PathBuf::from) else { return };
    let shown = Shown::start("virtual", "contra");
    let Some(browser) = Browser::open(&shown.url) else { return };
    shown.wait_until_playing();
    assert!(comes_true(|| shown.log().contains("BTN_EAST")), "{}", shown.log());
    for (view, [width, height], file) in PICTURES {
        browser.resize(width, height);
        browser.view(view);
        if view == "profile" {
            browser.wait("document.querySelector('[data-handle]')");
            browser.run("document.querySelector('[data-group=\"button.0\"] > summary').click()");
        }
        assert!(comes_true(|| shown.status()["contact"]["fz_n"].as_f64() > Some(1.0)), "{view}");
        browser.run("document.activeElement.blur()");
        fs::write(folder.join(file), browser.picture()).unwrap();
    }
}
