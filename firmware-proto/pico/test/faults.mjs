// What goes wrong on a board, in its converters, its supply and its program, and at its host: how each begins and ends, and the status
// bits that tell it.

import { UNPLUGGED } from './host/capture.mjs';
import { frame, setRate } from './host/wire.mjs';

const SUPPLY = 0x0800;
export const ALL = 0x01ff;
const ofModule = (module) => 0b111 << (3 * module);

/** Instructions that the program does not have, in memory that it does not use. */
function execute({ board }, instruction) {
  const { core } = board.mcu;
  board.mcu.sramView.setUint16(0x30000, instruction, true);
  core.PC = 0x20030000;
  core.waiting = false;
}

/** The host sees the device go, as systems tell it where the bus does. */
const unplugged = ({ board, host }) => host.chunks.push({ ns: board.ns, kind: UNPLUGGED });

/**
 * All kinds, each drawn anew. `of` says what it is a fault of: two at a time are of different parts. `ms` is how long it may last.
 * `bits` tell it, and no others but `may`; without them the pad has nothing to tell. `releases` says whether what is held must be let
 * go, after so many milliseconds of it. `restarts`: the host sets the device up once more.
 */
export const KINDS = {
  checksums: ({ module }) => ({
    name: `wrong checksums of module ${module}`, of: `module ${module}`, bits: ofModule(module), ms: [5, 120],
    begin: ({ board }) => (board.converters[module].faults.corrupt = Infinity),
    end: ({ board }) => (board.converters[module].faults.corrupt = 0),
  }),
  silence: () => ({
    name: 'silent data-ready', of: 'module 0', bits: ALL, ms: [60, 300],
    begin: ({ board }) => (board.converters[0].faults.silent = true),
    end: ({ board }) => (board.converters[0].faults.silent = false),
  }),
  saturation: ({ channel, sign }) => ({
    name: `channel ${channel} saturated`, of: `channel ${channel}`, bits: 1 << channel, ms: [5, 120],
    begin: ({ state }) => state.replaced.set(channel, 0.04 * sign),
    end: ({ state }) => state.replaced.delete(channel),
  }),
  // A tap that lost a gauge goes to the excitation or to ground.
  open: ({ channel, sign }) => ({
    name: `channel ${channel} open`, of: `channel ${channel}`, bits: 1 << channel, ms: [5, 120],
    begin: ({ state }) => state.replaced.set(channel, 1.25 * sign),
    end: ({ state }) => state.replaced.delete(channel),
  }),
  converterBrownOut: ({ module }) => ({
    name: `converter ${module} browned out`, of: `module ${module}`, bits: ofModule(module), may: ALL, ms: [60, 120],
    begin: ({ board }) => board.converters[module].brownOut(),
    end: () => {},
  }),
  gone: ({ module }) => ({
    name: `converter ${module} gone from the bus`, of: `module ${module}`, bits: ofModule(module), may: ALL, ms: [5, 200],
    begin: ({ board }) => (board.converters[module].faults.floating = true),
    end: ({ board }) => (board.converters[module].faults.floating = false),
  }),
  excitation: ({ sign }) => ({
    name: 'excitation out of tolerance', of: 'supply', bits: SUPPLY, ms: [25, 120],
    begin: ({ board }) => (board.excitationV = 2.5 + 0.3 * sign),
    end: ({ board }) => (board.excitationV = 2.5),
  }),
  unread: () => ({
    name: 'a host that does not read for a second', of: 'host', releases: 80, ms: [1000, 1000],
    begin: ({ host }) => host.read(false), end: ({ host }) => host.read(true),
  }),
  asleep: () => ({
    name: 'a machine that sleeps', of: 'host', releases: 80, ms: [5, 400],
    begin: ({ host }) => host.suspend(), end: ({ host }) => host.resume(),
  }),
  closed: () => ({
    name: 'a port that is closed and opened', of: 'host', releases: 80, ms: [5, 300],
    begin: ({ host }) => host.open(false), end: ({ host }) => host.open(true),
  }),
  noise: ({ random }) => ({
    name: 'bytes that are no commands', of: 'host', ms: [5, 20],
    begin: ({ host }) => host.writeSerial(Array.from({ length: 64 }, () => Math.floor(256 * random()))),
    end: ({ host }) => host.writeSerial([0]),
  }),
  rate: ({ random }) => ({
    name: 'another rate', of: 'host', may: ALL, ms: [20, 200],
    begin: ({ host }) => host.writeSerial(frame(setRate(100 + Math.floor(3901 * random())))),
    end: ({ host }) => host.writeSerial(frame(setRate(1000))),
  }),
  unplugged: () => ({
    name: 'a cable that is pulled', of: 'board', restarts: true, releases: 0, ms: [5, 300],
    begin: (play) => (unplugged(play), play.board.power(false)), end: ({ board }) => board.power(true),
  }),
  brownOut: () => ({
    name: 'a supply that fails for a moment', of: 'board', restarts: true, releases: 0, ms: [1, 1],
    begin: ({ board }) => board.power(false), end: ({ board }) => board.power(true),
  }),
  fault: () => ({
    name: 'a fault of the processor', of: 'board', restarts: true, releases: 0, ms: [5, 5],
    begin: (play) => execute(play, 0xde00), end: unplugged,
  }),
  standstill: () => ({
    name: 'a program that stands still', of: 'board', restarts: true, releases: 80, ms: [505, 505],
    begin: (play) => execute(play, 0xe7fe), end: unplugged,
  }),
};

/** A fault of this kind, drawn. */
export function draw(kind, random) {
  const fault = KINDS[kind]({
    random, module: Math.floor(3 * random()), channel: Math.floor(9 * random()), sign: random() < 0.5 ? 1 : -1,
  });
  const [least, most] = fault.ms;
  return { releases: fault.bits === undefined ? Infinity : 0, ...fault, ms: least + (most - least) * random() };
}
