//! SuperTux, a jump-and-run: the first part of its second level, as the game ships it.
//!
//! The game is asked to write Tux's place over its picture (`--show-pos`); the landmark is read there.

use std::path::Path;
use std::process::Stdio;
use std::sync::OnceLock;

use crate::desk::{Desk, Process, await_some, pause_ms};
use crate::digits::Font;
use crate::framebuffer::Area;
use crate::reaction::{Jump, Jumper};
use crate::segment::Segment;
use crate::support::leave_out;
use crate::trial::{Game, Progress};

const LEVEL: &str = "/usr/share/games/supertux2/levels/world1/welcome_antarctica.stl";
pub(crate) const WIDTH_PX: u32 = 640;
pub(crate) const HEIGHT_PX: u32 = 480;
/// Where the game writes Tux's place.
const PLACE: Area = Area { left_px: 552, top_px: 67, width_px: 88, height_px: 17 };
/// Two places by which the game shows all of its digits.
const DIGITS: [&str; 2] = ["12345,6789", "10,10"];
/// Of its window.
const CLASS: &str = "supertux2";
/// The key that jumps, and its word in the profile.
const SPACE: u16 = 57;
const JUMP: &str = "button 1";
/// Where Tux stands at the begin, and above that as far as he jumps: who is out of sight does not rest.
const TUX: Area = Area { left_px: 90, top_px: 40, width_px: 50, height_px: 235 };

/// Tux has come so far when the segment is done, in the level's own unit, of which a block has 32.
const LANDMARK_X: i32 = 1_600;
/// Nobody comes farther from one look to the next.
const STEP_MAX: i32 = 100;
/// Below the ice.
const LOST_Y: i32 = 700;

/// The shipped profile for it.
pub(crate) const PROFILE: &str = "supertux";

/// Whether this machine has the game.
pub(crate) fn is_there() -> bool {
    if Path::new("/usr/games/supertux2").is_file() {
        return true;
    }
    leave_out("supertux2", "apt-get install --no-install-recommends supertux");
    false
}

/// What the player does: walks, turns back and on, hops, jumps.
pub(crate) fn segment() -> Segment {
    Segment::default()
        .steer("right", 0, 900)
        .steer("left", 1_050, 1_400)
        .steer("right", 1_550, 8_000)
        .press(JUMP, 1_900, 2_020)
        .press(JUMP, 2_430, 2_930)
        .press(JUMP, 4_300, 4_800)
}

/// The game, at the begin of its level.
pub(crate) struct SuperTux {
    _program: Process,
    desk: Desk,
    font: Font,
    /// Tux's place when it was last read, and before that.
    places: [Option<[i32; 2]>; 2],
}

impl SuperTux {
    /// Starts the level and waits until Tux stands in it.
    pub(crate) fn start() -> Self {
        Self::start_on(Desk::new(WIDTH_PX, HEIGHT_PX))
    }

    /// The same in the upper left corner of a larger desk.
    pub(crate) fn start_on(desk: Desk) -> Self {
        let font = font();
        let program = started(&desk, &[]);
        let game = Self { _program: program, desk, font, places: [None; 2] };
        let placed = await_some(20_000, || {
            // The game puts its window into the middle once more when it has read its files.
            game.desk.focus(CLASS);
            game.read()
        });
        assert!(placed.is_some(), "the level's title");
        game.desk.press(SPACE);
        let begun = await_some(10_000, || game.is_bright().then_some(()));
        assert!(begun.is_some(), "the level");
        game
    }

    /// Tux's place, as the game writes it.
    fn read(&self) -> Option<[i32; 2]> {
        let text = self.font.read(&self.desk.screen.picture(), &PLACE);
        let (x, y) = text.strip_prefix("X:")?.split_once(" Y:")?;
        Some([x.parse().ok()?, y.parse().ok()?])
    }

    /// Whether the level has come out of the dark: the sky is as bright as it gets.
    fn is_bright(&self) -> bool {
        let sky = self.desk.screen.picture().at(300, 8);
        sky[2] > 245
    }
}

impl Jumper for SuperTux {
    fn jump(&self) -> Jump {
        Jump { key: SPACE, around: TUX, meant: JUMP }
    }
}

impl Game for SuperTux {
    fn desk(&self) -> &Desk {
        &self.desk
    }

    fn progress(&mut self) -> Progress {
        // A picture that is half drawn cannot be read.
        if let Some(place) = self.read() {
            self.places = [Some(place), self.places[0]];
        }
        let [Some([x, y]), Some([x_before, _])] = self.places else {
            return Progress::Going("nowhere".into());
        };
        if y > LOST_Y {
            return Progress::Lost(format!("Tux fell at {x}"));
        }
        // What was read wrong stands alone.
        if x >= LANDMARK_X && (x - x_before).abs() < STEP_MAX {
            return Progress::Reached;
        }
        Progress::Going(format!("Tux is at {x}"))
    }
}

/// The game's process with a level, on a desk.
fn started(desk: &Desk, arguments: &[&str]) -> Process {
    let mut command = desk.command("supertux2");
    command.arg("--userdir").arg(desk.home.path());
    command.args([
        "-g",
        &format!("{WIDTH_PX}x{HEIGHT_PX}"),
        "-w",
        "--renderer",
        "sdl",
        "--disable-sound",
        "--disable-music",
    ]);
    command.arg("--show-pos").args(arguments).arg(LEVEL);
    let program = Process(command.stdout(Stdio::null()).spawn().unwrap());
    desk.focus(CLASS);
    program
}

/// The font in which the game writes places, learned from two of them.
fn font() -> Font {
    static FONT: OnceLock<Font> = OnceLock::new();
    let learn = || {
        let mut font = Font::default();
        for place in DIGITS {
            let desk = Desk::new(WIDTH_PX, HEIGHT_PX);
            let _program = started(&desk, &["--spawn-pos", place]);
            let text = format!("X:{}", place.replace(',', " Y:"));
            // The title comes out of the dark.
            let learned = await_some(20_000, || {
                let seen = desk.screen.picture().part(&PLACE);
                pause_ms(200);
                let picture = desk.screen.picture();
                (picture.part(&PLACE) == seen && font.learn(&picture, &PLACE, &text)).then_some(())
            });
            assert!(learned.is_some(), "{text} on the level's title");
        }
        font
    };
    FONT.get_or_init(learn).clone()
}
