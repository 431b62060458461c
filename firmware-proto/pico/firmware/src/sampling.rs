//! Samples, taken by interrupts: data-ready stamps the time, and DMA brings the frames of the three converters one after the other
//! into a ring that the loop empties.

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use ads131m0x::device::null_frame;
use ads131m0x::frame::FRAME_MAX;
use cortex_m::peripheral::NVIC;
use cortex_m::peripheral::syst::SystClkSource;
use pad::CONVERTERS;
use pad::frames::{FRAME_LEN, Frames};
use pad::rate::SYSTEM_HZ;
use rp2040_hal::pac::{self, Interrupt, interrupt};

use crate::board::{READY_PIN, SELECT_PINS, drive, now_us};

/// Samples that may wait for the loop: eight milliseconds at the rate after a start.
const RING: usize = 8;

/// The loop comes round at least so often in a second.
const TICKS_HZ: u32 = 100;

/// DMA channels, to the converters and from them, and the requests of the bus that pace them.
const OUT: usize = 0;
const IN: usize = 1;
const BUS_WANTS: u8 = 16;
const BUS_HAS: u8 = 17;

/// What an interrupt puts down.
#[derive(Clone, Copy)]
struct Slot {
    /// Which conversion it is, counted since sampling began.
    number: u32,
    time_us: u64,
    frames: Frames,
}

/// A sample that was taken out of the ring.
pub(crate) struct Taken {
    /// When data were ready.
    pub(crate) time_us: u64,
    /// One frame of each converter.
    pub(crate) frames: Frames,
    /// Conversions before it that were not read.
    pub(crate) missed: u32,
}

struct Ring(UnsafeCell<[Slot; RING]>);

// SAFETY: interrupts of one priority write the slot at PUT and only then step PUT on; the loop reads slots before PUT and only then
// steps TAKEN on. Both counters are single words.
unsafe impl Sync for Ring {}

static SLOTS: Ring =
    Ring(UnsafeCell::new([Slot { number: 0, time_us: 0, frames: [[0; FRAME_LEN]; CONVERTERS] }; RING]));
static PUT: AtomicU32 = AtomicU32::new(0);
static TAKEN: AtomicU32 = AtomicU32::new(0);

/// Conversions that were announced, and the number of the last that was taken.
static ANNOUNCED: AtomicU32 = AtomicU32::new(0);
static LAST: AtomicU32 = AtomicU32::new(0);

/// Whether frames are on their way, and of which converter.
static BUSY: AtomicBool = AtomicBool::new(false);
static CONVERTER: AtomicU32 = AtomicU32::new(0);

struct Outgoing(UnsafeCell<[u8; FRAME_MAX]>);

// SAFETY: it is written before interrupts are on, and then read by DMA only.
unsafe impl Sync for Outgoing {}

static OUTGOING: Outgoing = Outgoing(UnsafeCell::new([0; FRAME_MAX]));

fn slot(count: u32) -> *mut Slot {
    // The ring's length divides the counters' range, so the place goes on where they begin anew.
    SLOTS.0.get().cast::<Slot>().wrapping_add(count as usize % RING)
}

fn dma() -> &'static pac::dma::RegisterBlock {
    // SAFETY: used by this file only.
    unsafe { &*pac::DMA::ptr() }
}

fn pins() -> &'static pac::io_bank0::RegisterBlock {
    // SAFETY: of the interrupts of pins, this file's are the only ones.
    unsafe { &*pac::IO_BANK0::ptr() }
}

const READY_WORD: usize = READY_PIN as usize / 8;
const READY_FALLS: u32 = 1 << (4 * (READY_PIN % 8) + 2);

/// Begins to sample.
pub(crate) fn start() {
    PUT.store(0, Ordering::Relaxed);
    TAKEN.store(0, Ordering::Relaxed);
    ANNOUNCED.store(0, Ordering::Relaxed);
    LAST.store(0, Ordering::Relaxed);
    BUSY.store(false, Ordering::Relaxed);
    // SAFETY: interrupts of sampling are off.
    unsafe { *OUTGOING.0.get() = null_frame() };
    pins().intr(READY_WORD).write(|w| unsafe { w.bits(READY_FALLS) });
    pins().proc0_inte(READY_WORD).modify(|r, w| unsafe { w.bits(r.bits() | READY_FALLS) });
    dma().ints0().write(|w| unsafe { w.bits(1 << IN) });
    dma().inte0().write(|w| unsafe { w.bits(1 << IN) });
    begin_ticks();
    // SAFETY: the handlers below are ready.
    unsafe {
        NVIC::unmask(Interrupt::IO_IRQ_BANK0);
        NVIC::unmask(Interrupt::DMA_IRQ_0);
    }
}

/// Ends sampling: what is on its way comes first, which the bus's own clock sees to, and then bus and converters are at rest.
pub(crate) fn stop() {
    NVIC::mask(Interrupt::IO_IRQ_BANK0);
    while BUSY.load(Ordering::Acquire) {
        core::hint::spin_loop();
    }
    NVIC::mask(Interrupt::DMA_IRQ_0);
}

