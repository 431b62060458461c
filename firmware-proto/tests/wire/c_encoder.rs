//! The C code for firmware and this crate write the same bytes and understand the same commands.

use std::fmt::Write;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command as Process;
use std::sync::OnceLock;

use firmware_proto::ENCODED_MAX;
use firmware_proto::channels::ChannelSample;
use firmware_proto::command::{AckResult, Command};
use firmware_proto::contact::ContactSample;
use firmware_proto::frame::{Message, WireError};
use firmware_proto::hid;
use firmware_proto::link::{CommandReceiver, encode_command, encode_message};
use firmware_proto::sample::{Sample, Status};

use crate::random::Random;
use crate::sanitized::compile_plain_and_sanitized;
use crate::vectors::{all_messages, command_frames, message_frames, refused_frames};

/// The driver, plain and sanitized, compiled once; none where there is no compiler.
fn drivers() -> &'static [PathBuf] {
    static DRIVERS: OnceLock<Vec<PathBuf>> = OnceLock::new();
    let sources = ["firmware-proto/tests/wire/c/driver.c", "firmware-proto/c/tactpad_proto.c"];
    DRIVERS.get_or_init(|| compile_plain_and_sanitized("c-driver", &sources))
}

/// What the driver says to `calls`, one line each.
fn answers(driver: &Path, test: &str, calls: &str) -> Vec<String> {
    let file = driver.with_extension(test);
    fs::write(&file, calls).unwrap();
    let output = Process::new(driver).stdin(File::open(&file).unwrap()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap().lines().map(|line| line.trim_end().to_owned()).collect()
}

/// Asks both drivers and compares line by line.
fn assert_answers(test: &str, calls_and_answers: &[(String, String)]) {
    let calls: String = calls_and_answers.iter().map(|(call, _)| format!("{call}\n")).collect();
    for driver in drivers() {
        let answers = answers(driver, test, &calls);
        assert_eq!(answers.len(), calls_and_answers.len());
        for ((call, expected), answer) in calls_and_answers.iter().zip(answers) {
            assert_eq!(*expected, answer, "{call}");
        }
    }
}

pub(crate) fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        write!(text, "{byte:02x}").unwrap();
        text
    })
}

/// The driver's call that encodes `message`, and the frame and report that this crate makes of it.
fn encoding(message: &Message) -> (String, String) {
    let call = match message {
        Message::Sample(sample) => {
            let counts = sample.counts.map(|count| count.to_string()).join(" ");
            let Sample { sequence, time_us, temperature_centi_c, status: Status(status), .. } = sample;
            format!("sample {sequence} {time_us} {counts} {temperature_centi_c} {status}")
        }
        Message::Channels(sample) => {
            let counts: String = sample.counts().iter().map(|count| format!(" {count}")).collect();
            let (channels, Status(status)) = (sample.counts().len(), sample.status());
            let ChannelSample { sequence, time_us, temperature_centi_c, .. } = sample;
            format!("channels {sequence} {time_us} {channels} {temperature_centi_c} {status}{counts}")
        }
        Message::Contact(sample) => {
            let ([x, y], [fx, fy, fz]) = (sample.place_um, sample.force_mn);
            let ContactSample { sequence, time_us, is_touched, has_shear, status: Status(status), .. } =
                sample;
            let ContactSample { place_deviation_um, shear_deviation_mn, normal_deviation_mn, .. } = sample;
            format!(
                "contact {sequence} {time_us} {x} {y} {fx} {fy} {fz} {place_deviation_um} {shear_deviation_mn} \
                 {normal_deviation_mn} {} {} {status}",
                u8::from(*is_touched),
                u8::from(*has_shear)
            )
        }
        Message::Identity(identity) => format!(
            "identity ={} {} {} {} {}",
            identity.serial_number,
            identity.channels,
            identity.count_bits,
            identity.rate_hz,
            identity.picovolts_per_count
        ),
        Message::Acknowledgement { command, result } => {
            let results = [AckResult::Done, AckResult::Refused, AckResult::Unknown];
            let byte = results.iter().position(|known| known == result).unwrap();
            format!("acknowledgement {command} {byte}")
        }
    };
    let mut frame = [0; ENCODED_MAX];
    let len = encode_message(message, &mut frame);
    (call, format!("{} {}", hex(&frame[..len]), hex(&hid::encode_message(message))))
}

/// What a pad was told, in the driver's words.
fn told(result: &Result<Command, WireError>) -> String {
    let command = |kind: u8, value: u16| format!("command:{kind:02x}:{value}");
    match *result {
        Ok(Command::Identify) => command(0x81, 0),
        Ok(Command::SetRate { rate_hz }) => command(0x82, rate_hz),
        Ok(Command::Blink { duration_ms }) => command(0x83, duration_ms),
        Ok(Command::SetOutput { output }) => command(0x84, output),
        Err(WireError::Damaged) => "damaged".into(),
        Err(WireError::TooLong) => "too_long".into(),
        Err(WireError::UnknownKind(kind)) => format!("unknown_kind:{kind:02x}"),
        Err(WireError::NewerVersion(_)) => "newer_version".into(),
    }
}

