//! Whatever happened to a tablet or a touchpad: what is pressed is let go, and a sound stroke plays. Histories are drawn at random.
//!
//! The device is a model of what the kernel tells: it says what changes, and nothing twice. What the port does with a real device,
//! asking the kernel what is true where events were lost, is done here by the same rule.

use proptest::prelude::{
    Just, ProptestConfig, Strategy, any, prop, prop_assert, prop_assert_eq, prop_oneof, proptest,
};

use tactpad_core::pipeline::call::Call;
use tactpad_core::pipeline::contact::read::playing;
use tactpad_core::pipeline::mapping::read::check::{OutputChoice, read as read_profile};
use tactpad_core::pipeline::mapping::read::shipped as profiles;
use tactpad_core::pipeline::{NoProbe, Pipeline};
use tactpad_core::source::codes::MT_TRACKING_ID;
use tactpad_core::source::{Origin, read, shipped};
use tactpad_core::time::HostInstant;

use super::*;

const X: u16 = 0x00;
const Y: u16 = 0x01;
const PRESSURE: u16 = 0x18;
const DISTANCE: u16 = 0x19;
const MT_X: u16 = 0x35;
const MT_Y: u16 = 0x36;
const MT_TOOL_TYPE: u16 = 0x37;
const MT_PRESSURE: u16 = 0x3a;
const BTN_TOOL_PEN: u16 = 0x140;
const BTN_STYLUS: u16 = 0x14b;
const BTN_TOOL_QUADTAP: u16 = 0x14f;

/// The full scale of each axis.
const FULL: i32 = 1_000;

/// Fingers that the touchpad follows.
const SLOTS: usize = 5;

/// Nothing is held for longer after the last touch, ms: a tap may be told when it ends, and lasts a while.
const LET_GO_MS: u64 = 150;

/// The port asks for the true state so often while something is down, ms.
const CHECK_MS: u64 = 100;

/// What happens to a device, or to the bridge.
#[derive(Clone, Debug)]
enum Happening {
    Wait(u64),
    /// A tool comes, or leaves, whatever it did.
    Tool(u16, bool),
    /// The tip touches, or not, and tells this pressure at this place and height.
    Tip {
        is_down: bool,
        place: [i32; 2],
        pressure: i32,
        distance: i32,
    },
    SideButton(bool),
    /// A finger of this slot comes or moves, or is taken for a palm.
    Finger {
        slot: usize,
        place: [i32; 2],
        pressure: i32,
        is_palm: bool,
    },
    Lift(usize),
    /// So many of the next happenings are lost; then the kernel says so.
    Lose(u8),
    /// Another program takes it, or gives it back.
    Foreign(bool),
    /// It vanishes, and is back after so long under another name, as it is then.
    Replug(u64),
    Pause(bool),
}

/// A device, the machine that makes frames of it, and the pipeline behind it.
struct Play {
    source: Source,
    is_pen: bool,
    frames: EvdevFrames,
    pipeline: Pipeline,
    now_us: u64,
    /// What is true of the device: buttons, axes, and of each slot.
    down: BTreeSet<u16>,
    axes: BTreeMap<u16, i32>,
    slots: [BTreeMap<u16, i32>; SLOTS],
    slot: i32,
    next_id: i32,
    is_foreign: bool,
    losing: u8,
    checked_us: u64,
    is_suspected: bool,
    /// For how long nothing has touched, nor anything else happened, ms.
    untouched_ms: u64,
    edges: Vec<(String, i32)>,
}

impl Play {
    fn of(is_pen: bool) -> Self {
        let text = shipped::text(if is_pen { "tablet" } else { "touchpad" }).unwrap();
        let source = read::read(text).0.unwrap();
        let profile =
            read_profile(profiles::text("super-mario").unwrap(), OutputChoice::AsWritten).0.unwrap();
        let mut play = Self {
            frames: frames(&source),
            source,
            is_pen,
            pipeline: Pipeline::new(playing(text.as_bytes()).unwrap(), profile),
            now_us: 1_000_000,
            down: BTreeSet::new(),
            axes: BTreeMap::new(),
            slots: std::array::from_fn(|_| BTreeMap::from([(MT_TRACKING_ID, -1)])),
            slot: 0,
            next_id: 0,
            is_foreign: false,
            losing: 0,
            checked_us: 0,
            is_suspected: false,
            untouched_ms: 0,
            edges: Vec::new(),
        };
        play.synchronize();
        play
    }

