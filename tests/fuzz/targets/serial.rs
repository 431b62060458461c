//! Any bytes on the line, then the same as a body that is sound on it: no panic, and what is read is written alike.
#![no_main]

use firmware_proto::ENCODED_MAX;
use firmware_proto::link::{CommandReceiver, MessageReceiver, encode_command, encode_message};

libfuzzer_sys::fuzz_target!(init: tactpad_fuzz::body::check(), |bytes: &[u8]| {
    let (mut messages, mut commands) = (MessageReceiver::new(), CommandReceiver::new());
    let mut again = [0; ENCODED_MAX];
    for byte in [bytes, &[0], &tactpad_fuzz::body::framed(bytes)].concat() {
        if let Some(Ok(message)) = messages.push(byte) {
            let length = encode_message(&message, &mut again);
            assert_eq!(again[..length].iter().find_map(|byte| messages.push(*byte)), Some(Ok(message)));
        }
        if let Some(Ok(command)) = commands.push(byte) {
            let length = encode_command(&command, &mut again);
            assert_eq!(again[..length].iter().find_map(|byte| commands.push(*byte)), Some(Ok(command)));
        }
    }
});
