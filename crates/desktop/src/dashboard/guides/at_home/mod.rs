//! A calibration at home: presses anywhere, a known weight on five marks, and a decoder that is fitted to them.
//!
//! It hears each call on a thread of its own, which fits, too. The game is paused as long as it listens.

mod pause;
mod session;
mod session_state;
mod stage;
mod steps;
mod worker;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use self::pause::Pause;
use self::session_state::SharedSessionState;
use self::stage::{RunningSession, SessionOptions, Stage};
use self::steps::{ANEW, NO_WEIGHT, WEIGHT, steps};
use self::worker::Worker;
use super::guide::{GuideContext, GuideResult, GuideState, GuideStatus, NO_ACTION, PageGuide};
use crate::dashboard::shadow::ConnectedPad;
use tactpad_bridge::request::Request;
use tactpad_bridge::state::State;
use tactpad_core::pad::weight::check_weight;

/// The name of what is kept of a pad that has no serial number.
const NAMELESS: &str = "pad";

/// The guide.
#[derive(Default)]
pub(super) struct AtHome {
    stage: Stage,
    /// Held by the session that writes; one that was stopped may still be at it.
    files: Arc<Mutex<()>>,
    /// Held by sessions as long as they listen.
    pause: Option<Arc<Pause>>,
}

impl PageGuide for AtHome {
    fn id(&self) -> &'static str {
        "at-home"
    }

    fn start(&mut self, context: &GuideContext<'_>) -> Result<(), String> {
        if !context.pad.is_heard {
            return Err(format!("there is no pad to calibrate: {}", absence(context.status.state)));
        }
        if let Some(pad) = context.host.described() {
            return Err(format!(
                "this calibrates strain pads of nine channels, and {} is decoded by its description: `tactpad source show {}`",
                pad.title, pad.name
            ));
        }
        self.stop(context);
        let name = name_of(&context.pad);
        let was_begun = context.host.has_session(&name);
        self.stage = Stage::Choosing(SessionOptions { name, was_begun, is_fresh: false });
        Ok(())
    }

    fn stop(&mut self, context: &GuideContext<'_>) {
        self.update(context);
        self.stage = match &self.stage {
            Stage::RunningSession(begun) if begun.progress() == GuideState::Running => {
                begun.stop.store(true, Ordering::Release);
                Stage::Idle(Some(GuideResult::words(
                    "Stopped. What was heard is kept: start again, and it goes on from there.",
                )))
            }
            _ => Stage::Idle(None),
        };
    }

    fn on_page_closed(&mut self, context: &GuideContext<'_>) {
        self.update(context);
        // A pad that nobody plays on would else stay paused. A fit needs nobody.
        if matches!(&self.stage, Stage::RunningSession(begun) if begun.standing.listens()) {
            self.stop(context);
        }
    }

    fn update(&mut self, _scene: &GuideContext<'_>) {
        if let Stage::RunningSession(begun) = &mut self.stage {
            begun.standing = begun.shared.now();
        }
    }

    fn act(
        &mut self,
        action: &str,
        number: Option<f64>,
        context: &GuideContext<'_>,
    ) -> Result<Option<Request>, String> {
        let Stage::Choosing(choice) = &mut self.stage else { return Err(NO_ACTION.into()) };
        match action {
            ANEW => choice.is_fresh = true,
            WEIGHT => {
                let weight_g = number.ok_or("write how many grams the weight has")?;
                check_weight(weight_g)?;
                self.begin(Some(weight_g), context)?;
            }
            NO_WEIGHT => self.begin(None, context)?,
            _ => return Err(NO_ACTION.into()),
        }
        Ok(None)
    }

    fn status(&self) -> GuideStatus {
        let (state, result) = match &self.stage {
            Stage::Idle(result) => (GuideState::Idle, result.clone()),
            Stage::Choosing(_) => (GuideState::Running, None),
            Stage::RunningSession(begun) => (begun.progress(), begun.standing.outcome()),
        };
        GuideStatus {
            id: self.id(),
            title: "Calibrate at home",
            about: "Two to three minutes of presses and a known weight on five marks. A decoder is fitted to your pad and written to a file; \
                    what plays now stays. The game is paused as long as the guide listens, and closing the page stops it.",
            state,
            steps: steps(&self.stage),
            result,
        }
    }
}

