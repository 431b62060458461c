//! Watches the file of the profile in play and the program in the foreground. It reads and parses on its own thread, so the bridge loses
//! no time.

use std::collections::BTreeMap;
use std::io;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

use rustix::event::{Timespec, poll};

use super::playing::Audience;
use super::profile_selection::{FileStamp, ProfileSelection};
use crate::cli::failure::Failure;
use crate::cli::playing::profile;
use crate::cli::printing::written::tell_in_passing;
use tactpad::bridge::foreground::{Foreground, WindowSystem};
use tactpad::bridge::profile_update::ProfileUpdate;
use tactpad::bridge::request::{Request, RequestSender};
use tactpad::pipeline::mapping::profile::Program;
use tactpad::pipeline::mapping::read::ReadProfile;
use tactpad::pipeline::mapping::read::check::OutputChoice;

/// It looks this often. A file is read once it was the same at two looks: who is writing it has ended.
const LOOK: Timespec = Timespec { tv_sec: 0, tv_nsec: 250_000_000 };

/// A desktop that does not answer is asked again after so many looks.
const LOOKS_WITHOUT_DESKTOP: u32 = 20;

/// Why a profile is played while none is for the program in front.
const NONE_IS_FOR_IT: &str = "none is for the program in front";

/// Starts to follow what `selection` says. The thread ends with the bridge. What does nothing on the pad is told to who reads it.
pub(super) fn start(
    selection: Arc<Mutex<ProfileSelection>>,
    output: OutputChoice,
    sender: RequestSender,
    audience: Audience,
) -> io::Result<()> {
    let mut follower = Follower::new(selection, output);
    thread::Builder::new().name("profiles".into()).spawn(move || {
        loop {
            for update in follower.look() {
                let warnings = follower.shear_warnings(&update);
                if audience == Audience::Stderr && !warnings.is_empty() {
                    tell_in_passing(warnings.trim_end());
                }
                if sender.send(Request::UpdateProfile(Box::new(update))).is_err() {
                    return;
                }
            }
            // Nothing wakes it: it lets time pass.
            let _ = poll(&mut [], Some(&LOOK));
        }
    })?;
    Ok(())
}

/// The profile that is to be played, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
struct ProfileChoice {
    name: String,
    stamp: Option<FileStamp>,
    /// Where it follows the program in front.
    reason: Option<String>,
}

/// The programs that a profile was for at the last look.
struct Candidate {
    stamp: Option<FileStamp>,
    is_read: bool,
    programs: Vec<Program>,
}

struct Follower {
    selection: Arc<Mutex<ProfileSelection>>,
    output: OutputChoice,
    /// The choice that was sent to the bridge last, or the one at the start.
    sent: ProfileChoice,
    /// Number of profile requests by people at that time.
    request_count: u64,
    /// A change that was seen at the last look.
    seen: Option<ProfileChoice>,
    candidates: BTreeMap<String, Candidate>,
    desktop: Result<WindowSystem, String>,
    looks_without_desktop: u32,
}

impl Follower {
    fn new(selection: Arc<Mutex<ProfileSelection>>, output: OutputChoice) -> Self {
        let begun = selection.lock().unwrap_or_else(PoisonError::into_inner).clone();
        Self {
            selection,
            output,
            sent: ProfileChoice { name: begun.name, stamp: begun.stamp, reason: None },
            request_count: begun.request_count,
            seen: None,
            candidates: BTreeMap::new(),
            desktop: Err(String::new()),
            looks_without_desktop: LOOKS_WITHOUT_DESKTOP,
        }
    }

    /// The updates to send now: errors of profiles that may be for a program, then the profile to be played.
    fn look(&mut self) -> Vec<ProfileUpdate> {
        let selection = self.selection.lock().unwrap_or_else(PoisonError::into_inner).clone();
        if selection.request_count != self.request_count {
            self.request_count = selection.request_count;
            self.sent =
                ProfileChoice { name: selection.name.clone(), stamp: selection.stamp.clone(), reason: None };
        }
        let mut updates = Vec::new();
        let choice = match &selection.fallback {
            Some(fallback) => {
                updates.extend(self.read_candidates().into_iter().map(|error| self.update(Err(error), None)));
                self.in_front(fallback)
            }
            None => ProfileChoice {
                name: selection.name.clone(),
                stamp: FileStamp::of(&selection.name),
                reason: None,
            },
        };
        updates.extend(self.changed(choice));
        updates
    }

