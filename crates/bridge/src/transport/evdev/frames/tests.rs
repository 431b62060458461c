//! Events of devices, and the contacts that they mean.

use firmware_proto::link::MessageReceiver;
use tactpad_core::source::codes::MT_TRACKING_ID;
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
const MT_TOOL_TYPE: u16 = 0x37;
const MT_PRESSURE: u16 = 0x3a;
const DISTANCE: u16 = 0x19;
const BTN_STYLUS: u16 = 0x14b;
const BTN_TOOL_QUADTAP: u16 = 0x14f;

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
        let touched = [Button(tool, true), Button(BTN_TOUCH, true), Axis(X, 20_000), Axis(Y, 12_500), End];
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
    Device::of("touchpad", &[(MT_X, range(0, 1_000, 10)), (MT_Y, range(0, 600, 10)), (MT_PRESSURE, pressure)])
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

#[test]
fn a_palm_begins_no_contact_and_a_finger_that_turns_out_to_be_one_ends_it() {
    let mut pad = touchpad(0);
    let palm = |slot, id| {
        let [at, came, x, y, force, end] = finger(slot, id, 100);
        [at, came, Axis(MT_TOOL_TYPE, 2), x, y, force, end]
    };
    assert_eq!(pad.contact(&palm(0, 1)), None);
    assert!(pad.contact(&finger(1, 2, 500)).is_some(), "a finger plays beside it");
    assert_eq!(pad.contact(&[Axis(MT_TOOL_TYPE, 2), End]), None, "that turned out to be one, too");
    assert_eq!(pad.contact(&[Axis(MT_TOOL_TYPE, 0), End]), None, "what was a palm stays one");
    assert!(pad.contact(&finger(2, 3, 500)).is_some(), "two palms are nobody");
    assert_eq!(pad.contact(&[Axis(MT_SLOT, 2), Axis(MT_TRACKING_ID, -1), End]), None);
    // The kernel says what changes: a slot that was a palm is one again without a word, unless it says that it is none.
    assert_eq!(pad.contact(&[Axis(MT_SLOT, 0), Axis(MT_TRACKING_ID, -1), End]), None);
    assert_eq!(pad.contact(&finger(0, 4, 500)), None);
    assert_eq!(pad.contact(&[Axis(MT_TRACKING_ID, -1), End]), None);
    let [at, came, x, y, force, end] = finger(0, 5, 500);
    assert!(pad.contact(&[at, came, Axis(MT_TOOL_TYPE, 0), x, y, force, end]).is_some());
}

#[test]
fn a_worn_tip_presses_from_what_it_tells_in_the_air() {
    let pen = || {
        Device::of(
            "tablet",
            &[
                (X, range(0, 1_000, 10)),
                (Y, range(0, 1_000, 10)),
                (PRESSURE, range(0, 1_000, 0)),
                (DISTANCE, range(0, 60, 0)),
            ],
        )
    };
    let comes = |distance, pressure| {
        [
            Button(BTN_TOOL_PEN, true),
            Axis(DISTANCE, distance),
            Button(BTN_TOUCH, true),
            Axis(PRESSURE, pressure),
            End,
        ]
    };
    let mut worn = pen();
    assert_eq!(worn.contact(&comes(50, 100)), None, "it says that it touches, in the air");
    assert_eq!(worn.contact(&[Axis(DISTANCE, 10), Axis(PRESSURE, 105), End]), None);
    // 0.4 of what is left of the scale is half of 0.8.
    let pressed = worn.contact(&[Axis(DISTANCE, 0), Axis(PRESSURE, 460), End]);
    assert_eq!(pressed.map(|(_, force_mn)| force_mn), Some(2_500));
    assert_eq!(worn.contact(&[Axis(PRESSURE, 100), End]), None);
    assert_eq!(
        worn.contact(&[Button(BTN_TOUCH, false), Button(BTN_TOOL_PEN, false), Axis(PRESSURE, 0), End]),
        None
    );
    // One that comes down at once, and one that tells too much to be worn.
    assert!(pen().contact(&comes(5, 100)).is_some());
    assert!(pen().contact(&comes(50, 300)).is_some());
}

