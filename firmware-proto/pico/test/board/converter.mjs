// An ADS131M03, register by register, written from the manufacturer's data sheet (Texas Instruments, SBAS853) and not from our driver.
//
// It has words of 24 bits only, SPI mode 1. It converts what stands at its inputs at the end of a conversion: the filter's delay and
// the converter's noise are left out. Where the sheet leaves something open that matters here, a comment says what was taken.

const CHANNELS = 3;
const REFERENCE_V = 1.2;
const REGISTERS = { ID: 0x00, STATUS: 0x01, MODE: 0x02, CLOCK: 0x03, GAIN1: 0x04, CFG: 0x06 };
const OVERSAMPLING = [128, 256, 512, 1024, 2048, 4096, 8192, 16256];

/** CRC-16, polynomial 1021, started with FFFF, bit by bit. */
export function crc16(bytes) {
  let crc = 0xffff;
  for (const byte of bytes) {
    for (let bit = 7; bit >= 0; bit--) {
      const top = ((crc >> 15) ^ (byte >> bit)) & 1;
      crc = ((crc << 1) & 0xffff) ^ (top ? 0x1021 : 0);
    }
  }
  return crc;
}

/** The code of a voltage between the inputs: the range is the reference over the gain, and its ends hold. */
export function codeOf(volts, gain) {
  const code = Math.round((volts * gain / REFERENCE_V) * 2 ** 23);
  return Math.max(-(2 ** 23), Math.min(2 ** 23 - 1, code));
}

const word = (value) => [(value >> 8) & 0xff, value & 0xff, 0];

export class Converter {
  /** `inputs()` gives the three differential voltages now; `onReady(low)` is told the level of data-ready. */
  constructor(clock, inputs, onReady = () => {}) {
    this.clock = clock;
    this.inputs = inputs;
    this.onReady = onReady;
    this.clockHz = 0;
    this.faults = { silent: false, corrupt: 0, floating: false };
    this.alarm = clock.createAlarm(() => this.convert());
    this.readyAlarm = clock.createAlarm(() => this.onReady(false));
    this.powerUp();
  }

  /** The state after power-on, and after a reset. */
  powerUp() {
    this.registers = new Uint16Array(64);
    this.registers.set([0x2300, 0x0500, 0x0510, 0x070e, 0x0000, 0, 0x0600]);
    for (let channel = 0; channel < CHANNELS; channel++) this.registers[0x0c + 5 * channel] = 0x8000;
    this.answer = 0xff20 | CHANNELS;
    this.fresh = 0;
    this.fifo = [];
    this.inputDamaged = false;
    this.resynchronized = false;
    this.selected = false;
    this.restart();
  }

  /** The clock at the pin CLKIN, in hertz. */
  setClock(hz) {
    this.clockHz = hz;
    this.restart();
  }

  get periodNs() {
    return (2 * OVERSAMPLING[(this.registers[REGISTERS.CLOCK] >> 2) & 7] / this.clockHz) * 1e9;
  }

  /** Conversions begin anew. The filter of third order needs three periods until its first code is whole. */
  restart() {
    this.fifo = [];
    this.fresh = 0;
    this.alarm.cancel();
    this.onReady(false);
    if (this.clockHz > 0) {
      this.dueNs = this.clock.nanos + 3 * this.periodNs;
      this.alarm.schedule(this.dueNs - this.clock.nanos);
    }
  }

  convert() {
    const gain = (channel) => 2 ** ((this.registers[REGISTERS.GAIN1] >> (4 * channel)) & 7);
    const codes = this.inputs().map((volt, channel) => codeOf(volt, gain(channel)));
    // Two conversions are kept; of more, the newest.
    this.fifo = [...this.fifo.slice(-1), codes];
    this.fresh = (1 << CHANNELS) - 1;
    this.dueNs += this.periodNs;
    this.alarm.schedule(this.dueNs - this.clock.nanos);
    if (!this.faults.silent) {
      this.onReady(true);
      // Not read, it goes high shortly before the next conversion, so that there is an edge each time.
      this.readyAlarm.schedule(this.periodNs * 0.95);
    }
  }

  /** A pulse on SYNC/RESET: 2,048 cycles or more reset, fewer synchronize. */
  syncPulse(lowNs) {
    const cycles = (lowNs / 1e9) * this.clockHz;
    if (cycles >= 2048) this.powerUp();
    else if (cycles >= 1) {
      this.resynchronized = true;
      this.restart();
    }
  }

  /** What a supply does that fails for a moment: everything is as after power-on. */
  brownOut() {
    this.powerUp();
  }

  get status() {
    const mode = this.registers[REGISTERS.MODE];
    return (this.resynchronized ? 0x4000 : 0) | (this.inputDamaged ? 0x1000 : 0) | (mode & 0x0f00) | this.fresh;
  }

  /** Chip select. */
  select(low) {
    if (low === this.selected) return;
    this.selected = low;
    if (low) this.beginFrame();
    else this.endFrame();
  }

  beginFrame() {
    const codes = this.fifo.shift() ?? this.lastCodes ?? [0, 0, 0];
    this.lastCodes = codes;
    const answer = this.answer ?? this.status;
    if (this.answer === null) [this.resynchronized, this.inputDamaged] = [false, false];
    const out = [...word(answer), ...codes.flatMap((code) => [(code >> 16) & 0xff, (code >> 8) & 0xff, code & 0xff])];
    out.push(...word(crc16(out)));
    if (this.faults.corrupt > 0) {
      this.faults.corrupt--;
      out[7] ^= 0x10;
    }
    this.out = this.faults.floating ? [] : out;
    this.in = [];
    this.fresh = 0;
    this.readyAlarm.cancel();
    this.onReady(false);
  }

  /** One byte each way. Nothing more comes after the checksum. */
  transfer(byte) {
    if (!this.selected) return 0xff;
    this.in.push(byte);
    return this.out[this.in.length - 1] ?? (this.faults.floating ? 0xff : 0);
  }

  endFrame() {
    this.answer = null;
    // A frame that is broken off does nothing.
    if (this.in.length < 3 * (CHANNELS + 2)) return;
    const words = [];
    for (let at = 0; at + 2 < this.in.length; at += 3) words.push((this.in[at] << 8) | this.in[at + 1]);
    const command = words[0];
    const isWrite = command >> 13 === 0b011;
    const count = isWrite ? (command & 0x7f) + 1 : 0;
    if (this.registers[REGISTERS.MODE] & 0x1000) {
      this.inputDamaged = words[1 + count] !== crc16(this.in.slice(0, 3 * (1 + count)));
    }
    if (this.inputDamaged && !isWrite) return;
    const address = (command >> 7) & 0x3f;
    if (command === 0x0011) {
      this.powerUp();
    } else if (command >> 13 === 0b101 && (command & 0x7f) === 0) {
      this.answer = address === REGISTERS.STATUS ? this.status : this.registers[address];
    } else if (isWrite) {
      // With a wrong checksum registers are written all the same, and the answer is that to NULL.
      if (!this.inputDamaged) this.answer = 0x4000 | (address << 7) | (count - 1);
      for (let index = 0; index < count; index++) this.write(address + index, words[1 + index]);
    }
  }

  write(address, value) {
    if (address <= REGISTERS.STATUS) return;
    // The mark of a reset can only be taken off.
    if (address === REGISTERS.MODE) value &= this.registers[address] | ~0x0400;
    this.registers[address] = value;
    if (address === REGISTERS.CLOCK) this.restart();
  }
}
