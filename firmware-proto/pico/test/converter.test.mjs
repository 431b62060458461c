// The converter's model is what the data sheet says, by examples that the driver is held to, too: ../ads131m0x/frames.txt.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { Converter, codeOf, crc16 } from './board/converter.mjs';

/** The frames of each part: bytes to the converter and from it. */
const parts = readFileSync(new URL('../ads131m0x/frames.txt', import.meta.url), 'utf8').split('## ').slice(1).map((part) => {
  const [name, ...lines] = part.split('\n');
  const marked = (mark) => lines.filter((line) => line.startsWith(mark)).map((line) => Buffer.from(line.slice(2).replaceAll(' ', ''), 'hex'));
  return { name, to: marked('> '), from: marked('< ') };
});

/** A clock that stands. */
const still = { nanos: 0, createAlarm: () => ({ schedule() {}, cancel() {} }) };

/** One step at the gain of the examples, in volts. */
const STEP = 1.2 / 32 / 2 ** 23;

/** What stands at the inputs when the examples' codes are converted, in steps. */
const CONVERTED = [[2 ** 24, 1, -(2 ** 24)], [-1, 0, 2 ** 23 - 1]];

test('frames are those of the examples, in one row', () => {
  let steps = [0, 0, 0];
  const converter = new Converter(still, () => steps.map((step) => step * STEP));
  const ours = parts.filter(({ name }) => name.startsWith('m03'));
  for (const { name, to, from } of ours) {
    to.forEach((bytes, index) => {
      if (name === 'm03 codes' && CONVERTED[index]) {
        steps = CONVERTED[index];
        converter.convert();
      }
      converter.select(true);
      const came = Buffer.from(Array.from(bytes, (byte) => converter.transfer(byte)));
      converter.select(false);
      assert.equal(came.toString('hex'), from[index].toString('hex'), `${name}, frame ${index + 1}`);
    });
  }
  assert.deepEqual(ours.map(({ to }) => to.length), [2, 2, 10, 3, 6]);
});

test('contents after power-on are those of the register map', () => {
  const converter = new Converter(still, () => [0, 0, 0]);
  const contents = { 0x00: 0x2300, 0x01: 0x0500, 0x02: 0x0510, 0x03: 0x070e, 0x04: 0x0000, 0x06: 0x0600, 0x0c: 0x8000 };
  for (const [address, content] of Object.entries(contents)) assert.equal(converter.registers[address], content, address);
});

test('the checksum has the values of the catalogues', () => {
  const of = (text) => crc16(Buffer.from(text));
  assert.deepEqual([of('123456789'), of('A'), of('A'.repeat(256)), of('')], [0x29b1, 0xb915, 0xea0b, 0xffff]);
});

test('ideal codes are those of the table', () => {
  const full = 1.2 / 32;
  const step = full / 2 ** 23;
  const codes = [2 * full, full, step, 0, -step, -full, -2 * full].map((volts) => codeOf(volts, 32) & 0xffffff);
  assert.deepEqual(codes, [0x7fffff, 0x7fffff, 0x000001, 0x000000, 0xffffff, 0x800000, 0x800000]);
});
