//! How a running bridge is shown beside the terminal: by the dashboard.

use std::sync::{Arc, Mutex};

use clap::Args;

#[cfg(feature = "dashboard")]
use super::page::Page;
use super::wish::Wish;
use crate::cli::failure::Failure;
use tactpad::bridge::observer::Observer;
use tactpad::bridge::opening::OpenedPad;
use tactpad::bridge::request::Asker;
use tactpad::bridge::running::Bridge;
use tactpad::bridge::sink::Sink;
use tactpad::bridge::timing::Timing;
use tactpad::pipeline::mapping::check::OutputChoice;

/// What people ask for.
#[derive(Clone, Copy, Debug, Args)]
pub(super) struct Shown {
    /// Show the bridge in a page of this machine's browser, and change profiles there; its address is printed.
    #[cfg(feature = "dashboard")]
    #[arg(long)]
    dashboard: bool,
}

/// What shows a bridge that is about to be made.
#[derive(Default)]
pub(super) struct Prepared {
    #[cfg(feature = "dashboard")]
    page: Option<Page>,
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

    /// Opens what shows the bridge that `asker` reaches.
    pub(super) fn prepare(
        self,
        asker: Asker,
        wish: Arc<Mutex<Wish>>,
        output: OutputChoice,
    ) -> Result<Prepared, Failure> {
        if !self.has_page() {
            return Ok(Prepared::default());
        }
        #[cfg(feature = "dashboard")]
        {
            let (page, observer) = Page::open(asker, wish, output)?;
            let url = Some(page.url());
            let (observer, timing) = (Some(observer), Some(Timing::default()));
            Ok(Prepared { page: Some(page), observer, url, timing })
        }
        #[cfg(not(feature = "dashboard"))]
        {
            let _ = (asker, wish, output);
            Ok(Prepared::default())
        }
    }
}

impl Prepared {
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

    /// Shows the bridge until the process ends.
    pub(super) fn start(self, bridge: &Bridge) -> Result<(), Failure> {
        #[cfg(feature = "dashboard")]
        if let Some(page) = self.page {
            return page.start(bridge, self.timing.unwrap_or_default());
        }
        let _ = bridge;
        Ok(())
    }
}
