//! Events of an input device as frames: what a firmware of ours would have sent. Told the time; it reads no clock.
//!
//! A device says nothing while nothing changes, so its last state is sent again and again: its silence is no lost link.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::RangeInclusive;

use firmware_proto::ENCODED_MAX;
use firmware_proto::channels::ChannelSample;
use firmware_proto::contact::ContactSample;
use firmware_proto::frame::Message;
use firmware_proto::link::encode_message;
use firmware_proto::sample::Status;
use tactpad_core::pipeline::contact::balance::PLATE_RADIUS_MM;
use tactpad_core::quantity::WEIGHT_N_PER_G;
use tactpad_core::source::codes::{BTN_TOUCH, MT_FIRST, MT_SLOT};
use tactpad_core::source::{Evdev, FULL_N, Measures, Source, Touching};

use super::axis::AxisRange;
use super::fingers::Fingers;
use super::leave::{FINGERS, Hold, Leave};
use super::tip::Tip;
use crate::transport::pacing::{FRAME_MIN_US, REPEAT_US};

/// Pen, eraser, brush, pencil and airbrush.
const TOOLS: RangeInclusive<u16> = 0x140..=0x144;

/// The side buttons of pens.
const SIDE_BUTTONS: [u16; 3] = [0x149, 0x14b, 0x14c];

/// Four fingers and five are there: a pad tells that also where it knows no places of so many.
const FOUR_AND_FIVE: [u16; 2] = [0x14f, 0x148];

/// A pen that has said nothing for so long and touches nothing may have left, µs: some tablets do not tell. One in a hand trembles.
const LEFT_US: u64 = 1_000_000;

/// Something that the device reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Change {
    /// An axis has this value.
    Axis(u16, i32),
    /// A button is down, or not.
    Button(u16, bool),
    /// All that came before is one state.
    End,
    /// Events were lost: what follows, up to the whole state, says nothing.
    Lost,
}

/// Makes frames of events.
#[derive(Clone, Debug)]
pub(super) struct EvdevFrames {
    kind: Kind,
    ranges: BTreeMap<u16, AxisRange>,
    axes: BTreeMap<u16, i32>,
    fingers: Fingers,
    tip: Tip,
    leave: Leave,
    /// Whether the gesture that gives the device back was made and not asked for.
    is_left: bool,
    /// Buttons that are down.
    down: BTreeSet<u16>,
    /// Whether the device says which tool is in range.
    has_tools: bool,
    /// Whether something has touched the device since its state was taken anew: that is no contact before it lifts.
    is_stale: bool,
    /// After so long without an event nothing is sent, µs.
    silent_us: Option<u64>,
    /// When the device was heard last.
    heard_us: u64,
    sequence: u32,
    sent_us: u64,
}

/// What the frames carry.
#[derive(Clone, Debug)]
enum Kind {
    Channels(Vec<u16>),
    Contact { touching: Touching, has_slots: bool },
}

impl EvdevFrames {
    /// Of a described device, before its state is known.
    pub(super) fn new(source: &Source, wanted: &Evdev) -> Self {
        let kind = match source.measures {
            Measures::Contact(touching) => {
                let has_slots = touching.place.iter().all(|axis| *axis >= MT_FIRST);
                Kind::Contact { touching, has_slots }
            }
            Measures::Cells(..) | Measures::Wrench(..) => Kind::Channels(wanted.channels.clone()),
        };
        Self {
            kind,
            ranges: BTreeMap::new(),
            axes: BTreeMap::new(),
            fingers: Fingers::new(0),
            tip: Tip::default(),
            leave: Leave::default(),
            is_left: false,
            down: BTreeSet::new(),
            has_tools: false,
            is_stale: false,
            silent_us: wanted.silent_ms.map(|ms| u64::from(ms) * 1_000),
            heard_us: 0,
            sequence: 0,
            sent_us: 0,
        }
    }

    /// Takes the device's state anew: the buttons that are down, and the axes. What each finger did is not told, so whatever touches is
    /// no contact before it lifts.
    pub(super) fn set_state(&mut self, down: BTreeSet<u16>, ranges: BTreeMap<u16, AxisRange>) {
        self.axes = ranges.iter().map(|(axis, range)| (*axis, range.value)).collect();
        self.ranges = ranges;
        self.fingers = Fingers::new(value(&self.axes, MT_SLOT));
        (self.tip, self.leave) = (Tip::default(), Leave::default());
        self.has_tools |= down.range(TOOLS).next().is_some();
        self.is_stale = down.contains(&BTN_TOUCH);
        self.down = down;
    }

    /// The buttons that are down.
    pub(super) const fn down(&self) -> &BTreeSet<u16> {
        &self.down
    }

