//! Reads the profiles that people ask for, on a thread of its own: a file may wait for a disk, a network or a pipe.

use std::io;
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

use super::profile_selection::ProfileSelection;
use crate::cli::failure::Failure;
use crate::cli::playing::profile;
use crate::cli::printing::written::tell_in_passing;
use tactpad::bridge::host::{ProfileReply, ProfileRequest};
use tactpad::pipeline::mapping::read::ReadProfile;
use tactpad::pipeline::mapping::read::check::OutputChoice;

/// Where requests are left. The thread ends when it is dropped.
pub(super) struct ProfileReader(Sender<(ProfileRequest, ProfileReply)>);

impl ProfileReader {
    /// Starts the thread. What is wrong with a profile that is played all the same is told if somebody reads it.
    pub(super) fn start(
        selection: Arc<Mutex<ProfileSelection>>,
        output: OutputChoice,
        is_read: bool,
    ) -> io::Result<Self> {
        let (requests, asked) = channel::<(ProfileRequest, ProfileReply)>();
        thread::Builder::new().name("profile reader".into()).spawn(move || {
            for (request, reply) in asked {
                let read = read(&selection, &request, output).map(|(read, warnings)| {
                    if is_read && !warnings.is_empty() {
                        tell_in_passing(warnings.trim_end());
                    }
                    read
                });
                reply.hand_in(read);
            }
        })?;
        Ok(Self(requests))
    }

    /// Has a profile read.
    pub(super) fn read(&self, request: ProfileRequest, reply: ProfileReply) {
        // The thread lives as long as this.
        let _ = self.0.send((request, reply));
    }
}

/// The profile that is asked for, and what is wrong with it. One that can be used is selected.
fn read(
    selection: &Mutex<ProfileSelection>,
    request: &ProfileRequest,
    output: OutputChoice,
) -> Result<(ReadProfile, String), String> {
    let lock = || selection.lock().unwrap_or_else(PoisonError::into_inner);
    // Nobody waits for the selection while a file is read.
    let before = lock().clone();
    let (requested, read) = match request {
        ProfileRequest::Next => {
            let (name, read) = profile::next(&before.name, output).ok_or(
                "no other profile has a press that leads on, so nobody would come back from it by the pad: `tactpad ctl profile NAME` goes to any of \
                 `tactpad profile list`; to go on by a press, `tactpad profile new NAME` and give a button of it out = { bridge = \"next-profile\" }",
            )?;
            (before.requested(Some(&name)), (read, String::new()))
        }
        ProfileRequest::Same | ProfileRequest::Named(_) => {
            let name = if let ProfileRequest::Named(name) = request { Some(&**name) } else { None };
            let requested = before.requested(name);
            let read = profile::read_aside(&requested.name, output).map_err(Failure::sentence)?;
            (requested, read)
        }
    };
    let (read, warnings) = read;
    let warnings = warnings + &requested.shear_warnings(&requested.name, &read);
    *lock() = requested;
    Ok((read, warnings))
}
