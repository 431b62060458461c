//! The golden frames of `vectors/`, both ways. They were made by another implementation, in Python.

use std::str::FromStr;

use firmware_proto::ENCODED_MAX;
use firmware_proto::channels::ChannelSample;
use firmware_proto::command::{AckResult, Command};
use firmware_proto::contact::ContactSample;
use firmware_proto::frame::{Message, WireError};
use firmware_proto::hid;
use firmware_proto::identity::{Identity, SerialNumber};
use firmware_proto::link::{CommandReceiver, MessageReceiver, encode_command, encode_message};
use firmware_proto::sample::{Sample, Status};

const SAMPLES: &str = include_str!("../../vectors/samples.txt");
const OTHERS: &str = include_str!("../../vectors/few_channels_and_contacts.txt");
const REPLIES: &str = include_str!("../../vectors/replies.txt");
const COMMANDS: &str = include_str!("../../vectors/commands.txt");
const REFUSED: &str = include_str!("../../vectors/refused.txt");

/// One block of a file: what it means and its bytes.
pub(crate) struct Vector {
    meaning: String,
    body: Vec<u8>,
    pub(crate) frame: Vec<u8>,
}

impl Vector {
    fn parse(block: &str) -> Option<Self> {
        let mut vector = Self { meaning: String::new(), body: Vec::new(), frame: Vec::new() };
        let joined = block.replace("\n ", " ");
        for line in joined.lines().filter(|line| !line.starts_with('#')) {
            match line.split_once(' ') {
                Some(("body", bytes)) => vector.body = hex(bytes),
                Some(("frame", bytes)) => vector.frame = hex(bytes),
                _ => vector.meaning = line.to_string(),
            }
        }
        (!vector.meaning.is_empty()).then_some(vector)
    }

    fn name(&self) -> &str {
        self.meaning.split(' ').next().unwrap()
    }

    /// The text after `key=`.
    fn field(&self, key: &str) -> &str {
        let fields = self.meaning.split(' ').filter_map(|part| part.split_once('='));
        fields.filter(|(name, _)| *name == key).map(|(_, value)| value).next().unwrap()
    }

    fn number<T: FromStr<Err: std::fmt::Debug>>(&self, key: &str) -> T {
        self.field(key).parse().unwrap()
    }

    fn list<T: FromStr<Err: std::fmt::Debug>>(&self, key: &str) -> Vec<T> {
        self.field(key).split(',').map(|number| number.parse().unwrap()).collect()
    }

    fn hex_number(&self, key: &str) -> u16 {
        u16::from_str_radix(self.field(key).strip_prefix("0x").unwrap(), 16).unwrap()
    }

    fn message(&self) -> Message {
        match self.name() {
            "sample" => Message::Sample(self.sample()),
            "channels" => Message::Channels(self.few_channels()),
            "contact" => Message::Contact(self.contact()),
            "identity" => Message::Identity(self.identity()),
            "acknowledgement" => Message::Acknowledgement {
                command: self.hex_number("command") as u8,
                result: match self.field("result") {
                    "done" => AckResult::Done,
                    "refused" => AckResult::Refused,
                    "unknown" => AckResult::Unknown,
                    other => panic!("result {other}"),
                },
            },
            other => panic!("message {other}"),
        }
    }

    fn sample(&self) -> Sample {
        let counts = self.list("counts");
        Sample {
            sequence: self.number("sequence"),
            time_us: self.number("time_us"),
            counts: counts.try_into().unwrap(),
            temperature_centi_c: self.number("temperature_centi_c"),
            status: Status(self.hex_number("status")),
        }
    }

    fn few_channels(&self) -> ChannelSample {
        let status = Status(self.hex_number("status"));
        let counts = self.list("counts");
        let sample =
            ChannelSample::new(self.number("sequence"), self.number("time_us"), &counts, status).unwrap();
        if status.temperature_invalid() {
            sample
        } else {
            sample.with_temperature(self.number("temperature_centi_c"))
        }
    }

    fn contact(&self) -> ContactSample {
        let [place_deviation_um, shear_deviation_mn, normal_deviation_mn] =
            self.list("deviations").try_into().unwrap();
        ContactSample {
            sequence: self.number("sequence"),
            time_us: self.number("time_us"),
            place_um: self.list("place_um").try_into().unwrap(),
            force_mn: self.list("force_mn").try_into().unwrap(),
            place_deviation_um,
            shear_deviation_mn,
            normal_deviation_mn,
            is_touched: self.field("touched") == "1",
            has_shear: self.field("shear") == "1",
            status: Status(self.hex_number("status")),
        }
    }

    fn identity(&self) -> Identity {
        Identity {
            serial_number: SerialNumber::from_ascii(self.field("serial_number")).unwrap(),
            channels: self.number("channels"),
            count_bits: self.number("count_bits"),
            rate_hz: self.number("rate_hz"),
            picovolts_per_count: self.number("picovolts_per_count"),
        }
    }