#[test]
fn a_scale_that_ends_below_a_press_is_a_share() {
    // 40 units per gram: the whole scale would be 0.06 N.
    let (_, force_mn) = touchpad(40).contact(&finger(0, 1, 500)).unwrap();
    assert_eq!(force_mn, 5_000);
}

/// Whether the gesture is made within so many milliseconds of nothing else.
fn leaves_within(device: &mut Device, ms: u64) -> bool {
    (0..1_000 * ms / (1_000 + REPEAT_US)).any(|_| {
        device.after(&[]);
        device.frames.take_leave()
    })
}

#[test]
fn four_fingers_that_come_together_and_lie_still_leave() {
    let mut pad = touchpad(0);
    let four = |pad: &mut Device, apart_ms: u64| {
        for k in 0..4 {
            pad.now_us += 1_000 * apart_ms;
            pad.contact(&finger(k, k + 1, 200 * k + 50));
        }
    };
    let lift = |pad: &mut Device| {
        (0..4).for_each(|k| {
            pad.contact(&[Axis(MT_SLOT, k), Axis(MT_TRACKING_ID, -1), End]);
        });
    };
    four(&mut pad, 50);
    assert_eq!(pad.contact(&[]), None, "they are no press");
    assert!(!leaves_within(&mut pad, 1_400) && leaves_within(&mut pad, 200));
    assert!(!leaves_within(&mut pad, 5_000), "once");
    assert_eq!(pad.contact(&[]), None, "nor afterwards");
    lift(&mut pad);
    // One plays while others come to rest.
    four(&mut pad, 300);
    assert!(pad.contact(&[]).is_some() && !leaves_within(&mut pad, 5_000));
    lift(&mut pad);
    four(&mut pad, 50);
    assert!(!leaves_within(&mut pad, 1_000));
    pad.contact(&[Axis(MT_SLOT, 2), Axis(MT_X, 600), End]);
    assert!(!leaves_within(&mut pad, 5_000), "one moved");
    lift(&mut pad);
    // A pad that knows the places of two.
    let two = [finger(0, 8, 200), finger(1, 9, 700)].concat();
    pad.contact(&[&two[..], &[Button(BTN_TOOL_QUADTAP, true), Button(BTN_TOUCH, true), End]].concat());
    assert!(leaves_within(&mut pad, 1_600));
}

#[test]
fn a_side_button_held_in_the_air_above_a_corner_leaves() {
    let at = |x, y| [Axis(X, x), Axis(Y, y), Button(BTN_TOOL_PEN, true), Button(BTN_STYLUS, true), End];
    let off = [Button(BTN_STYLUS, false), Button(BTN_TOUCH, false), End];
    let mut pen = tablet();
    pen.contact(&at(1_000, 24_000));
    assert!(!leaves_within(&mut pen, 1_400) && leaves_within(&mut pen, 200));
    assert!(!leaves_within(&mut pen, 5_000), "once");
    pen.contact(&off);
    pen.contact(&at(20_000, 12_000));
    assert!(!leaves_within(&mut pen, 5_000), "not in a corner");
    pen.contact(&off);
    pen.contact(&at(1_000, 1_000));
    pen.contact(&[Button(BTN_TOUCH, true), Axis(PRESSURE, 900), End]);
    assert!(!leaves_within(&mut pen, 5_000), "it touches");
    pen.contact(&off);
    pen.contact(&at(1_000, 1_000));
    assert!(!leaves_within(&mut pen, 1_000));
    pen.contact(&[Axis(X, 5_000), End]);
    assert!(!leaves_within(&mut pen, 5_000), "it moved");
}
