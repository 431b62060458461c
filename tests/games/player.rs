//! A finger of software on the twin of the paper's pad, behind a pseudo-terminal.

use std::sync::{Arc, Mutex};

use tactpad::bridge::transport::virtual_pad::{PadFirmware, VirtualPadPort as Terminal};
use tactpad::lab::field_cache::field_of;
use tactpad::numeric::random::SplitMix64;
use tactpad::pad::device::Device;
use tactpad::quantity::Contact;
use tactpad::virtual_pad::firmware::VirtualPad;
use tactpad::virtual_pad::script::{Keyframe, Script};

use crate::clock::monotonic_ns;
use crate::segment::{Segment, Touch};

/// How a player presses.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Style {
    /// Deviation of where a touch lands from where it is meant to, along each axis.
    pub(crate) aim_mm: f64,
    /// Deviation of a force, as a share of it.
    pub(crate) force_share: f64,
}

/// Presses as most people do.
pub(crate) const ORDINARY: Style = Style { aim_mm: 1.5, force_share: 0.1 };

/// Presses the same each time.
pub(crate) const EXACT: Style = Style { aim_mm: 0.0, force_share: 0.0 };

/// A thumb that rests on the middle reaches so far for a direction.
const REACH_MM: f64 = 14.0;
/// With so much force it holds a direction,
const STEER_N: f64 = 1.0;
/// and with so much it presses a button.
const PRESS_N: f64 = 3.0;
/// No force is less, however it scatters.
const LEAST_N: f64 = 0.05;
/// A force comes within this time, and goes within this one.
const RISE_US: u64 = 50_000;
const FALL_US: u64 = 40_000;

/// Draws how a finger comes down each time.
struct Finger {
    style: Style,
    random: SplitMix64,
}

impl Finger {
    fn place_mm(&mut self, towards: Option<&str>) -> [f64; 2] {
        let aim = match towards {
            Some("right") => [REACH_MM, 0.0],
            Some("up") => [0.0, REACH_MM],
            Some("left") => [-REACH_MM, 0.0],
            Some("down") => [0.0, -REACH_MM],
            Some(other) => panic!("{other} is no direction"),
            None => [0.0, 0.0],
        };
        aim.map(|mm| mm + self.style.aim_mm * f64::from(self.random.normal()))
    }

    fn force_n(&mut self, meant_n: f64) -> f64 {
        (meant_n * (1.0 + self.style.force_share * f64::from(self.random.normal()))).max(LEAST_N)
    }

    fn touch(&mut self, touch: &Touch, keyframes: &mut Vec<Keyframe>) {
        let [x_mm, y_mm] = self.place_mm(touch.towards).map(|mm| mm as f32);
        let mut frame = |at_us: u64, fz_n: f64| {
            let contact = Contact { x_mm, y_mm, fz_n: fz_n as f32, ..Contact::default() };
            keyframes.push(Keyframe { at_us, contact });
        };
        let steer_n = if touch.towards.is_some() { self.force_n(STEER_N) } else { 0.0 };
        frame(1_000 * touch.begin_ms, 0.0);
        let mut free_us = 1_000 * touch.begin_ms;
        if touch.towards.is_some() {
            free_us += RISE_US;
            frame(free_us, steer_n);
        }
        for press in &touch.presses {
            let (begin_us, end_us) = (1_000 * press.begin_ms, 1_000 * press.end_ms);
            let press_n = self.force_n(PRESS_N);
            frame(begin_us.max(free_us), steer_n);
            frame(begin_us.max(free_us) + RISE_US, press_n);
            frame(end_us, press_n);
            free_us = end_us + FALL_US;
            frame(free_us, steer_n);
        }
        let lift_us = (1_000 * touch.end_ms).max(free_us);
        frame(lift_us, steer_n);
        frame(lift_us + FALL_US, 0.0);
    }
}

/// What the finger of this seed does for a segment.
fn script(segment: &Segment, style: Style, seed: u64) -> Script {
    let mut finger = Finger { style, random: SplitMix64::named(seed, "finger") };
    let mut keyframes = Vec::new();
    segment.0.iter().for_each(|touch| finger.touch(touch, &mut keyframes));
    Script::of(keyframes)
}

/// What the player's thread is told, and tells.
#[derive(Default)]
struct Cue {
    script: Option<Script>,
    begun: Option<Begun>,
}

/// When a script began.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Begun {
    /// By the pad's clock.
    pub(crate) pad_us: u64,
    /// By the host's: the sample that is due then is sent at this time or up to a sample's period later.
    pub(crate) host_ns: u64,
}

/// The pad on its wire. It rests until it is told to play.
struct OnCue {
    pad: VirtualPad,
    cue: Arc<Mutex<Cue>>,
}

impl PadFirmware for OnCue {
    fn receive(&mut self, bytes: &[u8]) {
        self.pad.receive(bytes);
    }

    fn due_us(&self) -> u64 {
        self.pad.due_us()
    }

    fn emit(&mut self, now_us: u64, bytes: &mut Vec<u8>) {
        let mut cue = self.cue.lock().unwrap();
        if let Some(script) = cue.script.take() {
            cue.begun = Some(Begun { host_ns: monotonic_ns(), pad_us: self.pad.play(script) });
        }
        drop(cue);
        self.pad.emit(now_us, bytes);
    }
}

/// A player at a pad of its own, both drawn from a seed.
pub(crate) struct Player {
    terminal: Terminal,
    cue: Arc<Mutex<Cue>>,
    style: Style,
    seed: u64,
}

impl Player {
    pub(crate) fn new(style: Style, seed: u64) -> Self {
        let text = include_str!("../../models/imperfections/paper.toml");
        let device = Device::nominal().with_imperfections(text).0.unwrap();
        let field = field_of(&device, |_| ()).unwrap().known;
        let pad = VirtualPad::of(Script::of(Vec::new()), &device, &field, seed);
        let cue = Arc::new(Mutex::new(Cue::default()));
        let terminal = Terminal::start(OnCue { pad, cue: Arc::clone(&cue) }).unwrap();
        Self { terminal, cue, style, seed }
    }

    /// The pad's port.
    pub(crate) fn path(&self) -> &str {
        self.terminal.path()
    }

    /// Begins now.
    pub(crate) fn play(&self, segment: &Segment) {
        let script = script(segment, self.style, self.seed);
        *self.cue.lock().unwrap() = Cue { script: Some(script), begun: None };
    }

    /// When the segment began.
    pub(crate) fn begun(&self) -> Option<Begun> {
        self.cue.lock().unwrap().begun
    }

    /// How long after the segment's begin the finger first presses with this force.
    pub(crate) fn passes_us(&self, segment: &Segment, fz_n: f32) -> Option<u64> {
        let script = script(segment, self.style, self.seed);
        (0..1_000 * segment.length_ms()).step_by(100).find(|at_us| script.contact_at(*at_us).fz_n >= fz_n)
    }
}
