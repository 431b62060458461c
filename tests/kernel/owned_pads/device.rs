//! Devices of software with the axes and ranges of tablets and touchpads, and strokes of ours on them.

use std::path::PathBuf;

use evdev::uinput::VirtualDevice;
use evdev::{
    AbsInfo, AbsoluteAxisCode, AttributeSet, BusType, EventType, InputEvent, InputId, KeyCode, PropType,
    UinputAbsSetup,
};

pub(super) const MT: [AbsoluteAxisCode; 3] = [
    AbsoluteAxisCode::ABS_MT_POSITION_X,
    AbsoluteAxisCode::ABS_MT_POSITION_Y,
    AbsoluteAxisCode::ABS_MT_PRESSURE,
];

pub(super) const PEN: [AbsoluteAxisCode; 3] =
    [AbsoluteAxisCode::ABS_X, AbsoluteAxisCode::ABS_Y, AbsoluteAxisCode::ABS_PRESSURE];

/// What a device tells of itself.
#[derive(Clone, Copy)]
pub(crate) struct Shape {
    pub(super) name: &'static str,
    /// The description that must fit.
    pub(crate) source: &'static str,
    /// Minimum, maximum and resolution of x, y and the pressure.
    pub(super) ranges: [(i32, i32, i32); 3],
    /// The pressure that is 1 N for a profile.
    pub(super) one_n: i32,
}

/// Axes as such devices have them: two tablets, two touchpads, one of which says what its numbers weigh, and a trackpad.
pub(crate) const SHAPES: [Shape; 5] = [
    Shape {
        name: "Tablet 250 mm Pen",
        source: "tablet",
        ranges: [(0, 40_000, 157), (0, 25_000, 157), (0, 8_191, 0)],
        one_n: 1_311,
    },
    Shape {
        name: "Tablet 224 mm Pen",
        source: "tablet",
        ranges: [(0, 44_704, 200), (0, 27_940, 200), (0, 2_047, 0)],
        one_n: 328,
    },
    Shape {
        name: "Touchpad",
        source: "touchpad",
        ranges: [(1_024, 5_112, 42), (2_024, 4_832, 42), (0, 255, 0)],
        one_n: 31,
    },
    Shape {
        name: "Haptic Touchpad",
        source: "touchpad",
        ranges: [(0, 1_416, 12), (0, 888, 12), (0, 4_096, 10)],
        one_n: 612,
    },
    Shape {
        name: "Magic Trackpad",
        source: "magic-trackpad",
        ranges: [(-3_678, 3_934, 48), (-2_478, 2_587, 45), (0, 253, 0)],
        one_n: 30,
    },
];

/// A device of software.
pub(crate) struct Device {
    pub(crate) shape: Shape,
    device: VirtualDevice,
    pub(super) node: PathBuf,
    tracking_id: i32,
}

/// The node of a device that was made just now.
pub(crate) fn node(device: &mut VirtualDevice) -> PathBuf {
    let mut nodes = device.enumerate_dev_nodes_blocking().expect("its nodes");
    let is_event = |path: &PathBuf| path.to_string_lossy().contains("/event");
    nodes.find_map(|node| node.ok().filter(is_event)).expect("its event node")
}

impl Device {
    pub(crate) fn plug_in(shape: Shape) -> Self {
        let is_pen = shape.source == "tablet";
        let axes = if is_pen { PEN } else { MT };
        let mut keys = AttributeSet::<KeyCode>::new();
        keys.insert(KeyCode::BTN_TOUCH);
        keys.insert(if is_pen { KeyCode::BTN_TOOL_PEN } else { KeyCode::BTN_TOOL_FINGER });
        keys.insert(if is_pen { KeyCode::BTN_STYLUS } else { KeyCode::BTN_LEFT });
        let mut properties = AttributeSet::<PropType>::new();
        properties.insert(PropType::POINTER);
        let built = || {
            let mut builder = VirtualDevice::builder()?
                .name(shape.name)
                .input_id(InputId::new(BusType::BUS_USB, 0x1234, 0x5678, 1))
                .with_keys(&keys)?
                .with_properties(&properties)?;
            for (axis, (minimum, maximum, resolution)) in axes.into_iter().zip(shape.ranges) {
                let info = AbsInfo::new(0, minimum, maximum, 0, 0, resolution);
                builder = builder.with_absolute_axis(&UinputAbsSetup::new(axis, info))?;
            }
            if !is_pen {
                for (axis, maximum) in
                    [(AbsoluteAxisCode::ABS_MT_SLOT, 4), (AbsoluteAxisCode::ABS_MT_TRACKING_ID, 65_535)]
                {
                    let info = AbsInfo::new(0, 0, maximum, 0, 0, 0);
                    builder = builder.with_absolute_axis(&UinputAbsSetup::new(axis, info))?;
                }
            }
            builder.build()
        };
        let mut device = built().expect("a device by uinput");
        let node = node(&mut device);
        Self { shape, device, node, tracking_id: 0 }
    }

