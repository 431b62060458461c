// The program gives up, or the processor cannot go on, or the loop does not come round: the chip restarts, says why by name and light,
// and plays again without help. Nothing hangs in silence.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { FLASH } from './board/image.mjs';
import { functions, panics } from './board/program.mjs';
import { image } from './board/chip.mjs';
import { events, hearing, isDown, isUp, pressed } from './player.mjs';
import { drawn, seed, shuffled } from './setting.mjs';

/** From a panic or a fault of the processor to the next start; from a standstill the watchdog's time comes first. */
const AT_ONCE_MS = 1;
const WATCHDOG_MS = 510;

/** A host lets a device that comes settle for so long (USB 2.0, 7.1.7.3). */
const SETTLE_MS = 100;

/** From the start to the first sample at the host, the settling included. */
const BACK_MAX_MS = 200;

/** Released within this, by the host's time. */
const RELEASED_MAX_MS = 100;

/** The zero is measured anew, on an untouched pad. */
const ZERO_MS = 700;

const RESTARTED = 0x0400;
const RAM = 0x20030000;
const NOWHERE = 0x30000000;

const elf = readFileSync(process.env.TACTPAD_UF2.replace(/uf2$/, 'elf'));
const places = panics(image, FLASH, elf);

/** Has the processor go on with these instructions, which are no part of the program. */
function execute(board, ...instructions) {
  instructions.forEach((instruction, index) => board.mcu.sramView.setUint16(0x30000 + 2 * index, instruction, true));
  board.mcu.core.PC = RAM;
  board.mcu.core.waiting = false;
}

/** What happens to the program, and what it should say of it: each kind. */
const MISHAPS = (() => {
  const panic = (place, where, prepare) => ({
    name: `a panic at ${place.address.toString(16)}${where}`, says: `panic in line ${place.line}`,
    strike: (board) => {
      prepare?.(board);
      board.mcu.core.PC = place.address;
      board.mcu.core.waiting = false;
    },
  });
  const fault = (name, at, strike) => ({ name, says: `fault at 0x${at.toString(16)}`, strike });
  const still = (name, strike) => ({ name, says: 'stood still', ms: WATCHDOG_MS, strike });
  const inInterrupt = (board) => assert.ok(board.run(20, () => board.mcu.core.IPSR > 15), 'no interrupt comes');
  return {
    panics: places.flatMap((place) => [
      panic(place, ''),
      panic(place, ', interrupts off', (board) => (board.mcu.core.PM = true)),
      panic(place, ', in an interrupt', inInterrupt),
    ]),
    faults: [
      fault('no instruction', RAM, (board) => execute(board, 0xde00)),
      fault('no instruction, in an interrupt', RAM, (board) => (inInterrupt(board), execute(board, 0xde00))),
      fault('a read from nowhere', RAM, (board) => ((board.mcu.core.registers[0] = NOWHERE), execute(board, 0x6800))),
      fault('a write to nowhere', RAM, (board) => ((board.mcu.core.registers[0] = NOWHERE), execute(board, 0x6000))),
      fault('a word at an odd address', RAM, (board) => ((board.mcu.core.registers[0] = RAM + 2), execute(board, 0x6800))),
      fault('a jump to nowhere', NOWHERE, (board) => ((board.mcu.core.PC = NOWHERE), (board.mcu.core.waiting = false))),
    ],
    standstills: [
      still('a stack that is nowhere', (board) => (board.mcu.core.SP = NOWHERE)),
      still('a loop without end', (board) => execute(board, 0xe7fe)),
      still('a loop without end, interrupts off', (board) => ((board.mcu.core.PM = true), execute(board, 0xe7fe))),
      still('an interrupt without end', (board) => (inInterrupt(board), execute(board, 0xe7fe))),
    ],
  };
})();

/** So many of each kind; TACTPAD_EVERY takes all. */
const OF_EACH = process.env.TACTPAD_EVERY ? Infinity : 1;

