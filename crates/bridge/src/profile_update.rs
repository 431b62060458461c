//! Profile changes that come from another thread: a file was edited, or another program is in the foreground.

use tactpad_core::pipeline::mapping::profile::Profile;
use tactpad_core::pipeline::mapping::read::ReadProfile;

/// A profile that another thread has read for the bridge.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileUpdate {
    /// The profile, or why it cannot be used, for people.
    pub read: Result<ReadProfile, String>,
    /// Why it is to be played, for people; `None` if the reason is as before and only its file was changed.
    pub reason: Option<String>,
    /// Number of profile requests by people at the time of reading; the update is stale if there were more since.
    pub request_count: u64,
}

/// Why the current profile is played, and whether another one failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ProfileStatus {
    /// Reason for the current profile, for people.
    pub(super) reason: String,
    /// Error of the profile that would be played otherwise.
    pub(super) error: Option<String>,
    /// Whether the current profile is a preview that is not saved.
    pub(super) is_preview: bool,
}

impl ProfileStatus {
    /// The status at the start of a run.
    pub(super) fn new() -> Self {
        Self { reason: "chosen at the start".into(), error: None, is_preview: false }
    }

    /// Records a request by people: for a profile by its name, or to read the same one again.
    pub(super) fn on_request(&mut self, is_named: bool) {
        (self.error, self.is_preview) = (None, false);
        if is_named {
            self.reason = "asked for".into();
        }
    }

    /// Records that an unsaved profile is previewed.
    pub(super) fn on_preview(&mut self) {
        (self.error, self.is_preview) = (None, true);
    }

    /// Records the result of an update: the profile and whether it equals the one in play, or why it cannot be used. Returns the message
    /// for people, if there is one.
    pub(super) fn apply(
        &mut self,
        update: &ProfileUpdate,
        read: Result<(&Profile, bool), &String>,
    ) -> Option<String> {
        let (profile, is_same) = match read {
            Ok(read) => read,
            Err(error) => {
                let is_new = self.error.as_ref() != Some(error);
                self.error = Some(error.clone());
                return is_new.then(|| unchanged_message(error));
            }
        };
        self.is_preview = false;
        let had_error = self.error.take().is_some();
        let is_silent = is_same && !had_error && update.reason.as_ref().is_none_or(|it| *it == self.reason);
        self.reason = update.reason.clone().unwrap_or_else(|| std::mem::take(&mut self.reason));
        let why = update.reason.as_deref().unwrap_or("its file was changed");
        (!is_silent).then(|| format!("profile {}: {why}", profile.name))
    }
}

/// The message for people when a profile cannot be used.
pub(super) fn unchanged_message(error: &str) -> String {
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

    fn update(read: Result<ReadProfile, String>, reason: Option<&str>) -> ProfileUpdate {
        ProfileUpdate { read, reason: reason.map(str::to_owned), request_count: 0 }
    }

    fn message(profile_status: &mut ProfileStatus, update: &ProfileUpdate, is_same: bool) -> Option<String> {
        profile_status.apply(update, update.read.as_ref().map(|read| (read.profile(), is_same)))
    }

    #[test]
    fn an_error_is_told_once_and_kept_until_it_is_mended() {
        let mut profile_status = ProfileStatus::new();
        let [bad, good] = [update(Err("line 3 is wrong".into()), None), update(Ok(contra()), None)];
        assert!(message(&mut profile_status, &bad, false).is_some_and(|line| line.contains("line 3")));
        assert_eq!(message(&mut profile_status, &bad, false), None);
        assert_eq!(profile_status.error.as_deref(), Some("line 3 is wrong"));
        let mended = Some("profile Contra: its file was changed".to_owned());
        assert_eq!(message(&mut profile_status, &good, true), mended);
        assert_eq!(
            (&profile_status, message(&mut profile_status.clone(), &good, true)),
            (&ProfileStatus::new(), None)
        );
        assert_eq!(message(&mut profile_status, &good, false), mended);
    }

    #[test]
    fn a_reason_stays_until_there_is_another_one() {
        let mut profile_status = ProfileStatus::new();
        let [named, again] =
            ["for the game", "nothing is in front"].map(|why| update(Ok(contra()), Some(why)));
        assert_eq!(
            message(&mut profile_status, &named, false).as_deref(),
            Some("profile Contra: for the game")
        );
        assert_eq!(message(&mut profile_status, &update(Ok(contra()), None), true), None);
        assert_eq!(profile_status.reason, "for the game");
        assert!(message(&mut profile_status, &again, true).is_some());
        profile_status.on_request(false);
        assert_eq!(profile_status.reason, "nothing is in front");
        profile_status.on_request(true);
        assert_eq!(profile_status.reason, "asked for");
    }
}
