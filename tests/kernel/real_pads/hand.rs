//! A real device made through uinput, and a hand of ours on it: the reports are those that such a device sends.

use std::path::PathBuf;

use evdev::uinput::VirtualDevice;
use evdev::{AbsInfo, AbsoluteAxisCode, AttributeSet, EventType, InputEvent, KeyCode, UinputAbsSetup};

use super::litest::{RealDevice, Told};

/// Where a pen or a finger is: shares of the width, the height and the full scale of the pressure, and of the largest distance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Pose {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) pressure: f64,
    pub(super) distance: f64,
}

/// A device and who uses it.
pub(super) struct Hand {
    pub(super) device: RealDevice,
    uinput: VirtualDevice,
    pub(super) node: PathBuf,
    tracking_id: i32,
    /// The slot that is reported on.
    pub(super) slot: i32,
}

impl Hand {
    pub(super) fn plug_in(device: RealDevice) -> Self {
        let built = || {
            let mut builder = VirtualDevice::builder()?
                .name(&device.name)
                .input_id(device.id.clone())
                .with_keys(&AttributeSet::from_iter(&device.keys))?
                .with_properties(&AttributeSet::from_iter(&device.properties))?;
            if !device.relative.is_empty() {
                builder = builder.with_relative_axes(&AttributeSet::from_iter(&device.relative))?;
            }
            if !device.misc.is_empty() {
                builder = builder.with_msc(&AttributeSet::from_iter(&device.misc))?;
            }
            for (axis, info) in &device.axes {
                builder = builder.with_absolute_axis(&UinputAbsSetup::new(*axis, *info))?;
            }
            builder.build()
        };
        let mut uinput = built().expect("a device by uinput");
        let mut nodes = uinput.enumerate_dev_nodes_blocking().expect("its nodes");
        let is_event = |path: &PathBuf| path.to_string_lossy().contains("/event");
        let node = nodes.find_map(|node| node.ok().filter(is_event)).expect("its event node");
        drop(nodes);
        Self { device, uinput, node, tracking_id: 0, slot: 0 }
    }

    pub(super) fn axis(&self, axis: AbsoluteAxisCode) -> Option<AbsInfo> {
        self.device.axes.iter().find(|(found, _)| *found == axis).map(|(_, info)| *info)
    }

    /// The value of an axis at this pose.
    pub(super) fn value(&self, axis: AbsoluteAxisCode, pose: &Pose) -> i32 {
        use AbsoluteAxisCode as Axis;
        let share = match axis {
            Axis::ABS_X | Axis::ABS_MT_POSITION_X => pose.x,
            Axis::ABS_Y | Axis::ABS_MT_POSITION_Y => pose.y,
            Axis::ABS_PRESSURE | Axis::ABS_MT_PRESSURE => pose.pressure,
            Axis::ABS_DISTANCE => pose.distance,
            Axis::ABS_MT_SLOT => return self.slot,
            Axis::ABS_MT_TRACKING_ID => return self.tracking_id,
            Axis::ABS_MT_TOOL_TYPE => 0.0,
            _ => 0.5,
        };
        let info = self.axis(axis).unwrap_or_else(|| AbsInfo::new(0, 0, 0, 0, 0, 0));
        let (minimum, range) = (f64::from(info.minimum()), f64::from(info.maximum() - info.minimum()));
        (minimum + share * range) as i32
    }

    fn emit(&mut self, changes: &[(EventType, u16, i32)]) {
        let events: Vec<InputEvent> =
            changes.iter().map(|(kind, code, value)| InputEvent::new(kind.0, *code, *value)).collect();
        self.uinput.emit(&events).expect("events");
    }

    /// One of the device's reports, with these keys behind it.
    fn report(&mut self, name: &str, pose: &Pose, keys: &[(KeyCode, i32)]) {
        let report = self.device.reports.get(name).cloned().unwrap_or_default();
        assert!(!report.is_empty(), "{} has no {name}", self.device.name);
        let event = |told: &Told| {
            let code = told.code.unwrap_or(KeyCode::BTN_TOOL_PEN.0);
            let value = told.value.unwrap_or_else(|| self.value(AbsoluteAxisCode(code), pose));
            (told.kind, code, value)
        };
        let mut changes: Vec<_> = report.iter().map(event).collect();
        // The drivers tell more than these reports.
        let more: &[_] = match name {
            "down" => &[AbsoluteAxisCode::ABS_MT_TOOL_TYPE, AbsoluteAxisCode::ABS_MT_PRESSURE],
            "move" => &[AbsoluteAxisCode::ABS_MT_PRESSURE],
            _ => &[],
        };
        for axis in more.iter().filter(|axis| self.axis(**axis).is_some()) {
            if !changes.iter().any(|(kind, code, _)| *kind == EventType::ABSOLUTE && *code == axis.0) {
                changes.push((EventType::ABSOLUTE, axis.0, self.value(*axis, pose)));
            }
        }
        changes.extend(keys.iter().map(|(key, value)| (EventType::KEY, key.0, *value)));
        self.emit(&changes);
    }

