//! The host: the interface of the program that a bridge runs in.

use std::sync::Arc;
use std::sync::mpsc::SyncSender;

use crate::profile_update::ProfileUpdate;
use crate::request::{PendingRequest, Request, RequestSender};
use tactpad_core::pipeline::mapping::read::ReadProfile;

/// Which profile somebody asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ProfileRequest {
    /// The one in use, read again.
    Same,
    /// The one of this name.
    Named(String),
    /// The one that comes after the one in use. Only those are taken from which a press leads on, so that nobody who has no other
    /// input is left in one.
    Next,
}

/// Where a profile that was asked for is handed in once it is read.
#[derive(Debug)]
pub struct ProfileReply {
    pub(super) sender: Arc<RequestSender>,
    pub(super) reply_to: Option<SyncSender<String>>,
    pub(super) is_named: bool,
}

impl ProfileReply {
    /// Hands in the profile, or why it cannot be used, for people. The bridge goes over to it as soon as it can.
    pub fn hand_in(self, read: Result<ReadProfile, String>) {
        let request = Request::Play(Box::new(read), self.is_named);
        // A bridge that has ended plays nothing.
        let _ = self.sender.enqueue(PendingRequest { request, reply_to: self.reply_to });
    }
}

/// The program that a bridge runs in. It is called between two turns of the loop, so nothing here may wait.
pub trait Host {
    /// Has a profile read, on a thread of its own, and handed in to `reply`.
    fn read_profile(&mut self, request: ProfileRequest, reply: ProfileReply);

    /// Whether a profile that is offered is still wanted: people may have asked for another one meanwhile.
    fn wants(&self, _offer: &ProfileUpdate) -> bool {
        true
    }

    /// The address of the page that shows the bridge, if it has one.
    fn page(&self) -> Option<String> {
        None
    }

    /// Tells people what the bridge is doing, when that changed.
    fn tell(&mut self, line: &str);
}
