//! People who stand on a board: whatever they weigh, the same leaning and stamping gives the same events.
//!
//! The people are simulated: how they sway, lean, bounce and stamp is made up, after what force plates show of people.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::f64::consts::{PI, TAU};

use firmware_proto::ENCODED_MAX;
use firmware_proto::channels::ChannelSample;
use firmware_proto::frame::Message;
use firmware_proto::link::encode_message;
use firmware_proto::sample::Status;
use tactpad::pipeline::Pipeline;
use tactpad::pipeline::contact::read::playing;
use tactpad::source::{Measures, read, shipped};

use crate::rig::{Rig, profile};

mod histories;

/// Standard gravity, N per kg.
const N_PER_KG: f64 = 9.806_65;

/// The board repeats its state so often, and has a new one every second time, ms.
const FRAME_MS: u64 = 5;

/// Somebody who stands on the board.
#[derive(Clone, Copy, Debug)]
struct Person {
    mass_kg: f64,
    /// Where they stand, from the middle of the board, mm.
    at_mm: [f64; 2],
    /// How far they lean to the side, forwards and backwards, mm.
    sideways_mm: f64,
    forwards_mm: f64,
    backwards_mm: f64,
    /// By how much they sway to the side and forwards, mm.
    sway_mm: [f64; 2],
    /// What a bounce and a stamp weigh at their height, in weights.
    bounce: f64,
    stamp: f64,
    /// Where in their sway they begin, rad.
    phase: f64,
}

/// The people on whom the thresholds of the profile were chosen.
const CHOOSING: [Person; 4] = [
    Person {
        mass_kg: 31.0,
        at_mm: [12.0, -6.0],
        sideways_mm: 90.0,
        forwards_mm: 55.0,
        backwards_mm: 46.0,
        sway_mm: [4.0, 6.0],
        bounce: 1.55,
        stamp: 2.7,
        phase: 0.3,
    },
    Person {
        mass_kg: 58.0,
        at_mm: [-15.0, 10.0],
        sideways_mm: 115.0,
        forwards_mm: 75.0,
        backwards_mm: 50.0,
        sway_mm: [3.0, 5.0],
        bounce: 1.7,
        stamp: 3.1,
        phase: 1.9,
    },
    Person {
        mass_kg: 84.0,
        at_mm: [0.0, 4.0],
        sideways_mm: 130.0,
        forwards_mm: 70.0,
        backwards_mm: 55.0,
        sway_mm: [5.0, 7.0],
        bounce: 1.5,
        stamp: 2.5,
        phase: 4.1,
    },
    Person {
        mass_kg: 131.0,
        at_mm: [20.0, 0.0],
        sideways_mm: 100.0,
        forwards_mm: 60.0,
        backwards_mm: 48.0,
        sway_mm: [6.0, 8.0],
        bounce: 1.5,
        stamp: 2.4,
        phase: 5.5,
    },
];

/// Others, who were looked at only afterwards.
const SHOWN: [Person; 3] = [
    Person {
        mass_kg: 45.0,
        at_mm: [-9.0, 8.0],
        sideways_mm: 105.0,
        forwards_mm: 62.0,
        backwards_mm: 47.0,
        sway_mm: [3.5, 6.5],
        bounce: 1.62,
        stamp: 2.9,
        phase: 2.7,
    },
    Person {
        mass_kg: 70.0,
        at_mm: [17.0, -11.0],
        sideways_mm: 120.0,
        forwards_mm: 80.0,
        backwards_mm: 52.0,
        sway_mm: [4.5, 5.5],
        bounce: 1.58,
        stamp: 2.6,
        phase: 0.9,
    },
    Person {
        mass_kg: 110.0,
        at_mm: [4.0, 12.0],
        sideways_mm: 96.0,
        forwards_mm: 66.0,
        backwards_mm: 50.0,
        sway_mm: [5.5, 7.5],
        bounce: 1.53,
        stamp: 2.5,
        phase: 3.4,
    },
];

