//! The websocket: the newest moment 83 times a second, what changes slowly four times a second.

use std::sync::Arc;
use std::time::Duration;

use axum::extract::State;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::response::{IntoResponse, Response};
use serde::{Deserialize, Serialize};
use tokio::time::{MissedTickBehavior, interval, timeout};

use super::frame::{Cursor, json};
use super::office::{Office, Page};
use super::refusal::Refusal;

/// How often what changes slowly is told.
const SLOW: Duration = Duration::from_millis(250);

/// How often guides look.
const GUIDES: Duration = Duration::from_millis(100);

/// A page that takes nothing for so long has gone.
const PATIENCE: Duration = Duration::from_secs(10);

/// The longest message of a page.
const MESSAGE_BYTES_MAX: usize = 4 << 10;

/// What a page says.
#[derive(Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum Said {
    /// It wants to know the bridge's time, to tell how old a frame is.
    Ping { id: u64 },
}

/// The bridge's time.
#[derive(Serialize)]
struct Pong {
    kind: &'static str,
    id: u64,
    host_us: u64,
}

/// Answers `GET /api/live`.
pub(super) async fn live(State(office): State<Arc<Office>>, upgrade: WebSocketUpgrade) -> Response {
    let Some(page) = office.enter() else {
        return Refusal::unavailable("too many pages look already: close one of them").into_response();
    };
    let upgrade = upgrade.max_message_size(MESSAGE_BYTES_MAX).max_frame_size(MESSAGE_BYTES_MAX);
    upgrade.on_upgrade(move |socket| async move {
        // Whatever ends it, the page has gone.
        let _ = serve(socket, &office, page).await;
    })
}

/// Serves a page until it, or the bridge, goes.
async fn serve(mut socket: WebSocket, office: &Office, _page: Page) -> Result<(), axum::Error> {
    let mut added = office.feed.added();
    let mut cursor = Cursor::now(&office.feed);
    let mut slow = interval(SLOW);
    slow.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let (mut guides, mut changes) = (interval(GUIDES), 0);
    guides.set_missed_tick_behavior(MissedTickBehavior::Delay);
    loop {
        let messages = tokio::select! {
            changed = added.changed() => {
                if changed.is_err() || *added.borrow_and_update() == 0 {
                    return socket.send(Message::Close(None)).await;
                }
                cursor.messages(&office.feed)
            }
            _ = slow.tick() => vec![office.slow()],
            _ = guides.tick() => guided(office, &mut changes),
            said = socket.recv() => match said {
                Some(Ok(Message::Text(said))) => answer(office, &said).into_iter().collect(),
                Some(Ok(Message::Binary(_) | Message::Ping(_) | Message::Pong(_))) => Vec::new(),
                Some(Ok(Message::Close(_))) | None => return Ok(()),
                Some(Err(error)) => return Err(error),
            },
        };
        for message in messages {
            match timeout(PATIENCE, socket.send(Message::Text(message.into()))).await {
                Ok(sent) => sent?,
                Err(_) => return Ok(()),
            }
        }
    }
}

/// Lets the guides look, and tells of them if anything changed.
fn guided(office: &Office, changes: &mut u64) -> Vec<String> {
    office.with_guides(|guides, scene| {
        guides.look(scene);
        let before = std::mem::replace(changes, guides.changes());
        if before == *changes { Vec::new() } else { guides.messages() }
    })
}

/// What a page is answered. What it says beside the form has no answer.
fn answer(office: &Office, said: &str) -> Option<String> {
    let Said::Ping { id } = serde_json::from_str(said).ok()?;
    let clock = office.feed.newest().now.as_ref()?.clock;
    Some(json(&Pong { kind: "pong", id, host_us: clock.now().as_ns() / 1_000 }))
}
