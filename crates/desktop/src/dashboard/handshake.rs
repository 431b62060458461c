//! The handshake by which a page finds the bridge again: the page sends a nonce, and whoever answers proves itself before it is told anything.

use std::sync::Arc;

use axum::extract::ConnectInfo;
use axum::extract::rejection::JsonRejection;
use axum::http::{HeaderMap, StatusCode, header};
use axum::{Extension, Json};
use serde::{Deserialize, Serialize};

use super::api::body;
use super::guard::{Guard, HandshakeAnswer, text};
use super::listener::Peer;
use super::refusal::Refusal;

/// Hexadecimal digits of a nonce.
const NONCE_DIGITS: usize = 64;

/// What a page sends.
#[derive(Deserialize)]
pub(super) struct HandshakeRequest {
    /// A number that it never used before, in hexadecimal digits.
    nonce: String,
}

/// The keys of a page, as long as it is open.
#[derive(Serialize)]
pub(super) struct PageKeys {
    /// By which it tells that an answer is the program's.
    proofs: String,
    /// By which it keeps drafts in the browser.
    drafts: String,
}

/// `POST /handshake`: says that this is the user's own program, and where the page is now. Only this user's programs are told.
pub(super) async fn answer(
    ConnectInfo(peer): ConnectInfo<Peer>,
    Extension(guard): Extension<Arc<Guard>>,
    headers: HeaderMap,
    request: Result<Json<HandshakeRequest>, JsonRejection>,
) -> Result<Json<HandshakeAnswer>, Refusal> {
    if !peer.is_own {
        let error = "another user's program asks: use the address that `tactpad ctl dashboard` prints";
        return Err(Refusal::new(StatusCode::FORBIDDEN, error));
    }
    let HandshakeRequest { nonce } = body(request)?;
    if nonce.len() != NONCE_DIGITS || !nonce.bytes().all(|digit| digit.is_ascii_hexdigit()) {
        let error = format!("a nonce has {NONCE_DIGITS} hexadecimal digits");
        return Err(Refusal::new(StatusCode::BAD_REQUEST, error));
    }
    Ok(Json(guard.handshake(text(&headers, header::HOST).unwrap_or_default(), &nonce)))
}

/// `GET /api/keys`: what a page needs to know the program again, and to keep drafts where others may look.
pub(super) async fn keys(Extension(guard): Extension<Arc<Guard>>) -> Json<PageKeys> {
    Json(PageKeys { proofs: guard.key().of_proofs(), drafts: guard.key().of_drafts() })
}
