//! A sink that records the events which pass through it, so that they can be shown, counted and compared with expected ones.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex};

use super::{Sink, SinkError};
use crate::queue::OnWritten;
use tactpad_core::pipeline::control::{Code, OutputDevice, OutputEvent};
use tactpad_core::pipeline::mapping::profile::Binding;

/// Number of newest events that are kept.
const NEWEST: usize = 8;

/// An expected event, as a script lists it.
pub type ExpectedEvent = (OutputDevice, Code, i32);

/// The recorded events, in order. Steps of the pointer are only counted: they are many, and no two runs have the same.
#[derive(Clone, Debug, Default)]
pub struct RecordedEvents {
    /// All but the pointer's steps, where they are kept.
    pub edges: Vec<OutputEvent>,
    keeps_edges: bool,
    edge_counts: EdgeCounts,
    held: BTreeMap<(OutputDevice, Code), i32>,
    /// How many steps the pointer made.
    pub pointer_moves: usize,
    /// The newest events, of whatever kind.
    pub newest: VecDeque<OutputEvent>,
}

/// Numbers of press and release edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EdgeCounts {
    /// From neutral to held, or from one held value to another.
    pub downs: usize,
    /// From held to neutral, or from one held value to another.
    pub ups: usize,
    /// Controls that went down and not up again.
    pub held: usize,
}

impl RecordedEvents {
    fn extend(&mut self, group: &[OutputEvent]) {
        for event in group {
            match event.code {
                Code::Relative(_) => self.pointer_moves += 1,
                Code::Key(_) | Code::Axis(_) => self.count(event),
            }
            if self.newest.len() == NEWEST {
                self.newest.pop_front();
            }
            self.newest.push_back(*event);
        }
    }

    fn count(&mut self, event: &OutputEvent) {
        // A hat that goes over from one side to the other is an up and a down in one event.
        let before = self.held.insert((event.device, event.code), event.value).unwrap_or(0);
        self.edge_counts.ups += usize::from(before != 0);
        self.edge_counts.downs += usize::from(event.value != 0);
        if self.keeps_edges {
            self.edges.push(*event);
        }
    }

    /// The numbers of press and release edges.
    pub fn edge_counts(&self) -> EdgeCounts {
        EdgeCounts { held: self.held.values().filter(|value| **value != 0).count(), ..self.edge_counts }
    }

    /// Compares the edges with those of a script; times do not count.
    ///
    /// # Errors
    /// They differ; the text says where first.
    pub fn compare(&self, expected: &[ExpectedEvent]) -> Result<(), String> {
        let edges = self.edges.iter().map(|event| (event.device, event.code, event.value));
        let seen: Vec<ExpectedEvent> = edges.collect();
        let differs = seen.iter().zip(expected).position(|(seen, expected)| seen != expected);
        let Some(index) = differs.or((seen.len() != expected.len()).then(|| seen.len().min(expected.len())))
        else {
            return Ok(());
        };
        Err(format!(
            "event {} is {} where the script has {} ({} events, {} in the script)",
            index + 1,
            name(seen.get(index)),
            name(expected.get(index)),
            seen.len(),
            expected.len()
        ))
    }
}

fn name(event: Option<&ExpectedEvent>) -> String {
    match event {
        Some((device, code, value)) => format!("{} {code} {value}", device.name()),
        None => "nothing".into(),
    }
}

/// A sink that hands events on and records them.
pub struct RecordingSink {
    sink: Box<dyn Sink>,
    recorded: Arc<Mutex<RecordedEvents>>,
}

impl RecordingSink {
    /// Records the events for `sink`, and keeps each edge.
    pub fn new(sink: Box<dyn Sink>) -> Self {
        Self {
            sink,
            recorded: Arc::new(Mutex::new(RecordedEvents { keeps_edges: true, ..RecordedEvents::default() })),
        }
    }

    /// Records the events for `sink` in constant memory: edges are counted, and the newest ones are kept.
    pub fn counting(sink: Box<dyn Sink>) -> Self {
        Self { sink, recorded: Arc::default() }
    }

    /// The recorded events so far, shared with readers on other threads.
    pub fn recorded(&self) -> Arc<Mutex<RecordedEvents>> {
        Arc::clone(&self.recorded)
    }
}

impl Sink for RecordingSink {
    fn prepare(&mut self, device: OutputDevice) -> Result<(), SinkError> {
        self.sink.prepare(device)
    }

    fn accepts(&self, bindings: &[Binding]) -> Result<(), SinkError> {
        self.sink.accepts(bindings)
    }

    fn write(&mut self, group: &[OutputEvent]) -> Result<(), SinkError> {
        self.write_then(group, Box::new(|| ()))
    }

    fn write_then(&mut self, group: &[OutputEvent], written: OnWritten) -> Result<(), SinkError> {
        self.sink.write_then(group, written)?;
        if let Ok(mut recorded) = self.recorded.lock() {
            recorded.extend(group);
        }
        Ok(())
    }

    fn settle(&mut self) -> Result<(), SinkError> {
        self.sink.settle()
    }

    fn dropped(&self) -> u64 {
        self.sink.dropped()
    }

    fn waiting(&self) -> u64 {
        self.sink.waiting()
    }

    fn describe(&self) -> String {
        self.sink.describe()
    }
}

#[cfg(test)]
mod tests {
    use super::super::null::NullSink;
    use super::*;
    use tactpad_core::time::StreamInstant;

    fn event(code: Code, value: i32) -> OutputEvent {
        OutputEvent { at: StreamInstant::default(), device: OutputDevice::Gamepad, code, value }
    }

    #[test]
    fn edges_are_kept_steps_are_counted_and_a_hat_that_swings_over_is_an_up_and_a_down() {
        let mut recording = RecordingSink::new(Box::new(NullSink::NOWHERE));
        let recorded = recording.recorded();
        let hat = Code::Axis(16);
        for group in [[event(hat, 1), event(Code::Relative(0), 5)], [event(hat, -1), event(hat, 0)]] {
            recording.write(&group).unwrap();
        }
        let recorded = recorded.lock().unwrap();
        assert_eq!(recorded.edge_counts(), EdgeCounts { downs: 2, ups: 2, held: 0 });
        assert_eq!((recorded.edges.len(), recorded.pointer_moves, recorded.newest.len()), (3, 1, 4));
        let script = [1, -1, 0].map(|value| (OutputDevice::Gamepad, hat, value));
        assert_eq!(recorded.compare(&script), Ok(()));
        let told = recorded.compare(&script[..2]).unwrap_err();
        assert!(told.contains("event 3 is gamepad ABS_HAT0X 0 where the script has nothing"), "{told}");
    }

    #[test]
    fn what_the_end_released_is_not_held() {
        let (south, east) = (Code::Key(0x130), Code::Key(0x131));
        let mut recorded = RecordedEvents::default();
        recorded.extend(&[event(south, 1), event(east, 1)]);
        assert_eq!(recorded.edge_counts(), EdgeCounts { downs: 2, ups: 0, held: 2 });
        recorded.extend(&[event(south, 0), event(east, 0)]);
        assert_eq!(recorded.edge_counts(), EdgeCounts { downs: 2, ups: 2, held: 0 });
    }
}
