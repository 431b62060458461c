// The pad plays: what the program makes of the emulated pad is what it makes of its own virtual pad.

import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { BYTES, heard, read, replay, tactpad, write } from './host/capture.mjs';
import { IDENTIFY, Receiver, frame } from './host/wire.mjs';
import { PICOVOLTS, SECONDS, askForContacts, drawn, pinVolts, playing, seed } from './setting.mjs';

/** Events may be so far apart, in microseconds. */
const APART_MAX_US = 20_000;

/** Noise of a channel of the twin, in microvolts. */
const NOISE_UV = 10;

/** The pad's own zero is known after so long. */
const ZERO_MS = 500;

const STATICS = fileURLToPath(new URL('../../../models/statics.toml', import.meta.url));
const COLUMNS = 'x_mm,y_mm,fx_n,fy_n,fz_n';

/** A table of contacts and channels, an untouched row first. */
const table = (rows, channels, names) => [
  `${COLUMNS},${names}`, `0,0,0,0,0,${new Array(9).fill(0)}`, ...rows.map((row, index) => `${row},${channels[index]}`), '',
].join('\n');

/** What `evaluate` prints: mean errors along the axes and as a distance, and more. */
const figures = (text) => text.match(/by its labels(.*)/)[1].trim().split(/\s+/).map(Number);

const folder = mkdtempSync(join(tmpdir(), 'tactpad-pico-'));
after(() => rmSync(folder, { recursive: true }));
const file = (name) => join(folder, name);

/** What the virtual pad plays, recorded once. */
const virtual = (() => {
  tactpad('record', file('virtual'), '--pad', 'virtual', '--seconds', String(SECONDS + 1));
  const entries = read(readFileSync(file('virtual')));
  const played = { head: entries.slice(0, entries.findIndex((it) => it.kind === BYTES)), samples: [], picovolts: 10_000 };
  const receiver = new Receiver((it) => {
    if (it.kind === 'sample') played.samples.push(it);
    if (it.kind === 'identity') played.picovolts = it.picovolts;
  });
  for (const { kind, payload } of entries) if (kind === BYTES) receiver.push(payload);
  return played;
})();

/** Has the emulated pad play the same; the events must be the virtual pad's, as this decoder makes them of its channels. */
function plays(name, decoder, prepare = () => {}) {
  const { head, samples, picovolts } = virtual;
  let fromNs = Infinity;
  let index = 0;
  const { board, host } = playing((seconds) => {
    const us = (seconds * 1e9 - fromNs) / 1e3;
    while (index + 1 < samples.length && samples[index + 1].timeUs - samples[0].timeUs <= us) index++;
    return samples[index].counts.map((count) => pinVolts((count * picovolts) / 1e6));
  });
  prepare(board, host);
  fromNs = board.ns;
  host.writeSerial(frame(IDENTIFY));
  board.run(SECONDS * 1e3);
  assert.equal(host.receiver.damaged, 0);
  writeFileSync(file(name), write(heard(head, host.chunks, fromNs, board.ns)));

  const untilUs = SECONDS * 1e6 - 50_000;
  // Events have the pad's time; that of the virtual pad begins with its first sample.
  const events = (events, beginUs) => events.map((event) => ({ ...event, t_us: event.t_us - beginUs })).filter((event) => event.t_us < untilUs);
  const [wanted, came] = [events(replay(file('virtual'), ...decoder), samples[0].timeUs), events(replay(file(name)), fromNs / 1e3)];
  const said = (event) => `${event.device} ${event.code} ${event.value}`;
  assert.deepEqual(came.map(said), wanted.map(said));
  const apartUs = wanted.map((event, index) => Math.abs(event.t_us - came[index].t_us));
  console.log(`${wanted.length} events, at most ${Math.max(...apartUs).toFixed(0)} µs apart`);
  assert.ok(wanted.length >= SECONDS * 2, `${wanted.length} events`);
  assert.ok(Math.max(...apartUs) <= APART_MAX_US, `${apartUs}`);
  const latencies = host.latencyNs.serial.map((ns) => ns / 1e3).sort((a, b) => a - b);
  console.log(`data-ready to last byte handed to the USB: ${latencies[latencies.length >> 1].toFixed(0)} µs, ${latencies.at(-1).toFixed(0)} at most`);
}

test(`a scripted play of Super Mario, ${SECONDS} s: the same events as the virtual pad's, each within 20 ms`, () => {
  plays('channels', []);
});

test(`the same play decoded on the chip, ${SECONDS} s: the same events as by the program's statics, each within 20 ms`, () => {
  plays('decoded', ['--decoder', 'statics'], askForContacts);
});

/** Contacts that are drawn, as a table's rows, and their channels as the twin has them. */
function drawnContacts(random) {
  const between = (low, high) => (low + random() * (high - low)).toFixed(3);
  const rows = Array.from({ length: 40 }, () => {
    const [radius, angle] = [22 * Math.sqrt(random()), 2 * Math.PI * random()];
    const place = [radius * Math.cos(angle), radius * Math.sin(angle)].map((mm) => mm.toFixed(3));
    return [...place, between(-0.4, 0.4), between(-0.4, 0.4), between(0.5, 4)].join();
  });
  writeFileSync(file('contacts.csv'), `${COLUMNS}\n${rows.join('\n')}\n`);
  tactpad('simulate', '--contacts', file('contacts.csv'), '--out', file('channels.csv'));
  const [header, ...lines] = readFileSync(file('channels.csv'), 'utf8').trim().split('\n');
  const first = header.split(',').indexOf('m0x_uv');
  const channels = lines.map((line) => line.split(',').slice(first, first + 9).map(Number));
  return { rows, channels, names: header.split(',').slice(first, first + 9).join() };
}

