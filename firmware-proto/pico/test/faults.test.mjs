// Faults: each is told by its status bits, what the player holds is released within 100 ms, and the pad plays on without help.

import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { BYTES, UNPLUGGED, heard, read, replay, tactpad, write } from './capture.mjs';
import { drawn, pinVolts, playing, seed } from './setting.mjs';
import { frame, setRate } from './wire.mjs';

const TOLD_MAX_MS = 100;
const RECOVERED_MAX_MS = 150;
const PERIOD_NS = 1.0006e6;
const RESTARTED = 0x0400;
const SUPPLY = 0x0800;
const ALL = 0x01ff;
const ofModule = (module) => 0b111 << (3 * module);

const folder = mkdtempSync(join(tmpdir(), 'tactpad-pico-'));
after(() => rmSync(folder, { recursive: true }));
const file = (name) => join(folder, name);

/** Channels of a press that Super Mario's profile takes for a direction, in microvolts, and the event. */
const PRESS = (() => {
  writeFileSync(file('press.csv'), 'x_mm,y_mm,fx_n,fy_n,fz_n\n18,0,0,0,2\n');
  tactpad('simulate', '--contacts', file('press.csv'), '--out', file('channels.csv'));
  return readFileSync(file('channels.csv'), 'utf8').trim().split('\n')[1].split(',').slice(-9).map(Number);
})();
const isDown = (event) => event.code === 'ABS_HAT0X' && event.value === 1;
const isUp = (event) => event.code === 'ABS_HAT0X' && event.value === 0;

const head = (() => {
  tactpad('record', file('virtual'), '--pad', 'virtual', '--seconds', '0.5');
  const entries = read(readFileSync(file('virtual')));
  return entries.slice(0, entries.findIndex((it) => it.kind === BYTES)).map((entry) => ({ ...entry, ns: 0 }));
})();

/** A pad that is pressed or not, with channels that a fault replaces. */
function pressed() {
  const state = { down: false, replaced: new Map() };
  const { board, host } = playing(() => PRESS.map((uv, channel) => state.replaced.get(channel) ?? pinVolts(state.down ? uv : 0)));
  return { board, host, state };
}

/** Faults that the converters, the supply and the host make: how they begin and end, and the bits that tell them. */
const faults = (random) => {
  const module = () => Math.floor(random() * 3);
  const channel = () => Math.floor(random() * 9);
  const [damaged, silentBits, lost, gone] = [module(), ALL, module(), module()];
  const [high, low, open] = [channel(), channel(), channel()];
  return [
    { name: `wrong checksums of module ${damaged}`, bits: ofModule(damaged), ms: 60,
      begin: ({ board }) => (board.converters[damaged].faults.corrupt = Infinity),
      end: ({ board }) => (board.converters[damaged].faults.corrupt = 0) },
    { name: 'silent data-ready', bits: silentBits, ms: 250,
      begin: ({ board }) => (board.converters[0].faults.silent = true),
      end: ({ board }) => (board.converters[0].faults.silent = false) },
    { name: `channel ${high} saturated, positive`, bits: 1 << high, ms: 60,
      begin: ({ state }) => state.replaced.set(high, 0.04), end: ({ state }) => state.replaced.delete(high) },
    { name: `channel ${low} saturated, negative`, bits: 1 << low, ms: 60,
      begin: ({ state }) => state.replaced.set(low, -0.04), end: ({ state }) => state.replaced.delete(low) },
    // A tap that lost a gauge goes to the excitation or to ground.
    { name: `channel ${open} open`, bits: 1 << open, ms: 60,
      begin: ({ state }) => state.replaced.set(open, 1.25), end: ({ state }) => state.replaced.delete(open) },
    { name: `converter ${lost} browned out`, bits: ofModule(lost), ms: 60, may: ALL,
      begin: ({ board }) => board.converters[lost].brownOut(), end: () => {} },
    { name: `converter ${gone} gone from the bus`, bits: ofModule(gone), ms: 200, may: ALL,
      begin: ({ board }) => (board.converters[gone].faults.floating = true),
      end: ({ board }) => (board.converters[gone].faults.floating = false) },
    { name: 'excitation too low', bits: SUPPLY, ms: 60,
      begin: ({ board }) => (board.excitationV = 2.2), end: ({ board }) => (board.excitationV = 2.5) },
    { name: 'a host that does not read for a second', ms: 1000,
      begin: ({ host }) => host.read(false), end: ({ host }) => host.read(true) },
    { name: 'a machine that sleeps', ms: 400, begin: ({ host }) => host.suspend(), end: ({ host }) => host.resume() },
  ];
};

/** The same in another order. */
function shuffled(list, random) {
  const rest = [...list];
  return list.map(() => rest.splice(Math.floor(random() * rest.length), 1)[0]);
}

