//! A calibration at home, step by step: what to do next, and how far it is. It is fed with a pad's calls and reads no clock.

use firmware_proto::identity::SerialNumber;

use crate::play::home::{PressedPlaces, region_names};
use crate::play::reader::Reader;
use crate::play::weights::Placement;
use crate::play::windows::{WINDOW_S, Window};
use tactpad_core::pad::marks::MARKS_MM;
use tactpad_core::pad::weight::weight_n;
use tactpad_core::pipeline::Phase;
use tactpad_core::pipeline::call::Call;
use tactpad_core::quantity::Contact;
use tactpad_core::time::HostInstant;

/// The pad is left alone for so long at first.
pub const REST_S: f64 = 1.0;
/// So long a finger presses; fewer presses are fitted to as well, only not as finely.
pub const PRESSED_S: f64 = 60.0;
/// So much longer where everything was done already and somebody wants it better.
const MORE_S: f64 = 30.0;
/// Whoever leaves a part of the plate out goes on without it after so many times the time.
const PATIENCE: f64 = 1.5;
/// A weight is waited for so long to lie still.
pub const STILL_S: f64 = 2.0;
/// A pad that nobody calibrated yet reads its force and place so wrong, at most.
const FORCE_SHARE: f64 = 0.4;
const BESIDE_MM: f64 = 6.0;
/// What moves farther from one window's mean to the next one's does not lie still. Single samples are no measure: the hum of mains moves
/// them by millimetres.
const TRAVEL_MM: f32 = 1.0;
/// Something is called wrong only after so many windows of its touch: it is just being put down.
const SETTLING: usize = 5;
/// The pad is free again after so many windows.
const LIFTED: usize = 3;

/// Step to do now.
#[derive(Clone, Debug, PartialEq)]
pub enum GuideStep {
    /// Leave the pad alone.
    Rest {
        /// For so long it was left alone.
        rested_s: f64,
    },
    /// Press anywhere, again and again.
    Press {
        /// So long it was pressed.
        pressed_s: f64,
        /// And so long it is to be.
        of_s: f64,
        /// The part of the plate that was pressed least.
        next: &'static str,
        /// Parts that were never pressed.
        missing: usize,
    },
    /// Put the weight on a mark.
    Put {
        /// Which of [`MARKS_MM`].
        mark: usize,
        /// What lies there.
        lying: LoadOnPad,
    },
    /// Take it away again.
    TakeAway {
        /// From which of [`MARKS_MM`].
        mark: usize,
    },
    /// Nothing is left to do.
    Done,
}

/// Load on the pad where a weight is waited for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LoadOnPad {
    /// Nothing.
    Nothing,
    /// Something that was put down just now, or moves.
    Moving,
    /// The weight, for so long.
    Still {
        /// Seconds.
        still_s: f64,
    },
    /// Something that presses with quite another force.
    OtherForce {
        /// About so strong.
        force_n: f64,
    },
    /// The weight, but far from the mark.
    Beside {
        /// About there.
        place_mm: [f64; 2],
    },
    /// Nothing any more: it was taken away too early to be of use.
    TakenTooEarly,
}

/// Windows of one touch or one rest.
#[derive(Clone, Copy, Debug, Default)]
struct WindowRun {
    stretch: usize,
    windows: usize,
    /// How many of the last ones the weight lay still in.
    still: usize,
    /// The mean place in the last one.
    last_mm: Option<[f32; 2]>,
}

/// Leads through a calibration.
#[derive(Debug)]
pub struct Guide {
    reader: Reader,
    weight_g: Option<f64>,
    placements: Vec<Placement>,
    step: GuideStep,
    goal_s: f64,
    /// Windows that were judged.
    judged: usize,
    run: WindowRun,
    /// A moment at which the weight that is to be taken away lay still.
    still_at_s: f64,
}

impl Guide {
    /// One that has heard nothing. Without a weight there are presses only.
    pub fn new(reader: Reader, weight_g: Option<f64>) -> Self {
        Self {
            reader,
            weight_g,
            placements: Vec::new(),
            step: GuideStep::Rest { rested_s: 0.0 },
            goal_s: PRESSED_S,
            judged: 0,
            run: WindowRun::default(),
            still_at_s: 0.0,
        }
    }

    /// Makes a call of an earlier part of the same calibration: it counts, and asks for nothing.
    pub fn remember(&mut self, now: HostInstant, call: Call<'_>) {
        self.reader.apply(now, call);
    }

    /// Goes on after what was remembered, with the weights that were put down there; one that is not found there is forgotten. Where
    /// nothing was left to do, more presses are asked for.
    pub fn go_on(&mut self, mut placements: Vec<Placement>) {
        placements.retain(|it| it.found(self.reader.windows()).is_ok());
        self.placements = placements;
        self.judged = self.reader.windows().len();
        self.run = WindowRun::default();
        let heard_s = self.pressed_s();
        if heard_s >= PRESSED_S && (self.weight_g.is_none() || self.mark_left().is_none()) {
            self.goal_s = heard_s + MORE_S;
        }
    }

    /// Makes a call, and looks what is to be done after it.
    pub fn apply(&mut self, now: HostInstant, call: Call<'_>) {
        self.reader.apply(now, call);
        while let Some(window) = self.reader.windows().get(self.judged).copied() {
            self.judged += 1;
            self.judge(&window);
        }
    }

    /// Step to do now.
    pub const fn step(&self) -> &GuideStep {
        &self.step
    }

    /// The weight, in grams.
    pub const fn weight_g(&self) -> Option<f64> {
        self.weight_g
    }

    /// Weights that were put down and taken away.
    pub fn placements(&self) -> &[Placement] {
        &self.placements
    }

