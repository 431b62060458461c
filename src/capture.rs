//! The capture: every call made on the pipeline, so that a replay makes the same calls and gets the same events.
//!
//! Form, integers little-endian: the line `tactpad capture 1\n`, then one entry per call:
//!
//! | bytes | field |
//! |---|---|
//! | 1 | kind |
//! | 8 | host time in nanoseconds |
//! | 4 | length n of the payload, up to 16 MiB |
//! | 4 | checksum of the previous entry's payload checksum (0 for the first entry) and of the fields above |
//! | n | payload: the pad's bytes, a profile's text, or a decoder's file |
//! | 4 | checksum of the head's checksum and of the payload |
//!
//! A capture begins with its decoder, if it was another one than statics as it is inside the program, and its profile.
//!
//! Checksums are the wire's CRC-32. Each covers the one before it, so an entry that is missing, doubled or moved is
//! damage, too. The head has its own, so that a damaged length is not taken for the end of the file. A recorder that
//! was killed leaves a file whose last entry may be cut off; everything before it is sound.

use std::fmt;
use std::io::{self, Read, Write};

use firmware_proto::crc::crc32;

use crate::time::HostInstant;

const MAGIC: &[u8] = b"tactpad capture 1\n";

/// Longer payloads are not written by any recorder.
const PAYLOAD_BYTES_MAX: u32 = 1 << 24;

/// Kind, host time and length.
const FIELDS_BYTES: usize = 13;
const CHECKSUM_BYTES: usize = 4;
const HEAD_BYTES: usize = FIELDS_BYTES + CHECKSUM_BYTES;

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
    /// Another profile, as its TOML text, for the output it names; a capture's first one is what it begins with.
    Profile(String),
    /// The same, for the keyboard whatever output it names.
    KeyboardProfile(String),
    /// The decoder that plays, as its file has it; stands before everything else or nowhere.
    Decoder(Vec<u8>),
}

/// Why a capture cannot be read.
#[derive(Debug)]
pub enum CaptureError {
    /// It does not begin like one.
    NotACapture,
    /// A checksum is wrong, an entry is of no known kind or impossibly long, carries bytes where its kind has none, or
    /// is a decoder in the middle: the file is damaged, or from a newer program. All entries before it were given.
    Damaged {
        /// Byte offset of the entry.
        offset: u64,
    },
    /// The file ends inside an entry; all entries before it were given.
    CutOff {
        /// Byte offset of the entry.
        offset: u64,
    },
    /// It ends, or is cut off, before the first call but those of its decoder and profile.
    NoPlay,
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
            Self::NoPlay => f.write_str(
                "holds no play: it ends before the first call; record again with `tactpad record FILE`",
            ),
            Self::Io(error) => write!(f, "cannot be read: {error}"),
        }
    }
}

impl std::error::Error for CaptureError {}

/// Writes calls as they are made.
#[derive(Debug)]
pub struct CaptureWriter<W: Write> {
    to: W,
    chain: u32,
    entry: Vec<u8>,
}

impl<W: Write> CaptureWriter<W> {
    /// Begins a capture.
    ///
    /// # Errors
    /// The beginning cannot be written.
    pub fn new(mut to: W) -> io::Result<Self> {
        to.write_all(MAGIC)?;
        Ok(Self { to, chain: 0, entry: Vec::new() })
    }

    /// Adds one call.
    ///
    /// # Errors
    /// The call cannot be written, or what it carries is longer than 16 MiB.
    pub fn write(&mut self, now: HostInstant, call: CallRef<'_>) -> io::Result<()> {
        let payload = call.payload();
        let length = u32::try_from(payload.len()).ok().filter(|length| *length <= PAYLOAD_BYTES_MAX);
        let length = length.ok_or_else(|| io::Error::other("a call carries more than 16 MiB"))?;
        self.entry.clear();
        self.entry.push(call.kind());
        self.entry.extend_from_slice(&now.as_ns().to_le_bytes());
        self.entry.extend_from_slice(&length.to_le_bytes());
        let head = chained(self.chain, &self.entry);
        self.entry.extend_from_slice(&head.to_le_bytes());
        self.entry.extend_from_slice(payload);
        self.chain = chained(head, payload);
        self.entry.extend_from_slice(&self.chain.to_le_bytes());
        self.to.write_all(&self.entry)
    }

    /// Hands everything written so far to the file.
    ///
    /// # Errors
    /// The file does not take it.
    pub fn flush(&mut self) -> io::Result<()> {
        self.to.flush()
    }
}

