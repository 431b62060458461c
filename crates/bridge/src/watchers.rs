//! Those who watch what becomes of presses: a line of JSON for each, behind a queue, so that nobody holds up the bridge.

use std::io;
use std::net::Shutdown;
use std::os::unix::net::UnixStream;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use serde::Serialize;

use crate::queue::{WriteGroup, WriteQueue};
use tactpad_core::pipeline::mapping::live::verdict::{Reason, Verdict, VerdictEvent};
use tactpad_core::pipeline::mapping::plain::named;
use tactpad_core::pipeline::mapping::profile::Profile;

/// So many may watch at a time.
const WATCHERS_MAX: usize = 8;

/// So much may wait for one that does not read: some hundred presses.
const QUEUE_BYTES_MAX: usize = 16 << 10;

/// All who watch; clones are the same ones.
#[derive(Clone, Debug, Default)]
pub(super) struct Watchers {
    all: Arc<Mutex<Vec<Watcher>>>,
    /// How many there are, for a look that costs nothing.
    count: Arc<AtomicUsize>,
}

struct Watcher {
    stream: UnixStream,
    lines: WriteQueue,
    /// Presses that found no room since the last line.
    lost: u64,
}

/// A press as watchers read it.
#[derive(Clone, Debug, Serialize)]
pub struct PressLine {
    t_us: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    button: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    direction: Option<&'static str>,
    /// What people call it: what it does.
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    press: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<Reason>,
    /// How many presses before this one are not told, because they were not read in time.
    #[serde(skip_serializing_if = "is_none")]
    lost: u64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands a reference")]
const fn is_none(lost: &u64) -> bool {
    *lost == 0
}

impl PressLine {
    /// That of a verdict in the play of a profile, before which so many were lost.
    pub fn of(verdict: &Verdict, profile: &Profile, lost: u64) -> Self {
        let (button, direction, name, rejected) = match verdict.told {
            VerdictEvent::Button { number, rejected } => (
                Some(number),
                None,
                number.checked_sub(1).and_then(|it| named::button(profile, it)),
                rejected,
            ),
            VerdictEvent::Direction { direction, rejected } => {
                (None, Some(direction.name()), Some(named::direction(profile, direction)), rejected)
            }
            VerdictEvent::Rest => (None, None, None, None),
        };
        let press = match verdict.told {
            VerdictEvent::Rest => "rest",
            _ if rejected.is_some() => "rejected",
            _ => "accepted",
        };
        Self { t_us: verdict.t.as_us(), button, direction, name, press, reason: rejected, lost }
    }
}

impl Watchers {
    /// Lets one more watch. False if there are too many.
    ///
    /// # Errors
    /// The system has no thread or descriptor to give.
    pub(super) fn add(&self, stream: &UnixStream) -> io::Result<bool> {
        let mut all = self.all.lock().unwrap_or_else(PoisonError::into_inner);
        all.retain(|watcher| !watcher.has_left());
        if all.len() == WATCHERS_MAX {
            return Ok(false);
        }
        stream.set_nonblocking(false)?;
        let lines = WriteQueue::to_stream("watch", stream.try_clone()?, QUEUE_BYTES_MAX)?;
        lines.push(b"{\"ok\":true}\n".to_vec().into())?;
        all.push(Watcher { stream: stream.try_clone()?, lines, lost: 0 });
        self.count.store(all.len(), Ordering::Release);
        Ok(true)
    }

    /// Tells everybody what became of presses in the play of this profile. Who went away is forgotten.
    pub(super) fn tell(&self, verdicts: &[Verdict], profile: &Profile) {
        if verdicts.is_empty() || self.count.load(Ordering::Acquire) == 0 {
            return;
        }
        // Somebody is being let in: these presses come before it watches, or are lost.
        let Ok(mut all) = self.all.try_lock() else { return };
        all.retain_mut(|watcher| verdicts.iter().all(|verdict| watcher.tell(verdict, profile).is_ok()));
        self.count.store(all.len(), Ordering::Release);
    }
}

impl Watcher {
    /// Whether its other end is gone.
    fn has_left(&self) -> bool {
        let mut asked = [PollFd::new(&self.stream, PollFlags::empty())];
        let at_once = Timespec { tv_sec: 0, tv_nsec: 0 };
        poll(&mut asked, Some(&at_once)).is_ok()
            && asked[0].revents().intersects(PollFlags::HUP | PollFlags::ERR)
    }

    /// Hands a line on, or counts it as lost.
    fn tell(&mut self, verdict: &Verdict, profile: &Profile) -> io::Result<()> {
        let line = PressLine::of(verdict, profile, self.lost);
        let bytes = (serde_json::to_string(&line).map_err(io::Error::other)? + "\n").into_bytes();
        let is_taken = self.lines.push(WriteGroup { items: bytes, count: 1, written: None })?;
        self.lost = if is_taken { 0 } else { self.lost + 1 };
        Ok(())
    }
}

impl Drop for Watcher {
    fn drop(&mut self) {
        if self.lines.waiting() > 0 {
            // Who does not read is not waited for.
            let _ = self.stream.shutdown(Shutdown::Both);
        }
    }
}

impl std::fmt::Debug for Watcher {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Watcher").field("lost", &self.lost).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use std::io::{BufRead, BufReader};

