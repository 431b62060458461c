//! What can happen to a pipeline, as one type: the bridge makes calls, a capture keeps them, a replay makes them again.

use crate::pipeline::mapping::read::ReadProfile;

/// One call on the pipeline; see [`crate::pipeline::Pipeline::apply`]. It borrows what it carries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Call<'a> {
    /// Bytes came from the pad.
    Bytes(&'a [u8]),
    /// A deadline passed.
    Timeout,
    /// The pad was unplugged.
    Unplugged,
    /// The player paused.
    Pause,
    /// The player went on.
    Resume,
    /// Everything was to be released.
    ReleaseAll,
    /// The zero was to be measured again.
    Retare,
    /// Another profile was chosen.
    Profile(&'a ReadProfile),
}
