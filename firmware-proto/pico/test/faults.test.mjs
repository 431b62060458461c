// Faults that last: a board whose converters are not there, and one that is not there itself.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { BYTES, UNPLUGGED } from './host/capture.mjs';
import { events, hearing, isDown, isUp, pressed } from './player.mjs';
import { ALL } from './faults.mjs';

const WELL_MAX_MS = 150;
const RESTARTED = 0x0400;

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
  board.run(WELL_MAX_MS);
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
