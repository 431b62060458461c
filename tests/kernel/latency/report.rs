//! What was measured: as one line from the guest to the host, as a table, as a picture, and as goals that are reached or not.

use std::env;
use std::fs;

use serde::{Deserialize, Serialize};
use tactpad::plot::chart::{Chart, Series, SeriesLook, Side, Value};
use tactpad::plot::figure::Figure;
use tactpad::plot::scale::Scale;
use tactpad::plot::svg;

use crate::proof;

/// What is before it in the guest's output.
const SAID: &str = "guest: latency ";

/// Shares of edges that take no longer, percent.
const PERCENTS: [f64; 10] = [5.0, 10.0, 25.0, 50.0, 75.0, 90.0, 95.0, 98.0, 99.0, 99.5];

/// The names of ours and of the least that there can be.
pub(super) const OURS: &str = "tactpad";
pub(super) const ECHO: &str = "echo in C";

/// Ours takes, of a percentile, at most so many times another one's time, and so many µs.
pub(crate) struct Goal {
    cause: Cause,
    beside: &'static str,
    load: Load,
    percent: f64,
    times: f64,
    more_us: f64,
}

/// What is reached.
pub(crate) const REACHED: [Goal; 5] = [
    over_echo(Load::Idle, 50.0, 2.0, 20.0),
    over_echo(Load::Loaded, 50.0, 2.0, 20.0),
    not_behind("kanata", Load::Idle, 50.0),
    not_behind("kanata", Load::Idle, 99.0),
    not_behind("kanata", Load::Loaded, 50.0),
];

/// What is wanted besides.
pub(crate) const WANTED: [Goal; 9] = [
    over_echo(Load::Idle, 50.0, 1.3, 20.0),
    over_echo(Load::Idle, 99.0, 1.5, 40.0),
    over_echo(Load::Loaded, 50.0, 1.3, 20.0),
    over_echo(Load::Loaded, 99.0, 1.5, 40.0),
    not_behind("kanata", Load::Loaded, 99.0),
    not_behind("xremap", Load::Idle, 50.0),
    not_behind("xremap", Load::Idle, 99.0),
    not_behind("xremap", Load::Loaded, 50.0),
    not_behind("xremap", Load::Loaded, 99.0),
];

const fn over_echo(load: Load, percent: f64, times: f64, more_us: f64) -> Goal {
    Goal { cause: Cause::Frame, beside: ECHO, load, percent, times, more_us }
}

const fn not_behind(beside: &'static str, load: Load, percent: f64) -> Goal {
    Goal { cause: Cause::Event, beside, load, percent, times: 1.0, more_us: 0.0 }
}

/// What makes an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Cause {
    /// A frame on a serial line.
    Frame,
    /// An event of an input device.
    Event,
}

/// What the processor has to do besides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Load {
    /// Nothing.
    Idle,
    /// A process that never waits.
    Loaded,
}

/// One of those that were measured, in one load.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Row {
    cause: Cause,
    name: String,
    load: Load,
    edges: usize,
    /// How long edges took, by [`PERCENTS`], µs.
    quantiles_us: Vec<f64>,
}

/// All that was measured.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Measured {
    pub(super) seed: u64,
    /// Edges that were measured again, since the machine stood still.
    pub(super) repeated: usize,
    pub(super) rows: Vec<Row>,
    /// Programs that are not among them, each with the reason.
    pub(super) left_out: Vec<String>,
}

impl Load {
    pub(super) const BOTH: [Self; 2] = [Self::Idle, Self::Loaded];

    const fn name(self) -> &'static str {
        match self {
            Self::Idle => "idle",
            Self::Loaded => "loaded",
        }
    }
}

impl Cause {
    const BOTH: [Self; 2] = [Self::Frame, Self::Event];

    const fn name(self) -> &'static str {
        match self {
            Self::Frame => "frame on a serial line",
            Self::Event => "event of an input device",
        }
    }
}

impl Row {
    pub(super) fn new(cause: Cause, name: &str, load: Load, mut took_ns: Vec<u64>) -> Self {
        took_ns.sort_unstable();
        let edges = took_ns.len();
        // The least time that no smaller share of edges takes.
        let place = |percent: f64| (percent / 100.0 * edges as f64).ceil().max(1.0) as usize - 1;
        let quantiles_us = PERCENTS.iter().map(|percent| took_ns[place(*percent)] as f64 / 1e3).collect();
        Self { cause, name: name.to_owned(), load, edges, quantiles_us }
    }

    fn us(&self, percent: f64) -> f64 {
        let place = PERCENTS.iter().position(|other| *other == percent).expect("one of these");
        self.quantiles_us[place]
    }
}

