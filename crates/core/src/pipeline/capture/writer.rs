//! Writes captures.

use std::borrow::Cow;
use std::io::{self, Write};

use super::entry::{EntryKind, MAGIC, PAYLOAD_BYTES_MAX, chained};
use super::head::Head;
use crate::pipeline::call::Call;
use crate::time::HostInstant;

/// Writes calls as they are made.
#[derive(Debug)]
pub struct CaptureWriter<W: Write> {
    to: W,
    chain: u32,
    entry: Vec<u8>,
}

impl<W: Write> CaptureWriter<W> {
    /// Begins a capture at host time `now`.
    ///
    /// # Errors
    /// The beginning cannot be written, or what it holds is longer than 16 MiB.
    pub fn begin(to: W, now: HostInstant, head: &Head) -> io::Result<Self> {
        let mut writer = Self::new(to)?;
        if let Some(decoder) = &head.decoder {
            writer.write_entry(EntryKind::Decoder, now, decoder)?;
        }
        if let Some(profile) = &head.profile {
            writer.write(now, Call::Profile(profile))?;
        }
        Ok(writer)
    }

    /// A capture without a head.
    pub(super) fn new(mut to: W) -> io::Result<Self> {
        to.write_all(MAGIC)?;
        Ok(Self { to, chain: 0, entry: Vec::new() })
    }

    /// Adds one call that was made at host time `now`.
    ///
    /// # Errors
    /// The call cannot be written, or what it carries is longer than 16 MiB.
    pub fn write(&mut self, now: HostInstant, call: Call<'_>) -> io::Result<()> {
        let (kind, payload) = entry_of(call);
        self.write_entry(kind, now, &payload)
    }

    /// Ends the capture with a mark that what followed is missing: its file did not take calls as fast as they were made.
    ///
    /// # Errors
    /// The mark cannot be written.
    pub fn write_missing(&mut self, now: HostInstant) -> io::Result<()> {
        self.write_entry(EntryKind::Missing, now, &[])
    }

    /// Where it is written to. What is taken from there is no less part of the capture.
    pub const fn get_mut(&mut self) -> &mut W {
        &mut self.to
    }

    pub(super) fn write_entry(
        &mut self,
        kind: EntryKind,
        now: HostInstant,
        payload: &[u8],
    ) -> io::Result<()> {
        let length = u32::try_from(payload.len()).ok().filter(|length| *length <= PAYLOAD_BYTES_MAX);
        let length = length.ok_or_else(|| io::Error::other("a call carries more than 16 MiB"))?;
        self.entry.clear();
        self.entry.push(kind as u8);
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

/// The kind of a call's entry, and its payload.
fn entry_of(call: Call<'_>) -> (EntryKind, Cow<'_, [u8]>) {
    let plain = |kind: EntryKind| (kind, Cow::default());
    match call {
        Call::Bytes(bytes) => (EntryKind::Bytes, bytes.into()),
        Call::Timeout => plain(EntryKind::Timeout),
        Call::Unplugged => plain(EntryKind::Unplugged),
        Call::Pause => plain(EntryKind::Pause),
        Call::Resume => plain(EntryKind::Resume),
        Call::ReleaseAll => plain(EntryKind::ReleaseAll),
        Call::Retare => plain(EntryKind::Retare),
        Call::Weigh(weight) => (EntryKind::Weigh, weight.g().to_le_bytes().to_vec().into()),
        Call::Profile(read) => (EntryKind::of_profile(read.output()), read.text().as_bytes().into()),
    }
}
