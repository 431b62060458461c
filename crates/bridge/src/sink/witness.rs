//! Remembers what went out, so that it can be shown, counted, and held against what should have gone out.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex};

use super::{Sink, SinkError};
use crate::queue::Written;
use tactpad_core::pipeline::control::{Code, OutputDevice, OutputEvent};
use tactpad_core::pipeline::mapping::profile::Binding;

/// The newest events that an account keeps of all.
const NEWEST: usize = 8;

/// One event as a script lists it.
pub type Expected = (OutputDevice, Code, i32);

/// What went out, in order. The pointer's steps are many and no two runs have the same: they are counted.
#[derive(Clone, Debug, Default)]
pub struct Account {
    /// All but the pointer's steps, where they are kept.
    pub edges: Vec<OutputEvent>,
    keeps_edges: bool,
    tally: Tally,
    held: BTreeMap<(OutputDevice, Code), i32>,
    /// How many steps the pointer made.
    pub pointer_moves: usize,
    /// The newest events, of whatever kind.
    pub newest: VecDeque<OutputEvent>,
}

/// How often controls went down and up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// From neutral to held, or from one held value to another.
    pub downs: usize,
    /// From held to neutral, or from one held value to another.
    pub ups: usize,
    /// Controls that went down and not up again.
    pub held: usize,
}

impl Account {
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
        self.tally.ups += usize::from(before != 0);
        self.tally.downs += usize::from(event.value != 0);
        if self.keeps_edges {
            self.edges.push(*event);
        }
    }

    /// How often controls went down and up.
    pub fn tally(&self) -> Tally {
        Tally { held: self.held.values().filter(|value| **value != 0).count(), ..self.tally }
    }

    /// Holds the edges against those of a script; times do not count.
    ///
    /// # Errors
    /// They differ; the text says where first.
    pub fn compare(&self, expected: &[Expected]) -> Result<(), String> {
        let edges = self.edges.iter().map(|event| (event.device, event.code, event.value));
        let seen: Vec<Expected> = edges.collect();
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

fn name(event: Option<&Expected>) -> String {
    match event {
        Some((device, code, value)) => format!("{} {code} {value}", device.name()),
        None => "nothing".into(),
    }
}

/// Lets events pass and remembers them.
pub struct Witness {
    sink: Box<dyn Sink>,
    seen: Arc<Mutex<Account>>,
}

impl Witness {
    /// Watches over what goes to `sink`, and keeps each edge.
    pub fn new(sink: Box<dyn Sink>) -> Self {
        Self { sink, seen: Arc::new(Mutex::new(Account { keeps_edges: true, ..Account::default() })) }
    }

    /// Watches over what goes to `sink`, however long that goes on: edges are counted, and the newest ones are kept.
    pub fn counting(sink: Box<dyn Sink>) -> Self {
        Self { sink, seen: Arc::default() }
    }

    /// What went out so far, for whoever wants to look while it plays.
    pub fn seen(&self) -> Arc<Mutex<Account>> {
        Arc::clone(&self.seen)
    }
}

impl Sink for Witness {
    fn prepare(&mut self, device: OutputDevice) -> Result<(), SinkError> {
        self.sink.prepare(device)
    }

    fn accepts(&self, bindings: &[Binding]) -> Result<(), SinkError> {
        self.sink.accepts(bindings)
    }

    fn write(&mut self, group: &[OutputEvent]) -> Result<(), SinkError> {
        self.write_then(group, Box::new(|| ()))
    }

    fn write_then(&mut self, group: &[OutputEvent], written: Written) -> Result<(), SinkError> {
        self.sink.write_then(group, written)?;
        if let Ok(mut seen) = self.seen.lock() {
            seen.extend(group);
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
        let mut witness = Witness::new(Box::new(NullSink));
        let seen = witness.seen();
        let hat = Code::Axis(16);
        for group in [[event(hat, 1), event(Code::Relative(0), 5)], [event(hat, -1), event(hat, 0)]] {
            witness.write(&group).unwrap();
        }
        let seen = seen.lock().unwrap();
        assert_eq!(seen.tally(), Tally { downs: 2, ups: 2, held: 0 });
        assert_eq!((seen.edges.len(), seen.pointer_moves, seen.newest.len()), (3, 1, 4));
        let script = [1, -1, 0].map(|value| (OutputDevice::Gamepad, hat, value));
        assert_eq!(seen.compare(&script), Ok(()));
        let told = seen.compare(&script[..2]).unwrap_err();
        assert!(told.contains("event 3 is gamepad ABS_HAT0X 0 where the script has nothing"), "{told}");
    }

    #[test]
    fn what_the_end_released_is_not_held() {
        let (south, east) = (Code::Key(0x130), Code::Key(0x131));
        let mut account = Account::default();
        account.extend(&[event(south, 1), event(east, 1)]);
        assert_eq!(account.tally(), Tally { downs: 2, ups: 0, held: 2 });
        account.extend(&[event(south, 0), event(east, 0)]);
        assert_eq!(account.tally(), Tally { downs: 2, ups: 2, held: 0 });
    }
}