/// Judges what the guest said by `goals`, on the host: prints the table, keeps all numbers with the proofs' results, and draws the picture where
/// `TACTPAD_LATENCY_PICTURE` says.
pub(crate) fn judge(said: &str, goals: &[Goal]) {
    let line = said.split_once(SAID).and_then(|(_, rest)| rest.lines().next()).expect("the guest's line");
    let measured: Measured = serde_json::from_str(line.trim()).expect("what `say` writes");
    proof::write("latency", &serde_json::to_value(&measured).expect("numbers and texts"));
    if let Some(path) = env::var_os("TACTPAD_LATENCY_PICTURE") {
        fs::write(path, svg::text(&measured.picture())).expect("the picture's file");
    }
    println!("{}", measured.table());
    measured.left_out.iter().for_each(|left_out| println!("left out: {left_out}"));
    println!("edges repeated after a stall of the machine: {}", measured.repeated);
    let misses = measured.misses(goals);
    assert!(misses.is_empty(), "{misses:#?}");
}

impl Measured {
    /// Tells the host.
    pub(super) fn say(&self) {
        println!("{SAID}{}", serde_json::to_string(self).expect("numbers and texts"));
    }

    fn row(&self, cause: Cause, name: &str, load: Load) -> Option<&Row> {
        self.rows.iter().find(|row| row.cause == cause && row.name == name && row.load == load)
    }

    /// A line for each that was measured, as docs/latency.md has them.
    fn table(&self) -> String {
        let mut table = "| cause | program | idle p50, p95, p99 | loaded p50, p95, p99 | times its echo: idle p50, p99 | loaded p50, p99 |\n\
                         |---|---|---|---|---|---|\n"
            .to_owned();
        for Row { cause, name, .. } in self.rows.iter().filter(|row| row.load == Load::Idle) {
            let times = Load::BOTH.map(|load| {
                let us = |percent| self.row(*cause, name, load).map_or(f64::NAN, |row| row.us(percent));
                [50.0, 95.0, 99.0].map(|percent| format!("{:.0}", us(percent))).join(", ")
            });
            let over_echo = Load::BOTH.map(|load| {
                let us = |name, percent| self.row(*cause, name, load).map_or(f64::NAN, |row| row.us(percent));
                [50.0, 99.0].map(|percent| format!("{:.2}", us(name, percent) / us(ECHO, percent))).join(", ")
            });
            let cells = [&[cause.name().to_owned(), name.clone()][..], &times, &over_echo].concat();
            table += &format!("| {} |\n", cells.join(" | "));
        }
        table
    }

    /// What of these goals is not reached. One beside a program that was not measured is none.
    fn misses(&self, goals: &[Goal]) -> Vec<String> {
        let miss = |goal: &Goal| {
            let Goal { cause, beside, load, percent, times, more_us } = *goal;
            let us = |name| self.row(cause, name, load).map(|row| row.us(percent));
            let (ours_us, most_us) = (us(OURS)?, times * us(beside)? + more_us);
            let load = load.name();
            (ours_us > most_us).then(|| {
                format!(
                    "beside {beside}, {load}, p{percent}: {ours_us:.0} us, where {most_us:.0} are allowed"
                )
            })
        };
        goals.iter().filter_map(miss).collect()
    }

    /// The share of edges that take longer, over the time: a chart for each cause and load.
    fn picture(&self) -> Figure {
        const SIZE: [f64; 2] = [460.0, 330.0];
        let description = "How many edges take longer than a time, by cause, program and load";
        let mut page = Figure::new(2.0 * SIZE[0], 2.0 * SIZE[1], description);
        for (down, cause) in Cause::BOTH.into_iter().enumerate() {
            for (across, load) in Load::BOTH.into_iter().enumerate() {
                let at = [across as f64 * SIZE[0], down as f64 * SIZE[1]];
                page.place(self.chart(cause, load, SIZE).figure(), at);
            }
        }
        page
    }

    fn chart(&self, cause: Cause, load: Load, [width, height]: [f64; 2]) -> Chart {
        let series = self.rows.iter().filter(|row| row.cause == cause && row.load == load).map(|row| {
            let values = PERCENTS.iter().zip(&row.quantiles_us);
            let values = values.map(|(percent, us)| Value::new(*us, 100.0 - percent)).collect();
            let look = if row.name == ECHO { SeriesLook::Dashes } else { SeriesLook::Line };
            Series { name: row.name.clone(), values, look }
        });
        // All on the same axes.
        let all_us = self.rows.iter().flat_map(|row| row.quantiles_us.iter().copied()).collect();
        Chart {
            title: format!("{}, {}", cause.name(), load.name()),
            width,
            height,
            x: Side {
                label: "time until the event can be read, µs".into(),
                scale: Scale::Log10,
                also: all_us,
            },
            y: Side { label: "edges that take longer, %".into(), scale: Scale::Log10, also: vec![100.0] },
            series: series.collect(),
            guides: Vec::new(),
        }
    }
}
