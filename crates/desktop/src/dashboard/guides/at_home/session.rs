//! A running calibration session: it saves each call, and asks the guide for the next step.

use firmware_proto::ENCODED_MAX;
use firmware_proto::frame::Message;
use firmware_proto::identity::{Identity, SerialNumber};
use firmware_proto::link::encode_message;

use super::session_state::Position;
use crate::dashboard::host;
use tactpad_core::pipeline::call::Call;
use tactpad_core::pipeline::capture::head::Head;
use tactpad_core::pipeline::contact::read;
use tactpad_core::pipeline::mapping::read::ReadProfile;
use tactpad_core::pipeline::mapping::read::check::OutputChoice;
use tactpad_core::pipeline::mapping::read::shipped as profiles;
use tactpad_core::pipeline::{Phase, shipped};
use tactpad_core::time::HostInstant;
use tactpad_lab::play::guide::{Guide, GuideStep};
use tactpad_lab::play::reader::Reader;
use tactpad_lab::play::words::{is_news, is_other};

/// Interval between two writes to the disk, in windows of a tenth of a second.
const SETTLE_WINDOWS: usize = 10;

/// A guide that has heard nothing, and what a capture of what it hears begins with.
///
/// # Errors
/// The program has no decoder or profile inside, which its tests would have seen.
pub(super) fn guide(weight_g: Option<f64>) -> Result<(Guide, Head), String> {
    let bytes = shipped::bytes(shipped::INVERSE).ok_or("the program has no decoder inside")?;
    let decoder = read::playing(&bytes).map_err(|error| error.to_string())?;
    // Only its filter counts, so any will do.
    let text = profiles::text("super-mario").ok_or("the program has no profile inside")?;
    let profile =
        ReadProfile::read(text, OutputChoice::AsWritten).0.ok_or("the profile inside has errors")?;
    let guide = Guide::new(Reader::new(decoder, profile.profile().clone()), weight_g);
    Ok((guide, Head { decoder: Some(bytes.into_owned()), profile: Some(profile) }))
}

/// A session that goes on.
pub(super) struct Session {
    guide: Guide,
    kept: Box<dyn host::SessionStore>,
    /// The host time of the first call.
    begin: Option<HostInstant>,
    pad: Option<SerialNumber>,
    /// The step that was begun last, and the one that asked for something else last.
    begun: GuideStep,
    cue: GuideStep,
    judged: usize,
    phase: Phase,
}

impl Session {
    /// A session of a pad that said earlier who it is: that belongs to what is heard.
    pub(super) fn begin(
        guide: Guide,
        kept: Box<dyn host::SessionStore>,
        identity: Option<&Identity>,
    ) -> Result<Self, String> {
        let (step, judged, phase) = (guide.step().clone(), guide.judged(), guide.phase());
        let mut session =
            Self { guide, kept, begin: None, pad: None, begun: step.clone(), cue: step, judged, phase };
        if let Some(identity) = identity {
            let mut frame = [0; ENCODED_MAX];
            let length = encode_message(&Message::Identity(*identity), &mut frame);
            session.make(HostInstant::default(), Call::Bytes(frame.get(..length).unwrap_or_default()))?;
        }
        Ok(session)
    }

    /// Takes a call. Whether there is something new to tell.
    ///
    /// # Errors
    /// It cannot be kept, or another pad was plugged in.
    pub(super) fn take(&mut self, at: HostInstant, call: Call<'_>) -> Result<bool, String> {
        let begin = *self.begin.get_or_insert(at);
        self.make(HostInstant::default().plus_us(at.us_since(begin)), call)?;
        self.check_pad()?;
        let (judged, phase) = (self.guide.judged(), self.guide.phase());
        if (judged, phase) == (self.judged, self.phase) {
            return Ok(false);
        }
        if is_other(&self.begun, self.guide.step()) || judged % SETTLE_WINDOWS == 0 {
            self.settle()?;
        }
        (self.judged, self.phase, self.begun) = (judged, phase, self.guide.step().clone());
        if is_news(&self.cue, &self.begun) {
            self.cue = self.begun.clone();
        }
        Ok(true)
    }

    /// Where it is.
    pub(super) fn position(&self) -> Position {
        Position::of(&self.guide, &self.cue)
    }

    /// The step that is to be done.
    pub(super) const fn step(&self) -> &GuideStep {
        &self.begun
    }

    /// Whether nothing is left to do.
    pub(super) fn is_done(&self) -> bool {
        *self.guide.step() == GuideStep::Done
    }

    /// Sees that everything is kept.
    pub(super) fn settle(&mut self) -> Result<(), String> {
        self.kept.settle(self.guide.placements())
    }

    /// The guide, with all recorded presses.
    pub(super) fn finish(self) -> Guide {
        self.guide
    }

