//! Input devices of software.

use evdev::uinput::VirtualDevice;
use evdev::{
    AbsInfo, AbsoluteAxisCode, AttributeSet, BusType, EventType, InputEvent, InputId, KeyCode, UinputAbsSetup,
};

/// Makes a device with this name and these keys, and the range of each axis.
pub(super) fn plug_in(
    name: &str,
    bus: BusType,
    keys: &[KeyCode],
    axes: &[(AbsoluteAxisCode, AbsInfo)],
) -> VirtualDevice {
    let keys: AttributeSet<KeyCode> = keys.iter().copied().collect();
    let built = || {
        let id = InputId::new(bus, 0x1234, 0x5678, 1);
        let mut builder = VirtualDevice::builder()?.name(name).input_id(id).with_keys(&keys)?;
        for (axis, info) in axes {
            builder = builder.with_absolute_axis(&UinputAbsSetup::new(*axis, *info))?;
        }
        builder.build()
    };
    let mut device = built().unwrap();
    // It is there once the kernel has made its nodes.
    assert!(device.enumerate_dev_nodes_blocking().unwrap().next().is_some(), "{name} has no node");
    device
}

pub(super) fn axis(axis: AbsoluteAxisCode, value: f64) -> InputEvent {
    InputEvent::new(EventType::ABSOLUTE.0, axis.0, value as i32)
}

pub(super) fn key(key: KeyCode, is_down: bool) -> InputEvent {
    InputEvent::new(EventType::KEY.0, key.0, i32::from(is_down))
}