/// What they do.
#[derive(Clone, Copy, Debug)]
enum Act {
    StepOn,
    Stand,
    /// Towards one of eight directions, counted from right, counter-clockwise.
    Lean(u32),
    Bounce,
    Stamp,
    /// A stamp while leaning.
    LeanAndStamp(u32),
    Jump,
    StepOff,
}

impl Act {
    fn duration_s(self) -> f64 {
        match self {
            Self::StepOn | Self::StepOff => 1.0,
            Self::Stand => 1.6,
            Self::Lean(_) | Self::LeanAndStamp(_) => 2.4,
            Self::Bounce | Self::Stamp => 1.0,
            Self::Jump => 1.6,
        }
    }

    /// Events that are meant.
    fn events(self) -> Vec<String> {
        let hat = |direction: u32, is_down: bool| {
            let [x, y] =
                [direction_of(direction)[0], -direction_of(direction)[1]].map(|way| way.round() as i32);
            let axes = [("ABS_HAT0X", x), ("ABS_HAT0Y", y)];
            let moved = axes.into_iter().filter(|(_, way)| *way != 0);
            moved.map(|(axis, way)| format!("{axis}={}", if is_down { way } else { 0 })).collect::<Vec<_>>()
        };
        let press = |key: &str| vec![format!("{key}=1"), format!("{key}=0")];
        match self {
            Self::Lean(direction) => [hat(direction, true), hat(direction, false)].concat(),
            Self::LeanAndStamp(direction) => {
                [hat(direction, true), press("BTN_EAST"), hat(direction, false)].concat()
            }
            Self::Bounce => press("BTN_SOUTH"),
            Self::Stamp => press("BTN_EAST"),
            _ => Vec::new(),
        }
    }
}

fn direction_of(direction: u32) -> [f64; 2] {
    let (sin, cos) = (f64::from(direction) * PI / 4.0).sin_cos();
    [cos, sin]
}

/// From 0 to 1, smoothly, in the stretch of time.
fn ramp(t_s: f64, from_s: f64, to_s: f64) -> f64 {
    let part = ((t_s - from_s) / (to_s - from_s)).clamp(0.0, 1.0);
    0.5 - 0.5 * (PI * part).cos()
}

/// Half a wave of this height in the stretch of time.
fn wave(t_s: f64, from_s: f64, to_s: f64) -> f64 {
    let part = (t_s - from_s) / (to_s - from_s);
    if (0.0..=1.0).contains(&part) { (PI * part).sin() } else { 0.0 }
}

impl Person {
    fn weight_n(&self) -> f64 {
        self.mass_kg * N_PER_KG
    }

    /// The force in weights and where it is, mm, `t_s` after an act began, at `since_s` of all.
    fn press(&self, act: Act, t_s: f64, since_s: f64) -> (f64, [f64; 2]) {
        let sway =
            |k: usize, hz: f64| self.sway_mm[k] * (TAU * hz * since_s + self.phase * (k as f64 + 1.0)).sin();
        let mut place_mm = [
            self.at_mm[0] + 0.6 * sway(0, 0.31) + 0.4 * sway(0, 0.83),
            self.at_mm[1] + 0.6 * sway(1, 0.27) + 0.4 * sway(1, 0.71),
        ];
        let mut weights = 1.0 + 0.008 * (TAU * 1.2 * since_s + self.phase).sin();
        match act {
            Act::StepOn | Act::StepOff => {
                let t_s = if matches!(act, Act::StepOn) { t_s } else { act.duration_s() - t_s };
                // One foot first, 120 mm to the left; then the other one takes its half.
                let (foot, other) = (ramp(t_s, 0.0, 0.35), ramp(t_s, 0.35, 0.9));
                weights *= 0.6 * foot + 0.4 * other;
                place_mm[0] -= 120.0 * (1.0 - other);
            }
            Act::Stand => {}
            Act::Lean(direction) | Act::LeanAndStamp(direction) => {
                let [x, y] = direction_of(direction);
                let leans = ramp(t_s, 0.0, 0.5) - ramp(t_s, 1.5, 2.0);
                place_mm[0] += leans * x * self.sideways_mm;
                place_mm[1] += leans * y * if y > 0.0 { self.forwards_mm } else { self.backwards_mm };
                weights += 0.05 * (wave(t_s, 0.0, 0.5) - wave(t_s, 1.5, 2.0));
                if matches!(act, Act::LeanAndStamp(_)) {
                    weights += self.stamped(t_s - 0.7);
                }
            }
            Act::Bounce => {
                weights += (self.bounce - 1.0) * wave(t_s, 0.25, 0.6) - 0.35 * wave(t_s, 0.0, 0.25);
                weights -= 0.2 * wave(t_s, 0.6, 0.8);
            }
            Act::Stamp => weights += self.stamped(t_s),
            Act::Jump => {
                let off = wave(t_s, 0.0, 0.2) * -0.4 + wave(t_s, 0.2, 0.45) * 1.2;
                let flight = if (0.45..0.8).contains(&t_s) { 0.0 } else { 1.0 };
                weights = (weights + off) * flight + 1.6 * wave(t_s, 0.8, 0.95);
            }
        }
        (weights.max(0.0), place_mm)
    }

