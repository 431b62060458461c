//! The screen of a session: a few lines that are written over on a terminal, else a line when something changes.

use std::io::{self, Write};
use std::sync::mpsc::{Receiver, Sender};

use super::words::{instruction, progress};
use crate::cli::playing::live::playing::TerminalHost;
use crate::cli::playing::live::screen::{Picture, Size};
use crate::cli::printing::terminal;
use crate::cli::printing::written::say;
use tactpad::bridge::host::{Host, ProfileReply, ProfileRequest};
use tactpad::bridge::profile_update::ProfileUpdate;
use tactpad::lab::play::guide::Guide;
use tactpad::lab::play::words::wrong;

/// Hands on what the bridge tells of the pad, so that it stands among the session's lines.
pub(crate) struct SessionHost {
    terminal: TerminalHost,
    tell: Sender<String>,
}

impl SessionHost {
    pub(crate) const fn new(terminal: TerminalHost, tell: Sender<String>) -> Self {
        Self { terminal, tell }
    }
}

impl Host for SessionHost {
    fn read_profile(&mut self, request: ProfileRequest, reply: ProfileReply) {
        self.terminal.read_profile(request, reply);
    }

    fn wants(&self, update: &ProfileUpdate) -> bool {
        self.terminal.wants(update)
    }

    fn tell(&mut self, line: &str) {
        // A session that has ended hears nothing more.
        let _ = self.tell.send(line.into());
    }
}

/// The lines.
pub(super) struct SessionScreen {
    is_drawn: bool,
    last: Option<Picture>,
    /// The last message where nothing is drawn: the instruction, and whether something was wrong.
    said: Option<(String, bool)>,
    /// Messages of the bridge, and the last one.
    from_bridge: Receiver<String>,
    of_pad: String,
}

impl SessionScreen {
    pub(super) fn new(from_bridge: Receiver<String>) -> Self {
        let is_drawn = terminal::moves_cursor(&io::stderr());
        Self { is_drawn, last: None, said: None, from_bridge, of_pad: String::new() }
    }

    /// Says where the guide is now.
    pub(super) fn show(&mut self, guide: &Guide) {
        for line in self.from_bridge.try_iter() {
            if !self.is_drawn {
                say(&line);
            }
            self.of_pad = line;
        }
        let (step, weight_g) = (guide.step(), guide.weight_g());
        let what = instruction(step, weight_g);
        let wrong = wrong(step, weight_g);
        if self.is_drawn {
            self.draw(&[what, wrong.unwrap_or_else(|| progress(step)), self.of_pad.clone()]);
        } else {
            self.say(what, wrong);
        }
    }

    /// A last look is left as it is.
    pub(super) fn end(&mut self) {
        self.last = None;
    }

    fn draw(&mut self, lines: &[String]) {
        let picture = Picture::of(lines, Size::of(&io::stderr()));
        let text = picture.over(self.last.as_ref());
        // Where nobody reads, the session goes on.
        let _ = io::stderr().lock().write_all(text.as_bytes());
        self.last = Some(picture);
    }

    /// Each instruction is said once, and what is wrong whenever it begins to be.
    fn say(&mut self, what: String, wrong: Option<String>) {
        let (is_known, was_wrong) = match &self.said {
            Some((said, was_wrong)) if *said == what => (true, *was_wrong),
            _ => (false, false),
        };
        if !is_known {
            say(&what);
        }
        if let Some(wrong) = wrong.as_ref().filter(|_| !was_wrong) {
            say(wrong);
        }
        self.said = Some((what, wrong.is_some()));
    }
}
