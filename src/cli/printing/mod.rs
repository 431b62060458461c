//! Text and figures that verbs print: streams, terminals, progress, wrapped sentences.

pub(super) mod date;
pub(super) mod pictures;
pub(super) mod progress;
pub(super) mod reports;
pub(super) mod seconds;
pub(super) mod summary;
pub(super) mod terminal;
pub(super) mod wrapped;
pub(super) mod written;