    /// What a stamp of both feet adds, in weights: a dip, the impact, the way back.
    fn stamped(&self, t_s: f64) -> f64 {
        (self.stamp - 1.0) * wave(t_s, 0.15, 0.3) - 0.4 * wave(t_s, 0.0, 0.15) - 0.25 * wave(t_s, 0.3, 0.45)
    }
}

/// The board with its profile, untouched for a moment.
struct Board {
    rig: Rig,
    /// Of the cells, mm from the middle, and the newtons of a count.
    half_mm: [f64; 2],
    n_per_count: f64,
    counts: [i32; 4],
    /// What each cell reads of nothing, N.
    zeros_n: [f64; 4],
}

impl Board {
    fn new() -> Self {
        let text = shipped::text("balance-board-standing").unwrap();
        let Measures::Cells(_, reach) = read::read(text).0.unwrap().measures else { panic!("it has cells") };
        let mut rig = Rig::new(profile("board-standing"));
        rig.pipeline = Pipeline::new(playing(text.as_bytes()).unwrap(), profile("board-standing"));
        let mut board = Self {
            rig,
            half_mm: reach.half_mm,
            n_per_count: reach.n_per_unit,
            counts: [0; 4],
            zeros_n: [0.0; 4],
        };
        board.load(0.0, [0.0; 2], 600);
        board
    }

    /// A force at a place for so long.
    fn load(&mut self, force_n: f64, place_mm: [f64; 2], ms: u64) {
        for _ in 0..ms / FRAME_MS {
            self.frame(force_n, place_mm);
        }
    }

