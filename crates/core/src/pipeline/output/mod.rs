//! From levels to edges, and from rates to steps.

pub mod event_log;
pub mod ledger;
mod motion;
