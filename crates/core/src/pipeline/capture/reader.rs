//! Reads captures: first what they begin with, then their calls.

use std::fmt;
use std::io::{self, Read};

use super::entry::{
    CHECKSUM_BYTES, EntryKind, FIELDS_BYTES, HEAD_BYTES, MAGIC, PAYLOAD_BYTES_MAX, chained, weight,
};
use super::head::Head;
use crate::pipeline::call::Call;
use crate::pipeline::mapping::read::ReadProfile;
use crate::time::HostInstant;

/// Why a capture cannot be read.
#[derive(Debug)]
#[non_exhaustive]
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
    /// The recording went on here, but its file did not take it. All entries before were given.
    Missing {
        /// Byte offset of the mark.
        offset: u64,
    },
    /// In the middle the player went over to a profile that this program cannot use. The calls behind it can still be
    /// read.
    Profile {
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
            Self::Missing { offset } => write!(
                f,
                "ends at byte {offset} though the recording went on: its file took no more; everything before was used"
            ),
            Self::Profile { offset } => write!(
                f,
                "goes over at byte {offset} to a profile that this tactpad cannot use; choose one with --profile"
            ),
            Self::NoPlay => f.write_str(
                "holds no play: it ends before the first call; record again with `tactpad record FILE`",
            ),
            Self::Io(error) => write!(f, "cannot be read: {error}"),
        }
    }
}

impl std::error::Error for CaptureError {}

/// Reads a capture's head, then its calls in order.
#[derive(Debug)]
pub struct CaptureReader<R: Read> {
    entries: Entries<R>,
    head: Head,
    /// The first entry behind the head, read with it.
    first: Option<CaptureEntry>,
    /// The profile of the last call.
    profile: Option<ReadProfile>,
}

impl<R: Read> CaptureReader<R> {
    /// Begins to read: the head, and whether there is something to play.
    ///
    /// # Errors
    /// [`CaptureError::NotACapture`] if it does not begin like one; or the first entries cannot be read.
    pub fn new(from: R) -> Result<Self, CaptureError> {
        let mut entries = Entries::new(from)?;
        let mut head = Head::default();
        let mut first = entries.read()?;
        if first.is_some_and(|entry| entry.kind == EntryKind::Decoder) {
            head.decoder = Some(entries.payload.clone());
            first = entries.read()?;
        }
        if let Some(output) = first.and_then(|entry| entry.kind.output()) {
            head.profile = ReadProfile::read(entries.text(), output).0;
            first = None;
        }
        Ok(Self { entries, head, first, profile: None })
    }

    /// Head of the capture.
    pub const fn head(&self) -> &Head {
        &self.head
    }

    /// The next call and its host time; `None` at the end of the file, and after an error that ends it: any but
    /// [`CaptureError::Profile`].
    pub fn next_call(&mut self) -> Option<Result<(HostInstant, Call<'_>), CaptureError>> {
        match self.first.take().map_or_else(|| self.entries.read(), |entry| Ok(Some(entry))) {
            Ok(entry) => entry.map(|entry| self.call(entry)),
            Err(error) => Some(Err(error)),
        }
    }

    fn call(&mut self, entry: CaptureEntry) -> Result<(HostInstant, Call<'_>), CaptureError> {
        let call = match entry.kind {
            EntryKind::Bytes => Call::Bytes(&self.entries.payload),
            EntryKind::Timeout => Call::Timeout,
            EntryKind::Unplugged => Call::Unplugged,
            EntryKind::Pause => Call::Pause,
            EntryKind::Resume => Call::Resume,
            EntryKind::ReleaseAll => Call::ReleaseAll,
            EntryKind::Retare => Call::Retare,
            EntryKind::Weigh => {
                let weight = weight(&self.entries.payload);
                Call::Weigh(weight.ok_or(CaptureError::Damaged { offset: entry.offset })?)
            }
            EntryKind::Profile | EntryKind::KeyboardProfile => {
                let output = entry.kind.output();
                self.profile = output.and_then(|output| ReadProfile::read(self.entries.text(), output).0);
                let read = self.profile.as_ref();
                Call::Profile(read.ok_or(CaptureError::Profile { offset: entry.offset })?)
            }
            EntryKind::Decoder => return Err(CaptureError::Damaged { offset: entry.offset }),
            EntryKind::Missing => {
                self.entries.ended = true;
                return Err(CaptureError::Missing { offset: entry.offset });
            }
        };
        Ok((entry.now, call))
    }
}

/// An entry; its payload stays with the reader.
#[derive(Clone, Copy, Debug)]
struct CaptureEntry {
    kind: EntryKind,
    now: HostInstant,
    offset: u64,
}

