// Faults: each is told by its status bits, what the player holds is released within 100 ms, and the pad plays on without help.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { BYTES, UNPLUGGED } from './host/capture.mjs';
import { events, hearing, isDown, isUp, pressed } from './player.mjs';
import { drawn, seed, shuffled } from './setting.mjs';

const TOLD_MAX_MS = 100;
const RECOVERED_MAX_MS = 150;
const PERIOD_NS = 1.0006e6;
const RESTARTED = 0x0400;
const SUPPLY = 0x0800;
const ALL = 0x01ff;
const ofModule = (module) => 0b111 << (3 * module);

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

  const told = events(hearing(host.chunks, fromNs, board.ns)).map((event) => ({ ...event, ns: event.t_us * 1e3 }));
  const between = (low, high, is) => told.filter((event) => event.ns >= low && event.ns <= high && is(event));
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
  const entries = hearing(before.host.chunks, beginNs, before.board.ns);
  entries.push({ kind: UNPLUGGED, ns: pulledNs });

  const again = pressed();
  again.board.run(900);
  again.state.down = true;
  again.board.run(200);
  assert.deepEqual(again.host.samples.serial.slice(0, 2).map((it) => it.status), [RESTARTED, 0]);
  const shift = pulledNs + 300e6;
  const late = hearing(again.host.chunks, 0, again.board.ns).filter((entry) => entry.kind === BYTES);
  entries.push(...late.map((entry) => ({ ...entry, ns: entry.ns + shift })));
  const told = events(entries).filter((event) => isDown(event) || isUp(event)).map(isDown);
  assert.deepEqual(told.slice(0, 3), [true, false, true], 'pressed, released, pressed again');
});
