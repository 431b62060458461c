//! `--dashboard`: the page of a running bridge, and what it needs of this program.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use serde_json::Value;

use super::practising::Practising;
use super::profile_selection::ProfileSelection;
use super::runtime::BridgeName;
use super::{calibrated, doctor, page_memory, reported};
use crate::cli::failure::Failure;
use crate::cli::playing::profile;
use crate::cli::printing::written::{reason, say};
use tactpad::bridge::event_loop::Bridge;
use tactpad::bridge::observer::Observer;
use tactpad::bridge::request::RequestSender;
use tactpad::bridge::timing::Timing;
use tactpad::dashboard::host::{
    DashboardHost, KeptDecoder, Overwrite, ProfileEntry, ReportEntry, SaveError, SavedProfile, SessionStore,
    StoredProfile,
};
use tactpad::dashboard::practice::Wish;
use tactpad::dashboard::server::Dashboard;
use tactpad::lab::play::guide::Guide;
use tactpad::pipeline::capture::head::Head;
use tactpad::pipeline::mapping::read::check::OutputChoice;
use tactpad::source::Source;

/// A page that has its address, and waits for its bridge.
pub(super) struct Page {
    dashboard: Dashboard,
    sender: RequestSender,
    shelf: Arc<Shelf>,
}

impl Page {
    /// Opens an address for the page of a bridge that `sender` reaches, and gives the observer that the bridge needs. `memory` is the
    /// state file of addresses.
    pub(super) fn open(
        memory: &str,
        sender: RequestSender,
        shelf: Shelf,
    ) -> Result<(Self, Observer), Failure> {
        let earlier = page_memory::addresses(memory);
        let (dashboard, observer) = Dashboard::open(&earlier, page_memory::key()?).map_err(|error| {
            Failure::Failed(format!(
                "the dashboard has no port: {}; start without --dashboard",
                reason(&error)
            ))
        })?;
        if let Err(failure) = page_memory::keep(memory, dashboard.address(), &earlier) {
            say(failure.sentence());
        }
        Ok((Self { dashboard, sender, shelf: Arc::new(shelf) }, observer))
    }

    /// Where it is.
    pub(super) fn url(&self) -> String {
        self.dashboard.url()
    }

    /// Shows `bridge` until the process ends.
    pub(super) fn start(self, bridge: &Bridge, timing: Timing) -> Result<(), Failure> {
        Ok(self.dashboard.start(bridge, self.sender, timing, self.shelf)?)
    }
}

/// Profiles, the doctor and reports.
pub(super) struct Shelf {
    /// The name by which `tactpad ctl` reaches the bridge.
    reached: Option<BridgeName>,
    selection: Arc<Mutex<ProfileSelection>>,
    output: OutputChoice,
    /// The practice hand, if one plays.
    hand: Mutex<Option<Practising>>,
}

impl Shelf {
    /// Of the bridge that `tactpad ctl` reaches by this name, if it has one.
    pub(super) const fn new(
        reached: Option<BridgeName>,
        selection: Arc<Mutex<ProfileSelection>>,
        output: OutputChoice,
        hand: Option<Practising>,
    ) -> Self {
        Self { reached, selection, output, hand: Mutex::new(hand) }
    }
}

impl DashboardHost for Shelf {
    fn practise(&self, wish: Wish) {
        if let Some(hand) = &mut *self.hand.lock().unwrap_or_else(PoisonError::into_inner) {
            hand.obey(wish);
        }
    }

    fn entries(&self) -> Vec<ProfileEntry> {
        profile::entries()
    }

    fn playing(&self) -> String {
        self.selection.lock().unwrap_or_else(PoisonError::into_inner).name.clone()
    }

    fn output(&self) -> OutputChoice {
        self.output
    }

    fn described(&self) -> Option<Arc<Source>> {
        self.selection.lock().unwrap_or_else(PoisonError::into_inner).described.clone()
    }

    fn read(&self, name: &str) -> Option<StoredProfile> {
        profile::stored(name)
    }

    fn save(&self, name: &str, text: &str, over: &Overwrite) -> Result<SavedProfile, SaveError> {
        profile::save(name, text, over)
    }

    fn history(&self, name: &str) -> Value {
        serde_json::to_value(profile::listed(name)).unwrap_or_default()
    }

    fn saved(&self, name: &str, id: u64) -> Option<String> {
        profile::saved(name, id)
    }

    fn delete(&self, name: &str) -> Result<(), SaveError> {
        profile::delete(name)
    }

    fn rename(&self, from: &str, to: &str) -> Result<(), SaveError> {
        profile::rename(from, to)
    }

    fn decoders(&self) -> Vec<String> {
        profile::decoders().into_iter().map(|(name, _)| name).collect()
    }

    fn exported(&self, name: &str, decoder: Option<&str>) -> Option<String> {
        profile::exported(name, decoder)
    }

    fn import(&self, document: &str, name: &str) -> Result<Option<String>, SaveError> {
        profile::import(document, name)
    }

    fn doctor(&self) -> Value {
        serde_json::to_value(doctor::examine(self.reached.as_ref())).unwrap_or_default()
    }

    fn reports(&self) -> Vec<ReportEntry> {
        reported::all()
    }

    fn report(&self, id: &str) -> Option<PathBuf> {
        reported::page(id)
    }

    fn has_session(&self, name: &str) -> bool {
        calibrated::has_session(name)
    }

    fn open_session(
        &self,
        name: &str,
        fresh: bool,
        guide: &mut Guide,
        head: &Head,
    ) -> Result<Box<dyn SessionStore>, String> {
        calibrated::open(name, fresh, guide, head).map_err(Failure::sentence)
    }

    fn keep_decoder(&self, name: &str, bytes: &[u8]) -> Result<KeptDecoder, String> {
        calibrated::write(name, bytes).map_err(Failure::sentence)
    }
}