    pub(super) fn is_pen(&self) -> bool {
        self.device.keys.contains(&KeyCode::BTN_TOOL_PEN)
    }

    /// A pen comes into range.
    pub(super) fn come(&mut self, pose: &Pose) {
        self.report("proximity_in", pose, &[]);
    }

    pub(super) fn leave(&mut self) {
        self.report("proximity_out", &Pose::default(), &[]);
    }

    /// A pen moves in the air, with its side button or without.
    pub(super) fn hover(&mut self, pose: &Pose, side_button: i32) {
        self.report("motion", pose, &[(KeyCode::BTN_STYLUS, side_button)]);
    }

    /// A pen or a finger touches, from now on or still.
    pub(super) fn touch(&mut self, pose: &Pose, is_first: bool) {
        if self.is_pen() {
            self.report("motion", pose, &[(KeyCode::BTN_TOUCH, 1)]);
        } else if is_first {
            self.tracking_id += 1;
            self.report("down", pose, &[(KeyCode::BTN_TOUCH, 1), (KeyCode::BTN_TOOL_FINGER, 1)]);
        } else {
            self.report("move", pose, &[]);
        }
    }

    /// A pen or a finger lifts.
    pub(super) fn lift(&mut self, pose: &Pose) {
        if self.is_pen() {
            self.report("motion", &Pose { pressure: 0.0, ..*pose }, &[(KeyCode::BTN_TOUCH, 0)]);
            return;
        }
        self.emit(&[
            (EventType::ABSOLUTE, AbsoluteAxisCode::ABS_MT_SLOT.0, self.slot),
            (EventType::ABSOLUTE, AbsoluteAxisCode::ABS_MT_TRACKING_ID.0, -1),
            (EventType::KEY, KeyCode::BTN_TOUCH.0, 0),
            (EventType::KEY, KeyCode::BTN_TOOL_FINGER.0, 0),
        ]);
    }

    /// A palm comes to the touchpad, in one report with what it is.
    pub(super) fn palm(&mut self, pose: &Pose) {
        self.tracking_id += 1;
        let axes = [
            AbsoluteAxisCode::ABS_MT_SLOT,
            AbsoluteAxisCode::ABS_MT_TRACKING_ID,
            AbsoluteAxisCode::ABS_MT_POSITION_X,
            AbsoluteAxisCode::ABS_MT_POSITION_Y,
            AbsoluteAxisCode::ABS_MT_PRESSURE,
        ];
        let mut changes: Vec<_> =
            axes.into_iter().map(|axis| (EventType::ABSOLUTE, axis.0, self.value(axis, pose))).collect();
        let kind = self.axis(AbsoluteAxisCode::ABS_MT_TOOL_TYPE).expect("it tells palms").maximum();
        changes.insert(2, (EventType::ABSOLUTE, AbsoluteAxisCode::ABS_MT_TOOL_TYPE.0, kind));
        changes.push((EventType::KEY, KeyCode::BTN_TOUCH.0, 1));
        changes.push((EventType::KEY, KeyCode::BTN_TOOL_FINGER.0, 1));
        self.emit(&changes);
    }

    /// Four fingers come to the touchpad at once, or go. Where it knows fewer places it says how many they are.
    pub(super) fn four(&mut self, is_down: bool) {
        let slots = self.axis(AbsoluteAxisCode::ABS_MT_SLOT).expect("slots").maximum() + 1;
        for slot in 0..slots.min(4) {
            self.slot = slot;
            let pose = Pose { x: 0.2 + 0.15 * f64::from(slot), y: 0.5, pressure: 0.3, distance: 0.0 };
            if is_down {
                self.touch(&pose, true);
            } else {
                self.lift(&pose);
            }
        }
        self.slot = 0;
        self.emit(&[(EventType::KEY, KeyCode::BTN_TOOL_QUADTAP.0, i32::from(is_down))]);
    }
}
