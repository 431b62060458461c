//! Lines of text as frames of channels: what a firmware of ours would have sent. Told the time; it reads no clock.
//!
//! A source of ten lines a second is too slow for a pad, so its last state is sent again in between. Each line is a frame at once. Once no
//! line has come for some of its usual intervals nothing is sent any more, and the pipeline hears the silence.

use firmware_proto::ENCODED_MAX;
use firmware_proto::channels::{ChannelSample, FEW_CHANNELS_MAX};
use firmware_proto::frame::Message;
use firmware_proto::link::encode_message;
use firmware_proto::sample::Status;
use tactpad_core::pipeline::line_check::LineFinding;
use tactpad_core::source::Lines;

use crate::transport::pacing::{FRAME_MIN_US, REPEAT_US};

use super::look::{LineLook, LineOutcome};
use super::still::StillCells;

/// No sound line is longer, bytes.
pub const LINE_BYTES_MAX: usize = 256;

/// The source is silent after so many of its longest recent intervals, …
const SILENT_INTERVALS: u64 = 3;

/// … but not before, µs, as a port hands over its bytes in parts, …
const SILENT_MIN_US: u64 = 20_000;

/// … and not later, µs: ten lines a second are the fewest that can be played with.
pub const SILENT_MAX_US: u64 = 400_000;

/// So many lines in a row with a number of fields are what the source prints now.
const OTHER_FIELDS_LINES: u8 = 2;

/// So many intervals are remembered.
const INTERVALS: usize = 8;

/// What a line says: the counts, and a status for cells that say nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Measurement {
    counts: [i32; FEW_CHANNELS_MAX],
    status: Status,
}

/// Makes frames of lines.
#[derive(Clone, Debug)]
pub struct LineFrames {
    columns: Vec<usize>,
    /// Counts of 1.
    counts_per_unit: f64,
    /// The line that is coming in; `None` before the first end of a line, and while one is too long.
    partial: Option<Vec<u8>>,
    /// Bytes since then that belong to no line.
    skipped: usize,
    /// How many fields a line has, and how many lines in a row had another number, which one.
    fields: Option<usize>,
    other_fields: (usize, u8),
    /// What the last line said, if it is to be repeated, and when a sound one came last; `None` while the source is silent.
    newest: Option<Measurement>,
    heard_us: Option<u64>,
    intervals_us: [u64; INTERVALS],
    lines: usize,
    sequence: u32,
    /// Time of the last frame.
    sent_us: u64,
    still: StillCells,
    look: LineLook,
}

impl LineFrames {
    /// Of a port that has said nothing yet.
    pub fn new(lines: &Lines) -> Self {
        Self {
            columns: lines.columns.clone(),
            counts_per_unit: 10_f64.powi(lines.decimals.into()),
            partial: None,
            skipped: 0,
            fields: None,
            other_fields: (0, 0),
            newest: None,
            heard_us: None,
            intervals_us: [SILENT_MAX_US; INTERVALS],
            lines: 0,
            sequence: 0,
            sent_us: 0,
            still: StillCells::default(),
            look: LineLook::default(),
        }
    }

    /// Takes bytes that came by `now_us`, and appends the frames of the lines that end in them to `out`.
    pub fn take(&mut self, now_us: u64, bytes: &[u8], out: &mut Vec<u8>) {
        let mut measured = Vec::new();
        let mut is_last_sound = true;
        for &byte in bytes {
            if let Some(outcome) = self.push(byte) {
                let (outcome, wrong) = self.judged(outcome);
                self.look.line(now_us, wrong);
                if outcome.is_err() {
                    // What it would have said is not known, so the state before is not repeated.
                    self.newest = None;
                }
                is_last_sound = outcome.is_ok();
                measured.extend(outcome);
            }
        }
        let Some(last) = measured.last().copied() else { return };
        self.hear(now_us, last, is_last_sound);
        // Lines that come together were measured one after the other.
        let from_us = self.sent_us.max(now_us.saturating_sub(REPEAT_US));
        let count = measured.len() as u64;
        for (number, measurement) in (1..).zip(measured) {
            let at_us = from_us + now_us.saturating_sub(from_us) * number / count;
            self.send(at_us, &measurement, out);
        }
    }

    /// When [`Self::repeat`] is to be called if nothing comes before; `None` while there is nothing to repeat.
    pub fn due_us(&self) -> Option<u64> {
        self.newest.map(|_| self.sent_us + REPEAT_US)
    }

    /// Appends the last state to `out` if that is due at `now_us`, unless the source is silent.
    pub fn repeat(&mut self, now_us: u64, out: &mut Vec<u8>) {
        let Some(measurement) = self.newest.filter(|_| self.sent_us + REPEAT_US <= now_us) else { return };
        let silent_us = now_us.saturating_sub(self.heard_us.unwrap_or(now_us));
        if silent_us > self.silent_after_us() {
            (self.newest, self.heard_us, self.lines) = (None, None, 0);
            self.intervals_us = [SILENT_MAX_US; INTERVALS];
        } else {
            self.send(now_us, &measurement, out);
        }
    }

    /// What is wrong with the lines as a whole, if anything is.
    pub const fn finding(&self) -> Option<&LineFinding> {
        self.look.finding()
    }

