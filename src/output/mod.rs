//! From levels to edges.

pub mod event_log;
pub mod ledger;
