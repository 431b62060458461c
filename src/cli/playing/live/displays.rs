//! The displays of a running bridge beside the terminal: the dashboard and the tray.

use std::sync::{Arc, Mutex};

use clap::Args;

#[cfg(feature = "dashboard")]
use super::page::Page;
use super::profile_selection::ProfileSelection;
use super::runtime::BridgeName;
#[cfg(feature = "tray")]
use super::tray_profiles::TrayProfiles;
use crate::cli::failure::Failure;
#[cfg(feature = "tray")]
use crate::cli::printing::written::say;
use tactpad::bridge::event_loop::Bridge;
use tactpad::bridge::observer::Observer;
use tactpad::bridge::opening::OpenedPad;
#[cfg(any(feature = "dashboard", feature = "tray"))]
use tactpad::bridge::request::RequestSender;
use tactpad::bridge::requests::Requests;
use tactpad::bridge::sink::Sink;
use tactpad::bridge::timing::Timing;
use tactpad::pipeline::mapping::read::check::OutputChoice;
#[cfg(feature = "tray")]
use tactpad::tray;

/// What people ask for.
#[derive(Clone, Copy, Debug, Args)]
pub(super) struct DisplayOptions {
    /// Show the bridge in a page of this machine's browser, and change profiles there; its address is printed.
    #[cfg(feature = "dashboard")]
    #[arg(long)]
    dashboard: bool,
    /// Show an icon among those of the desktop: what the bridge is doing, and a menu that asks it.
    #[cfg(feature = "tray")]
    #[arg(long)]
    tray: bool,
}

/// The displays, opened before the bridge is made.
#[derive(Default)]
pub(super) struct OpenedDisplays {
    #[cfg(feature = "dashboard")]
    page: Option<Page>,
    #[cfg(feature = "tray")]
    tray: Option<(TrayProfiles, RequestSender)>,
    /// The observer of each call, for the page.
    pub(super) observer: Option<Observer>,
    /// Address of the page.
    pub(super) url: Option<String>,
    timing: Option<Timing>,
}

impl DisplayOptions {
    /// Whether there is a page.
    pub(super) const fn has_page(self) -> bool {
        #[cfg(feature = "dashboard")]
        return self.dashboard;
        #[cfg(not(feature = "dashboard"))]
        false
    }

    /// Opens the displays of the bridge that `requests` reach, by the name `reached` if it has one. `memory` is the state file of the page's addresses.
    pub(super) fn prepare(
        self,
        memory: &str,
        reached: Option<&BridgeName>,
        requests: &Requests,
        selection: &Arc<Mutex<ProfileSelection>>,
        output: OutputChoice,
    ) -> Result<OpenedDisplays, Failure> {
        let prepared = OpenedDisplays::default();
        #[cfg(feature = "dashboard")]
        let prepared = match self.dashboard {
            true => prepared.with_page(
                memory,
                reached.cloned(),
                requests.sender()?,
                Arc::clone(selection),
                output,
            )?,
            false => prepared,
        };
        #[cfg(feature = "tray")]
        let prepared = match self.tray {
            true => prepared.with_icon(requests.sender()?, Arc::clone(selection)),
            false => prepared,
        };
        let _ = (memory, reached, requests, selection, output);
        Ok(prepared)
    }
}

impl OpenedDisplays {
    #[cfg(feature = "dashboard")]
    fn with_page(
        self,
        memory: &str,
        reached: Option<BridgeName>,
        sender: RequestSender,
        selection: Arc<Mutex<ProfileSelection>>,
        output: OutputChoice,
    ) -> Result<Self, Failure> {
        let (page, observer) = Page::open(memory, reached, sender, selection, output)?;
        let (observer, url, timing) = (Some(observer), Some(page.url()), Some(Timing::default()));
        Ok(Self { page: Some(page), observer, url, timing, ..self })
    }

    #[cfg(feature = "tray")]
    fn with_icon(self, sender: RequestSender, selection: Arc<Mutex<ProfileSelection>>) -> Self {
        let profiles = TrayProfiles::new(selection, self.url.clone());
        Self { tray: Some((profiles, sender)), ..self }
    }

    /// The same pad; its reads are timed for the page.
    pub(super) fn pad(&self, pad: OpenedPad) -> OpenedPad {
        match &self.timing {
            Some(timing) => timing.pad(pad),
            None => pad,
        }
    }

    /// The same sink; its writes are timed for the page.
    pub(super) fn sink(&self, sink: Box<dyn Sink>) -> Box<dyn Sink> {
        match &self.timing {
            Some(timing) => timing.sink(sink),
            None => sink,
        }
    }

    /// Shows the bridge until the process ends. Where the desktop has no place for an icon, the bridge plays all the same.
    pub(super) fn start(self, bridge: &Bridge) -> Result<(), Failure> {
        #[cfg(feature = "dashboard")]
        if let Some(page) = self.page {
            page.start(bridge, self.timing.unwrap_or_default())?;
        }
        #[cfg(feature = "tray")]
        if let Some((profiles, sender)) = self.tray
            && let Err(why) = tray::start(Box::new(profiles), bridge.snapshot(), sender)?
        {
            say(format_args!(
                "there is no tray here ({why}): `tactpad ctl` does everything that its menu does"
            ));
        }
        let _ = bridge;
        Ok(())
    }
}
