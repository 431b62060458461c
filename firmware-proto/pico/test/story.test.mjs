// A story of faults in an order that is drawn: each is told by its status bits, what the player holds is released within 100 ms, and
// the pad plays on without help.

import assert from 'node:assert/strict';
import { after, test } from 'node:test';
import { KINDS, draw } from './faults.mjs';
import { events, hearing, isDown, isUp, pressed } from './player.mjs';
import { drawn, seed, shuffled } from './setting.mjs';

/** Faults in a story: each kind once, and some that are short once more. */
const FAULTS = 20;

/** Stories: one, or more before a release. */
const STORIES = Number(process.env.TACTPAD_STORIES ?? 1);

/** So often a second fault of another part begins while the first lasts. */
const TWO_AT_A_TIME = 0.3;

const RELEASED_MAX_MS = 100;
const TOLD_MAX_MS = 40;

/** From the end of a fault to good samples, and to a press that is heard. */
const WELL_MAX_MS = 150;
const PLAYS_MAX_MS = 500;

/** A pad that restarted: its host's settling, and then the zero, for which nobody may touch it. */
const SETTLE_MS = 100;
const BACK_MAX_MS = 200;
const ZERO_MS = 600;

const RESTARTED = 0x0400;
const UNTRUSTED = 0x0800;

/** What happens, in the order that it happens: one fault, or two that overlap. */
function steps(random) {
  const all = Object.keys(KINDS);
  const short = all.filter((kind) => draw(kind, random).ms < 500);
  const kinds = shuffled([...all, ...shuffled(short, random).slice(0, FAULTS - all.length)], random);
  const found = [];
  while (kinds.length > 0) {
    const first = draw(kinds.pop(), random);
    const second = kinds.length > 0 && random() < TWO_AT_A_TIME && draw(kinds.at(-1), random);
    const fits = second && second.of !== first.of && !first.restarts && !second.restarts;
    if (fits) kinds.pop();
    found.push(fits ? [first, second] : [first]);
  }
  return found;
}

/** Has the faults come and go; the second begins in the first one's time. Returns when the first began and the last ended. */
function happen(play, faults, random) {
  const beginNs = play.board.ns;
  const moments = faults.flatMap((fault, index) => {
    const from = index * faults[0].ms * random();
    return [{ ms: from, act: fault.begin }, { ms: from + fault.ms, act: fault.end }];
  }).sort((a, b) => a.ms - b.ms);
  for (const { ms, act } of moments) {
    play.board.run(Math.max(0, beginNs / 1e6 + ms - play.board.ns / 1e6));
    act(play);
  }
  return [beginNs, play.board.ns];
}

/** That the status bits tell these faults, soon, and nothing else. Contacts have one bit for all. */
function assertTold(faults, samples, beginNs, name) {
  const ofKind = (bits) => (samples[0]?.kind === 'contact' && bits ? UNTRUSTED : bits);
  const bits = ofKind(faults.reduce((all, fault) => all | (fault.bits ?? 0), 0));
  const may = ofKind(faults.reduce((all, fault) => all | (fault.may ?? 0), bits));
  const seen = samples.reduce((all, it) => all | it.status, 0);
  assert.equal(seen & ~may, 0, `${name}: bits ${seen.toString(16)}`);
  if (faults.some((fault) => fault.of === 'host') || bits === 0) return;
  assert.equal(seen & bits, bits, `${name}: bits ${seen.toString(16)}`);
  const toldMs = (samples.find((it) => it.status !== 0).ns - beginNs) / 1e6;
  assert.ok(faults.length > 1 || toldMs <= TOLD_MAX_MS, `${name}: told after ${toldMs} ms`);
}

function tell(random) {
  // Every other pad decodes on its own.
  const jumper = random() < 0.5;
  const play = pressed({ jumper });
  const { board, host, state } = play;
  const fromNs = board.ns;
  board.run(700);
  const heard = (ns) => events(hearing(host.chunks, fromNs, ns)).filter((event) => isDown(event) || isUp(event)).map(isDown);
  const told = [jumper ? 'contacts' : 'channels'];
  let before = [];
  after(() => console.log(`${told.join('; ')}`));
  for (const faults of steps(random)) {
    const name = faults.map((fault) => `${fault.name}, ${fault.ms.toFixed(0)} ms`).join(', and ');
    told.push(name);
    const restarts = faults.some((fault) => fault.restarts);
    state.down = true;
    board.run(60 + 60 * random());
    const [beginNs, endNs] = happen(play, faults, random);
    state.down = false;
    if (restarts) {
      host.samples = { serial: [], hid: [] };
      host.enumerate({ settleMs: SETTLE_MS });
      board.run(20);
      const backMs = (host.samples.serial[0]?.ns - endNs) / 1e6;
      assert.ok(backMs <= BACK_MAX_MS, `${name}: samples after ${backMs} ms`);
      for (const port of ['serial', 'hid']) assert.equal(host.samples[port][0].status, RESTARTED, `${name}: ${port}`);
      board.run(ZERO_MS);
    } else {
      board.run(200 + 150 * random());
    }
    const untilNs = board.ns;
    state.down = true;
    board.run(80);
    const playsMs = (board.ns - endNs) / 1e6;
    assert.ok(restarts || playsMs <= PLAYS_MAX_MS, `${name}: asked too late`);
    state.down = false;
    // Of two faults the second may be the one that must let go.
    const lastsMs = faults.length > 1 ? faults[0].ms : 0;
    const since = heard(beginNs + (lastsMs + RELEASED_MAX_MS) * 1e6).slice(before.length);
    assert.equal(since[0], true, `${name}: the press before is not heard`);
    // What lasts long enough must let go; what is over sooner may.
    const mustRelease = faults.some((fault) => fault.ms >= fault.releases);
    assert.ok(!mustRelease || since.includes(false), `${name}: nothing is released`);
    before = heard(board.ns);
    assert.deepEqual([before.at(-2), before.at(-1)], [false, true], `${name}: a press after it is not heard`);
    if (!restarts) {
      for (const port of ['serial', 'hid']) {
        const samples = host.samples[port].filter((it) => it.ns >= beginNs && it.ns <= untilNs);
        assertTold(faults, samples, beginNs, `${name}: ${port}`);
        const later = samples.filter((it) => it.ns > endNs + WELL_MAX_MS * 1e6);
        assert.ok(later.length > 30 && later.every((it) => it.status === 0), `${name}: ${port} is not well`);
      }
    }
    board.run(120);
    before.push(false);
  }
  assert.equal(host.receiver.damaged, 0);
}

for (let story = 1; story <= STORIES; story++) {
  test(`story ${story}: every fault is told and released within 100 ms, and the pad plays on without help`, () => tell(drawn(seed())));
}
