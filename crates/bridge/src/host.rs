//! The host: the interface of the program that a bridge runs in.

use crate::profile_update::ProfileUpdate;
use tactpad_core::pipeline::mapping::read::ReadProfile;

/// The program that a bridge runs in. It is called between two turns of the loop, so it should answer soon.
pub trait Host {
    /// Reads a profile: the named one, or the one in use again.
    ///
    /// # Errors
    /// It cannot be used; the text is for people.
    fn read_profile(&mut self, name: Option<&str>) -> Result<ReadProfile, String>;

    /// Reads the profile that comes after the one in use. Only those are taken from which a press leads on, so that nobody who has no
    /// other input is left in one.
    ///
    /// # Errors
    /// There is none; the text is for people.
    fn next_profile(&mut self) -> Result<ReadProfile, String>;

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
