//! Requests to a running bridge, and the handle that sends them from other threads.

use std::io::{self, Write};
use std::os::unix::net::UnixStream;
use std::sync::mpsc::{Receiver, Sender, SyncSender, sync_channel};
use std::time::Duration;

use crate::profile_update::ProfileUpdate;
use tactpad_core::pad::weight::Weight;
use tactpad_core::pipeline::mapping::read::ReadProfile;

/// The bridge answers in well under a millisecond; one that does not has ended or is stopped.
pub(super) const ANSWER_LIMIT: Duration = Duration::from_secs(2);

/// A request to a running bridge.
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
    /// Play a profile that was asked for and is read by now, or say why it cannot be used; and whether it was asked for by its name.
    Play(Box<Result<ReadProfile, String>>, bool),
    /// Play a profile that was read on another thread, if nobody has asked for another one meanwhile.
    UpdateProfile(Box<ProfileUpdate>),
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

/// A request in the queue, and the channel for its reply.
#[derive(Debug)]
pub struct PendingRequest {
    /// The request.
    pub request: Request,
    pub(super) reply_to: Option<SyncSender<String>>,
}

impl PendingRequest {
    /// A request without a reply.
    pub(super) const fn unanswered(request: Request) -> Self {
        Self { request, reply_to: None }
    }

    /// Sends the reply: one line of JSON. A signal waits for none.
    pub fn reply(&self, line: String) {
        if let Some(reply_to) = &self.reply_to {
            // A client that went away needs no answer.
            let _ = reply_to.try_send(line);
        }
    }
}

/// Handle that sends requests to the bridge from any thread of its program.
#[derive(Debug)]
pub struct RequestSender {
    pub(super) queue: Sender<PendingRequest>,
    pub(super) wake: UnixStream,
}

impl RequestSender {
    /// Sends a request without waiting for a reply.
    ///
    /// # Errors
    /// The bridge has ended.
    pub fn send(&self, request: Request) -> io::Result<()> {
        self.enqueue(PendingRequest::unanswered(request))
    }

    /// Sends a request and waits for the reply: one line of JSON. Blocks for at most 2 s.
    ///
    /// # Errors
    /// The bridge has ended, or does not answer: then the kind is `TimedOut`.
    pub fn send_and_wait(&self, request: Request) -> io::Result<String> {
        self.send_for_reply(request)?.recv_timeout(ANSWER_LIMIT).map_err(|_| io::ErrorKind::TimedOut.into())
    }

    /// Sends a request and returns the channel on which the reply, one line of JSON, will arrive.
    ///
    /// # Errors
    /// The bridge has ended.
    pub fn send_for_reply(&self, request: Request) -> io::Result<Receiver<String>> {
        let (reply_to, reply) = sync_channel(1);
        self.enqueue(PendingRequest { request, reply_to: Some(reply_to) })?;
        Ok(reply)
    }

    pub(super) fn enqueue(&self, pending: PendingRequest) -> io::Result<()> {
        self.queue.send(pending).map_err(|_| io::Error::from(io::ErrorKind::BrokenPipe))?;
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