    fn make(&mut self, at: HostInstant, call: Call<'_>) -> Result<(), String> {
        let at = self.kept.at(at);
        self.kept.write(at, call)?;
        self.guide.apply(at, call);
        Ok(())
    }

    /// Presses on two pads make no decoder of either.
    fn check_pad(&mut self) -> Result<(), String> {
        let Some(now) = self.guide.serial_number() else { return Ok(()) };
        if *self.pad.get_or_insert(now) == now {
            return Ok(());
        }
        Err(format!(
            "another pad was plugged in ({now}): plug the first one in and start again, or start with this one"
        ))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, Mutex};

    use firmware_proto::link::MessageReceiver;

    use super::super::worker::fitted;
    use super::*;
    use tactpad_core::pad::marks::MARKS_MM;
    use tactpad_core::pipeline::call::OwnedCall;
    use tactpad_core::virtual_pad::firmware::VirtualPad;
    use tactpad_core::virtual_pad::freehand::Calibrator;
    use tactpad_lab::play::guide::LoadOnPad;
    use tactpad_lab::play::weights::Placement;

    const WEIGHT_G: f64 = 200.0;
    /// The bridge runs for an hour already.
    const BEGIN_US: u64 = 3_600_000_000;

    /// A session store in memory.
    #[derive(Clone, Default)]
    struct Memory {
        calls: Arc<Mutex<Vec<(HostInstant, OwnedCall)>>>,
        placements: Arc<Mutex<Vec<Placement>>>,
        begin_us: u64,
    }

    impl host::SessionStore for Memory {
        fn at(&self, at: HostInstant) -> HostInstant {
            at.plus_us(self.begin_us)
        }

        fn write(&mut self, at: HostInstant, call: Call<'_>) -> Result<(), String> {
            self.calls.lock().unwrap().push((at, call.into()));
            Ok(())
        }

        fn settle(&mut self, placements: &[Placement]) -> Result<(), String> {
            *self.placements.lock().unwrap() = placements.to_vec();
            Ok(())
        }
    }

    /// A pad that somebody plays with, and hands that do what is asked once a calibration begins.
    struct GuideContext {
        pad: VirtualPad,
        hands: Calibrator,
        obeyed: Option<GuideStep>,
        /// How far beside the mark the weight is put.
        off_mm: f64,
    }

    impl GuideContext {
        /// The pad has said who it is long before.
        fn new(seed: u64) -> Self {
            let pad = VirtualPad::new(Calibrator::rest(), seed);
            let mut context = Self { pad, hands: Calibrator::new(seed), obeyed: None, off_mm: 0.0 };
            (0..1_500).for_each(|_| drop(context.emitted()));
            context
        }

        fn emitted(&mut self) -> (HostInstant, Vec<u8>) {
            let (now_us, mut bytes) = (self.pad.due_us(), Vec::new());
            self.pad.emit(now_us, &mut bytes);
            (HostInstant::default().plus_us(BEGIN_US + now_us), bytes)
        }

        fn obey(&mut self, step: &GuideStep) {
            if self.obeyed.as_ref().is_some_and(|obeyed| !is_other(obeyed, step)) {
                return;
            }
            self.obeyed = Some(step.clone());
            match step {
                GuideStep::Rest { .. } | GuideStep::Done => self.pad.play(Calibrator::rest()),
                GuideStep::Press { .. } => self.pad.play(self.hands.press()),
                GuideStep::Put { mark, .. } => {
                    let [x_mm, y_mm] = MARKS_MM[*mark];
                    self.pad.lay(self.hands.lay([x_mm + self.off_mm, y_mm], WEIGHT_G))
                }
                GuideStep::TakeAway { .. } => self.pad.lay(self.hands.take_away()),
            };
        }

        /// Goes on until the session stands so.
        fn lead(&mut self, session: &mut Session, until: impl Fn(&Position) -> bool) -> Position {
            loop {
                let position = session.position();
                if until(&position) {
                    return position;
                }
                self.obey(&position.step);
                let (at, bytes) = self.emitted();
                assert!(self.pad.due_us() < 400_000_000, "{position:?}");
                session.take(at, Call::Bytes(&bytes)).unwrap();
            }
        }
    }

    fn identity(serial: &str) -> Identity {
        let mut pad = VirtualPad::new(Calibrator::rest(), 1);
        let (mut bytes, mut link) = (Vec::new(), MessageReceiver::new());
        pad.introduce();
        pad.emit(pad.due_us(), &mut bytes);
        let told = bytes.iter().find_map(|byte| match link.push(*byte) {
            Some(Ok(Message::Identity(identity))) => Some(identity),
            _ => None,
        });
        Identity { serial_number: SerialNumber::from_ascii(serial).unwrap(), ..told.unwrap() }
    }

