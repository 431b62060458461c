//! The paper's task block (Table 6) and players who scatter: a segment many times, side by side.

use std::fs;
use std::path::Path;

use tactpad::numeric::statistics::{deviation, mean};

use crate::desk::{Desk, pause_ms};
use crate::hand::{ORDINARY, Style};
use crate::heard::labels;
use crate::player::Player;
use crate::segment::Segment;
use crate::trial::{Bridge, Game, Outcome, Recorded, Way, play, tactpad};

/// A game as the blocks play it.
pub(crate) struct Played<'a> {
    /// Starts it anew.
    pub(crate) start: &'a dyn Fn() -> Box<dyn Game>,
    pub(crate) segment: &'a Segment,
    pub(crate) profile: &'a str,
}

/// Trials of one kind.
#[derive(Default)]
pub(crate) struct Trials(Vec<Outcome>);

impl Trials {
    pub(crate) fn reached(&self) -> usize {
        self.0.iter().filter(|outcome| outcome.reached_s.is_ok()).count()
    }

    /// Mean and standard deviation of the times of those that succeeded.
    pub(crate) fn time_s(&self) -> [f64; 2] {
        let times: Vec<f64> = self.0.iter().filter_map(|outcome| outcome.reached_s.clone().ok()).collect();
        [mean(&times), deviation(&times)]
    }

    fn mispresses_per_minute(&self, segment: &Segment) -> f64 {
        let mispresses: usize = self.0.iter().map(|outcome| outcome.mispresses).sum();
        mispresses as f64 / (self.0.len() as f64 * segment.length_ms() as f64 / 60_000.0)
    }

    pub(crate) fn row(&self, name: &str, segment: &Segment) -> String {
        let [mean_s, deviation_s] = self.time_s();
        let (reached, count, each) = (self.reached(), self.0.len(), self.mispresses_per_minute(segment));
        let time = if reached == 0 { "–".into() } else { format!("{mean_s:.2} ± {deviation_s:.2}") };
        format!("| {name} | {reached} of {count} | {time} | {each:.1} |")
    }
}

/// The head of the tables that are printed.
pub(crate) const HEAD: &str = "| player | succeeded | time, s | mis-presses per minute |\n|---|---|---|---|";

impl Played<'_> {
    pub(crate) fn trial(&self, trials: &mut Trials, way: Way<'_>) {
        let outcome = play((self.start)().as_mut(), self.segment, way);
        println!("{way}: {outcome}");
        if outcome.reached_s.is_err() {
            println!("  {}", outcome.events.join(", "));
        }
        trials.0.push(outcome);
    }

    /// The segment `count` times by the pad and `count` times by the commands themselves, in turn. Pads and fingers are those of the
    /// seeds from [`BLOCK_SEED`] on.
    pub(crate) fn side_by_side(&self, count: u64) -> [Trials; 2] {
        let profile = self.profile;
        let [mut pad, mut plain] = [Trials::default(), Trials::default()];
        for seed in BLOCK_SEED..BLOCK_SEED + count {
            self.trial(&mut pad, Way::Pad { style: ORDINARY, seed, profile });
            self.trial(&mut plain, Way::Plain { profile });
        }
        println!(
            "{HEAD}\n{}\n{}",
            pad.row("pad", self.segment),
            plain.row("the commands themselves", self.segment)
        );
        [pad, plain]
    }

    /// Players of these styles, each with the shipped profile and with the one that `tune` makes of its recording.
    pub(crate) fn scattered(&self, styles: &[Style], count: u64) {
        let mut rows = Vec::new();
        for (number, style) in (1..).zip(styles) {
            let folder = tempfile::tempdir().unwrap();
            let tuned = self.tuned(*style, WARM_UP_SEED + number, folder.path());
            let profiles = [("shipped", self.profile), ("tuned", tuned.as_str())];
            let mut trials = [Trials::default(), Trials::default()];
            for seed in SCATTERED_SEED..SCATTERED_SEED + count {
                for ((_, profile), trials) in profiles.iter().zip(&mut trials) {
                    self.trial(trials, Way::Pad { style: *style, seed: seed + 100 * number, profile });
                }
            }
            for ((what, _), trials) in profiles.iter().zip(&trials) {
                let name = format!("{} mm, {:.0} %, {what}", style.aim_mm, 100.0 * style.force_share);
                rows.push(trials.row(&name, self.segment));
            }
        }
        println!("{HEAD}\n{}", rows.join("\n"));
    }

    /// Records a player's warm-up, without a game, and lets `tune` fit the profile to it; the new profile's file.
    fn tuned(&self, style: Style, seed: u64, folder: &Path) -> String {
        let desk = Desk::new(320, 240);
        let bridge = Bridge::start(&desk, Player::on_twin(style, seed), self.profile);
        let round_ms = self.segment.length_ms() + BETWEEN_MS;
        let warm_up = Segment((0..ROUNDS).flat_map(|round| self.segment.after(round * round_ms).0).collect());
        bridge.player.play(&warm_up);
        pause_ms(ROUNDS * round_ms);
        let Recorded { capture, begun_us } = bridge.end();
        let [table, tuned] = ["warm-up.csv", "tuned.toml"].map(|name| folder.join(name));
        fs::write(&table, labels(&capture, &warm_up, begun_us)).unwrap();
        let mut tune = tactpad(folder);
        tune.arg("tune").arg(&capture).arg("--labelled").arg(&table);
        tune.args(["--profile", self.profile, "--write"]).arg(&tuned);
        let told = tune.output().unwrap();
        println!("{}", String::from_utf8_lossy(&told.stdout));
        assert!(told.status.success(), "{}", String::from_utf8_lossy(&told.stderr));
        // Where nothing is better nothing is written.
        if tuned.exists() { tuned.display().to_string() } else { self.profile.to_owned() }
    }
}

/// How often the segment is played for a recording, and how long a player pauses between.
const ROUNDS: u64 = 12;
const BETWEEN_MS: u64 = 600;
/// First seeds of the block, of warm-ups and of players who scatter. Nothing was chosen by what these did.
const BLOCK_SEED: u64 = 5_001;
const WARM_UP_SEED: u64 = 6_001;
const SCATTERED_SEED: u64 = 7_001;
