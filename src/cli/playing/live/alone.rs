//! `tactpad` without a verb, on a desktop: plays with the tray, or opens the page of the bridge that runs already.

use std::env;
use std::io;

use serde_json::Value;

use super::{ctl, last_profile, profile_selection, runtime};
use crate::cli::failure::Failure;
use crate::cli::playing::profile;
use crate::cli::printing::written::say;
use tactpad::bridge::control::ask;
use tactpad::pipeline::mapping::read::check::OutputChoice;
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
            let profile = format!("--profile={}", last_profile());
            let words = ["tactpad", "run", &profile].into_iter().chain(shown.iter().copied());
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

/// The profile that was played last, if it can still be used.
fn last_profile() -> String {
    let Some(kept) = last_profile::kept() else { return profile_selection::FALLBACK.to_owned() };
    if profile::read_aside(profile_selection::first(&kept), OutputChoice::AsWritten).is_ok() {
        return kept;
    }
    say(format_args!(
        "the profile that was played last, {kept}, cannot be used any more: playing {}",
        profile_selection::FALLBACK
    ));
    profile_selection::FALLBACK.to_owned()
}
