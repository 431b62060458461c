//! The feed of the live bridge for its pages: the newest moment, and the events since a reader's last look.

use std::sync::{Mutex, MutexGuard, PoisonError};

use tokio::sync::watch;

use super::ring::Ring;
use tactpad_bridge::clock::Clock;
use tactpad_bridge::snapshot::Uncertainty;
use tactpad_core::pipeline::control::OutputEvent;
use tactpad_core::pipeline::mapping::live::intent::Level;
use tactpad_core::pipeline::mapping::live::verdict::Verdict;
use tactpad_core::pipeline::mapping::profile::Profile;
use tactpad_core::quantity::{CHANNELS, Contact};
use tactpad_core::time::{HostInstant, StreamInstant};

/// Two seconds of points: a reader who stops for longer misses some, and is told how many.
const POINTS_MAX: usize = 1_000;
const EVENTS_MAX: usize = 1_000;
const PRESSES_MAX: usize = 200;

/// The pad at one moment.
#[derive(Clone, Debug)]
pub(super) struct Moment {
    /// The clock of `at`.
    pub(super) clock: Clock,
    /// When the newest call was made.
    pub(super) at: HostInstant,
    /// Stream time.
    pub(super) t: StreamInstant,
    pub(super) contact: Option<Contact>,
    pub(super) uncertainty: Option<Uncertainty>,
    pub(super) channels_uv: Option<[f32; CHANNELS]>,
    pub(super) held: Vec<Level>,
    /// Whether contacts become events.
    pub(super) is_playing: bool,
    /// The mean time between samples; 0 without samples.
    pub(super) period_us: u64,
}

/// A point of the trace: where the finger was, or that it was lifted.
pub(super) type TracePoint = (StreamInstant, Option<Contact>);

/// The events of some calls, and the moment after them.
#[derive(Debug, Default)]
pub(super) struct FeedUpdate {
    /// The last moment, if there were any calls.
    pub(super) now: Option<Moment>,
    pub(super) trace: Vec<TracePoint>,
    pub(super) events: Vec<OutputEvent>,
    pub(super) presses: Vec<Verdict>,
    /// The profile, if it is another one.
    pub(super) profile: Option<Box<Profile>>,
}

/// The contents of the feed.
#[derive(Debug)]
pub(super) struct FeedContents {
    pub(super) now: Option<Moment>,
    pub(super) trace: Ring<TracePoint>,
    pub(super) events: Ring<OutputEvent>,
    pub(super) presses: Ring<Verdict>,
    pub(super) profile: Option<Box<Profile>>,
    /// How many profiles there were.
    pub(super) profiles: u64,
}

/// The newest of the bridge, for any number of readers.
#[derive(Debug)]
pub(super) struct Feed {
    newest: Mutex<FeedContents>,
    /// Counts what was added; 0 is the end.
    added: watch::Sender<u64>,
}

impl Feed {
    /// Nothing was seen yet.
    pub(super) fn new() -> Self {
        let newest = FeedContents {
            now: None,
            trace: Ring::new(POINTS_MAX),
            events: Ring::new(EVENTS_MAX),
            presses: Ring::new(PRESSES_MAX),
            profile: None,
            profiles: 0,
        };
        Self { newest: Mutex::new(newest), added: watch::Sender::new(1) }
    }

    /// Adds what was seen, if there was anything.
    pub(super) fn add(&self, seen: FeedUpdate) {
        let FeedUpdate { now: Some(now), trace, events, presses, profile } = seen else { return };
        let mut newest = self.newest();
        newest.now = Some(now);
        trace.into_iter().for_each(|it| newest.trace.push(it));
        events.into_iter().for_each(|it| newest.events.push(it));
        presses.into_iter().for_each(|it| newest.presses.push(it));
        if let Some(profile) = profile {
            newest.profile = Some(profile);
            newest.profiles += 1;
        }
        drop(newest);
        self.added.send_modify(|added| *added += 1);
    }

    /// The bridge has ended.
    pub(super) fn end(&self) {
        self.added.send_replace(0);
    }

    /// The contents.
    pub(super) fn newest(&self) -> MutexGuard<'_, FeedContents> {
        self.newest.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes whenever something is added; 0 once the bridge has ended.
    pub(super) fn added(&self) -> watch::Receiver<u64> {
        self.added.subscribe()
    }
}
