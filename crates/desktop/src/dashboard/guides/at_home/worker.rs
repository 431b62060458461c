//! The thread of a session: it listens, then fits, and writes the decoder.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use firmware_proto::identity::Identity;

use super::pause::PauseHold;
use super::session::{Session, guide};
use super::session_state::{SessionState, SharedSessionState};
use crate::dashboard::call_subscribers::TimedCall;
use crate::dashboard::guides::guide::{CommandLine, GuideResult, ResultTable};
use crate::dashboard::host::DashboardHost;
use crate::dashboard::practice::Wish;
use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::PadField;
use tactpad_core::pad::marks::MARKS_MM;
use tactpad_core::pipeline::call::{Call, OwnedCall};
use tactpad_core::time::HostInstant;
use tactpad_lab::play::guide::{Guide, GuideStep};
use tactpad_lab::play::home::calibrated;
use tactpad_lab::play::summary::{HEADING, PlatePart, Summary};
use tactpad_lab::play::words::is_other;
use tactpad_lab::tangent::SimulatedPad;
use tactpad_mechanics::field_cache;

/// Whether it was stopped is looked at this often, although no call comes.
const LOOK: Duration = Duration::from_millis(100);

/// How a weight is put on the marks.
const WEIGHING: &str = "Start again with a weight: the guide says when and where.";

/// The worker of a session, with its parameters.
pub(super) struct Worker {
    /// The name of what is kept.
    pub(super) name: String,
    pub(super) is_fresh: bool,
    pub(super) weight_g: Option<f64>,
    pub(super) host: Arc<dyn DashboardHost>,
    /// Held as long as files are read and written.
    pub(super) files: Arc<Mutex<()>>,
    /// Who the pad said that it is.
    pub(super) identity: Option<Identity>,
    pub(super) shared: Arc<SharedSessionState>,
    pub(super) stop: Arc<AtomicBool>,
}

impl Worker {
    /// Works on a thread of its own; the pause ends as soon as nobody has to press any more.
    ///
    /// # Errors
    /// The system has no thread to give.
    pub(super) fn start(self, pause: PauseHold, calls: Receiver<TimedCall>) -> Result<(), String> {
        let spawned = thread::Builder::new().name("calibration".into()).spawn(move || {
            match self.work(pause, calls) {
                Ok(Some(outcome)) => self.shared.set(SessionState::Finished(Ok(outcome))),
                // Who stopped it hears no more of it.
                Ok(None) => {}
                Err(why) => self.shared.fail(why),
            }
        });
        spawned.map(drop).map_err(|error| error.to_string())
    }

    /// `None` where it was stopped.
    fn work(&self, pause: PauseHold, calls: Receiver<TimedCall>) -> Result<Option<GuideResult>, String> {
        let heard = self.listen(&pause, &calls);
        drop((pause, calls));
        let Some(guide) = heard? else { return Ok(None) };
        let (file, summary) = {
            let shared = &self.shared;
            fitted(guide, &|share| shared.set(SessionState::Fitting(share)))?
        };
        if self.is_stopped() {
            return Ok(None);
        }
        let _files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
        let kept = self.host.keep_decoder(&self.name, &file)?;
        Ok(Some(outcome(&summary, &kept.path, kept.command)))
    }

    /// Listens until nothing is left to do. `None` where it was stopped before.
    fn listen(&self, pause: &PauseHold, calls: &Receiver<TimedCall>) -> Result<Option<Guide>, String> {
        let _files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
        let (mut guide, head) = guide(self.weight_g)?;
        let kept = self.host.open_session(&self.name, self.is_fresh, &mut guide, &head)?;
        let mut session = Session::begin(guide, kept, self.identity.as_ref())?;
        self.host.practise(wish(session.step(), self.weight_g));
        self.shared.set(SessionState::Guided(session.position()));
        let went = self.hear(&mut session, pause, calls);
        let settled = session.settle();
        let is_whole = went?;
        settled?;
        Ok(is_whole.then(|| session.finish()))
    }

    /// Hears calls until nothing is left to do; whether it came to that.
    fn hear(
        &self,
        session: &mut Session,
        pause: &PauseHold,
        calls: &Receiver<TimedCall>,
    ) -> Result<bool, String> {
        while !session.is_done() {
            if self.is_stopped() {
                return Ok(false);
            }
            match calls.recv_timeout(LOOK) {
                Ok((at, call)) => self.take(session, pause, at, &call)?,
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return Ok(false),
            }
        }
        Ok(true)
    }

    fn take(
        &self,
        session: &mut Session,
        pause: &PauseHold,
        at: HostInstant,
        call: &OwnedCall,
    ) -> Result<(), String> {
        if *call == OwnedCall::Plain(Call::Resume) {
            pause.again();
        }
        let before = session.step().clone();
        if session.take(at, call.as_call())? {
            if is_other(&before, session.step()) {
                self.host.practise(wish(session.step(), self.weight_g));
            }
            self.shared.set(SessionState::Guided(session.position()));
        }
        Ok(())
    }

    fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Acquire)
    }
}

/// What a step asks of a hand.
fn wish(step: &GuideStep, weight_g: Option<f64>) -> Wish {
    match step {
        GuideStep::Rest { .. } | GuideStep::Done => Wish::Rest,
        GuideStep::Press { .. } => Wish::Anywhere,
        GuideStep::Put { mark, .. } => {
            let mark_mm = MARKS_MM.get(*mark).copied().unwrap_or_default();
            Wish::Lay { mark_mm, weight_g: weight_g.unwrap_or_default() }
        }
        GuideStep::TakeAway { .. } => Wish::TakeAway,
    }
}

/// The decoder's file, and what it knows. `report` hears how much of the fit is done.
pub(super) fn fitted(guide: Guide, report: &(dyn Fn(f64) + Sync)) -> Result<(Vec<u8>, Summary), String> {
    let (windows, placements) = guide.finish();
    let (device, field) = (Device::nominal(), PadField::nominal());
    report(0.0);
    let share = |done: usize, of: usize| report(done as f64 / of.max(1) as f64);
    let pad = SimulatedPad { solve: &field_cache::solve, ..SimulatedPad::known(&device, &field) };
    let found = calibrated(&windows, &placements, &pad, None, &share);
    let found = found.map_err(|error| format!("there is no decoder yet: {error}"))?;
    Ok((found.file(), Summary::of(&found, &windows)))
}

/// The result for people.
fn outcome(summary: &Summary, path: &str, command: String) -> GuideResult {
    let row = |part: &PlatePart| {
        let PlatePart { name, deviation_mm, force_share, presses, open } = part;
        let is_open = if *open { "open" } else { "" };
        let [deviation, share] = [format!("{deviation_mm:.2} mm"), format!("{:.1} %", 100.0 * force_share)];
        vec![(*name).to_owned(), deviation, share, presses.to_string(), is_open.to_owned()]
    };
    GuideResult {
        table: Some(ResultTable {
            caption: HEADING,
            heads: vec!["PlatePart", "Place", "Force", "Presses", "Open"],
            rows: summary.map.iter().map(row).collect(),
        }),
        commands: vec![CommandLine { label: "Play with it", text: command }],
        ..GuideResult::words(format!(
            "The decoder is written: {path}. It plays from the next start that names it. It comes from {}. {}",
            summary.source(),
            summary.next(WEIGHING)
        ))
    }
}
