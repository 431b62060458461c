// A USB host: it sets a device up, reads its serial port and its HID, and writes commands.
//
// The emulator hands over a packet as soon as the device offers it. A real host comes when it likes, so here a packet stays offered
// until it is fetched: the HID's once in a millisecond, the serial port's a short time after.

import { Receiver, message } from './wire.mjs';

const FRAME_NS = 1e6;
const BULK_NS = 20e3;
const AVAILABLE = 1 << 10;
const FULL = 1 << 15;
const STALL = 1 << 11;
/** Buffer controls of endpoint 0. */
const CONTROL_IN = 0x80;
const CONTROL_OUT = 0x84;
const SUSPENDED = 1 << 4;
const RESUME = 1 << 11;

export class Host {
  constructor(board) {
    this.board = board;
    this.samples = { serial: [], hid: [] };
    this.replies = { serial: [], hid: [] };
    this.chunks = [];
    this.receiver = new Receiver((it) => this.take('serial', it));
    this.reads = true;
    this.latencyNs = { serial: [], hid: [] };
    board.onStart = () => this.attach();
    this.attach();
  }

  /** The device's end of the bus, of a chip that has just started. */
  attach() {
    const { mcu, simulator } = this.board;
    const usb = (this.usb = mcu.usbCtrl);
    this.offered = new Map();
    this.wanted = new Map();
    this.endpoints = null;
    this.enabled = false;
    this.wasReset = false;
    usb.onUSBEnabled = () => {
      this.enabled = true;
      usb.resetDevice();
    };
    usb.onResetReceived = () => (this.wasReset = true);
    usb.onEndpointWrite = (endpoint, bytes) => endpoint === 0 && this.control0?.(Buffer.from(bytes));
    usb.onEndpointRead = (endpoint, size) => this.wanted.set(endpoint, size);
    const updated = usb.DPRAMUpdated.bind(usb);
    usb.DPRAMUpdated = (offset, value) => {
      const isIn = offset >= 0x88 && offset < 0x100 && !(offset & 4);
      if (isIn && value & AVAILABLE) this.offer((offset - 0x80) >> 3, offset, value);
      else updated(offset, value);
    };
    // The bit of a suspension is taken off by writing it, which the emulator leaves out.
    const write = usb.writeUint32.bind(usb);
    usb.writeUint32 = (offset, value) => {
      if (offset === 0x50 && usb.rawWriteValue & SUSPENDED) usb.sieStatus &= ~SUSPENDED;
      write(offset, value);
    };
    this.frameAlarm = simulator.clock.createAlarm(() => {
      this.frameAlarm.schedule(FRAME_NS);
      if (!this.asleep && this.reads && this.endpoints) this.fetch(this.endpoints.hidIn);
    });
    this.frameAlarm.schedule(FRAME_NS);
    this.bulkAlarm = simulator.clock.createAlarm(() => {
      if (!this.asleep && this.reads && this.endpoints) this.fetch(this.endpoints.serialIn);
    });
  }

  offer(endpoint, offset, value) {
    const { endpoints, board } = this;
    const last = board.readyNs.at(-1);
    if (endpoints && last !== undefined && this.reads && !this.asleep) {
      const bytes = this.packet(offset, value, endpoint);
      // The packet with a frame's last byte.
      if (endpoint === endpoints.hidIn) this.latencyNs.hid.push(board.ns - last);
      if (endpoint === endpoints.serialIn && bytes.at(-1) === 0) this.latencyNs.serial.push(board.ns - last);
    }
    this.offered.set(endpoint, offset);
    if (endpoints && endpoint === endpoints.serialIn) this.bulkAlarm.schedule(BULK_NS);
  }

  packet(offset, value, endpoint) {
    const at = this.usb.getEndpointBufferOffset(endpoint, false);
    return Buffer.from(this.board.mcu.usbDPRAM.slice(at, at + (value & 0x3ff)));
  }

  /** Fetches what an endpoint offers. */
  fetch(endpoint) {
    const bytes = this.takePacket(endpoint);
    if (bytes) this.received(endpoint, bytes);
  }

  /** Takes the packet that an endpoint offers, if it does. */
  takePacket(endpoint) {
    const offset = this.offered.get(endpoint);
    if (offset === undefined) return undefined;
    this.offered.delete(endpoint);
    const view = this.board.mcu.usbDPRAMView;
    const value = view.getUint32(offset, true);
    const bytes = this.packet(offset, value, endpoint);
    view.setUint32(offset, value & ~(AVAILABLE | FULL), true);
    this.usb.indicateBufferReady(endpoint, false);
    return bytes;
  }

  received(endpoint, bytes) {
    if (endpoint === this.endpoints.serialIn && bytes.length > 0) {
      this.chunks.push({ ns: this.board.ns, bytes });
      this.receiver.push(bytes);
    } else if (endpoint === this.endpoints.hidIn) {
      if (bytes.length !== 64 || bytes[0] !== 1) throw new Error(`a report of ${bytes.length} bytes, id ${bytes[0]}`);
      this.take('hid', message(bytes.subarray(1)));
    }
  }

  take(port, it) {
    if (it.kind === 'sample' || it.kind === 'contact') this.samples[port].push({ ...it, ns: this.board.ns });
    else this.replies[port].push(it);
  }

