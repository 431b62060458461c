//! What was played, in figures, for people and as JSON.

use serde::Serialize;

use tactpad::bridge::event_loop::Bridge;
use tactpad::bridge::latency::Percentiles;
use tactpad::bridge::sink::recording::RecordedEvents;
use tactpad::counted::counted;

/// The figures of a run.
#[derive(Serialize)]
pub(super) struct Figures {
    frames: u64,
    frames_lost: u64,
    contacts: u64,
    downs: usize,
    ups: usize,
    pointer_moves: usize,
    held_at_end: usize,
    latency_us: Percentiles,
}

impl Figures {
    /// Those of a bridge whose events were recorded.
    pub(super) fn of(bridge: &Bridge, recorded: &RecordedEvents) -> Self {
        let health = bridge.health();
        let edge_counts = recorded.edge_counts();
        Self {
            frames: health.samples,
            frames_lost: health.frames_lost + health.frames_damaged,
            contacts: health.contacts,
            downs: edge_counts.downs,
            ups: edge_counts.ups,
            pointer_moves: recorded.pointer_moves,
            held_at_end: edge_counts.held,
            latency_us: bridge.latency().percentiles(),
        }
    }

    /// Lines for people.
    pub(super) fn lines(&self) -> Vec<String> {
        let Self { frames, frames_lost, contacts, downs, ups, pointer_moves, held_at_end, latency_us } = self;
        let Percentiles { p50, p95, p99, max } = latency_us;
        let steered =
            (*pointer_moves > 0).then(|| format!("{} of the pointer", counted(*pointer_moves, "move")));
        [
            Some(format!(
                "{}, {frames_lost} lost; {}",
                counted(*frames, "frame"),
                counted(*contacts, "contact")
            )),
            Some(format!(
                "{}, {}, {held_at_end} held at the end",
                counted(*downs, "down"),
                counted(*ups, "up")
            )),
            steered,
            Some(format!(
                "bytes readable to event written: p50 {p50:.0} µs, p95 {p95:.0} µs, p99 {p99:.0} µs, max {max:.0} µs"
            )),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}
