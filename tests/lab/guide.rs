//! A guided calibration at home, in stream time, on a virtual pad whose hands do what is asked.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::mem::discriminant;

use tactpad::lab::play::guide::{Guide, GuideStep, LoadOnPad};
use tactpad::lab::play::reader::Reader;
use tactpad::lab::play::weights::Placement;
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;
use tactpad::pad::marks::MARKS_MM;
use tactpad::pipeline::call::Call;
use tactpad::pipeline::contact::read::playing;
use tactpad::pipeline::mapping::read::check::{OutputChoice, read};
use tactpad::pipeline::mapping::read::shipped as profiles;
use tactpad::pipeline::shipped;
use tactpad::time::HostInstant;
use tactpad::virtual_pad::firmware::VirtualPad;
use tactpad::virtual_pad::freehand::Calibrator;

const WEIGHT_G: f64 = 200.0;
/// No session lasts longer.
const LIMIT_US: u64 = 400_000_000;

fn guide(weight_g: Option<f64>) -> Guide {
    let profile = read(profiles::text("super-mario").unwrap(), OutputChoice::AsWritten).0.unwrap();
    let decoder = playing(&shipped::bytes("inverse").unwrap()).unwrap();
    Guide::new(Reader::new(decoder, profile), weight_g)
}

/// A pad with hands, and what was said to them.
struct Scene {
    pad: VirtualPad,
    hands: Calibrator,
    /// What is really put on the marks.
    weight_g: f64,
    /// How far beside.
    off_mm: f64,
    /// What was done, as calls.
    calls: Vec<(HostInstant, Vec<u8>)>,
    steps: Vec<GuideStep>,
}

impl Scene {
    fn new(seed: u64) -> Self {
        Self::on(VirtualPad::new(Calibrator::rest(), seed), seed)
    }

    fn on(mut pad: VirtualPad, seed: u64) -> Self {
        pad.introduce();
        Self {
            pad,
            hands: Calibrator::new(seed),
            weight_g: WEIGHT_G,
            off_mm: 0.0,
            calls: Vec::new(),
            steps: Vec::new(),
        }
    }

    fn obey(&mut self, step: &GuideStep) {
        match step {
            GuideStep::Rest { .. } | GuideStep::Done => self.pad.play(Calibrator::rest()),
            GuideStep::Press { .. } => self.pad.play(self.hands.press()),
            GuideStep::Put { mark, .. } => {
                let [x_mm, y_mm] = MARKS_MM[*mark];
                self.pad.lay(self.hands.lay([x_mm + self.off_mm, y_mm], self.weight_g))
            }
            GuideStep::TakeAway { .. } => self.pad.lay(self.hands.take_away()),
        };
    }

    /// Goes on until the guide says so.
    fn lead(&mut self, guide: &mut Guide, until: impl Fn(&GuideStep) -> bool) {
        let mut bytes = Vec::new();
        while !until(guide.step()) {
            let now_us = self.pad.due_us();
            assert!(now_us < LIMIT_US, "{:?}", guide.step());
            bytes.clear();
            self.pad.emit(now_us, &mut bytes);
            let at = HostInstant::default().plus_us(now_us);
            self.calls.push((at, bytes.clone()));
            guide.apply(at, Call::Bytes(&bytes));
            let step = guide.step();
            let is_begun = self.steps.last().is_some_and(|last| discriminant(last) == discriminant(step));
            if !is_begun {
                self.steps.push(step.clone());
                self.obey(&step.clone());
            }
        }
    }
}

#[test]
fn it_goes_through_all_steps() {
    let (mut scene, mut guide) = (Scene::new(7), guide(Some(WEIGHT_G)));
    scene.lead(&mut guide, |step| *step == GuideStep::Done);
    let kinds: Vec<char> = scene
        .steps
        .iter()
        .map(|step| match step {
            GuideStep::Rest { .. } => 'r',
            GuideStep::Press { .. } => 'p',
            GuideStep::Put { .. } => 'w',
            GuideStep::TakeAway { .. } => 't',
            GuideStep::Done => '.',
        })
        .collect();
    assert_eq!(kinds.iter().collect::<String>(), "rpwtwtwtwtwt.");
    assert!((60.0..63.0).contains(&guide.pressed_s()), "{}", guide.pressed_s());
    assert!(scene.pad.due_us() < 160_000_000, "{}", scene.pad.due_us());
    let (_, placements) = guide.finish();
    assert_eq!(placements.iter().map(|it| it.place_mm).collect::<Vec<_>>(), MARKS_MM);
}

#[test]
fn a_weight_is_found_to_lie_still_on_a_pad_that_hums() {
    let imperfections = include_str!("../../models/imperfections/paper.toml");
    let device = Device::nominal().with_imperfections(imperfections).0.unwrap();
    let pad = VirtualPad::of(Calibrator::rest(), &device, &PadField::nominal(), 12);
    let (mut scene, mut guide) = (Scene::on(pad, 12), guide(Some(WEIGHT_G)));
    scene.lead(&mut guide, |step| *step == GuideStep::Done);
    assert_eq!(guide.placements().len(), 5);
}