    fn begun(memory: &Memory, weight_g: Option<f64>) -> Session {
        let (guide, _) = guide(weight_g).unwrap();
        let mut session = Session::begin(guide, Box::new(memory.clone()), Some(&identity("A-1"))).unwrap();
        // The bridge is paused for it.
        session.take(HostInstant::default().plus_us(BEGIN_US), Call::Pause).unwrap();
        session
    }

    #[test]
    fn it_leads_from_the_middle_of_a_paused_game_to_a_decoder_that_knows_the_scale() {
        let (mut context, memory) = (GuideContext::new(5), Memory::default());
        let mut session = begun(&memory, Some(WEIGHT_G));
        context.lead(&mut session, |it| matches!(it.step, GuideStep::TakeAway { mark: 4 }));
        assert_eq!(memory.placements.lock().unwrap().len(), 4, "each mark is kept as soon as it is done");
        context.lead(&mut session, |it| it.step == GuideStep::Done);
        session.settle().unwrap();
        let calls = memory.calls.lock().unwrap();
        assert!(matches!(&calls[0], (at, OwnedCall::Bytes(_)) if *at == HostInstant::default()));
        assert!(calls.last().unwrap().0 < HostInstant::default().plus_us(200_000_000), "times begin anew");
        assert_eq!(memory.placements.lock().unwrap().len(), 5);
        let shares = Mutex::new(Vec::new());
        let (file, summary) = fitted(session.finish(), &|share| shares.lock().unwrap().push(share)).unwrap();
        assert!(read::playing(&file).is_ok());
        assert!(summary.scale_known && summary.placements == 5 && summary.presses > 350, "{summary:?}");
        assert!(summary.map.len() == 13 && summary.map.iter().all(|part| part.presses > 0), "{summary:?}");
        let shares = shares.into_inner().unwrap();
        assert!(shares.len() > 3 && shares.iter().all(|share| (0.0..=1.0).contains(share)), "{shares:?}");
    }

    #[test]
    fn a_weight_beside_its_mark_is_asked_for_elsewhere_without_trembling() {
        let (mut context, memory) = (GuideContext::new(6), Memory::default());
        let mut session = begun(&memory, Some(WEIGHT_G));
        context.off_mm = 10.0;
        let is_beside =
            |step: &GuideStep| matches!(step, GuideStep::Put { lying: LoadOnPad::Beside { .. }, .. });
        let first = context.lead(&mut session, |it| is_beside(&it.step));
        let cue = first.cue.clone();
        assert!(is_beside(&cue), "{first:?}");
        for _ in 0..2_000 {
            let (at, bytes) = context.emitted();
            session.take(at, Call::Bytes(&bytes)).unwrap();
            assert_eq!(session.position().cue, cue);
        }
    }

    #[test]
    fn what_was_kept_is_gone_on_from() {
        let (mut context, memory) = (GuideContext::new(7), Memory::default());
        let mut session = begun(&memory, Some(WEIGHT_G));
        context.lead(&mut session, |it| matches!(it.step, GuideStep::Put { mark: 2, .. }));
        let pressed_s = session.finish().pressed_s();
        let (mut again, _) = guide(Some(WEIGHT_G)).unwrap();
        let calls = memory.calls.lock().unwrap().clone();
        calls.iter().for_each(|(at, call)| again.remember(*at, call.as_call()));
        let end = calls.last().unwrap().0.plus_us(1_000_000);
        again.remember(end, Call::Unplugged);
        again.go_on(memory.placements.lock().unwrap().clone());
        assert!((again.pressed_s() - pressed_s).abs() < 0.05, "{} {pressed_s}", again.pressed_s());
        let kept = Memory { begin_us: end.as_ns() / 1_000, ..Memory::default() };
        let mut second = Session::begin(again, Box::new(kept), Some(&identity("A-1"))).unwrap();
        let next = context.lead(&mut second, |it| !matches!(it.step, GuideStep::Rest { .. }));
        assert!(matches!(next.step, GuideStep::Put { mark: 2, .. }) && next.placed == 2, "{next:?}");
    }

    #[test]
    fn another_pad_ends_it() {
        let memory = Memory::default();
        let mut session = begun(&memory, None);
        let at = HostInstant::default().plus_us(BEGIN_US + 1);
        session.take(at, Call::Unplugged).unwrap();
        let mut frame = [0; ENCODED_MAX];
        let length = encode_message(&Message::Identity(identity("B-2")), &mut frame);
        let refused = session.take(at, Call::Bytes(&frame[..length])).unwrap_err();
        assert!(refused.contains("another pad was plugged in (B-2)"), "{refused}");
    }
}
