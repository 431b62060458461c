//! A pad's samples as they are sent, before any zero, filter, fault or decoder.

use firmware_proto::identity::Identity;

use tactpad_core::pipeline::call::Call;
use tactpad_core::pipeline::health::Health;
use tactpad_core::pipeline::link::reading::Reading;
use tactpad_core::pipeline::link::{Fault, Link, LinkEvent};
use tactpad_core::pipeline::signal::Scale;
use tactpad_core::quantity::CHANNELS;
use tactpad_core::time::{HostInstant, StreamInstant};

/// One sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BenchSample {
    /// Seconds on the pad's clock since the stream began.
    pub t_s: f64,
    /// What each input reads.
    pub uv: [f64; CHANNELS],
    /// Whether an input is at the end of its range, or its bridge is open.
    pub is_out_of_range: [bool; CHANNELS],
}

/// What the stream brings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StreamEvent {
    /// A sample of nine channels.
    Sample(BenchSample),
    /// The pad began anew, or its readings have another scale now: what was heard before does not go on.
    Anew,
    /// The excitation or the reference is wrong, so that no reading counts.
    SupplyFault,
    /// The pad has another number of channels.
    OtherChannels,
}

/// Makes samples of a pad's calls.
#[derive(Debug)]
pub struct SampleReader {
    link: Link,
    health: Health,
    scale: Scale,
    identity: Option<Identity>,
    begin: Option<StreamInstant>,
}

impl Default for SampleReader {
    fn default() -> Self {
        Self {
            link: Link::new(),
            health: Health::default(),
            scale: Scale::unidentified(),
            identity: None,
            begin: None,
        }
    }
}

impl SampleReader {
    /// Makes a call.
    pub fn apply(&mut self, now: HostInstant, call: Call<'_>, mut take: impl FnMut(StreamEvent)) {
        match call {
            Call::Bytes(bytes) => {
                for byte in bytes {
                    let event = self.link.push(now, *byte, &mut self.health);
                    if let Some(event) = event {
                        self.heard(&event, &mut take);
                    }
                }
            }
            Call::Unplugged => {
                self.link.unplug(now);
                self.identity = None;
                take(StreamEvent::Anew);
            }
            _ => {}
        }
    }

    /// Who the pad is, once it has told.
    pub const fn identity(&self) -> Option<&Identity> {
        self.identity.as_ref()
    }

    /// Frames that are missing.
    pub const fn frames_lost(&self) -> u64 {
        self.health.frames_lost
    }

    /// Frames that were damaged.
    pub const fn frames_damaged(&self) -> u64 {
        self.health.frames_damaged
    }

    fn heard(&mut self, event: &LinkEvent, take: &mut impl FnMut(StreamEvent)) {
        match event {
            LinkEvent::Sample { at, reading, fault } => {
                if matches!(fault, Some(Fault::Restarted | Fault::TimeJump)) {
                    take(StreamEvent::Anew);
                }
                self.health.samples += 1;
                take(self.sample(*at, reading));
            }
            LinkEvent::Identity(identity) => {
                self.identity = Some(*identity);
                let scale = Scale::of(identity).unwrap_or_else(Scale::unidentified);
                if std::mem::replace(&mut self.scale, scale) != scale {
                    take(StreamEvent::Anew);
                }
            }
            LinkEvent::Fault(_) | LinkEvent::NewerVersion(_) => {}
        }
    }

    fn sample(&mut self, at: StreamInstant, reading: &Reading) -> StreamEvent {
        let Some(counts) = reading.nine_counts() else { return StreamEvent::OtherChannels };
        if reading.status.supply_fault() {
            return StreamEvent::SupplyFault;
        }
        let begin = *self.begin.get_or_insert(at);
        let limit = 2_f64.powi(i32::from(self.scale.count_bits) - 1) - 1.0;
        let is_at_end = |count: i32| f64::from(count).abs() >= limit;
        StreamEvent::Sample(BenchSample {
            t_s: 1e-6 * at.us_since(begin) as f64,
            uv: counts.map(|count| self.scale.uv_per_count * f64::from(count)),
            is_out_of_range: std::array::from_fn(|k| {
                reading.status.is_out_of_range(k) || is_at_end(counts[k])
            }),
        })
    }
}
