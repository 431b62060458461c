// What the tests share: voltages at the converters' pins, a board that is set up, drawn numbers.

import assert from 'node:assert/strict';
import { Board } from './board/chip.mjs';
import { Host } from './host/host.mjs';
import { frame, setOutput } from './host/wire.mjs';

/** Excitation of the board, and the one for which the wire's microvolts are told, in volts. */
const EXCITATION_V = 2.5;
const TOLD_FOR_V = 2.8;

/** Counts as the firmware should tell them, in picovolts at the bridge: 2.4 V over gain 32 and 2^24 codes, four times, at 2.8 V. */
export const PICOVOLTS = ((2.4 / 32 / 2 ** 24) * 4 * (TOLD_FOR_V / EXCITATION_V)) / 1e-12;

/** The voltage between a converter's inputs for a signal in microvolts; docs/build.md has z wired the other way round. */
export const pinVolts = (uv) => (uv * 1e-6 / 4) * (EXCITATION_V / TOLD_FOR_V);

/** A board with these voltages at its pins, set up by a host, and running. */
export function playing(inputs, options) {
  const board = new Board(inputs, options);
  const host = new Host(board);
  host.enumerate();
  board.run(20);
  return { board, host };
}

/** Has the pad decode on its own. */
export function askForContacts(board, host) {
  host.writeSerial(frame(setOutput(1)));
  const begun = () => ['serial', 'hid'].every((port) => host.samples[port].at(-1)?.kind === 'contact');
  assert.ok(board.run(20, begun), 'no contacts come');
}

/** Numbers from 0 to 1, the same for the same seed (xorshift). */
export function drawn(seed) {
  let state = seed >>> 0 || 1;
  return () => {
    state ^= state << 13;
    state ^= state >>> 17;
    state ^= state << 5;
    return (state >>> 0) / 2 ** 32;
  };
}

/** The same in another order. */
export function shuffled(list, random) {
  const rest = [...list];
  return list.map(() => rest.splice(Math.floor(random() * rest.length), 1)[0]);
}

/** A seed, told so that a failure can be had again: TACTPAD_SEED. */
export function seed() {
  const chosen = Number(process.env.TACTPAD_SEED ?? Math.floor(Math.random() * 2 ** 32));
  console.log(`TACTPAD_SEED=${chosen}`);
  return chosen;
}

/** Seconds of play: 5, or more before a release. */
export const SECONDS = Number(process.env.TACTPAD_SECONDS ?? 5);
