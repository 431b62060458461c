//! Four load cells that print lines, on a pseudo-terminal: whatever happens to the line, nothing stays held and play goes on.
//!
//! The board is a thread that writes as fast as its rate says; how fast it comes to that on a busy machine decides nothing here,
//! as each step waits for a state of the bridge.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fmt::Write as _;
use std::fs;
use std::io::Read;
use std::os::fd::OwnedFd;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Command;
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};

use rustix::event::{PollFd, Timespec, poll};
use rustix::process::Signal;
use tactpad::numeric::random::SplitMix64;

use crate::pseudo_terminal;
use crate::running::{Running, comes_true};

const TACTPAD: &str = env!("CARGO_BIN_EXE_tactpad");

/// What the board prints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Printing {
    /// Numbers, under nothing.
    Rest,
    /// Numbers, under 2 kg half way to the right edge.
    Press,
    /// Numbers, and none for the third cell.
    DeadCell,
    /// Words.
    Words,
    /// Half of each line.
    Halves,
    /// One line without end.
    Endless,
    /// Nothing.
    Silence,
    /// The cable is pulled.
    Pulled,
}

/// What can go wrong, each with the state that the bridge then is in, unless it only says so.
const TROUBLES: [Printing; 6] = [
    Printing::DeadCell,
    Printing::Words,
    Printing::Halves,
    Printing::Endless,
    Printing::Silence,
    Printing::Pulled,
];

/// A board on a terminal of its own.
struct Board {
    printing: Arc<Mutex<Printing>>,
    stop: Arc<Mutex<bool>>,
    thread: Option<JoinHandle<()>>,
}

