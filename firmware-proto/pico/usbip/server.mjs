// The emulated board as a USB/IP server: another machine's kernel sets it up and drives it as if it were plugged in there.
//
// Written from the kernel's description of the protocol (Documentation/usb/usbip_protocol.rst). Numbers are big-endian.
//
//   node server.mjs PORT   with TACTPAD_RP2040JS and TACTPAD_UF2, as ../test/run sets them

import { createServer } from 'node:net';
import { Board } from '../test/board/chip.mjs';
import { Host } from '../test/host/host.mjs';
import { pinVolts } from '../test/setting.mjs';

const BUS = { id: '1-1', bus: 1, device: 2 };
const FULL_SPEED = 2;
const VERSION = 0x0111;
const IMPORT = 0x8003;
const IMPORTED = 0x0003;
const SUBMIT = 1;
const UNLINK = 2;
const SUBMITTED = 3;
const UNLINKED = 4;
const HEAD_LEN = 48;
const REFUSED = -32; // EPIPE
const TAKEN_BACK = -104; // ECONNRESET
const PACKET = 64;

/** Simulated time goes in steps of so many milliseconds, and no faster than the clock on the wall. */
const STEP_MS = 1;

/** What a press reads, in microvolts; and when it is held. */
const PRESS_UV = process.env.TACTPAD_PRESS_UV.split(',').map(Number);
const PERIOD_S = 2;
const PRESSED_FROM_S = 1.2;

/** What the channels tremble by. */
const NOISE_UV = 10;

/** The host's end of the bus, of which a client asks transfers. */
class Exported extends Host {
  constructor(board) {
    super(board);
    this.client = null;
    /** Transfers that wait, for each endpoint and direction. */
    this.waiting = new Map();
  }

  /** After a reset of the bus: what a client is told of the device. */
  begin() {
    this.board.run(200, () => this.wasReset);
    this.board.run(10);
    this.control(0x00, 5, 1, 0);
    this.device = this.control(0x80, 6, 0x0100, 0, 18);
    this.configuration = this.control(0x80, 6, 0x0200, 0, 255);
    this.endpoints = { hidIn: -1, serialIn: -1 };
  }

  queue(endpoint, isIn) {
    const key = endpoint * 2 + isIn;
    if (!this.waiting.has(key)) this.waiting.set(key, []);
    return this.waiting.get(key);
  }

  /** Packets go to the transfers that wait, and stay offered without one. */
  poll() {
    for (const endpoint of [...this.offered.keys()]) {
      const queue = this.queue(endpoint, 1);
      if (queue.length === 0) continue;
      const transfer = queue[0];
      const packet = this.takePacket(endpoint);
      transfer.came = Buffer.concat([transfer.came, packet]);
      if (packet.length < PACKET || transfer.came.length >= transfer.length) {
        queue.shift();
        this.answer(transfer.number, 0, transfer.came);
      }
    }
    for (const [endpoint] of this.wanted) {
      const queue = this.queue(endpoint, 0);
      if (endpoint === 0 || queue.length === 0) continue;
      const transfer = queue[0];
      this.wanted.delete(endpoint);
      this.usb.endpointReadDone(endpoint, transfer.data.subarray(transfer.sent, transfer.sent + PACKET));
      transfer.sent += PACKET;
      if (transfer.sent >= transfer.data.length) {
        queue.shift();
        this.answer(transfer.number, 0, null, transfer.data.length);
      }
    }
  }

  // Reports come once in a millisecond, by the queue.
  fetch() {}

  answer(number, status, bytes, length = bytes?.length ?? 0) {
    const head = Buffer.alloc(HEAD_LEN);
    head.writeUInt32BE(SUBMITTED, 0);
    head.writeUInt32BE(number, 4);
    head.writeInt32BE(status, 20);
    head.writeInt32BE(length, 24);
    this.client?.write(bytes ? Buffer.concat([head, bytes]) : head);
  }

  submit({ number, isIn, endpoint, length, setup, data }) {
    if (endpoint === 0) {
      const [value, index, wanted] = [2, 4, 6].map((at) => setup.readUInt16LE(at));
      const came = this.control(setup[0], setup[1], value, index, isIn ? wanted : data);
      if (came === null) this.answer(number, REFUSED, null);
      else this.answer(number, 0, isIn ? came : null, isIn ? came.length : data.length);
    } else {
      this.queue(endpoint, Number(isIn)).push({ number, length, data, came: Buffer.alloc(0), sent: 0 });
    }
  }

