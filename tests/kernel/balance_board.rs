//! A Wii Balance Board by the kernel's real driver: a board of software below it, the bridge above it, and what a game sees.

use std::fs::{self, Permissions};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::Command;

use evdev::KeyCode;
use rustix::process::Signal;
use tactpad::numeric::random::SplitMix64;

use crate::bridge::TACTPAD;
use crate::clock::MS;
use crate::owned_pads::{comes_true, devices, pause};
use crate::program::Running;
use crate::reader::{Reader, find};
use crate::wiimote::{Board, Load, Make, NOTHING};

/// How long a board that is connected may take to be known by the system and measured by the bridge: it is asked a dozen questions,
/// looked for four times a second, and its zero takes 0.4 s.
const READY_MS: u64 = 1_500;

/// Who stands still so long is weighed.
const WEIGHED_MS: u64 = 1_400;

/// Everything is let go so long after a board's connection ended.
const LET_GO_MS: u64 = 200;

/// What is done with a board in a session.
const DEEDS: usize = 40;

/// An axis or button, and its value.
type Edge = (&'static str, i32);

/// The directions, anticlockwise from the right.
const DIRECTIONS: [&[Edge]; 8] = [
    &[("ABS_HAT0X", 1)],
    &[("ABS_HAT0X", 1), ("ABS_HAT0Y", -1)],
    &[("ABS_HAT0Y", -1)],
    &[("ABS_HAT0X", -1), ("ABS_HAT0Y", -1)],
    &[("ABS_HAT0X", -1)],
    &[("ABS_HAT0X", -1), ("ABS_HAT0Y", 1)],
    &[("ABS_HAT0Y", 1)],
    &[("ABS_HAT0X", 1), ("ABS_HAT0Y", 1)],
];

/// How somebody plays on a board.
struct Player {
    source: &'static str,
    /// Whether the board's own reports are taken; else the driver's axes alone.
    takes_reports: bool,
    /// A shipped profile, which plays in eight directions here.
    profile: &'static str,
    /// What lies on the board between two deeds.
    rest: Load,
    /// Forces of a lean, N.
    lean_n: [f64; 2],
    /// Forces of a press for the button, and of one for the other button, N.
    press_n: [f64; 2],
    press: Edge,
    stamp_n: [f64; 2],
    stamp: Edge,
    /// How long these press, ms.
    press_ms: [f64; 2],
    stamp_ms: [f64; 2],
}

impl Player {
    /// Hands, or the feet of who sits. A lean is as light as 3 kg on all four cells.
    fn seated() -> Self {
        Self {
            source: "balance-board",
            takes_reports: true,
            profile: "super-mario",
            rest: NOTHING,
            lean_n: [30.0, 85.0],
            press_n: [130.0, 220.0],
            press: ("BTN_SOUTH", 1),
            stamp_n: [130.0, 220.0],
            stamp: ("BTN_EAST", 1),
            press_ms: [80.0, 250.0],
            stamp_ms: [600.0, 900.0],
        }
    }

    /// Somebody who stands on it, somewhere.
    fn standing(random: &mut SplitMix64) -> Self {
        let weight_n = between(random, [300.0, 1_100.0]);
        let [x, y] = [0, 1].map(|_| between(random, [-0.1, 0.1]));
        Self {
            source: "balance-board-standing",
            takes_reports: true,
            profile: "board-standing",
            rest: Load { fz_n: weight_n, x, y },
            lean_n: [0.97 * weight_n, 1.03 * weight_n],
            press_n: [1.4 * weight_n, 1.9 * weight_n],
            press: ("BTN_SOUTH", 1),
            stamp_n: [2.3 * weight_n, 2.7 * weight_n],
            stamp: ("BTN_EAST", 1),
            press_ms: [200.0, 350.0],
            stamp_ms: [120.0, 250.0],
        }
    }
}

fn between(random: &mut SplitMix64, [low, high]: [f64; 2]) -> f64 {
    low + (high - low) * f64::from(random.fraction())
}

fn whole_between(random: &mut SplitMix64, low: u64, high: u64) -> u64 {
    between(random, [low as f64, high as f64]) as u64
}

/// A game that is played on a board.
struct Session {
    random: SplitMix64,
    player: Player,
    make: Make,
    board: Option<Board>,
    program: Running,
    reader: Reader,
    /// Leans of which the driver's axes say nothing.
    unsaid: usize,
}

impl Session {
    /// Connects a board, and starts the bridge on it.
    fn start(mut random: SplitMix64, player: Player) -> Self {
        let mut make = Make::drawn(&mut random);
        if !player.takes_reports {
            // The driver tells what lies on a cell beyond its zero.
            make.rest_kg = [0.5; 4];
        }
        let board = Board::connect(&make);
        let folder = tempfile::tempdir().expect("a folder").keep();
        let shipped = |folder: &str, name: &str| {
            fs::read_to_string(Path::new(folder).join(name).with_extension("toml")).expect("a shipped file")
        };
        let profile = shipped("mappings", player.profile).replace("\"4way\"", "\"8way\"");
        fs::write(folder.join("profile.toml"), profile).expect("a profile");
        let mut source = shipped("models/sources", player.source);
        if !player.takes_reports {
            source = source.replace("reports = ", "# reports = ");
        }
        fs::write(folder.join("source.toml"), source).expect("a description");
        let mut command = Command::new(TACTPAD);
        command.args(["run", "--pad", player.source, "--source", "./source.toml"]);
        command.args(["--profile", "./profile.toml", "--output", "uinput", "--wait"]);
        let mut program = Running::start_command(command.current_dir(&folder));
        // The driver's own device has the button that games call south.
        comes_true("the bridge's gamepad", || {
            assert!(!program.has_ended(), "the bridge ended: {}", program.complaints());
            find(KeyCode::BTN_EAST).is_some()
        });
        let reader = Reader::open(&find(KeyCode::BTN_EAST).expect("it was there a moment ago"));
        let mut session = Self { random, player, make, board: Some(board), program, reader, unsaid: 0 };
        session.get_ready();
        session
    }

    fn board(&self) -> &Board {
        self.board.as_ref().expect("it is connected")
    }

    /// Leaves the board alone until its zero is measured; then whoever stands on it steps on.
    fn get_ready(&mut self) {
        pause(READY_MS);
        self.board().bear(self.player.rest);
        pause(WEIGHED_MS);
        self.expect("a board that gets ready", &[]);
    }

    /// A lean in a direction, and what it means.
    fn lean(&mut self) -> (Load, &'static [Edge]) {
        let random = &mut self.random;
        let k = random.next_bits() as usize % DIRECTIONS.len();
        let angle = (k as f64 * 45.0 + between(random, [-8.0, 8.0])).to_radians();
        let (radius, fz_n) = (between(random, [0.45, 0.6]), between(random, self.player.lean_n));
        let Load { x, y, .. } = self.player.rest;
        let load = Load { fz_n, x: x + radius * angle.cos(), y: y + radius * angle.sin() };
        (load, DIRECTIONS[k])
    }

    /// Force in place, for the one button or the other; how long it presses, and what it means.
    fn press(&mut self) -> (Load, u64, Edge) {
        let random = &mut self.random;
        let Player { press_n, press_ms, press, stamp_n, stamp_ms, stamp, rest, .. } = self.player;
        let is_stamp = random.fraction() < 0.5;
        let (n, ms, edge) = if is_stamp { (stamp_n, stamp_ms, stamp) } else { (press_n, press_ms, press) };
        let load = Load { fz_n: between(random, n), ..rest };
        (load, between(random, ms) as u64, edge)
    }

    /// Checks that exactly this was seen since the last time, in whatever order what is simultaneous came; returns the last stamp.
    fn expect(&mut self, what: &str, steps: &[&[Edge]]) -> u64 {
        self.reader.read_available();
        let (mut seen, mut wanted) = (self.reader.edges(), steps.concat());
        let mut from = 0;
        for step in steps {
            let to = from + step.len();
            wanted[from..to].sort_unstable();
            if let Some(seen) = seen.get_mut(from..to) {
                seen.sort_unstable();
            }
            from = to;
        }
        assert_eq!(seen, wanted, "{what}: {}\n{:?}", self.program.complaints(), self.make);
        let last_ns = self.reader.seen.iter().map(|change| change.at_ns).max().unwrap_or_default();
        self.reader.seen.clear();
        last_ns
    }

    /// Bears a load for a while, then what is borne between deeds.
    fn play(&mut self, what: &str, load: Load, for_ms: u64, meant: &[Edge]) {
        self.board().bear(load);
        pause(for_ms);
        self.board().bear(self.player.rest);
        pause(300);
        self.expect(what, &[meant, &released(meant)]);
    }

    fn lean_and_back(&mut self) {
        let (load, meant) = self.lean();
        let for_ms = whole_between(&mut self.random, 150, 700);
        self.unsaid += usize::from(self.make.is_unsaid(load));
        self.play(&format!("{load:?} for {for_ms} ms"), load, for_ms, meant);
    }

    fn press_and_back(&mut self) {
        let (load, for_ms, meant) = self.press();
        self.play(&format!("{load:?} for {for_ms} ms"), load, for_ms, &[meant]);
    }

    /// Its radio is out of reach for so long that the direction that was held must not be.
    fn stall(&mut self) {
        let (load, meant) = self.lean();
        self.board().bear(load);
        pause(300);
        self.board().fall_silent(true);
        pause(2_000);
        self.expect("a board out of reach", &[meant, &released(meant)]);
        self.board().bear(self.player.rest);
        self.board().fall_silent(false);
        // Who has been away for a second is weighed again.
        pause(WEIGHED_MS);
        self.expect("a board within reach again", &[]);
    }

    /// The bridge is stopped while the lean ends, shortly or for longer than the kernel keeps what is reported.
    fn stop(&mut self) {
        let (load, meant) = self.lean();
        self.board().bear(load);
        pause(300);
        self.program.signal(Signal::STOP);
        pause(20);
        self.board().bear(self.player.rest);
        pause(whole_between(&mut self.random, 50, 1_500));
        self.program.signal(Signal::CONT);
        pause(LET_GO_MS);
        self.expect("a bridge that was stopped", &[meant, &released(meant)]);
        pause(WEIGHED_MS);
        self.expect("a bridge that goes on", &[]);
    }

    /// Somebody looks at the battery in the middle of a lean, and the desktop asks the driver for it: that holds up nothing.
    fn look_at_battery(&mut self) {
        let (load, meant) = self.lean();
        self.board().bear(load);
        pause(300);
        let listed = devices();
        assert!(listed.contains("\"battery\":{"), "{listed}");
        pause(whole_between(&mut self.random, 0, 20));
        let battery = fs::read_dir("/sys/class/power_supply").expect("sysfs").flatten().next();
        let charge = battery.and_then(|battery| fs::read_to_string(battery.path().join("capacity")).ok());
        assert_eq!(charge.as_deref(), Some("94\n"));
        pause(300);
        self.board().bear(self.player.rest);
        pause(300);
        self.expect("a look at the battery", &[meant, &released(meant)]);
    }

    /// Leans so hard that a direction and a button are held.
    fn hold_both(&mut self) -> (Load, Vec<Edge>) {
        let (load, meant) = self.lean();
        let fz_n = between(&mut self.random, self.player.stamp_n);
        (Load { fz_n, ..load }, [meant, &[self.player.stamp]].concat())
    }

    /// Its connection ends while it is leaned on; some tries to connect it again are cut short.
    fn drop_and_come_back(&mut self) {
        let (load, meant) = if self.random.fraction() < 0.5 {
            self.hold_both()
        } else {
            let (load, meant) = self.lean();
            (load, meant.to_vec())
        };
        self.board().bear(load);
        pause(whole_between(&mut self.random, 600, 900));
        self.expect("before the connection ends", &[&meant]);
        let dropped_ns = self.board.take().expect("it was connected").drop_connection();
        pause(LET_GO_MS);
        let released_ns = self.expect("after the connection ended", &[&released(&meant)]);
        assert!(released_ns <= dropped_ns + LET_GO_MS * MS, "let go too late");
        while self.random.fraction() < 0.4 {
            let board = Board::connect(&self.make);
            pause(whole_between(&mut self.random, 1, 200));
            drop(board);
        }
        pause(whole_between(&mut self.random, 0, 1_000));
        self.board = Some(Board::connect(&self.make));
        assert!(!self.program.has_ended(), "the bridge ended");
        self.get_ready();
    }
}

fn released(pressed: &[Edge]) -> Vec<Edge> {
    pressed.iter().map(|(name, _)| (*name, 0)).collect()
}

/// Seeds of sessions: the first ones, or as many as `TACTPAD_BOARD_SEEDS` says.
fn seeds() -> std::ops::Range<u64> {
    0..std::env::var("TACTPAD_BOARD_SEEDS").ok().and_then(|text| text.parse().ok()).unwrap_or(3)
}

/// Plays a session: each lean and press gives the events that it means, and nothing else does, whatever comes between.
fn plays_through(seed: u64, player: impl Fn(&mut SplitMix64) -> Player) {
    let mut random = SplitMix64::named(seed, "board");
    let player = player(&mut random);
    let (source, needs_reports) = (player.source, player.takes_reports && player.rest == NOTHING);
    let mut session = Session::start(random, player);
    let mut drops = 0;
    for _ in 0..DEEDS {
        match session.random.next_bits() % 12 {
            0..=4 => session.lean_and_back(),
            5..=7 => session.press_and_back(),
            8 => session.stall(),
            9 => session.stop(),
            10 => session.look_at_battery(),
            _ => {
                session.drop_and_come_back();
                drops += 1;
            }
        }
    }
    println!(
        "{source}, seed {seed}: {DEEDS} deeds, {drops} drops, {} leans that the driver does not tell",
        session.unsaid
    );
    assert!(!needs_reports || session.unsaid > 0, "no lean was light enough to need the board's own reports");
    drop(session);
    comes_true("the gamepad goes", || find(KeyCode::BTN_EAST).is_none());
}

/// Hands or feet on boards whose corners read less than their own zero.
pub(crate) fn seated() {
    seeds().for_each(|seed| plays_through(seed, |_| Player::seated()));
}

/// People of 31 to 112 kg on such boards.
pub(crate) fn standing() {
    seeds().for_each(|seed| plays_through(seed, Player::standing));
}

/// The same by the driver's axes alone, on boards whose cells read their own zero.
pub(crate) fn by_the_driver_alone() {
    let player = || Player { takes_reports: false, ..Player::seated() };
    seeds().for_each(|seed| plays_through(seed, |_| player()));
}

/// A user of the guest who is not root.
const SOMEBODY: u32 = 1_000;

/// The program, as somebody who is not root runs it.
fn as_somebody(arguments: &[&str]) -> Command {
    let mut command = Command::new(TACTPAD);
    command.args(arguments).uid(SOMEBODY).gid(SOMEBODY);
    command
}

fn told(command: &mut Command) -> String {
    String::from_utf8(command.output().expect("the program runs").stdout).expect("text")
}

/// Lets everybody do what these bits say.
fn permit(node: &Path, mode: u32) {
    fs::set_permissions(node, Permissions::from_mode(mode)).expect("a node of the guest");
}

/// The only raw node, and the board's input device by what `devices` lists.
fn nodes() -> [PathBuf; 2] {
    let mut raw = fs::read_dir("/sys/class/hidraw").expect("sysfs").flatten();
    let raw = Path::new("/dev").join(raw.next().expect("the board's").file_name());
    let listed: serde_json::Value = serde_json::from_str(&devices()).expect("a document");
    let path = listed["input_devices"][0]["path"].as_str().expect("the board");
    [raw, path.into()]
}

/// Who may read a board, or its own reports, is told so by command, and so is a battery that is low. Without the reports the driver's axes
/// play, which do not tell what is light.
pub(crate) fn access() {
    let mut make = Make::drawn(&mut SplitMix64::named(0, "access"));
    let board = Board::connect(&make);
    comes_true("the board is known", || devices().contains("\"source\":\"balance-board\""));
    // The board's own reports say 5.2 V; to its driver it says the same whatever its batteries are.
    assert!(devices().contains("\"battery\":{\"volts\":5.17"), "{}", devices());
    let [raw, input] = nodes();
    permit(&raw, 0o600);
    permit(&input, 0o600);
    let command = format!("sudo setfacl -m u:$USER:r {} {}\n", input.display(), raw.display());
    let doctor = told(&mut as_somebody(&["doctor"]));
    assert!(doctor.contains(&command) && doctor.contains("its battery at 94 %"), "{doctor}");
    permit(&input, 0o644);
    let command = format!("sudo setfacl -m u:$USER:r {}\n", raw.display());
    let doctor = told(&mut as_somebody(&["doctor"]));
    assert!(doctor.contains(&command) && doctor.contains("below that cell's zero"), "{doctor}");

    permit(Path::new("/dev/uinput"), 0o666);
    let folder = tempfile::tempdir().expect("a folder");
    permit(folder.path(), 0o777);
    let light = Load { fz_n: 30.0, x: 0.5, y: 0.0 };
    let heavy = Load { fz_n: 500.0, x: 0.0, y: 0.0 };
    make.rest_kg = [-4.0; 4];
    drop(board);
    comes_true("the board goes", || !devices().contains("balance-board"));
    for (mode, wanted) in [(0o600, &[][..]), (0o644, &[("ABS_HAT0X", 1), ("ABS_HAT0X", 0)][..])] {
        let board = Board::connect(&make);
        comes_true("the board is known", || devices().contains("balance-board"));
        let [raw, input] = nodes();
        permit(&raw, mode);
        permit(&input, 0o644);
        let mut command = as_somebody(&["run", "--pad", "balance-board", "--output", "uinput"]);
        let program =
            Running::start_command(command.env("XDG_RUNTIME_DIR", folder.path()).env("HOME", folder.path()));
        comes_true("the bridge's gamepad", || find(KeyCode::BTN_EAST).is_some());
        let mut reader = Reader::open(&find(KeyCode::BTN_EAST).expect("it was there a moment ago"));
        pause(READY_MS);
        for load in [light, NOTHING, heavy, NOTHING] {
            board.bear(load);
            pause(300);
        }
        reader.read_available();
        let stamp = [("BTN_SOUTH", 1), ("BTN_SOUTH", 0)];
        assert_eq!(reader.edges(), [wanted, &stamp].concat(), "{mode:o}: {}", program.complaints());
        drop((program, board));
        comes_true("all of it goes", || {
            find(KeyCode::BTN_EAST).is_none() && !devices().contains("balance-board")
        });
    }

    make.battery = 0x60;
    let _board = Board::connect(&make);
    comes_true("the board is known", || devices().contains("balance-board"));
    let doctor = told(Command::new(TACTPAD).arg("doctor"));
    assert!(doctor.contains("its battery at 3.8 V, which is low"), "{doctor}");
}
