//! Profiles that a running bridge is offered: by whoever watches their files, or the program in front.

use tactpad_core::pipeline::mapping::profile::Profile;
use tactpad_core::pipeline::mapping::read::ReadProfile;

/// A profile that was read away from the bridge's loop.
#[derive(Clone, Debug, PartialEq)]
pub struct Offer {
    /// The profile, or why it cannot be used, for people.
    pub read: Result<ReadProfile, String>,
    /// Why it is to be played, for people; `None` if the reason is as before and only its file was changed.
    pub reason: Option<String>,
    /// How often people had asked for a profile when it was read.
    pub asked: u64,
}

/// How the profile that is played came to be it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Standing {
    /// Why it is this one.
    pub(super) reason: String,
    /// What is wrong with the one that would be played else.
    pub(super) error: Option<String>,
    /// Whether what is played is only tried, and is not kept.
    pub(super) is_preview: bool,
}

impl Standing {
    /// At the start.
    pub(super) fn begun() -> Self {
        Self { reason: "chosen at the start".into(), error: None, is_preview: false }
    }

    /// People asked for it: by its name, or to be read again.
    pub(super) fn asked(&mut self, is_named: bool) {
        (self.error, self.is_preview) = (None, false);
        if is_named {
            self.reason = "asked for".into();
        }
    }

    /// A profile is tried that is not kept.
    pub(super) fn previewed(&mut self) {
        (self.error, self.is_preview) = (None, true);
    }

    /// Goes on with what came of an offer: the profile and whether it is the one that is played, or why it cannot be used. The line to
    /// tell people, if there is one.
    pub(super) fn offered(
        &mut self,
        offer: &Offer,
        read: Result<(&Profile, bool), &String>,
    ) -> Option<String> {
        let (profile, is_same) = match read {
            Ok(read) => read,
            Err(error) => {
                let is_new = self.error.as_ref() != Some(error);
                self.error = Some(error.clone());
                return is_new.then(|| kept(error));
            }
        };
        self.is_preview = false;
        let had_error = self.error.take().is_some();
        let is_silent = is_same && !had_error && offer.reason.as_ref().is_none_or(|it| *it == self.reason);
        self.reason = offer.reason.clone().unwrap_or_else(|| std::mem::take(&mut self.reason));
        let why = offer.reason.as_deref().unwrap_or("its file was changed");
        (!is_silent).then(|| format!("profile {}: {why}", profile.name))
    }
}

/// What is told of a profile that cannot be used.
pub(super) fn kept(error: &str) -> String {
    format!("{error}\nthe profile in use stays")
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_core::pipeline::mapping::read::check::OutputChoice;
    use tactpad_core::pipeline::mapping::read::shipped;

    fn contra() -> ReadProfile {
        ReadProfile::read(shipped::text("contra").unwrap(), OutputChoice::AsWritten).0.unwrap()
    }

    fn offer(read: Result<ReadProfile, String>, reason: Option<&str>) -> Offer {
        Offer { read, reason: reason.map(str::to_owned), asked: 0 }
    }

    fn told(standing: &mut Standing, offer: &Offer, is_same: bool) -> Option<String> {
        standing.offered(offer, offer.read.as_ref().map(|read| (read.profile(), is_same)))
    }

    #[test]
    fn an_error_is_told_once_and_kept_until_it_is_mended() {
        let mut standing = Standing::begun();
        let [bad, good] = [offer(Err("line 3 is wrong".into()), None), offer(Ok(contra()), None)];
        assert!(told(&mut standing, &bad, false).is_some_and(|line| line.contains("line 3")));
        assert_eq!(told(&mut standing, &bad, false), None);
        assert_eq!(standing.error.as_deref(), Some("line 3 is wrong"));
        let mended = Some("profile Contra: its file was changed".to_owned());
        assert_eq!(told(&mut standing, &good, true), mended);
        assert_eq!((&standing, told(&mut standing.clone(), &good, true)), (&Standing::begun(), None));
        assert_eq!(told(&mut standing, &good, false), mended);
    }

    #[test]
    fn a_reason_stays_until_there_is_another_one() {
        let mut standing = Standing::begun();
        let [named, again] =
            ["for the game", "nothing is in front"].map(|why| offer(Ok(contra()), Some(why)));
        assert_eq!(told(&mut standing, &named, false).as_deref(), Some("profile Contra: for the game"));
        assert_eq!(told(&mut standing, &offer(Ok(contra()), None), true), None);
        assert_eq!(standing.reason, "for the game");
        assert!(told(&mut standing, &again, true).is_some());
        standing.asked(false);
        assert_eq!(standing.reason, "nothing is in front");
        standing.asked(true);
        assert_eq!(standing.reason, "asked for");
    }
}
