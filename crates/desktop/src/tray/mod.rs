//! The icon among those of the desktop: it shows what the bridge is doing, and its menu asks the bridge.
//!
//! It has a thread of its own, and neither that nor the bridge ever waits for the other: it looks at the snapshot some ten
//! times a second, changes what is shown where that has changed, and asks without waiting for an answer.

pub mod browser;
mod bus;
pub mod host;
mod icon;
mod icon_state;
mod menu;
mod view;

use std::io;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

use tray_icon::menu::MenuEvent;

use crate::tray::host::TrayHost;
use crate::tray::view::TrayView;
use tactpad_bridge::request::RequestSender;
use tactpad_bridge::snapshot::Snapshot;

/// It looks at the bridge this often.
const LOOK: Duration = Duration::from_millis(100);

/// A desktop that has not said within this time whether it has a place for the icon is not waited for.
const DESKTOP_LIMIT: Duration = Duration::from_secs(2);

/// Shows a bridge, until it ends; to be called once in a process. Where the desktop has no place for icons yet, the icon comes as
/// soon as there is one. The inner error says, to people, why it is not there now.
///
/// # Errors
/// The system has no thread to give.
pub fn start(
    host: Box<dyn TrayHost + Send>,
    snapshot: Arc<Mutex<Snapshot>>,
    sender: RequestSender,
) -> io::Result<Result<(), String>> {
    let (tell, told) = channel();
    thread::Builder::new().name("tray".into()).spawn(move || show(host, &snapshot, sender, &tell))?;
    Ok(told.recv_timeout(DESKTOP_LIMIT).unwrap_or_else(|_| Err("the session bus does not answer".into())))
}

/// The thread's work. Why the icon is not there now goes to `tell`; who waits for that may have given up.
fn show(
    host: Box<dyn TrayHost + Send>,
    snapshot: &Mutex<Snapshot>,
    sender: RequestSender,
    tell: &Sender<Result<(), String>>,
) {
    let (click, clicked) = channel();
    MenuEvent::set_event_handler(Some(move |event| {
        // Where nobody hears it any more, the bridge has ended.
        let _ = click.send(event);
    }));
    let place = bus::find_place();
    match TrayView::begin(host, sender, snapshot) {
        Ok(view) => {
            let _ = tell.send(place);
            attend(view, snapshot, &clicked);
        }
        Err(error) => {
            let _ = tell.send(Err(place.err().unwrap_or(error)));
        }
    }
}

/// Shows and asks until the bridge has ended.
fn attend(mut view: TrayView, snapshot: &Mutex<Snapshot>, clicked: &Receiver<MenuEvent>) {
    loop {
        match clicked.recv_timeout(LOOK) {
            Ok(event) => {
                if view.obey(event.id()).is_err() {
                    return;
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return,
        }
        view.renew(snapshot);
    }
}
