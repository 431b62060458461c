//! The server: opens addresses of the loopback interface and answers on a thread of its own.

use std::io;
use std::net::{Ipv4Addr, SocketAddrV4, TcpListener};
use std::sync::mpsc::Receiver;
use std::sync::{Arc, Mutex};
use std::thread;

use axum::extract::DefaultBodyLimit;
use axum::routing::{get, post};
use axum::{Extension, Router, middleware};

use super::app_state::{AppState, BridgeHandles};
use super::feed::Feed;
use super::guard::{BODY_BYTES_MAX, Guard, HANDSHAKE_PATH, OPEN_PATH, open, watch};
use super::host::DashboardHost;
use super::listener::{LimitedListener, Peer};
use super::shadow::{self, ShadowState};
use super::user_key::{UserKey, random};
use super::{api, assets, handshake, websocket, words};
use tactpad_bridge::event_loop::Bridge;
use tactpad_bridge::observer::{Observation, Observer, observe};
use tactpad_bridge::request::RequestSender;
use tactpad_bridge::timing::Timing;

/// A server that has its addresses, but shows no bridge yet.
pub struct Dashboard {
    listeners: Vec<TcpListener>,
    guard: Guard,
    observed: Receiver<Observation>,
}

impl Dashboard {
    /// Opens an address of the loopback interface at which nobody was before, on the port of the first of the `earlier` ones if that is
    /// free; and those themselves as far as they are free. The observer belongs to the bridge that is to be shown.
    ///
    /// # Errors
    /// There is no port, or the system has no random numbers.
    pub fn open(earlier: &[SocketAddrV4], key: UserKey) -> io::Result<(Self, Observer)> {
        let ip = fresh_ip()?;
        let port = earlier.first().map_or(0, SocketAddrV4::port);
        let listener = TcpListener::bind((ip, port)).or_else(|_| TcpListener::bind((ip, 0)))?;
        let address = SocketAddrV4::new(ip, listener.local_addr()?.port());
        let opened = |address: &SocketAddrV4| Some((TcpListener::bind(address).ok()?, *address));
        let (again, earlier): (Vec<_>, _) = earlier.iter().filter_map(opened).unzip();
        let listeners: Vec<_> = [listener].into_iter().chain(again).collect();
        listeners.iter().try_for_each(|listener| listener.set_nonblocking(true))?;
        let (observer, observed) = observe();
        Ok((Self { listeners, guard: Guard::new(address, earlier, key)?, observed }, observer))
    }

    /// The address of this start, at which later ones are to be, too.
    pub const fn address(&self) -> SocketAddrV4 {
        self.guard.address()
    }

    /// The address that shows the page; whoever has it can use the bridge.
    pub fn url(&self) -> String {
        self.guard.url()
    }

    /// Shows `bridge` from now on, until the process ends. `timing` tells of its reads and writes.
    ///
    /// # Errors
    /// The system has no threads to give.
    pub fn start(
        self,
        bridge: &Bridge,
        sender: RequestSender,
        timing: Timing,
        host: Arc<dyn DashboardHost>,
    ) -> io::Result<()> {
        let (feed, shadow) = (Arc::new(Feed::new()), Arc::new(Mutex::new(ShadowState::default())));
        shadow::start(self.observed, Arc::clone(&feed), Arc::clone(&shadow))?;
        let handles =
            BridgeHandles { snapshot: bridge.snapshot(), timing, end_to_end: bridge.shared_latency() };
        let app = Arc::new(AppState::new(sender, host, feed, shadow, handles));
        let router = router(app, Arc::new(self.guard));
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let listeners = self.listeners;
        thread::Builder::new().name("dashboard".into()).spawn(move || {
            // It serves until the process ends; a port that fails has no one to tell.
            let _ = runtime.block_on(async move {
                let listeners = listeners.into_iter().map(tokio::net::TcpListener::from_std);
                let listener = LimitedListener::new(listeners.collect::<io::Result<_>>()?);
                axum::serve(listener, router.into_make_service_with_connect_info::<Peer>()).await
            });
        })?;
        Ok(())
    }
}

/// An address of the loopback interface, one of four million; few programs use any of them.
fn fresh_ip() -> io::Result<Ipv4Addr> {
    let [second, third, fourth] = random()?;
    Ok(Ipv4Addr::new(127, 64 + second % 64, third, fourth))
}

fn router(app: Arc<AppState>, guard: Arc<Guard>) -> Router {
    Router::new()
        .route("/", get(assets::index))
        .route(OPEN_PATH, get(open))
        .route(HANDSHAKE_PATH, post(handshake::answer))
        .route("/api/keys", get(handshake::keys))
        .route("/page/{*path}", get(assets::file))
        .route("/report/{id}", get(api::report))
        .route("/sheet/{name}", get(api::sheet))
        .route("/api/live", get(websocket::upgrade))
        .route("/api/status", get(api::status))
        .route("/api/schema", get(api::schema))
        .route("/api/words", get(words::words))
        .route("/api/profiles", get(api::profiles))
        .route("/api/profile/{name}", get(api::profile).put(api::save).delete(api::delete))
        .route("/api/profile/{name}/history", get(api::history))
        .route("/api/profile/{name}/history/{id}", get(api::earlier))
        .route("/api/profile/{name}/rename", post(api::rename))
        .route("/api/profile/{name}/export", get(api::export))
        .route("/api/profile/{name}/export/{decoder}", get(api::export_with_decoder))
        .route("/api/import", post(api::import))
        .route("/api/decoders", get(api::decoders))
        .route("/api/play", post(api::play))
        .route("/api/draft", post(api::draft))
        .route("/api/preview", post(api::preview).delete(api::end_preview))
        .route("/api/rewind", post(api::rewind))
        .route("/api/sheet", post(api::profile_sheet))
        .route("/api/doctor", get(api::doctor))
        .route("/api/reports", get(api::reports))
        .route("/api/guides", get(api::guides))
        .route("/api/guides/{id}", post(api::guide))
        .route("/api/{action}", post(api::act))
        .with_state(app)
        .layer(DefaultBodyLimit::max(BODY_BYTES_MAX))
        .layer(middleware::from_fn_with_state(Arc::clone(&guard), watch))
        .layer(Extension(guard))
}
