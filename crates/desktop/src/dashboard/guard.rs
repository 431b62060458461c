//! Who may ask: only a page that this server gave, in a browser of this machine, with this start's token.
//!
//! A page of another origin can make a browser send requests here, and a name that it owns can be made to lead here. So the host must be
//! this server's own address, an origin, where the browser tells one, must be this server, and everything but the page's own files asks for
//! the token, which no other page knows.
//!
//! Whatever once answered at an address can leave a program in the browser there. So each start has an address at which nobody was before.
//! At those of earlier starts, to which pages come back, there are the page's files and the way to the new address, and no token counts.

use std::io;
use std::net::SocketAddrV4;
use std::sync::Arc;

use axum::Extension;
use axum::extract::{ConnectInfo, Request, State};
use axum::http::header::{self, HeaderMap, HeaderName, HeaderValue};
use axum::http::{Method, StatusCode, Uri};
use axum::middleware::Next;
use axum::response::{IntoResponse, Redirect, Response};
use serde::Serialize;

use super::listener::Peer;
use super::refusal::Refusal;
use super::user_key::{Proven, UserKey, hex, random};

/// A body may be this long.
pub(super) const BODY_BYTES_MAX: usize = 1 << 20;

/// Random bytes of a token.
const TOKEN_BYTES: usize = 16;

/// Paths that are served to everybody on this machine: the page's own files, which hold no secret.
const OPEN: [&str; 2] = ["/", "/page/"];

/// Leads this user's programs to the page, token and all: an address with the token would stand in the arguments of the program
/// that opens it, which every user of the machine can read.
pub(super) const OPEN_PATH: &str = "/open";

/// Nothing is loaded from elsewhere, no other page shows this one, and no text of the page runs as a program.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; \
                      font-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// A report is one file with its own styles and pictures, and no program.
const POLICY_OF_REPORTS: &str = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; \
                                 form-action 'none'; frame-ancestors 'none'; sandbox";

/// Where a page finds out whether this is the program, and where the page is now.
pub(super) const HANDSHAKE_PATH: &str = "/handshake";

/// The addresses of this server, the token that requests need, and the key by which it proves itself.
#[derive(Clone, Debug)]
pub(super) struct Guard {
    address: SocketAddrV4,
    /// Addresses of earlier starts.
    earlier: Vec<SocketAddrV4>,
    token: String,
    key: UserKey,
}

/// The answer to a handshake.
#[derive(Debug, Serialize)]
pub(super) struct HandshakeAnswer {
    /// Where the page is now.
    origin: String,
    /// The token, where the page is asked; empty at an earlier address.
    token: String,
    /// That this is the program that has the user's key.
    proof: String,
}

/// Which of its addresses a request names.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    Present,
    Earlier,
}

impl Guard {
    /// A guard with a new token.
    ///
    /// # Errors
    /// The system has no random numbers.
    pub(super) fn new(address: SocketAddrV4, earlier: Vec<SocketAddrV4>, key: UserKey) -> io::Result<Self> {
        Ok(Self { address, earlier, token: hex(&random::<TOKEN_BYTES>()?), key })
    }

    /// Where the page of this start is.
    pub(super) const fn address(&self) -> SocketAddrV4 {
        self.address
    }

    /// The address that shows the page.
    pub(super) fn url(&self) -> String {
        format!("http://{}/?token={}", self.address, self.token)
    }

    /// The keys that the page's own programs have.
    pub(super) const fn key(&self) -> &UserKey {
        &self.key
    }

    /// The answer to a page that sent `nonce` to `host`.
    pub(super) fn handshake(&self, host: &str, nonce: &str) -> HandshakeAnswer {
        let is_present = self.place(host) == Some(Place::Present);
        let token = if is_present { self.token.clone() } else { String::new() };
        let origin = format!("http://{}", self.address);
        let proof = self.key.proof(Proven { host, nonce, origin: &origin, token: &token });
        HandshakeAnswer { origin, token, proof }
    }

    fn place(&self, host: &str) -> Option<Place> {
        // Every spelling but this one could lead elsewhere.
        let is = |address: &SocketAddrV4| address.to_string() == host;
        let earlier = || self.earlier.iter().any(is).then_some(Place::Earlier);
        if is(&self.address) { Some(Place::Present) } else { earlier() }
    }

