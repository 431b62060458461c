//! The capture: every call made on the pipeline, so that a replay makes the same calls and gets the same events.
//!
//! Form, integers little-endian: the line `tactpad capture 1\n`, then one entry per call: kind (u8), host time in
//! nanoseconds (u64), length of what follows (u32), and that many bytes. A recorder that was killed leaves a file
//! whose last entry may be cut off; everything before it is sound.

use std::fmt;
use std::io::{self, Read, Write};

use crate::time::HostInstant;

const MAGIC: &[u8] = b"tactpad capture 1\n";

/// Longer entries are not written by any recorder.
const ENTRY_BYTES_MAX: u32 = 1 << 20;

/// One call on the pipeline.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Call {
    /// Host time of the call.
    pub now: HostInstant,
    /// What was called.
    pub kind: CallKind,
}

/// What was called.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CallKind {
    /// Bytes came from the pad.
    Bytes(Vec<u8>),
    /// A deadline passed.
    Timeout,
    /// The pad was unplugged.
    Unplugged,
    /// The player paused.
    Pause,
    /// The player went on.
    Resume,
    /// Everything was to be released.
    ReleaseAll,
    /// The zero was to be measured again.
    Retare,
    /// Another profile, as its TOML text, for the output it names; the first call of a capture.
    Profile(String),
    /// The same, for the keyboard whatever output it names.
    KeyboardProfile(String),
}

/// Why a capture cannot be read.
#[derive(Debug)]
pub enum CaptureError {
    /// It does not begin like one.
    NotACapture,
    /// An entry is of no known kind, impossibly long, or carries bytes where its kind has none: the file is damaged,
    /// or from a newer program.
    Damaged {
        /// Byte offset of the entry.
        offset: u64,
    },
    /// The file ends inside an entry; all entries before it were given.
    CutOff {
        /// Byte offset of the entry.
        offset: u64,
    },
    /// The file cannot be read.
    Io(io::Error),
}

impl fmt::Display for CaptureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotACapture => f.write_str("is not a capture; make one with `tactpad record FILE`"),
            Self::Damaged { offset } => {
                write!(f, "is damaged at byte {offset}, or written by a newer tactpad")
            }
            Self::CutOff { offset } => write!(f, "is cut off at byte {offset}; everything before was used"),
            Self::Io(error) => write!(f, "cannot be read: {error}"),
        }
    }
}

impl std::error::Error for CaptureError {}

/// Writes calls as they are made.
#[derive(Debug)]
pub struct CaptureWriter<W: Write> {
    to: W,
}

impl<W: Write> CaptureWriter<W> {
    /// Begins a capture.
    ///
    /// # Errors
    /// The beginning cannot be written.
    pub fn new(mut to: W) -> io::Result<Self> {
        to.write_all(MAGIC)?;
        Ok(Self { to })
    }

    /// Adds one call.
    ///
    /// # Errors
    /// The call cannot be written.
    pub fn write(&mut self, now: HostInstant, call: CallRef<'_>) -> io::Result<()> {
        let bytes = call.payload();
        self.to.write_all(&[call.kind()])?;
        self.to.write_all(&now.as_ns().to_le_bytes())?;
        self.to.write_all(&(bytes.len() as u32).to_le_bytes())?;
        self.to.write_all(bytes)
    }

    /// Hands everything written so far to the file.
    ///
    /// # Errors
    /// The file does not take it.
    pub fn flush(&mut self) -> io::Result<()> {
        self.to.flush()
    }
}

