//! Plans: which contacts are made, from the program's own plan files or from a table of the test's own.

use crate::effects::warmth::REFERENCE_C;
use crate::program::protocol;
use crate::random::Random;

/// A place in mm and a force in N, pressing positive.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Contact {
    pub(crate) place: [f64; 2],
    pub(crate) force: [f64; 3],
}

/// One row of a plan, and when and how it is carried out.
#[derive(Debug, Clone)]
pub(crate) struct Row {
    pub(crate) trial: String,
    pub(crate) session: String,
    /// Seconds from the trial's beginning; none for a static sample.
    pub(crate) in_trial_s: Option<f64>,
    /// Seconds from the recording's beginning.
    pub(crate) time_s: f64,
    pub(crate) temp_c: f64,
    pub(crate) cycle: f64,
    pub(crate) contact: Contact,
    pub(crate) dwell_s: f64,
    pub(crate) unloading: bool,
    /// By how much the pad is turned on the stage, counter-clockwise.
    pub(crate) turned_deg: f64,
    /// A known weight in place of the rig's press.
    pub(crate) weight_g: Option<f64>,
}

impl Row {
    pub(crate) fn loaded(&self) -> bool {
        self.contact.force != [0.0; 3]
    }

    /// By what the force is larger from which an unloading contact comes down: its largest component is 5 N there.
    pub(crate) fn overload(&self) -> f64 {
        5.0 / self.contact.force.iter().fold(1e-3_f64, |largest, force| largest.max(force.abs()))
    }
}

/// Which contacts are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Plan {
    Paper,
    Recommended,
    /// Fast presses at 45 samples a second on top of the paper's contacts: for what only time shows.
    Stream,
}

impl Plan {
    pub(crate) const BOTH: [Self; 2] = [Self::Paper, Self::Recommended];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Recommended => "recommended",
            Self::Stream => "stream",
        }
    }

    /// The plan's rows; the program writes the first two, from outside.
    pub(crate) fn rows(self, seed: u64) -> Vec<Row> {
        let program = |name: &str| read(&protocol(name, seed));
        match self {
            Self::Paper => program("paper"),
            Self::Recommended => program("recommended"),
            Self::Stream => {
                let mut rows = program("paper");
                rows.extend(stream(&mut Random::new(seed, "stream")));
                rows
            }
        }
    }
}

/// Reads a plan by the names of its columns.
pub(crate) fn read(text: &str) -> Vec<Row> {
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let cell = |name: &str| {
            let column = header.iter().position(|own| *own == name);
            column.map_or("", |column| cells[column])
        };
        let number = |name: &str| cell(name).parse::<f64>().ok();
        let known = |name: &str| number(name).unwrap_or_default();
        Row {
            trial: cell("trial").to_owned(),
            session: cell("session").to_owned(),
            in_trial_s: number("t_s").filter(|_| !cell("trial").is_empty()),
            time_s: 0.0,
            temp_c: REFERENCE_C,
            cycle: 0.0,
            contact: Contact {
                place: [known("x_mm"), known("y_mm")],
                force: [known("fx_n"), known("fy_n"), known("fz_n")],
            },
            dwell_s: number("dwell_s").unwrap_or(1.0),
            unloading: cell("approach") == "unloading",
            turned_deg: known("turned_deg"),
            weight_g: number("weight_g"),
        }
    };
    lines.map(row).collect()
}

/// Eight presses of two to four seconds, each in a trial of its own, and ten seconds of rest.
fn stream(random: &mut Random) -> Vec<Row> {
    let mut rows = Vec::new();
    for trial in 0..9 {
        let (angle, radius) = (random.between(0.0, 360.0).to_radians(), random.between(0.0, 27.0));
        let [along_x, along_y, pressing] = [random.normal(), random.normal(), random.between(2.0, 5.0)];
        let seconds = if trial == 0 { 10.0 } else { random.between(2.0, 4.0) };
        let samples = (seconds * 45.0) as usize;
        for sample in 0..samples {
            let at = sample as f64 / 45.0;
            let rise = (std::f64::consts::PI * at / seconds).sin().powi(2);
            let rise = if trial == 0 { 0.0 } else { rise };
            let force = [along_x, along_y, pressing].map(|force| rise * force);
            rows.push(Row {
                trial: format!("press {trial}"),
                session: "stream".to_owned(),
                in_trial_s: Some(at),
                time_s: 0.0,
                temp_c: REFERENCE_C,
                cycle: 0.0,
                contact: Contact { place: [radius * angle.cos(), radius * angle.sin()], force },
                dwell_s: 0.0,
                unloading: false,
                turned_deg: 0.0,
                weight_g: None,
            });
        }
    }
    rows
}

/// How the room's temperature goes during a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Room {
    /// Up and back in three waves that are no multiples of the recording's length: not the time.
    UpAndDown,
    /// Ever warmer, as after the heating was turned on: the time itself.
    Warming,
}

/// The clock, the room's temperature and the cycles of load, as the recording goes on. Each contact counts for so many
/// cycles that 50,000 are behind the pad at the end.
pub(crate) fn carry_out(rows: &mut [Row], room: Room, random: &mut Random) {
    run_clock(rows);
    let waves = [random.between(1.3, 1.8), random.between(2.2, 2.9), random.between(3.3, 4.6)];
    let phases = [0, 1, 2].map(|_| random.unit());
    let count = rows.len() as f64;
    let end = rows.last().map_or(1.0, |row| row.time_s);
    for (index, row) in rows.iter_mut().enumerate() {
        let part = row.time_s / end;
        let wave = |wave: usize| (std::f64::consts::TAU * (waves[wave] * part + phases[wave])).sin();
        row.temp_c = REFERENCE_C
            + match room {
                Room::UpAndDown => 3.0 * (wave(0) + wave(1) + wave(2)),
                Room::Warming => 8.0 * part - 4.0,
            };
        row.cycle = (50_000.0 * (index + 1) as f64 / count).round();
    }
}

/// Four seconds to reach a contact, and what it is held; a series runs by its own clock.
fn run_clock(rows: &mut [Row]) {
    let (mut now, mut trial_start, mut before) = (0.0, 0.0, String::new());
    for row in rows.iter_mut() {
        if row.in_trial_s.is_some() && row.trial != before {
            trial_start = now + 4.0;
        }
        now = row.in_trial_s.map_or(now + 4.0 + row.dwell_s, |at| trial_start + at);
        row.time_s = now;
        before.clone_from(&row.trial);
    }
}
