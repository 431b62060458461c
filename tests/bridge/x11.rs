//! Key presses and the pointer through a real X server, seen by an ordinary X client.
#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use std::io::{BufRead, BufReader, Write as _};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::channel;

use crate::clock::{MS, monotonic_ns};
use rustix::process::{Pid, Signal, kill_process};
use tactpad::bridge::clock::Clock;
use tactpad::bridge::latency::{Durations, Percentiles};
use tactpad::bridge::sink::Sink;
use tactpad::bridge::sink::x11::{HeldRecords, X11Sink};
use tactpad::pipeline::control::{Code, OutputDevice, OutputEvent};
use tactpad::pipeline::mapping::profile::Binding;
use tactpad::time::StreamInstant;
use x11rb::COPY_DEPTH_FROM_PARENT;
use x11rb::connection::Connection;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    AutoRepeatMode, ChangeKeyboardControlAux, ConnectionExt as _, CreateWindowAux, EventMask, InputFocus,
    KeyButMask, WindowClass,
};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;

use crate::support::require;

const UP: u16 = 103;
const LEFT: u16 = 105;
const LEFT_SHIFT: u16 = 42;
pub(crate) const Z: u16 = 44;
pub(crate) const X: u16 = 45;

/// An X server of this test alone, on a display that nobody else uses.
pub(crate) struct Server {
    process: Child,
    pub(crate) display: String,
}

impl Server {
    pub(crate) fn start() -> Self {
        let mut command = Command::new("Xvfb");
        command.args(["-displayfd", "1", "-screen", "0", "320x240x24", "-nolisten", "tcp", "-noreset"]);
        let mut process = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let mut number = String::new();
        // The server names its display once it takes connections.
        BufReader::new(process.stdout.as_mut().unwrap()).read_line(&mut number).unwrap();
        assert!(!number.trim().is_empty(), "Xvfb did not start");
        Self { process, display: format!(":{}", number.trim()) }
    }

    /// Lets it stand still.
    pub(crate) fn stop(&self) {
        kill_process(Pid::from_child(&self.process), Signal::STOP).unwrap();
    }

    /// Lets it go on.
    pub(crate) fn go_on(&self) {
        kill_process(Pid::from_child(&self.process), Signal::CONT).unwrap();
    }

    /// How many of its keys are down.
    pub(crate) fn keys_down(&self) -> u32 {
        self.keymap().iter().map(|keys| keys.count_ones()).sum()
    }

    fn keymap(&self) -> [u8; 32] {
        let (connection, _) = x11rb::connect(Some(&self.display)).unwrap();
        connection.query_keymap().unwrap().reply().unwrap().keys
    }