/// The checksum of `bytes` behind the checksum of what came before them.
fn chained(before: u32, bytes: &[u8]) -> u32 {
    crc32(&[&before.to_le_bytes(), bytes].concat())
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
    /// See [`CallKind::Decoder`].
    Decoder(&'a [u8]),
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
            Self::Decoder(_) => 9,
        }
    }

    const fn payload(&self) -> &[u8] {
        match self {
            Self::Bytes(bytes) | Self::Decoder(bytes) => bytes,
            Self::Profile(text) | Self::KeyboardProfile(text) => text.as_bytes(),
            _ => &[],
        }
    }
}

impl CallKind {
    fn from_entry(kind: u8, bytes: Vec<u8>) -> Option<Self> {
        let carries_bytes = matches!(kind, 0 | 7..=9);
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
            9 => Some(Self::Decoder(bytes)),
            _ => None,
        }
    }

    /// Whether it is more than what a capture begins with.
    const fn is_play(&self) -> bool {
        !matches!(self, Self::Profile(_) | Self::KeyboardProfile(_) | Self::Decoder(_))
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
            Self::Decoder(bytes) => CallRef::Decoder(bytes),
        }
    }
}

/// Reads calls in order; an iterator that ends at the end of the file or after the first error.
#[derive(Debug)]
pub struct CaptureReader<R: Read> {
    from: R,
    offset: u64,
    chain: u32,
    plays: bool,
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
        Ok(Self { from, offset: MAGIC.len() as u64, chain: 0, plays: false, ended: false })
    }

    fn entry(&mut self) -> Result<Option<Call>, CaptureError> {
        let offset = self.offset;
        let Some(Head { kind, now, length, checksum }) = self.head()? else { return Ok(None) };
        let mut payload = vec![0; length as usize];
        let mut checksum_of_payload = [0; CHECKSUM_BYTES];
        self.fill(&mut payload)?;
        self.fill(&mut checksum_of_payload)?;
        self.chain = u32::from_le_bytes(checksum_of_payload);
        self.offset += (HEAD_BYTES + CHECKSUM_BYTES) as u64 + u64::from(length);
        let sound = chained(checksum, &payload) == self.chain;
        let is_first = offset == MAGIC.len() as u64;
        let kind = CallKind::from_entry(kind, payload)
            .filter(|kind| sound && (is_first || !matches!(kind, CallKind::Decoder(_))));
        Ok(Some(Call { now, kind: kind.ok_or(CaptureError::Damaged { offset })? }))
    }

    /// The head of the next entry; `None` at the end of the file.
    fn head(&mut self) -> Result<Option<Head>, CaptureError> {
        let mut head = [0; HEAD_BYTES];
        let read = read_up_to(&mut self.from, &mut head).map_err(CaptureError::Io)?;
        let offset = self.offset;
        match read {
            0 => return Ok(None),
            HEAD_BYTES => {}
            _ => return Err(CaptureError::CutOff { offset }),
        }
        let [kind, t0, t1, t2, t3, t4, t5, t6, t7, l0, l1, l2, l3, c0, c1, c2, c3] = head;
        let now = HostInstant::from_ns(u64::from_le_bytes([t0, t1, t2, t3, t4, t5, t6, t7]));
        let length = u32::from_le_bytes([l0, l1, l2, l3]);
        let checksum = u32::from_le_bytes([c0, c1, c2, c3]);
        let fields = head.get(..FIELDS_BYTES).unwrap_or_default();
        let sound = chained(self.chain, fields) == checksum && length <= PAYLOAD_BYTES_MAX;
        if sound {
            Ok(Some(Head { kind, now, length, checksum }))
        } else {
            Err(CaptureError::Damaged { offset })
        }
    }

    fn fill(&mut self, bytes: &mut [u8]) -> Result<(), CaptureError> {
        match read_up_to(&mut self.from, bytes).map_err(CaptureError::Io)? {
            read if read == bytes.len() => Ok(()),
            _ => Err(CaptureError::CutOff { offset: self.offset }),
        }
    }
}

/// What stands before an entry's payload.
struct Head {
    kind: u8,
    now: HostInstant,
    length: u32,
    checksum: u32,
}