    /// Whether the kernel's state is another one than what was told, as far as the kernel says.
    pub(super) fn is_unlike(&self, down: &BTreeSet<u16>, ranges: &BTreeMap<u16, AxisRange>) -> bool {
        let is_other = |(axis, range): (&u16, &AxisRange)| match *axis {
            MT_SLOT => !self.fingers.is_at(range.value),
            axis => axis < MT_SLOT && value(&self.axes, axis) != range.value,
        };
        *down != self.down || ranges.iter().any(is_other)
    }

    /// Whether a button is down at `now_us`, or a tool in range.
    pub(super) fn is_in_use(&self, now_us: u64) -> bool {
        let is_quiet = now_us.saturating_sub(self.heard_us) >= LEFT_US;
        self.down.iter().any(|button| !(is_quiet && TOOLS.contains(button)))
    }

    /// Whether the gesture that gives the device back was made; tells it once.
    pub(super) const fn take_leave(&mut self) -> bool {
        std::mem::replace(&mut self.is_left, false)
    }

    /// Takes what the device reported by `now_us`, and appends a frame for each whole state to `out`.
    pub(super) fn take(&mut self, now_us: u64, change: Change, out: &mut Vec<u8>) {
        self.heard_us = now_us;
        match change {
            Change::Axis(axis, value) if axis >= MT_SLOT => self.fingers.take(axis, value),
            Change::Axis(axis, value) => {
                self.axes.insert(axis, value);
            }
            Change::Button(button, is_down) => self.press(button, is_down),
            Change::End => {
                self.settle();
                self.send(now_us, out);
            }
            Change::Lost => {}
        }
    }

    /// When [`Self::repeat`] is to be called if nothing comes before; `None` while the device's silence is no rest.
    pub(super) fn due_us(&self) -> Option<u64> {
        let due_us = self.sent_us + REPEAT_US;
        let is_silent = self.silent_us.is_some_and(|silent_us| due_us >= self.heard_us + silent_us);
        (!is_silent || self.is_at_rest()).then_some(due_us)
    }

    /// Whether all channels are 0: then nothing lies on the device, and nothing changes.
    fn is_at_rest(&self) -> bool {
        let Kind::Channels(channels) = &self.kind else { return false };
        channels.iter().all(|axis| value(&self.axes, *axis) == 0)
    }

    /// Appends the state to `out` once more, if that is due at `now_us`.
    pub(super) fn repeat(&mut self, now_us: u64, out: &mut Vec<u8>) {
        if self.due_us().is_some_and(|due_us| due_us <= now_us) {
            self.send(now_us, out);
        }
    }

    /// A button goes down or up.
    fn press(&mut self, button: u16, is_down: bool) {
        if is_down {
            self.down.insert(button);
        } else {
            self.down.remove(&button);
        }
        if button == BTN_TOUCH && !is_down {
            self.is_stale = false;
            // Fingers of before the state was taken are not known here.
            self.fingers.lift();
        }
        if TOOLS.contains(&button) {
            self.has_tools = true;
            self.is_stale &= self.is_near();
        }
    }

    /// Whether a tool is in range, as far as the device says so.
    fn is_near(&self) -> bool {
        !self.has_tools || self.down.range(TOOLS).next().is_some()
    }

    /// A state is whole.
    fn settle(&mut self) {
        match &self.kind {
            Kind::Contact { has_slots: true, .. } => self.fingers.settle(),
            Kind::Contact { touching: Touching { force: Some(axis), .. }, .. } => {
                let (pressure, range) = (value(&self.axes, *axis), self.range(*axis));
                let is_near = self.has_tools && self.is_near();
                self.tip.settle(is_near, pressure, &range, &self.axes, &self.ranges);
            }
            _ => {}
        }
    }

    /// What may be the gesture that gives the device back.
    fn hold(&self, touching: &Touching, has_slots: bool) -> Option<Hold> {
        let place = |axes: &BTreeMap<u16, i32>| {
            let [x, y] =
                touching.place.map(|axis| axes.get(&axis).map(|value| self.range(axis).share(*value)));
            Some([x?, y?])
        };
        if has_slots {
            let is_many = FOUR_AND_FIVE.iter().any(|button| self.down.contains(button));
            let count = self.fingers.down().count().max(if is_many { FINGERS } else { 0 });
            let places = self.fingers.down().filter_map(|(slot, axes)| Some((slot, place(axes)?)));
            return (count > 0).then(|| Hold::Fingers(count, places.collect()));
        }
        let is_held = SIDE_BUTTONS.iter().any(|button| self.down.contains(button));
        let is_in_air = self.is_near() && !self.down.contains(&BTN_TOUCH);
        if is_held && is_in_air { place(&self.axes).map(Hold::SideButton) } else { None }
    }