/// A call as it is made, borrowing what it carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CallRef<'a> {
    /// See [`CallKind::Bytes`].
    Bytes(&'a [u8]),
    /// See [`CallKind::Timeout`].
    Timeout,
    /// See [`CallKind::Unplugged`].
    Unplugged,
    /// See [`CallKind::Pause`].
    Pause,
    /// See [`CallKind::Resume`].
    Resume,
    /// See [`CallKind::ReleaseAll`].
    ReleaseAll,
    /// See [`CallKind::Retare`].
    Retare,
    /// See [`CallKind::Profile`].
    Profile(&'a str),
    /// See [`CallKind::KeyboardProfile`].
    KeyboardProfile(&'a str),
}

impl CallRef<'_> {
    const fn kind(self) -> u8 {
        match self {
            Self::Bytes(_) => 0,
            Self::Timeout => 1,
            Self::Unplugged => 2,
            Self::Pause => 3,
            Self::Resume => 4,
            Self::ReleaseAll => 5,
            Self::Retare => 6,
            Self::Profile(_) => 7,
            Self::KeyboardProfile(_) => 8,
        }
    }

    const fn payload(&self) -> &[u8] {
        match self {
            Self::Bytes(bytes) => bytes,
            Self::Profile(text) | Self::KeyboardProfile(text) => text.as_bytes(),
            _ => &[],
        }
    }
}

impl CallKind {
    fn from_entry(kind: u8, bytes: Vec<u8>) -> Option<Self> {
        let carries_bytes = matches!(kind, 0 | 7 | 8);
        if !carries_bytes && !bytes.is_empty() {
            return None;
        }
        match kind {
            0 => Some(Self::Bytes(bytes)),
            1 => Some(Self::Timeout),
            2 => Some(Self::Unplugged),
            3 => Some(Self::Pause),
            4 => Some(Self::Resume),
            5 => Some(Self::ReleaseAll),
            6 => Some(Self::Retare),
            7 => String::from_utf8(bytes).ok().map(Self::Profile),
            8 => String::from_utf8(bytes).ok().map(Self::KeyboardProfile),
            _ => None,
        }
    }

    /// The same call, borrowed.
    pub fn as_ref(&self) -> CallRef<'_> {
        match self {
            Self::Bytes(bytes) => CallRef::Bytes(bytes),
            Self::Timeout => CallRef::Timeout,
            Self::Unplugged => CallRef::Unplugged,
            Self::Pause => CallRef::Pause,
            Self::Resume => CallRef::Resume,
            Self::ReleaseAll => CallRef::ReleaseAll,
            Self::Retare => CallRef::Retare,
            Self::Profile(text) => CallRef::Profile(text),
            Self::KeyboardProfile(text) => CallRef::KeyboardProfile(text),
        }
    }
}

/// Reads calls in order; an iterator that ends at the end of the file or after the first error.
#[derive(Debug)]
pub struct CaptureReader<R: Read> {
    from: R,
    offset: u64,
    ended: bool,
}

impl<R: Read> CaptureReader<R> {
    /// Begins to read.
    ///
    /// # Errors
    /// [`CaptureError::NotACapture`] if it does not begin like one, or the file cannot be read.
    pub fn new(mut from: R) -> Result<Self, CaptureError> {
        let mut magic = [0; MAGIC.len()];
        let read = read_up_to(&mut from, &mut magic).map_err(CaptureError::Io)?;
        if magic.get(..read) != Some(MAGIC) {
            return Err(CaptureError::NotACapture);
        }
        Ok(Self { from, offset: MAGIC.len() as u64, ended: false })
    }

    fn entry(&mut self) -> Result<Option<Call>, CaptureError> {
        let offset = self.offset;
        let mut head = [0; 13];
        let read = read_up_to(&mut self.from, &mut head).map_err(CaptureError::Io)?;
        if read == 0 {
            return Ok(None);
        }
        if read < head.len() {
            return Err(CaptureError::CutOff { offset });
        }
        let [kind, t0, t1, t2, t3, t4, t5, t6, t7, l0, l1, l2, l3] = head;
        let length = u32::from_le_bytes([l0, l1, l2, l3]);
        if length > ENTRY_BYTES_MAX {
            return Err(CaptureError::Damaged { offset });
        }
        let mut bytes = vec![0; length as usize];
        if read_up_to(&mut self.from, &mut bytes).map_err(CaptureError::Io)? < bytes.len() {
            return Err(CaptureError::CutOff { offset });
        }
        self.offset += 13 + u64::from(length);
        let now = HostInstant::from_ns(u64::from_le_bytes([t0, t1, t2, t3, t4, t5, t6, t7]));
        let kind = CallKind::from_entry(kind, bytes).ok_or(CaptureError::Damaged { offset })?;
        Ok(Some(Call { now, kind }))
    }
}

