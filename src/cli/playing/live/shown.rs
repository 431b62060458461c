//! How a running bridge is shown beside the terminal: by the dashboard and the tray.

use std::sync::{Arc, Mutex};

use clap::Args;

#[cfg(feature = "tray")]
use super::desk::Around;
#[cfg(feature = "dashboard")]
use super::page::Page;
use super::wish::Wish;
use crate::cli::failure::Failure;
#[cfg(feature = "tray")]
use crate::cli::printing::written::say;
use tactpad::bridge::observer::Observer;
use tactpad::bridge::opening::OpenedPad;
#[cfg(any(feature = "dashboard", feature = "tray"))]
use tactpad::bridge::request::Asker;
use tactpad::bridge::requests::Requests;
use tactpad::bridge::running::Bridge;
use tactpad::bridge::sink::Sink;
use tactpad::bridge::timing::Timing;
use tactpad::pipeline::mapping::read::check::OutputChoice;
#[cfg(feature = "tray")]
use tactpad::tray;

/// What people ask for.
#[derive(Clone, Copy, Debug, Args)]
pub(super) struct Shown {
    /// Show the bridge in a page of this machine's browser, and change profiles there; its address is printed.
    #[cfg(feature = "dashboard")]
    #[arg(long)]
    dashboard: bool,
    /// Show an icon among those of the desktop: what the bridge is doing, and a menu that asks it.
    #[cfg(feature = "tray")]
    #[arg(long)]
    tray: bool,
}

/// What shows a bridge that is about to be made.
#[derive(Default)]
pub(super) struct Prepared {
    #[cfg(feature = "dashboard")]
    page: Option<Page>,
    #[cfg(feature = "tray")]
    tray: Option<(Around, Asker)>,
    /// Who wants to hear of each call.
    pub(super) observer: Option<Observer>,
    /// Where the page is.
    pub(super) url: Option<String>,
    timing: Option<Timing>,
}

impl Shown {
    /// Whether there is a page.
    pub(super) const fn has_page(self) -> bool {
        #[cfg(feature = "dashboard")]
        return self.dashboard;
        #[cfg(not(feature = "dashboard"))]
        false
    }

    /// Opens what shows the bridge that `requests` reach.
    pub(super) fn prepare(
        self,
        requests: &Requests,
        wish: &Arc<Mutex<Wish>>,
        output: OutputChoice,
    ) -> Result<Prepared, Failure> {
        let prepared = Prepared::default();
        #[cfg(feature = "dashboard")]
        let prepared = match self.dashboard {
            true => prepared.with_page(requests.asker()?, Arc::clone(wish), output)?,
            false => prepared,
        };
        #[cfg(feature = "tray")]
        let prepared = match self.tray {
            true => prepared.with_icon(requests.asker()?, Arc::clone(wish)),
            false => prepared,
        };
        let _ = (requests, wish, output);
        Ok(prepared)
    }
}

impl Prepared {
    #[cfg(feature = "dashboard")]
    fn with_page(self, asker: Asker, wish: Arc<Mutex<Wish>>, output: OutputChoice) -> Result<Self, Failure> {
        let (page, observer) = Page::open(asker, wish, output)?;
        let (observer, url, timing) = (Some(observer), Some(page.url()), Some(Timing::default()));
        Ok(Self { page: Some(page), observer, url, timing, ..self })
    }

    #[cfg(feature = "tray")]
    fn with_icon(self, asker: Asker, wish: Arc<Mutex<Wish>>) -> Self {
        let around = Around::new(wish, self.url.clone());
        Self { tray: Some((around, asker)), ..self }
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
        if let Some((around, asker)) = self.tray
            && let Err(why) = tray::start(Box::new(around), bridge.snapshot(), asker)?
        {
            say(format_args!(
                "there is no tray here ({why}): `tactpad ctl` does everything that its menu does"
            ));
        }
        let _ = bridge;
        Ok(())
    }
}
