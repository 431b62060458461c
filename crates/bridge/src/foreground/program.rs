//! The program of a window.

use std::env;
use std::fs;
use std::path::PathBuf;

/// The window that has the keyboard.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Foreground {
    /// None has it, or one that says nothing of itself.
    Unknown,
    /// One of this program.
    OwnProgram,
    /// One of another program.
    Program {
        /// The words of its class (`WM_CLASS`), or its name on Wayland (`app_id`).
        classes: Vec<String>,
        /// The path of the executable that its process runs, if that can be known.
        executable: Option<String>,
    },
}

/// The executable of this process.
#[derive(Clone, Debug)]
pub(super) struct OwnProgram(Option<PathBuf>);

impl OwnProgram {
    pub(super) fn here() -> Self {
        Self(env::current_exe().ok())
    }

    /// The program of a window, by its classes and its process on this machine.
    pub(super) fn or_program(&self, classes: Vec<String>, process: Option<u32>) -> Foreground {
        let path = process.and_then(|process| fs::read_link(format!("/proc/{process}/exe")).ok());
        if path.is_some() && path == self.0 {
            return Foreground::OwnProgram;
        }
        let executable = path.map(|path| path.to_string_lossy().trim_end_matches(" (deleted)").to_owned());
        Foreground::Program { classes, executable }
    }
}
