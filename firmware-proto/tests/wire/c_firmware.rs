//! The reference firmware on a board whose time is simulated: what it sends and when, to the microsecond.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command as Process;
use std::sync::OnceLock;

use firmware_proto::command::{AckResult, Command};
use firmware_proto::frame::Message;
use firmware_proto::link::{MessageReceiver, encode_message};
use firmware_proto::sample::{Sample, Status};
use firmware_proto::{CHANNELS, ENCODED_MAX};

use crate::c_encoder::{command_frame, hex};
use crate::sanitized::compile_plain_and_sanitized;

const CONVERSION_US: u64 = 20;

/// The firmware on its simulated board, plain and sanitized; none where there is no compiler.
fn boards() -> &'static [PathBuf] {
    static BOARDS: OnceLock<Vec<PathBuf>> = OnceLock::new();
    let sources = [
        "firmware-proto/tests/wire/c/sim_board.c",
        "firmware-proto/c/firmware/pad_firmware.c",
        "firmware-proto/c/tactpad_proto.c",
    ];
    BOARDS.get_or_init(|| compile_plain_and_sanitized("c-sim-board", &sources))
}

/// What one `run` gave.
#[derive(Debug)]
struct Run {
    messages: Vec<Message>,
    /// Switchings of the light, such as `on@2020`.
    light: Vec<String>,
    bytes_not_taken: u32,
    stalls: u32,
}

impl Run {
    fn parse(line: &str, receiver: &mut MessageReceiver) -> Self {
        let mut run = Self { messages: Vec::new(), light: Vec::new(), bytes_not_taken: 0, stalls: 0 };
        for word in line.split_whitespace() {
            if let Some((name, value)) = word.split_once('=') {
                let counter = if name == "stalls" { &mut run.stalls } else { &mut run.bytes_not_taken };
                *counter = value.parse().unwrap();
            } else if word.contains('@') {
                run.light.push(word.to_owned());
            } else {
                let bytes = word.as_bytes().chunks(2).map(|pair| str::from_utf8(pair).unwrap());
                let bytes = bytes.map(|pair| u8::from_str_radix(pair, 16).unwrap());
                run.messages.extend(bytes.filter_map(|byte| receiver.push(byte)).map(Result::unwrap));
            }
        }
        run
    }

    fn samples(&self) -> Vec<Sample> {
        let sample = |message: &Message| match message {
            Message::Sample(sample) => Some(*sample),
            _ => None,
        };
        self.messages.iter().filter_map(sample).collect()
    }

    fn replies(&self) -> Vec<Message> {
        let is_reply = |message: &&Message| !matches!(message, Message::Sample(_));
        self.messages.iter().filter(is_reply).copied().collect()
    }
}

/// Makes `calls` on a new board and hands over what each `run` gave, for every way in which the board was compiled.
fn on_boards(test: &str, rate_hz: u16, calls: &str, check: impl Fn(&[Run])) {
    for board in boards() {
        check(&runs(board, test, rate_hz, calls));
    }
}

