//! The guardian: a process that outlives a bridge, however that dies, and lifts what it left down on an X server.
//!
//! It waits for the lock of the bridge's record, which the kernel gives away when a process dies. Where both are killed at once the next
//! start lifts.

use std::fs::File;
use std::io;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread;

use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
use signal_hook::flag;

use super::left_down::{LeftDown, Treatment, left_down};

/// Starts the program that is to guard this record, which is locked. It gets the record as its last argument, and calls [`guard`].
///
/// # Errors
/// The system has no process or no thread to give.
pub(super) fn start(mut program: Command, record: &Path) -> io::Result<()> {
    program.arg(record).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    // A terminal's Ctrl-C is not for it, and no folder is held.
    let mut guardian = program.process_group(0).current_dir("/").spawn()?;
    // It ends after the sink: somebody has to ask how.
    let wait = move || guardian.wait().map_or((), |_| ());
    thread::Builder::new().name("guardian".into()).spawn(wait).map(|_| ())
}

/// Waits until the bridge of this record has ended, and lifts what it and other dead ones left down.
///
/// # Errors
/// Signals cannot be put off, or the record cannot be locked.
pub fn guard(record: &Path) -> io::Result<Vec<LeftDown>> {
    // Who ends both asks the bridge first; this ends with it.
    let ignored = Arc::new(AtomicBool::new(false));
    for signal in [SIGHUP, SIGINT, SIGQUIT, SIGTERM] {
        flag::register(signal, Arc::clone(&ignored))?;
    }
    let file = match File::open(record) {
        // The bridge has ended already, and held nothing.
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        opened => opened?,
    };
    while let Err(error) = file.lock() {
        if error.kind() != io::ErrorKind::Interrupted {
            return Err(error);
        }
    }
    drop(file);
    Ok(record.parent().map(|folder| left_down(folder, Treatment::Lift)).unwrap_or_default())
}
