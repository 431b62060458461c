//! How a verb ends that did not do what was asked: the message and the exit code.

use std::io;

/// Why a verb did not do what was asked.
#[derive(Debug)]
pub(super) enum Failure {
    /// Arguments or input that cannot be used: exit 2.
    Unusable(String),
    /// It failed, or a check says no: exit 1.
    Failed(String),
    /// Nobody reads our output any more; nothing to say.
    Unread,
}

#[cfg(target_os = "linux")]
impl Failure {
    /// As people read it, where it ends nothing.
    pub(super) fn sentence(self) -> String {
        match self {
            Self::Unusable(message) | Self::Failed(message) => message,
            Self::Unread => "nobody reads the warnings".into(),
        }
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        if error.kind() == io::ErrorKind::BrokenPipe { Self::Unread } else { Self::Failed(error.to_string()) }
    }
}

/// Ignores that the reader went away: that is no reason to skip the verdict.
pub(super) fn if_read(printed: Result<(), Failure>) -> Result<(), Failure> {
    match printed {
        Err(Failure::Unread) => Ok(()),
        printed => printed,
    }
}
