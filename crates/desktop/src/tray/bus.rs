//! Whether the desktop has a place for the icon.

use zbus::blocking::Connection;

/// The name of whoever keeps a desktop's icons.
const WATCHER: &str = "org.kde.StatusNotifierWatcher";

/// Whether there is one now.
///
/// # Errors
/// There is none, or no desktop; the text is for people.
pub(super) fn find_place() -> Result<(), String> {
    let bus = Connection::session().map_err(|_| "there is no session bus")?;
    let daemon = "org.freedesktop.DBus";
    let answer = bus
        .call_method(Some(daemon), "/org/freedesktop/DBus", Some(daemon), "NameHasOwner", &WATCHER)
        .and_then(|answer| answer.body().deserialize::<bool>());
    match answer {
        Ok(true) => Ok(()),
        Ok(false) => Err("no panel takes icons yet".into()),
        Err(_) => Err("the session bus does not answer".into()),
    }
}
