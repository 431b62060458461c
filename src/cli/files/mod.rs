//! Files that verbs take and write: how they are named, found, read and kept.

pub(super) mod config_folder;
pub(super) mod decoder_file;
pub(super) mod destination;
pub(super) mod device;
pub(super) mod field;
pub(super) mod labels;
pub(super) mod played;
pub(super) mod recording;
pub(super) mod state_file;
pub(super) mod tables;
pub(super) mod text_file;
