// The stream: nothing lost, nothing damaged, both ways at once, at every rate; and what a host may ask.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { IDENTIFY, blink, frame, setRate } from './host/wire.mjs';
import { PICOVOLTS, SECONDS, drawn, playing, seed } from './setting.mjs';

const SPECIFICATION = new URL('../../README.md', import.meta.url);

/** That each sample follows the one before, in number and time. */
function assertWhole(samples, periodUs, what) {
  for (let index = 1; index < samples.length; index++) {
    const [before, after] = [samples[index - 1], samples[index]];
    assert.equal(after.sequence, before.sequence + 1, `${what}: sample ${index}`);
    const stepUs = after.timeUs - before.timeUs;
    assert.ok(Math.abs(stepUs - periodUs) < 15, `${what}: ${stepUs} µs before sample ${after.sequence}`);
  }
}

test(`${SECONDS} s at 1 kHz: every sample comes both ways, whole, and is what stood at the pins`, () => {
  const random = drawn(seed());
  const truth = [];
  // All three converters ask at the same moment: one draw for each conversion.
  const { board, host } = playing((seconds) => {
    if (truth.length === 0 || seconds - truth.at(-1).seconds > 1e-6) {
      truth.push({ seconds, volts: Array.from({ length: 9 }, () => (random() - 0.5) * 0.07) });
    }
    return truth.at(-1).volts;
  });
  board.run(5);
  const fromUs = board.ns / 1e3;
  board.run(SECONDS * 1e3);
  const latencies = {};
  for (const port of ['serial', 'hid']) {
    const samples = host.samples[port].filter((it) => it.timeUs > fromUs);
    assertWhole(samples, 1000.55, port);
    assert.ok(samples.length >= SECONDS * 999 - 2, `${port}: ${samples.length} samples`);
    assert.ok(samples.every((it) => it.status === 0), port);
    let index = 0;
    for (const { timeUs, counts } of samples) {
      while (truth[index].seconds * 1e6 < timeUs - 500) index++;
      const lateUs = timeUs - truth[index].seconds * 1e6;
      assert.ok(lateUs > -1 && lateUs < 15, `${port}: stamped ${lateUs} µs after the conversion`);
      const at = truth[index].volts;
      counts.forEach((count, channel) => {
        const ideal = (at[channel] * 32 / 1.2) * 2 ** 23;
        assert.ok(Math.abs(count - ideal) < 2 + Math.abs(ideal) * 2e-4, `${port}: channel ${channel} ${count}, not ${ideal}`);
      });
    }
    latencies[port] = host.latencyNs[port].map((ns) => ns / 1e3).sort((a, b) => a - b);
    assert.ok(latencies[port].at(-1) < 1000, port);
    const [median, most] = [latencies[port][latencies[port].length >> 1], latencies[port].at(-1)];
    console.log(`${port}: ${samples.length} samples; data-ready to last byte handed to the USB: ${median.toFixed(0)} µs, ${most.toFixed(0)} at most`);
  }
  assert.equal(host.receiver.damaged, 0);
  assert.equal(board.resets, 0);
});

test('it sets up as the specification says', () => {
  const { board, host } = playing();
  const text = readFileSync(SPECIFICATION, 'utf8').split('The report descriptor:')[1].split('```')[1];
  const wanted = text.split('\n').map((line) => line.match(/^((?:[0-9a-f]{2} )*[0-9a-f]{2})\s/)?.[1] ?? (line.startsWith('c0') ? 'c0' : ''));
  assert.equal(host.reportDescriptor.toString('hex'), wanted.join('').replaceAll(' ', ''));
  assert.deepEqual([host.device.readUInt16LE(8), host.device.readUInt16LE(10), host.found.hidInterval], [0x1209, 0x0001, 1]);
  assert.deepEqual(host.names, { maker: 'tactpad', product: 'tactpad pad 0.1.0', serial: 'E6605838830ABC01' });
  for (const port of ['serial', 'hid']) {
    assert.deepEqual(host.samples[port].map((it) => it.status & 0x0400).slice(0, 3), [0x0400, 0, 0], port);
  }
  const last = host.samples.serial.at(-1);
  assert.ok(Math.abs(last.centiC - 100 * board.temperatureC) < 60, `${last.centiC / 100} °C`);
});

test('commands are answered where they were asked, and rates are kept without loss', () => {
  const { board, host } = playing();
  const ask = { serial: (body) => host.writeSerial(frame(body)), hid: (body) => host.writeHid(body) };
  const answer = (port, body) => {
    const before = host.replies[port].length;
    ask[port](body);
    assert.ok(board.run(20, () => host.replies[port].length > before), `${port} does not answer`);
    return host.replies[port].at(-1);
  };
  const identity = (rateHz) => ({
    kind: 'identity', serialNumber: 'E6605838830ABC01', channels: 9, bits: 24, rateHz, picovolts: Math.round(PICOVOLTS),
  });
  const acknowledgement = (command, result) => ({ kind: 'acknowledgement', command, result });
  for (const port of ['serial', 'hid']) {
    assert.deepEqual(answer(port, IDENTIFY), identity(999));
    assert.deepEqual(answer(port, setRate(4001)), acknowledgement(0x82, 1));
    assert.deepEqual(answer(port, setRate(99)), acknowledgement(0x82, 1));
    assert.deepEqual(answer(port, [1, 0x9c]), acknowledgement(0x9c, 2));
  }
  for (const rateHz of [100, 250, 500, 997, 2000, 4000]) {
    assert.deepEqual(answer('serial', setRate(rateHz)), acknowledgement(0x82, 0));
    board.run(40);
    const from = host.samples.serial.length;
    board.run(200);
    const samples = host.samples.serial.slice(from);
    const periodUs = (samples.at(-1).timeUs - samples[0].timeUs) / (samples.length - 1);
    assert.ok(Math.abs(1e6 / periodUs / rateHz - 1) < 0.006, `${rateHz} Hz: ${periodUs} µs`);
    assertWhole(samples, periodUs, `${rateHz} Hz`);
    assert.ok(samples.length >= rateHz * 0.2 * 0.99 - 1);
  }
  assert.equal(host.receiver.damaged, 0);
  assert.equal(answer('hid', setRate(1000)).result, 0);
  assert.deepEqual(answer('serial', IDENTIFY), identity(999));
  assert.equal(board.lit, true, 'lit while it sends');
  assert.equal(answer('hid', blink(1000)).result, 0);
  const seen = new Set();
  for (let step = 0; step < 20; step++) {
    board.run(20);
    seen.add(board.lit);
  }
  assert.equal(seen.size, 2, 'it flashes when it is asked to');
});

test('a serial port that is closed at 1200 baud means the boot loader', () => {
  const { board, host } = playing();
  host.open(false);
  board.run(20);
  assert.equal(board.bootloader, false);
  host.open(true, 1200);
  board.run(20);
  assert.equal(board.bootloader, false);
  try {
    host.open(false, 1200);
  } catch {
    // It may be gone before it answers.
  }
  board.run(20);
  assert.equal(board.bootloader, true);
});
