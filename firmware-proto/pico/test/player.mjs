// A player who presses and lifts, and what the program makes of the bytes that came: for tests of what goes wrong meanwhile.

import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after } from 'node:test';
import { BYTES, heard, read, replay, tactpad, write } from './host/capture.mjs';
import { drawn, pinVolts, playing } from './setting.mjs';

const folder = mkdtempSync(join(tmpdir(), 'tactpad-pico-'));
after(() => rmSync(folder, { recursive: true }));
const file = (name) => join(folder, name);

/** Channels of a press that Super Mario's profile takes for a direction, in microvolts. */
const PRESS = (() => {
  writeFileSync(file('press.csv'), 'x_mm,y_mm,fx_n,fy_n,fz_n\n18,0,0,0,2\n');
  tactpad('simulate', '--contacts', file('press.csv'), '--out', file('channels.csv'));
  return readFileSync(file('channels.csv'), 'utf8').trim().split('\n')[1].split(',').slice(-9).map(Number);
})();

/** What the channels tremble by, in microvolts. */
const NOISE_UV = 10;

/** The event of a press, and of its end. */
export const isDown = (event) => event.code === 'ABS_HAT0X' && event.value === 1;
export const isUp = (event) => event.code === 'ABS_HAT0X' && event.value === 0;

/** A capture's entries before the first bytes. */
const HEAD = (() => {
  tactpad('record', file('virtual'), '--pad', 'virtual', '--seconds', '0.5');
  const entries = read(readFileSync(file('virtual')));
  return entries.slice(0, entries.findIndex((it) => it.kind === BYTES)).map((entry) => ({ ...entry, ns: 0 }));
})();

/** A pad that is pressed while `state.down`, with voltages at single channels that a fault has `state.replaced`. */
export function pressed(options) {
  const state = { down: false, replaced: new Map() };
  const noise = drawn(1);
  const volts = (uv) => pinVolts((state.down ? uv : 0) + NOISE_UV * (noise() - 0.5));
  const { board, host } = playing(() => PRESS.map((uv, channel) => state.replaced.get(channel) ?? volts(uv)), options);
  return { board, host, state };
}

/** What the program would have heard of these chunks between two times. */
export const hearing = (chunks, fromNs, toNs) => heard(HEAD, chunks, fromNs, toNs);

/** The events of what was heard, in the order they came. */
export function events(entries) {
  writeFileSync(file('heard'), write(entries));
  return replay(file('heard'));
}
