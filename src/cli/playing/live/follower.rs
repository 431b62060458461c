//! Follows the file of the profile that is played, and the program in front, on a thread of its own: what it reads and parses takes no
//! time from the bridge.

use std::collections::BTreeMap;
use std::io;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

use rustix::event::{Timespec, poll};

use super::wish::{Stamp, Wish};
use crate::cli::failure::Failure;
use crate::cli::playing::profile;
use tactpad::bridge::front::{Desktop, Front};
use tactpad::bridge::offer::Offer;
use tactpad::bridge::request::{Asker, Request};
use tactpad::pipeline::mapping::profile::Program;
use tactpad::pipeline::mapping::read::ReadProfile;
use tactpad::pipeline::mapping::read::check::OutputChoice;

/// It looks this often. A file is read once it was the same at two looks: who is writing it has ended.
const LOOK: Timespec = Timespec { tv_sec: 0, tv_nsec: 250_000_000 };

/// A desktop that does not answer is asked again after so many looks.
const LOOKS_WITHOUT_DESKTOP: u32 = 20;

/// Why a profile is played while none is for the program in front.
const NONE_IS_FOR_IT: &str = "none is for the program in front";

/// Starts to follow what `wish` says. The thread ends with the bridge.
pub(super) fn start(wish: Arc<Mutex<Wish>>, output: OutputChoice, asker: Asker) -> io::Result<()> {
    let mut follower = Follower::new(wish, output);
    thread::Builder::new().name("profiles".into()).spawn(move || {
        loop {
            for offer in follower.look() {
                if asker.ask(Request::Offer(Box::new(offer))).is_err() {
                    return;
                }
            }
            // Nothing wakes it: it lets time pass.
            let _ = poll(&mut [], Some(&LOOK));
        }
    })?;
    Ok(())
}

/// What is to be played, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Choice {
    name: String,
    stamp: Option<Stamp>,
    /// Where it follows the program in front.
    reason: Option<String>,
}

/// What a profile of one's own was for at the last look.
struct Candidate {
    stamp: Option<Stamp>,
    is_read: bool,
    programs: Vec<Program>,
}

struct Follower {
    wish: Arc<Mutex<Wish>>,
    output: OutputChoice,
    /// What was offered last, or was there at the start.
    offered: Choice,
    /// How often people had asked then.
    asked: u64,
    /// A change that was seen at the last look.
    seen: Option<Choice>,
    candidates: BTreeMap<String, Candidate>,
    desktop: Result<Desktop, String>,
    looks_without_desktop: u32,
}

impl Follower {
    fn new(wish: Arc<Mutex<Wish>>, output: OutputChoice) -> Self {
        let begun = wish.lock().unwrap_or_else(PoisonError::into_inner).clone();
        Self {
            wish,
            output,
            offered: Choice { name: begun.name, stamp: begun.stamp, reason: None },
            asked: begun.asked,
            seen: None,
            candidates: BTreeMap::new(),
            desktop: Err(String::new()),
            looks_without_desktop: LOOKS_WITHOUT_DESKTOP,
        }
    }

    /// What there is to offer now: errors of profiles that may be for a program, then the profile to be played.
    fn look(&mut self) -> Vec<Offer> {
        let wish = self.wish.lock().unwrap_or_else(PoisonError::into_inner).clone();
        if wish.asked != self.asked {
            self.asked = wish.asked;
            self.offered = Choice { name: wish.name.clone(), stamp: wish.stamp.clone(), reason: None };
        }
        let mut offers = Vec::new();
        let choice = match &wish.fallback {
            Some(fallback) => {
                offers.extend(self.read_candidates().into_iter().map(|error| self.offer(Err(error), None)));
                self.in_front(fallback)
            }
            None => Choice { name: wish.name.clone(), stamp: Stamp::of(&wish.name), reason: None },
        };
        offers.extend(self.changed(choice));
        offers
    }

    /// The choice as an offer, if it is another one than before and has come to rest.
    fn changed(&mut self, choice: Choice) -> Option<Offer> {
        if choice == self.offered {
            self.seen = None;
            return None;
        }
        let is_at_rest = self.seen.replace(choice.clone()).as_ref() == Some(&choice);
        if !is_at_rest {
            return None;
        }
        let read = read(&choice.name, self.output);
        if Stamp::of(&choice.name) != choice.stamp {
            // It was written meanwhile: what was read may be half of it.
            return None;
        }
        let mut wish = self.wish.lock().unwrap_or_else(PoisonError::into_inner);
        if wish.asked == self.asked && read.is_ok() {
            (wish.name, wish.stamp) = (choice.name.clone(), choice.stamp.clone());
        }
        drop(wish);
        let reason = Some(&choice.reason).filter(|reason| **reason != self.offered.reason).cloned().flatten();
        self.offered = choice;
        self.seen = None;
        Some(self.offer(read, reason))
    }

