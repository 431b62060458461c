//! A Wii Balance Board of software: the remote's protocol as its firmware speaks it, below the kernel's real driver.
//!
//! Written by the protocol's public description (<https://wiibrew.org/wiki/Wiimote>, <https://wiibrew.org/wiki/Wii_Balance_Board>). It is
//! harsher than a board in one thing: after any report of its state it reports nothing more until it is asked anew.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};

use tactpad::numeric::random::SplitMix64;

use crate::clock::{MS, monotonic_ns, readable_before, stamp_ns};
use crate::uhid::{Bus, Told, Uhid};

/// Cells: upper right, lower right, upper left, lower left, by the signs of their places.
const CELLS: [[f64; 2]; 4] = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];

/// Weight of a kilogram, N.
const N_PER_KG: f64 = 9.806_65;

/// The factory's weights, kg.
const STEP_KG: f64 = 17.0;

/// A board reports so often, ns.
const PERIOD_NS: u64 = 10 * MS;

/// Reports to the system and from it, each with the bytes behind its number.
const INPUTS: [(u8, u8); 14] = [
    (0x20, 6),
    (0x21, 21),
    (0x22, 4),
    (0x30, 2),
    (0x31, 5),
    (0x32, 10),
    (0x33, 17),
    (0x34, 21),
    (0x35, 21),
    (0x36, 21),
    (0x37, 21),
    (0x3d, 21),
    (0x3e, 21),
    (0x3f, 21),
];
const OUTPUTS: [(u8, u8); 11] = [
    (0x10, 1),
    (0x11, 1),
    (0x12, 2),
    (0x13, 1),
    (0x14, 1),
    (0x15, 1),
    (0x16, 21),
    (0x17, 6),
    (0x18, 21),
    (0x19, 1),
    (0x1a, 1),
];

// Errors that a read or write of memory gives back.
const NO_DEVICE: u8 = 7;
const NO_ADDRESS: u8 = 8;

/// What the board's registers say of what it is, once they are asked without encryption.
const IDENTITY: [u8; 6] = [0x00, 0x00, 0xa4, 0x20, 0x04, 0x02];

/// A board as the factory made it, and its batteries.
#[derive(Clone, Debug)]
pub(crate) struct Make {
    address: String,
    /// What each cell reads under 0, 17 and 34 kg.
    points: [[u16; 3]; 4],
    /// What each cell seems to bear while nothing lies on it, kg.
    pub(crate) rest_kg: [f64; 4],
    /// Time from a request to its answer, ns.
    latency_ns: u64,
    /// What the battery reads.
    pub(crate) battery: u8,
    /// Seed of its cells' noise.
    noise: u64,
}

impl Make {
    /// Of a seed. Unloaded cells read up to 6.5 kg less than their own zero, as on some boards.
    pub(crate) fn drawn(random: &mut SplitMix64) -> Self {
        let points = std::array::from_fn(|_| {
            let zero = 1_000.0 + 14_000.0 * random.fraction();
            let [near, far] = [0, 0].map(|_| 1_700.0 + 200.0 * random.fraction());
            [zero, zero + near, zero + near + far].map(|reads| reads as u16)
        });
        Self {
            address: "00:1e:35:01:02:03".into(),
            points,
            rest_kg: std::array::from_fn(|_| -6.5 + 5.0 * f64::from(random.fraction())),
            latency_ns: (1.0 + 9.0 * f64::from(random.fraction())) as u64 * MS,
            battery: 0x83,
            noise: random.next_bits(),
        }
    }

    /// What a cell reads of so much on it.
    fn reads(&self, cell: usize, kg: f64) -> f64 {
        let [none, some, more] = self.points[cell].map(f64::from);
        let kg = kg + self.rest_kg[cell];
        if kg < STEP_KG {
            none + kg / STEP_KG * (some - none)
        } else {
            some + (kg - STEP_KG) / STEP_KG * (more - some)
        }
    }

    /// Whether all cells read less than their own zero while this lies on the board: the driver's axes say nothing of it.
    pub(crate) fn is_unsaid(&self, load: Load) -> bool {
        (0..4).all(|cell| load.kg(cell) + self.rest_kg[cell] < 0.0)
    }
}

/// What lies on the board: a force in N, at shares of its half width and half height, right and up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Load {
    pub(crate) fz_n: f64,
    pub(crate) x: f64,
    pub(crate) y: f64,
}

