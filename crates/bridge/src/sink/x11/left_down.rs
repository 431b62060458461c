//! What bridges that were killed left down on X servers: found, and lifted.

use std::fmt;
use std::io;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::Duration;

use x11rb::errors::{ConnectError, ConnectionError, ReplyError};
use x11rb::protocol::xinput::{ConnectionExt as _, InputStateData};
use x11rb::protocol::xproto::{BUTTON_RELEASE_EVENT, KEY_RELEASE_EVENT};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;

use super::held_record::{Content, Down, FoundRecord, records};
use tactpad_core::pipeline::control::Code;
use tactpad_core::pipeline::control::names::POINTER_BUTTONS;

/// A server is waited for so long.
const ANSWER_LIMIT: Duration = Duration::from_secs(1);

/// The server's first number of a key; the kernel's is so much lower.
const FIRST_KEY: u8 = 8;

/// What becomes of what was left down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Treatment {
    /// It is only told.
    Look,
    /// It is released, and its records are removed.
    Lift,
}

/// Something that a killed bridge left.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LeftDown {
    /// These keys and buttons are down, or were until they were lifted.
    Held {
        /// The X display.
        display: String,
        /// In the order of their numbers; not empty.
        codes: Vec<Code>,
    },
    /// The display does not answer, so nothing is known, and nothing was lifted.
    Unanswered {
        /// The X display.
        display: String,
        /// What the record says.
        codes: Vec<Code>,
    },
    /// The record says nothing.
    Damaged {
        /// Its file.
        path: PathBuf,
    },
}

impl fmt::Display for LeftDown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = |codes: &[Code]| codes.iter().map(Code::to_string).collect::<Vec<_>>().join(", ");
        match self {
            Self::Held { display, codes } => {
                write!(f, "a bridge that was killed left {} down on X display {display}", names(codes))
            }
            Self::Unanswered { display, codes } => write!(
                f,
                "a bridge that was killed may have left {} down on X display {display}, which does not answer: run this \
                 again where it does",
                names(codes)
            ),
            Self::Damaged { path } => write!(
                f,
                "{} should say what a killed bridge left down, and is damaged: a key that hangs comes up when the pad \
                 plays it once more",
                path.display()
            ),
        }
    }
}

/// What bridges left down that were killed and had their records in `folder`. What a living bridge holds, and what people hold
/// on a keyboard of their own, stays as it is. A server that does not answer is waited for only a little.
pub fn left_down(folder: &Path, treatment: Treatment) -> Vec<LeftDown> {
    let (living, dead): (Vec<_>, Vec<_>) = records(folder).into_iter().partition(|record| record.is_alive);
    let living: Vec<Content> = living.into_iter().filter_map(|record| record.content).collect();
    let (mut left, mut asked) = (Vec::new(), Vec::new());
    for mut record in dead {
        let Some(content) = record.content.take() else {
            left.push(LeftDown::Damaged { path: record.path.clone() });
            removed(record, treatment);
            continue;
        };
        let of_living = |number: &u8| {
            living.iter().any(|other| other.display == content.display && other.down.contains(number))
        };
        let suspects: Down = content.down.iter().copied().filter(|number| !of_living(number)).collect();
        if suspects.is_empty() {
            removed(record, treatment);
        } else {
            asked.push(ask_aside(record, content.display, suspects, treatment));
        }
    }
    left.extend(asked.into_iter().filter_map(|Asked { if_unanswered, answer }| {
        answer.recv_timeout(ANSWER_LIMIT).unwrap_or(Some(if_unanswered))
    }));
    left
}

fn removed(record: FoundRecord, treatment: Treatment) {
    if treatment == Treatment::Lift {
        record.remove();
    }
}

/// A server that was asked.
struct Asked {
    if_unanswered: LeftDown,
    answer: Receiver<Option<LeftDown>>,
}

/// Asks the server on a thread of its own, which goes on when nobody waits for it any more.
fn ask_aside(record: FoundRecord, display: String, suspects: Down, treatment: Treatment) -> Asked {
    let (tell, answer) = channel();
    let codes = suspects.iter().copied().map(code).collect();
    let if_unanswered = LeftDown::Unanswered { display: display.clone(), codes };
    let unanswered = if_unanswered.clone();
    // Where there is no thread to be had, nobody answers.
    let _ = thread::Builder::new().spawn(move || {
        // Who only looks keeps no lock, by which others would take the bridge for a living one.
        let record = (treatment == Treatment::Lift).then_some(record);
        let answered = match down_on(&display, &suspects, treatment) {
            Ok(held) => {
                if let Some(record) = record {
                    record.remove();
                }
                let codes: Vec<Code> = held.into_iter().map(code).collect();
                (!codes.is_empty()).then_some(LeftDown::Held { display, codes })
            }
            Err(_) => Some(unanswered),
        };
        let _ = tell.send(answered);
    });
    Asked { if_unanswered, answer }
}

/// Which of the suspects are down on the server; they are released if that is asked for.
///
/// # Errors
/// It does not let us in, or does not answer.
fn down_on(display: &str, suspects: &Down, treatment: Treatment) -> Result<Down, ReplyError> {
    use io::ErrorKind::{ConnectionRefused, NotFound};
    let connection = match x11rb::connect(Some(display)) {
        Ok((connection, _)) => connection,
        // The server is gone, and with it what was held there.
        Err(ConnectError::IoError(error)) if matches!(error.kind(), ConnectionRefused | NotFound) => {
            return Ok(Down::new());
        }
        Err(_) => return Err(ConnectionError::UnknownError.into()),
    };
    let held: Down = injected(&connection)?.intersection(suspects).copied().collect();
    if treatment == Treatment::Lift {
        for number in &held {
            let kind = if *number < FIRST_KEY { BUTTON_RELEASE_EVENT } else { KEY_RELEASE_EVENT };
            connection.xtest_fake_input(kind, *number, x11rb::CURRENT_TIME, x11rb::NONE, 0, 0, 0)?;
        }
        connection.sync()?;
    }
    Ok(held)
}

/// What programs hold on the server, apart from what people do: a server has devices of its own for programs.
fn injected(connection: &RustConnection) -> Result<Down, ReplyError> {
    let listed = connection.xinput_list_input_devices()?.reply()?;
    let mut down = Down::new();
    for (device, name) in listed.devices.iter().zip(&listed.names) {
        if !name.name.windows(5).any(|part| part == b"XTEST") {
            continue;
        }
        let state = connection.xinput_query_device_state(device.device_id)?.reply()?;
        for class in state.classes {
            match class.data {
                InputStateData::Key(keys) => down.extend(numbers(&keys.keys, FIRST_KEY..=u8::MAX)),
                InputStateData::Button(buttons) => down.extend(numbers(&buttons.buttons, 1..=FIRST_KEY - 1)),
                _ => {}
            }
        }
    }
    Ok(down)
}

/// The numbers within `range` whose bits are set.
fn numbers(bits: &[u8; 32], range: RangeInclusive<u8>) -> impl Iterator<Item = u8> {
    let is_set =
        |number: &u8| bits.get(usize::from(number / 8)).is_some_and(|byte| byte >> (number % 8) & 1 == 1);
    range.filter(is_set)
}

/// The kernel's name of what the server gives this number.
fn code(number: u8) -> Code {
    let [left, right, middle] = POINTER_BUTTONS;
    match number {
        1 => left,
        2 => middle,
        number if number < FIRST_KEY => right,
        number => Code::Key(u16::from(number - FIRST_KEY)),
    }
}