  unlink(number, unwanted) {
    let status = 0;
    for (const queue of this.waiting.values()) {
      const at = queue.findIndex((transfer) => transfer.number === unwanted);
      if (at >= 0) {
        queue.splice(at, 1);
        status = TAKEN_BACK;
      }
    }
    const head = Buffer.alloc(HEAD_LEN);
    head.writeUInt32BE(UNLINKED, 0);
    head.writeUInt32BE(number, 4);
    head.writeInt32BE(status, 20);
    this.client?.write(head);
  }

  /** The answer to who asks for the device. */
  imported() {
    const reply = Buffer.alloc(320);
    reply.writeUInt16BE(VERSION, 0);
    reply.writeUInt16BE(IMPORTED, 2);
    reply.write(`/sys/devices/${BUS.id}`, 8);
    reply.write(BUS.id, 8 + 256);
    [BUS.bus, BUS.device, FULL_SPEED].forEach((word, index) => reply.writeUInt32BE(word, 296 + 4 * index));
    [8, 10, 12].forEach((at, index) => reply.writeUInt16BE(this.device.readUInt16LE(at), 308 + 2 * index));
    reply.set([this.device[4], this.device[5], this.device[6], 0, this.device[17], this.configuration[4]], 314);
    return reply;
  }
}

/** Cuts a client's bytes into messages and has them done. */
function serve(exported, client) {
  let bytes = Buffer.alloc(0);
  let isImported = false;
  const take = (count) => {
    const taken = bytes.subarray(0, count);
    bytes = bytes.subarray(count);
    return taken;
  };
  client.setNoDelay(true);
  client.on('data', (more) => {
    bytes = Buffer.concat([bytes, more]);
    if (!isImported) {
      if (bytes.length < 40) return;
      const asked = take(40);
      if (asked.readUInt16BE(2) !== IMPORT || asked.toString('latin1', 8).replace(/\0.*/s, '') !== BUS.id) return client.destroy();
      isImported = true;
      exported.client = client;
      exported.waiting.clear();
      client.write(exported.imported());
    }
    while (bytes.length >= HEAD_LEN) {
      const [command, number, , direction, endpoint, flagsOrUnwanted, length] = Array.from({ length: 7 }, (_, at) => bytes.readUInt32BE(4 * at));
      const isIn = direction === 1;
      const dataLength = command === SUBMIT && !isIn ? length : 0;
      if (bytes.length < HEAD_LEN + dataLength) return;
      const head = take(HEAD_LEN);
      const data = take(dataLength);
      if (command === SUBMIT) exported.submit({ number, isIn, endpoint, length, setup: head.subarray(40, 48), data });
      else if (command === UNLINK) exported.unlink(number, flagsOrUnwanted);
      else return client.destroy();
    }
  });
  client.on('error', () => {});
  client.on('close', () => (exported.client = exported.client === client ? null : exported.client));
}

const board = new Board((seconds) => {
  const isPressed = seconds % PERIOD_S >= PRESSED_FROM_S;
  return PRESS_UV.map((uv) => pinVolts((isPressed ? uv : 0) + NOISE_UV * (Math.random() - 0.5)));
});
const exported = new Exported(board);
exported.begin();
const begunMs = performance.now() - board.ns / 1e6;
let lostMs = 0;

function step() {
  let behindMs = performance.now() - begunMs - lostMs - board.ns / 1e6;
  if (behindMs > 100) {
    // What cannot be caught up is lost: the board's clock was slow.
    lostMs += behindMs;
    behindMs = STEP_MS;
  }
  if (behindMs >= STEP_MS) {
    board.run(STEP_MS);
    exported.poll();
  }
  if (behindMs > 2 * STEP_MS) setImmediate(step);
  else setTimeout(step, 1);
}

createServer((client) => serve(exported, client)).listen(Number(process.argv[2]), '127.0.0.1', () => {
  console.log('ready');
  step();
});
process.on('SIGTERM', () => {
  console.log(`the board was slower than the clock on the wall by ${lostMs.toFixed(0)} of ${(performance.now() - begunMs).toFixed(0)} ms`);
  process.exit(0);
});
