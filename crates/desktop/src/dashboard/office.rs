//! What the requests of the page act on.

use std::io;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use serde_json::Value;

use super::feed::Feed;
use super::frame::{Told, slow};
use super::guides::guide::Scene;
use super::guides::list::Guides;
use super::library::Library;
use super::past::Past;
use super::refusal::Refusal;
use super::shadow::Known;
use tactpad_bridge::latency::Durations;
use tactpad_bridge::request::{Asker, Request};
use tactpad_bridge::snapshot::Snapshot;
use tactpad_bridge::timing::{Policy, Stages, Timing};
use tactpad_core::pipeline::mapping::read::ReadProfile;

/// So many pages may look at a time.
const PAGES_MAX: usize = 8;

/// What is known of the running bridge, and how to ask it.
pub(super) struct Office {
    pub(super) asker: Arc<Asker>,
    pub(super) library: Arc<dyn Library>,
    pub(super) feed: Arc<Feed>,
    pub(super) known: Arc<Mutex<Known>>,
    pub(super) snapshot: Arc<Mutex<Snapshot>>,
    /// How long reading and writing take, where the bridge's pad and sink tell it.
    pub(super) timing: Timing,
    pub(super) end_to_end: Arc<Mutex<Durations>>,
    guides: Mutex<Guides>,
    /// Pages that look.
    pages: AtomicUsize,
    /// Whether one of them lets a profile be tried.
    previews: AtomicBool,
}

/// What the bridge gives to look at it.
pub(super) struct Sight {
    pub(super) snapshot: Arc<Mutex<Snapshot>>,
    pub(super) timing: Timing,
    pub(super) end_to_end: Arc<Mutex<Durations>>,
}

/// A page that looks; it is forgotten when this is dropped.
pub(super) struct Page(Arc<Office>);

impl Office {
    pub(super) fn new(
        asker: Asker,
        library: Arc<dyn Library>,
        feed: Arc<Feed>,
        known: Arc<Mutex<Known>>,
        Sight { snapshot, timing, end_to_end }: Sight,
    ) -> Self {
        let (pages, previews) = (AtomicUsize::new(0), AtomicBool::new(false));
        let guides = Mutex::new(Guides::new());
        let asker = Arc::new(asker);
        Self { asker, library, feed, known, snapshot, timing, end_to_end, guides, pages, previews }
    }

    /// Asks the bridge and waits for its answer.
    pub(super) fn ask(&self, request: Request) -> Result<Value, Refusal> {
        let answer = self.asker.answer(request).map_err(|error| match error.kind() {
            io::ErrorKind::TimedOut => {
                Refusal::unavailable("the bridge does not answer: if it was stopped, continue it")
            }
            _ => Refusal::unavailable("the bridge has ended: start it again"),
        })?;
        serde_json::from_str(&answer).map_err(|error| Refusal::unavailable(error.to_string()))
    }

    /// Plays a profile that is not kept.
    pub(super) fn preview(&self, read: ReadProfile) -> Result<Value, Refusal> {
        self.previews.store(true, Ordering::Release);
        self.ask(Request::Preview(Box::new(read)))
    }

    /// Plays what is kept again, if anything else is.
    pub(super) fn end_preview(&self) -> Result<Value, Refusal> {
        if self.previews.swap(false, Ordering::AcqRel) {
            return self.ask(Request::Profile(None));
        }
        Ok(serde_json::json!({"ok": true}))
    }

    /// A profile was asked for, or kept: nothing is tried any more.
    pub(super) fn forget_preview(&self) {
        self.previews.store(false, Ordering::Release);
    }

    /// Lets one more page look; `None` if there are too many.
    pub(super) fn enter(self: &Arc<Self>) -> Option<Page> {
        let entered = self.pages.fetch_update(Ordering::AcqRel, Ordering::Acquire, |pages| {
            (pages < PAGES_MAX).then_some(pages + 1)
        });
        entered.ok().map(|_| Page(Arc::clone(self)))
    }

    /// The guides, and what they see now.
    pub(super) fn with_guides<T>(&self, work: impl FnOnce(&mut Guides, &Scene<'_>) -> T) -> T {
        let snapshot = self.snapshot.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let now = self.feed.newest().now.as_ref().map(|now| now.clock.now());
        let pad = self.known.lock().unwrap_or_else(PoisonError::into_inner).pad;
        let scene = Scene {
            now: now.unwrap_or(snapshot.at),
            status: &snapshot.status,
            pad,
            profile: &|| {
                let name = self.library.playing();
                self.library.read(&name).map(|stored| (name, stored.text))
            },
            past: &|| self.past(),
            hear: &|| self.known.lock().unwrap_or_else(PoisonError::into_inner).ears.add(),
            asker: &self.asker,
            library: &self.library,
        };
        work(&mut self.guides.lock().unwrap_or_else(PoisonError::into_inner), &scene)
    }

    /// The last minute of play.
    pub(super) fn past(&self) -> Option<Past> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner).past.clone()
    }

    /// The message of what changes slowly.
    pub(super) fn slow(&self) -> String {
        let snapshot = self.snapshot.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let status = &snapshot.status;
        let told = Told {
            sentence: status.state.sentence(),
            warning_sentence: status.warning.map(|warning| warning.to_string()),
            profile_id: self.library.playing(),
            status,
        };
        let shadowed = self.known.lock().unwrap_or_else(PoisonError::into_inner).stages.clone();
        let live = self.timing.live();
        let stages = Stages { read: live.read, write: live.write, ..shadowed };
        let end_to_end = self.end_to_end.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let newest = self.feed.newest();
        let period_us = newest.now.as_ref().map_or(0, |now| now.period_us);
        let policy = newest.profile.as_ref().map(|profile| Policy::of(profile, period_us));
        drop(newest);
        slow(told, &stages, &end_to_end, policy)
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        if self.0.pages.fetch_sub(1, Ordering::AcqRel) > 1 {
            return;
        }
        self.0.with_guides(Guides::leave);
        // Who tried a profile and went away has not kept it.
        if self.0.previews.swap(false, Ordering::AcqRel) {
            let _ = self.0.asker.ask(Request::Profile(None));
        }
    }
}