/// The oldest sample that waits.
pub(crate) fn take() -> Option<Taken> {
    let taken = TAKEN.load(Ordering::Relaxed);
    if taken == PUT.load(Ordering::Acquire) {
        return None;
    }
    // SAFETY: it lies before PUT, so no interrupt writes it.
    let slot = unsafe { *slot(taken) };
    TAKEN.store(taken.wrapping_add(1), Ordering::Release);
    let missed = slot.number.wrapping_sub(LAST.load(Ordering::Relaxed)).wrapping_sub(1);
    LAST.store(slot.number, Ordering::Relaxed);
    Some(Taken { time_us: slot.time_us, frames: slot.frames, missed })
}

/// Begins the transfer of the frame of `converter` into the slot that is being filled.
fn fetch(converter: usize) {
    let filled = slot(PUT.load(Ordering::Relaxed));
    // SAFETY: the slot is not before PUT, so the loop does not read it.
    let to = unsafe { (&raw mut (*filled).frames).cast::<u8>() }.wrapping_add(converter * FRAME_LEN);
    // SAFETY: only its address is taken.
    let bus = unsafe { (*pac::SPI0::ptr()).sspdr().as_ptr() } as u32;
    drive(SELECT_PINS[converter % CONVERTERS], false);
    let into = dma().ch(IN);
    into.ch_read_addr().write(|w| unsafe { w.bits(bus) });
    into.ch_write_addr().write(|w| unsafe { w.bits(to as u32) });
    into.ch_trans_count().write(|w| unsafe { w.bits(FRAME_LEN as u32) });
    into.ch_ctrl_trig().write(|w| unsafe {
        w.treq_sel().bits(BUS_HAS).chain_to().bits(IN as u8).incr_write().set_bit().en().set_bit()
    });
    let out = dma().ch(OUT);
    out.ch_read_addr().write(|w| unsafe { w.bits(OUTGOING.0.get() as u32) });
    out.ch_write_addr().write(|w| unsafe { w.bits(bus) });
    out.ch_trans_count().write(|w| unsafe { w.bits(FRAME_LEN as u32) });
    out.ch_ctrl_trig().write(|w| unsafe {
        w.treq_sel().bits(BUS_WANTS).chain_to().bits(OUT as u8).incr_read().set_bit().en().set_bit()
    });
}

#[interrupt]
fn IO_IRQ_BANK0() {
    let time_us = now_us();
    pins().intr(READY_WORD).write(|w| unsafe { w.bits(READY_FALLS) });
    let number = ANNOUNCED.load(Ordering::Relaxed).wrapping_add(1);
    ANNOUNCED.store(number, Ordering::Relaxed);
    let put = PUT.load(Ordering::Relaxed);
    let is_full = put.wrapping_sub(TAKEN.load(Ordering::Acquire)) as usize >= RING;
    // A sample that the loop has no room for is left out; its number shows it missing.
    if is_full || BUSY.load(Ordering::Relaxed) {
        return;
    }
    BUSY.store(true, Ordering::Relaxed);
    // SAFETY: the slot is not before PUT, so the loop does not read it.
    unsafe {
        (*slot(put)).number = number;
        (*slot(put)).time_us = time_us;
    }
    CONVERTER.store(0, Ordering::Relaxed);
    fetch(0);
}

#[interrupt]
fn DMA_IRQ_0() {
    dma().ints0().write(|w| unsafe { w.bits(1 << IN) });
    let converter = CONVERTER.load(Ordering::Relaxed) as usize;
    drive(SELECT_PINS[converter % CONVERTERS], true);
    if converter + 1 < CONVERTERS {
        CONVERTER.store(converter as u32 + 1, Ordering::Relaxed);
        fetch(converter + 1);
    } else {
        PUT.store(PUT.load(Ordering::Relaxed).wrapping_add(1), Ordering::Release);
        BUSY.store(false, Ordering::Relaxed);
    }
}

/// The USB has something to say: the loop asks what, and lets it wake the chip again when it sleeps the next time.
#[interrupt]
fn USBCTRL_IRQ() {
    NVIC::mask(Interrupt::USBCTRL_IRQ);
}

#[cortex_m_rt::exception]
fn SysTick() {}

fn begin_ticks() {
    // SAFETY: nothing else uses the timer of the processor.
    let mut system = unsafe { cortex_m::Peripherals::steal() }.SYST;
    system.set_clock_source(SystClkSource::Core);
    system.set_reload(SYSTEM_HZ / TICKS_HZ - 1);
    system.clear_current();
    system.enable_counter();
    system.enable_interrupt();
}

/// Sleeps until an interrupt. One that comes after the loop looked and before it sleeps is not lost: it is held back until then, and
/// ends the sleep.
pub(crate) fn sleep_until_something_happens() {
    cortex_m::interrupt::free(|_| {
        if TAKEN.load(Ordering::Relaxed) == PUT.load(Ordering::Acquire) {
            // SAFETY: its handler only masks it.
            unsafe { NVIC::unmask(Interrupt::USBCTRL_IRQ) };
            cortex_m::asm::wfi();
        }
    });
}