    fn offer(&self, read: Result<ReadProfile, String>, reason: Option<String>) -> Offer {
        Offer { read, reason, asked: self.asked }
    }

    /// What is to be played with the program that is in front.
    fn in_front(&mut self, fallback: &str) -> Choice {
        let chosen = |name: &str, reason: String| Choice {
            name: name.to_owned(),
            stamp: Stamp::of(name),
            reason: Some(reason),
        };
        match self.front() {
            Err(why) => chosen(fallback, why),
            Ok(Front::Ourselves) => Choice { stamp: Stamp::of(&self.offered.name), ..self.offered.clone() },
            Ok(Front::Nobody) => chosen(fallback, NONE_IS_FOR_IT.into()),
            Ok(Front::Program { classes, executable }) => {
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
    fn front(&mut self) -> Result<Front, String> {
        self.looks_without_desktop += 1;
        if self.desktop.is_err() && self.looks_without_desktop > LOOKS_WITHOUT_DESKTOP {
            self.looks_without_desktop = 0;
            self.desktop = Desktop::open();
        }
        let front = self.desktop.as_ref().map_err(String::clone).and_then(Desktop::front);
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
            let stamp = Stamp::of(&name);
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
        let wish = Arc::new(Mutex::new(Wish::of(&path)));
        (Follower::new(wish, OutputChoice::AsWritten), path)
    }

    fn text(name: &str) -> String {
        format!("schema = 1\nname = \"{name}\"\noutput = \"gamepad\"\n[dpad]\n")
    }

    /// The names and errors that are offered at so many looks.
    fn offered(follower: &mut Follower, looks: usize) -> Vec<Result<String, String>> {
        let offers = (0..looks).flat_map(|_| follower.look()).collect::<Vec<_>>();
        offers.into_iter().map(|offer| offer.read.map(|read| read.profile().name.clone())).collect()
    }

    #[test]
    fn a_file_is_offered_once_it_is_at_rest_and_an_error_once() {
        let folder = tempfile::tempdir().unwrap();
        let (mut follower, path) = following(folder.path(), &text("One"));
        assert_eq!(offered(&mut follower, 3), []);
        // Half of it is there at this look, and all of it at the next.
        fs::write(&path, "schema = 1\nname = \"Tw").unwrap();
        assert_eq!(offered(&mut follower, 1), []);
        fs::write(&path, text("Two")).unwrap();
        assert_eq!(offered(&mut follower, 1), []);
        assert_eq!(offered(&mut follower, 3), [Ok("Two".into())]);
        fs::write(&path, "schema = 2").unwrap();
        let told = offered(&mut follower, 4);
        assert!(matches!(&told[..], [Err(error)] if error.contains("mine.toml:1:10")), "{told:?}");
        let aside = folder.path().join("aside");
        fs::write(&aside, text("Three")).unwrap();
        fs::rename(&aside, &path).unwrap();
        assert_eq!(offered(&mut follower, 3), [Ok("Three".into())]);
    }

    #[test]
    fn a_file_that_is_gone_is_an_error_and_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let (mut follower, path) = following(folder.path(), &text("One"));
        fs::remove_file(&path).unwrap();
        let told = offered(&mut follower, 3);
        assert!(matches!(&told[..], [Err(error)] if error.contains("mine.toml")), "{told:?}");
        fs::write(&path, text("One")).unwrap();
        assert_eq!(offered(&mut follower, 3), [Ok("One".into())]);
    }

    #[test]
    fn what_people_ask_for_meanwhile_stands_before_what_was_seen() {
        let folder = tempfile::tempdir().unwrap();
        let (mut follower, path) = following(folder.path(), &text("One"));
        fs::write(&path, text("Two")).unwrap();
        assert_eq!(offered(&mut follower, 1), []);
        let asked = follower.wish.lock().unwrap().asked(Some("contra"));
        *follower.wish.lock().unwrap() = asked;
        assert_eq!(offered(&mut follower, 3), []);
        assert_eq!(follower.wish.lock().unwrap().name, "contra");
    }
}
