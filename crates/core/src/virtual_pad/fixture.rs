//! What the tests of the virtual pad share: the shipped profiles, and a host's ear.

use firmware_proto::frame::Message;
use firmware_proto::link::MessageReceiver;

use crate::pipeline::control::Code;
use crate::pipeline::mapping::profile::Profile;
use crate::pipeline::mapping::read::check::{self, OutputChoice};
use crate::pipeline::mapping::read::shipped;

pub(super) const HAT_X: Code = Code::Axis(0x10);
pub(super) const HAT_Y: Code = Code::Axis(0x11);
pub(super) const SOUTH: Code = Code::Key(0x130);
pub(super) const EAST: Code = Code::Key(0x131);

/// super-mario, tetris, tank-battle, contra.
pub(super) fn shipped_profiles() -> [Profile; 4] {
    ["super-mario", "tetris", "tank-battle", "contra"].map(|name| {
        let text = shipped::text(name).unwrap();
        check::read(text, OutputChoice::AsWritten).0.unwrap()
    })
}

/// Every message in `bytes`, all of which must be good.
pub(super) fn messages(bytes: &[u8]) -> Vec<Message> {
    let mut receiver = MessageReceiver::new();
    bytes.iter().filter_map(|byte| receiver.push(*byte)).map(|message| message.unwrap()).collect()
}