    /// A line with what is wrong with it: cells that stand still say nothing, as those without a number.
    fn judged(
        &mut self,
        outcome: Result<Measurement, LineOutcome>,
    ) -> (Result<Measurement, LineOutcome>, Option<LineOutcome>) {
        let mut measurement = match outcome {
            Ok(measurement) => measurement,
            Err(wrong) => return (outcome, Some(wrong)),
        };
        let mut wrong = dead_cell(&measurement);
        let stands = self.still.see(&measurement.counts, self.columns.len());
        for (channel, _) in stands.iter().enumerate().filter(|(_, stands)| **stands) {
            measurement.status = measurement.status.with_out_of_range(channel);
            wrong = wrong.or(Some(LineOutcome::Stands { channel }));
        }
        (Ok(measurement), wrong)
    }

    /// Remembers what is to be repeated, unless a line came after it that says nothing.
    fn hear(&mut self, now_us: u64, measurement: Measurement, is_last: bool) {
        let heard_us = self.heard_us.replace(now_us);
        if let Some(heard_us) = heard_us {
            if let Some(slot) = self.intervals_us.get_mut(self.lines % INTERVALS) {
                *slot = now_us.saturating_sub(heard_us);
            }
            self.lines += 1;
        }
        self.newest = is_last.then_some(measurement);
    }

    fn silent_after_us(&self) -> u64 {
        let longest_us = self.intervals_us.iter().copied().max().unwrap_or(SILENT_MAX_US);
        longest_us.saturating_mul(SILENT_INTERVALS).clamp(SILENT_MIN_US, SILENT_MAX_US)
    }

    fn send(&mut self, at_us: u64, measurement: &Measurement, out: &mut Vec<u8>) {
        self.sent_us = at_us.max(self.sent_us + FRAME_MIN_US);
        let counts = measurement.counts.get(..self.columns.len()).unwrap_or_default();
        let Some(sample) = ChannelSample::new(self.sequence, self.sent_us, counts, measurement.status) else {
            return;
        };
        self.sequence = self.sequence.wrapping_add(1);
        let mut frame = [0; ENCODED_MAX];
        let length = encode_message(&Message::Channels(sample), &mut frame);
        out.extend_from_slice(frame.get(..length).unwrap_or_default());
    }

    /// Takes a byte; what a line that ends with it says, if it is no empty one.
    fn push(&mut self, byte: u8) -> Option<Result<Measurement, LineOutcome>> {
        if !matches!(byte, b'\n' | b'\r') {
            match &mut self.partial {
                Some(partial) => partial.push(byte),
                None => self.skipped += 1,
            }
            if self.skipped.max(self.partial.as_ref().map_or(0, Vec::len)) <= LINE_BYTES_MAX {
                return None;
            }
            // Also what has no end at all is told, again and again.
            (self.partial, self.skipped) = (None, 0);
            return Some(Err(LineOutcome::TooLong));
        }
        self.skipped = 0;
        // What came before the first end of a line may be half of one.
        let line = self.partial.replace(Vec::new())?;
        let text = std::str::from_utf8(&line).map(str::trim);
        if text == Ok("") { None } else { Some(self.measured(text.unwrap_or_default())) }
    }

    /// What a line says. Where some cells have numbers and others have none, those are dead.
    fn measured(&mut self, line: &str) -> Result<Measurement, LineOutcome> {
        let is_between = |letter: char| letter == ',' || letter == ';' || letter.is_whitespace();
        // Blanks may stand beside a comma, and a field between two commas may be empty.
        let fields: Vec<&str> = if line.contains([',', ';']) {
            line.split([',', ';']).map(str::trim).collect()
        } else {
            line.split(is_between).filter(|field| !field.is_empty()).collect()
        };
        if !self.is_whole(fields.len()) {
            return Err(LineOutcome::NotNumbers);
        }
        let mut measurement = Measurement { counts: [0; FEW_CHANNELS_MAX], status: Status::OK };
        let mut sound = 0;
        for (channel, (count, column)) in measurement.counts.iter_mut().zip(&self.columns).enumerate() {
            let field = fields.get(column - 1).ok_or(LineOutcome::NotNumbers)?;
            match self.count(field) {
                Some(number) => (*count, sound) = (number, sound + 1),
                None => measurement.status = measurement.status.with_out_of_range(channel),
            }
        }
        if sound == 0 { Err(LineOutcome::NotNumbers) } else { Ok(measurement) }
    }

    /// Whether a line of so many fields is whole: one that has lost its end goes on with the next line, and has more.
    fn is_whole(&mut self, fields: usize) -> bool {
        let (other, times) = self.other_fields;
        let times = if other == fields { times + 1 } else { 1 };
        if self.fields == Some(fields) || times >= OTHER_FIELDS_LINES {
            (self.fields, self.other_fields) = (Some(fields), (0, 0));
            return true;
        }
        self.other_fields = (fields, times);
        false
    }

    fn count(&self, field: &str) -> Option<i32> {
        let counts = field.parse::<f64>().ok()? * self.counts_per_unit;
        let is_count = counts.abs() < f64::from(i32::MAX);
        is_count.then(|| counts.round() as i32)
    }
}

/// The first cell that a sound line has no number for.
fn dead_cell(measurement: &Measurement) -> Option<LineOutcome> {
    let status = measurement.status;
    (0..FEW_CHANNELS_MAX)
        .find(|channel| status.is_out_of_range(*channel))
        .map(|channel| LineOutcome::NoNumber { channel })
}
