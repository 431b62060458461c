//! Virtual devices of the kernel (uinput), which every program takes for hardware.
//!
//! A device leaves when its descriptor closes, also when the program is killed, and the kernel then releases
//! its keys. It does not bring axes back to rest; dropping the sink does that.

use std::io;
use std::os::fd::AsFd;
use std::path::{Path, PathBuf};

use evdev::uinput::VirtualDevice;
use evdev::{
    AbsInfo, AbsoluteAxisCode, AttributeSet, BusType, InputId, KeyCode, RelativeAxisCode, UinputAbsSetup,
};
use rustix::event::{Timespec, poll};
use rustix::io::Errno;

use super::identity::{
    DeviceIdentity, GAMEPAD, GAMEPAD_AXES, KEYBOARD, POINTER, TABLET, TABLET_AXES, declares, keys, movements,
};
use super::{Sink, SinkError};
use tactpad_core::pipeline::control::{Code, OutputDevice, OutputEvent};

/// Where the kernel makes virtual devices.
const UINPUT: &str = "/dev/uinput";

/// How long a new device's node may take to appear, in milliseconds.
const NODE_LIMIT_MS: u32 = 2_000;

/// How long the device service may take to set a new node's permissions, in milliseconds.
const SERVICE_LIMIT_MS: u32 = 1_000;

/// How long readers get to see the last releases before the device leaves, in milliseconds.
///
/// A reader that comes later finds no device and not what it sent last. A game reads once a frame.
const FAREWELL_MS: u32 = 20;

/// Size of the time stamp in `struct input_event`: two machine words. The kernel fills it in where it is
/// zero.
const TIME_LEN: usize = 2 * size_of::<usize>();

const EV_SYN: u16 = 0;
const EV_KEY: u16 = 1;
const EV_REL: u16 = 2;
const EV_ABS: u16 = 3;
const SYN_REPORT: u16 = 0;

/// Every device, in the order in which a group is written.
/// The pointer is where it goes before its buttons change.
const DEVICES: [OutputDevice; 4] =
    [OutputDevice::Gamepad, OutputDevice::Keyboard, OutputDevice::Tablet, OutputDevice::Pointer];

/// The virtual gamepad, keyboard and pointer. Each is made when it is first prepared.
#[derive(Debug)]
pub struct UinputSink {
    gamepad: Option<UinputDevice>,
    keyboard: Option<UinputDevice>,
    pointer: Option<UinputDevice>,
    tablet: Option<UinputDevice>,
}

impl UinputSink {
    /// A sink without devices yet.
    ///
    /// # Errors
    /// uinput cannot be used here; the text says what would help.
    pub fn open() -> Result<Self, SinkError> {
        available().map_err(|obstacle| obstacle.error())?;
        Ok(Self::empty())
    }

    const fn empty() -> Self {
        Self { gamepad: None, keyboard: None, pointer: None, tablet: None }
    }

    /// The node that readers of `device` open; `None` before it is prepared.
    pub fn node(&self, device: OutputDevice) -> Option<&Path> {
        let unit = match device {
            OutputDevice::Gamepad => &self.gamepad,
            OutputDevice::Keyboard => &self.keyboard,
            OutputDevice::Pointer => &self.pointer,
            OutputDevice::Tablet => &self.tablet,
        };
        unit.as_ref().map(|unit| unit.node.as_path())
    }

    fn unit(&mut self, device: OutputDevice) -> Result<&mut UinputDevice, SinkError> {
        let place = match device {
            OutputDevice::Gamepad => &mut self.gamepad,
            OutputDevice::Keyboard => &mut self.keyboard,
            OutputDevice::Pointer => &mut self.pointer,
            OutputDevice::Tablet => &mut self.tablet,
        };
        match place {
            Some(unit) => Ok(unit),
            None => Ok(place.insert(UinputDevice::make(device)?)),
        }
    }
}

/// Says whether virtual devices can be made here, without making one.
///
/// # Errors
/// They cannot, and this keeps them from it.
pub fn available() -> Result<(), UinputObstacle> {
    let uinput = std::fs::OpenOptions::new().read(true).write(true).open(UINPUT);
    uinput.map(|_| ()).map_err(|error| UinputObstacle::of(&error))
}

/// The command that puts the udev rules in place, which the program prints.
pub const INSTALL_RULES: &str = "tactpad doctor --udev-rules | sudo tee /etc/udev/rules.d/70-tactpad.rules && \
                                 sudo udevadm control --reload && sudo udevadm trigger";

/// The command that loads the kernel's module. The rules' static node loads it after each start of the machine.
const LOAD_MODULE: &str = "sudo modprobe uinput";

/// What keeps virtual devices from being made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UinputObstacle {
    /// The reason, for people.
    pub why: String,
    /// The command that mends it, if one does.
    pub mend: Option<&'static str>,
}

