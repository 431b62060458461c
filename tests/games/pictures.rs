//! A recording of a game beside the page that shows the pad.

use std::path::Path;
use std::process::{Command, Stdio};

use crate::desk::{Desk, Process, pause_ms};
use crate::hand::ORDINARY;
use crate::player::Player;
use crate::segment::Segment;
use crate::trial::{Bridge, Game, watch};

/// The page stands to the right of the game, as high as that.
const PAGE_WIDTH_PX: u32 = 560;
/// A length on the page is so many pixels, so that the whole of it is to be seen.
const PAGE_SCALE: f64 = 0.5;
/// Frames of the recording per second.
const RATE_HZ: u32 = 6;
const SEED: u64 = 1;

/// A desk on which a game of this size and the page have room.
pub(crate) fn desk(width_px: u32, height_px: u32) -> Desk {
    Desk::new(width_px + PAGE_WIDTH_PX, height_px)
}

/// Plays a game and records it into `folder`: `PROFILE.webp`, which moves, and `PROFILE.png` from its later half.
///
/// The page is there before the game, which would pause if another window took the keyboard.
///
/// # Panics
/// The landmark is not reached: that is no picture of how the game is played.
pub(crate) fn record<G: Game>(
    desk: Desk,
    start: fn(Desk) -> G,
    segment: &Segment,
    profile: &str,
    folder: &Path,
) {
    let bridge = Bridge::start_as(&desk, Player::on_twin(ORDINARY, SEED), profile, &["run", "--dashboard"]);
    let _page = browser(&desk, bridge.ctl(&["dashboard"]).trim());
    pause_ms(PAGE_MS);
    let [film, still] = ["webp", "png"].map(|kind| folder.join(format!("{profile}.{kind}")));
    let mut game = start(desk);
    let shown = Shown::on(game.desk());
    let mut recorder = shown.film(segment.length_ms(), &film);
    let mut shots = Vec::new();
    bridge.player.play(segment);
    let reached_s = watch(&mut game, segment, |at_us| {
        if shots.is_empty() && at_us > 1_000 * segment.length_ms() * 2 / 3 {
            shots.push(shown.shot(&still));
        }
    });
    assert!(reached_s.is_ok(), "{profile}: {reached_s:?}");
    assert!(shots.iter_mut().chain([&mut recorder]).all(|it| it.0.wait().unwrap().success()));
    println!("{} and {} are written", film.display(), still.display());
}

/// A page is there after so long.
const PAGE_MS: u64 = 6_000;

fn browser(desk: &Desk, url: &str) -> Process {
    let mut browser = desk.command("chromium");
    browser.args(["--no-sandbox", "--test-type", "--disable-gpu", "--no-first-run", "--hide-scrollbars"]);
    browser.arg(format!("--force-device-scale-factor={PAGE_SCALE}"));
    let width_px = f64::from(PAGE_WIDTH_PX);
    let left_px = desk.screen.width() as f64 - width_px;
    let [left, width, height] = [left_px, width_px, desk.screen.height() as f64].map(|px| px / PAGE_SCALE);
    browser
        .arg(format!("--window-position={left:.0},0"))
        .arg(format!("--window-size={width:.0},{height:.0}"));
    browser.arg(format!("--user-data-dir={}", desk.home.path().join("browser").display()));
    Process(browser.arg(format!("--app={url}")).spawn().unwrap())
}

/// What is on a desk, for whoever takes pictures of it while somebody else looks after the game.
struct Shown {
    display: String,
    size_px: String,
}

impl Shown {
    fn on(desk: &Desk) -> Self {
        let size_px = format!("{}x{}", desk.screen.width(), desk.screen.height());
        Self { display: desk.display.clone(), size_px }
    }

    /// Takes pictures of the whole screen.
    fn grab(&self) -> Command {
        let mut grab = Command::new("ffmpeg");
        grab.args(["-loglevel", "error", "-y", "-f", "x11grab", "-framerate", &RATE_HZ.to_string()]);
        grab.args(["-video_size", &self.size_px, "-i", &self.display]).stdin(Stdio::null());
        grab
    }

    fn film(&self, length_ms: u64, file: &Path) -> Process {
        let mut film = self.grab();
        film.args(["-t", &format!("{}.{:03}", length_ms / 1_000, length_ms % 1_000), "-vf", "scale=-2:240"]);
        film.args(["-c:v", "libwebp", "-lossless", "0", "-quality", "22", "-compression_level", "3"]);
        Process(film.args(["-loop", "0"]).arg(file).spawn().unwrap())
    }

    fn shot(&self, file: &Path) -> Process {
        let mut shot = self.grab();
        shot.args(["-frames:v", "1", "-update", "1", "-vf", "scale=900:-1"]);
        Process(shot.arg(file).spawn().unwrap())
    }
}
