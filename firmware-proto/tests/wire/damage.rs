//! Whatever happens on the line, no receiver yields a message that was not sent, and the next zero sets it
//! right.

use firmware_proto::ENCODED_MAX;
use firmware_proto::command::Command;
use firmware_proto::frame::{Message, WireError};
use firmware_proto::link::{CommandReceiver, MessageReceiver, encode_command, encode_message};

use crate::random::Random;
use crate::vectors::{command_frames, message_frames};

fn frame_of(message: &Message) -> Vec<u8> {
    let mut frame = [0; ENCODED_MAX];
    let len = encode_message(message, &mut frame);
    frame[..len].to_vec()
}

fn receive(bytes: &[u8]) -> Vec<Result<Message, WireError>> {
    let mut receiver = MessageReceiver::new();
    bytes.iter().filter_map(|byte| receiver.push(*byte)).collect()
}

fn receive_commands(bytes: &[u8]) -> Vec<Result<Command, WireError>> {
    let mut receiver = CommandReceiver::new();
    bytes.iter().filter_map(|byte| receiver.push(*byte)).collect()
}

/// A message that no test damages, to follow the damage.
fn follower() -> Message {
    Message::Sample(Random(99).sample())
}

/// Sends damaged bytes and then two good frames. The first of them may be lost with the damage, the second
/// may not.
fn assert_told_and_survived(damaged: &[u8]) {
    let follower = follower();
    let good = frame_of(&follower);
    let received = receive(&[damaged, &good, &good].concat());
    assert_eq!(received.last(), Some(&Ok(follower)), "{damaged:02x?}");
    assert!(received.iter().all(|result| *result == Ok(follower) || result.is_err()), "{received:?}");
    assert!(received.iter().any(Result::is_err), "damage goes unseen: {damaged:02x?}");
}

#[test]
fn every_truncation_is_told() {
    for frame in message_frames() {
        for len in 1..frame.len() - 1 {
            assert_eq!(receive(&frame[..len]), [], "no zero yet");
            assert_eq!(receive(&[&frame[..len], &[0]].concat()), [Err(WireError::Damaged)]);
            assert_told_and_survived(&frame[len..]);
        }
    }
    for frame in command_frames() {
        for len in 1..frame.len() - 1 {
            assert_eq!(receive_commands(&[&frame[..len], &[0]].concat()), [Err(WireError::Damaged)]);
        }
    }
}

#[test]
fn every_single_bit_of_damage_is_told() {
    for frame in message_frames() {
        for bit in 0..8 * frame.len() {
            let mut damaged = frame.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert_told_and_survived(&damaged);
        }
    }
    for frame in command_frames() {
        for bit in 0..8 * frame.len() {
            let mut damaged = frame.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert!(receive_commands(&[&damaged[..], &[0]].concat()).iter().all(Result::is_err));
        }
    }
}

#[test]
fn every_lost_or_doubled_byte_is_told() {
    for frame in message_frames() {
        for at in 0..frame.len() {
            let (before, after) = frame.split_at(at);
            assert_told_and_survived(&[before, &after[1..]].concat());
            // A closing zero that comes twice does no harm.
            if after[0] != 0 {
                assert_told_and_survived(&[before, &after[..1], after].concat());
            }
        }
    }
}

#[test]
fn bursts_of_damage_are_told() {
    let mut random = Random(1);
    for _ in 0..20_000 {
        let message = random.message();
        let frame = frame_of(&message);
        let mut damaged = frame.clone();
        for _ in 0..1 + random.below(6) {
            let at = random.below(damaged.len());
            damaged[at] = random.byte();
        }
        if damaged != frame {
            assert_told_and_survived(&damaged);
        }
    }
}

#[test]
fn garbage_of_any_length_ends_at_the_next_zero() {
    let mut random = Random(2);
    for len in 0..2_000 {
        let garbage = random.bytes(len);
        let message = random.message();
        let received = receive(&[&garbage[..], &[0], &frame_of(&message)].concat());
        assert_eq!(received.last(), Some(&Ok(message)));
        assert!(received.iter().rev().skip(1).all(Result::is_err));
    }
}

#[test]
fn endless_noise_is_never_a_message() {
    let mut random = Random(3);
    let mut messages = MessageReceiver::new();
    let mut commands = CommandReceiver::new();
    let mut errors = 0_u32;
    for _ in 0..4_000_000 {
        let byte = random.byte();
        for told in [
            messages.push(byte).map(|result| result.is_ok()),
            commands.push(byte).map(|result| result.is_ok()),
        ] {
            assert_ne!(told, Some(true));
            errors += u32::from(told.is_some());
        }
    }
    // A zero comes every 256 bytes, so that there is about one error in as many for each receiver.
    assert!((20_000..40_000).contains(&errors), "{errors}");
}

#[test]
fn noise_without_a_zero_is_told_once() {
    let mut random = Random(4);
    let noise: Vec<u8> = random.bytes(5_000).into_iter().filter(|byte| *byte != 0).collect();
    assert_eq!(receive(&noise), [Err(WireError::TooLong)]);
    let message = random.message();
    assert_eq!(
        receive(&[&noise[..], &[0], &frame_of(&message)].concat()),
        [Err(WireError::TooLong), Ok(message)]
    );
}

#[test]
fn a_stream_of_random_messages_arrives_whole_and_in_order() {
    let mut random = Random(5);
    let sent: Vec<Message> = (0..20_000).map(|_| random.message()).collect();
    let stream: Vec<u8> = sent.iter().flat_map(frame_of).collect();
    let received: Vec<Message> = receive(&stream).into_iter().collect::<Result<_, _>>().unwrap();
    assert_eq!(received, sent);
}

#[test]
fn a_stream_of_random_commands_arrives_whole_and_in_order() {
    let mut random = Random(6);
    let sent: Vec<Command> = (0..20_000).map(|_| random.command()).collect();
    let mut stream = Vec::new();
    for command in &sent {
        let mut frame = [0; ENCODED_MAX];
        let len = encode_command(command, &mut frame);
        // Zeros between frames are no frames.
        stream.extend(vec![0; random.below(3)]);
        stream.extend(&frame[..len]);
    }
    let received: Vec<Command> = receive_commands(&stream).into_iter().collect::<Result<_, _>>().unwrap();
    assert_eq!(received, sent);
}