/// Reads entries in order, up to the end of the file or the first error.
#[derive(Debug)]
struct Entries<R: Read> {
    from: R,
    offset: u64,
    chain: u32,
    plays: bool,
    ended: bool,
    /// Of the entry that was read last.
    payload: Vec<u8>,
}

impl<R: Read> Entries<R> {
    fn new(mut from: R) -> Result<Self, CaptureError> {
        let mut magic = [0; MAGIC.len()];
        let read = read_up_to(&mut from, &mut magic).map_err(CaptureError::Io)?;
        if magic.get(..read) != Some(MAGIC) {
            return Err(CaptureError::NotACapture);
        }
        let offset = MAGIC.len() as u64;
        Ok(Self { from, offset, chain: 0, plays: false, ended: false, payload: Vec::new() })
    }

    /// The next entry; `None` at the end and after an error.
    fn read(&mut self) -> Result<Option<CaptureEntry>, CaptureError> {
        if self.ended {
            return Ok(None);
        }
        let entry = match self.entry() {
            Ok(None) | Err(CaptureError::CutOff { .. }) if !self.plays => Err(CaptureError::NoPlay),
            entry => entry,
        };
        match &entry {
            Ok(Some(entry)) => self.plays |= entry.kind.is_play(),
            _ => self.ended = true,
        }
        entry
    }

    /// The last payload as text; an entry whose kind has a text is sound only if it is one.
    fn text(&self) -> &str {
        std::str::from_utf8(&self.payload).unwrap_or_default()
    }

    fn entry(&mut self) -> Result<Option<CaptureEntry>, CaptureError> {
        let offset = self.offset;
        let Some(EntryHead { kind, now, length, checksum }) = self.head()? else { return Ok(None) };
        let mut checksum_of_payload = [0; CHECKSUM_BYTES];
        self.payload.resize(length as usize, 0);
        fill(&mut self.from, &mut self.payload, offset)?;
        fill(&mut self.from, &mut checksum_of_payload, offset)?;
        self.chain = u32::from_le_bytes(checksum_of_payload);
        self.offset += (HEAD_BYTES + CHECKSUM_BYTES) as u64 + u64::from(length);
        let is_sound = chained(checksum, &self.payload) == self.chain;
        let is_first = offset == MAGIC.len() as u64;
        let kind = EntryKind::of(kind).filter(|kind| {
            is_sound && kind.takes(&self.payload) && (is_first || *kind != EntryKind::Decoder)
        });
        Ok(Some(CaptureEntry { kind: kind.ok_or(CaptureError::Damaged { offset })?, now, offset }))
    }

    /// The head of the next entry; `None` at the end of the file.
    fn head(&mut self) -> Result<Option<EntryHead>, CaptureError> {
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
            Ok(Some(EntryHead { kind, now, length, checksum }))
        } else {
            Err(CaptureError::Damaged { offset })
        }
    }
}

/// Head of an entry, before its payload.
struct EntryHead {
    kind: u8,
    now: HostInstant,
    length: u32,
    checksum: u32,
}