/** A board with offsets of gauges on every channel; `press(uv)` has a contact of these channels for so long. */
function withOffsets(random, prepare = () => {}) {
  const offsets = Array.from({ length: 9 }, () => (random() - 0.5) * 4000);
  let now = new Array(9).fill(0);
  const { board, host } = playing(() => now.map((uv, channel) => pinVolts(uv + offsets[channel])));
  prepare(board, host);
  const press = (uv, ms) => {
    now = uv;
    board.run(ms);
    return host.samples.serial.at(-1);
  };
  return { board, press };
}

/** The law in floating point, by the numbers in models/statics.toml: place in micrometres, forces in millinewtons. */
const statics = (() => {
  const text = readFileSync(STATICS, 'utf8');
  const number = (name) => Number(text.match(new RegExp(`^${name} = (.*)$`, 'm'))[1]);
  const [t, r, n] = ['tangential', 'radial', 'normal'].map((name) => number(`${name}_uv_per_n`));
  const [height, share, radius] = ['contact_height_mm', 'false_shear_per_mm', 'module_radius_mm'].map(number);
  return (uv) => {
    const sum = { x: 0, y: 0, z: 0, px: 0, py: 0 };
    for (let module = 0; module < 3; module++) {
      const [cos, sin] = [Math.cos((module * 2 * Math.PI) / 3), Math.sin((module * 2 * Math.PI) / 3)];
      const [tangential, radial, normal] = [uv[3 * module] / t, uv[3 * module + 1] / r, uv[3 * module + 2] / n];
      sum.x += radial * cos - tangential * sin;
      sum.y += radial * sin + tangential * cos;
      sum.z += normal;
      sum.px += radius * cos * normal;
      sum.py += radius * sin * normal;
    }
    const kept = 1 - share * height;
    const [x, y] = [(sum.x - share * sum.px) / kept, (sum.y - share * sum.py) / kept];
    return { placeUm: [((sum.px - height * x) / sum.z) * 1e3, ((sum.py - height * y) / sum.z) * 1e3], forceMn: [x * 1e3, y * 1e3, sum.z * 1e3] };
  };
})();

test('contacts that the chip decodes are what the law in floating point says of the same channels', () => {
  const random = drawn(seed());
  const { rows, channels, names } = drawnContacts(random);
  const { board, press } = withOffsets(random, askForContacts);
  board.run(ZERO_MS);
  const told = channels.map((uv) => {
    assert.equal(press(new Array(9).fill(0), 5).touched, false);
    const { touched, shear, placeUm, forceMn } = press(uv, 5);
    assert.deepEqual([touched, shear], [true, true]);
    return { placeUm, forceMn };
  });
  const apart = (field) => Math.max(...told.flatMap((it, row) => it[field].map((value, axis) => Math.abs(value - statics(channels[row])[field][axis]))));
  const [placeUm, forceMn] = [apart('placeUm'), apart('forceMn')];
  console.log(`at most ${placeUm.toFixed(1)} µm and ${forceMn.toFixed(2)} mN from the law`);
  assert.ok(placeUm < 20 && forceMn < 2, `${placeUm} µm, ${forceMn} mN`);

  const off = (row, index) => Math.hypot(...row.split(',').slice(0, 2).map((mm, axis) => told[index].placeUm[axis] / 1e3 - mm));
  const distanceMm = rows.reduce((sum, row, index) => sum + off(row, index), 0) / rows.length;
  writeFileSync(file('ideal.csv'), table(rows, channels, names));
  const wantedMm = figures(tactpad('evaluate', '--decoder', STATICS, '--measured', file('ideal.csv')))[1];
  console.log(`${distanceMm.toFixed(3)} mm from the truth; the program's statics ${wantedMm} mm`);
  assert.ok(Math.abs(distanceMm - wantedMm) < 0.01, `${distanceMm} mm`);
});

test('contacts come out as they went in', () => {
  const random = drawn(seed());
  const { rows, channels: truth, names } = drawnContacts(random);
  const { press } = withOffsets(random);
  // Each contact for 20 ms, between them an untouched pad.
  const measured = (uv) => press(uv, 20).counts.map((count) => (count * Math.round(PICOVOLTS)) / 1e6);
  const rest = measured(new Array(9).fill(0));
  const channels = truth.map((uv) => measured(uv).map((value, channel) => value - rest[channel]));
  const errors = channels.flatMap((uv, row) => uv.map((value, channel) => Math.abs(value - truth[row][channel])));
  console.log(`channels: at most ${Math.max(...errors).toFixed(3)} µV from the truth`);
  assert.ok(Math.max(...errors) < NOISE_UV, `${Math.max(...errors)} µV`);

  // What the decoder makes of the emulated pad is what it makes of the simulated channels themselves.
  writeFileSync(file('ideal.csv'), table(rows, truth, names));
  writeFileSync(file('measured.csv'), table(rows, channels.map((uv) => uv.map((value) => value.toFixed(3))), names));
  const [ideal, real] = ['ideal.csv', 'measured.csv'].map((name) => tactpad('evaluate', '--measured', file(name)));
  console.log(`the simulation's channels, decoded:\n${ideal}the emulated pad's:\n${real}`);
  figures(ideal).forEach((figure, column) => {
    // What is printed has thousandths: two of them above what the decoder does with the truth itself.
    assert.ok(figures(real)[column] <= figure + 0.0021, `${figures(real)}, not ${figures(ideal)}`);
  });
});
