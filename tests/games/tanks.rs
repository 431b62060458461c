//! Battle Tanks, seen from above: a ride on its map "wastes", on which nothing else moves at the begin.
//!
//! What is judged is the window's way over the ground, which follows the tank, and the two numbers at the window's upper edge: the
//! score, which a destroyed target raises, and the missiles that are left.

use std::fs;
use std::path::Path;

use crate::clock::{MS, monotonic_ns};
use crate::desk::{Desk, Process, await_some, pause_ms};
use crate::framebuffer::{Area, Picture};
use crate::scroll::Scroll;
use crate::segment::Segment;
use crate::support::leave_out;
use crate::trial::{Game, Progress};

/// The shipped profile for it.
pub(crate) const PROFILE: &str = "btanks";
/// Its window's class.
const CLASS: &str = "btanks";

pub(crate) const WIDTH_PX: u32 = 800;
pub(crate) const HEIGHT_PX: u32 = 600;
/// Where the window shows ground alone: below its upper edge, left of the radar, above the clock.
const GROUND: [[usize; 2]; 2] = [[10, 40], [690, 540]];
/// The score at the begin, with the sign before it, which goes to the left when the score gets longer; and the number of missiles.
const SCORE: Area = Area { left_px: 766, top_px: 4, width_px: 34, height_px: 24 };
const MISSILES: Area = Area { left_px: 84, top_px: 4, width_px: 28, height_px: 24 };
/// Menus: what to do, and which map.
const MENU: Area = Area { left_px: 270, top_px: 200, width_px: 260, height_px: 210 };
const MAPS: Area = Area { left_px: 10, top_px: 10, width_px: 240, height_px: 60 };
/// Letters of menus are orange, so many pixels of them.
const LETTERS: usize = 1_000;
/// A pixel of a digit is at least so bright; so many of them make a number.
const BRIGHT: u8 = 150;
const DIGIT: usize = 40;
/// A number is another one when less of its pixels than this share are the same.
const SAME_SHARE: f64 = 0.9;
const RETURN: u16 = 28;
/// The window is looked at so often. It is large, and the game needs the time, too.
const LOOK_MS: u64 = 50;

/// The game's settings: who plays, on which map, and in a tank.
const SETTINGS: &str = r#"<config>
<value name="engine.profile" type="string">0</value>
<value name="profile.0.name" type="string">player</value>
<value name="menu.mode-0.default-mp-map" type="string">wastes</value>
<value name="multiplayer.restrict-start-vehicle" type="string">tank</value>
<value name="multiplayer.restrict-start-animation" type="string">green-tank</value>
</config>
"#;

/// What the screen must show, one after the other; places of the window in pixels from where it was at the begin.
#[derive(Clone, Copy, Debug)]
enum Leg {
    /// A target is destroyed.
    Struck,
    Below(i64),
    Above(i64),
    RightOf(i64),
    /// A missile is gone.
    Launched,
    LeftOf(i64),
}

const LEGS: [Leg; 6] =
    [Leg::Struck, Leg::Below(80), Leg::Above(40), Leg::Launched, Leg::RightOf(250), Leg::LeftOf(200)];

/// What the player does: turns to a target and fires at it, crosses the road and comes back, launches missiles while driving along
/// the road, and turns back.
pub(crate) fn segment() -> Segment {
    let (fire, launch) = ("button 1 tap", "button 1 hold");
    Segment::default()
        .steer("left", 0, 170)
        .tap(fire, 450, 650)
        .tap(fire, 850, 1_050)
        .tap(fire, 1_250, 1_450)
        .steer("down", 1_700, 3_000)
        .steer("up", 3_200, 5_000)
        .steer("down", 5_300, 5_500)
        .steer("right", 5_800, 7_200)
        .press(launch, 6_100, 6_800)
        .steer("left", 7_500, 8_800)
}

/// Whether this machine has the game.
pub(crate) fn is_there() -> bool {
    let is_there = Path::new("/usr/games/btanks").is_file();
    if !is_there {
        leave_out("btanks", "apt-get install btanks");
    }
    is_there
}

