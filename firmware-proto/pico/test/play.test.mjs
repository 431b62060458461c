// The pad plays: what the program makes of the emulated pad is what it makes of its own virtual pad.

import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { BYTES, heard, read, replay, tactpad, write } from './host/capture.mjs';
import { IDENTIFY, Receiver, frame } from './host/wire.mjs';
import { PICOVOLTS, SECONDS, drawn, pinVolts, playing, seed } from './setting.mjs';

/** Events may be so far apart, in microseconds. */
const APART_MAX_US = 20_000;

/** Noise of a channel of the twin, in microvolts. */
const NOISE_UV = 10;

const folder = mkdtempSync(join(tmpdir(), 'tactpad-pico-'));
after(() => rmSync(folder, { recursive: true }));
const file = (name) => join(folder, name);

test(`a scripted play of Super Mario, ${SECONDS} s: the same events as the virtual pad's, each within 20 ms`, () => {
  tactpad('record', file('virtual'), '--pad', 'virtual', '--seconds', String(SECONDS + 1));
  const entries = read(readFileSync(file('virtual')));
  const head = entries.slice(0, entries.findIndex((it) => it.kind === BYTES));
  const played = [];
  let virtual = { picovolts: 10_000 };
  const receiver = new Receiver((it) => {
    if (it.kind === 'sample') played.push(it);
    if (it.kind === 'identity') virtual = it;
  });
  for (const { kind, payload } of entries) if (kind === BYTES) receiver.push(payload);

  let fromNs = Infinity;
  let index = 0;
  const { board, host } = playing((seconds) => {
    const us = (seconds * 1e9 - fromNs) / 1e3;
    while (index + 1 < played.length && played[index + 1].timeUs - played[0].timeUs <= us) index++;
    return played[index].counts.map((count) => pinVolts((count * virtual.picovolts) / 1e6));
  });
  fromNs = board.ns;
  host.writeSerial(frame(IDENTIFY));
  board.run(SECONDS * 1e3);
  assert.equal(host.receiver.damaged, 0);
  writeFileSync(file('emulated'), write(heard(head, host.chunks, fromNs, board.ns)));

  const untilUs = SECONDS * 1e6 - 50_000;
  // Events have the pad's time; that of the virtual pad begins with its first sample.
  const events = (name, beginUs) => replay(file(name))
    .map((event) => ({ ...event, t_us: event.t_us - beginUs }))
    .filter((event) => event.t_us < untilUs);
  const [wanted, came] = [events('virtual', played[0].timeUs), events('emulated', fromNs / 1e3)];
  const said = (event) => `${event.device} ${event.code} ${event.value}`;
  assert.deepEqual(came.map(said), wanted.map(said));
  const apartUs = wanted.map((event, index) => Math.abs(event.t_us - came[index].t_us));
  console.log(`${wanted.length} events, at most ${Math.max(...apartUs)} µs apart`);
  assert.ok(wanted.length >= SECONDS * 2, `${wanted.length} events`);
  assert.ok(Math.max(...apartUs) <= APART_MAX_US, `${apartUs}`);
});

test('contacts come out as they went in', () => {
  const random = drawn(seed());
  const between = (low, high) => (low + random() * (high - low)).toFixed(3);
  const rows = Array.from({ length: 40 }, () => {
    const [radius, angle] = [22 * Math.sqrt(random()), 2 * Math.PI * random()];
    const place = [radius * Math.cos(angle), radius * Math.sin(angle)].map((mm) => mm.toFixed(3));
    return [...place, between(-0.4, 0.4), between(-0.4, 0.4), between(0.5, 4)].join();
  });
  const columns = 'x_mm,y_mm,fx_n,fy_n,fz_n';
  writeFileSync(file('contacts.csv'), `${columns}\n${rows.join('\n')}\n`);
  tactpad('simulate', '--contacts', file('contacts.csv'), '--out', file('channels.csv'));
  const [header, ...lines] = readFileSync(file('channels.csv'), 'utf8').trim().split('\n');
  const first = header.split(',').indexOf('m0x_uv');
  const truth = lines.map((line) => line.split(',').slice(first, first + 9).map(Number));

  // Each contact for 20 ms, between them an untouched pad; offsets of gauges on every channel.
  const offsets = Array.from({ length: 9 }, () => (random() - 0.5) * 4000);
  let now = new Array(9).fill(0);
  const { board, host } = playing(() => now.map((uv, channel) => pinVolts(uv + offsets[channel])));
  const measured = (uv) => {
    now = uv;
    board.run(20);
    return host.samples.serial.at(-1).counts.map((count) => (count * Math.round(PICOVOLTS)) / 1e6);
  };
  const rest = measured(new Array(9).fill(0));
  const channels = truth.map((uv) => measured(uv).map((value, channel) => value - rest[channel]));
  const errors = channels.flatMap((uv, row) => uv.map((value, channel) => Math.abs(value - truth[row][channel])));
  console.log(`channels: at most ${Math.max(...errors).toFixed(3)} µV from the truth`);
  assert.ok(Math.max(...errors) < NOISE_UV, `${Math.max(...errors)} µV`);

  // What the decoder makes of the emulated pad is what it makes of the simulated channels themselves.
  const names = header.split(',').slice(first, first + 9).join();
  const table = (values) => [
    `${columns},${names}`, `0,0,0,0,0,${new Array(9).fill(0)}`, ...rows.map((row, index) => `${row},${values[index]}`), '',
  ].join('\n');
  writeFileSync(file('ideal.csv'), table(truth));
  writeFileSync(file('measured.csv'), table(channels.map((uv) => uv.map((value) => value.toFixed(3)))));
  const [ideal, real] = ['ideal.csv', 'measured.csv'].map((name) => tactpad('evaluate', '--measured', file(name)));
  console.log(`the simulation's channels, decoded:\n${ideal}the emulated pad's:\n${real}`);
  const figures = (text) => text.match(/by its labels(.*)/)[1].trim().split(/\s+/).map(Number);
  figures(ideal).forEach((figure, column) => {
    // What is printed has thousandths: two of them above what the decoder does with the truth itself.
    assert.ok(figures(real)[column] <= figure + 0.0021, `${figures(real)}, not ${figures(ideal)}`);
  });
});
