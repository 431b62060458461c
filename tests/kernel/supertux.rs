//! A game of Debian's, as it is installed, played from the pad through the virtual gamepad.
//!
//! The game, its first level and SDL's mapping of the gamepad are what everyone has; nothing names the pad to them. What
//! comes of a touch is read from the game's screen.

use std::path::Path;
use std::process::Command;

use evdev::KeyCode;
use rustix::process::Signal;

use crate::bridge::{Bridge, TACTPAD};
use crate::clock::{MS, monotonic_ns, wait_until};
use crate::hand::Hand;
use crate::pad::{LEFT, NONE, PRESS, PRESS_RIGHT, RIGHT, Touch};
use crate::program::Running;
use crate::scene::Scene;
use crate::screen::Screen;
use crate::sdl;
use crate::support::{leave_out, require};

/// Debian keeps games out of the search path of root.
const GAME: &str = "/usr/games/supertux2";
const LEVEL: &str = "/usr/share/games/supertux2/levels/world1/welcome_antarctica.stl";

/// The button lasts as long as the press: a game that looks once per frame cannot miss it, however slow the machine.
const PROFILE: &str = "supertux";

/// How often the screen is looked at; more often would leave the game too little time.
const LOOK_EVERY_MS: u64 = 50;

/// Reading its files takes the game some seconds here.
const LOADING_LIMIT_MS: u64 = 60_000;

/// How long the game may take for a page, or to end.
const PAGE_LIMIT_MS: u64 = 10_000;

/// How long it may take until a touch has done what it should. The level's first enemy comes later: he, too, makes Tux
/// move.
const TOUCH_LIMIT_MS: u64 = 4_000;

/// For so long nothing may happen where nothing should.
const STILL_MS: u64 = 500;

/// What Tux moves while he breathes, blinks or walks on the spot.
const STILL_PX: i32 = 4;

/// A jump is at least so high, a scroll so long: two of the level's tiles.
const FAR_PX: i32 = 64;

/// Whether the game and all it needs are there to run.
pub(crate) fn is_there() -> bool {
    if !Path::new(GAME).is_file() {
        leave_out(GAME, "apt-get install supertux");
        return false;
    }
    require("Xvfb", "apt-get install xvfb") && sdl::probe_is_there()
}

/// SDL knows the gamepad, and Tux stands, jumps and runs as the finger says.
pub(crate) fn played() {
    let screen = Screen::start();
    // SDL finds what is there when the game starts; later ones are for udev to tell, which the guest has not.
    let mut bridge = Bridge::start(PROFILE, KeyCode::BTN_SOUTH);
    sdl::check(|touch, for_ms| bridge.pad.hold(touch, for_ms));
    let Bridge { pad, program: _running, .. } = bridge;
    let folder = std::env::temp_dir().join("supertux");
    let mut game = start_game(&screen, &folder);
    let player = Player { screen, hand: Hand::on(pad) };
    let start = player.begin();
    player.leave_alone(&start);
    player.press_muted(&start);
    player.jump(&start);
    player.run_right(&start);
    player.run_left(&start);
    game.signal(Signal::TERM);
    assert!(game.wait(PAGE_LIMIT_MS).success());
    // By its own account it takes pads as SDL maps them, and for others, of which it knows no names, it has no D-pad.
    let settings = std::fs::read_to_string(folder.join("config")).expect("the game's settings");
    assert!(settings.contains("(use-game-controller #t)") && !settings.contains("(hat "), "{settings}");
}

/// Starts the game as a new player has it: without settings of its own and without any of the tester's.
fn start_game(screen: &Screen, folder: &Path) -> Running {
    std::fs::create_dir(folder).expect("a new folder");
    let mut command = Command::new(GAME);
    command
        .args([
            "--window",
            "--geometry",
            "640x480",
            "--renderer",
            "sdl",
            "--disable-sound",
            "--disable-music",
        ])
        .arg("--userdir")
        .arg(folder)
        .arg(LEVEL)
        .env_clear()
        .env("HOME", folder)
        .env("DISPLAY", screen.display())
        // Drawn without OpenGL, which would be emulated.
        .envs([("SDL_RENDER_DRIVER", "software"), ("SDL_FRAMEBUFFER_ACCELERATION", "0")])
        .envs([("SDL_AUDIODRIVER", "dummy"), ("ALSOFT_DRIVERS", "null")]);
    Running::start_command(&mut command)
}

/// Somebody with a finger on the pad who looks at the screen.
struct Player {
    screen: Screen,
    hand: Hand,
}