    use super::*;
    use tactpad_core::pipeline::mapping::profile::Direction;
    use tactpad_core::pipeline::mapping::read::check::{OutputChoice, read};
    use tactpad_core::time::StreamInstant;

    /// With two buttons, of which the second has a name.
    fn profile() -> Profile {
        let text = "schema = 1\nname = \"x\"\noutput = \"gamepad\"\n[dpad]\nlabel = { left = \"back\" }\n\
                    [[button]]\nforce = \"fx\"\npress_n = 1.0\nout = { gamepad = \"BTN_TL\", keyboard = \"KEY_A\" }\n\
                    [[button]]\nforce = \"fz\"\npress_n = 1.0\n\
                    out = { gamepad = \"BTN_SOUTH\", keyboard = \"KEY_Z\", label = \"jump\" }\n";
        let (profile, found) = read(text, OutputChoice::AsWritten);
        profile.unwrap_or_else(|| panic!("{found:?}"))
    }

    fn verdict(us: u64, rejected: Option<Reason>) -> Verdict {
        Verdict { t: StreamInstant::from_us(us), told: VerdictEvent::Button { number: 2, rejected } }
    }

    #[test]
    fn directions_and_hands_that_rest_have_lines_of_their_own() {
        let line = |told| {
            let verdict = Verdict { t: StreamInstant::from_us(7), told };
            serde_json::to_string(&PressLine::of(&verdict, &profile(), 0)).unwrap()
        };
        let left = |rejected| VerdictEvent::Direction { direction: Direction::Left, rejected };
        assert_eq!(
            line(left(None)),
            r#"{"t_us":7,"direction":"left","name":"left: back","press":"accepted"}"#
        );
        assert_eq!(
            line(left(Some(Reason::Slow))),
            r#"{"t_us":7,"direction":"left","name":"left: back","press":"rejected","reason":"slow"}"#
        );
        assert_eq!(line(VerdictEvent::Rest), r#"{"t_us":7,"press":"rest"}"#);
    }

    #[test]
    fn a_watcher_reads_a_line_for_each_press() {
        let (client, served) = UnixStream::pair().unwrap();
        let watchers = Watchers::default();
        watchers.tell(&[verdict(1, None)], &profile());
        assert!(watchers.add(&served).unwrap());
        watchers.tell(&[verdict(5, None), verdict(9, Some(Reason::Bounce))], &profile());
        let lines: Vec<_> = BufReader::new(&client).lines().take(3).map(Result::unwrap).collect();
        let expected = [
            r#"{"ok":true}"#,
            r#"{"t_us":5,"button":2,"name":"A: jump","press":"accepted"}"#,
            r#"{"t_us":9,"button":2,"name":"A: jump","press":"rejected","reason":"bounce"}"#,
        ];
        assert_eq!(lines, expected);
    }

    #[test]
    fn who_does_not_read_loses_presses_that_are_counted_and_holds_up_nobody() {
        let (client, served) = UnixStream::pair().unwrap();
        let watchers = Watchers::default();
        assert!(watchers.add(&served).unwrap());
        let profile = profile();
        // More than a socket and the queue keep.
        (0..40_000).for_each(|us| watchers.tell(&[verdict(us, None)], &profile));
        let reading = std::thread::spawn(move || {
            let (mut told, mut lost) = (0, 0);
            for line in BufReader::new(client).lines().skip(1) {
                let line: serde_json::Value = serde_json::from_str(&line.unwrap()).unwrap();
                lost += line["lost"].as_u64().unwrap_or(0);
                if line["reason"] == "slow" {
                    return (told, lost);
                }
                told += 1;
            }
            panic!("the last press was not told")
        });
        // Each of these is told, or counted with those that were lost.
        while !reading.is_finished() {
            watchers.tell(&[verdict(50_000, Some(Reason::Slow))], &profile);
        }
        let (told, lost) = reading.join().unwrap();
        assert!(lost > 0 && told + lost >= 40_000, "{told} told, {lost} lost");
    }

    #[test]
    fn who_went_away_is_forgotten_and_there_is_an_end_of_who_may_watch() {
        let watchers = Watchers::default();
        let pairs: Vec<_> = (0..WATCHERS_MAX).map(|_| UnixStream::pair().unwrap()).collect();
        assert!(pairs.iter().all(|(_, served)| watchers.add(served).unwrap()));
        assert!(!watchers.add(&pairs[0].1).unwrap());
        drop(pairs);
        let late = UnixStream::pair().unwrap();
        assert!(watchers.add(&late.1).unwrap(), "the others are gone");
        assert_eq!(watchers.all.lock().unwrap().len(), 1);
        drop(late);
        while watchers.count.load(Ordering::Acquire) > 0 {
            watchers.tell(&[verdict(1, None)], &profile());
        }
        assert!(watchers.all.lock().unwrap().is_empty());
    }
}
