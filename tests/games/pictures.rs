//! A recording of a game beside the page that shows the pad.

use std::path::Path;
use std::process::Stdio;

use crate::desk::{Desk, Process, pause_ms};
use crate::player::{ORDINARY, Player};
use crate::segment::Segment;
use crate::trial::{Bridge, Game};

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

/// Plays `segment` and records it into `folder`: `PROFILE.webp`, which moves, and `PROFILE.png` from its later half.
pub(crate) fn record(game: &mut dyn Game, segment: &Segment, profile: &str, folder: &Path) {
    let desk = game.desk();
    let player = Player::new(ORDINARY, SEED);
    let bridge = Bridge::start_as(desk, player, profile, &["run", "--dashboard"]);
    let _page = browser(desk, bridge.ctl(&["dashboard"]).trim());
    pause_ms(PAGE_MS);
    game.take_keyboard();
    let [film, still] = ["webp", "png"].map(|kind| folder.join(format!("{profile}.{kind}")));
    let mut recorder = ffmpeg(desk, segment.length_ms(), &film);
    bridge.player.play(segment);
    pause_ms(segment.length_ms() * 2 / 3);
    assert!(shot(desk, &still).0.wait().unwrap().success());
    assert!(recorder.0.wait().unwrap().success());
    println!("{} and {} are written; at the end {:?}", film.display(), still.display(), game.progress());
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

/// Takes pictures of the whole screen.
fn grab(desk: &Desk) -> std::process::Command {
    let mut grab = desk.command("ffmpeg");
    grab.args(["-loglevel", "error", "-y", "-f", "x11grab", "-framerate", &RATE_HZ.to_string()]);
    grab.args([
        "-video_size",
        &format!("{}x{}", desk.screen.width(), desk.screen.height()),
        "-i",
        &desk.display,
    ]);
    grab.stderr(Stdio::inherit());
    grab
}

fn ffmpeg(desk: &Desk, length_ms: u64, file: &Path) -> Process {
    let mut film = grab(desk);
    film.args(["-t", &format!("{}.{:03}", length_ms / 1_000, length_ms % 1_000), "-vf", "scale=-2:240"]);
    film.args([
        "-c:v",
        "libwebp",
        "-lossless",
        "0",
        "-quality",
        "55",
        "-compression_level",
        "3",
        "-loop",
        "0",
    ]);
    Process(film.arg(file).spawn().unwrap())
}

fn shot(desk: &Desk, file: &Path) -> Process {
    let mut shot = grab(desk);
    Process(shot.args(["-frames:v", "1", "-update", "1", "-vf", "scale=900:-1"]).arg(file).spawn().unwrap())
}
