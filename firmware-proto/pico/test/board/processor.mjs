// What the emulator's processor leaves out: faults. An instruction that is none, an address where nothing is, one that is not aligned,
// and a break without a debugger are a HardFault; one more in its handler, or with no stack to begin it, stops the processor for good,
// which ARM calls lockup. (ARMv6-M Architecture Reference Manual, B1.5.)

const HARD_FAULT = 3;
const FAULT_PRIORITY_MAX = 3;

export class Faults {
  constructor(mcu) {
    this.mcu = mcu;
    this.pending = false;
    /** Stopped for good: only a reset ends it. */
    this.lockedUp = false;
    const raise = () => (this.pending = true);
    mcu.onBreak = raise;
    const { core, logger } = mcu;
    const warn = logger.warn.bind(logger);
    logger.warn = (component, text) => {
      if (/^(Warning: Instruction|Opcode|Read from invalid|Write to undefined)/.test(text)) raise();
      else warn(component, text);
    };
    for (const [name, mask] of [['readUint32', 3], ['writeUint32', 3], ['readUint16', 1], ['writeUint16', 1]]) {
      const access = core[name].bind(core);
      core[name] = (address, value) => {
        if (address & mask) raise();
        return access(address & ~mask, value);
      };
    }
  }

  /** Takes a fault of the instruction at `pc`. */
  take(pc) {
    const { core } = this.mcu;
    this.pending = false;
    if (core.IPSR > 0 && core.IPSR <= FAULT_PRIORITY_MAX) this.lockedUp = true;
    if (this.lockedUp) return;
    core.PC = pc;
    core.waiting = false;
    core.exceptionEntry(HARD_FAULT);
    // The registers could not be put down.
    if (this.pending) this.lockedUp = true;
  }
}