/// Nothing.
pub(crate) const NOTHING: Load = Load { fz_n: 0.0, x: 0.0, y: 0.0 };

impl Load {
    /// What of it a cell bears, kg.
    fn kg(self, cell: usize) -> f64 {
        let [right, up] = CELLS[cell];
        (1.0 + right * self.x + up * self.y) / 4.0 * self.fz_n / N_PER_KG
    }
}

/// What a test does with a board.
#[derive(Default)]
struct Hand {
    load: Load,
    /// Its radio is out of reach, and the system does not know it yet.
    is_silent: bool,
    is_switched_off: bool,
}

/// A board that is switched on and connected.
pub(crate) struct Board {
    hand: Arc<Mutex<Hand>>,
    thread: Option<JoinHandle<()>>,
}

impl Board {
    /// Switches it on.
    pub(crate) fn connect(make: &Make) -> Self {
        let hand = Arc::<Mutex<Hand>>::default();
        let uhid = Uhid::plug_in(&Told {
            name: "Nintendo RVL-WBC-01",
            serial_number: &make.address,
            bus: Bus::Bluetooth,
            vendor: 0x057e,
            product: 0x0306,
            descriptor: &descriptor(),
        });
        let mut firmware = Firmware {
            uhid,
            make: make.clone(),
            registers: registers(make),
            mode: 0x30,
            lights: 0,
            noise: SplitMix64::new(make.noise),
            answers: VecDeque::new(),
        };
        let theirs = Arc::clone(&hand);
        let thread = Some(thread::spawn(move || {
            firmware.run(&theirs);
            firmware.uhid.unplug();
        }));
        Self { hand, thread }
    }

    /// Puts this onto it, and nothing else.
    pub(crate) fn bear(&self, load: Load) {
        self.hand.lock().expect("its thread lives").load = load;
    }

    /// Its radio is out of reach, or back.
    pub(crate) fn fall_silent(&self, is_silent: bool) {
        self.hand.lock().expect("its thread lives").is_silent = is_silent;
    }

    /// Its connection ends; returns the stamp of that moment.
    pub(crate) fn drop_connection(self) -> u64 {
        let stamp_ns = stamp_ns();
        drop(self);
        stamp_ns
    }
}

impl Drop for Board {
    fn drop(&mut self) {
        if let Ok(mut hand) = self.hand.lock() {
            hand.is_switched_off = true;
        }
        let ended = self.thread.take().map(JoinHandle::join);
        assert!(thread::panicking() || matches!(ended, Some(Ok(()))), "the board's firmware panicked");
    }
}

/// A descriptor that tells the reports above: bytes without a meaning.
fn descriptor() -> Vec<u8> {
    // Generic desktop, a game pad; bytes of 0 to 255.
    let mut bytes = vec![0x05, 0x01, 0x09, 0x05, 0xa1, 0x01, 0x15, 0x00, 0x26, 0xff, 0x00, 0x75, 0x08];
    for (kind, reports) in [(0x91, &OUTPUTS[..]), (0x81, &INPUTS[..])] {
        for (id, length) in reports {
            // Its number, so many bytes, of a maker's own page.
            bytes.extend([0x85, *id, 0x95, *length, 0x06, 0x00, 0xff, 0x09, 0x01, kind, 0x00]);
        }
    }
    bytes.push(0xc0);
    bytes
}

/// The registers of the board's cells, at 0xa40000.
fn registers(make: &Make) -> [u8; 256] {
    let mut registers = [0xff; 256];
    registers[0x20..0x24].copy_from_slice(&[0x10, 0x69, 0x00, 0x00]);
    let numbers = (0..3).flat_map(|step| make.points.iter().map(move |points| points[step]));
    for (to, number) in registers[0x24..0x3c].as_chunks_mut::<2>().0.iter_mut().zip(numbers) {
        *to = number.to_be_bytes();
    }
    registers[0xfa..].copy_from_slice(&IDENTITY);
    registers
}

/// What runs on the board.
struct Firmware {
    uhid: Uhid,
    make: Make,
    registers: [u8; 256],
    /// The report that the system asked for; 0 for none.
    mode: u8,
    lights: u8,
    noise: SplitMix64,
    /// Reports that answer, each with the time at which it goes.
    answers: VecDeque<(u64, Vec<u8>)>,
}

