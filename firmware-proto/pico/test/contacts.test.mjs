// The pad decodes on its own: chosen by command or jumper, and told in the stream. How well stands in play.test.mjs.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { IDENTIFY, frame, setOutput, setRate } from './host/wire.mjs';
import { events, hearing, isDown, isUp, pressed } from './player.mjs';
import { askForContacts, playing } from './setting.mjs';

const RESTARTED = 0x0400;
const UNTRUSTED = 0x0800;
const ZERO_MS = 500;

test('a command chooses contacts, and the stream says so', () => {
  const { board, host } = playing();
  const answer = (body) => {
    host.replies.serial = [];
    host.writeSerial(frame(body));
    assert.ok(board.run(20, () => host.replies.serial.length > 0), 'no answer');
    return host.replies.serial[0];
  };
  assert.deepEqual(answer(setOutput(2)), { kind: 'acknowledgement', command: 0x84, result: 1 });
  for (const [output, kind, channels] of [[1, 'contact', 0], [0, 'sample', 9], [1, 'contact', 0]]) {
    const from = { serial: host.samples.serial.length, hid: host.samples.hid.length };
    assert.deepEqual(answer(setOutput(output)), { kind: 'acknowledgement', command: 0x84, result: 0 });
    board.run(50);
    assert.equal(answer(IDENTIFY).channels, channels);
    for (const port of ['serial', 'hid']) {
      const all = host.samples[port].slice(from[port] - 1);
      const first = all.findIndex((it) => it.kind === kind);
      assert.ok(first > 0 && all.slice(first).every((it) => it.kind === kind), port);
      assert.deepEqual(all.slice(first, first + 2).map((it) => it.status), [RESTARTED, 0], port);
      all.slice(1).forEach((it, index) => assert.equal(it.sequence, all[index].sequence + 1, port));
    }
  }
  // Decoding keeps up at the fastest rate.
  assert.equal(answer(setRate(4000)).result, 0);
  board.run(40);
  host.samples.serial = [];
  board.run(200);
  const fast = host.samples.serial;
  assert.ok(fast.length >= 790, `${fast.length} contacts in 200 ms`);
  fast.slice(1).forEach((it, index) => assert.equal(it.sequence, fast[index].sequence + 1));

  // A restart by the chip itself keeps what was chosen.
  board.mcu.core.PC = 0x30000000;
  board.mcu.core.waiting = false;
  board.run(1);
  assert.equal(board.resets, 1);
  host.samples = { serial: [], hid: [] };
  host.enumerate();
  board.run(20);
  for (const port of ['serial', 'hid']) assert.deepEqual([host.samples[port][0].kind, host.samples[port][0].status], ['contact', RESTARTED]);
});

test('a jumper chooses contacts from the start', () => {
  const { host } = playing(undefined, { jumper: true });
  for (const port of ['serial', 'hid']) assert.equal(host.samples[port][0].kind, 'contact');
});

test('a fault is told by the one bit that contacts have, and what is held is let go', () => {
  const { board, host, state } = pressed();
  askForContacts(board, host);
  const fromNs = board.ns;
  board.run(ZERO_MS);
  const heard = (ns) => events(hearing(host.chunks, fromNs, ns)).filter((event) => isDown(event) || isUp(event)).map(isDown);
  for (const begin of [() => state.replaced.set(4, 1.25), () => board.converters[1].brownOut(), () => (board.excitationV = 2.2)]) {
    state.down = true;
    board.run(100);
    const [beginNs, before] = [board.ns, heard(board.ns).length];
    begin();
    board.run(60);
    state.replaced.clear();
    board.excitationV = 2.5;
    board.run(150);
    state.down = false;
    const since = host.samples.serial.filter((it) => it.ns >= beginNs);
    assert.equal(since.reduce((bits, it) => bits | it.status, 0), UNTRUSTED);
    assert.ok(heard(beginNs + 100e6).slice(before).includes(false), 'nothing is released');
    assert.equal(heard(board.ns).at(-1), true, 'it is not heard again');
    board.run(150);
  }
});
