//! Phase of a pipeline, in a word.

/// Phase of the pipeline, for people.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// No pad is heard.
    Waiting,
    /// The zero is being measured; the pad must lie untouched.
    Taring,
    /// The zero cannot be measured: something lies on the pad.
    Loaded,
    /// Contacts become events.
    Playing,
    /// A known weight is weighed, or lies there still: contacts do nothing.
    Weighing,
    /// The line was at fault just now; contacts are not believed yet.
    Doubtful,
    /// A channel cannot be trusted.
    Faulty,
    /// The player paused.
    Paused,
    /// The pad cannot be played with.
    Refused,
}
