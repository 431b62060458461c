// What is flashed is what a boot ROM takes, and the converter's model is what the data sheet says.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { blocks, bootChecksum, faults, flash } from './board/image.mjs';
import { Converter, codeOf, crc16 } from './board/converter.mjs';

const file = readFileSync(process.env.TACTPAD_UF2);

test('every block is of the RP2040 and in its place', () => {
  blocks(file).forEach((block, number, all) => {
    assert.deepEqual(
      [block.family, block.flags, block.length, block.number, block.count, block.address],
      [0xe48bff56, 0x2000, 256, number, all.length, 0x10000000 + 256 * number],
    );
  });
});

test('the boot ROM starts it: checksum of the second stage, stack, vectors', () => {
  assert.equal(bootChecksum(Buffer.from('123456789')), 0x0376e6e7, 'the check value of this checksum');
  assert.deepEqual(faults(flash(file)), []);
});

test('a file that is wrong is found to be', () => {
  const wrong = (offset) => {
    const image = flash(file);
    image[offset] ^= 1;
    return faults(image).length;
  };
  assert.deepEqual([wrong(0), wrong(251), wrong(252), wrong(260), wrong(256 + 4 * 15)], [1, 1, 1, 2, 1]);
  const bad = Buffer.from(file);
  bad[512] ^= 1;
  assert.throws(() => blocks(bad), /block at byte 512/);
  assert.throws(() => blocks(file.subarray(1)), /whole blocks/);
});

/** A clock that stands. */
const still = { nanos: 0, createAlarm: () => ({ schedule() {}, cancel() {} }) };

/** Sends words of 16 bits in words of 24; the words that come, the codes of 24 bits whole. */
function exchange(converter, words) {
  converter.select(true);
  const bytes = Array.from({ length: 15 }, (_, at) => (at % 3 < 2 ? (words[Math.floor(at / 3)] ?? 0) >> (8 - 8 * (at % 3)) : 0) & 0xff);
  const came = bytes.map((byte) => converter.transfer(byte));
  converter.select(false);
  return [0, 1, 2, 3, 4].map((index) => (came[3 * index] << 16) | (came[3 * index + 1] << 8) | came[3 * index + 2]);
}

// The data sheet's tables: answers to commands, states after power-on, ideal codes. A whole frame with its checksum as an example was
// not at hand, so there is none here; the checksum is held to its catalogued check value.
test("the converter's model answers as the data sheet's tables say", () => {
  assert.equal(crc16(Buffer.from('123456789')), 0x29b1);
  const converter = new Converter(still, () => [0, 0, 0]);
  const answer = (word) => {
    exchange(converter, [word]);
    return exchange(converter, [0x0000])[0] >> 8;
  };
  assert.equal(exchange(converter, [0])[0] >> 8, 0xff23, 'after power-on');
  assert.equal(exchange(converter, [0])[0] >> 8, 0x0500, 'status: reset, words of 24 bits');
  assert.equal(answer(0x0011), 0xff23, 'RESET');
  const registers = { 0xa000: 0x2300, 0xa100: 0x0510, 0xa180: 0x070e, 0xa200: 0x0000, 0xa300: 0x0600 };
  for (const [command, content] of Object.entries(registers)) assert.equal(answer(Number(command)), content, command);
  assert.equal(exchange(converter, [0x6102, 0x0110, 0x0716, 0x0555])[4] & 0xff, 0);
  assert.equal(exchange(converter, [0])[0] >> 8, 0x4102, 'WREG of three registers');
  assert.deepEqual([answer(0xa100), answer(0xa180), answer(0xa200)], [0x0110, 0x0716, 0x0555]);
});

test('ideal codes are those of the table', () => {
  const full = 1.2 / 32;
  const step = full / 2 ** 23;
  const codes = [2 * full, full, step, 0, -step, -full, -2 * full].map((volts) => codeOf(volts, 32) & 0xffffff);
  assert.deepEqual(codes, [0x7fffff, 0x7fffff, 0x000001, 0x000000, 0xffffff, 0x800000, 0x800000]);
});
