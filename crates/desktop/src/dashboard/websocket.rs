//! The websocket: the newest moment 83 times a second, what changes slowly four times a second.

use std::sync::Arc;
use std::time::Duration;

use axum::extract::State;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::response::{IntoResponse, Response};
use serde::{Deserialize, Serialize};
use tokio::time::{MissedTickBehavior, interval, timeout};

use super::app_state::{AppState, PageConnection};
use super::frame::{Cursor, json};
use super::refusal::Refusal;

/// How often what changes slowly is told.
const SLOW: Duration = Duration::from_millis(250);

/// How often guides look.
const GUIDES: Duration = Duration::from_millis(100);

/// A page that takes nothing for so long has gone.
const PATIENCE: Duration = Duration::from_secs(10);

/// The longest message of a page.
const MESSAGE_BYTES_MAX: usize = 4 << 10;

/// A message from the page.
#[derive(Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum PageMessage {
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
pub(super) async fn upgrade(State(app): State<Arc<AppState>>, upgrade: WebSocketUpgrade) -> Response {
    let Some(page) = app.enter() else {
        return Refusal::unavailable("too many pages look already: close one of them").into_response();
    };
    let upgrade = upgrade.max_message_size(MESSAGE_BYTES_MAX).max_frame_size(MESSAGE_BYTES_MAX);
    upgrade.on_upgrade(move |socket| async move {
        // Whatever ends it, the page has gone.
        let _ = serve(socket, &app, page).await;
    })
}

/// Serves a page until it, or the bridge, goes.
async fn serve(mut socket: WebSocket, app: &AppState, _page: PageConnection) -> Result<(), axum::Error> {
    let mut added = app.feed.added();
    let mut cursor = Cursor::now(&app.feed);
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
                cursor.messages(&app.feed)
            }
            _ = slow.tick() => vec![app.status_message()],
            _ = guides.tick() => guided(app, &mut changes),
            message = socket.recv() => match message {
                Some(Ok(Message::Text(message))) => answer(app, &message).into_iter().collect(),
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
fn guided(app: &AppState, changes: &mut u64) -> Vec<String> {
    app.with_guides(|guides, context| {
        guides.update(context);
        let before = std::mem::replace(changes, guides.changes());
        if before == *changes { Vec::new() } else { guides.messages() }
    })
}

/// The answer to a message of the page; `None` for a message of an unknown form.
fn answer(app: &AppState, message: &str) -> Option<String> {
    let PageMessage::Ping { id } = serde_json::from_str(message).ok()?;
    let clock = app.feed.newest().now.as_ref()?.clock;
    Some(json(&Pong { kind: "pong", id, host_us: clock.now().as_ns() / 1_000 }))
}