impl UinputObstacle {
    fn of(error: &io::Error) -> Self {
        let (why, mend) = match error.kind() {
            io::ErrorKind::NotFound => ("is not there: the kernel's module is not loaded", Some(LOAD_MODULE)),
            io::ErrorKind::PermissionDenied => ("cannot be written by you", Some(INSTALL_RULES)),
            _ if error.raw_os_error() == Some(Errno::NODEV.raw_os_error()) => {
                ("has no driver behind it: the kernel's module is not loaded", Some(LOAD_MODULE))
            }
            _ => return Self { why: format!("{UINPUT} makes no device ({error})"), mend: None },
        };
        Self { why: format!("{UINPUT} {why}"), mend }
    }

    fn error(&self) -> SinkError {
        let Self { why, mend } = self;
        let way_out = mend.unwrap_or("--output x11` or `--output log:FILE");
        SinkError { message: format!("{why}; this helps: `{way_out}`") }
    }
}

impl Sink for UinputSink {
    /// Makes the device and waits until readers can open it, 3 s at most.
    fn prepare(&mut self, device: OutputDevice) -> Result<(), SinkError> {
        self.unit(device).map(|_| ())
    }

    fn write(&mut self, group: &[OutputEvent]) -> Result<(), SinkError> {
        if let Some(event) = group.iter().find(|event| !declares(event.device, event.code)) {
            return Err(undeclared(event));
        }
        for device in DEVICES {
            if group.iter().any(|event| event.device == device) {
                let unit = self.unit(device)?;
                unit.write(
                    group
                        .iter()
                        .filter(|event| event.device == device)
                        .map(|event| (event.code, event.value)),
                )?;
            }
        }
        Ok(())
    }

    fn describe(&self) -> String {
        let nodes = DEVICES.map(|device| {
            self.node(device).map(|node| format!("virtual {} at {}", device.name(), node.display()))
        });
        let nodes: Vec<String> = nodes.into_iter().flatten().collect();
        if nodes.is_empty() { "virtual devices (none made yet)".into() } else { nodes.join(", ") }
    }
}

/// One virtual device.
#[derive(Debug)]
struct UinputDevice {
    device: VirtualDevice,
    name: &'static str,
    node: PathBuf,
    bytes: Vec<u8>,
    held: Vec<Code>,
}

impl UinputDevice {
    fn make(device: OutputDevice) -> Result<Self, SinkError> {
        let (made, name) = match device {
            OutputDevice::Gamepad => (make_gamepad(), GAMEPAD.name),
            OutputDevice::Keyboard => (make_keyboard(), KEYBOARD.name),
            OutputDevice::Pointer => (make_pointer(), POINTER.name),
            OutputDevice::Tablet => (make_tablet(), TABLET.name),
        };
        let mut device = made.map_err(|error| UinputObstacle::of(&error).error())?;
        let node = wait_for_node(&mut device).ok_or_else(|| no_node(name))?;
        Ok(Self { device, name, node, bytes: Vec::new(), held: Vec::new() })
    }

    /// Writes the events and their report in one system call.
    fn write(&mut self, events: impl Iterator<Item = (Code, i32)>) -> Result<(), SinkError> {
        self.bytes.clear();
        for (code, value) in events {
            self.held.retain(|held| *held != code);
            // A tablet's place is nothing that is held.
            if value != 0 && !matches!(code, Code::Relative(_)) && self.name != TABLET.name {
                self.held.push(code);
            }
            encode(code, value, &mut self.bytes);
        }
        encode_report(&mut self.bytes);
        let device = self.device.as_fd();
        write_all(|bytes| rustix::io::write(device, bytes), &self.bytes)
            .map_err(|error| lost(self.name, &error))
    }
}

impl Drop for UinputDevice {
    fn drop(&mut self) {
        let held = std::mem::take(&mut self.held);
        let spoke = !self.bytes.is_empty();
        // Where this fails the device is gone, and with it what it held.
        let released = held.is_empty() || self.write(held.into_iter().map(|code| (code, 0))).is_ok();
        if spoke && released {
            let _: Option<()> = eventually(FAREWELL_MS, || None);
        }
    }
}

