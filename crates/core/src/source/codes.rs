//! The kernel's names of what input devices report, as far as descriptions use them.

/// What a device reports: an absolute axis or a button, by the kernel's number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputCode {
    /// An absolute axis.
    Axis(u16),
    /// A key or button.
    Button(u16),
}

/// Something touches the device.
pub const BTN_TOUCH: u16 = 0x14a;

/// Which finger the axes that follow are of.
pub const MT_SLOT: u16 = 0x2f;

/// The first axis that each finger has of its own.
pub const MT_FIRST: u16 = 0x30;

/// A finger comes, or goes with -1.
pub const MT_TRACKING_ID: u16 = 0x39;

/// Two axes each of the first two hats. A Balance Board has its cells there.
pub const ABS_HAT0X: u16 = 0x10;
/// See [`ABS_HAT0X`].
pub const ABS_HAT0Y: u16 = 0x11;
/// See [`ABS_HAT0X`].
pub const ABS_HAT1X: u16 = 0x12;
/// See [`ABS_HAT0X`].
pub const ABS_HAT1Y: u16 = 0x13;

/// Axes by name.
pub const AXES: [(&str, u16); 20] = [
    ("ABS_X", 0x00),
    ("ABS_Y", 0x01),
    ("ABS_Z", 0x02),
    ("ABS_RX", 0x03),
    ("ABS_RY", 0x04),
    ("ABS_RZ", 0x05),
    ("ABS_HAT0X", ABS_HAT0X),
    ("ABS_HAT0Y", ABS_HAT0Y),
    ("ABS_HAT1X", ABS_HAT1X),
    ("ABS_HAT1Y", ABS_HAT1Y),
    ("ABS_HAT2X", 0x14),
    ("ABS_HAT2Y", 0x15),
    ("ABS_HAT3X", 0x16),
    ("ABS_HAT3Y", 0x17),
    ("ABS_PRESSURE", 0x18),
    ("ABS_DISTANCE", 0x19),
    ("ABS_MT_SLOT", MT_SLOT),
    ("ABS_MT_POSITION_X", 0x35),
    ("ABS_MT_POSITION_Y", 0x36),
    ("ABS_MT_PRESSURE", 0x3a),
];

/// Axes and buttons by name.
pub const CODES: [(&str, InputCode); 26] = {
    let mut codes = [("", InputCode::Axis(0)); 26];
    let mut k = 0;
    while k < AXES.len() {
        let (name, number) = AXES[k];
        codes[k] = (name, InputCode::Axis(number));
        k += 1;
    }
    codes[20] = ("BTN_TOUCH", InputCode::Button(BTN_TOUCH));
    codes[21] = ("BTN_TOOL_PEN", InputCode::Button(0x140));
    codes[22] = ("BTN_TOOL_RUBBER", InputCode::Button(0x141));
    codes[23] = ("BTN_TOOL_FINGER", InputCode::Button(0x145));
    codes[24] = ("BTN_STYLUS", InputCode::Button(0x14b));
    codes[25] = ("BTN_A", InputCode::Button(0x130));
    codes
};
