//! What can happen to a pipeline, small enough that a mutation of bytes is a mutation of the story.

use arbitrary::Arbitrary;

/// One thing that happens.
#[derive(Arbitrary, Clone, Debug)]
pub enum Step {
    /// The pad sends samples of one contact, a millisecond apart.
    Hold {
        finger: Finger,
        samples: u8,
    },
    /// The pad lies untouched for as long as the zero takes, sampling every 25 ms.
    Rest,
    /// The pad sends one sample with something wrong.
    Odd {
        finger: Finger,
        oddity: Oddity,
    },
    /// Anything comes from the pad.
    Bytes(Vec<u8>),
    /// A sound frame of any body comes from the pad.
    Body(Vec<u8>),
    /// The pad tells who it is.
    Identity {
        channels: u8,
        count_bits: u8,
        picovolts_per_count: u32,
    },
    /// Time passes; `Late` is a host that sleeps over its deadlines and calls once at the end.
    Silence {
        us: u32,
        waking: Waking,
    },
    Timeout,
    Unplugged,
    Pause,
    Resume,
    ReleaseAll,
    Retare,
    /// A weight of so many grams and 30.
    Weigh(u8),
    /// One of the shipped profiles, for the gamepad or the keyboard.
    Profile {
        number: u8,
        keyboard: bool,
    },
}

/// Place in half millimetres, forces in twentieths of a newton.
#[derive(Arbitrary, Clone, Copy, Debug)]
pub struct Finger {
    pub x: i8,
    pub y: i8,
    pub fx: i8,
    pub fy: i8,
    pub fz: u8,
}

/// When the host calls what is due.
#[derive(Arbitrary, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Waking {
    OnTime,
    Late,
}

/// What is wrong with a sample.
#[derive(Arbitrary, Clone, Copy, Debug)]
pub enum Oddity {
    Counts([i32; 9]),
    Status(u16),
    Sequence(u32),
    TimeUs(u64),
    Repeated,
    Damaged { place: u8, bit: u8 },
}
