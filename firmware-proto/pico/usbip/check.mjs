// Judges what the guest said: node check.mjs FILE.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';

const HAT_X = 0x10;
const said = readFileSync(process.argv[2], 'utf8');
const line = (pattern) => said.match(new RegExp(`^${pattern}$`, 'm'))?.[1];

/** Events of the gamepad: 64-bit seconds and microseconds, type, code, value. */
function events(name) {
  const bytes = Buffer.from(line(`${name}: events: (.*)`) ?? '', 'base64');
  const found = [];
  for (let at = 0; at + 24 <= bytes.length; at += 24) {
    const seconds = Number(bytes.readBigInt64LE(at)) + Number(bytes.readBigInt64LE(at + 8)) / 1e6;
    const [type, code, value] = [bytes.readUInt16LE(at + 16), bytes.readUInt16LE(at + 18), bytes.readInt32LE(at + 20)];
    if (type !== 0) found.push({ seconds, type, code, value });
  }
  // Who begins to listen may come into a press.
  return found[0]?.value === 0 ? found.slice(1) : found;
}

assert.equal(line('guest: product: (.*)'), 'tactpad pad 0.1.0');
assert.deepEqual(said.match(/^guest: interface .*$/gm).map((it) => it.split(': ')[2]), ['cdc_acm', 'cdc_acm', 'usbhid']);
assert.match(said, /^devices: pad .*hidraw/m);
assert.match(said, /^devices: pad .*ttyACM0/m);
for (const name of ['auto', 'serial']) {
  const all = events(name);
  assert.ok(all.length >= 5, `${name}: ${all.length} events`);
  all.forEach(({ type, code, value }, index) => assert.deepEqual([type, code, value], [3, HAT_X, 1 - (index % 2)], `${name}: event ${index}`));
  const held = all.slice(1).map((it, index) => it.seconds - all[index].seconds).filter((_, index) => index % 2 === 0);
  console.log(`${name}: ${held.length} presses, held for ${held.map((it) => it.toFixed(2)).join(', ')} s`);
  for (const count of ['samples', 'frames_lost', 'frames_damaged']) console.log(`${name}: ${count} ${line(`${name}: status: ${count} +(.*)`) ?? 0}`);
}
assert.match(said, /^guest: released when it was pulled out$/m);
assert.match(said, /^guest: plays when it is back$/m);
assert.match(said, /^guest: exit code 0$/m);
console.log(line('guest: (kernel .*), up for.*'));
