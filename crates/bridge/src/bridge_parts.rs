//! The parts of which a bridge is made.

use std::io::Write;

use crate::changes::ChangesSlot;
use crate::clock::Clock;
use crate::host::Host;
use crate::observer::Observer;
use crate::opening::{OpenedPad, Patience};
use crate::requests::Requests;
use crate::sink::Sink;
use tactpad_core::pipeline::contact::Decoder;
use tactpad_core::pipeline::mapping::read::ReadProfile;

/// A decoder that is to play.
#[derive(Clone, Debug)]
pub struct PlayingDecoder {
    /// The decoder itself.
    pub decoder: Decoder,
    /// Display name.
    pub name: String,
    /// Where it was read, for who reads it again: a file's whole path, or its name inside the program.
    pub place: Option<String>,
    /// Its file, as captures keep it; `None` for the statics that are inside the program.
    pub file: Option<Vec<u8>>,
}

/// The parts of which a bridge is made.
pub struct BridgeParts {
    /// The clock of the run.
    pub clock: Clock,
    /// The pad, opened once already so that errors were told.
    pub pad: OpenedPad,
    /// Whether to go on waiting for a pad that sends no sound frame.
    pub patience: Patience,
    /// The decoder.
    pub decoder: PlayingDecoder,
    /// The profile in play at the start.
    pub profile: ReadProfile,
    /// Where events go.
    pub sink: Box<dyn Sink>,
    /// The queue of requests by people.
    pub requests: Requests,
    /// The program around the bridge.
    pub host: Box<dyn Host>,
    /// Where calls are recorded.
    pub record: Option<Box<dyn Write + Send>>,
    /// Who are told of each call.
    pub observers: Vec<Observer>,
    /// Where it is handed in what play shows of changes in the pad.
    pub changes: ChangesSlot,
    /// Ends the run after this time.
    pub duration_us: Option<u64>,
}