  /** Whether the device refuses the control transfer at hand. */
  get refuses() {
    return [CONTROL_IN, CONTROL_OUT].some((offset) => this.board.mcu.usbDPRAMView.getUint32(offset, true) & STALL);
  }

  /** A control transfer: the bytes that come, or none; `null` if the device refuses it. */
  control(type, request, value, index, dataOrLength = 0) {
    const reads = (type & 0x80) !== 0;
    const data = reads ? null : Buffer.from(dataOrLength || []);
    const length = reads ? dataOrLength : data.length;
    const came = [];
    let done = false;
    this.wanted.delete(0);
    this.control0 = (bytes) => {
      if (!reads) done = true;
      else {
        came.push(...bytes);
        done = came.length >= length || bytes.length < 64;
      }
    };
    const halves = [value, index, length].flatMap((half) => [half & 0xff, half >> 8]);
    const view = this.board.mcu.usbDPRAMView;
    for (const offset of [CONTROL_IN, CONTROL_OUT]) view.setUint32(offset, view.getUint32(offset, true) & ~STALL, true);
    this.usb.sendSetupPacket(new Uint8Array([type, request, ...halves]));
    if (data?.length && this.board.run(5, () => this.refuses || this.wanted.has(0)) && !this.refuses) {
      this.usb.endpointReadDone(0, data);
    }
    const ended = this.board.run(50, () => done || this.refuses);
    if (this.refuses) return null;
    if (!ended) throw new Error(`no answer to request ${request} of type ${type.toString(16)}`);
    this.board.run(0.3);
    if (reads) this.usb.endpointReadDone(0, Buffer.alloc(0));
    this.board.run(0.3);
    this.control0 = null;
    return Buffer.from(came);
  }

  string(index) {
    const bytes = this.control(0x80, 6, 0x0300 | index, 0x0409, 255);
    return bytes.subarray(2, bytes[0]).toString('utf16le');
  }

  /** Sets the device up, as a system does that knows its classes, and opens its serial port. */
  enumerate({ open = true, settleMs = 1 } = {}) {
    if (!this.board.run(200, () => this.wasReset)) throw new Error('the device does not show itself on the bus');
    this.board.run(settleMs);
    this.control(0x00, 5, 1, 0);
    this.device = this.control(0x80, 6, 0x0100, 0, 18);
    const total = this.control(0x80, 6, 0x0200, 0, 9).readUInt16LE(2);
    const configuration = this.control(0x80, 6, 0x0200, 0, total);
    const found = interfaces(configuration);
    this.reportDescriptor = this.control(0x81, 6, 0x2200, found.hid, found.reportLength);
    this.names = { maker: this.string(this.device[14]), product: this.string(this.device[15]), serial: this.string(this.device[16]) };
    this.control(0x00, 9, configuration[5], 0);
    this.found = found;
    this.endpoints = found.endpoints;
    if (open) this.open();
  }

  /** Opens or closes the serial port. */
  open(opened = true, baud = 115200) {
    const coding = Buffer.alloc(7);
    coding.writeUInt32LE(baud, 0);
    coding[6] = 8;
    this.control(0x21, 0x20, 0, this.found.serial, coding);
    this.control(0x21, 0x22, opened ? 3 : 0, this.found.serial);
  }

  /** Writes to the serial port. */
  writeSerial(bytes) {
    this.usb.endpointReadDone(this.endpoints.serialOut, Buffer.from(bytes));
  }

  /** Writes a command's body as a report. */
  writeHid(body) {
    const report = Buffer.alloc(64);
    report.set([2, ...body]);
    this.usb.endpointReadDone(this.endpoints.hidOut, report);
  }

  /** The bus falls silent, as when the machine sleeps. */
  suspend() {
    this.asleep = true;
    this.usb.sieStatus |= SUSPENDED;
    this.usb.sieStatusUpdated();
  }

  resume() {
    this.usb.sieStatus |= RESUME;
    this.usb.sieStatusUpdated();
    this.asleep = false;
    // What was offered before is fetched by the next polls.
    this.bulkAlarm.schedule(BULK_NS);
  }

  /** Reads, or does not. */
  read(reads) {
    this.reads = reads;
    if (reads) this.bulkAlarm.schedule(BULK_NS);
  }
}

/** What of a configuration a host needs. */
function interfaces(bytes) {
  const found = { endpoints: {} };
  let [number, kind] = [0, 0];
  for (let at = 0; at < bytes.length; at += bytes[at]) {
    const type = bytes[at + 1];
    if (type === 4) {
      [number, kind] = [bytes[at + 2], bytes[at + 5]];
      if (kind === 2) found.serial = number;
      if (kind === 3) found.hid = number;
    } else if (type === 0x21 && kind === 3) {
      found.reportLength = bytes.readUInt16LE(at + 7);
    } else if (type === 5) {
      const [address, isIn] = [bytes[at + 2] & 15, (bytes[at + 2] & 0x80) !== 0];
      if (kind === 10) found.endpoints[isIn ? 'serialIn' : 'serialOut'] = address;
      if (kind === 3) found.endpoints[isIn ? 'hidIn' : 'hidOut'] = address;
      if (kind === 3 && isIn) found.hidInterval = bytes[at + 6];
    }
  }
  return found;
}