/// Writes all of `bytes` by `write`. A device that takes none of them, or none now, is at fault: nothing is tried again.
fn write_all(mut write: impl FnMut(&[u8]) -> Result<usize, Errno>, bytes: &[u8]) -> Result<(), Errno> {
    let mut rest = bytes;
    while !rest.is_empty() {
        // The kernel takes a whole group at once, unless a signal comes between two events.
        match write(rest) {
            Ok(0) => return Err(Errno::IO),
            Ok(count) => rest = rest.get(count..).unwrap_or_default(),
            Err(Errno::INTR) => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

/// Appends one change as a `struct input_event` of this machine.
fn encode(code: Code, value: i32, bytes: &mut Vec<u8>) {
    match code {
        Code::Key(key) => encode_event(EV_KEY, key, value, bytes),
        Code::Axis(axis) => encode_event(EV_ABS, axis, value, bytes),
        Code::Relative(movement) => encode_event(EV_REL, movement, value, bytes),
    }
}

/// Appends the event that ends a group: readers take everything before it for simultaneous.
fn encode_report(bytes: &mut Vec<u8>) {
    encode_event(EV_SYN, SYN_REPORT, 0, bytes);
}

fn encode_event(kind: u16, code: u16, value: i32, bytes: &mut Vec<u8>) {
    bytes.extend_from_slice(&[0; TIME_LEN]);
    bytes.extend_from_slice(&kind.to_ne_bytes());
    bytes.extend_from_slice(&code.to_ne_bytes());
    bytes.extend_from_slice(&value.to_ne_bytes());
}

fn make_gamepad() -> io::Result<VirtualDevice> {
    let keys: AttributeSet<KeyCode> = keys(OutputDevice::Gamepad).map(KeyCode::new).collect();
    let builder = VirtualDevice::builder()?.name(GAMEPAD.name).input_id(input_id(&GAMEPAD));
    let mut builder = builder.with_keys(&keys)?;
    for axis in GAMEPAD_AXES {
        let range = AbsInfo::new(0, axis.min, axis.max, axis.fuzz, axis.flat, 0);
        builder = builder.with_absolute_axis(&UinputAbsSetup::new(AbsoluteAxisCode(axis.code), range))?;
    }
    builder.build()
}

/// The keyboard does not repeat keys by itself (no `EV_REP`): what is held is the mapping's to say.
fn make_keyboard() -> io::Result<VirtualDevice> {
    let keys: AttributeSet<KeyCode> = keys(OutputDevice::Keyboard).map(KeyCode::new).collect();
    let builder = VirtualDevice::builder()?.name(KEYBOARD.name).input_id(input_id(&KEYBOARD));
    builder.with_keys(&keys)?.build()
}

/// A device of places and no movements, as virtual machines have it: a mouse's buttons tell input stacks what it is, though none of them
/// is ever pressed here.
fn make_tablet() -> io::Result<VirtualDevice> {
    let keys: AttributeSet<KeyCode> = keys(OutputDevice::Pointer).map(KeyCode::new).collect();
    let builder = VirtualDevice::builder()?.name(TABLET.name).input_id(input_id(&TABLET));
    let mut builder = builder.with_keys(&keys)?;
    for axis in TABLET_AXES {
        let range = AbsInfo::new(0, axis.min, axis.max, axis.fuzz, axis.flat, 0);
        builder = builder.with_absolute_axis(&UinputAbsSetup::new(AbsoluteAxisCode(axis.code), range))?;
    }
    builder.build()
}

fn make_pointer() -> io::Result<VirtualDevice> {
    let keys: AttributeSet<KeyCode> = keys(OutputDevice::Pointer).map(KeyCode::new).collect();
    let movements: AttributeSet<RelativeAxisCode> = movements().map(RelativeAxisCode).collect();
    let builder = VirtualDevice::builder()?.name(POINTER.name).input_id(input_id(&POINTER));
    builder.with_keys(&keys)?.with_relative_axes(&movements)?.build()
}

fn input_id(identity: &DeviceIdentity) -> InputId {
    InputId::new(BusType(identity.bus), identity.vendor, identity.product, identity.version)
}

/// Waits until readers can open the device, so that its first event is not lost.
///
/// The kernel makes the node at once or a little later; then the device service, where one runs, gives the
/// user access to it and tells programs that wait for controllers. `None`: the node did not appear.
fn wait_for_node(device: &mut VirtualDevice) -> Option<PathBuf> {
    let node = eventually(NODE_LIMIT_MS, || {
        let mut nodes = device.enumerate_dev_nodes_blocking().ok()?.flatten();
        nodes.find(|node| node.exists())
    })?;
    if Path::new("/run/udev/control").exists() {
        // The service may be stuck or not know the node; the device works without it.
        let _ = eventually(SERVICE_LIMIT_MS, || service_entry(device, &node).filter(|entry| entry.exists()));
    }
    Some(node)
}

/// Where udev notes that it is done with `node`.
fn service_entry(device: &mut VirtualDevice, node: &Path) -> Option<PathBuf> {
    let number = device.get_syspath().ok()?.join(node.file_name()?).join("dev");
    let number = std::fs::read_to_string(number).ok()?;
    Some(Path::new("/run/udev/data").join(format!("c{}", number.trim_end())))
}

/// Asks every millisecond until there is an answer, `limit_ms` times at most.
fn eventually<T>(limit_ms: u32, mut ask: impl FnMut() -> Option<T>) -> Option<T> {
    for _ in 0..limit_ms {
        if let Some(answer) = ask() {
            return Some(answer);
        }
        // Nothing to poll: only the time limit ends this. A signal may end it early, which does no harm.
        let _ = poll(&mut [], Some(&Timespec { tv_sec: 0, tv_nsec: 1_000_000 }));
    }
    ask()
}

fn no_node(name: &str) -> SinkError {
    let message = format!(
        "the virtual {name} got no node in /dev/input within {NODE_LIMIT_MS} ms: load the kernel's module \
         with `sudo modprobe evdev` and see that /sys is mounted"
    );
    SinkError { message }
}

fn lost(name: &str, error: &Errno) -> SinkError {
    SinkError { message: format!("the virtual {name} takes no events any more ({error}): start again") }
}

fn undeclared(event: &OutputEvent) -> SinkError {
    let message = format!(
        "the virtual {} has no {}: bind one of its own controls in the profile",
        event.device.name(),
        event.code
    );
    SinkError { message }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_core::time::StreamInstant;

    #[test]
    fn event_is_as_long_as_the_kernels() {
        let mut bytes = Vec::new();
        encode_report(&mut bytes);
        assert_eq!(bytes.len(), size_of::<evdev::InputEvent>());
    }

    #[cfg(all(target_pointer_width = "64", target_endian = "little"))]
    #[test]
    fn group_is_these_bytes() {
        let mut bytes = Vec::new();
        encode(Code::Key(0x130), 1, &mut bytes);
        encode(Code::Axis(0x11), -1, &mut bytes);
        encode(Code::Relative(0x01), -2, &mut bytes);
        encode_report(&mut bytes);
        let expected = [
            [[0; 16].as_slice(), &[0x01, 0x00, 0x30, 0x01, 0x01, 0x00, 0x00, 0x00]].concat(),
            [[0; 16].as_slice(), &[0x03, 0x00, 0x11, 0x00, 0xff, 0xff, 0xff, 0xff]].concat(),
            [[0; 16].as_slice(), &[0x02, 0x00, 0x01, 0x00, 0xfe, 0xff, 0xff, 0xff]].concat(),
            [0; 24].to_vec(),
        ];
        assert_eq!(bytes, expected.concat());
    }

    #[test]
    fn refusals_say_the_way_out() {
        for (code, way_out) in [
            (Errno::NOENT, "modprobe uinput"),
            (Errno::NODEV, "modprobe uinput"),
            (Errno::ACCESS, "/etc/udev/rules.d"),
            (Errno::PERM, "/etc/udev/rules.d"),
            (Errno::INVAL, "--output"),
        ] {
            let error = UinputObstacle::of(&code.into()).error();
            assert!(error.message.contains(way_out) && error.message.contains(UINPUT), "{error}");
        }
    }

    #[test]
    fn control_of_the_other_device_is_refused_before_anything_is_made() {
        let mut sink = UinputSink::empty();
        let at = StreamInstant::from_us(0);
        let event = OutputEvent { at, device: OutputDevice::Keyboard, code: Code::Key(0x130), value: 1 };
        let error = sink.write(&[event]).unwrap_err();
        assert!(error.message.contains("keyboard") && error.message.contains("BTN_SOUTH"), "{error}");
        assert_eq!(sink.node(OutputDevice::Keyboard), None);
    }

    #[test]
    fn waiting_ends_with_the_answer_or_after_so_many_questions() {
        let mut asked = 0;
        assert_eq!(
            eventually(5, || {
                asked += 1;
                (asked == 3).then_some(asked)
            }),
            Some(3)
        );
        asked = 0;
        assert_eq!(
            eventually::<()>(5, || {
                asked += 1;
                None
            }),
            None
        );
        assert_eq!(asked, 6);
    }

    #[test]
    fn a_device_that_takes_nothing_is_an_error_and_is_not_asked_for_ever() {
        for (answers, outcome) in [
            (&[Ok(3), Err(Errno::INTR), Ok(5)][..], Ok(())),
            (&[Ok(3), Ok(0)], Err(Errno::IO)),
            (&[Ok(3), Err(Errno::AGAIN)], Err(Errno::AGAIN)),
            (&[Err(Errno::NODEV)], Err(Errno::NODEV)),
        ] {
            let mut left = answers.iter();
            assert_eq!(write_all(|_| *left.next().unwrap(), &[0; 8]), outcome, "{answers:?}");
            assert_eq!(left.next(), None, "{answers:?}");
        }
    }

    #[test]
    fn empty_group_writes_nothing() {
        UinputSink::empty().write(&[]).unwrap();
    }
}