fn pause(us: i64) {
    let pause = Timespec { tv_sec: us / 1_000_000, tv_nsec: us % 1_000_000 * 1_000 };
    poll(&mut [] as &mut [PollFd<'_>; 0], Some(&pause)).unwrap();
}

/// A new terminal behind the path `link`.
fn terminal(link: &Path) -> OwnedFd {
    let (master, path) = pseudo_terminal::open();
    let _ = fs::remove_file(link);
    symlink(path, link).unwrap();
    master
}

fn line(number: u32, printing: Printing) -> String {
    let mut line = String::new();
    for k in 0..4_u32 {
        let noise = f64::from((number * 7 + k * 3) % 11) / 5.0 - 1.0;
        // 20 N at x = 50 mm: three quarters on the right cells.
        let share = if k % 2 == 1 { 0.375 } else { 0.125 };
        let load_g = if printing == Printing::Press { share * 20.0 / 9.806_65e-3 } else { 0.0 };
        let separator = if k == 0 { "" } else { "," };
        if k == 2 && printing == Printing::DeadCell {
            write!(line, "{separator}nan").unwrap();
        } else {
            write!(line, "{separator}{:.2}", 1_000.0 * f64::from(k) + load_g + noise).unwrap();
        }
    }
    match printing {
        Printing::Words => "calibrating the scale, please wait\n".into(),
        Printing::Halves => line.get(..line.len() / 3).unwrap_or_default().to_owned() + "\n",
        Printing::Endless => line,
        Printing::Silence | Printing::Pulled => String::new(),
        _ => line + "\r\n",
    }
}

impl Board {
    fn start(lines_per_s: i64, link: std::path::PathBuf) -> Self {
        let (printing, stop) = (Arc::new(Mutex::new(Printing::Rest)), Arc::new(Mutex::new(false)));
        let mut port = Some(terminal(&link));
        let (said, told) = (Arc::clone(&printing), Arc::clone(&stop));
        let thread = thread::spawn(move || {
            for number in 0.. {
                if *told.lock().unwrap() {
                    return;
                }
                let printing = *said.lock().unwrap();
                if printing == Printing::Pulled {
                    port = None;
                } else {
                    let port = port.get_or_insert_with(|| terminal(&link));
                    // Nobody reads it, or slowly: what does not fit is lost.
                    let _ = rustix::io::write(&*port, line(number, printing).as_bytes());
                }
                pause(1_000_000 / lines_per_s);
            }
        });
        Self { printing, stop, thread: Some(thread) }
    }

    fn prints(&self, printing: Printing) {
        *self.printing.lock().unwrap() = printing;
    }
}

impl Drop for Board {
    fn drop(&mut self) {
        *self.stop.lock().unwrap() = true;
        let ended = self.thread.take().map(JoinHandle::join);
        assert!(thread::panicking() || matches!(ended, Some(Ok(()))));
    }
}

fn held(bridge: &Running) -> usize {
    bridge.status()["held"].as_array().map_or(usize::MAX, Vec::len)
}

fn state(bridge: &Running) -> String {
    bridge.status()["state"].as_str().unwrap_or_default().to_owned()
}

/// Plays through troubles in an order of this seed.
fn plays_through(lines_per_s: i64, seed: u64) {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let board = Board::start(lines_per_s, link.clone());
    let address = format!("load-cells:{}", link.display());
    let mut record = Running::program(TACTPAD, folder.path());
    record.args(["record", "game.cap", "--pad", &address, "--output", "log:live"]);
    let mut bridge = Running::start(folder, record);
    assert!(comes_true(|| state(&bridge) == "playing"), "{lines_per_s}: {}", state(&bridge));
    let mut troubles = TROUBLES;
    let mut random = SplitMix64::new(seed);
    for k in (1..troubles.len()).rev() {
        troubles.swap(k, (random.fraction() * (k + 1) as f32) as usize % (k + 1));
    }
    for trouble in troubles {
        board.prints(Printing::Press);
        assert!(comes_true(|| held(&bridge) > 0), "{lines_per_s}: before {trouble:?}: {}", state(&bridge));
        board.prints(trouble);
        // The key is let go, and why is said.
        let wanted = match trouble {
            Printing::DeadCell => "faulty",
            Printing::Pulled => "waiting",
            _ => "silent",
        };
        let is_told = || held(&bridge) == 0 && state(&bridge) == wanted;
        assert!(comes_true(is_told), "{lines_per_s}: {trouble:?}: {}", state(&bridge));
        board.prints(Printing::Rest);
        assert!(
            comes_true(|| state(&bridge) == "playing"),
            "{lines_per_s}: after {trouble:?}: {}",
            state(&bridge)
        );
    }
    board.prints(Printing::Press);
    assert!(comes_true(|| held(&bridge) > 0), "{lines_per_s}: at the end");
    board.prints(Printing::Rest);
    assert!(comes_true(|| held(&bridge) == 0), "{lines_per_s}: at the end");
    bridge.signal(Signal::TERM);
    assert!(bridge.ends().is_some_and(|ended| ended.success()));

    let mut live = String::new();
    fs::File::open(bridge.folder.path().join("live")).unwrap().read_to_string(&mut live).unwrap();
    let replayed =
        Command::new(TACTPAD).args(["replay", "game.cap"]).current_dir(bridge.folder.path()).output();
    let replayed = replayed.unwrap();
    assert!(live.lines().count() >= 14, "{live}");
    assert_eq!(
        String::from_utf8(replayed.stdout).unwrap(),
        live,
        "{lines_per_s}: it replays to the same events"
    );
}

#[test]
fn ten_lines_a_second_play_through_whatever_happens() {
    plays_through(10, 1);
}

#[test]
fn eighty_lines_a_second_play_through_whatever_happens() {
    plays_through(80, 2);
}

#[test]
fn a_thousand_lines_a_second_play_through_whatever_happens() {
    plays_through(1_000, 3);
}

#[test]
fn a_port_that_prints_words_is_no_pad_and_is_told_so() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let board = Board::start(80, link.clone());
    board.prints(Printing::Words);
    let mut run = Running::program(TACTPAD, folder.path());
    run.args(["run", "--pad", &format!("load-cells:{}", link.display()), "--output", "none"]);
    let mut bridge = Running::start(folder, run);
    assert_eq!(bridge.ends().and_then(|ended| ended.code()), Some(2), "{}", bridge.told());
    let told = bridge.told();
    assert!(
        told.contains("lines come that are not the numbers of the description: check the baud rate"),
        "{told}"
    );
}