impl<R: Read> Iterator for CaptureReader<R> {
    type Item = Result<Call, CaptureError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let entry = self.entry().transpose();
        self.ended = !matches!(entry, Some(Ok(_)));
        entry
    }
}

/// Fills `bytes` as far as the file reaches.
fn read_up_to(from: &mut impl Read, bytes: &mut [u8]) -> io::Result<usize> {
    let mut filled = 0;
    while let Some(rest) = bytes.get_mut(filled..).filter(|rest| !rest.is_empty()) {
        match from.read(rest) {
            Ok(0) => break,
            Ok(read) => filled += read,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(filled)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn calls() -> Vec<Call> {
        let kinds = [
            CallKind::Profile("name = \"é\"".into()),
            CallKind::Bytes((0..=255).collect()),
            CallKind::Timeout,
            CallKind::Unplugged,
            CallKind::Pause,
            CallKind::Resume,
            CallKind::ReleaseAll,
            CallKind::Retare,
            CallKind::KeyboardProfile(String::new()),
            CallKind::Bytes(Vec::new()),
        ];
        let nows = [0, 1, 2, 3, 4, 5, 6, 7, 1 << 40, u64::MAX];
        kinds.into_iter().zip(nows).map(|(kind, ns)| Call { now: HostInstant::from_ns(ns), kind }).collect()
    }

    fn written() -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut writer = CaptureWriter::new(&mut bytes).unwrap();
        for call in calls() {
            writer.write(call.now, call.kind.as_ref()).unwrap();
        }
        bytes
    }

    #[test]
    fn what_is_written_is_read() {
        let bytes = written();
        let read: Vec<_> = CaptureReader::new(&bytes[..]).unwrap().map(Result::unwrap).collect();
        assert_eq!(read, calls());
    }

    #[test]
    fn a_cut_off_capture_gives_its_whole_entries_and_says_so() {
        let bytes = written();
        for end in MAGIC.len()..bytes.len() {
            let entries: Vec<_> = CaptureReader::new(&bytes[..end]).unwrap().collect();
            let whole = entries.iter().filter_map(|entry| entry.as_ref().ok()).count();
            assert!(
                calls().iter().zip(&entries).take(whole).all(|(call, entry)| entry.as_ref().unwrap() == call)
            );
            assert!(entries[whole..].iter().all(|entry| matches!(entry, Err(CaptureError::CutOff { .. }))));
        }
    }

    #[test]
    fn other_files_are_refused() {
        for bytes in [&b""[..], b"tactpad", b"tactpad capture 2\n", b"\x7fELF and more than that"] {
            assert!(matches!(CaptureReader::new(bytes), Err(CaptureError::NotACapture)));
        }
    }

    #[test]
    fn damage_ends_the_reading_with_its_place() {
        let mut bytes = MAGIC.to_vec();
        bytes.extend([99; 200]);
        let entries: Vec<_> = CaptureReader::new(&bytes[..]).unwrap().collect();
        assert!(matches!(entries[..], [Err(CaptureError::Damaged { offset: 18 })]));
    }

    #[test]
    fn bytes_where_a_call_has_none_are_damage() {
        for kind in 0..=9_u8 {
            let entry = [&[kind; 1][..], &[0; 8], &[1, 0, 0, 0], b"x"].concat();
            let file = [MAGIC, &entry].concat();
            let [entry] = &CaptureReader::new(&file[..]).unwrap().collect::<Vec<_>>()[..] else { panic!() };
            assert_eq!(entry.is_ok(), [0, 7, 8].contains(&kind), "kind {kind}");
        }
    }
}