    /// Whether a pen is in range.
    fn is_near(&self) -> bool {
        self.down.range(TOOLS).next().is_some()
    }

    fn is_touched(&self) -> bool {
        self.down.contains(&BTN_TOUCH)
    }

    /// The axes as the kernel has them.
    fn ranges(&self) -> BTreeMap<u16, AxisRange> {
        let axes: &[u16] =
            if self.is_pen { &[X, Y, PRESSURE, DISTANCE] } else { &[MT_SLOT, MT_X, MT_Y, MT_PRESSURE] };
        let range = |axis: u16| {
            let value =
                if axis == MT_SLOT { self.slot } else { self.axes.get(&axis).copied().unwrap_or_default() };
            (axis, AxisRange { value, minimum: 0, maximum: FULL, resolution: 0 })
        };
        axes.iter().copied().map(range).collect()
    }

    /// The state is taken from the kernel.
    fn synchronize(&mut self) {
        self.frames.set_state(self.down.clone(), self.ranges());
        self.take(&[Change::End]);
    }

    fn take(&mut self, changes: &[Change]) {
        let mut out = Vec::new();
        changes.iter().for_each(|change| self.frames.take(self.now_us, *change, &mut out));
        self.play(&out);
    }

    fn play(&mut self, bytes: &[u8]) {
        let mut call = Some(Call::Bytes(bytes));
        while let Some(next) = call {
            call = self.pipeline.apply(HostInstant::default().plus_us(self.now_us), next, &mut NoProbe);
            self.note();
        }
        if self.frames.take_leave() {
            self.call(Call::Pause);
        }
    }

    fn call(&mut self, call: Call<'_>) {
        let _ = self.pipeline.apply(HostInstant::default().plus_us(self.now_us), call, &mut NoProbe);
        self.note();
    }

    fn note(&mut self) {
        let events = self.pipeline.events().iter();
        self.edges.extend(events.map(|event| (event.code.to_string(), event.value)));
    }

    /// The device says what is new of this; the reader hears it, unless it does not.
    fn tell(&mut self, changes: &[Change]) {
        let mut told = Vec::new();
        self.untouched_ms = 0;
        for change in changes {
            let is_new = match *change {
                Change::Button(button, true) => self.down.insert(button),
                Change::Button(button, false) => self.down.remove(&button),
                Change::Axis(MT_SLOT, slot) => std::mem::replace(&mut self.slot, slot) != slot,
                Change::Axis(axis, value) => {
                    let slot = usize::try_from(self.slot).unwrap();
                    let axes = if axis >= MT_FIRST { &mut self.slots[slot] } else { &mut self.axes };
                    axes.insert(axis, value) != Some(value)
                }
                Change::End | Change::Lost => false,
            };
            told.extend(is_new.then_some(*change));
        }
        if self.losing > 0 {
            self.losing -= 1;
            if self.losing == 0 {
                self.synchronize();
            }
        } else if !self.is_foreign && !told.is_empty() {
            told.push(Change::End);
            self.is_suspected = false;
            self.take(&told);
        }
    }

    fn is_slot_down(&self, slot: usize) -> bool {
        self.slots[slot].get(&MT_TRACKING_ID).is_some_and(|id| *id >= 0)
    }

    /// Buttons that follow from how many fingers are down.
    fn count(&mut self, mut changes: Vec<Change>, count: usize) {
        changes.push(Change::Button(BTN_TOUCH, count > 0));
        changes.push(Change::Button(BTN_TOOL_QUADTAP, count == 4));
        self.tell(&changes);
    }

