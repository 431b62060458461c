//! Wayland's wire, as far as a client needs it that shows nothing: messages of words over a socket, without descriptors.

use std::env;
use std::io::{self, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::time::Duration;

/// How long a compositor may take to answer when it is asked first.
const ANSWER_LIMIT: Duration = Duration::from_secs(1);

/// The object that every connection begins with.
pub(super) const DISPLAY: u32 = 1;

/// Bytes before a message's words: the object, the message's number and its length.
const HEADER: usize = 8;

/// A message of the compositor.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Message {
    pub(super) object: u32,
    pub(super) event: u16,
    words: Vec<u8>,
}

/// The arguments of a message that are still to be read.
pub(super) struct Words<'a>(&'a [u8]);

/// A connection to a compositor.
pub(super) struct Connection {
    socket: UnixStream,
    /// Bytes of messages that are not whole yet.
    bytes: Vec<u8>,
}

impl Connection {
    /// Connects to the compositor of the environment.
    pub(super) fn open() -> io::Result<Self> {
        let name = env::var_os("WAYLAND_DISPLAY").ok_or(io::ErrorKind::NotFound)?;
        let folder = env::var_os("XDG_RUNTIME_DIR").map(PathBuf::from).unwrap_or_default();
        // An absolute name stands alone.
        let socket = UnixStream::connect(folder.join(name))?;
        socket.set_read_timeout(Some(ANSWER_LIMIT))?;
        socket.set_write_timeout(Some(ANSWER_LIMIT))?;
        Ok(Self { socket, bytes: Vec::new() })
    }

    /// From now on reading waits for nothing.
    pub(super) fn wait_no_more(&self) -> io::Result<()> {
        self.socket.set_nonblocking(true)
    }

    /// Sends a request.
    pub(super) fn send(&mut self, object: u32, request: u16, arguments: &[u8]) -> io::Result<()> {
        let length = u16::try_from(HEADER + arguments.len()).map_err(|_| io::ErrorKind::InvalidInput)?;
        let mut message = object.to_ne_bytes().to_vec();
        message.extend((u32::from(length) << 16 | u32::from(request)).to_ne_bytes());
        message.extend(arguments);
        self.socket.write_all(&message)
    }

    /// The messages that have come; where none has it waits as long as reading may.
    ///
    /// # Errors
    /// The compositor is gone, or sends what is no message. Nothing there is no error.
    pub(super) fn receive(&mut self) -> io::Result<Vec<Message>> {
        let mut bytes = [0; 4096];
        match self.socket.read(&mut bytes) {
            Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
            Ok(count) => self.bytes.extend_from_slice(&bytes[..count]),
            Err(error)
                if matches!(
                    error.kind(),
                    io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted
                ) => {}
            Err(error) => return Err(error),
        }
        let mut messages = Vec::new();
        while let Some((message, length)) = first_message(&self.bytes)? {
            self.bytes.drain(..length);
            messages.push(message);
        }
        Ok(messages)
    }
}

/// The first message, and its length in bytes; `None` where it is not whole yet.
fn first_message(bytes: &[u8]) -> io::Result<Option<(Message, usize)>> {
    let mut header = Words(bytes);
    let (Some(object), Some(second)) = (header.number(), header.number()) else { return Ok(None) };
    let length = (second >> 16) as usize;
    if length < HEADER || !length.is_multiple_of(4) {
        return Err(io::ErrorKind::InvalidData.into());
    }
    let event = (second & 0xFFFF) as u16;
    Ok(bytes.get(HEADER..length).map(|words| (Message { object, event, words: words.to_vec() }, length)))
}

impl Message {
    pub(super) fn words(&self) -> Words<'_> {
        Words(&self.words)
    }
}

impl<'a> Words<'a> {
    pub(super) fn number(&mut self) -> Option<u32> {
        let (word, rest) = self.0.split_first_chunk::<4>()?;
        self.0 = rest;
        Some(u32::from_ne_bytes(*word))
    }

    /// An array: its length and its bytes, which fill whole words.
    pub(super) fn array(&mut self) -> Option<&'a [u8]> {
        let length = self.number()? as usize;
        let array = self.0.get(..length)?;
        self.0 = self.0.get(length.next_multiple_of(4)..)?;
        Some(array)
    }

    /// A string, which ends with a zero.
    pub(super) fn text(&mut self) -> Option<String> {
        Some(String::from_utf8_lossy(self.array()?.strip_suffix(&[0])?).into_owned())
    }
}

/// A number as an argument.
pub(super) fn number(number: u32) -> Vec<u8> {
    number.to_ne_bytes().to_vec()
}

/// A string as an argument.
pub(super) fn text(text: &str) -> Vec<u8> {
    let length = text.len() + 1;
    let mut bytes = number(length as u32);
    bytes.extend(text.as_bytes());
    bytes.resize(4 + length.next_multiple_of(4), 0);
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_read_once_they_are_whole() {
        let arguments = [number(7), text("wl_seat"), number(3)].concat();
        let length = HEADER + arguments.len();
        let mut bytes = [number(2), number((length as u32) << 16 | 5), arguments].concat();
        bytes.extend(number(9));
        for end in 0..length {
            assert_eq!(first_message(&bytes[..end]).unwrap(), None, "{end}");
        }
        let (message, taken) = first_message(&bytes).unwrap().unwrap();
        assert_eq!((message.object, message.event, taken), (2, 5, length));
        let mut words = message.words();
        assert_eq!(
            (words.number(), words.text().as_deref(), words.number()),
            (Some(7), Some("wl_seat"), Some(3))
        );
        assert_eq!(words.number(), None);
    }

    #[test]
    fn what_is_no_message_is_an_error_or_nothing() {
        for length in [0, 4, 7, 9] {
            assert!(first_message(&[number(1), number(length << 16)].concat()).is_err(), "{length}");
        }
        for words in
            [vec![], vec![0; 3], number(5), [number(3), b"abc".to_vec()].concat(), [number(0)].concat()]
        {
            assert_eq!(Words(&words).text(), None, "{words:?}");
        }
        assert_eq!(Words(&number(u32::MAX)).array(), None);
    }
}
