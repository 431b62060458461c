// A Raspberry Pi Pico with its three converters: an emulated RP2040 that runs the bytes of the file that is flashed.
//
// The emulator has no boot ROM, so what that does is done here: it checks the second boot stage, copies it to memory and jumps there.

import { createRequire } from 'node:module';
import { readFileSync } from 'node:fs';
import { Converter } from './converter.mjs';
import { bootChecksum, flash } from './image.mjs';
import { Faults } from './processor.mjs';

const { Simulator, ConsoleLogger, LogLevel } = createRequire(`${process.env.TACTPAD_RP2040JS}/`)('rp2040js');

const SELECT_PINS = [5, 6, 7];
const READY_PIN = 8;
const SYNC_PIN = 9;
const CONTACTS_PIN = 22;
const LIGHT_PIN = 25;
const CLOCK_SLICE = 5;
const EXCITATION_INPUT = 0;
const THERMOMETER_INPUT = 4;
const REFERENCE_V = 3;

/** The flash chip's unique number. */
export const UNIQUE = [0xe6, 0x60, 0x58, 0x38, 0x83, 0x0a, 0xbc, 0x01];

/** All of the chip but its oscillators. */
const RESET_ALL = 0x1fffc;

/** The file that is flashed. */
export const image = flash(readFileSync(process.env.TACTPAD_UF2));

/** A peripheral of which the emulator has none, or one that is not enough here. */
class Registers {
  constructor(read, write) {
    this.words = new Map();
    this.readUint32 = (offset) => read?.(offset) ?? this.words.get(offset) ?? 0;
    this.writeUint32 = (offset, value) => {
      this.words.set(offset, value >>> 0);
      write?.(offset, value >>> 0);
    };
  }

  writeUint32Atomic(offset, value, type) {
    const now = this.readUint32(offset);
    this.writeUint32(offset, [value, now ^ value, now | value, now & ~value][type]);
  }
}

export class Board {
  /**
   * `inputs(seconds)` gives the nine differential voltages at the converters' pins, in the wire's order; `jumper`: that for contacts is
   * set.
   */
  constructor(inputs = () => new Array(9).fill(0), { jumper = false } = {}) {
    this.inputs = inputs;
    this.excitationV = 2.5;
    this.temperatureC = 25;
    this.readyNs = [];
    this.resets = 0;
    this.jumper = jumper;
    this.bootloader = false;
    /** What the flash holds. */
    this.image = image;
    /** When the chip was started last: its own time begins anew, the board's goes on. */
    this.startedNs = 0;
    this.start(null);
  }

  get ns() {
    return this.startedNs + (this.simulator?.clock.nanos ?? 0);
  }

  /** Power-on, or a reset by the watchdog, which keeps its registers. */
  start(watchdog) {
    this.startedNs = this.ns;
    this.simulator = new Simulator();
    const mcu = (this.mcu = this.simulator.rp2040);
    mcu.logger = new ConsoleLogger(LogLevel.Error, false);
    mcu.flash.set(this.image, 0);
    this.faults = new Faults(mcu);
    const clock = this.simulator.clock;
    this.converters = SELECT_PINS.map((_, index) => new Converter(
      clock,
      () => this.inputs(this.ns / 1e9).slice(3 * index, 3 * index + 3),
      index === 0 ? (low) => this.ready(low) : undefined,
    ));
    this.wire();
    this.wireFlash();
    const dog = mcu.peripherals[0x40058];
    if (watchdog) {
      dog.scratchData.set(watchdog.scratchData);
      dog.reason = watchdog.reason;
    }
    dog.onWatchdogTrigger = () => {
      // The emulator's would bite again and again before anything else runs.
      dog.alarm.enable = false;
      const reset = mcu.peripherals[0x40010].wdsel;
      if (reset !== RESET_ALL) throw new Error(`the watchdog would reset only ${reset.toString(16)} of the chip`);
      this.restarting = true;
    };
    this.boot();
    this.onStart?.();
  }

  ready(low) {
    if (low) this.readyNs.push(this.ns);
    this.mcu.gpio[READY_PIN].setInputValue(!low);
  }