impl AtHome {
    fn begin(&mut self, weight_g: Option<f64>, context: &GuideContext<'_>) -> Result<(), String> {
        let Stage::Choosing(choice) = &self.stage else { return Err(NO_ACTION.into()) };
        let pause = self.pause.get_or_insert_with(|| Pause::new(context.sender)).hold()?;
        let (shared, stop) = (Arc::<SharedSessionState>::default(), Arc::<AtomicBool>::default());
        let work = Worker {
            name: choice.name.clone(),
            is_fresh: choice.is_fresh,
            weight_g,
            host: Arc::clone(context.host),
            files: Arc::clone(&self.files),
            identity: context.pad.identity,
            shared: Arc::clone(&shared),
            stop: Arc::clone(&stop),
        };
        work.start(pause, (context.subscribe)())?;
        self.stage = Stage::RunningSession(RunningSession { weight_g, standing: shared.now(), shared, stop });
        Ok(())
    }
}

/// The reason why the pad sends nothing.
const fn absence(state: State) -> &'static str {
    match state {
        // Behind a pause the bridge tells of nothing else.
        State::Paused | State::Playing => State::Waiting.sentence(),
        state => state.sentence(),
    }
}

/// The name of what is kept of a pad. What a file's name should not have becomes `_`.
fn name_of(pad: &ConnectedPad) -> String {
    let is_plain = |letter: char| letter.is_ascii_alphanumeric() || letter == '-';
    let plain = |letter: char| if is_plain(letter) { letter } else { '_' };
    let serial = pad.identity.map(|identity| identity.serial_number.as_str().chars().map(plain).collect());
    serial.filter(|serial: &String| !serial.is_empty()).unwrap_or_else(|| NAMELESS.into())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::path::PathBuf;
    use std::sync::PoisonError;

    use firmware_proto::identity::{Identity, SerialNumber};
    use rustix::event::{PollFd, PollFlags, poll};
    use serde_json::Value;

    use super::*;
    use crate::dashboard::call_subscribers::CallSubscribers;
    use crate::dashboard::host::{
        DashboardHost, KeptDecoder, Overwrite, ProfileEntry, ReportEntry, SaveError, SavedProfile,
        SessionStore, StoredProfile,
    };
    use tactpad_bridge::latency::Percentiles;
    use tactpad_bridge::request::RequestSender;
    use tactpad_bridge::requests::Requests;
    use tactpad_bridge::snapshot::{BridgeHealth, Status};
    use tactpad_core::pipeline::call::Call;
    use tactpad_core::pipeline::capture::head::Head;
    use tactpad_core::pipeline::mapping::live::Presses;
    use tactpad_core::pipeline::mapping::read::check::OutputChoice;
    use tactpad_core::time::HostInstant;
    use tactpad_lab::play::guide::Guide as Led;
    use tactpad_lab::play::weights::Placement;

    /// Keeps nothing, and knows of an earlier session.
    struct Shelf;

    impl SessionStore for Shelf {
        fn at(&self, at: HostInstant) -> HostInstant {
            at
        }

        fn write(&mut self, _at: HostInstant, _call: Call<'_>) -> Result<(), String> {
            Ok(())
        }

        fn settle(&mut self, _placements: &[Placement]) -> Result<(), String> {
            Ok(())
        }
    }

    impl DashboardHost for Shelf {
        fn entries(&self) -> Vec<ProfileEntry> {
            Vec::new()
        }

        fn playing(&self) -> String {
            String::new()
        }

        fn output(&self) -> OutputChoice {
            OutputChoice::AsWritten
        }

        fn read(&self, _name: &str) -> Option<StoredProfile> {
            None
        }

        fn save(&self, _name: &str, _text: &str, _over: &Overwrite) -> Result<SavedProfile, SaveError> {
            Err(SaveError::Failed("nothing is kept".into()))
        }

        fn history(&self, _name: &str) -> Value {
            Value::Null
        }

        fn saved(&self, _name: &str, _id: u64) -> Option<String> {
            None
        }

        fn delete(&self, _name: &str) -> Result<(), SaveError> {
            Err(SaveError::Failed("nothing is kept".into()))
        }

        fn rename(&self, _from: &str, _to: &str) -> Result<(), SaveError> {
            Err(SaveError::Failed("nothing is kept".into()))
        }

        fn decoders(&self) -> Vec<String> {
            Vec::new()
        }

        fn exported(&self, _name: &str, _decoder: Option<&str>) -> Option<String> {
            None
        }

        fn import(&self, _document: &str, _name: &str) -> Result<Option<String>, SaveError> {
            Err(SaveError::Failed("nothing is kept".into()))
        }

        fn doctor(&self) -> Value {
            Value::Null
        }

        fn reports(&self) -> Vec<ReportEntry> {
            Vec::new()
        }

        fn report(&self, _id: &str) -> Option<PathBuf> {
            None
        }

        fn has_session(&self, _name: &str) -> bool {
            true
        }

        fn open_session(
            &self,
            _name: &str,
            _fresh: bool,
            _guide: &mut Led,
            _head: &Head,
        ) -> Result<Box<dyn SessionStore>, String> {
            Ok(Box::new(Self))
        }

        fn keep_decoder(&self, _name: &str, _bytes: &[u8]) -> Result<KeptDecoder, String> {
            Err("nothing is kept".into())
        }
    }

    /// A bridge that only writes down what it is asked.
    struct Bridge {
        requests: Requests,
        sender: Arc<RequestSender>,
        call_subscribers: Mutex<CallSubscribers>,
        host: Arc<dyn DashboardHost>,
        state: State,
        /// What a page was told last.
        status: Status,
        pad: ConnectedPad,
    }

    impl Bridge {
        fn new(state: State) -> Self {
            let requests = Requests::new().unwrap();
            let sender = Arc::new(requests.sender().unwrap());
            let status = Status { state, ..status() };
            let pad = ConnectedPad { is_heard: state != State::Waiting, identity: None };
            Self {
                requests,
                sender,
                call_subscribers: Mutex::default(),
                host: Arc::new(Shelf),
                state,
                status,
                pad,
            }
        }

        fn with<T>(&self, work: impl FnOnce(&GuideContext<'_>) -> T) -> T {
            work(&GuideContext {
                now: HostInstant::default(),
                status: &self.status,
                pad: self.pad,
                profile: &|| None,
                past: &|| None,
                subscribe: &|| {
                    self.call_subscribers.lock().unwrap_or_else(PoisonError::into_inner).subscribe()
                },
                sender: &self.sender,
                host: &self.host,
            })
        }

        /// Waits for the next request that is no question.
        fn asked(&mut self) -> Request {
            loop {
                if let Some(pending) = self.requests.take() {
                    if pending.request != Request::Status {
                        return pending.request;
                    }
                    pending.reply(format!(r#"{{"state":"{}"}}"#, self.state.word()));
                    continue;
                }
                let mut fds = [PollFd::from_borrowed_fd(self.requests.fd(), PollFlags::IN)];
                poll(&mut fds, None).unwrap();
            }
        }
    }

    fn status() -> Status {
        Status {
            state: State::Playing,
            pad: None,
            profile: String::new(),
            layer: None,
            profile_reason: String::new(),
            profile_error: None,
            preview: false,
            decoder: String::new(),
            output: String::new(),
            contact: None,
            held: Vec::new(),
            warning: None,
            line: None,
            presses: Presses::default(),
            health: BridgeHealth::default(),
            latency_us: Percentiles::default(),
            decoder_file: None,
            gain: 1.0,
            weighing: None,
            changes: None,
            held_names: Vec::new(),
            labels: BTreeMap::new(),
        }
    }

    fn begin(guide: &mut AtHome, bridge: &Bridge) {
        bridge.with(|context| guide.start(context)).unwrap();
        bridge.with(|context| guide.act(WEIGHT, Some(200.0), context)).unwrap();
    }

    #[test]
    fn without_a_pad_it_says_why_it_does_not_begin() {
        let (bridge, mut guide) = (Bridge::new(State::Waiting), AtHome::default());
        let refused = bridge.with(|context| guide.start(context)).unwrap_err();
        assert!(refused.contains("no pad") && refused.contains("plug it in"), "{refused}");
        assert_eq!(guide.status().state, GuideState::Idle);
    }

    #[test]
    fn a_weight_that_no_pad_bears_begins_nothing() {
        let (mut bridge, mut guide) = (Bridge::new(State::Playing), AtHome::default());
        bridge.with(|context| guide.start(context)).unwrap();
        for (number, why) in [(None, "how many grams"), (Some(2.0), "30 to 1000 g"), (Some(f64::NAN), "g")] {
            let refused = bridge.with(|context| guide.act(WEIGHT, number, context)).unwrap_err();
            assert!(refused.contains(why), "{refused}");
        }
        assert_eq!(bridge.with(|context| guide.act("dance", None, context)).unwrap_err(), NO_ACTION);
        assert!(bridge.requests.take().is_none(), "nothing was paused");
    }

    #[test]
    fn the_game_is_paused_until_it_is_stopped_or_nobody_looks() {
        let (mut bridge, mut guide) = (Bridge::new(State::Playing), AtHome::default());
        begin(&mut guide, &bridge);
        assert_eq!(bridge.asked(), Request::Pause);
        // Somebody lets the bridge go on meanwhile.
        bridge.call_subscribers.lock().unwrap().publish(HostInstant::default(), &Call::Resume.into());
        assert_eq!(bridge.asked(), Request::Pause);
        bridge.with(|context| guide.stop(context));
        assert_eq!(bridge.asked(), Request::Resume);
        let status = guide.status();
        assert!(
            status.state == GuideState::Idle && status.result.is_some_and(|it| it.text.contains("goes on"))
        );
        begin(&mut guide, &bridge);
        assert_eq!(bridge.asked(), Request::Pause);
        bridge.with(|context| guide.on_page_closed(context));
        assert_eq!(bridge.asked(), Request::Resume);
    }

    #[test]
    fn a_session_that_begins_before_a_page_knows_that_the_last_one_has_ended_pauses_for_itself() {
        let (mut bridge, mut guide) = (Bridge::new(State::Playing), AtHome::default());
        begin(&mut guide, &bridge);
        assert_eq!(bridge.asked(), Request::Pause);
        bridge.with(|context| guide.stop(context));
        assert_eq!(bridge.asked(), Request::Resume);
        // The page still has the status from before.
        bridge.status.state = State::Paused;
        begin(&mut guide, &bridge);
        assert_eq!(bridge.asked(), Request::Pause);
        bridge.with(|context| guide.stop(context));
        assert_eq!(bridge.asked(), Request::Resume);
    }

    #[test]
    fn who_had_paused_before_goes_on_by_himself() {
        let (mut bridge, mut guide) = (Bridge::new(State::Paused), AtHome::default());
        begin(&mut guide, &bridge);
        assert_eq!(bridge.asked(), Request::Pause);
        bridge.with(|context| guide.stop(context));
        while Arc::strong_count(guide.pause.as_ref().unwrap()) > 1 {
            std::thread::yield_now();
        }
        assert!(bridge.requests.take().is_none());
    }

    #[test]
    fn what_is_kept_of_a_pad_is_named_by_its_serial_number() {
        let pad = |serial: &str| {
            let serial_number = SerialNumber::from_ascii(serial).unwrap();
            let identity = Identity {
                serial_number,
                channels: 9,
                count_bits: 24,
                rate_hz: 1000,
                picovolts_per_count: 1,
            };
            ConnectedPad { is_heard: true, identity: Some(identity) }
        };
        assert_eq!(name_of(&pad("TP-0042")), "TP-0042");
        assert_eq!(name_of(&pad("../a:b")), "___a_b");
        assert_eq!(
            (name_of(&pad("")), name_of(&ConnectedPad::default())),
            (NAMELESS.into(), NAMELESS.into())
        );
    }
}