    /// How many windows were judged: as long as it stays, nothing is new.
    pub const fn judged(&self) -> usize {
        self.judged
    }

    /// For how long a finger pressed, without the weights.
    pub fn pressed_s(&self) -> f64 {
        self.pressed().seconds
    }

    /// What the pad is doing.
    pub fn phase(&self) -> Phase {
        self.reader.phase()
    }

    /// The pad, once it has told who it is.
    pub fn serial_number(&self) -> Option<SerialNumber> {
        self.reader.serial_number()
    }

    /// What a fit takes.
    pub fn finish(self) -> (Vec<Window>, Vec<Placement>) {
        (self.reader.finish(), self.placements)
    }

    fn pressed(&self) -> PressedPlaces {
        PressedPlaces::of(self.reader.windows(), &self.placements)
    }

    fn mark_left(&self) -> Option<usize> {
        let is_placed = |mark_mm: &[f64; 2]| self.placements.iter().any(|it| it.place_mm == *mark_mm);
        MARKS_MM.iter().position(|mark_mm| !is_placed(mark_mm))
    }

    fn judge(&mut self, window: &Window) {
        if self.run.stretch != window.stretch {
            self.run = WindowRun { stretch: window.stretch, ..WindowRun::default() };
        }
        self.run.windows += 1;
        self.step = match self.step {
            GuideStep::Rest { .. } => self.rest(window),
            GuideStep::Press { .. } => self.press(window),
            GuideStep::Put { mark, lying } => self.put(mark, lying, window),
            GuideStep::TakeAway { mark } => self.take_away(mark, window),
            GuideStep::Done => GuideStep::Done,
        };
    }

    fn rest(&self, window: &Window) -> GuideStep {
        let rested_s = if window.contact.is_none() { WINDOW_S * self.run.windows as f64 } else { 0.0 };
        if rested_s + 0.5 * WINDOW_S < REST_S { GuideStep::Rest { rested_s } } else { self.press(window) }
    }

    fn press(&self, window: &Window) -> GuideStep {
        let PressedPlaces { seconds: pressed_s, by_region } = self.pressed();
        let missing = by_region.iter().filter(|count| **count == 0).count();
        let is_enough = pressed_s >= if missing == 0 { self.goal_s } else { PATIENCE * self.goal_s };
        if is_enough && window.contact.is_none() {
            return self.next_mark();
        }
        let least = by_region.iter().zip(region_names()).min_by_key(|(count, _)| **count);
        GuideStep::Press { pressed_s, of_s: self.goal_s, next: least.map_or("", |(_, name)| name), missing }
    }

    fn next_mark(&self) -> GuideStep {
        match self.mark_left().filter(|_| self.weight_g.is_some()) {
            Some(mark) => GuideStep::Put { mark, lying: LoadOnPad::Nothing },
            None => GuideStep::Done,
        }
    }

    fn put(&mut self, mark: usize, before: LoadOnPad, window: &Window) -> GuideStep {
        let Some(contact) = window.contact else {
            let is_told = before == LoadOnPad::TakenTooEarly;
            return GuideStep::Put { mark, lying: if is_told { before } else { LoadOnPad::Nothing } };
        };
        let wrong = self.weight_g.and_then(|weight_g| wrong(&contact, MARKS_MM[mark], weight_g));
        let place_mm = [contact.x_mm, contact.y_mm];
        let stays =
            |[x_mm, y_mm]: [f32; 2]| libm::hypotf(place_mm[0] - x_mm, place_mm[1] - y_mm) <= TRAVEL_MM;
        let is_still = wrong.is_none() && window.is_full && self.run.last_mm.is_some_and(stays);
        self.run.last_mm = Some(place_mm);
        self.run.still = if is_still { self.run.still + 1 } else { 0 };
        let still_s = WINDOW_S * self.run.still as f64;
        if still_s + 0.5 * WINDOW_S >= STILL_S {
            self.still_at_s = window.at_s() - 0.5 * STILL_S;
            return GuideStep::TakeAway { mark };
        }
        let lying = match wrong {
            Some(wrong) if self.run.windows > SETTLING => wrong,
            None if is_still => LoadOnPad::Still { still_s },
            _ => LoadOnPad::Moving,
        };
        GuideStep::Put { mark, lying }
    }

    fn take_away(&mut self, mark: usize, window: &Window) -> GuideStep {
        if window.contact.is_some() || self.run.windows < LIFTED {
            return GuideStep::TakeAway { mark };
        }
        let weight_g = self.weight_g.unwrap_or_default();
        let placement = Placement { line: 0, at_s: self.still_at_s, place_mm: MARKS_MM[mark], weight_g };
        match placement.found(self.reader.windows()) {
            Ok(_) => {
                self.placements.push(placement);
                self.next_mark()
            }
            // It was lifted in between, so that no part of its rest is long enough.
            Err(_) => GuideStep::Put { mark, lying: LoadOnPad::TakenTooEarly },
        }
    }
}

/// What is wrong with what lies there, as far as a pad tells that nobody calibrated yet.
fn wrong(contact: &Contact, mark_mm: [f64; 2], weight_g: f64) -> Option<LoadOnPad> {
    let (force_n, wanted_n) = (f64::from(contact.fz_n), weight_n(weight_g));
    if (force_n - wanted_n).abs() > FORCE_SHARE * wanted_n {
        return Some(LoadOnPad::OtherForce { force_n });
    }
    let place_mm = [contact.x_mm, contact.y_mm].map(f64::from);
    let off_mm = (place_mm[0] - mark_mm[0]).hypot(place_mm[1] - mark_mm[1]);
    (off_mm > BESIDE_MM).then_some(LoadOnPad::Beside { place_mm })
}