    fn happen(&mut self, happening: &Happening) {
        match *happening {
            Happening::Wait(ms) => self.pass(ms),
            Happening::Tool(tool, is_near) if self.is_pen => self.tell(&[Change::Button(tool, is_near)]),
            // Out of range nothing is told of a pen.
            Happening::Tip { is_down, place: [x, y], pressure, distance } if self.is_near() => self.tell(&[
                Change::Axis(X, x),
                Change::Axis(Y, y),
                Change::Axis(PRESSURE, pressure),
                Change::Axis(DISTANCE, distance),
                Change::Button(BTN_TOUCH, is_down),
            ]),
            Happening::SideButton(is_down) if self.is_pen => {
                self.tell(&[Change::Button(BTN_STYLUS, is_down)]);
            }
            Happening::Finger { slot, place: [x, y], pressure, is_palm } if !self.is_pen => {
                let mut changes = vec![Change::Axis(MT_SLOT, slot as i32)];
                if !self.is_slot_down(slot) {
                    self.next_id += 1;
                    changes.push(Change::Axis(MT_TRACKING_ID, self.next_id));
                }
                // What a slot is called while another program has it, the kernel does not say again, and nothing asks.
                let was_palm = self.slots[slot].get(&MT_TOOL_TYPE) == Some(&2);
                let is_palm = if self.is_foreign { was_palm } else { is_palm };
                let axes =
                    [(MT_TOOL_TYPE, 2 * i32::from(is_palm)), (MT_X, x), (MT_Y, y), (MT_PRESSURE, pressure)];
                changes.extend(axes.map(|(axis, value)| Change::Axis(axis, value)));
                let others = (0..SLOTS).filter(|other| *other != slot && self.is_slot_down(*other)).count();
                self.count(changes, others + 1);
            }
            Happening::Lift(slot) if !self.is_pen && self.is_slot_down(slot) => {
                let others = (0..SLOTS).filter(|other| *other != slot && self.is_slot_down(*other)).count();
                let changes = [(MT_SLOT, slot as i32), (MT_TRACKING_ID, -1)];
                self.count(changes.map(|(axis, value)| Change::Axis(axis, value)).into(), others);
            }
            Happening::Lose(count) if !self.is_foreign => self.losing = self.losing.max(count),
            Happening::Foreign(is_foreign) => {
                self.is_foreign = is_foreign;
                // That something was missed is known once it stays so.
                self.pass(if is_foreign { 0 } else { 2 * CHECK_MS + 50 });
            }
            Happening::Replug(ms) => {
                self.call(Call::Unplugged);
                self.now_us += 1_000 * ms;
                self.frames = frames(&self.source);
                (self.is_foreign, self.losing) = (false, 0);
                self.synchronize();
            }
            Happening::Pause(is_paused) => self.call(if is_paused { Call::Pause } else { Call::Resume }),
            _ => {}
        }
    }

    /// Time passes; what was due comes, and the true state is asked while something is down.
    fn pass(&mut self, ms: u64) {
        for _ in 0..ms {
            self.now_us += 1_000;
            self.untouched_ms = if self.is_touched() { 0 } else { self.untouched_ms + 1 };
            let is_due = self.checked_us + 1_000 * CHECK_MS <= self.now_us;
            if self.losing == 0 && is_due && !self.frames.down().is_empty() {
                self.checked_us = self.now_us;
                let is_unlike = self.frames.is_unlike(&self.down, &self.ranges());
                if is_unlike && self.is_suspected {
                    self.synchronize();
                }
                self.is_suspected = is_unlike;
            }
            if self.losing == 0 && self.frames.due_us().is_some_and(|due_us| due_us <= self.now_us) {
                let mut out = Vec::new();
                self.frames.repeat(self.now_us, &mut out);
                self.play(&out);
            }
            let now = HostInstant::default().plus_us(self.now_us);
            if self.pipeline.poll_timeout().is_some_and(|due| due <= now) {
                self.call(Call::Timeout);
            }
            let is_known = self.losing == 0 && self.untouched_ms > LET_GO_MS + 2 * CHECK_MS;
            assert!(!is_known || self.pipeline.held().next().is_none(), "held, and nothing touches");
        }
    }

