//! Restarts that say why: the reason survives in the watchdog's registers, the product's name on the USB tells it, and the light for a
//! minute.

use core::fmt::{self, Write};
use core::panic::PanicInfo;

use rp2040_hal::pac;

/// In the first register with a reason below it: what is there after power-on is no reason.
const MAGIC: u32 = 0x7AC7_0000;

const PANIC: u32 = 1;
const HARD_FAULT: u32 = 2;
const FAILED: u32 = 3;

/// No reason yet: the program runs. The boot ROM restarts by the watchdog, too, after it has taken a new program, and has not this.
const RUNNING: u32 = 4;

/// Why the chip was restarted.
#[derive(Clone, Copy)]
pub(crate) enum Why {
    /// The loop did not come round.
    Watchdog,
    /// The program gave up in this line of a file.
    Panic(u32),
    /// The processor could not go on, at this address.
    HardFault(u32),
    /// What the program needs at its start was not there; the line that says so.
    Failed(u32),
}

impl fmt::Display for Why {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Watchdog => write!(f, "restarted: stood still"),
            Self::Panic(line) => write!(f, "restarted: panic in line {line}"),
            Self::HardFault(address) => write!(f, "restarted: fault at {address:#x}"),
            Self::Failed(line) => write!(f, "restarted: no start, line {line}"),
        }
    }
}

fn watchdog() -> &'static pac::watchdog::RegisterBlock {
    // SAFETY: what is used here is written as whole words, and the rest of the program only feeds it.
    unsafe { &*pac::WATCHDOG::ptr() }
}

/// A restart of the chip by itself.
#[derive(Clone, Copy)]
pub(crate) struct Restart {
    pub(crate) why: Why,
    /// How many there were since power-on, or since the program had run well for a while.
    pub(crate) in_a_row: u32,
    /// What the pad sent before it, as a host chose it; no number of the wire if none did.
    pub(crate) output: u16,
}

/// The restart that began this run; `None` after power-on. It is told once.
pub(crate) fn last() -> Option<Restart> {
    let watchdog = watchdog();
    let (kind, detail) = (watchdog.scratch0().read().bits(), watchdog.scratch1().read().bits());
    watchdog.scratch0().write(|w| unsafe { w.bits(MAGIC | RUNNING) });
    let why = match kind.wrapping_sub(MAGIC) {
        PANIC => Some(Why::Panic(detail)),
        HARD_FAULT => Some(Why::HardFault(detail)),
        FAILED => Some(Why::Failed(detail)),
        RUNNING if watchdog.reason().read().timer().bit_is_set() => Some(Why::Watchdog),
        _ => None,
    };
    let before = if why.is_some() { watchdog.scratch2().read().bits() } else { 0 };
    let in_a_row = before.saturating_add(u32::from(why.is_some()));
    watchdog.scratch2().write(|w| unsafe { w.bits(in_a_row) });
    let Some(why) = why else {
        keep_output(u16::MAX);
        return None;
    };
    Some(Restart { why, in_a_row, output: watchdog.scratch3().read().bits() as u16 })
}

/// Keeps what a host chose that the pad sends, for the next start if that is a restart.
pub(crate) fn keep_output(output: u16) {
    watchdog().scratch3().write(|w| unsafe { w.bits(u32::from(output)) });
}

/// The program has run well for a while: the next restart is the first again.
pub(crate) fn forget() {
    watchdog().scratch2().write(|w| unsafe { w.bits(0) });
}

fn restart(kind: u32, detail: u32) -> ! {
    let watchdog = watchdog();
    watchdog.scratch0().write(|w| unsafe { w.bits(MAGIC | kind) });
    watchdog.scratch1().write(|w| unsafe { w.bits(detail) });
    // All of the chip but its oscillators, as the watchdog does when it is not fed.
    // SAFETY: nothing runs on after this.
    let machine = unsafe { &*pac::PSM::ptr() };
    machine.wdsel().write(|w| unsafe { w.bits(0x0001_FFFC) });
    loop {
        watchdog.ctrl().modify(|_, w| w.trigger().set_bit());
    }
}

/// Restarts because what the program needs at its start is not there.
pub(crate) fn fail(line: u32) -> ! {
    restart(FAILED, line)
}

/// Into the boot ROM: the board becomes a drive that takes the next firmware.
pub(crate) fn into_bootloader() -> ! {
    watchdog().scratch0().write(|w| unsafe { w.bits(0) });
    rp2040_hal::rom_data::reset_to_usb_boot(0, 0)
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    restart(PANIC, info.location().map_or(0, |place| place.line()))
}

#[cortex_m_rt::exception]
unsafe fn HardFault(frame: &cortex_m_rt::ExceptionFrame) -> ! {
    restart(HARD_FAULT, frame.pc())
}

/// A short text: the most that a USB string holds here. What is too long is cut off.
pub(crate) struct Text {
    bytes: [u8; 62],
    len: usize,
}

impl Default for Text {
    fn default() -> Self {
        Self { bytes: [0; 62], len: 0 }
    }
}

impl Text {
    pub(crate) fn as_str(&self) -> &str {
        core::str::from_utf8(&self.bytes[..self.len]).unwrap_or_default()
    }
}

impl Write for Text {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes().filter(u8::is_ascii) {
            *self.bytes.get_mut(self.len).ok_or(fmt::Error)? = byte;
            self.len += 1;
        }
        Ok(())
    }
}