/// The game, on its map.
pub(crate) struct Tanks {
    _program: Process,
    desk: Desk,
    scroll: Scroll,
    score: Number,
    missiles: Number,
    /// How many legs are done.
    done: usize,
    /// When to look again.
    look_ns: u64,
}

impl Tanks {
    /// Starts the game and goes through its menus.
    pub(crate) fn start() -> Self {
        Self::start_on(Desk::new(WIDTH_PX, HEIGHT_PX))
    }

    /// The same in the upper left corner of a larger desk.
    pub(crate) fn start_on(desk: Desk) -> Self {
        let folder = desk.home.path().join(".btanks");
        fs::create_dir(&folder).unwrap();
        fs::write(folder.join("bt.xml"), SETTINGS).unwrap();
        let program = Process(desk.command("btanks").args(["--no-gl", "--no-sound"]).spawn().unwrap());
        desk.focus(CLASS);
        for menu in [MENU, MAPS] {
            let shown = await_some(20_000, || (letters(&desk, &menu) >= LETTERS).then_some(()));
            assert!(shown.is_some(), "the menu at {menu:?}");
            desk.press(RETURN);
        }
        let begun = await_some(20_000, || {
            let numbers = [SCORE, MISSILES].map(|area| Number::of(&desk.screen.picture(), &area));
            let covered = letters(&desk, &MENU) + letters(&desk, &MAPS) >= LETTERS;
            (!covered && numbers.iter().all(|number| number.0.len() >= DIGIT)).then_some(())
        });
        assert!(begun.is_some(), "the map");
        pause_ms(500);
        let picture = desk.screen.picture();
        let [score, missiles] = [SCORE, MISSILES].map(|area| Number::of(&picture, &area));
        let scroll = Scroll::new(picture, GROUND[0], GROUND[1]);
        Self { _program: program, desk, scroll, score, missiles, done: 0, look_ns: 0 }
    }

    fn is_done(&self, leg: Leg) -> bool {
        let Scroll { picture, at_px: [right_px, down_px], .. } = &self.scroll;
        match leg {
            Leg::Struck => self.score.is_another(picture),
            Leg::Launched => self.missiles.is_another(picture),
            Leg::Below(px) => *down_px >= px,
            Leg::Above(px) => *down_px <= px,
            Leg::RightOf(px) => *right_px >= px,
            Leg::LeftOf(px) => *right_px <= px,
        }
    }
}

/// Pixels of a menu's letters in a part of the screen.
fn letters(desk: &Desk, area: &Area) -> usize {
    let is_letter = |[red, green, blue]: &[u8; 3]| *red > 200 && (100..190).contains(green) && *blue < 60;
    desk.screen.picture_of(area).iter().filter(|pixel| is_letter(pixel)).count()
}

/// The pixels of a number that is written over the ground: they stay while the ground below them moves.
struct Number(Vec<([usize; 2], [u8; 3])>);

impl Number {
    fn of(picture: &Picture, area: &Area) -> Self {
        let lines = area.top_px..area.top_px + area.height_px;
        let columns = || area.left_px..area.left_px + area.width_px;
        let all = lines.flat_map(|y| columns().map(move |x| [x, y]));
        let pixels = all.map(|[x, y]| ([x, y], picture.at(x, y)));
        Self(pixels.filter(|(_, rgb)| rgb.iter().all(|level| *level >= BRIGHT)).collect())
    }

    /// Whether something else stands there now.
    fn is_another(&self, picture: &Picture) -> bool {
        let same = self.0.iter().filter(|([x, y], rgb)| picture.at(*x, *y) == *rgb).count();
        (same as f64) < SAME_SHARE * self.0.len() as f64
    }
}

impl Game for Tanks {
    fn desk(&self) -> &Desk {
        &self.desk
    }

    fn progress(&mut self) -> Progress {
        if monotonic_ns() >= self.look_ns && self.scroll.follow(self.desk.screen.picture()) {
            self.look_ns = monotonic_ns() + LOOK_MS * MS;
            while LEGS.get(self.done).is_some_and(|leg| self.is_done(*leg)) {
                self.done += 1;
            }
        }
        match LEGS.get(self.done) {
            None => Progress::Reached,
            Some(leg) => Progress::Going(format!("before {leg:?}, the window at {:?} px", self.scroll.at_px)),
        }
    }
}
