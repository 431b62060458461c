//! Abilities of the terminal at the end of a stream.

use std::env;
use std::ffi::OsStr;
use std::io::IsTerminal;

/// Whether `stream` is a terminal on which the cursor can be moved. Files, pipes and dumb terminals get plain lines.
pub(crate) fn moves_cursor(stream: &impl IsTerminal) -> bool {
    stream.is_terminal() && is_capable(env::var_os("TERM").as_deref())
}

/// Whether a terminal of this name knows any escape sequence.
fn is_capable(term: Option<&OsStr>) -> bool {
    term.is_some_and(|term| !term.is_empty() && term != "dumb")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dumb_terminal_and_one_without_a_name_move_no_cursor() {
        let capable = |term: Option<&str>| is_capable(term.map(OsStr::new));
        assert_eq!([None, Some(""), Some("dumb")].map(capable), [false; 3]);
        assert_eq!([Some("xterm"), Some("linux"), Some("tmux-256color")].map(capable), [true; 3]);
    }
}