impl Firmware {
    fn run(&mut self, hand: &Mutex<Hand>) {
        let mut report_ns = monotonic_ns();
        loop {
            let (load, is_silent) = {
                let hand = hand.lock().expect("the test lives");
                if hand.is_switched_off {
                    return;
                }
                (hand.load, hand.is_silent)
            };
            while self.answers.front().is_some_and(|(due_ns, _)| *due_ns <= monotonic_ns()) {
                let answer = self.answers.pop_front().expect("it was there").1;
                if answer[0] == 0x20 {
                    self.mode = 0;
                }
                self.uhid.report(&answer);
            }
            if report_ns <= monotonic_ns() {
                report_ns += PERIOD_NS;
                if !is_silent {
                    self.report(load);
                }
            }
            let due_ns = self.answers.front().map_or(report_ns, |(due_ns, _)| report_ns.min(*due_ns));
            if readable_before(due_ns, self.uhid.fd())
                && let Some(request) = self.uhid.hear()
                && !is_silent
            {
                self.take(&request);
            }
        }
    }

    /// Sends what it measures, if the system asked for that.
    fn report(&mut self, load: Load) {
        let cells_at = match self.mode {
            0x32 | 0x34 => 3,
            0x35 => 6,
            _ => return,
        };
        let mut report = vec![0; report_length(self.mode)];
        report[0] = self.mode;
        for cell in 0..4 {
            // A cell is never still.
            let reads = self.make.reads(cell, load.kg(cell)) + 2.0 * f64::from(self.noise.normal());
            let at = cells_at + 2 * cell;
            report[at..at + 2].copy_from_slice(&(reads.round() as u16).to_be_bytes());
        }
        if self.mode == 0x34 {
            report[cells_at + 8] = 0x19;
            report[cells_at + 10] = self.make.battery;
        }
        self.uhid.report(&report);
    }

    fn take(&mut self, request: &[u8]) {
        let byte = |at: usize| request.get(at).copied().unwrap_or_default();
        let address = u32::from_be_bytes([0, byte(2), byte(3), byte(4)]);
        let is_register = byte(1) & 0x04 != 0;
        match byte(0) {
            0x11 => self.lights = byte(1) & 0xf0,
            0x12 => self.mode = byte(2),
            // Whatever the battery is, a board says the same here.
            0x15 => self.answer(vec![0x20, 0, 0, self.lights | 0x02, 0, 0, 0xf2]),
            0x16 => {
                let length = usize::from(byte(5)).min(16);
                let error = match self.place(is_register, address, length) {
                    Ok(place) => {
                        self.registers[place..place + length].copy_from_slice(&request[6..6 + length]);
                        0
                    }
                    Err(error) => error,
                };
                self.answer(vec![0x22, 0, 0, 0x16, error]);
            }
            0x17 => self.send_memory(is_register, address, u16::from_be_bytes([byte(5), byte(6)]).into()),
            _ => {}
        }
    }

    fn send_memory(&mut self, is_register: bool, address: u32, length: usize) {
        for from in (0..length).step_by(16) {
            let (part, at) = ((length - from).min(16), address + from as u32);
            let mut bytes = [0; 16];
            let error = match self.place(is_register, at, part) {
                // What it is, it says only to who has switched the encryption off.
                Ok(place) if self.registers[0xf0] == 0x55 && self.registers[0xfb] == 0x00 => {
                    bytes[..part].copy_from_slice(&self.registers[place..place + part]);
                    0
                }
                Ok(_) => NO_DEVICE,
                Err(error) => error,
            };
            let size = (part as u8 - 1) << 4;
            let [_, _, high, low] = at.to_be_bytes();
            let mut answer = vec![0x21, 0, 0, size | error, high, low];
            answer.extend(bytes);
            self.answer(answer);
        }
    }

    /// Where in the cells' registers an address is.
    fn place(&self, is_register: bool, address: u32, length: usize) -> Result<usize, u8> {
        let place = (address & 0xff) as usize;
        match address >> 8 {
            0xa400 if is_register && place + length <= self.registers.len() => Ok(place),
            _ if is_register => Err(NO_DEVICE),
            _ => Err(NO_ADDRESS),
        }
    }

    fn answer(&mut self, report: Vec<u8>) {
        self.answers.push_back((monotonic_ns() + self.make.latency_ns, report));
    }
}

fn report_length(id: u8) -> usize {
    let length = INPUTS.iter().find(|(input, _)| *input == id).expect("a report of a remote").1;
    1 + usize::from(length)
}
