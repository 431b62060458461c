//! One game, played once: who plays, and what came of it.

use std::fmt;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use tactpad::bridge::sink::Sink;
use tactpad::bridge::sink::x11::X11Sink;
use tactpad::pipeline::mapping::profile::Profile;
use tactpad::pipeline::mapping::read::check::{OutputChoice, read};

use crate::clock::{MS, monotonic_ns, wait_until};
use crate::desk::{Desk, Process, await_some};
use crate::hand::Style;
use crate::heard::Heard;
use crate::pads::{Kind, Owned};
use crate::player::Player;
use crate::segment::Segment;

/// A game that is on the screen and waits for its player.
pub(crate) trait Game {
    /// Where it is shown and listens.
    fn desk(&self) -> &Desk;

    /// What the screen says about how far the player has come.
    fn progress(&mut self) -> Progress;
}

/// How far a player has come.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Progress {
    /// On the way; where.
    Going(String),
    /// The landmark is reached.
    Reached,
    /// It cannot be reached any more; why.
    Lost(String),
}

/// Who plays.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Way<'a> {
    /// A finger on a pad, through the bridge; pad and finger are those of the seed.
    Pad { style: Style, seed: u64, profile: &'a str },
    /// Somebody on a pad that people own; both are those of the seed.
    Owned { kind: Kind, seed: u64, profile: &'a str },
    /// The commands themselves, through the same output.
    Plain { profile: &'a str },
}

impl fmt::Display for Way<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Plain { profile } => write!(f, "{profile}: the commands themselves"),
            Self::Owned { kind, seed, profile } => write!(f, "{profile}: {kind}, seed {seed}"),
            Self::Pad { style: Style { aim_mm, force_share }, seed, profile } => {
                write!(f, "{profile}: finger and pad {seed}, {aim_mm} mm, {:.0} %,", 100.0 * force_share)
            }
        }
    }
}

/// What came of it.
#[derive(Clone, Debug)]
pub(crate) struct Outcome {
    /// How long the landmark took, from the segment's begin; or what the screen showed at the end.
    pub(crate) reached_s: Result<f64, String>,
    /// Of a pad: things that did not come down as they were meant, or came down unasked.
    pub(crate) mispresses: usize,
    /// And what went down and up when.
    pub(crate) events: Vec<String>,
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.reached_s {
            Ok(s) => write!(f, "reached the landmark after {s:.2} s")?,
            Err(place) => write!(f, "did not reach the landmark: {place}")?,
        }
        match self.mispresses {
            0 => Ok(()),
            count => write!(f, "; {count} mis-presses"),
        }
    }
}

/// The landmark must be reached so long after the last command at the latest.
const AFTER_MS: u64 = 1_500;
/// What the last lift lets go has gone so long after it.
const RELEASED_MS: u64 = 400;
/// The screen is looked at so often.
const LOOK_MS: u64 = 15;

/// Plays `segment` once and watches.
pub(crate) fn play(game: &mut dyn Game, segment: &Segment, way: Way<'_>) -> Outcome {
    match way {
        Way::Pad { style, seed, profile } => play_on(Player::on_twin(style, seed), game, segment, profile),
        Way::Owned { kind, seed, profile } => {
            play_on(Player::Owned(Owned::start(kind, seed)), game, segment, profile)
        }
        Way::Plain { profile } => {
            let mut sink = X11Sink::open(Some(&game.desk().display), None).unwrap();
            let commands = segment.commands(&profile_of(profile));
            let mut next = commands.iter().peekable();
            let reached_s = watch(game, segment, |at_us| {
                while let Some(event) = next.next_if(|event| event.at.as_us() <= at_us) {
                    sink.write(&[*event]).unwrap();
                }
            });
            Outcome { reached_s, mispresses: 0, events: Vec::new() }
        }
    }
}

fn play_on(player: Player, game: &mut dyn Game, segment: &Segment, profile: &str) -> Outcome {
    let bridge = Bridge::start(game.desk(), player, profile);
    bridge.player.play(segment);
    let begin_ns = monotonic_ns();
    let reached_s = watch(game, segment, |_| ());
    wait_until(begin_ns + (segment.length_ms() + RELEASED_MS) * MS);
    let Recorded { capture, begun_us } = bridge.end();
    let Heard { mispresses, events } = Heard::of(&capture, segment, begun_us, &profile_of(profile));
    Outcome { reached_s, mispresses, events }
}