test('every fault is told and released within 100 ms, and the pad plays on without help', () => {
  const random = drawn(seed());
  const play = pressed();
  const { board, host, state } = play;
  const fromNs = board.ns;
  board.run(900);
  const marks = [];
  for (const fault of shuffled(faults(random), random)) {
    state.down = true;
    const pressNs = board.ns;
    board.run(150);
    const beginNs = board.ns;
    fault.begin(play);
    board.run(fault.ms);
    const endNs = board.ns;
    fault.end(play);
    board.run(RECOVERED_MAX_MS);
    const recoveredNs = board.ns;
    board.run(100);
    state.down = false;
    board.run(150);
    marks.push({ fault, pressNs, beginNs, endNs, recoveredNs, doneNs: board.ns });
  }
  state.down = true;
  board.run(150);
  marks.push({ pressNs: board.ns - 150e6 });
  const untilNs = board.ns;
  state.down = false;
  board.run(100);

  writeFileSync(file('faults'), write(heard(head, host.chunks, fromNs, board.ns)));
  const events = replay(file('faults')).map((event) => ({ ...event, ns: event.t_us * 1e3 }));
  const between = (low, high, is) => events.filter((event) => event.ns >= low && event.ns <= high && is(event));
  marks.forEach(({ fault, pressNs, beginNs, endNs, recoveredNs, doneNs }, index) => {
    const name = fault?.name ?? 'after all';
    assert.ok(between(pressNs, beginNs ?? untilNs, isDown).length > 0, `${name}: the press before is not heard`);
    if (!fault) return;
    // Events have the time of their sample's data-ready, and a fault may come between that and the frames.
    const released = between(beginNs - PERIOD_NS, beginNs + TOLD_MAX_MS * 1e6, isUp)[0];
    assert.ok(released, `${name}: nothing is released`);
    for (const port of ['serial', 'hid']) {
      const samples = host.samples[port].filter((it) => it.ns >= beginNs && it.ns <= doneNs);
      const told = samples.find((it) => it.status !== 0);
      if (fault.bits === undefined) {
        assert.equal(told, undefined, `${name}: ${port} tells a fault of the pad`);
        const before = host.samples[port].findLast((it) => it.ns < beginNs);
        const missed = samples.at(-1).sequence - before.sequence - samples.length;
        assert.ok(missed > 0.9 * fault.ms, `${name}: ${port} misses ${missed} samples`);
      } else {
        const toldMs = (told?.ns - beginNs) / 1e6;
        assert.ok(toldMs <= TOLD_MAX_MS, `${name}: ${port} tells it after ${toldMs} ms`);
        if (port === 'serial') console.log(`${name}: told after ${toldMs.toFixed(1)} ms, released after ${((released.ns - beginNs) / 1e6).toFixed(1)} ms`);
        const all = samples.reduce((bits, it) => bits | it.status, 0);
        assert.equal(all & fault.bits, fault.bits, `${name}: ${port} has bits ${all.toString(16)}`);
        assert.equal(all & ~(fault.may ?? fault.bits), 0, `${name}: ${port} has bits ${all.toString(16)}`);
      }
      const later = samples.filter((it) => it.ns > recoveredNs);
      assert.ok(later.length > 200 && later.every((it) => it.status === 0), `${name}: ${port} does not recover`);
    }
    if (fault.bits === undefined) console.log(`${name}: released after ${((released.ns - beginNs) / 1e6).toFixed(1)} ms`);
  });
  assert.equal(host.receiver.damaged, 0);
  assert.equal(board.resets, 0);
});

test('a board without converters says so by bits and light, and plays when they are there', () => {
  const { board, host } = pressed();
  const gone = (floating) => board.converters.forEach((converter) => (converter.faults.floating = floating));
  const litMs = () => Array.from({ length: 100 }, () => (board.run(10), board.lit)).filter(Boolean).length * 10;
  gone(true);
  for (const converter of board.converters) converter.faults.silent = true;
  board.run(300);
  const told = host.samples.serial.at(-1);
  assert.deepEqual([told.status, board.ns - told.ns < 15e6], [ALL, true]);
  const [flashesMs, from] = [litMs(), host.samples.serial.length];
  assert.ok(Math.abs(flashesMs - 200) <= 30, `${flashesMs} ms of a second lit`);
  gone(false);
  for (const converter of board.converters) converter.faults.silent = false;
  board.run(RECOVERED_MAX_MS);
  const later = host.samples.serial.length;
  assert.ok(later > from);
  assert.equal(litMs(), 1000);
  assert.ok(host.samples.serial.slice(later).every((it) => it.status === 0));
});

test('a pad that is pulled out and put back begins anew', () => {
  const before = pressed();
  const beginNs = before.board.ns;
  before.board.run(900);
  before.state.down = true;
  before.board.run(200);
  const pulledNs = before.board.ns - beginNs;
  const entries = heard(head, before.host.chunks, beginNs, before.board.ns);
  entries.push({ kind: UNPLUGGED, ns: pulledNs });

  const again = pressed();
  const againNs = again.board.ns;
  again.board.run(900);
  again.state.down = true;
  again.board.run(200);
  assert.deepEqual(again.host.samples.serial.slice(0, 2).map((it) => it.status), [RESTARTED, 0]);
  const shift = pulledNs + 300e6;
  const late = heard([], again.host.chunks, 0, again.board.ns).filter((entry) => entry.kind === BYTES);
  entries.push(...late.map((entry) => ({ ...entry, ns: entry.ns + shift })));
  writeFileSync(file('pulled'), write(entries));
  const events = replay(file('pulled')).filter((event) => event.code === 'ABS_HAT0X').map((event) => event.value);
  assert.deepEqual(events.slice(0, 3), [1, 0, 1], 'pressed, released, pressed again');
  assert.ok(againNs > 0);
});

test('a program that stands still is restarted, says so, and plays on', () => {
  const { board, host } = pressed();
  board.run(100);
  const { mcu } = board;
  mcu.sram.set([0xfe, 0xe7], 0x30000); // b .
  mcu.core.PM = true;
  mcu.core.PC = 0x20030000;
  assert.ok(board.run(600, () => board.resets > 0), 'the watchdog does not bite');
  host.samples.serial = [];
  host.enumerate();
  board.run(100);
  assert.equal(host.names.product, 'tactpad pad 0.1.0 (restarted: stood still)');
  const samples = host.samples.serial;
  assert.ok(samples.length > 80);
  assert.equal(samples[0].status, RESTARTED);
  assert.ok(samples.slice(1).every((it) => it.status === 0));
  host.writeSerial(frame(setRate(500)));
  assert.ok(board.run(20, () => host.replies.serial.length > 0), 'it listens again');
});
