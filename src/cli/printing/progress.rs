//! One line on the terminal that says what long work is at, how far it has come, and how long it has gone on.

use std::fmt;
use std::io;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::terminal;

/// Something moves this often, however long a step takes.
const TICK: Duration = Duration::from_millis(100);

const WITHOUT_END: &str = "{spinner} {elapsed_precise} {wide_msg}";
const WITH_END: &str = "{spinner} {elapsed_precise} [{bar:24}] {percent:>3} %  {wide_msg}";

/// The line; it is wiped when this is dropped. Where standard error is no terminal, or a dumb one, nothing is written.
#[derive(Debug)]
pub(crate) struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// A line that says what is begun.
    pub(crate) fn begin(what: impl fmt::Display) -> Self {
        let is_seen = terminal::moves_cursor(&io::stderr());
        let target = if is_seen { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(None, target).with_style(style(WITHOUT_END));
        bar.set_message(what.to_string());
        if is_seen {
            bar.enable_steady_tick(TICK);
        }
        Self { bar }
    }

    /// Says what is done now instead of what was done before.
    pub(crate) fn step(&self, what: impl fmt::Display) {
        if self.bar.length().is_some() {
            self.bar.unset_length();
            self.bar.set_style(style(WITHOUT_END));
        }
        self.bar.set_message(what.to_string());
    }

    /// The same for work of which `done` parts of at most `of` are done.
    pub(crate) fn part(&self, done: usize, of: usize, what: impl fmt::Display) {
        if self.bar.length().is_none() {
            self.bar.set_style(style(WITH_END));
        }
        self.bar.set_length(of as u64);
        self.bar.set_position(done as u64);
        self.bar.set_message(what.to_string());
    }
}

/// Both templates are sound, as the tests see; a line of another look would be no reason to stop.
fn style(template: &str) -> ProgressStyle {
    let plain = ProgressStyle::default_spinner().template(template);
    plain.unwrap_or_else(|_| ProgressStyle::default_spinner()).progress_chars("#> ")
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn templates_are_sound() {
        for template in [WITHOUT_END, WITH_END] {
            assert!(ProgressStyle::default_spinner().template(template).is_ok(), "{template}");
        }
    }
}
