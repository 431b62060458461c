//! What can be asked of a running bridge, and by whom.

use std::io::{self, Write};
use std::os::unix::net::UnixStream;
use std::sync::mpsc::{Receiver, Sender, SyncSender, sync_channel};
use std::time::Duration;

use crate::offer::Offer;
use tactpad_core::pad::weight::Weight;
use tactpad_core::pipeline::mapping::read::ReadProfile;

/// The bridge answers in well under a millisecond; one that does not has ended or is stopped.
pub(super) const ANSWER_LIMIT: Duration = Duration::from_secs(2);

/// What is asked for.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// Release everything and end.
    End,
    /// Release everything and stop the process, until it is continued.
    Stop,
    /// Release everything (the panic button) and go on.
    ReleaseAll,
    /// Release everything and ignore contacts.
    Pause,
    /// Go on.
    Resume,
    /// Pause, or go on.
    TogglePause,
    /// Measure the zero again.
    Retare,
    /// Weigh a known weight: the answer has the weighing's number, by which the status tells how far it is.
    Weigh(Weight),
    /// Go over to another profile; `None` reads the one in use again.
    Profile(Option<String>),
    /// Go over to the next profile that a press can leave again.
    NextProfile,
    /// Take a profile that was read away from the loop, if it is still wanted.
    Offer(Box<Offer>),
    /// Play a profile that is not kept yet, until another one is asked for or offered, or this one is read again.
    Preview(Box<ReadProfile>),
    /// Tell what the bridge is doing.
    Status,
    /// Tell the address of the page that shows it.
    Page,
}

impl Request {
    /// The request that a line of the control socket states.
    pub(super) fn parse(line: &str) -> Option<Self> {
        match line.trim_end_matches(['\r', '\n']).split_once(' ') {
            Some(("profile", name)) if !name.is_empty() => Some(Self::Profile(Some(name.into()))),
            Some(("weigh", grams)) => Some(Self::Weigh(Weight::of_g(grams.trim().parse().ok()?).ok()?)),
            Some(_) => None,
            None => match line.trim_end() {
                "status" => Some(Self::Status),
                "dashboard" => Some(Self::Page),
                "pause" => Some(Self::Pause),
                "resume" => Some(Self::Resume),
                "panic" => Some(Self::ReleaseAll),
                "tare" => Some(Self::Retare),
                "next-profile" => Some(Self::NextProfile),
                "reload" => Some(Self::Profile(None)),
                "quit" => Some(Self::End),
                _ => None,
            },
        }
    }
}

/// A request and whoever waits for its answer.
#[derive(Debug)]
pub struct Asked {
    /// What is asked for.
    pub request: Request,
    pub(super) answer: Option<SyncSender<String>>,
}

impl Asked {
    /// A request that gets no answer.
    pub(super) const fn unanswered(request: Request) -> Self {
        Self { request, answer: None }
    }

    /// Answers with one line of JSON. A signal gets no answer.
    pub fn answer(&self, line: String) {
        if let Some(answer) = &self.answer {
            // A client that went away needs no answer.
            let _ = answer.try_send(line);
        }
    }
}

/// Asks the bridge from any thread of its program.
#[derive(Debug)]
pub struct Asker {
    pub(super) ask: Sender<Asked>,
    pub(super) wake: UnixStream,
}

impl Asker {
    /// Asks, and does not wait for an answer.
    ///
    /// # Errors
    /// The bridge has ended.
    pub fn ask(&self, request: Request) -> io::Result<()> {
        self.send(Asked::unanswered(request))
    }

    /// Asks, and waits for the answer: a line of JSON.
    ///
    /// # Errors
    /// The bridge has ended, or does not answer: then the kind is `TimedOut`.
    pub fn answer(&self, request: Request) -> io::Result<String> {
        self.question(request)?.recv_timeout(ANSWER_LIMIT).map_err(|_| io::ErrorKind::TimedOut.into())
    }

    /// Asks, and does not wait: the answer, a line of JSON, comes through what is returned.
    ///
    /// # Errors
    /// The bridge has ended.
    pub fn question(&self, request: Request) -> io::Result<Receiver<String>> {
        let (answer, answered) = sync_channel(1);
        self.send(Asked { request, answer: Some(answer) })?;
        Ok(answered)
    }

    pub(super) fn send(&self, asked: Asked) -> io::Result<()> {
        self.ask.send(asked).map_err(|_| io::Error::from(io::ErrorKind::BrokenPipe))?;
        (&self.wake).write_all(&[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_state_requests() {
        for (line, request) in [
            ("status\n", Some(Request::Status)),
            ("panic\r\n", Some(Request::ReleaseAll)),
            ("dashboard\n", Some(Request::Page)),
            ("next-profile\n", Some(Request::NextProfile)),
            ("reload\n", Some(Request::Profile(None))),
            ("profile my game.toml\n", Some(Request::Profile(Some("my game.toml".into())))),
            ("weigh 200.5\n", Some(Request::Weigh(Weight::of_g(200.5).unwrap()))),
            ("weigh 2\n", None),
            ("weigh much\n", None),
            ("weigh\n", None),
            ("profile \n", None),
            ("profile\n", None),
            ("status now\n", None),
            ("", None),
        ] {
            assert_eq!(Request::parse(line), request, "{line:?}");
        }
    }
}
