//! Calls to a pipeline, as one type: the bridge makes calls, a capture keeps them, a replay makes them again.

use std::sync::Arc;

use crate::pad::weight::Weight;
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
    /// A known weight was to be weighed.
    Weigh(Weight),
    /// Another profile was chosen.
    Profile(&'a ReadProfile),
}

/// A call that owns what it carries, for whoever makes it later; clones share that.
#[derive(Clone, Debug, PartialEq)]
pub enum OwnedCall {
    /// Bytes came from the pad.
    Bytes(Arc<[u8]>),
    /// Another profile was chosen.
    Profile(Arc<ReadProfile>),
    /// What borrows nothing.
    Plain(Call<'static>),
}

impl OwnedCall {
    /// The call itself.
    pub fn as_call(&self) -> Call<'_> {
        match self {
            Self::Bytes(bytes) => Call::Bytes(bytes),
            Self::Profile(read) => Call::Profile(read),
            Self::Plain(call) => *call,
        }
    }
}

impl From<Call<'_>> for OwnedCall {
    fn from(call: Call<'_>) -> Self {
        match call {
            Call::Bytes(bytes) => Self::Bytes(bytes.into()),
            Call::Profile(read) => Self::Profile(Arc::new(read.clone())),
            Call::Timeout => Self::Plain(Call::Timeout),
            Call::Unplugged => Self::Plain(Call::Unplugged),
            Call::Pause => Self::Plain(Call::Pause),
            Call::Resume => Self::Plain(Call::Resume),
            Call::ReleaseAll => Self::Plain(Call::ReleaseAll),
            Call::Retare => Self::Plain(Call::Retare),
            Call::Weigh(weight) => Self::Plain(Call::Weigh(weight)),
        }
    }
}