  wire() {
    const { mcu, converters } = this;
    const clock = this.simulator.clock;
    SELECT_PINS.forEach((pin, index) => mcu.gpio[pin].addListener((state) => converters[index].select(state === 0)));
    let lowNs = 0;
    mcu.gpio[SYNC_PIN].addListener((state) => {
      if (state === 0) lowNs = clock.nanos;
      else for (const converter of converters) converter.syncPulse(clock.nanos - lowNs);
    });
    // Pulled up, unless a jumper is set.
    mcu.gpio[CONTACTS_PIN].setInputValue(!this.jumper);
    const spi = mcu.spi[0];
    let answer = 0xff;
    const done = clock.createAlarm(() => spi.completeTransmit(answer));
    spi.onTransmit = (byte) => {
      answer = converters.reduce((line, converter) => line & converter.transfer(byte), 0xff);
      done.schedule((spi.dataBits / spi.clockFrequency) * 1e9);
    };
    // The emulator's own would step through each edge of the clock for the converters.
    mcu.peripherals[0x40050] = new Registers(null, (offset) => {
      const of = (register) => mcu.peripherals[0x40050].words.get(0x14 * CLOCK_SLICE + register) ?? 0;
      if (offset < 0x14 * CLOCK_SLICE || offset >= 0x14 * (CLOCK_SLICE + 1)) return;
      const runs = of(0x00) & 1 && of(0x0c) > 0;
      const hz = runs ? mcu.clkSys / (of(0x04) / 16) / (of(0x10) + 1) : 0;
      for (const converter of converters) converter.setClock(hz);
    });
    let code = 0;
    const read = clock.createAlarm(() => mcu.adc.completeADCRead(code, false));
    mcu.adc.onADCRead = (input) => {
      const volts = { [EXCITATION_INPUT]: this.excitationV, [THERMOMETER_INPUT]: 0.706 - (this.temperatureC - 27) * 0.001721 };
      code = Math.round(((volts[input] ?? 0) / REFERENCE_V) * 4096);
      read.schedule(2000);
    };
  }

  /** The flash chip as commands reach it: selected by its pin, it answers to the one for its unique number. */
  wireFlash() {
    let bytes = null;
    let answer = 0;
    const pins = new Registers(null, (offset, value) => {
      if (offset === 0x0c) bytes = ((value >> 8) & 3) === 2 ? [] : null;
    });
    this.mcu.peripherals[0x40018] = pins;
    const ssi = this.mcu.peripherals[0x18000];
    this.mcu.peripherals[0x18000] = new Registers(
      (offset) => (offset === 0x60 && bytes ? answer : ssi.readUint32(offset)),
      (offset, value) => {
        if (offset !== 0x60 || !bytes) return ssi.writeUint32(offset, value);
        bytes.push(value);
        answer = bytes[0] === 0x4b ? UNIQUE[bytes.length - 6] ?? 0 : 0;
      },
    );
  }

  boot() {
    const { mcu } = this;
    const stage = this.image.subarray(0, 256);
    if (bootChecksum(stage.subarray(0, 252)) !== stage.readUInt32LE(252)) throw new Error('the boot ROM would not start this');
    // A ROM of which the program uses one function, that into the boot loader: the table, its search, and the function itself.
    const rom = new DataView(new ArrayBuffer(64));
    rom.setUint16(0x14, 0x20, true);
    rom.setUint16(0x18, 0x30 + 1, true);
    rom.setUint16(0x30, 0x4800, true); // ldr r0, [pc, #0]
    rom.setUint16(0x32, 0x4770, true); // bx lr
    rom.setUint32(0x34, 0x38 + 1, true);
    rom.setUint16(0x38, 0xe7fe, true); // b .
    for (let at = 0; at < 64; at += 4) mcu.bootrom[at / 4] = rom.getUint32(at, true);
    mcu.sram.set(stage, 0x41f00);
    mcu.core.SP = 0x20042000;
    mcu.core.LR = 0;
    mcu.core.PC = 0x20041f00;
  }

  /** The supply goes, or comes: time goes on, and nothing happens while it is off. */
  power(on) {
    this.off = !on;
    if (on) this.start(null);
  }

  /** Runs until `done` says so, or for so many milliseconds of simulated time; says whether it was done. */
  run(ms, done = () => false) {
    const endNs = this.ns + ms * 1e6;
    while (this.ns < endNs) {
      if (this.off) {
        this.startedNs = endNs - this.simulator.clock.nanos;
        return false;
      }
      const { mcu, simulator, faults } = this;
      const { core } = mcu;
      const { clock } = simulator;
      const cycleNs = 1e9 / mcu.clkSys;
      for (let step = 0; step < 200 && !this.restarting; step++) {
        if (core.waiting && core.checkForInterrupts()) core.waiting = false;
        if (core.waiting || faults.lockedUp) {
          const leftNs = endNs - this.ns;
          if (leftNs <= 0) break;
          clock.tick(Math.max(1, Math.min(clock.nanosToNextAlarm, leftNs)));
        } else {
          const at = core.PC;
          clock.tick(core.executeInstruction() * cycleNs);
          if (faults.pending) faults.take(at);
        }
      }
      if (core.PC === 0x38) this.bootloader = true;
      if (this.restarting) {
        this.restarting = false;
        this.resets++;
        this.start(mcu.peripherals[0x40058]);
      }
      if (done()) return true;
    }
    return false;
  }

  /** As if it had run well for a minute: the next restart is the first again. */
  forgetRestarts() {
    this.mcu.peripherals[0x40058].scratchData[2] = 0;
  }

  get lit() {
    return this.mcu.gpio[LIGHT_PIN].outputValue;
  }
}
