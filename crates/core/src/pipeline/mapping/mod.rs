//! From contacts to what should be held now.
//!
//! The mapping states *levels*; it never emits. `output::ledger` turns levels into edges.
//!
//! ```text
//! read ──▶ profile ◀── live
//! ```
//!
//! [`profile`] is one game's mapping as a value. [`read`] makes it of TOML text, with all that there is to say about the text;
//! [`live`] plays it, sample by sample. Neither of these two knows the other. [`plain`] says what people read of it.

pub mod live;
pub mod plain;
pub mod profile;
pub mod read;