    /// Refuses what nobody may ask.
    fn check(&self, method: &Method, uri: &Uri, headers: &HeaderMap) -> Result<(), Refusal> {
        let host = text(headers, header::HOST).unwrap_or_default();
        let Some(place) = self.place(host) else {
            return Err(Refusal::new(
                StatusCode::FORBIDDEN,
                "the host is not this server: use the address that it printed",
            ));
        };
        let is_own = |origin: &str| origin.strip_prefix("http://") == Some(host);
        let is_foreign =
            headers.contains_key(header::ORIGIN) && !text(headers, header::ORIGIN).is_some_and(is_own);
        let site = headers.get(SITE).map(HeaderValue::as_bytes);
        if is_foreign
            || site.is_some_and(|site| !matches!(site, b"same-origin" | b"none") && *method != Method::GET)
        {
            return Err(Refusal::new(StatusCode::FORBIDDEN, "another page may not ask here"));
        }
        let is_file = uri.path() == OPEN[0] || uri.path().starts_with(OPEN[1]);
        let is_navigation =
            uri.path() == OPEN_PATH && site.is_none_or(|site| matches!(site, b"same-origin" | b"none"));
        let is_open = is_file || is_navigation || uri.path() == HANDSHAKE_PATH;
        if !is_open && (place == Place::Earlier || !self.has_token(uri, headers)) {
            let error = "this needs the token of the address: open the page from the tray, or with `tactpad ctl dashboard`";
            return Err(Refusal::new(StatusCode::UNAUTHORIZED, error));
        }
        let length = text(headers, header::CONTENT_LENGTH).and_then(|length| length.parse::<u64>().ok());
        if length.is_some_and(|length| length > BODY_BYTES_MAX as u64) {
            return Err(too_long());
        }
        Ok(())
    }

    /// Whether the token stands in the header or, as browsers' websockets have no header of their own, in the address.
    fn has_token(&self, uri: &Uri, headers: &HeaderMap) -> bool {
        let given = text(headers, header::AUTHORIZATION).and_then(|it| it.strip_prefix("Bearer "));
        let in_address = || uri.query()?.split('&').find_map(|pair| pair.strip_prefix("token="));
        given.or_else(in_address).is_some_and(|given| is_same(given.as_bytes(), self.token.as_bytes()))
    }
}

/// From where a browser says that a request comes.
const SITE: HeaderName = HeaderName::from_static("sec-fetch-site");

/// A body that is too long.
pub(super) fn too_long() -> Refusal {
    Refusal::new(StatusCode::PAYLOAD_TOO_LARGE, "a request has one megabyte at most")
}

pub(super) fn text(headers: &HeaderMap, name: HeaderName) -> Option<&str> {
    let mut all = headers.get_all(name).iter();
    let only = all.next().filter(|_| all.next().is_none())?;
    only.to_str().ok()
}

/// Whether both are the same, in a time that does not tell how much of them is.
fn is_same(given: &[u8], own: &[u8]) -> bool {
    given.len() == own.len()
        && given.iter().zip(own).fold(0, |other, (given, own)| other | (given ^ own)) == 0
}

/// Leads to the page, if this user asks.
pub(super) async fn open(
    ConnectInfo(peer): ConnectInfo<Peer>,
    Extension(guard): Extension<Arc<Guard>>,
) -> Result<Redirect, Refusal> {
    if peer.is_own {
        Ok(Redirect::to(&guard.url()))
    } else {
        let error = "another user's program asks: use the address that `tactpad ctl dashboard` prints";
        Err(Refusal::new(StatusCode::FORBIDDEN, error))
    }
}