/// Fills `bytes`, which belong to the entry at `offset`.
fn fill(from: &mut impl Read, bytes: &mut [u8], offset: u64) -> Result<(), CaptureError> {
    match read_up_to(from, bytes).map_err(CaptureError::Io)? {
        read if read == bytes.len() => Ok(()),
        _ => Err(CaptureError::CutOff { offset }),
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
    use super::super::writer::CaptureWriter;
    use super::*;
    use crate::pad::weight::Weight;
    use crate::pipeline::mapping::read::check::OutputChoice;

    const TEXT: &str = "schema = 1\nname = \"é\"\noutput = \"gamepad\"\n[dpad]\nmode = \"4way\"\n";

    fn profile(output: OutputChoice) -> ReadProfile {
        ReadProfile::read(TEXT, output).0.unwrap()
    }

    fn head() -> Head {
        Head { decoder: Some(vec![0, 255, 10]), profile: Some(profile(OutputChoice::AsWritten)) }
    }

    /// Every kind of call, at times that reach to the end of time.
    fn with_calls<T>(mut see: impl FnMut(HostInstant, Call<'_>) -> T) -> Vec<T> {
        let bytes: Vec<u8> = (0..=255).collect();
        let keyboard = profile(OutputChoice::Keyboard);
        let calls = [
            Call::Bytes(&bytes),
            Call::Timeout,
            Call::Unplugged,
            Call::Pause,
            Call::Resume,
            Call::ReleaseAll,
            Call::Retare,
            Call::Profile(&keyboard),
            Call::Weigh(Weight::of_g(200.5).unwrap()),
            Call::Bytes(&[]),
        ];
        let nows = [1, 2, 3, 4, 5, 6, 7, 8, 1 << 40, u64::MAX];
        calls.into_iter().zip(nows).map(|(call, ns)| see(HostInstant::from_ns(ns), call)).collect()
    }

    fn shown(now: HostInstant, call: Call<'_>) -> String {
        format!("{now:?} {call:?}")
    }

    fn written() -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut writer = CaptureWriter::begin(&mut bytes, HostInstant::default(), &head()).unwrap();
        with_calls(|now, call| writer.write(now, call).unwrap());
        bytes
    }

    /// The calls of a capture up to its first error, and that.
    fn read(bytes: &[u8]) -> (Vec<String>, Option<CaptureError>) {
        let mut reader = match CaptureReader::new(bytes) {
            Ok(reader) => reader,
            Err(error) => return (Vec::new(), Some(error)),
        };
        let mut calls = Vec::new();
        while let Some(call) = reader.next_call() {
            match call {
                Ok((now, call)) => calls.push(shown(now, call)),
                Err(error) => {
                    assert!(reader.next_call().is_none(), "nothing comes behind {error}");
                    return (calls, Some(error));
                }
            }
        }
        (calls, None)
    }

    #[test]
    fn what_is_written_is_read() {
        let bytes = written();
        assert_eq!(*CaptureReader::new(&bytes[..]).unwrap().head(), head());
        let (calls, error) = read(&bytes);
        assert!(error.is_none(), "{error:?}");
        assert_eq!(calls, with_calls(shown));
    }

    #[test]
    fn a_cut_off_capture_gives_its_whole_entries_and_says_so() {
        let bytes = written();
        let all = with_calls(shown);
        for end in MAGIC.len()..bytes.len() {
            let (calls, error) = read(&bytes[..end]);
            assert_eq!(calls, all[..calls.len()]);
            match error {
                None => assert!(offsets().contains(&(end as u64)) && !calls.is_empty()),
                Some(CaptureError::CutOff { offset }) => {
                    assert_eq!((offset, calls.is_empty()), (offsets()[HEAD_ENTRIES + calls.len()], false));
                }
                Some(CaptureError::NoPlay) => assert!(calls.is_empty()),
                Some(error) => panic!("{error:?}"),
            }
        }
    }

    #[test]
    fn a_capture_whose_file_took_no_more_gives_its_calls_and_says_so() {
        let mut writer = CaptureWriter::begin(Vec::new(), HostInstant::default(), &head()).unwrap();
        with_calls(|now, call| writer.write(now, call).unwrap());
        writer.write_missing(HostInstant::from_ns(u64::MAX)).unwrap();
        let (calls, error) = read(writer.get_mut());
        assert_eq!(calls, with_calls(shown));
        let end = written().len() as u64;
        assert!(matches!(error, Some(CaptureError::Missing { offset }) if offset == end), "{error:?}");
    }

    #[test]
    fn other_files_are_refused() {
        for bytes in [&b""[..], b"tactpad", b"tactpad capture 2\n", b"\x7fELF and more than that"] {
            assert!(matches!(CaptureReader::new(bytes), Err(CaptureError::NotACapture)));
        }
    }

    /// Decoder and profile.
    const HEAD_ENTRIES: usize = 2;

    /// The byte offset of each entry of [`written`], and the file's end.
    fn offsets() -> Vec<u64> {
        let payloads = with_calls(|_, call| match call {
            Call::Bytes(bytes) => bytes.len(),
            Call::Profile(read) => read.text().len(),
            Call::Weigh(_) => 8,
            _ => 0,
        });
        let mut at = MAGIC.len() as u64;
        let mut offsets = vec![at];
        offsets.extend([3, TEXT.len()].into_iter().chain(payloads).map(|payload| {
            at += (HEAD_BYTES + CHECKSUM_BYTES + payload) as u64;
            at
        }));
        offsets
    }

    /// Sees that `bytes` give the calls before the entry at `offset`, then damage there.
    fn is_damaged_at(bytes: &[u8], offset: u64, what: &str) {
        let (calls, error) = read(bytes);
        assert!(
            matches!(error, Some(CaptureError::Damaged { offset: told }) if told == offset),
            "{what}: {error:?}"
        );
        assert_eq!(calls, with_calls(shown)[..calls.len()], "{what}");
        let entry = offsets().iter().position(|other| *other == offset);
        assert_eq!(entry.map(|entry| entry.saturating_sub(HEAD_ENTRIES)), Some(calls.len()), "{what}");
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
        is_damaged_at(&[&bytes[..], &bytes[first..second]].concat(), offsets[12], "two captures in one");
        is_damaged_at(&[MAGIC, &[99; 200]].concat(), offsets[0], "noise");
    }

    #[test]
    fn a_call_that_no_reader_would_take_is_not_written() {
        let mut file = Vec::new();
        let mut writer = CaptureWriter::new(&mut file).unwrap();
        let bytes = vec![0; PAYLOAD_BYTES_MAX as usize + 1];
        assert!(writer.write(HostInstant::default(), Call::Bytes(&bytes)).is_err());
        writer.write(HostInstant::default(), Call::Bytes(&bytes[1..])).unwrap();
        let (calls, error) = read(&file);
        assert!(calls.len() == 1 && error.is_none(), "{error:?}");
    }

    /// A file of these entries, all at the beginning of time.
    fn file(entries: &[(EntryKind, &[u8])]) -> Vec<u8> {
        let mut file = Vec::new();
        let mut writer = CaptureWriter::new(&mut file).unwrap();
        for (kind, payload) in entries {
            writer.write_entry(*kind, HostInstant::default(), payload).unwrap();
        }
        file
    }

    #[test]
    fn a_decoder_stands_first_or_the_file_is_damaged() {
        let entries: [(EntryKind, &[u8]); 4] = [
            (EntryKind::Decoder, b"one"),
            (EntryKind::Profile, b""),
            (EntryKind::Timeout, b""),
            (EntryKind::Decoder, b"two"),
        ];
        for (entries, calls) in [(&entries[..], 1), (&[entries[0], entries[3]], 0)] {
            let (read, error) = read(&file(entries));
            assert!(read.len() == calls && matches!(error, Some(CaptureError::Damaged { .. })), "{error:?}");
        }
    }

    #[test]
    fn a_head_may_be_missing_or_of_no_use() {
        let bare = file(&[(EntryKind::Timeout, b"")]);
        assert_eq!(*CaptureReader::new(&bare[..]).unwrap().head(), Head::default());
        assert_eq!(read(&bare).0.len(), 1);
        let useless = file(&[
            (EntryKind::Decoder, b"none"),
            (EntryKind::Profile, b"schema = 7"),
            (EntryKind::Pause, b""),
        ]);
        let reader = CaptureReader::new(&useless[..]).unwrap();
        assert!(reader.head().profile.is_none() && reader.head().read_decoder().is_err());
        assert_eq!(read(&useless).0.len(), 1);
    }

    #[test]
    fn a_profile_of_no_use_in_the_middle_is_told_and_the_calls_behind_it_are_read() {
        let entries: [(EntryKind, &[u8]); 3] =
            [(EntryKind::Timeout, b""), (EntryKind::KeyboardProfile, b"schema = 7"), (EntryKind::Pause, b"")];
        let file = file(&entries);
        let mut reader = CaptureReader::new(&file[..]).unwrap();
        assert!(matches!(reader.next_call(), Some(Ok((_, Call::Timeout)))));
        let offset = (MAGIC.len() + HEAD_BYTES + CHECKSUM_BYTES) as u64;
        let told = reader.next_call();
        assert!(
            matches!(told, Some(Err(CaptureError::Profile { offset: told })) if told == offset),
            "{told:?}"
        );
        assert!(matches!(reader.next_call(), Some(Ok((_, Call::Pause)))));
        assert!(reader.next_call().is_none());
    }

    #[test]
    fn a_weight_that_no_pad_feels_or_bears_is_damage() {
        for g in [0.0, -200.0, 1e9, f64::NAN] {
            let (calls, error) =
                read(&file(&[(EntryKind::Timeout, b""), (EntryKind::Weigh, &g.to_le_bytes())]));
            assert!(
                calls.len() == 1 && matches!(error, Some(CaptureError::Damaged { .. })),
                "{g}: {error:?}"
            );
        }
    }

    #[test]
    fn bytes_where_a_call_has_none_are_damage() {
        for kind in 0..=11_u8 {
            let fields = [&[kind; 1][..], &[0; 8], &[1, 0, 0, 0]].concat();
            let head = chained(0, &fields);
            let ends = [head, chained(head, b"x")].map(u32::to_le_bytes);
            let file = [MAGIC, &fields, &ends[0], b"x", &ends[1]].concat();
            let is_sound = !matches!(read(&file).1, Some(CaptureError::Damaged { .. }));
            assert_eq!(is_sound, [0, 7, 8, 9].contains(&kind), "kind {kind}");
        }
    }
}