    fn send(&mut self, now_us: u64, out: &mut Vec<u8>) {
        self.sent_us = now_us.max(self.sent_us + FRAME_MIN_US);
        let message = match &self.kind {
            Kind::Channels(channels) => {
                let counts: Vec<i32> = channels.iter().map(|axis| value(&self.axes, *axis)).collect();
                ChannelSample::new(self.sequence, self.sent_us, &counts, Status::OK).map(Message::Channels)
            }
            Kind::Contact { touching, has_slots } => {
                let (touching, has_slots) = (*touching, *has_slots);
                let hold = self.hold(&touching, has_slots);
                self.is_left |= self.leave.see(now_us, hold);
                let touch = if has_slots { self.finger(&touching) } else { self.tool(&touching) };
                let touch = touch.filter(|_| !self.is_stale && !self.leave.is_begun());
                let untouched = ContactSample::untouched(self.sequence, self.sent_us);
                Some(Message::Contact(touch.map_or(untouched, |[x_um, y_um, fz_mn]| ContactSample {
                    place_um: [x_um, y_um],
                    force_mn: [0, 0, fz_mn],
                    place_deviation_um: self.place_deviation_um(&touching),
                    is_touched: true,
                    ..untouched
                })))
            }
        };
        self.sequence = self.sequence.wrapping_add(1);
        let Some(message) = message else { return };
        let mut frame = [0; ENCODED_MAX];
        let length = encode_message(&message, &mut frame);
        out.extend_from_slice(frame.get(..length).unwrap_or_default());
    }

    /// The contact of the finger that plays: x, y in µm, force in mN.
    fn finger(&self, touching: &Touching) -> Option<[i32; 3]> {
        let axes = self.fingers.playing()?;
        // What a slot was never told it has not.
        let [x, y] = touching.place.map(|axis| axes.get(&axis).copied());
        let force = touching.force.map(|axis| value(axes, axis));
        Some(self.contact(touching, [x?, y?], force))
    }

    /// The contact of a pen: none while it hovers or is out of range.
    fn tool(&self, touching: &Touching) -> Option<[i32; 3]> {
        let is_told = self.down.contains(&BTN_TOUCH) && self.is_near();
        let place = touching.place.map(|axis| value(&self.axes, axis));
        let force = touching.force.map(|axis| value(&self.axes, axis));
        let pressure = touching.force.zip(force);
        let is_down =
            is_told && pressure.is_none_or(|(axis, value)| self.tip.touches(value, &self.range(axis)));
        is_down.then(|| self.contact(touching, place, force))
    }

    fn contact(&self, touching: &Touching, place: [i32; 2], force: Option<i32>) -> [i32; 3] {
        let [x_axis, y_axis] = touching.place;
        let [x_share, y_share] = [(x_axis, place[0]), (y_axis, place[1])].map(|(axis, value)| {
            // From −1 at the one end of the range to 1 at the other.
            2.0 * self.range(axis).share(value) - 1.0
        });
        let fz_n = match (touching.force, force) {
            (Some(axis), Some(value)) => self.force_n(touching, axis, value),
            _ => touching.touch_n,
        };
        let um = |share: f64| (share * PLATE_RADIUS_MM * 1e3).round() as i32;
        // Devices count downwards.
        [um(x_share), um(-y_share), (fz_n * 1e3).round() as i32]
    }

    /// The range of an axis; none where it has not told any.
    fn range(&self, axis: u16) -> AxisRange {
        self.ranges.get(&axis).copied().unwrap_or_default()
    }

    /// The force for a profile. A scale that ends below half a firm press is a share, whatever it is said to weigh: it would never press.
    fn force_n(&self, touching: &Touching, axis: u16, value: i32) -> f64 {
        let range = self.tip.beyond_zero(&self.range(axis));
        let weight_n = |value: i32| f64::from(value.max(0)) / f64::from(range.resolution) * WEIGHT_N_PER_G;
        if range.resolution > 0 && weight_n(range.maximum) >= touching.full_n / 2.0 {
            weight_n(value) / touching.full_n * FULL_N
        } else {
            range.share(value) / touching.full_share * FULL_N
        }
    }

    /// Half a unit of the coarser axis, on the plate.
    fn place_deviation_um(&self, touching: &Touching) -> u16 {
        let unit_um = touching.place.map(|axis| {
            let AxisRange { minimum, maximum, .. } = self.range(axis);
            2e3 * PLATE_RADIUS_MM / (f64::from(maximum) - f64::from(minimum)).max(1.0)
        });
        (unit_um[0].max(unit_um[1]) / 2.0).clamp(1.0, 15_000.0) as u16
    }
}

fn value(axes: &BTreeMap<u16, i32>, axis: u16) -> i32 {
    axes.get(&axis).copied().unwrap_or_default()
}

#[cfg(test)]
mod histories;
#[cfg(test)]
mod tests;
