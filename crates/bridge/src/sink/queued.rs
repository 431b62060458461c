//! Groups of events behind a queue, for what may take them late or not at all.

use std::io;

use super::held_controls::HeldControls;
use crate::queue::{OnWritten, WriteGroup, WriteQueue};
use tactpad_core::pipeline::control::OutputEvent;

/// Puts groups of events into a queue, as items of whoever writes them.
///
/// Groups that find no room are dropped. In their place comes, as soon as there is room, what leads from what was queued to what
/// is held then: so whatever went down comes up.
pub(super) struct QueuedGroups<T> {
    queue: WriteQueue<T>,
    /// The controls that are held now.
    held: HeldControls,
    /// The controls that are held after everything in the queue.
    queued: HeldControls,
    /// The controls that are held after the group in the queue's last place.
    caught_up: Option<HeldControls>,
    dropped: u64,
}

impl<T> QueuedGroups<T> {
    /// Nothing is held.
    pub(super) fn new(queue: WriteQueue<T>) -> Self {
        let [held, queued] = [HeldControls::default(), HeldControls::default()];
        Self { queue, held, queued, caught_up: None, dropped: 0 }
    }

    /// Queues a group, or what is true instead of it.
    ///
    /// # Errors
    /// An earlier group could not be written, or `items` makes nothing of this one.
    pub(super) fn write(
        &mut self,
        group: &[OutputEvent],
        written: OnWritten,
        items: impl Fn(&[OutputEvent]) -> io::Result<Vec<T>>,
    ) -> io::Result<()> {
        let queued = WriteGroup { items: items(group)?, count: 1, written: Some(written) };
        self.held.apply(group);
        if let Some(caught_up) = self.caught_up.take() {
            if self.queue.replace_last(items(&self.queued.events_to(&self.held))?.into())? {
                self.drop_group();
                return Ok(());
            }
            // That is out by now.
            self.queued = caught_up;
        }
        if self.queue.push(queued)? {
            self.queued.clone_from(&self.held);
        } else {
            self.queue.put_last(items(&self.queued.events_to(&self.held))?.into())?;
            self.drop_group();
        }
        Ok(())
    }

    fn drop_group(&mut self) {
        self.caught_up = Some(self.held.clone());
        self.dropped += 1;
    }

    /// Queues items that are no events, if there is room.
    ///
    /// # Errors
    /// An earlier group could not be written.
    pub(super) fn push(&self, items: Vec<T>) -> io::Result<()> {
        self.queue.push(items.into()).map(|_| ())
    }

    /// The events that release what is held.
    pub(super) fn releases(&self) -> Vec<OutputEvent> {
        self.held.events_to(&HeldControls::default())
    }

    /// See [`super::Sink::settle`].
    pub(super) fn settle(&self) -> io::Result<()> {
        self.queue.settle()
    }

    /// See [`super::Sink::dropped`].
    pub(super) const fn dropped(&self) -> u64 {
        self.dropped
    }

    /// See [`super::Sink::waiting`].
    pub(super) fn waiting(&self) -> u64 {
        self.queue.waiting()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::sync::mpsc::{Receiver, channel};

    use proptest::prelude::{ProptestConfig, any, prop, prop_assert, prop_assert_eq, proptest};

    use super::*;
    use tactpad_core::pipeline::control::{Code, OutputDevice};
    use tactpad_core::time::StreamInstant;

    /// A queue of few places whose writer takes a group for each permit, and what it has written.
    fn gated(permits: Receiver<()>) -> (QueuedGroups<OutputEvent>, Receiver<OutputEvent>) {
        let (out, written) = channel();
        let queue = WriteQueue::start("gated", 3, move |events: &[OutputEvent]| {
            // Without anybody who permits it takes all.
            let _ = permits.recv();
            events.iter().for_each(|event| out.send(*event).unwrap());
            Ok(())
        });
        (QueuedGroups::new(queue.unwrap()), written)
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

        /// Each step changes one of a few keys, or has the writer take some groups.
        #[test]
        fn whatever_is_dropped_each_down_has_one_up(steps in prop::collection::vec((any::<bool>(), 0..4_u16), 1..80)) {
            let (permit, permits) = channel();
            let (mut groups, written) = gated(permits);
            let mut held = BTreeMap::new();
            for (is_permit, number) in steps {
                if is_permit {
                    (0..number).for_each(|_| permit.send(()).unwrap());
                    continue;
                }
                let value = held.get(&number).map_or(1, |value: &i32| 1 - value);
                held.insert(number, value);
                let event = OutputEvent { at: StreamInstant::default(), device: OutputDevice::Gamepad, code: Code::Key(number), value };
                groups.write(&[event], Box::new(|| ()), |events| Ok(events.to_vec())).unwrap();
            }
            drop(permit);
            drop(groups);
            let mut seen = BTreeMap::new();
            for event in written {
                let Code::Key(number) = event.code else { continue };
                prop_assert!(seen.insert(number, event.value).unwrap_or(0) != event.value, "{event:?} was so before");
            }
            held.retain(|_, value| *value == 1);
            seen.retain(|_, value| *value == 1);
            prop_assert_eq!(seen, held);
        }
    }
}