#[test]
fn without_a_weight_there_are_presses_only() {
    let (mut scene, mut guide) = (Scene::new(8), guide(None));
    // A paused game is no reason not to hear presses.
    guide.apply(HostInstant::default(), Call::Pause);
    scene.lead(&mut guide, |step| *step == GuideStep::Done);
    assert!(
        scene.steps.iter().all(|step| !matches!(step, GuideStep::Put { .. } | GuideStep::TakeAway { .. }))
    );
    assert!(guide.placements().is_empty() && guide.pressed_s() >= 60.0);
}

#[test]
fn another_weight_and_another_place_are_noticed_and_waited_out() {
    let (mut scene, mut guide) = (Scene::new(9), guide(Some(WEIGHT_G)));
    scene.weight_g = 100.0;
    scene.lead(&mut guide, |step| matches!(step, GuideStep::Put { lying: LoadOnPad::OtherForce { .. }, .. }));
    let GuideStep::Put { mark: 0, lying: LoadOnPad::OtherForce { force_n } } = guide.step().clone() else {
        panic!("{:?}", guide.step())
    };
    assert!((force_n - 0.98).abs() < 0.15, "{force_n}");
    // As long as it lies there, nothing goes on.
    let begin_us = scene.pad.due_us();
    let mut bytes = Vec::new();
    while scene.pad.due_us() < begin_us + 5_000_000 {
        bytes.clear();
        let now_us = scene.pad.due_us();
        scene.pad.emit(now_us, &mut bytes);
        guide.apply(HostInstant::default().plus_us(now_us), Call::Bytes(&bytes));
        assert!(matches!(guide.step(), GuideStep::Put { mark: 0, lying: LoadOnPad::OtherForce { .. } }));
    }
    // The right weight at the wrong place.
    (scene.weight_g, scene.off_mm) = (WEIGHT_G, 10.0);
    scene.obey(&guide.step().clone());
    scene.lead(&mut guide, |step| matches!(step, GuideStep::Put { lying: LoadOnPad::Beside { .. }, .. }));
    let GuideStep::Put { lying: LoadOnPad::Beside { place_mm: [x_mm, y_mm] }, .. } = guide.step().clone()
    else {
        panic!("{:?}", guide.step())
    };
    assert!((x_mm - 10.0).abs() < 2.0 && y_mm.abs() < 2.0, "({x_mm}, {y_mm})");
    scene.off_mm = 0.0;
    scene.obey(&guide.step().clone());
    scene.lead(&mut guide, |step| *step == GuideStep::Done);
    assert_eq!(guide.placements().len(), 5);
}

#[test]
fn a_session_is_taken_up_again_where_it_was_left() {
    let (mut first, mut heard) = (Scene::new(10), guide(Some(WEIGHT_G)));
    first.lead(&mut heard, |step| matches!(step, GuideStep::Put { mark: 2, .. }));
    let (pressed_s, placements) = (heard.pressed_s(), heard.placements().to_vec());
    assert_eq!(placements.len(), 2);

    let mut again = guide(Some(WEIGHT_G));
    for (at, bytes) in &first.calls {
        again.remember(*at, Call::Bytes(bytes));
    }
    let end = first.calls.last().unwrap().0.plus_us(1_000_000);
    again.remember(end, Call::Unplugged);
    let nowhere = Placement { at_s: 1e6, place_mm: MARKS_MM[2], ..placements[0] };
    again.go_on([placements.clone(), vec![nowhere]].concat());
    assert_eq!(again.placements(), placements);
    assert!((again.pressed_s() - pressed_s).abs() < 0.05, "{} {pressed_s}", again.pressed_s());
    assert_eq!(*again.step(), GuideStep::Rest { rested_s: 0.0 });

    // Another day: the pad's clock begins anew.
    let mut second = Scene::new(11);
    let mut bytes = Vec::new();
    while *again.step() != GuideStep::Done {
        let now_us = second.pad.due_us();
        assert!(now_us < 40_000_000, "{:?}", again.step());
        bytes.clear();
        second.pad.emit(now_us, &mut bytes);
        again.apply(end.plus_us(now_us), Call::Bytes(&bytes));
        let step = again.step().clone();
        if second.steps.last().is_none_or(|last| discriminant(last) != discriminant(&step)) {
            second.obey(&step);
            second.steps.push(step);
        }
    }
    assert!(
        second
            .steps
            .iter()
            .all(|step| !matches!(step, GuideStep::Press { .. } | GuideStep::Put { mark: 0 | 1, .. }))
    );
    assert_eq!(again.placements()[..2], placements);
    let (windows, placements) = again.finish();
    assert_eq!(placements.len(), 5);
    assert!(placements.iter().all(|it| it.found(&windows).is_ok()));
}
