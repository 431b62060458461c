//! The state that the handlers of the page's requests share.

use std::io;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use serde_json::Value;

use super::feed::Feed;
use super::frame::{DescribedPad, StatusMessage, status_message};
use super::guides::guide::GuideContext;
use super::guides::list::Guides;
use super::host::DashboardHost;
use super::refusal::Refusal;
use super::replay_buffer::ReplayBuffer;
use super::shadow::ShadowState;
use tactpad_bridge::latency::Durations;
use tactpad_bridge::request::{Request, RequestSender};
use tactpad_bridge::snapshot::Snapshot;
use tactpad_bridge::timing::{ProfileDelays, Stages, Timing};
use tactpad_core::pipeline::mapping::read::ReadProfile;

/// So many pages may look at a time.
const PAGES_MAX: usize = 8;

/// The shared state of all request handlers: handles of the running bridge, its feed, and the guides.
pub(super) struct AppState {
    pub(super) sender: Arc<RequestSender>,
    pub(super) host: Arc<dyn DashboardHost>,
    pub(super) feed: Arc<Feed>,
    pub(super) shadow: Arc<Mutex<ShadowState>>,
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

/// The handles of a bridge through which its state and its times are read.
pub(super) struct BridgeHandles {
    pub(super) snapshot: Arc<Mutex<Snapshot>>,
    pub(super) timing: Timing,
    pub(super) end_to_end: Arc<Mutex<Durations>>,
}

/// A page that looks; it is forgotten when this is dropped.
pub(super) struct PageConnection(Arc<AppState>);

impl AppState {
    pub(super) fn new(
        sender: RequestSender,
        host: Arc<dyn DashboardHost>,
        feed: Arc<Feed>,
        shadow: Arc<Mutex<ShadowState>>,
        BridgeHandles { snapshot, timing, end_to_end }: BridgeHandles,
    ) -> Self {
        let (pages, previews) = (AtomicUsize::new(0), AtomicBool::new(false));
        let guides = Mutex::new(Guides::new());
        let sender = Arc::new(sender);
        Self { sender, host, feed, shadow, snapshot, timing, end_to_end, guides, pages, previews }
    }

    /// Asks the bridge and waits for its answer.
    pub(super) fn ask(&self, request: Request) -> Result<Value, Refusal> {
        let answer = self.sender.send_and_wait(request).map_err(|error| match error.kind() {
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
    pub(super) fn enter(self: &Arc<Self>) -> Option<PageConnection> {
        let entered = self.pages.fetch_update(Ordering::AcqRel, Ordering::Acquire, |pages| {
            (pages < PAGES_MAX).then_some(pages + 1)
        });
        entered.ok().map(|_| PageConnection(Arc::clone(self)))
    }

    /// The guides, and what they see now.
    pub(super) fn with_guides<T>(&self, work: impl FnOnce(&mut Guides, &GuideContext<'_>) -> T) -> T {
        let snapshot = self.snapshot.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let now = self.feed.newest().now.as_ref().map(|now| now.clock.now());
        let pad = self.shadow.lock().unwrap_or_else(PoisonError::into_inner).pad;
        let context = GuideContext {
            now: now.unwrap_or(snapshot.at),
            status: &snapshot.status,
            pad,
            profile: &|| {
                let name = self.host.playing();
                self.host.read(&name).map(|stored| (name, stored.text))
            },
            past: &|| self.past(),
            subscribe: &|| {
                self.shadow.lock().unwrap_or_else(PoisonError::into_inner).call_subscribers.subscribe()
            },
            sender: &self.sender,
            host: &self.host,
        };
        work(&mut self.guides.lock().unwrap_or_else(PoisonError::into_inner), &context)
    }

    /// The last minute of play.
    pub(super) fn past(&self) -> Option<ReplayBuffer> {
        self.shadow.lock().unwrap_or_else(PoisonError::into_inner).replay.clone()
    }

    /// The message of what changes slowly.
    pub(super) fn status_message(&self) -> String {
        let snapshot = self.snapshot.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let status = &snapshot.status;
        let status = StatusMessage {
            sentence: status.state.sentence(),
            warning_sentence: status.warning.map(|warning| warning.to_string()),
            profile_id: self.host.playing(),
            described: self.host.described().as_deref().map(DescribedPad::from),
            status,
        };
        let shadowed = self.shadow.lock().unwrap_or_else(PoisonError::into_inner).stages.clone();
        let live = self.timing.live();
        let stages = Stages { read: live.read, write: live.write, ..shadowed };
        let end_to_end = self.end_to_end.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let newest = self.feed.newest();
        let period_us = newest.now.as_ref().map_or(0, |now| now.period_us);
        let policy = newest.profile.as_ref().map(|profile| ProfileDelays::of(profile, period_us));
        drop(newest);
        status_message(status, &stages, &end_to_end, policy)
    }
}

impl Drop for PageConnection {
    fn drop(&mut self) {
        if self.0.pages.fetch_sub(1, Ordering::AcqRel) > 1 {
            return;
        }
        self.0.with_guides(Guides::on_page_closed);
        // Who tried a profile and went away has not kept it.
        if self.0.previews.swap(false, Ordering::AcqRel) {
            let _ = self.0.sender.send(Request::Profile(None));
        }
    }
}