impl<R: Read> Iterator for CaptureReader<R> {
    type Item = Result<Call, CaptureError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let entry = match self.entry().transpose() {
            None | Some(Err(CaptureError::CutOff { .. })) if !self.plays => Some(Err(CaptureError::NoPlay)),
            entry => entry,
        };
        match &entry {
            Some(Ok(call)) => self.plays |= call.kind.is_play(),
            _ => self.ended = true,
        }
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
            CallKind::Decoder(vec![0, 255, 10]),
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
        let nows = [0, 0, 1, 2, 3, 4, 5, 6, 7, 1 << 40, u64::MAX];
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
            match &entries[whole..] {
                [] => assert!(offsets().contains(&(end as u64)) && whole > 2),
                [Err(CaptureError::CutOff { offset })] => {
                    assert_eq!((*offset, whole > 2), (offsets()[whole], true));
                }
                [Err(CaptureError::NoPlay)] => assert!(whole <= 2),
                rest => panic!("{rest:?}"),
            }
        }
    }

    #[test]
    fn other_files_are_refused() {
        for bytes in [&b""[..], b"tactpad", b"tactpad capture 2\n", b"\x7fELF and more than that"] {
            assert!(matches!(CaptureReader::new(bytes), Err(CaptureError::NotACapture)));
        }
    }

    /// The byte offset of each entry of [`written`], and the file's end.
    fn offsets() -> Vec<u64> {
        let sizes = calls()
            .into_iter()
            .map(|call| (HEAD_BYTES + CHECKSUM_BYTES + call.kind.as_ref().payload().len()) as u64);
        let mut at = MAGIC.len() as u64;
        let mut offsets = vec![at];
        offsets.extend(sizes.map(|size| {
            at += size;
            at
        }));
        offsets
    }

    /// Sees that `bytes` give the calls before the entry at `offset`, then damage there.
    fn is_damaged_at(bytes: &[u8], offset: u64, what: &str) {
        let mut entries: Vec<_> = CaptureReader::new(bytes).unwrap().collect();
        let last = entries.pop().unwrap();
        assert!(
            matches!(last, Err(CaptureError::Damaged { offset: told }) if told == offset),
            "{what}: {last:?}"
        );
        let before: Vec<_> = entries.into_iter().map(Result::unwrap).collect();
        assert_eq!(before, calls()[..before.len()], "{what}");
        assert_eq!(offsets()[before.len()], offset, "{what}");
    }

    #[test]
    fn each_flipped_bit_is_damage_of_its_entry() {
        let bytes = written();
        for place in MAGIC.len()..bytes.len() {
            let offset = *offsets().iter().rfind(|offset| **offset <= place as u64).unwrap();
            for bit in 0..8 {
                let mut flipped = bytes.clone();
                flipped[place] ^= 1 << bit;
                is_damaged_at(&flipped, offset, &format!("bit {bit} of byte {place}"));
            }
        }
    }

    #[test]
    fn entries_that_are_missing_doubled_or_foreign_are_damage() {
        let (bytes, offsets) = (written(), offsets());
        let [first, second, third] = [0, 1, 2].map(|entry| offsets[entry] as usize);
        let [before, entry, after] = [&bytes[..second], &bytes[second..third], &bytes[third..]];
        is_damaged_at(&[before, after].concat(), offsets[1], "missing");
        is_damaged_at(&[before, entry, entry, after].concat(), offsets[2], "doubled");
        is_damaged_at(&[&bytes[..], &bytes[first..second]].concat(), offsets[11], "two captures in one");
        is_damaged_at(&[MAGIC, &[99; 200]].concat(), offsets[0], "noise");
    }

    #[test]
    fn a_call_that_no_reader_would_take_is_not_written() {
        let mut writer = CaptureWriter::new(Vec::new()).unwrap();
        let bytes = vec![0; PAYLOAD_BYTES_MAX as usize + 1];
        assert!(writer.write(HostInstant::default(), CallRef::Bytes(&bytes)).is_err());
        writer.write(HostInstant::default(), CallRef::Bytes(&bytes[1..])).unwrap();
        let calls: Vec<_> = CaptureReader::new(&writer.to[..]).unwrap().map(Result::unwrap).collect();
        assert_eq!(calls.len(), 1);
    }

    #[test]
    fn a_decoder_stands_first_or_the_file_is_damaged() {
        let mut writer = CaptureWriter::new(Vec::new()).unwrap();
        for call in [CallRef::Decoder(b"one"), CallRef::Profile(""), CallRef::Decoder(b"two")] {
            writer.write(HostInstant::default(), call).unwrap();
        }
        let read: Vec<_> = CaptureReader::new(&writer.to[..]).unwrap().collect();
        assert!(matches!(&read[..], [Ok(_), Ok(_), Err(CaptureError::Damaged { .. })]), "{read:?}");
    }

    #[test]
    fn bytes_where_a_call_has_none_are_damage() {
        for kind in 0..=10_u8 {
            let fields = [&[kind; 1][..], &[0; 8], &[1, 0, 0, 0]].concat();
            let head = chained(0, &fields);
            let ends = [head, chained(head, b"x")].map(u32::to_le_bytes);
            let file = [MAGIC, &fields, &ends[0], b"x", &ends[1]].concat();
            let entry = CaptureReader::new(&file[..]).unwrap().next().unwrap();
            assert_eq!(entry.is_ok(), [0, 7, 8, 9].contains(&kind), "kind {kind}");
        }
    }
}
