//! The history of the user's own profiles: every save, what it changed, edits that are kept in it, and profiles as files for other machines.

pub(super) mod bundle;
mod changes;
pub(super) mod edits;
pub(super) mod saves;
pub(super) mod verbs;