    fn frame(&mut self, force_n: f64, [x_mm, y_mm]: [f64; 2]) {
        let Rig { now_us, sequence, .. } = &mut self.rig;
        *now_us += 1_000 * FRAME_MS;
        *sequence = sequence.wrapping_add(1);
        if sequence.is_multiple_of(2) {
            let signs = [[-1.0, 1.0], [1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
            let noise = [3, 7, 11, 13].map(|k| (u64::from(*sequence) * k % 17) as f64 * 0.1 - 0.8);
            let [along, up] = [x_mm / self.half_mm[0], y_mm / self.half_mm[1]];
            let zeros_n = self.zeros_n.iter().zip(noise).map(|(zero_n, noise_n)| zero_n + noise_n);
            for ((count, [right, upper]), noise_n) in self.counts.iter_mut().zip(signs).zip(zeros_n) {
                let cell_n = force_n * (1.0 + right * along) * (1.0 + upper * up) / 4.0 + noise_n;
                // The driver knows nothing below a cell's zero.
                *count = (cell_n / self.n_per_count).round().max(0.0) as i32;
            }
        }
        let sample = ChannelSample::new(*sequence, *now_us, &self.counts, Status::OK).unwrap();
        let mut bytes = [0; ENCODED_MAX];
        let length = encode_message(&Message::Channels(sample), &mut bytes);
        self.rig.bytes(&bytes[..length]);
    }

    /// It says nothing for so long.
    fn stall(&mut self, ms: u64) {
        self.rig.silence(ms);
    }

    /// Events while somebody does this.
    fn play(&mut self, person: &Person, act: Act) -> Vec<String> {
        let frames = (act.duration_s() * 1e3) as u64 / FRAME_MS;
        for frame in 0..frames {
            let since_s = self.rig.now_us as f64 * 1e-6;
            let (weights, place_mm) = person.press(act, (frame * FRAME_MS) as f64 * 1e-3, since_s);
            self.frame(weights * person.mass_kg * N_PER_KG, place_mm);
        }
        self.rig.take_events()
    }

    /// What is meant comes out, and nothing else, and nothing is held after it.
    fn expect(&mut self, person: &Person, act: Act) {
        assert_eq!(self.play(person, act), act.events(), "{act:?} of {person:?}");
        assert!(self.rig.is_neutral(), "{act:?} of {person:?}");
    }
}

/// Somebody steps on, does all there is to do, and leaves.
fn plays(board: &mut Board, person: &Person) {
    let leans = (0..8).map(Act::Lean);
    let stamping = (0..8).map(Act::LeanAndStamp);
    let acts = [Act::StepOn, Act::Stand].into_iter().chain(leans).chain([
        Act::Bounce,
        Act::Stamp,
        Act::Bounce,
        Act::Stamp,
    ]);
    for act in acts.chain(stamping).chain([Act::Stand, Act::StepOff]) {
        board.expect(person, act);
    }
    board.load(0.0, [0.0; 2], 2_000);
    assert!(board.rig.is_neutral() && board.rig.take_events().is_empty());
}

#[test]
fn the_thresholds_fit_the_people_on_whom_they_were_chosen() {
    CHOOSING.iter().for_each(|person| plays(&mut Board::new(), person));
}

#[test]
fn people_of_45_70_and_110_kg_lean_and_stamp_and_the_events_are_those_that_were_meant() {
    SHOWN.iter().for_each(|person| plays(&mut Board::new(), person));
}

#[test]
fn one_after_the_other_plays_on_the_same_board() {
    let mut board = Board::new();
    SHOWN.iter().rev().chain(&SHOWN).for_each(|person| plays(&mut board, person));
}

#[test]
fn what_lay_on_a_board_whose_zero_has_jumped_holds_nothing_once_it_has_gone() {
    let mut board = Board::new();
    let (none, jumped) = ([-1e3; 4], [7.746_135, 13.791_787, 14.591_550, 12.095_175]);
    let loads = [
        (none, 0.0, 0.0, 20),
        (jumped, 59.294_314, -143.097_157, 1_020),
        (jumped, 42.829_300, 0.0, 30),
        (jumped, 0.0, 0.0, 4_000),
    ];
    for (zeros_n, force_n, x_mm, ms) in loads {
        board.zeros_n = zeros_n;
        board.load(force_n, [x_mm, 0.0], ms);
    }
    assert!(board.rig.is_neutral());
}

#[test]
fn a_jump_ends_in_nothing_that_is_held_and_keeps_the_weight() {
    for person in &SHOWN {
        let mut board = Board::new();
        [Act::StepOn, Act::Stand].into_iter().for_each(|act| board.expect(person, act));
        let events = board.play(person, Act::Jump);
        assert!(
            events.contains(&"BTN_EAST=1".into()) || events.contains(&"BTN_SOUTH=1".into()),
            "{events:?}"
        );
        assert!(board.rig.is_neutral());
        board.expect(person, Act::Lean(0));
    }
}

#[test]
fn who_leaves_while_a_direction_is_held_holds_nothing() {
    let mut board = Board::new();
    [Act::StepOn, Act::Stand].into_iter().for_each(|act| board.expect(&SHOWN[1], act));
    board.load(70.0 * N_PER_KG, [150.0, 0.0], 500);
    assert_eq!(board.rig.take_events(), ["ABS_HAT0X=1"]);
    board.load(0.0, [0.0; 2], 100);
    assert_eq!(board.rig.take_events(), ["ABS_HAT0X=0"]);
    assert!(board.rig.is_neutral());
}