/** How long the light is on in a second, in milliseconds. */
const litMs = (board) => Array.from({ length: 100 }, () => (board.run(10), board.lit)).filter(Boolean).length * 10;

test('a program that cannot go on restarts, says why, and plays again', () => {
  const random = drawn(seed());
  const { board, host, state } = pressed();
  const chosen = Object.values(MISHAPS).flatMap((kind) => shuffled(kind, random).slice(0, OF_EACH));
  // The program hears the pad from a start on.
  let fromNs = board.ns;
  board.run(ZERO_MS);
  for (const [index, { name, says, ms = AT_ONCE_MS, strike }] of chosen.entries()) {
    state.down = true;
    board.run(100 + 50 * random());
    const struckNs = board.ns;
    board.forgetRestarts();
    strike(board);
    assert.ok(board.run(ms, () => board.resets > index), `${name}: it does not restart in ${ms} ms`);
    const [restartedMs, startedNs] = [(board.ns - struckNs) / 1e6, board.ns];
    state.down = false;
    host.samples = { serial: [], hid: [] };
    host.enumerate({ settleMs: SETTLE_MS });
    assert.equal(host.names.product, `tactpad pad 0.1.0 (restarted: ${says})`, name);
    board.run(50);
    const backMs = (host.samples.serial[0]?.ns - startedNs) / 1e6;
    assert.ok(backMs <= BACK_MAX_MS, `${name}: samples after ${backMs} ms`);
    board.run(ZERO_MS);
    for (const port of ['serial', 'hid']) {
      const samples = host.samples[port];
      assert.equal(samples[0].status, RESTARTED, `${name}: ${port}`);
      assert.ok(samples.length > ZERO_MS * 0.99 && samples.slice(1).every((it) => it.status === 0), `${name}: ${port}`);
    }
    state.down = true;
    board.run(100);
    state.down = false;
    const heldAt = (ns) => events(hearing(host.chunks, fromNs, ns)).filter((event) => isDown(event) || isUp(event)).map(isDown);
    const before = heldAt(struckNs);
    assert.equal(before.at(-1), true, `${name}: the press before is not heard`);
    assert.deepEqual(heldAt(struckNs + RELEASED_MAX_MS * 1e6), [...before, false], `${name}: it is held for more than ${RELEASED_MAX_MS} ms`);
    assert.deepEqual(heldAt(board.ns), [...before, false, true], `${name}: the press after is not heard`);
    board.run(100);
    fromNs = startedNs;
    console.log(`${name}: restarted after ${restartedMs.toFixed(1)} ms (${says}), samples ${backMs.toFixed(0)} ms after that`);
  }
  const lit = litMs(board);
  assert.ok(Math.abs(lit - 300) <= 30, `${lit} ms of a second lit`);
  board.run(100);
});

test('a program that fails at every start says so by its light, and plays once it can', () => {
  const { board, host } = pressed();
  const good = board.image;
  const broken = Buffer.from(good);
  const { address } = functions(elf).find(({ name }) => /UsbBusAllocator.*alloc/.test(name));
  broken.writeUInt16LE(0xde00, address - FLASH);
  board.image = broken;
  execute(board, 0xde00);
  const lit = [];
  for (let step = 0; step < 60; step++) {
    board.run(10);
    lit.push(board.lit);
  }
  const flashes = lit.filter((now, index) => now && !lit[index - 1]).length;
  assert.deepEqual([board.resets, flashes], [4, 3], 'restarts and flashes in 0.6 s');
  board.image = good;
  board.forgetRestarts();
  host.samples.serial = [];
  assert.ok(board.run(2500, () => host.wasReset), 'it does not come back');
  host.enumerate({ settleMs: SETTLE_MS });
  assert.match(host.names.product, /\(restarted: fault at 0x1000[0-9a-f]{4}\)/);
  board.run(200);
  assert.deepEqual(host.samples.serial.slice(0, 2).map((it) => it.status), [RESTARTED, 0]);
});