/// The driver's call for each part of a stream of bytes, and what this crate's receiver tells of it.
fn receiving(parts: &[Vec<u8>]) -> Vec<(String, String)> {
    let mut receiver = CommandReceiver::new();
    let call = |part: &Vec<u8>| {
        let told: Vec<String> =
            part.iter().filter_map(|byte| receiver.push(*byte)).map(|result| told(&result)).collect();
        (format!("bytes {}", hex(part)), told.join(" "))
    };
    parts.iter().map(call).collect()
}

pub(crate) fn command_frame(command: &Command) -> Vec<u8> {
    let mut frame = [0; ENCODED_MAX];
    let len = encode_command(command, &mut frame);
    frame[..len].to_vec()
}

#[test]
fn golden_messages_are_encoded_alike() {
    let calls: Vec<_> = all_messages().iter().map(encoding).collect();
    assert_eq!(calls.len(), 21);
    assert_answers("golden", &calls);
}

#[test]
fn random_messages_are_encoded_alike() {
    let mut random = Random(20);
    let mut messages: Vec<_> = (0..5_000).map(|_| random.message()).collect();
    let mut undefined_bits = random.sample();
    undefined_bits.status = Status(u16::MAX);
    messages.push(Message::Sample(undefined_bits));
    assert_answers("random", &messages.iter().map(encoding).collect::<Vec<_>>());
}

#[test]
fn golden_frames_are_received_alike() {
    // A pad understands the commands, calls messages of other pads unknown, and sees through damage.
    let parts = [command_frames(), message_frames(), refused_frames(), command_frames()].concat();
    let calls = receiving(&parts);
    let saying = |word: &str| calls.iter().filter(|(_, told)| told.starts_with(word)).count();
    assert_eq!((saying("command"), saying("too_long"), saying("newer_version")), (19, 1, 2));
    assert_answers("received", &calls);
}

/// A frame that may be damaged: bytes changed, lost or doubled; or noise, with few zeros or many.
fn rough_bytes(random: &mut Random) -> Vec<u8> {
    let mut bytes = match random.below(8) {
        0 => {
            let len = random.below(600);
            random.bytes(len)
        }
        1 => {
            let len = 240 + random.below(30);
            let mut long: Vec<u8> = random.bytes(len).into_iter().map(|byte| byte | 0x80).collect();
            long.push(0);
            long
        }
        _ => command_frame(&random.command()),
    };
    let at = random.below(bytes.len().max(1));
    match random.below(6) {
        0 => bytes.truncate(at),
        1 if !bytes.is_empty() => bytes[at] = random.byte(),
        2 if !bytes.is_empty() => bytes.insert(at, bytes[at]),
        _ => {}
    }
    bytes
}

#[test]
fn rough_streams_are_received_alike() {
    let mut random = Random(21);
    let parts: Vec<_> = (0..20_000).map(|_| rough_bytes(&mut random)).collect();
    let calls = receiving(&parts);
    for word in ["command:81", "command:82", "command:83", "command:84", "damaged", "too_long"] {
        assert!(calls.iter().filter(|(_, told)| told.contains(word)).count() > 100, "{word}");
    }
    assert_answers("rough", &calls);
}

#[test]
fn receivers_give_up_at_the_same_byte() {
    let longest = 254;
    let parts: Vec<Vec<u8>> =
        (longest - 2..longest + 3).map(|len| [vec![0xFE; len], vec![0]].concat()).collect();
    let calls = receiving(&parts);
    let told: Vec<_> = calls.iter().map(|(_, told)| told.as_str()).collect();
    assert_eq!(told, ["damaged", "damaged", "damaged", "too_long", "too_long"]);
    assert_answers("limit", &calls);
}

#[test]
fn reports_are_decoded_alike() {
    let mut random = Random(22);
    let mut reports: Vec<Vec<u8>> = Vec::new();
    for _ in 0..5_000 {
        let mut report = hid::encode_command(&random.command()).to_vec();
        match random.below(4) {
            0 => report[random.below(5)] = random.byte(),
            1 => report.truncate(random.below(hid::REPORT_LEN)),
            2 => report.push(0),
            _ => report[5..].fill(random.byte()),
        }
        reports.push(report);
    }
    let call = |report: &Vec<u8>| {
        (format!("report {}", hex(report)).trim_end().to_owned(), told(&hid::decode_command(report)))
    };
    assert_answers("reports", &reports.iter().map(call).collect::<Vec<_>>());
}

#[test]
fn the_descriptor_is_the_same() {
    assert_answers("descriptor", &[("descriptor".into(), hex(hid::REPORT_DESCRIPTOR))]);
}