fn runs(board: &Path, test: &str, rate_hz: u16, calls: &str) -> Vec<Run> {
    let file = board.with_extension(test);
    fs::write(&file, calls).unwrap();
    let mut process = Process::new(board);
    let output = process.arg(rate_hz.to_string()).stdin(File::open(&file).unwrap()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut receiver = MessageReceiver::new();
    let said = String::from_utf8(output.stdout).unwrap();
    said.lines().map(|line| Run::parse(line, &mut receiver)).collect()
}

fn receive(commands: &[Command]) -> String {
    let frames: Vec<u8> = commands.iter().flat_map(command_frame).collect();
    format!("receive {}\n", hex(&frames))
}

fn ack(command: u8, result: AckResult) -> Message {
    Message::Acknowledgement { command, result }
}

#[test]
fn samples_are_the_boards_and_the_first_tells_of_the_start() {
    on_boards("first", 1000, "run 5000\n", |runs| {
        let samples = runs[0].samples();
        assert_eq!(samples.len(), 5);
        for (sequence, sample) in (0..).zip(&samples) {
            let bridge_is_open = Status::OK.with_out_of_range(4);
            let expected = Sample {
                sequence,
                time_us: 1000 * u64::from(sequence) + CONVERSION_US,
                counts: std::array::from_fn(|channel| sequence as i32 * 16 - channel as i32),
                temperature_centi_c: -123,
                status: if sequence == 0 { bridge_is_open.with_restarted() } else { bridge_is_open },
            };
            assert_eq!(*sample, expected);
        }
        assert_eq!(runs[0].light, ["off@0"]);
    });
}

#[test]
fn no_rate_drifts() {
    for rate_hz in [100, 300, 999, 1000, 3333, 7001, 7999, 8000] {
        on_boards(&format!("drift-{rate_hz}"), rate_hz, "run 3000000\n", |runs| {
            let samples = runs[0].samples();
            assert_eq!(samples.len(), 3 * usize::from(rate_hz));
            for (number, sample) in (0..).zip(&samples) {
                let due_us = number * 1_000_000 / u64::from(rate_hz);
                assert_eq!(sample.time_us, due_us + CONVERSION_US, "sample {number} at {rate_hz} Hz");
            }
        });
    }
}

#[test]
fn a_rate_that_is_none_becomes_the_slowest() {
    for rate_hz in [0, 99, 8001] {
        on_boards(&format!("none-{rate_hz}"), rate_hz, "run 1000000\n", |runs| {
            assert_eq!(runs[0].samples().len(), 100);
        });
    }
}

#[test]
fn it_tells_who_it_is() {
    let set = Command::SetRate { rate_hz: 250 };
    let calls = format!("{}run 2000\n", receive(&[Command::Identify, set, Command::Identify]));
    on_boards("identity", 1000, &calls, |runs| {
        let [Message::Identity(before), set, Message::Identity(after)] = runs[0].replies()[..] else {
            panic!("{runs:?}");
        };
        assert_eq!(before.serial_number.as_str(), "SIM-0001");
        assert_eq!((before.channels, before.count_bits, before.rate_hz), (CHANNELS as u8, 24, 1000));
        assert_eq!(before.picovolts_per_count, 2384);
        assert_eq!(set, ack(0x82, AckResult::Done));
        assert_eq!(after.rate_hz, 250);
    });
}

#[test]
fn a_new_rate_counts_from_the_next_sample_on() {
    for (rate_hz, result) in [
        (99, AckResult::Refused),
        (100, AckResult::Done),
        (8000, AckResult::Done),
        (8001, AckResult::Refused),
    ] {
        let calls = format!("run 3000\n{}run 1003000\n", receive(&[Command::SetRate { rate_hz }]));
        on_boards(&format!("rate-{rate_hz}"), 1000, &calls, |runs| {
            assert_eq!(runs[1].replies(), [ack(0x82, result)]);
            let rate_hz = if result == AckResult::Done { u64::from(rate_hz) } else { 1000 };
            let samples = runs[1].samples();
            // The command is read after the sample at 3000 µs, when the one at 4000 µs is set.
            let expected =
                |number| if number == 0 { 3000 } else { 4000 + (number - 1) * 1_000_000 / rate_hz };
            for (number, sample) in (0..).zip(&samples) {
                assert_eq!(sample.time_us, expected(number) + CONVERSION_US, "sample {number}");
                assert_eq!(u64::from(sample.sequence), 3 + number);
            }
            assert!(samples.len() as u64 >= 999 * rate_hz / 1000);
        });
    }
}

#[test]
fn the_light_shines_as_long_as_it_is_told() {
    let blink = |duration_ms| receive(&[Command::Blink { duration_ms }]);
    let calls = format!("{}run 10000\n{}run 20000\n{}run 30000\n", blink(5), blink(500), blink(0));
    on_boards("light", 1000, &calls, |runs| {
        let done = [ack(0x83, AckResult::Done)];
        assert!(runs.iter().all(|run| run.replies() == done));
        // Commands are read after a conversion; the light is looked at after each.
        assert_eq!(runs[0].light, ["off@0", "on@20", "off@5020"]);
        assert_eq!(runs[1].light, ["on@10020"]);
        assert_eq!(runs[2].light, ["off@20020"]);
    });
}

#[test]
fn strangers_are_answered_and_damage_is_not() {
    let mut stranger = [0; ENCODED_MAX];
    let len = encode_message(&ack(0x81, AckResult::Done), &mut stranger);
    let mut damaged = command_frame(&Command::Identify);
    damaged[2] ^= 0x10;
    let bytes = [&damaged[..], &[0xFE; 300], &[0], &stranger[..len]].concat();
    let calls = format!("receive {}\nrun 20000\n", hex(&bytes));
    on_boards("strangers", 1000, &calls, |runs| {
        assert_eq!(runs[0].replies(), [ack(0x03, AckResult::Unknown)]);
    });
}

#[test]
fn a_flood_of_commands_stops_no_sample() {
    let calls = format!("{}run 200000\n", receive(&[Command::Identify; 500]));
    on_boards("flood", 1000, &calls, |runs| {
        let times: Vec<u64> = runs[0].samples().iter().map(|sample| sample.time_us).collect();
        assert_eq!(times, (0..200).map(|number| number * 1000 + CONVERSION_US).collect::<Vec<_>>());
        assert_eq!((runs[0].replies().len(), runs[0].bytes_not_taken), (500, 0));
    });
}

#[test]
fn a_full_link_loses_whole_samples_and_counts_their_bytes() {
    // The link takes two samples and a half, then nothing for a while, then everything.
    let calls = "run 1000\nroom 150\nrun 20000\nroom 4294967295\nrun 30000\n";
    on_boards("full", 1000, calls, |runs| {
        let parts = runs.iter().flat_map(Run::samples).collect::<Vec<_>>();
        let sequences: Vec<u32> = parts.iter().map(|sample| sample.sequence).collect();
        // Of 19 samples two and a half went out, and the outbox of 240 bytes kept the rest of the third and
        // three more.
        let sent: Vec<u32> = (0..7).chain(20..30).collect();
        assert_eq!(sequences, sent, "no frame was damaged on the way");
        assert_eq!(runs[1].bytes_not_taken, 13 * 60);
        assert_eq!(runs[2].bytes_not_taken, 13 * 60);
        let newest = parts.last().unwrap();
        assert_eq!(newest.time_us, 29_000 + CONVERSION_US, "it never waited");
    });
}

#[test]
fn short_delays_are_made_up_for_and_long_ones_are_not() {
    let calls = "run 10000\nstall 100000\nrun 200000\nstall 200000\nrun 500000\n";
    on_boards("stall", 1000, calls, |runs| {
        assert_eq!(runs[1].samples().len(), 190, "every period of the first stall");
        assert_eq!(runs[1].stalls, 0);
        let times: Vec<u64> = runs[2].samples().iter().map(|sample| sample.time_us).collect();
        assert_eq!(runs[2].stalls, 1);
        assert!(times[0] >= 399_000 && times.len() <= 102, "{times:?}");
        assert!(times.windows(2).all(|pair| pair[1] - pair[0] == 1000));
    });
}
