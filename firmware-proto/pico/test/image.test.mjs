// What is flashed is what a boot ROM takes.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { blocks, bootChecksum, faults, flash } from './board/image.mjs';

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
