//! Opens a page with the program that the desktop has for it.

use std::io;
use std::process::{Child, Command, Stdio};

/// The desktop's program that opens addresses.
const OPENER: &str = "xdg-open";

/// A page that is being opened.
#[derive(Debug)]
pub struct Opening {
    opener: Child,
    url: String,
}

/// Begins to open the page at `url`. No shell reads it.
///
/// # Errors
/// The desktop's program cannot be started; the text is for people.
pub fn open(url: &str) -> Result<Opening, String> {
    let mut command = Command::new(OPENER);
    command.arg(url).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    match command.spawn() {
        Ok(opener) => Ok(Opening { opener, url: url.to_owned() }),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            Err(format!("{OPENER} is missing (package xdg-utils): open {url} in a browser"))
        }
        Err(error) => Err(format!("{OPENER} cannot be started ({error}): open {url} in a browser")),
    }
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
            false => Err(format!("{OPENER} found no browser: open {} in one", self.url)),
        }
    }
}