impl Player {
    /// Waits for the page before the level, which stays until a button is pressed; then for the level.
    fn begin(&self) -> Scene {
        let black = || self.screen.look().rgb.iter().all(|colour| *colour == [0, 0, 0]);
        self.wait("the game's first page", LOADING_LIMIT_MS, || (!black()).then_some(()));
        self.wait_still();
        assert_eq!(self.scene(), None, "the level begins by itself");
        self.hold_until("the level", PRESS, |_| true);
        self.hand.put(NONE);
        let mut before = None;
        self.wait("a picture that stays", PAGE_LIMIT_MS, || {
            self.wait_still();
            let after = self.scene();
            let stays = after.is_some() && after == before;
            before = after;
            after.filter(|_| stays)
        })
    }

    fn leave_alone(&self, start: &Scene) {
        self.nothing_happens("left alone", NONE, start);
    }

    /// A bridge that pauses: what the finger does now must not arrive.
    fn press_muted(&self, start: &Scene) {
        ask_bridge("pause");
        self.nothing_happens("muted", PRESS_RIGHT, start);
        self.nothing_happens("muted and lifted", NONE, start);
        ask_bridge("resume");
    }

    fn jump(&self, start: &Scene) {
        let height_px = |scene: &Scene| start.tux_in_world()[1] - scene.tux_in_world()[1];
        let above = self.hold_until("Tux in the air", PRESS, |scene| height_px(scene) >= FAR_PX);
        assert!(
            (above.tux_in_world()[0] - start.tux_in_world()[0]).abs() <= STILL_PX,
            "straight up: {above:?}"
        );
        self.hold_until("Tux on the ground", NONE, |scene| height_px(scene).abs() <= STILL_PX);
    }

    fn run_right(&self, start: &Scene) {
        let scrolled = |scene: &Scene| start.crates[0] - scene.crates[0] >= FAR_PX;
        let far = self.hold_until("the world scrolls", RIGHT, scrolled);
        assert!(far.tux_in_world()[0] >= start.tux_in_world()[0] + FAR_PX, "Tux ran there: {far:?}");
    }

    /// Back to the level's left edge, beyond which nothing scrolls.
    fn run_left(&self, start: &Scene) {
        let at_edge = |scene: &Scene| scene.tux[0] <= STILL_PX && scene.crates[0] == start.crates[0];
        let edge = self.hold_until("Tux at the left edge", LEFT, at_edge);
        assert!(edge.tux_in_world()[0] <= start.tux_in_world()[0] - FAR_PX, "Tux ran there: {edge:?}");
        self.nothing_happens("at the edge", LEFT, &edge);
    }

    /// Holds `touch`, and sees Tux and the world where they were.
    fn nothing_happens(&self, what: &str, touch: Touch, before: &Scene) {
        self.hand.put(touch);
        for _ in 0..STILL_MS / LOOK_EVERY_MS {
            wait_until(monotonic_ns() + LOOK_EVERY_MS * MS);
            let scene = self.scene().expect("still in the level");
            assert_eq!(scene.crates, before.crates, "{what}, the world stays");
            let moved = [0, 1].map(|way| scene.tux[way] - before.tux[way]);
            assert!(moved.iter().all(|px| px.abs() <= STILL_PX), "{what}, Tux moved by {moved:?}");
        }
        println!("{what}: {before:?}");
    }

    /// Holds `touch` until a scene is such as it should become.
    fn hold_until(&self, what: &str, touch: Touch, done: impl Fn(&Scene) -> bool) -> Scene {
        self.hand.put(touch);
        let scene = self.wait(what, TOUCH_LIMIT_MS, || self.scene().filter(&done));
        println!("{what}: {scene:?}");
        scene
    }

    /// Looks until there is something to see.
    fn wait<T>(&self, what: &str, limit_ms: u64, mut look: impl FnMut() -> Option<T>) -> T {
        let limit_ns = monotonic_ns() + limit_ms * MS;
        loop {
            wait_until(monotonic_ns() + LOOK_EVERY_MS * MS);
            if let Some(seen) = look() {
                return seen;
            }
            assert!(monotonic_ns() < limit_ns, "{what}: not within {limit_ms} ms, but {:?}", self.scene());
        }
    }

    fn wait_still(&self) {
        wait_until(monotonic_ns() + STILL_MS * MS);
    }

    fn scene(&self) -> Option<Scene> {
        Scene::seen(&self.screen.look())
    }
}

fn ask_bridge(request: &str) {
    let answer = Command::new(TACTPAD).args(["ctl", request]).output().expect("the program");
    assert!(answer.status.success(), "{request}: {}", String::from_utf8_lossy(&answer.stderr));
}
