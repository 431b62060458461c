//! `tactpad` without a verb, on a desktop: plays with the tray, or opens the page of the bridge that runs already.

use std::env;
use std::io;

use serde_json::Value;

use super::{ctl, runtime};
use crate::cli::failure::Failure;
use tactpad::bridge::control::ask;
use tactpad::tray::browser;

/// Whether there is a desktop to play on.
pub(crate) fn is_on_desktop() -> bool {
    let is_set = |name| env::var_os(name).is_some_and(|value| !value.is_empty());
    is_set("DISPLAY") || is_set("WAYLAND_DISPLAY")
}

/// The command line that is meant; `None` if the running bridge's page was opened instead.
pub(crate) fn command_line() -> Result<Option<Vec<String>>, Failure> {
    use io::ErrorKind::{ConnectionRefused, NotFound};
    let path = runtime::socket_path(None)?;
    match ask(&path, "dashboard") {
        Ok(answer) => open_page(&answer).map(|()| None),
        Err(error) if matches!(error.kind(), NotFound | ConnectionRefused) => {
            let shown: &[&str] =
                if cfg!(feature = "dashboard") { &["--tray", "--dashboard"] } else { &["--tray"] };
            let words = ["tactpad", "run"].into_iter().chain(shown.iter().copied());
            Ok(Some(words.map(str::to_owned).collect()))
        }
        Err(error) => Err(Failure::Failed(ctl::answer::no_answer(&path, &error))),
    }
}

/// Opens the page that the running bridge names.
fn open_page(answer: &str) -> Result<(), Failure> {
    let answer: Value = serde_json::from_str(answer).unwrap_or_default();
    let Some(page) = answer.get("url").and_then(Value::as_str) else {
        return Err(Failure::Failed(
            "a bridge runs already, and it has no page: ask it with `tactpad ctl`".into(),
        ));
    };
    browser::open(page).and_then(browser::Opening::wait).map_err(Failure::Failed)
}