    /// Whether its key of the kernel's number is down.
    pub(crate) fn is_down(&self, key: u16) -> bool {
        let number = usize::from(key + 8);
        self.keymap()[number / 8] >> (number % 8) & 1 == 1
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// A window that has the keyboard.
struct Client {
    connection: RustConnection,
    first_key: u8,
    symbols: Vec<Vec<u32>>,
}

impl Client {
    fn open(display: &str) -> Self {
        let (connection, screen) = x11rb::connect(Some(display)).unwrap();
        let root = connection.setup().roots[screen].root;
        let window = connection.generate_id().unwrap();
        let mask = EventMask::KEY_PRESS
            | EventMask::KEY_RELEASE
            | EventMask::BUTTON_PRESS
            | EventMask::BUTTON_RELEASE
            | EventMask::POINTER_MOTION
            | EventMask::EXPOSURE;
        connection
            .create_window(
                COPY_DEPTH_FROM_PARENT,
                window,
                root,
                0,
                0,
                100,
                100,
                0,
                WindowClass::INPUT_OUTPUT,
                0,
                &CreateWindowAux::new().event_mask(mask),
            )
            .unwrap();
        // Held keys would repeat where the machine is slow.
        let steady = ChangeKeyboardControlAux::new().auto_repeat_mode(AutoRepeatMode::OFF);
        connection.change_keyboard_control(&steady).unwrap();
        connection.map_window(window).unwrap();
        connection.flush().unwrap();
        while !matches!(connection.wait_for_event().unwrap(), Event::Expose(_)) {}
        connection.set_input_focus(InputFocus::POINTER_ROOT, window, x11rb::CURRENT_TIME).unwrap();
        let first_key = connection.setup().min_keycode;
        let count = connection.setup().max_keycode - first_key + 1;
        let mapping = connection.get_keyboard_mapping(first_key, count).unwrap().reply().unwrap();
        let symbols =
            mapping.keysyms.chunks(mapping.keysyms_per_keycode.into()).map(<[u32]>::to_vec).collect();
        Self { connection, first_key, symbols }
    }

    /// The same, once there is so much of it: the server reads the requests of each program in its own time. After ten seconds it is
    /// what there is.
    fn seen_so_many(&self, count: usize) -> Vec<(u32, bool)> {
        let deadline_ns = monotonic_ns() + 10_000 * MS;
        let mut seen = self.seen();
        while seen.len() < count && monotonic_ns() < deadline_ns {
            seen.extend(self.seen());
        }
        seen
    }

    /// What has arrived since the last call: the symbol on the key, with Shift where it was held, and whether
    /// it went down.
    fn seen(&self) -> Vec<(u32, bool)> {
        self.connection.sync().unwrap();
        let mut seen = Vec::new();
        while let Some(event) = self.connection.poll_for_event().unwrap() {
            let (event, down) = match event {
                Event::KeyPress(event) => (event, true),
                Event::KeyRelease(event) => (event, false),
                _ => continue,
            };
            let column = usize::from(event.state.contains(KeyButMask::SHIFT));
            seen.push((self.symbols[usize::from(event.detail - self.first_key)][column], down));
        }
        seen
    }
}

/// What the pointer did on the client's window.
#[derive(Debug, PartialEq, Eq)]
enum Pointed {
    /// It is at this place of the screen.
    At(i16, i16),
    /// The button of this number went down.
    Down(u8),
    /// It went up.
    Up(u8),
}

impl Client {
    /// What the pointer has done since the last call.
    fn pointed(&self) -> Vec<Pointed> {
        self.connection.sync().unwrap();
        let mut seen = Vec::new();
        while let Some(event) = self.connection.poll_for_event().unwrap() {
            match event {
                Event::MotionNotify(event) => seen.push(Pointed::At(event.root_x, event.root_y)),
                Event::ButtonPress(event) => seen.push(Pointed::Down(event.detail)),
                Event::ButtonRelease(event) => seen.push(Pointed::Up(event.detail)),
                _ => {}
            }
        }
        seen
    }
}

pub(crate) fn event(key: u16, value: i32) -> OutputEvent {
    OutputEvent { at: StreamInstant::from_us(0), device: OutputDevice::Keyboard, code: Code::Key(key), value }
}

fn pointer(code: Code, value: i32) -> OutputEvent {
    OutputEvent { at: StreamInstant::from_us(0), device: OutputDevice::Pointer, code, value }
}

const SYMBOL_UP: u32 = 0xff52;
const SYMBOL_LEFT: u32 = 0xff51;

/// Writes a group, and waits until it is out.
pub(crate) fn put(sink: &mut X11Sink, group: &[OutputEvent]) {
    sink.write(group).unwrap();
    sink.settle().unwrap();
}

#[test]
fn keys_reach_a_window_in_order() {
    if !require("Xvfb", "apt-get install xvfb") {
        return;
    }
    let server = Server::start();
    let client = Client::open(&server.display);
    let mut sink = X11Sink::open(Some(&server.display), None).unwrap();
    sink.prepare(OutputDevice::Keyboard).unwrap();
    put(&mut sink, &[event(UP, 1)]);
    put(&mut sink, &[event(LEFT, 1), event(Z, 1)]);
    put(&mut sink, &[event(UP, 0), event(Z, 0), event(X, 1)]);
    put(&mut sink, &[event(X, 0), event(LEFT, 0)]);
    let (z, x) = (u32::from(b'z'), u32::from(b'x'));
    let expected = [
        (SYMBOL_UP, true),
        (SYMBOL_LEFT, true),
        (z, true),
        (SYMBOL_UP, false),
        (z, false),
        (x, true),
        (x, false),
        (SYMBOL_LEFT, false),
    ];
    assert_eq!(client.seen_so_many(expected.len()), expected);
    put(&mut sink, &[event(LEFT_SHIFT, 1)]);
    client.seen_so_many(1);
    put(&mut sink, &[event(Z, 1), event(Z, 0)]);
    assert_eq!(client.seen_so_many(2), [(u32::from(b'Z'), true), (u32::from(b'Z'), false)]);
}

#[test]
fn dropping_the_sink_releases_what_it_holds() {
    if !require("Xvfb", "apt-get install xvfb") {
        return;
    }
    let server = Server::start();
    let client = Client::open(&server.display);
    let mut sink = X11Sink::open(Some(&server.display), None).unwrap();
    put(&mut sink, &[event(UP, 1), event(Z, 1), event(X, 1)]);
    put(&mut sink, &[event(X, 0)]);
    client.seen_so_many(4);
    drop(sink);
    let mut released = client.seen_so_many(2);
    released.sort_unstable();
    assert_eq!(released, [(u32::from(b'z'), false), (SYMBOL_UP, false)]);
}

#[test]
fn the_pointer_moves_and_clicks_where_it_is() {
    if !require("Xvfb", "apt-get install xvfb") {
        return;
    }
    let server = Server::start();
    let client = Client::open(&server.display);
    let root = client.connection.setup().roots[0].root;
    client.connection.warp_pointer(x11rb::NONE, root, 0, 0, 0, 0, 50, 40).unwrap();
    client.pointed();
    let mut sink = X11Sink::open(Some(&server.display), None).unwrap();
    sink.prepare(OutputDevice::Pointer).unwrap();
    let (x, y, left) = (Code::Relative(0), Code::Relative(1), Code::Key(0x110));
    put(&mut sink, &[pointer(x, 7), pointer(y, -3), pointer(left, 1)]);
    put(&mut sink, &[pointer(x, -20), pointer(left, 0), pointer(Code::Key(0x111), 1)]);
    use Pointed::{At, Down, Up};
    assert_eq!(client.pointed(), [At(57, 40), At(57, 37), Down(1), At(37, 37), Up(1), Down(3)]);
    let wheel = Code::Relative(8);
    put(&mut sink, &[pointer(wheel, 1)]);
    put(&mut sink, &[pointer(wheel, -1)]);
    assert_eq!(client.pointed(), [Down(4), Up(4), Down(5), Up(5)]);
    drop(sink);
    assert_eq!(client.pointed(), [Up(3)], "what was held is released");
}

#[test]
fn the_pointer_goes_to_places_of_the_screen() {
    if !require("Xvfb", "apt-get install xvfb") {
        return;
    }
    let server = Server::start();
    let client = Client::open(&server.display);
    let screen = &client.connection.setup().roots[0];
    let (right, bottom) = (screen.width_in_pixels as i16 - 1, screen.height_in_pixels as i16 - 1);
    let at = || {
        let pointer = client.connection.query_pointer(screen.root).unwrap().reply().unwrap();
        (pointer.root_x, pointer.root_y)
    };
    let mut sink = X11Sink::open(Some(&server.display), None).unwrap();
    sink.prepare(OutputDevice::Tablet).unwrap();
    let place =
        |axis, value| OutputEvent { device: OutputDevice::Tablet, ..pointer(Code::Axis(axis), value) };
    put(&mut sink, &[place(0, 1), place(1, 1)]);
    assert_eq!(at(), (0, 0));
    put(&mut sink, &[place(0, 32_767), place(1, 32_767)]);
    assert_eq!(at(), (right, bottom));
    put(&mut sink, &[place(0, 16_384)]);
    assert_eq!(at(), (right / 2, bottom), "along the other side it stays");
}

#[test]
fn what_x_cannot_do_is_refused_before_a_key_goes_out() {
    if !require("Xvfb", "apt-get install xvfb") {
        return;
    }
    let server = Server::start();
    let client = Client::open(&server.display);
    let mut sink = X11Sink::open(Some(&server.display), None).unwrap();
    assert!(sink.prepare(OutputDevice::Gamepad).unwrap_err().message.contains("output = \"keyboard\""));
    let hat = OutputEvent { device: OutputDevice::Gamepad, code: Code::Axis(0x11), ..event(0, -1) };
    let bare = client.symbols.iter().position(|symbols| symbols.iter().all(|symbol| *symbol == 0)).unwrap();
    assert_eq!(client.first_key, 8, "the kernel's key 0");
    // 247 is the highest number that X has room for.
    let sideways = pointer(Code::Relative(6), 1);
    let moved_key = OutputEvent { code: Code::Relative(0), ..event(0, 1) };
    let outside = [event(248, 1), event(0x110, 1), event(0x130, 1), event(u16::MAX, 1)];
    for refused in [hat, event(0, 1), event(bare as u16, 1), sideways, moved_key].into_iter().chain(outside) {
        let error = sink.write(&[event(Z, 1), refused]).unwrap_err();
        assert!(error.message.contains("--output uinput"), "{error}");
    }
    assert_eq!(client.seen(), []);
    let binding = |number| Binding { device: OutputDevice::Keyboard, code: Code::Key(number), value: 1 };
    assert!(sink.accepts(&[binding(Z), binding(UP)]).is_ok());
    let error = sink.accepts(&[binding(Z), binding(249), binding(X), binding(bare as u16)]).unwrap_err();
    let mut lacking = [249, bare as u16];
    lacking.sort_unstable();
    let [first, second] = lacking.map(|number| Code::Key(number).to_string());
    assert!(error.message.contains(&format!("has no {first}, {second}:")), "{error}");
}

#[test]
fn missing_server_is_one_sentence() {
    let error = X11Sink::open(Some(":65000"), None).err().unwrap();
    assert!(error.message.contains(":65000") && error.message.contains("--output uinput"), "{error}");
}

/// The keys that the shipped profiles type.
const PLAYED: [u16; 6] = [UP, 108, LEFT, 106, Z, X];

/// Every key of every shipped profile, press and release in turn, as fast as the sink takes them.
fn presses(count: usize) -> impl Iterator<Item = OutputEvent> {
    let keys = PLAYED.into_iter().cycle().take(count);
    keys.flat_map(|key| [event(key, 1), event(key, 0)])
}

/// A key call may take so many times as long as the shortest question to the server and its answer, as far as that is not what
/// the scheduler adds to either.
const ROUND_TRIPS_MAX: f64 = 3.0;

#[test]
fn two_thousand_presses_arrive_in_order_and_are_quick() {
    if !require("Xvfb", "apt-get install xvfb") {
        return;
    }
    let server = Server::start();
    let client = Client::open(&server.display);
    let records = tempfile::tempdir().unwrap();
    let mut sink =
        X11Sink::open(Some(&server.display), Some(HeldRecords { folder: records.path(), guardian: None }))
            .unwrap();
    let clock = Clock::start();
    let [mut calls, mut round_trips] = [Durations::new(), Durations::new()];
    for press in presses(2_000) {
        let before = clock.now();
        let (tell, written) = channel();
        sink.write_then(&[press], Box::new(move || tell.send(clock.now()).unwrap())).unwrap();
        let out = written.recv().unwrap();
        let between = clock.now();
        // Whatever the machine does meanwhile happens to both.
        client.connection.sync().unwrap();
        calls.record_ns(out.as_ns() - before.as_ns());
        round_trips.record_ns(clock.now().as_ns() - between.as_ns());
    }
    let symbol = |event: &OutputEvent| match event.code {
        Code::Key(key) => (client.symbols[usize::from(key)][0], event.value == 1),
        other => panic!("{other} is no key"),
    };
    let expected: Vec<_> = presses(2_000).map(|event| symbol(&event)).collect();
    assert_eq!(client.seen_so_many(expected.len()), expected);
    let Percentiles { p50, p99, max, .. } = calls.percentiles();
    let round_trip = round_trips.percentiles().p50;
    println!(
        "a key call: p50 {p50:.0} µs, p99 {p99:.0} µs, max {max:.0} µs; a round trip: p50 {round_trip:.0} µs"
    );
    assert!(p50 <= ROUND_TRIPS_MAX * round_trip, "p50 {p50} µs; a round trip {round_trip} µs");
}

#[test]
fn setup_keeps_keys_where_they_are_chosen_and_run_types_them() {
    if !require("Xvfb", "apt-get install xvfb") || Path::new("/dev/uinput").exists() {
        return;
    }
    let server = Server::start();
    let home = tempfile::tempdir().unwrap();
    let tactpad = |line: &str, answers: &str, display: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_tactpad"));
        command.args(line.split(' ')).env("HOME", home.path()).env("XDG_RUNTIME_DIR", home.path());
        command.env("XDG_STATE_HOME", home.path()).env("DISPLAY", display).env_remove("WAYLAND_DISPLAY");
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        child.stdin.take().unwrap().write_all(answers.as_bytes()).unwrap();
        let output = child.wait_with_output().unwrap();
        let [said, told] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
        assert!(output.status.success(), "{said}{told}");
        (said, told)
    };
    let setup = "setup --pad virtual --try no --profile tetris";
    // The second answer is to the question of permission.
    let (said, _) = tactpad(setup, "1\n\n", &server.display);
    assert!(said.contains("sudo modprobe uinput") && said.contains("(`tactpad doctor`):"), "{said}");
    assert!(said.ends_with("changed there.\n") && said.contains("\n  tactpad run\n"), "{said}");
    let (_, told) = tactpad("run --seconds 0.3", "", &server.display);
    assert!(told.contains("which go to the window in front: `--output x11`"), "{told}");
    let (said, _) = tactpad(setup, "2\n", &server.display);
    assert!(
        said.contains("start the game first") && said.contains("\n  tactpad run --output x11\n"),
        "{said}"
    );
    let (_, told) = tactpad("run --seconds 3", "", &server.display);
    assert!(told.contains("keys and pointer of X display") && !told.contains(" 0 downs"), "{told}");
    assert!(told.contains(", 0 held at the end"), "{told}");
    let (_, told) = tactpad("run --seconds 0.3", "", "");
    assert!(told.contains("chose keys of the X server, and there is none here"), "{told}");
}