/// Lets a request through, or refuses it; and tells the browser what the answer may do.
pub(super) async fn watch(State(guard): State<Arc<Guard>>, request: Request, next: Next) -> Response {
    let is_report = request.uri().path().starts_with("/report/");
    let mut response = match guard.check(request.method(), request.uri(), request.headers()) {
        Ok(()) => next.run(request).await,
        Err(refusal) => refusal.into_response(),
    };
    let policy = if is_report { POLICY_OF_REPORTS } else { POLICY };
    let fixed = [
        (header::CONTENT_SECURITY_POLICY, policy),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::X_FRAME_OPTIONS, "DENY"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::CACHE_CONTROL, "no-store"),
        (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
        (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    ];
    let headers = response.headers_mut();
    for (name, value) in fixed {
        headers.insert(name, HeaderValue::from_static(value));
    }
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    fn guard() -> Guard {
        let at = |text: &str| text.parse().unwrap();
        let key = UserKey::from_hex(&"07".repeat(32)).unwrap();
        let mut guard = Guard::new(at("127.1.2.3:8080"), vec![at("127.4.5.6:8080")], key).unwrap();
        guard.token = "abc".into();
        guard
    }

    fn status(method: &Method, uri: &str, headers: &[(&'static str, &str)]) -> u16 {
        let headers = headers
            .iter()
            .map(|(name, value)| (HeaderName::from_static(name), HeaderValue::from_str(value).unwrap()));
        let checked = guard().check(method, &uri.parse().unwrap(), &headers.collect());
        checked.map_or_else(|refusal| refusal.status.as_u16(), |()| 200)
    }

    #[test]
    fn the_host_is_this_server() {
        for (host, expected) in [
            ("127.1.2.3:8080", 200),
            ("127.4.5.6:8080", 200),
            ("127.1.2.3", 403),
            ("127.1.2.3:8081", 403),
            ("127.0.0.1:8080", 403),
            ("localhost:8080", 403),
            ("[::1]:8080", 403),
            ("evil.example:8080", 403),
            ("127.1.2.3:8080.evil.example", 403),
            ("127.1.2.003:8080", 403),
        ] {
            assert_eq!(status(&Method::GET, "/", &[("host", host)]), expected, "{host}");
        }
        assert_eq!(status(&Method::GET, "/", &[]), 403);
    }

    #[test]
    fn another_origin_is_refused_before_its_token_is_looked_at() {
        let host = ("host", "127.1.2.3:8080");
        let asked =
            |extra: (&'static str, &str)| status(&Method::POST, "/api/pause?token=abc", &[host, extra]);
        assert_eq!(asked(("origin", "http://127.1.2.3:8080")), 200);
        for origin in [
            "http://evil.example",
            "null",
            "https://127.1.2.3:8080",
            "http://127.1.2.3:80801",
            "http://127.4.5.6:8080",
            "file://",
        ] {
            assert_eq!(asked(("origin", origin)), 403, "{origin}");
        }
        assert_eq!(asked(("sec-fetch-site", "cross-site")), 403);
        assert_eq!(asked(("sec-fetch-site", "same-origin")), 200);
    }

    #[test]
    fn everything_but_the_page_needs_the_whole_token() {
        let host = ("host", "127.1.2.3:8080");
        let asked =
            |uri: &str, more: &[(&'static str, &str)]| status(&Method::GET, uri, &[&[host], more].concat());
        assert_eq!(asked("/page/main.js", &[]), 200);
        for uri in [
            "/api/status",
            "/api/status?token=",
            "/api/status?token=ab",
            "/api/status?token=abcd",
            "/report/0",
            "/pages",
        ] {
            assert_eq!(asked(uri, &[]), 401, "{uri}");
        }
        assert_eq!(asked("/api/status?x=1&token=abc", &[]), 200);
        assert_eq!(asked("/api/status", &[("authorization", "Bearer abc")]), 200);
        assert_eq!(asked("/api/status", &[("authorization", "Bearer abd")]), 401);
        assert_eq!(asked("/api/status", &[("authorization", "abc")]), 401);
    }

    #[test]
    fn a_long_body_is_refused_before_it_is_read() {
        let asked = |length: &str| {
            let headers =
                [("host", "127.1.2.3:8080"), ("authorization", "Bearer abc"), ("content-length", length)];
            status(&Method::PUT, "/api/profile/x", &headers)
        };
        assert_eq!((asked("1048576"), asked("1048577"), asked("104857600")), (200, 413, 413));
    }

    #[test]
    fn tokens_are_new_and_long() {
        let new = || {
            let guard = guard();
            Guard::new(guard.address, guard.earlier, guard.key).unwrap().token
        };
        assert!(new() != new() && new().len() == 2 * TOKEN_BYTES);
    }

    #[test]
    fn an_earlier_address_has_the_pages_files_and_the_way_on_and_knows_no_token() {
        let host = ("host", "127.4.5.6:8080");
        let asked = |uri: &str| status(&Method::GET, uri, &[host, ("authorization", "Bearer abc")]);
        assert_eq!([asked("/"), asked("/page/main.js"), asked("/open"), asked("/handshake")], [200; 4]);
        assert_eq!([asked("/api/status"), asked("/report/0"), asked("/sheet/marks.svg")], [401; 3]);
        let told = |host: &str| guard().handshake(host, "1");
        let (here, there) = (told("127.1.2.3:8080"), told("127.4.5.6:8080"));
        assert_eq!([here.origin.as_str(), &there.origin], ["http://127.1.2.3:8080"; 2]);
        assert_eq!([here.token.as_str(), &there.token], ["abc", ""]);
        assert_ne!(here.proof, there.proof);
    }
}