    /// Everything is taken off the device and given back to the reader.
    fn end(&mut self) {
        if self.is_foreign {
            self.happen(&Happening::Foreign(false));
        }
        if std::mem::take(&mut self.losing) > 0 {
            self.synchronize();
        }
        if self.is_pen {
            let mut off: Vec<_> = self.down.iter().map(|button| Change::Button(*button, false)).collect();
            // A tip that tells pressure in the air is a worn one, and presses less with the same.
            off.push(Change::Axis(PRESSURE, 0));
            self.tell(&off);
        }
        (0..SLOTS).for_each(|slot| self.happen(&Happening::Lift(slot)));
        self.call(Call::Resume);
    }

    /// A stroke to the right.
    fn stroke(&mut self, is_down: bool) {
        let (place, pressure) = ([901, 501], if is_down { 201 } else { 0 });
        if self.is_pen {
            self.happen(&Happening::Tool(BTN_TOOL_PEN, true));
            self.happen(&Happening::Tip { is_down, place, pressure, distance: 0 });
        } else if is_down {
            self.happen(&Happening::Finger { slot: 0, place, pressure, is_palm: false });
        } else {
            self.happen(&Happening::Lift(0));
        }
    }
}

fn frames(source: &Source) -> EvdevFrames {
    let Origin::Evdev(wanted) = &source.origin else { panic!("{source:?}") };
    EvdevFrames::new(source, wanted)
}

fn happenings() -> impl Strategy<Value = Happening> {
    // What the kernel told once it does not say again: the stroke at the end is nowhere of these.
    let place = || {
        prop_oneof![(0..=FULL / 2, 0..=FULL / 2), Just((10, 15)), Just((450, 250))]
            .prop_map(|(x, y)| [2 * x, 2 * y])
    };
    let pressure = || prop_oneof![Just(0), (0..=FULL / 2).prop_map(|half| 2 * half), Just(100)];
    let tip = (any::<bool>(), place(), pressure(), prop_oneof![Just(0), 0..=FULL]);
    let finger = (0..SLOTS, place(), pressure(), prop::bool::weighted(0.15));
    prop_oneof![
        6 => prop_oneof![0..20_u64, 0..300_u64, 0..2_500_u64].prop_map(Happening::Wait),
        3 => (TOOLS, any::<bool>()).prop_map(|(tool, is_near)| Happening::Tool(tool, is_near)),
        5 => tip.prop_map(|(is_down, place, pressure, distance)| {
            Happening::Tip { is_down, place, pressure, distance }
        }),
        1 => any::<bool>().prop_map(Happening::SideButton),
        5 => finger.prop_map(|(slot, place, pressure, is_palm)| {
            Happening::Finger { slot, place, pressure, is_palm }
        }),
        3 => (0..SLOTS).prop_map(Happening::Lift),
        1 => (1..6_u8).prop_map(Happening::Lose),
        1 => any::<bool>().prop_map(Happening::Foreign),
        1 => (1..2_000_u64).prop_map(Happening::Replug),
        1 => any::<bool>().prop_map(Happening::Pause),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn whatever_happened_nothing_is_held_and_a_sound_stroke_plays(
        is_pen in any::<bool>(),
        history in prop::collection::vec(happenings(), 0..60),
    ) {
        let mut play = Play::of(is_pen);
        history.iter().for_each(|happening| play.happen(happening));
        play.end();
        play.pass(LET_GO_MS + 2 * CHECK_MS);
        prop_assert!(play.pipeline.held().next().is_none(), "something stays down");
        let before = play.edges.len();
        play.stroke(true);
        play.pass(150);
        prop_assert!(
            play.edges[before..].iter().any(|(code, value)| code == "ABS_HAT0X" && *value == 1),
            "it does not play: {:?}",
            &play.edges[before..]
        );
        play.stroke(false);
        play.pass(LET_GO_MS);
        prop_assert!(play.pipeline.held().next().is_none());
        // Every down has its up, one by one.
        let mut held = BTreeMap::new();
        for (code, value) in &play.edges {
            let before = held.insert(code.clone(), *value).unwrap_or(0);
            prop_assert!(before == 0 || *value == 0 || code.starts_with("ABS_"), "{code} is pressed twice");
        }
        prop_assert_eq!(held.values().filter(|value| **value != 0).count(), 0);
    }
}