    /// The update for a choice that differs from the last one and is stable.
    fn changed(&mut self, choice: ProfileChoice) -> Option<ProfileUpdate> {
        if choice == self.sent {
            self.seen = None;
            return None;
        }
        let is_at_rest = self.seen.replace(choice.clone()).as_ref() == Some(&choice);
        if !is_at_rest {
            return None;
        }
        let read = read(&choice.name, self.output);
        if FileStamp::of(&choice.name) != choice.stamp {
            // It was written meanwhile: what was read may be half of it.
            return None;
        }
        let mut selection = self.selection.lock().unwrap_or_else(PoisonError::into_inner);
        if selection.request_count == self.request_count && read.is_ok() {
            (selection.name, selection.stamp) = (choice.name.clone(), choice.stamp.clone());
        }
        drop(selection);
        let reason = Some(&choice.reason).filter(|reason| **reason != self.sent.reason).cloned().flatten();
        self.sent = choice;
        self.seen = None;
        Some(self.update(read, reason))
    }

    /// What of the profile of an update does nothing on the pad.
    fn shear_warnings(&self, update: &ProfileUpdate) -> String {
        let Ok(read) = &update.read else { return String::new() };
        let selection = self.selection.lock().unwrap_or_else(PoisonError::into_inner).clone();
        selection.shear_warnings(&self.sent.name, read)
    }

    fn update(&self, read: Result<ReadProfile, String>, reason: Option<String>) -> ProfileUpdate {
        ProfileUpdate { read, reason, request_count: self.request_count }
    }

    /// The profile for the program in the foreground.
    fn in_front(&mut self, fallback: &str) -> ProfileChoice {
        let chosen = |name: &str, reason: String| ProfileChoice {
            name: name.to_owned(),
            stamp: FileStamp::of(name),
            reason: Some(reason),
        };
        match self.front() {
            Err(why) => chosen(fallback, why),
            Ok(Foreground::OwnProgram) => {
                ProfileChoice { stamp: FileStamp::of(&self.sent.name), ..self.sent.clone() }
            }
            Ok(Foreground::Unknown) => chosen(fallback, NONE_IS_FOR_IT.into()),
            Ok(Foreground::Program { classes, executable }) => {
                let classes: Vec<&str> = classes.iter().map(String::as_str).collect();
                let is_for = |candidate: &Candidate| {
                    candidate.programs.iter().any(|program| program.is(&classes, executable.as_deref()))
                };
                match self.candidates.iter().find(|(_, candidate)| is_for(candidate)) {
                    Some((name, _)) => {
                        let called = classes.last().copied().or(executable.as_deref()).unwrap_or_default();
                        chosen(name, format!("for the program in front, {called}"))
                    }
                    None => chosen(fallback, NONE_IS_FOR_IT.into()),
                }
            }
        }
    }

    /// Asks the desktop. One that is not there, or does not answer any more, is looked for again after a while.
    fn front(&mut self) -> Result<Foreground, String> {
        self.looks_without_desktop += 1;
        if self.desktop.is_err() && self.looks_without_desktop > LOOKS_WITHOUT_DESKTOP {
            self.looks_without_desktop = 0;
            self.desktop = WindowSystem::open();
        }
        let front = self.desktop.as_mut().map_err(|why| why.clone()).and_then(WindowSystem::front);
        if let Err(why) = &front {
            self.desktop = Err(why.clone());
        }
        front
    }