    fn command(&self) -> Command {
        match self.name() {
            "identify" => Command::Identify,
            "set_rate" => Command::SetRate { rate_hz: self.number("rate_hz") },
            "blink" => Command::Blink { duration_ms: self.number("duration_ms") },
            "set_output" => Command::SetOutput { output: self.number("output") },
            other => panic!("command {other}"),
        }
    }

    fn error(&self) -> WireError {
        let number = |text: &str| text.parse().unwrap();
        match self.meaning.split_once(' ') {
            None if self.meaning == "damaged" => WireError::Damaged,
            None if self.meaning == "too_long" => WireError::TooLong,
            Some(("unknown_kind", kind)) => {
                WireError::UnknownKind(u8::from_str_radix(kind.strip_prefix("0x").unwrap(), 16).unwrap())
            }
            Some(("newer_version", version)) => WireError::NewerVersion(number(version)),
            _ => panic!("error {}", self.meaning),
        }
    }

    fn report(&self, report_id: u8) -> Vec<u8> {
        let mut report = vec![report_id];
        report.extend(&self.body);
        report.resize(hid::REPORT_LEN, 0);
        report
    }
}

pub(crate) fn hex(text: &str) -> Vec<u8> {
    text.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect()
}

fn vectors(text: &str) -> Vec<Vector> {
    text.split("\n\n").filter_map(Vector::parse).collect()
}

/// Every golden message from a pad.
pub(crate) fn all_messages() -> Vec<Message> {
    [SAMPLES, OTHERS, REPLIES].into_iter().flat_map(vectors).map(|vector| vector.message()).collect()
}

/// Every golden frame from a pad.
pub(crate) fn message_frames() -> Vec<Vec<u8>> {
    [SAMPLES, OTHERS, REPLIES].into_iter().flat_map(vectors).map(|vector| vector.frame).collect()
}

/// Every golden frame from a host.
pub(crate) fn command_frames() -> Vec<Vec<u8>> {
    vectors(COMMANDS).into_iter().map(|vector| vector.frame).collect()
}

/// Every golden frame that no host may take for a message.
pub(crate) fn refused_frames() -> Vec<Vec<u8>> {
    vectors(REFUSED).into_iter().map(|vector| vector.frame).collect()
}

#[test]
fn messages_both_ways() {
    let vectors: Vec<_> = [SAMPLES, OTHERS, REPLIES].into_iter().flat_map(vectors).collect();
    assert_eq!(vectors.len(), 21);
    let mut receiver = MessageReceiver::new();
    for vector in vectors {
        let message = vector.message();
        let mut frame = [0xAA; ENCODED_MAX];
        let len = encode_message(&message, &mut frame);
        assert_eq!(frame[..len], vector.frame, "{}", vector.meaning);
        let received: Vec<_> = vector.frame.iter().filter_map(|byte| receiver.push(*byte)).collect();
        assert_eq!(received, [Ok(message)]);

        let report = vector.report(hid::MESSAGE_REPORT_ID);
        assert_eq!(hid::encode_message(&message).as_slice(), report, "{}", vector.meaning);
        assert_eq!(hid::decode_message(&report), Ok(message));
    }
}

#[test]
fn commands_both_ways() {
    let vectors = vectors(COMMANDS);
    assert_eq!(vectors.len(), 9);
    let mut receiver = CommandReceiver::new();
    for vector in vectors {
        let command = vector.command();
        let mut frame = [0xAA; ENCODED_MAX];
        let len = encode_command(&command, &mut frame);
        assert_eq!(frame[..len], vector.frame, "{}", vector.meaning);
        let received: Vec<_> = vector.frame.iter().filter_map(|byte| receiver.push(*byte)).collect();
        assert_eq!(received, [Ok(command)]);
        assert_eq!(command.kind(), vector.body[1]);

        let report = vector.report(hid::COMMAND_REPORT_ID);
        assert_eq!(hid::encode_command(&command).as_slice(), report, "{}", vector.meaning);
        assert_eq!(hid::decode_command(&report), Ok(command));
    }
}

#[test]
fn refused_frames_tell_why_and_leave_the_receiver_sound() {
    let vectors = vectors(REFUSED);
    assert_eq!(vectors.len(), 24);
    let good = &message_frames()[0];
    let mut receiver = MessageReceiver::new();
    for vector in vectors {
        let received: Vec<_> = vector.frame.iter().filter_map(|byte| receiver.push(*byte)).collect();
        assert_eq!(received, [Err(vector.error())], "{:02x?}", vector.frame);
        assert!(matches!(good.iter().find_map(|byte| receiver.push(*byte)), Some(Ok(_))));
    }
}
