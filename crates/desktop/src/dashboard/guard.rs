//! Who may ask: only a page that this server gave, in a browser of this machine, with this start's token.
//!
//! A page of another origin can make a browser send requests here, and a name that it owns can be made to lead here. So the host must be
//! this server's own address, an origin, where the browser tells one, must be this server, and everything but the page's own files asks for
//! the token, which no other page knows.

use std::fs::File;
use std::io::{self, Read};
use std::sync::Arc;

use axum::Extension;
use axum::extract::{ConnectInfo, Request, State};
use axum::http::header::{self, HeaderMap, HeaderName, HeaderValue};
use axum::http::{Method, StatusCode, Uri};
use axum::middleware::Next;
use axum::response::{IntoResponse, Redirect, Response};

use super::listener::Peer;
use super::refusal::Refusal;

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

/// The port of this server, and the token that requests need.
#[derive(Clone, Debug)]
pub(super) struct Guard {
    port: u16,
    token: String,
}

impl Guard {
    /// A guard with a new token.
    ///
    /// # Errors
    /// The system has no random numbers.
    pub(super) fn new(port: u16) -> io::Result<Self> {
        let mut bytes = [0; TOKEN_BYTES];
        File::open("/dev/urandom")?.read_exact(&mut bytes)?;
        Ok(Self { port, token: bytes.iter().map(|byte| format!("{byte:02x}")).collect() })
    }

    /// The address that shows the page.
    pub(super) fn url(&self) -> String {
        format!("http://127.0.0.1:{}/?token={}", self.port, self.token)
    }

    fn hosts(&self) -> [String; 3] {
        ["127.0.0.1", "localhost", "[::1]"].map(|name| format!("{name}:{}", self.port))
    }

    /// Refuses what nobody may ask.
    fn check(&self, method: &Method, uri: &Uri, headers: &HeaderMap) -> Result<(), Refusal> {
        let hosts = self.hosts();
        if !text(headers, header::HOST).is_some_and(|host| hosts.iter().any(|own| own == host)) {
            return Err(Refusal::new(
                StatusCode::FORBIDDEN,
                "the host is not this server: use the address that it printed",
            ));
        }
        let is_own = |origin: &str| {
            origin.strip_prefix("http://").is_some_and(|origin| hosts.iter().any(|own| own == origin))
        };
        let is_foreign =
            headers.contains_key(header::ORIGIN) && !text(headers, header::ORIGIN).is_some_and(is_own);
        let site = headers.get(SITE).map(HeaderValue::as_bytes);
        if is_foreign
            || site.is_some_and(|site| !matches!(site, b"same-origin" | b"none") && *method != Method::GET)
        {
            return Err(Refusal::new(StatusCode::FORBIDDEN, "another page may not ask here"));
        }
        let is_navigation =
            uri.path() == OPEN_PATH && site.is_none_or(|site| matches!(site, b"same-origin" | b"none"));
        let is_open = uri.path() == OPEN[0] || uri.path().starts_with(OPEN[1]) || is_navigation;
        if !is_open && !self.has_token(uri, headers) {
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

fn text(headers: &HeaderMap, name: HeaderName) -> Option<&str> {
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
        Guard { port: 8080, token: "abc".into() }
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
            ("127.0.0.1:8080", 200),
            ("localhost:8080", 200),
            ("[::1]:8080", 200),
            ("127.0.0.1", 403),
            ("127.0.0.1:8081", 403),
            ("evil.example:8080", 403),
            ("127.0.0.1:8080.evil.example", 403),
        ] {
            assert_eq!(status(&Method::GET, "/", &[("host", host)]), expected, "{host}");
        }
        assert_eq!(status(&Method::GET, "/", &[]), 403);
    }

    #[test]
    fn another_origin_is_refused_before_its_token_is_looked_at() {
        let host = ("host", "127.0.0.1:8080");
        let asked =
            |extra: (&'static str, &str)| status(&Method::POST, "/api/pause?token=abc", &[host, extra]);
        assert_eq!(asked(("origin", "http://127.0.0.1:8080")), 200);
        for origin in
            ["http://evil.example", "null", "https://127.0.0.1:8080", "http://127.0.0.1:80801", "file://"]
        {
            assert_eq!(asked(("origin", origin)), 403, "{origin}");
        }
        assert_eq!(asked(("sec-fetch-site", "cross-site")), 403);
        assert_eq!(asked(("sec-fetch-site", "same-origin")), 200);
    }

    #[test]
    fn everything_but_the_page_needs_the_whole_token() {
        let host = ("host", "127.0.0.1:8080");
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
                [("host", "127.0.0.1:8080"), ("authorization", "Bearer abc"), ("content-length", length)];
            status(&Method::PUT, "/api/profile/x", &headers)
        };
        assert_eq!((asked("1048576"), asked("1048577"), asked("104857600")), (200, 413, 413));
    }

    #[test]
    fn tokens_are_new_and_long() {
        let [first, second] = [Guard::new(1), Guard::new(1)].map(|guard| guard.unwrap().token);
        assert!(first != second && first.len() == 2 * TOKEN_BYTES);
    }
}
