//! How long a game takes from an event to the first frame that shows it.

use tactpad::bridge::sink::Sink;
use tactpad::bridge::sink::x11::X11Sink;
use tactpad::numeric::random::SplitMix64;
use tactpad::numeric::statistics::{deviation, mean, median};
use tactpad::pipeline::control::{Code, OutputDevice, OutputEvent};
use tactpad::time::StreamInstant;

use crate::clock::{MS, monotonic_ns, wait_until};
use crate::desk::{Desk, await_some, pause_ms};
use crate::framebuffer::Area;
use crate::hand::EXACT;
use crate::player::{Player, thumb_script};
use crate::segment::Segment;
use crate::trial::{Bridge, Game, profile_of};

/// A thing that a key does at once, in a place where nothing else moves.
pub(crate) struct Jump {
    pub(crate) key: u16,
    /// The profile's word for it.
    pub(crate) meant: &'static str,
    pub(crate) around: Area,
}

/// A game in which a key does that.
pub(crate) trait Jumper: Game {
    fn jump(&self) -> Jump;
}

/// The picture rests if it has not changed for so long.
const STILL_MS: u64 = 150;
/// Presses come at any time of a frame.
const PHASE_MAX_MS: f64 = 40.0;
/// A press lasts so long.
const PRESS_MS: u64 = 80;
/// What has not come by then does not come.
const LIMIT_MS: u64 = 1_000;
const SEED: u64 = 1;

/// Watches a part of the screen.
struct Watch<'a> {
    desk: &'a Desk,
    area: Area,
    phase: SplitMix64,
}

impl<'a> Watch<'a> {
    fn new(desk: &'a Desk, area: Area) -> Self {
        Self { desk, area, phase: SplitMix64::named(SEED, "phase") }
    }

    fn seen(&self) -> Vec<[u8; 3]> {
        self.desk.screen.picture_of(&self.area)
    }

    /// Waits until the picture rests, and then for a part of a frame.
    fn rest(&mut self) -> Vec<[u8; 3]> {
        let mut seen = self.seen();
        let mut still_ns = self.still_ns();
        let rests = await_some(20_000, || {
            let now = self.seen();
            if now != seen {
                (seen, still_ns) = (now, self.still_ns());
            }
            (monotonic_ns() >= still_ns).then_some(())
        });
        assert!(rests.is_some(), "the picture never rests");
        seen
    }

    /// How long the picture must stay as it is from now on.
    fn still_ns(&mut self) -> u64 {
        let phase_ms = f64::from(self.phase.fraction()) * PHASE_MAX_MS;
        monotonic_ns() + STILL_MS * MS + (phase_ms * MS as f64) as u64
    }

    /// When the picture changes from what it was; `None` where it had changed before anything was done, or never does.
    fn changes_ns(&self, before: &[[u8; 3]]) -> Option<u64> {
        let end_ns = monotonic_ns() + LIMIT_MS * MS;
        while monotonic_ns() < end_ns {
            if self.seen() != before {
                return Some(monotonic_ns());
            }
            wait_until(monotonic_ns() + MS / 4);
        }
        None
    }
}

/// Times to the first changed frame, in milliseconds.
#[derive(Default)]
pub(crate) struct Times {
    /// From a key's event at the X server.
    pub(crate) events_ms: Vec<f64>,
    /// From where the finger's force passes the profile's threshold.
    pub(crate) presses_ms: Vec<f64>,
}

/// Both, `count` times, in turn.
pub(crate) fn times(game: &dyn Jumper, profile: &str, count: usize) -> Times {
    let Jump { key, around, .. } = game.jump();
    let mut watch = Watch::new(game.desk(), around);
    let mut keys = X11Sink::open(Some(&game.desk().display), None).unwrap();
    let presser = Presser::new(game, profile);
    let mut times = Times::default();
    for _ in 0..count {
        let before = watch.rest();
        let begin_ns = monotonic_ns();
        keys.write(&[event(key, 1)]).unwrap();
        let end_ns = watch.changes_ns(&before).expect("the game does something");
        times.events_ms.push(1e-6 * (end_ns - begin_ns) as f64);
        pause_ms(PRESS_MS);
        keys.write(&[event(key, 0)]).unwrap();
        let before = watch.rest();
        let begun = presser.press();
        let end_ns = watch.changes_ns(&before).expect("the game does something");
        times.presses_ms.push(1e-6 * (end_ns as f64 - begun() as f64));
    }
    times
}

fn event(key: u16, value: i32) -> OutputEvent {
    OutputEvent { at: StreamInstant::from_us(0), device: OutputDevice::Keyboard, code: Code::Key(key), value }
}

/// A finger that presses the same each time.
struct Presser {
    bridge: Bridge,
    press: Segment,
    /// From the press's begin to the threshold.
    passes_us: u64,
}

impl Presser {
    fn new(game: &dyn Jumper, profile: &str) -> Self {
        let bridge = Bridge::start(game.desk(), Player::on_twin(EXACT, SEED), profile);
        let press = Segment::default().tap(game.jump().meant, 0, PRESS_MS);
        let threshold_n = profile_of(profile).buttons[0].press_n;
        let script = thumb_script(EXACT, &press, SEED);
        let mut times_us = (0..1_000 * press.length_ms()).step_by(100);
        let passes_us = times_us.find(|at_us| script.contact_at(*at_us).fz_n >= threshold_n);
        let passes_us = passes_us.expect("it presses hard enough");
        Self { bridge, press, passes_us }
    }

    /// Begins to press; afterwards it is known when the threshold was passed, by the monotonic clock.
    fn press(&self) -> impl Fn() -> u64 {
        self.bridge.player.play(&self.press);
        || self.bridge.player.begun().expect("it has begun").host_ns + 1_000 * self.passes_us
    }
}

/// A line of a table.
pub(crate) fn row(name: &str, times_ms: &[f64]) -> String {
    let mut sorted = times_ms.to_vec();
    sorted.sort_by(f64::total_cmp);
    let late_ms = sorted[(sorted.len() * 95 / 100).min(sorted.len() - 1)];
    let (mean_ms, deviation_ms) = (mean(times_ms), deviation(times_ms));
    let median_ms = median(times_ms.iter().copied()).unwrap();
    format!(
        "| {name} | {} | {mean_ms:.1} ± {deviation_ms:.1} | {median_ms:.1} | {late_ms:.1} |",
        times_ms.len()
    )
}
