// tactpad's captures, read and written: so the program hears the emulated pad at its simulated times, and nothing waits.
//
// The form is told in crates/core/src/pipeline/capture/mod.rs.

import { execFileSync } from 'node:child_process';
import { checksum } from './wire.mjs';

const MAGIC = Buffer.from('tactpad capture 1\n');
export const BYTES = 0;
export const TIMEOUT = 1;
export const UNPLUGGED = 2;

/** The bridge looks at its deadlines at least so often, in nanoseconds, while no bytes come. */
const LOOK_NS = 5e6;

/** The program, run with these arguments; what it prints. */
export function tactpad(...args) {
  return execFileSync(process.env.TACTPAD_PROGRAM, args, { encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'], maxBuffer: 1 << 26 });
}

/** The events that a capture comes to. */
export function replay(file, ...options) {
  return tactpad('replay', file, ...options).split('\n').filter(Boolean).map((line) => JSON.parse(line));
}

/** The entries of a capture: kind, time and payload. */
export function read(file) {
  if (!file.subarray(0, MAGIC.length).equals(MAGIC)) throw new Error('no capture');
  const entries = [];
  for (let at = MAGIC.length; at + 17 <= file.length; ) {
    const length = file.readUInt32LE(at + 9);
    entries.push({ kind: file[at], ns: Number(file.readBigUInt64LE(at + 1)), payload: file.subarray(at + 17, at + 17 + length) });
    at += 17 + length + 4;
  }
  return entries;
}

function chained(before, bytes) {
  const word = Buffer.alloc(4);
  word.writeUInt32LE(before);
  return checksum(Buffer.concat([word, bytes]));
}

/** A capture of these entries. */
export function write(entries) {
  const parts = [MAGIC];
  let chain = 0;
  for (const { kind, ns, payload = Buffer.alloc(0) } of entries) {
    const fields = Buffer.alloc(13);
    fields[0] = kind;
    fields.writeBigUInt64LE(BigInt(Math.round(ns)), 1);
    fields.writeUInt32LE(payload.length, 9);
    const head = chained(chain, fields);
    chain = chained(head, payload);
    const sums = [head, chain].map((sum) => Buffer.from(Uint32Array.of(sum).buffer));
    parts.push(fields, sums[0], payload, sums[1]);
  }
  return Buffer.concat(parts);
}

/** What the program would have heard of these chunks from `fromNs` to `toNs`, told from `fromNs` on, behind a capture's head. */
export function heard(head, chunks, fromNs, toNs) {
  const entries = [...head];
  let lastNs = fromNs;
  const look = (untilNs) => {
    for (lastNs += LOOK_NS; lastNs < untilNs; lastNs += LOOK_NS) entries.push({ kind: TIMEOUT, ns: lastNs - fromNs });
  };
  for (const { ns, bytes, kind = BYTES } of chunks) {
    if (ns < fromNs || ns > toNs) continue;
    look(ns);
    entries.push({ kind, ns: ns - fromNs, payload: bytes });
    lastNs = ns;
  }
  look(toNs);
  return entries;
}
