//! One line on the terminal that says how far long work has come.

use std::io::{self, IsTerminal, Write};

/// The line; it is wiped when this is dropped. Where standard error is no terminal, nothing is written.
#[derive(Debug)]
pub(super) struct Progress {
    to: Option<io::Stderr>,
}

impl Progress {
    /// A line without words yet.
    pub(super) fn begin() -> Self {
        Self { to: Some(io::stderr()).filter(IsTerminal::is_terminal) }
    }

    /// Says what is done now instead of what was done before.
    pub(super) fn step(&mut self, what: impl std::fmt::Display) {
        self.write(format_args!("\r\x1b[K{what} …"));
    }

    /// What does not get out must not stop the work.
    fn write(&mut self, text: std::fmt::Arguments<'_>) {
        if let Some(to) = &mut self.to {
            let _ = to.write_fmt(text).and_then(|()| to.flush());
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.write(format_args!("\r\x1b[K"));
    }
}
