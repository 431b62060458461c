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
use tactpad_core::source::codes::{BTN_TOUCH, MT_FIRST, MT_SLOT, MT_TRACKING_ID};
use tactpad_core::source::{Evdev, FULL_N, Measures, Source, Touching};

use crate::transport::pacing::{FRAME_MIN_US, REPEAT_US};

/// Fingers of a touchpad that are followed.
const SLOTS: usize = 16;

/// Pen, eraser, brush, pencil and airbrush.
const TOOLS: RangeInclusive<u16> = 0x140..=0x144;

/// The range of an axis, by the kernel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct AxisRange {
    pub(super) value: i32,
    pub(super) minimum: i32,
    pub(super) maximum: i32,
    /// Units per millimetre; of a pressure per gram; 0 where it is not told.
    pub(super) resolution: i32,
}

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

/// One finger of a touchpad.
#[derive(Clone, Debug, Default)]
struct Slot {
    is_down: bool,
    axes: BTreeMap<u16, i32>,
}

/// Makes frames of events.
#[derive(Clone, Debug)]
pub(super) struct EvdevFrames {
    kind: Kind,
    ranges: BTreeMap<u16, AxisRange>,
    axes: BTreeMap<u16, i32>,
    slots: Vec<Slot>,
    slot: usize,
    /// The finger that plays.
    playing: Option<usize>,
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
            slots: vec![Slot::default(); SLOTS],
            slot: 0,
            playing: None,
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
        self.slots.fill(Slot::default());
        // The kernel does not say again which slot it is at.
        self.slot = usize::try_from(value(&self.axes, MT_SLOT)).unwrap_or(SLOTS);
        self.playing = None;
        self.has_tools |= down.range(TOOLS).next().is_some();
        self.is_stale = down.contains(&BTN_TOUCH);
        self.down = down;
    }

    /// The buttons that are down.
    pub(super) const fn down(&self) -> &BTreeSet<u16> {
        &self.down
    }

    /// Whether a button is down, or a tool in range.
    pub(super) fn is_anything_down(&self) -> bool {
        !self.down.is_empty()
    }

    /// Takes what the device reported by `now_us`, and appends a frame for each whole state to `out`.
    pub(super) fn take(&mut self, now_us: u64, change: Change, out: &mut Vec<u8>) {
        self.heard_us = now_us;
        match change {
            Change::Axis(MT_SLOT, value) => self.slot = usize::try_from(value).unwrap_or(SLOTS),
            Change::Axis(MT_TRACKING_ID, value) => self.track(value >= 0),
            Change::Axis(axis, value) if axis >= MT_FIRST => {
                if let Some(slot) = self.slots.get_mut(self.slot) {
                    slot.axes.insert(axis, value);
                }
            }
            Change::Axis(axis, value) => {
                self.axes.insert(axis, value);
            }
            Change::Button(button, is_down) => self.press(button, is_down),
            Change::End => self.send(now_us, out),
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
            // Fingers of before the state was taken have no slots here.
            self.slots.iter_mut().for_each(|slot| slot.is_down = false);
            self.playing = None;
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

    /// A finger comes or goes. The one that comes to an untouched pad plays; others do nothing, also when it has gone.
    fn track(&mut self, is_down: bool) {
        let is_first = is_down && self.slots.iter().all(|slot| !slot.is_down);
        if let Some(slot) = self.slots.get_mut(self.slot) {
            slot.is_down = is_down;
        }
        if is_first {
            self.playing = Some(self.slot);
        } else if !is_down && self.playing == Some(self.slot) {
            self.playing = None;
        }
    }

    fn send(&mut self, now_us: u64, out: &mut Vec<u8>) {
        self.sent_us = now_us.max(self.sent_us + FRAME_MIN_US);
        let message = match &self.kind {
            Kind::Channels(channels) => {
                let counts: Vec<i32> = channels.iter().map(|axis| value(&self.axes, *axis)).collect();
                ChannelSample::new(self.sequence, self.sent_us, &counts, Status::OK).map(Message::Channels)
            }
            Kind::Contact { touching, has_slots } => {
                let touch = if *has_slots { self.finger(touching) } else { self.tool(touching) };
                let touch = touch.filter(|_| !self.is_stale);
                let untouched = ContactSample::untouched(self.sequence, self.sent_us);
                Some(Message::Contact(touch.map_or(untouched, |[x_um, y_um, fz_mn]| ContactSample {
                    place_um: [x_um, y_um],
                    force_mn: [0, 0, fz_mn],
                    place_deviation_um: self.place_deviation_um(touching),
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
        let slot = self.slots.get(self.playing?)?;
        // What a slot was never told it has not.
        let [x, y] = touching.place.map(|axis| slot.axes.get(&axis).copied());
        let force = touching.force.map(|axis| value(&slot.axes, axis));
        Some(self.contact(touching, [x?, y?], force))
    }

    /// The contact of a pen: none while it hovers or is out of range.
    fn tool(&self, touching: &Touching) -> Option<[i32; 3]> {
        let is_down = self.down.contains(&BTN_TOUCH) && self.is_near();
        let place = touching.place.map(|axis| value(&self.axes, axis));
        let force = touching.force.map(|axis| value(&self.axes, axis));
        is_down.then(|| self.contact(touching, place, force))
    }

    fn contact(&self, touching: &Touching, place: [i32; 2], force: Option<i32>) -> [i32; 3] {
        let [x_axis, y_axis] = touching.place;
        let [x_share, y_share] = [(x_axis, place[0]), (y_axis, place[1])].map(|(axis, value)| {
            // From −1 at the one end of the range to 1 at the other.
            2.0 * self.share(axis, value) - 1.0
        });
        let fz_n = match (touching.force, force) {
            (Some(axis), Some(value)) => self.force_n(touching, axis, value),
            _ => touching.touch_n,
        };
        let um = |share: f64| (share * PLATE_RADIUS_MM * 1e3).round() as i32;
        // Devices count downwards.
        [um(x_share), um(-y_share), (fz_n * 1e3).round() as i32]
    }

    /// The share of an axis' range at which a value is.
    fn share(&self, axis: u16, value: i32) -> f64 {
        let AxisRange { minimum, maximum, .. } = self.ranges.get(&axis).copied().unwrap_or_default();
        let range = f64::from(maximum) - f64::from(minimum);
        if range > 0.0 { ((f64::from(value) - f64::from(minimum)) / range).clamp(0.0, 1.0) } else { 0.5 }
    }

    fn force_n(&self, touching: &Touching, axis: u16, value: i32) -> f64 {
        let resolution = self.ranges.get(&axis).map_or(0, |range| range.resolution);
        if resolution > 0 {
            let n = f64::from(value.max(0)) / f64::from(resolution) * WEIGHT_N_PER_G;
            n / touching.full_n * FULL_N
        } else {
            self.share(axis, value) / touching.full_share * FULL_N
        }
    }

    /// Half a unit of the coarser axis, on the plate.
    fn place_deviation_um(&self, touching: &Touching) -> u16 {
        let unit_um = touching.place.map(|axis| {
            let AxisRange { minimum, maximum, .. } = self.ranges.get(&axis).copied().unwrap_or_default();
            2e3 * PLATE_RADIUS_MM / (f64::from(maximum) - f64::from(minimum)).max(1.0)
        });
        (unit_um[0].max(unit_um[1]) / 2.0).clamp(1.0, 15_000.0) as u16
    }
}

fn value(axes: &BTreeMap<u16, i32>, axis: u16) -> i32 {
    axes.get(&axis).copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use firmware_proto::link::MessageReceiver;
    use tactpad_core::source::{Origin, read, shipped};

    use super::Change::{Axis, Button, End};
    use super::*;

    const fn range(minimum: i32, maximum: i32, resolution: i32) -> AxisRange {
        AxisRange { value: 0, minimum, maximum, resolution }
    }

    /// A device of a shipped description.
    struct Device {
        frames: EvdevFrames,
        now_us: u64,
    }

    impl Device {
        fn of(name: &str, ranges: &[(u16, AxisRange)]) -> Self {
            let source = read::read(shipped::text(name).unwrap()).0.unwrap();
            let Origin::Evdev(wanted) = &source.origin else { panic!("{source:?}") };
            let mut frames = EvdevFrames::new(&source, wanted);
            frames.set_state(BTreeSet::new(), ranges.iter().copied().collect());
            Self { frames, now_us: 0 }
        }

        /// What the last frame says after these changes, a millisecond later.
        fn after(&mut self, changes: &[Change]) -> Message {
            self.now_us += 1_000;
            let mut out = Vec::new();
            changes.iter().for_each(|change| self.frames.take(self.now_us, *change, &mut out));
            if out.is_empty() {
                self.now_us += REPEAT_US;
                self.frames.repeat(self.now_us, &mut out);
            }
            let mut receiver = MessageReceiver::new();
            out.iter().filter_map(|byte| receiver.push(*byte)).last().unwrap().unwrap()
        }

        /// Place in µm and force in mN; nothing while nothing touches it.
        fn contact(&mut self, changes: &[Change]) -> Option<([i32; 2], i32)> {
            let Message::Contact(contact) = self.after(changes) else { panic!("no contact") };
            contact.is_touched.then_some((contact.place_um, contact.force_mn[2]))
        }
    }

    const BTN_TOOL_PEN: u16 = 0x140;
    const BTN_TOOL_RUBBER: u16 = 0x141;
    const X: u16 = 0x00;
    const Y: u16 = 0x01;
    const PRESSURE: u16 = 0x18;
    const MT_X: u16 = 0x35;
    const MT_Y: u16 = 0x36;
    const MT_PRESSURE: u16 = 0x3a;

    fn tablet() -> Device {
        Device::of(
            "tablet",
            &[(X, range(0, 40_000, 157)), (Y, range(0, 25_000, 157)), (PRESSURE, range(0, 8_191, 0))],
        )
    }

    #[test]
    fn a_pen_presses_only_while_it_touches() {
        let mut pen = tablet();
        assert_eq!(pen.contact(&[]), None, "it has time before it says anything");
        let hover = [Button(BTN_TOOL_PEN, true), Axis(X, 30_000), Axis(Y, 6_250), Axis(PRESSURE, 0), End];
        assert_eq!(pen.contact(&hover), None, "it hovers");
        let touched = pen.contact(&[Button(BTN_TOUCH, true), Axis(PRESSURE, 3_276), End]);
        // Three quarters to the right, three quarters up; half of 0.8 of the full scale.
        let wanted = ([15_000, 15_000], 2_500);
        let (place_um, force_mn) = touched.unwrap();
        assert_eq!(place_um, wanted.0);
        assert!((force_mn - wanted.1).abs() <= 1, "{force_mn}");
        assert_eq!(pen.contact(&[]), touched, "held still it goes on");
        assert_eq!(pen.contact(&[Button(BTN_TOUCH, false), Axis(PRESSURE, 0), End]), None);
        // It leaves the range without a lift.
        assert!(pen.contact(&[Button(BTN_TOUCH, true), Axis(PRESSURE, 900), End]).is_some());
        assert_eq!(pen.contact(&[Button(BTN_TOOL_PEN, false), End]), None);
    }

    #[test]
    fn each_tool_presses_like_the_tip_also_after_another() {
        let mut pen = tablet();
        for tool in TOOLS.chain([BTN_TOOL_PEN]) {
            let touched =
                [Button(tool, true), Button(BTN_TOUCH, true), Axis(X, 20_000), Axis(Y, 12_500), End];
            assert_eq!(pen.contact(&touched).map(|(place_um, _)| place_um), Some([0, 0]), "{tool:x}");
            assert_eq!(pen.contact(&[Button(BTN_TOUCH, false), Button(tool, false), End]), None, "{tool:x}");
        }
        // The pen leaves while the eraser is there.
        let both = [Button(BTN_TOOL_PEN, true), Button(BTN_TOOL_RUBBER, true), Button(BTN_TOUCH, true), End];
        assert!(pen.contact(&both).is_some());
        assert!(pen.contact(&[Button(BTN_TOOL_PEN, false), End]).is_some());
    }

    #[test]
    fn what_touches_when_the_state_is_taken_is_no_contact_before_it_lifts() {
        let mut pen = tablet();
        let ranges = pen.frames.ranges.clone();
        let hover = [Button(BTN_TOOL_PEN, true), End];
        assert_eq!(pen.contact(&hover), None);
        assert!(pen.contact(&[Button(BTN_TOUCH, true), End]).is_some());
        pen.frames.set_state([BTN_TOOL_PEN, BTN_TOUCH].into(), ranges.clone());
        assert_eq!(pen.contact(&[Axis(X, 20_000), End]), None);
        assert_eq!(pen.contact(&[Button(BTN_TOUCH, false), End]), None);
        assert!(pen.contact(&[Button(BTN_TOUCH, true), End]).is_some());
        pen.frames.set_state(BTreeSet::new(), ranges);
        assert_eq!(pen.contact(&[]), None, "it lifted, and that was lost");
    }

    #[test]
    fn a_second_finger_does_nothing_while_an_unknown_one_touches() {
        let mut pad = touchpad(0);
        let ranges = pad.frames.ranges.clone();
        assert!(pad.contact(&[&[Button(BTN_TOUCH, true)], &finger(0, 1, 500)[..]].concat()).is_some());
        pad.frames.set_state([BTN_TOUCH].into(), ranges);
        assert_eq!(pad.contact(&finger(1, 2, 300)), None);
        assert_eq!(pad.contact(&[Axis(MT_SLOT, 0), Axis(MT_TRACKING_ID, -1), End]), None);
        let lifted = [Axis(MT_SLOT, 1), Axis(MT_TRACKING_ID, -1), Button(BTN_TOUCH, false), End];
        assert_eq!(pad.contact(&lifted), None);
        assert!(pad.contact(&finger(1, 3, 300)).is_some());
    }

    fn touchpad(resolution: i32) -> Device {
        let pressure = range(0, 255, resolution);
        Device::of(
            "touchpad",
            &[(MT_X, range(0, 1_000, 10)), (MT_Y, range(0, 600, 10)), (MT_PRESSURE, pressure)],
        )
    }

    fn finger(slot: i32, id: i32, x: i32) -> [Change; 6] {
        [
            Axis(MT_SLOT, slot),
            Axis(MT_TRACKING_ID, id),
            Axis(MT_X, x),
            Axis(MT_Y, 300),
            Axis(MT_PRESSURE, 153),
            End,
        ]
    }

    #[test]
    fn the_first_finger_plays_and_others_do_nothing() {
        let mut pad = touchpad(0);
        // Full share is 0.6 of the scale.
        assert_eq!(pad.contact(&finger(0, 7, 750)), Some(([15_000, 0], 5_000)));
        assert_eq!(pad.contact(&finger(1, 8, 100)), Some(([15_000, 0], 5_000)), "a second finger");
        assert_eq!(
            pad.contact(&[Axis(MT_SLOT, 0), Axis(MT_TRACKING_ID, -1), End]),
            None,
            "the first one has gone"
        );
        assert_eq!(pad.contact(&[Axis(MT_SLOT, 1), Axis(MT_X, 200), End]), None, "the second is none");
        assert_eq!(pad.contact(&[Axis(MT_TRACKING_ID, -1), End]), None);
        assert!(pad.contact(&finger(1, 9, 500)).is_some(), "any first finger plays");
    }

    #[test]
    fn the_slot_at_the_opening_is_the_kernels() {
        let at_two = AxisRange { value: 2, ..range(0, 4, 0) };
        let ranges = [(MT_SLOT, at_two), (MT_X, range(0, 1_000, 10)), (MT_Y, range(0, 600, 10))];
        let mut pad = Device::of("touchpad", &ranges);
        let touched = [Axis(MT_TRACKING_ID, 1), Axis(MT_X, 750), Axis(MT_Y, 300), End];
        assert!(pad.contact(&touched).is_some());
        assert!(
            pad.contact(&finger(0, 2, 100)).is_some_and(|([x_um, _], _)| x_um == 15_000),
            "it goes on playing"
        );
        assert_eq!(pad.contact(&[Axis(MT_SLOT, 2), Axis(MT_TRACKING_ID, -1), End]), None);
    }

    #[test]
    fn pressure_with_a_unit_is_newtons() {
        // One unit per gram: 153 g are 1.5 N, and 3 N are 5 N for a profile.
        let (_, force_mn) = touchpad(1).contact(&finger(0, 1, 500)).unwrap();
        assert_eq!(force_mn, 2_501);
    }

    #[test]
    fn fingers_beyond_what_is_followed_do_nothing() {
        let mut pad = touchpad(0);
        for slot in [-1, 16, i32::MAX, i32::MIN] {
            assert_eq!(pad.contact(&finger(slot, 1, 500)), None, "{slot}");
        }
        assert!(pad.contact(&finger(0, 1, 500)).is_some());
    }

    #[test]
    fn a_board_that_stalls_under_a_load_repeats_nothing() {
        let ranges: Vec<_> = [0x12, 0x10, 0x13, 0x11].map(|axis| (axis, range(0, 65_535, 0))).into();
        let mut board = Device::of("balance-board", &ranges);
        let frames = &mut board.frames;
        let mut out = Vec::new();
        let mut repeats = |frames: &mut EvdevFrames, from_us: u64| {
            let mut now_us = from_us;
            while let Some(due_us) = frames.due_us().filter(|due_us| *due_us < from_us + 5_000_000) {
                now_us = due_us;
                frames.repeat(now_us, &mut out);
            }
            now_us - from_us
        };
        assert!(repeats(frames, 0) > 4_900_000, "nobody is on it");
        frames.take(5_000_000, Axis(0x12, 100), &mut Vec::new());
        frames.take(5_000_000, End, &mut Vec::new());
        assert_eq!(repeats(frames, 5_000_000), 995_000);
        frames.take(9_000_000, End, &mut Vec::new());
        assert_eq!(repeats(frames, 9_000_000), 995_000, "it is heard again");
    }

    #[test]
    fn a_board_sends_its_cells_as_channels() {
        let axes = [0x12, 0x10, 0x13, 0x11];
        let ranges: Vec<_> = axes.iter().map(|axis| (*axis, range(0, 65_535, 0))).collect();
        let mut board = Device::of("balance-board", &ranges);
        let changes: Vec<_> =
            [(0x12, 100), (0x10, 200), (0x13, 300), (0x11, 400)].map(|(a, v)| Axis(a, v)).into();
        let Message::Channels(sample) = board.after(&[&changes[..], &[End]].concat()) else { panic!() };
        assert_eq!(sample.counts(), [100, 200, 300, 400]);
    }
}