    /// Reads for which programs profiles are, as far as they were changed. What is wrong with any that was.
    fn read_candidates(&mut self) -> Vec<String> {
        let names = profile::known();
        self.candidates.retain(|name, _| names.contains(name));
        let mut errors = Vec::new();
        for name in names {
            let stamp = FileStamp::of(&name);
            let known = self.candidates.entry(name.clone()).or_insert_with(|| Candidate {
                stamp: None,
                is_read: false,
                programs: Vec::new(),
            });
            if known.stamp != stamp {
                (known.stamp, known.is_read) = (stamp, false);
            } else if !known.is_read {
                known.is_read = true;
                match read(&name, self.output) {
                    Ok(read) => known.programs.clone_from(&read.profile().programs),
                    Err(error) => errors.push(error),
                }
            }
        }
        errors
    }
}

/// Reads a profile; what is wrong with it is for people. Its warnings were told when it was checked.
fn read(name: &str, output: OutputChoice) -> Result<ReadProfile, String> {
    profile::read_aside(name, output).map(|(read, _)| read).map_err(Failure::sentence)
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::*;

    /// A follower of a profile in `folder`, and its path.
    fn following(folder: &Path, text: &str) -> (Follower, String) {
        let path = folder.join("mine.toml").to_str().unwrap().to_owned();
        fs::write(&path, text).unwrap();
        let selection = Arc::new(Mutex::new(ProfileSelection::of(&path)));
        (Follower::new(selection, OutputChoice::AsWritten), path)
    }

    fn text(name: &str) -> String {
        format!("schema = 1\nname = \"{name}\"\noutput = \"gamepad\"\n[dpad]\n")
    }

    /// The names and errors that are offered at so many looks.
    fn updates(follower: &mut Follower, looks: usize) -> Vec<Result<String, String>> {
        let offers = (0..looks).flat_map(|_| follower.look()).collect::<Vec<_>>();
        offers.into_iter().map(|offer| offer.read.map(|read| read.profile().name.clone())).collect()
    }

    #[test]
    fn a_file_is_offered_once_it_is_at_rest_and_an_error_once() {
        let folder = tempfile::tempdir().unwrap();
        let (mut follower, path) = following(folder.path(), &text("One"));
        assert_eq!(updates(&mut follower, 3), []);
        // Half of it is there at this look, and all of it at the next.
        fs::write(&path, "schema = 1\nname = \"Tw").unwrap();
        assert_eq!(updates(&mut follower, 1), []);
        fs::write(&path, text("Two")).unwrap();
        assert_eq!(updates(&mut follower, 1), []);
        assert_eq!(updates(&mut follower, 3), [Ok("Two".into())]);
        fs::write(&path, "schema = 2").unwrap();
        let told = updates(&mut follower, 4);
        assert!(matches!(&told[..], [Err(error)] if error.contains("mine.toml:1:10")), "{told:?}");
        let aside = folder.path().join("aside");
        fs::write(&aside, text("Three")).unwrap();
        fs::rename(&aside, &path).unwrap();
        assert_eq!(updates(&mut follower, 3), [Ok("Three".into())]);
    }

    #[test]
    fn a_file_that_is_gone_is_an_error_and_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let (mut follower, path) = following(folder.path(), &text("One"));
        fs::remove_file(&path).unwrap();
        let told = updates(&mut follower, 3);
        assert!(matches!(&told[..], [Err(error)] if error.contains("mine.toml")), "{told:?}");
        fs::write(&path, text("One")).unwrap();
        assert_eq!(updates(&mut follower, 3), [Ok("One".into())]);
    }

    #[test]
    fn what_people_ask_for_meanwhile_stands_before_what_was_seen() {
        let folder = tempfile::tempdir().unwrap();
        let (mut follower, path) = following(folder.path(), &text("One"));
        fs::write(&path, text("Two")).unwrap();
        assert_eq!(updates(&mut follower, 1), []);
        let requested = follower.selection.lock().unwrap().requested(Some("contra"));
        *follower.selection.lock().unwrap() = requested;
        assert_eq!(updates(&mut follower, 3), []);
        assert_eq!(follower.selection.lock().unwrap().name, "contra");
    }
}