/// Looks at the screen until the landmark is reached or cannot be; `step` hears how long it has been.
pub(crate) fn watch(
    game: &mut dyn Game,
    segment: &Segment,
    mut step: impl FnMut(u64),
) -> Result<f64, String> {
    let begin_ns = monotonic_ns();
    let end_ns = begin_ns + (segment.length_ms() + AFTER_MS) * MS;
    let mut look_ns = begin_ns;
    let mut seen = Progress::Going("nothing".into());
    while monotonic_ns() < end_ns {
        step((monotonic_ns() - begin_ns) / 1_000);
        if monotonic_ns() >= look_ns {
            seen = game.progress();
            look_ns = monotonic_ns() + LOOK_MS * MS;
        }
        match seen {
            Progress::Reached => {
                return Ok(1e-9 * (monotonic_ns() - begin_ns) as f64);
            }
            Progress::Lost(why) => return Err(why),
            Progress::Going(_) => wait_until(monotonic_ns() + MS),
        }
    }
    let Progress::Going(place) = seen else { unreachable!("others have returned") };
    Err(place)
}

/// The profile for X11; a shipped name or a file.
pub(crate) fn profile_of(name: &str) -> Profile {
    let shipped = tactpad::pipeline::mapping::read::shipped::text(name).map(str::to_owned);
    let text = shipped.unwrap_or_else(|| fs::read_to_string(name).unwrap());
    read(&text, OutputChoice::Keyboard).0.unwrap()
}

/// The program that plays the pad into the desk, and writes down what it hears.
pub(crate) struct Bridge {
    program: Process,
    /// When it was started.
    started_us: u64,
    pub(crate) player: Player,
    folder: PathBuf,
}

/// What a bridge leaves.
pub(crate) struct Recorded {
    pub(crate) capture: PathBuf,
    /// When the segment began, by the pad's clock.
    pub(crate) begun_us: u64,
}

impl Bridge {
    /// Starts it and waits until it has found the pad's zero.
    pub(crate) fn start(desk: &Desk, player: Player, profile: &str) -> Self {
        Self::start_as(desk, player, profile, &["record", CAPTURE])
    }

    /// The same with another verb than `record`.
    pub(crate) fn start_as(desk: &Desk, player: Player, profile: &str, verb: &[&str]) -> Self {
        let folder = tempfile::tempdir_in(desk.home.path()).unwrap().keep();
        let mut program = tactpad(&folder);
        program.args(verb).args(["--output", "x11", "--profile", profile]);
        program.args(["--pad", &player.address()]).env("DISPLAY", &desk.display);
        let told = File::create(folder.join("told")).unwrap();
        let program = program.stdout(Stdio::null()).stderr(told).spawn().unwrap();
        let started_us = monotonic_ns() / 1_000;
        let bridge = Self { program: Process(program), started_us, player, folder };
        let ready = await_some(10_000, || bridge.hears().then_some(()));
        assert!(ready.is_some(), "{}", fs::read_to_string(bridge.folder.join("told")).unwrap());
        bridge
    }

    /// What `tactpad ctl` prints.
    pub(crate) fn ctl(&self, request: &[&str]) -> String {
        let told = tactpad(&self.folder).arg("ctl").args(request).output().unwrap();
        String::from_utf8(told.stdout).unwrap()
    }

    /// Whether enough of a resting pad has been heard to know its zero.
    fn hears(&self) -> bool {
        let status: serde_json::Value =
            serde_json::from_str(&self.ctl(&["status", "--json"])).unwrap_or_default();
        status["state"] == "playing"
            && status["health"]["samples"].as_u64() > Some(self.player.resting_samples())
    }

    /// Ends it.
    pub(crate) fn end(mut self) -> Recorded {
        assert!(tactpad(&self.folder).args(["ctl", "quit"]).output().unwrap().status.success());
        assert!(self.program.0.wait().unwrap().success());
        let origin_us = if self.player.has_clock() { 0 } else { self.started_us };
        let begun_us = self.player.begun().expect("the player has begun").pad_us - origin_us;
        Recorded { capture: self.folder.join(CAPTURE), begun_us }
    }
}

const CAPTURE: &str = "play.cap";

/// The program under test, with its files in `folder`.
pub(crate) fn tactpad(folder: &Path) -> Command {
    let mut program = Command::new(env!("CARGO_BIN_EXE_tactpad"));
    for variable in ["XDG_RUNTIME_DIR", "XDG_CONFIG_HOME", "XDG_STATE_HOME"] {
        program.env(variable, folder);
    }
    program.current_dir(folder).stdin(Stdio::null());
    program
}