    pub(super) fn is_pen(&self) -> bool {
        self.shape.source == "tablet"
    }

    pub(super) fn emit(&mut self, changes: &[(EventType, u16, i32)]) {
        let events: Vec<InputEvent> =
            changes.iter().map(|(kind, code, value)| InputEvent::new(kind.0, *code, *value)).collect();
        self.device.emit(&events).expect("events");
    }

    /// Something touches it at shares of its width and height, with a force for the profile in N.
    pub(crate) fn touch(&mut self, x_share: f64, y_share: f64, fz_n: f64) {
        let axes = if self.is_pen() { PEN } else { MT };
        let at = |k: usize, share: f64| {
            let (minimum, maximum, _) = self.shape.ranges[k];
            f64::from(minimum) + share * (f64::from(maximum) - f64::from(minimum))
        };
        let values = [at(0, x_share), at(1, y_share), fz_n * f64::from(self.shape.one_n)];
        let mut changes: Vec<_> = axes
            .iter()
            .zip(values)
            .map(|(axis, value)| (EventType::ABSOLUTE, axis.0, value as i32))
            .collect();
        if self.is_pen() {
            changes.insert(0, (EventType::KEY, KeyCode::BTN_TOOL_PEN.0, 1));
        } else {
            self.tracking_id += 1;
            changes
                .insert(0, (EventType::ABSOLUTE, AbsoluteAxisCode::ABS_MT_TRACKING_ID.0, self.tracking_id));
        }
        changes.push((EventType::KEY, KeyCode::BTN_TOUCH.0, 1));
        self.emit(&changes);
    }

    pub(super) fn hover(&mut self, x_share: f64) {
        let (minimum, maximum, _) = self.shape.ranges[0];
        let x = f64::from(minimum) + x_share * f64::from(maximum - minimum);
        self.emit(&[
            (EventType::KEY, KeyCode::BTN_TOOL_PEN.0, 1),
            (EventType::ABSOLUTE, AbsoluteAxisCode::ABS_X.0, x as i32),
        ]);
    }

    /// A pen leaves the range.
    pub(super) fn leave(&mut self) {
        self.emit(&[(EventType::KEY, KeyCode::BTN_TOOL_PEN.0, 0)]);
    }

    /// A second finger comes to a touchpad, or goes.
    pub(super) fn second(&mut self, x_share: f64, is_down: bool) {
        let (minimum, maximum, _) = self.shape.ranges[0];
        let x = f64::from(minimum) + x_share * f64::from(maximum - minimum);
        self.tracking_id += 1;
        let id = if is_down { self.tracking_id } else { -1 };
        self.emit(&[
            (EventType::ABSOLUTE, AbsoluteAxisCode::ABS_MT_SLOT.0, 1),
            (EventType::ABSOLUTE, AbsoluteAxisCode::ABS_MT_TRACKING_ID.0, id),
            (EventType::ABSOLUTE, MT[0].0, x as i32),
            (EventType::ABSOLUTE, AbsoluteAxisCode::ABS_MT_SLOT.0, 0),
        ]);
    }

    pub(crate) fn lift(&mut self) {
        if self.is_pen() {
            let pressure = AbsoluteAxisCode::ABS_PRESSURE.0;
            self.emit(&[(EventType::ABSOLUTE, pressure, 0), (EventType::KEY, KeyCode::BTN_TOUCH.0, 0)]);
        } else {
            let id = AbsoluteAxisCode::ABS_MT_TRACKING_ID.0;
            self.emit(&[(EventType::ABSOLUTE, id, -1), (EventType::KEY, KeyCode::BTN_TOUCH.0, 0)]);
        }
    }
}
