//! The displays of a running bridge beside the terminal: the dashboard and the tray.

use std::sync::{Arc, Mutex};

use clap::Args;

#[cfg(feature = "dashboard")]
use super::page::{Page, Shelf};
#[cfg(feature = "dashboard")]
use super::practising::{self, Practising};
use super::profile_selection::ProfileSelection;
use super::runtime::BridgeName;
#[cfg(feature = "tray")]
use super::tray_profiles::TrayProfiles;
use crate::cli::failure::Failure;
use crate::cli::files::device::PadOptions;
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
use tactpad::bridge::transport::address::PadAddress;
#[cfg(feature = "dashboard")]
use tactpad::dashboard::practice::PracticeHand;
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
    /// Have a practice hand play the virtual pad, which does what the page's guides ask: weak, trembling, one-finger, off-centre, ignoring.
    #[cfg(feature = "dashboard")]
    #[arg(long, value_name = "HAND", value_parser = practising::hand, requires = "dashboard")]
    hand: Option<PracticeHand>,
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
    /// The pad that a practice hand touches.
    practised: Option<OpenedPad>,
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
        (address, device): (&PadAddress, &PadOptions),
    ) -> Result<OpenedDisplays, Failure> {
        let prepared = OpenedDisplays::default();
        #[cfg(feature = "dashboard")]
        let prepared = match self.dashboard {
            true => {
                let (practised, hand) = self.practised(address, device)?.unzip();
                let shelf = Shelf::new(reached.cloned(), Arc::clone(selection), output, hand);
                OpenedDisplays { practised, ..prepared }.with_page(memory, requests.sender()?, shelf)?
            }
            false => prepared,
        };
        #[cfg(feature = "tray")]
        let prepared = match self.tray {
            true => prepared.with_icon(requests.sender()?, Arc::clone(selection)),
            false => prepared,
        };
        let _ = (memory, reached, requests, selection, output, address, device);
        Ok(prepared)
    }

    /// The pad of the practice hand that is asked for, and the hand.
    #[cfg(feature = "dashboard")]
    fn practised(
        self,
        address: &PadAddress,
        device: &PadOptions,
    ) -> Result<Option<(OpenedPad, Practising)>, Failure> {
        let Some(hand) = self.hand else { return Ok(None) };
        if *address != PadAddress::Virtual {
            return Err(Failure::Unusable("--hand plays the virtual pad: add --pad virtual".into()));
        }
        practising::open(device, hand).map(Some)
    }
}

impl OpenedDisplays {
    #[cfg(feature = "dashboard")]
    fn with_page(self, memory: &str, sender: RequestSender, shelf: Shelf) -> Result<Self, Failure> {
        let (page, observer) = Page::open(memory, sender, shelf)?;
        let (observer, url, timing) = (Some(observer), Some(page.url()), Some(Timing::default()));
        Ok(Self { page: Some(page), observer, url, timing, ..self })
    }

    #[cfg(feature = "tray")]
    fn with_icon(self, sender: RequestSender, selection: Arc<Mutex<ProfileSelection>>) -> Self {
        let profiles = TrayProfiles::new(selection, self.url.clone());
        Self { tray: Some((profiles, sender)), ..self }
    }

    /// The same pad, or the one that a practice hand touches; its reads are timed for the page.
    pub(super) fn pad(&mut self, pad: OpenedPad) -> OpenedPad {
        let pad = self.practised.take().unwrap_or(pad);
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
