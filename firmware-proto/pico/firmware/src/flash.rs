//! The flash chip's unique number, of which the pad makes its serial number.

use core::mem::transmute;
use core::ptr::{read_volatile, write_volatile};

use crate::BOOT2;

/// Asks for the unique number; four bytes follow that mean nothing.
const READ_UNIQUE: u32 = 0x4B;

/// Bytes before the number.
const LEAD: usize = 5;

/// Bytes of the number.
const LEN: usize = 8;

const SSI: usize = 0x1800_0000;
const CTRLR0: usize = SSI;
const SSIENR: usize = SSI + 0x08;
const SER: usize = SSI + 0x10;
const BAUDR: usize = SSI + 0x14;
const SR: usize = SSI + 0x28;
const DR0: usize = SSI + 0x60;

/// SR: a byte has come.
const RECEIVED: u32 = 1 << 3;

/// CTRLR0: bytes, both ways.
const BYTES: u32 = 7 << 16;

/// The pin that selects the flash: its output is as the SSI has it, low, or high.
const SELECT: usize = 0x4001_800C;
const SELECT_BY_SSI: u32 = 0;
const SELECT_LOW: u32 = 2 << 8;
const SELECT_HIGH: u32 = 3 << 8;

/// The number. Call it before interrupts are on: the program cannot be read from the flash meanwhile.
pub(crate) fn unique_number() -> [u8; LEN] {
    // What set up the flash at the start does it again, from memory.
    let mut set_up = [0_u32; 64];
    for (word, bytes) in set_up.iter_mut().zip(BOOT2.chunks_exact(4)) {
        *word = u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
    }
    let mut number = [0; LEN];
    cortex_m::interrupt::free(|_| {
        // SAFETY: nothing else runs. The code returns because it was called, as its authors provide for, and leaves the flash as it
        // was. An odd address is one of Thumb code.
        unsafe {
            let set_up: extern "C" fn() = transmute(set_up.as_ptr() as usize + 1);
            ask_in_memory(set_up, number.as_mut_ptr());
        }
    });
    number
}

/// Runs in memory, and calls nothing that does not.
#[inline(never)]
#[unsafe(link_section = ".data.ask_in_memory")]
unsafe fn ask_in_memory(set_up: extern "C" fn(), number: *mut u8) {
    let put = |address: usize, value: u32| unsafe { write_volatile(address as *mut u32, value) };
    let get = |address: usize| unsafe { read_volatile(address as *const u32) };
    put(SSIENR, 0);
    put(BAUDR, 16);
    put(CTRLR0, BYTES);
    put(SER, 1);
    put(SSIENR, 1);
    put(SELECT, SELECT_LOW);
    let mut index = 0;
    while index < LEAD + LEN {
        put(DR0, if index == 0 { READ_UNIQUE } else { 0 });
        while get(SR) & RECEIVED == 0 {}
        let byte = get(DR0) as u8;
        if index >= LEAD {
            unsafe { write_volatile(number.add(index - LEAD), byte) };
        }
        index += 1;
    }
    put(SELECT, SELECT_HIGH);
    set_up();
    put(SELECT, SELECT_BY_SSI);
}
