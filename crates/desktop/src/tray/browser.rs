//! Opens a page with the program that the desktop has for it.

use std::env;
use std::io;
use std::process::{Child, Command, Stdio};

/// The desktop's program that opens addresses.
const OPENER: &str = "xdg-open";

/// Has a program started by the user's manager. What a service starts itself has the service's limits, under which no browser runs.
const BY_MANAGER: [&str; 5] = ["systemd-run", "--user", "--quiet", "--collect", "--wait"];

/// A page that is being opened.
#[derive(Debug)]
pub struct Opening {
    opener: Child,
    url: String,
}

/// Begins to open the page at `url`. No shell reads it, and its token is in no program's arguments.
///
/// # Errors
/// The desktop's program cannot be started; the text is for people.
pub fn open(url: &str) -> Result<Opening, String> {
    // The manager's sign that this is a service.
    let is_service = env::var_os("INVOCATION_ID").is_some();
    let spawned = match start(&words(url, is_service)) {
        Err(error) if is_service && error.kind() == io::ErrorKind::NotFound => start(&words(url, false)),
        spawned => spawned,
    };
    match spawned {
        Ok(opener) => Ok(Opening { opener, url: url.to_owned() }),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            Err(format!("{OPENER} is missing (package xdg-utils): open {url} in a browser"))
        }
        Err(error) => Err(format!("{OPENER} cannot be started ({error}): open {url} in a browser")),
    }
}

/// The program and its arguments.
fn words(url: &str, is_service: bool) -> Vec<String> {
    let before: &[&str] = if is_service { &BY_MANAGER } else { &[] };
    before.iter().copied().chain([OPENER]).map(str::to_owned).chain([without_token(url)]).collect()
}

fn start(words: &[String]) -> io::Result<Child> {
    let Some((program, arguments)) = words.split_first() else { return Err(io::ErrorKind::NotFound.into()) };
    let mut command = Command::new(program);
    command.args(arguments).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn()
}

/// The address that leads this user's programs to the page at `url`; another address is as it was.
fn without_token(url: &str) -> String {
    let Some((server, rest)) = url.split_once("/?token=") else { return url.to_owned() };
    let part = rest.find('#').and_then(|at| rest.get(at..)).unwrap_or_default();
    format!("{server}/open{part}")
}

impl Opening {
    /// The outcome, once it is known. Does not wait.
    pub fn outcome(&mut self) -> Option<Result<(), String>> {
        match self.opener.try_wait() {
            Ok(None) => None,
            Ok(Some(status)) => Some(self.judged(status.success())),
            Err(_) => Some(self.judged(false)),
        }
    }

    /// The outcome. Waits until it is known.
    ///
    /// # Errors
    /// The page was not opened; the text is for people.
    pub fn wait(mut self) -> Result<(), String> {
        let is_open = self.opener.wait().is_ok_and(|status| status.success());
        self.judged(is_open)
    }

    fn judged(&self, is_open: bool) -> Result<(), String> {
        match is_open {
            true => Ok(()),
            false => Err(format!("{OPENER} opened no browser: open {} in one", self.url)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_service_has_the_browser_started_by_the_manager() {
        let url = "http://127.0.0.1:8080/?token=abc";
        assert_eq!(words(url, false), ["xdg-open", "http://127.0.0.1:8080/open"]);
        let by_manager = words(url, true);
        assert_eq!((by_manager[0].as_str(), &by_manager[5..]), ("systemd-run", &words(url, false)[..]));
    }

    #[test]
    fn no_token_is_in_the_arguments() {
        for (url, opened) in [
            ("http://127.0.0.1:8080/?token=abc", "http://127.0.0.1:8080/open"),
            ("http://127.0.0.1:8080/?token=abc#profile", "http://127.0.0.1:8080/open#profile"),
            ("http://127.0.0.1:8080/", "http://127.0.0.1:8080/"),
        ] {
            assert_eq!(without_token(url), opened);
        }
    }
}
