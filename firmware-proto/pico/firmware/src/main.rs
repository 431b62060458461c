//! The pad's firmware for a Raspberry Pi Pico: three ADS131M03 on one bus, a USB serial port and a USB HID at once.
//!
//! Interrupts take samples: data-ready stamps the time and DMA brings one frame after the other. Everything else is this file's loop,
//! which sleeps while there is nothing to do. No memory is allocated. What cannot go on restarts the chip and says why.

#![no_std]
#![no_main]

mod board;
mod converters;
mod flash;
mod measure;
mod ports;
mod restart;
mod sampling;

use core::fmt::Write;

use firmware_proto::command::Command;
use firmware_proto::frame::WireError;
use firmware_proto::identity::SerialNumber;
use pad::frames::FrameReader;
use pad::light::State;
use pad::pad::{Board, Output, Pad, digits};
use pad::rate::{RATE_DEFAULT_HZ, Rate};

use crate::board::Chip;
use crate::converters::Converters;
use crate::measure::Measure;
use crate::ports::Ports;
use crate::restart::{Text, fail};

/// How the flash is set up before the program starts: plain reads, which any chip of the kind understands, and which leave it ready
/// for other commands.
#[unsafe(link_section = ".boot2")]
#[used]
static BOOT2: [u8; 256] = rp2040_boot2::BOOT_LOADER_GENERIC_03H;

/// Beyond two periods, data-ready may be late by this, in microseconds.
const LATE_MAX_US: u64 = 20_000;

/// While the converters are silent, the host is told so often, in microseconds.
const SILENT_PERIOD_US: u64 = 10_000;

/// While they are silent or lost, they are begun anew so often, in microseconds.
const RETRY_PERIOD_US: u64 = 50_000;

/// From one measurement of the board to the next, in microseconds.
const MEASURE_PERIOD_US: u64 = 10_000;

/// For so long after a restart the light tells it, in microseconds; after it, the next restart is the first again.
const RESTART_TOLD_US: u64 = 60_000_000;

/// After more restarts than this in a row the light tells it before anything else is tried, for a second each time: what fails so
/// early shows nothing on the USB.
const RESTARTS_MAX: u32 = 3;

/// What of it all is where: when something was done last, in microseconds.
struct Times {
    sampled_us: u64,
    told_us: u64,
    begun_us: u64,
    measured_us: u64,
}

#[rp2040_hal::entry]
fn main() -> ! {
    let restart = restart::last();
    let unique = flash::unique_number();
    let Some(mut chip) = Chip::take() else { fail(line!()) };
    if restart.is_some_and(|it| it.in_a_row > RESTARTS_MAX) {
        chip.show_a_second(State::Restarted);
    }
    let serial_digits = digits(unique);
    let serial_text = core::str::from_utf8(&serial_digits).unwrap_or_default();
    let Some(serial_number) = SerialNumber::from_ascii(serial_text) else { fail(line!()) };
    let Some(rate) = Rate::near(RATE_DEFAULT_HZ) else { fail(line!()) };

    let mut product = Text::default();
    let _ = write!(product, "tactpad pad {}", env!("CARGO_PKG_VERSION"));
    if let Some(restart) = restart {
        let _ = write!(product, " ({})", restart.why);
    }
    let mut restart_told_until_us = restart.map_or(0, |_| RESTART_TOLD_US);
    let allocator = chip.usb.take().unwrap_or_else(|| fail(line!()));
    let mut ports = Ports::new(&allocator, serial_text, product.as_str());

    let measure = Measure::new();
    // What a host chose holds over restarts by the chip itself.
    let chosen = restart.and_then(|it| Output::of(it.output));
    let output =
        chosen.unwrap_or(if board::asks_for_contacts() { Output::Contacts } else { Output::Channels });
    let mut pad = Pad::new(serial_number, rate, output);
    let mut reader = FrameReader::default();
    let mut converters = Converters::new(chip.timer);
    let mut board =
        Board { excitation: measure.excitation(), temperature_centi_c: measure.temperature_centi_c() };
    let mut well = converters.begin(rate);
    let now_us = board::now_us();
    let mut times = Times { sampled_us: now_us, told_us: now_us, begun_us: now_us, measured_us: now_us };

    loop {
        chip.watchdog.feed();
        ports.poll();
        let now_us = board::now_us();

        if let Some(taken) = sampling::take() {
            let codes = reader.read(&taken.frames);
            well &= !codes.restart;
            pad.skip(taken.missed);
            ports.send(&pad.message(&codes, taken.time_us, &board), pad.rate());
            (times.sampled_us, times.told_us) = (now_us, now_us);
        } else if now_us > times.sampled_us + LATE_MAX_US + 2 * u64::from(pad.rate().period_us()) {
            well = false;
            if now_us >= times.told_us + SILENT_PERIOD_US {
                ports.send(&pad.message(&reader.silence(), now_us, &board), pad.rate());
                times.told_us = now_us;
            }
        }

        let (rate, output) = (pad.rate(), pad.output());
        while let Some(command) = ports.command() {
            obey(&mut pad, &mut ports, command, now_us);
        }
        if pad.output() != output {
            restart::keep_output(pad.output() as u16);
            ports.begin_anew();
        }
        if ports.asks_for_bootloader() {
            restart::into_bootloader();
        }
        if pad.rate() != rate || (!well && now_us >= times.begun_us + RETRY_PERIOD_US) {
            well = converters.begin(pad.rate());
            times.begun_us = board::now_us();
        }

        if now_us >= times.measured_us + MEASURE_PERIOD_US {
            times.measured_us = now_us;
            board.excitation.see(measure.excitation_uv());
            board.temperature_centi_c = measure.temperature_centi_c();
        }
        let state = match () {
            () if pad.is_shown(now_us) => State::Shown,
            () if !well || board.excitation.is_out_of_tolerance() => State::Fault,
            () if restart_told_until_us > 0 && ports.state() != State::Asleep => State::Restarted,
            () => ports.state(),
        };
        if restart_told_until_us > 0 && now_us >= restart_told_until_us {
            restart_told_until_us = 0;
            restart::forget();
        }
        board::light(state.is_lit(now_us / 1_000));
        sampling::sleep_until_something_happens();
    }
}

fn obey(pad: &mut Pad, ports: &mut Ports, command: (ports::Port, Result<Command, WireError>), now_us: u64) {
    let (port, command) = command;
    if let Some(answer) = pad.answer(command, now_us) {
        ports.answer(port, &answer);
    }
}
