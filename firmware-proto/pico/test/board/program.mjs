// What the linked program says of itself: where its functions lie, and where it gives up.

const SECTION_LEN = 40;
const SYMBOL_LEN = 16;
const SYMBOLS = 2;
const FUNCTION = 2;

/** Functions of an ELF of 32 bits: names and addresses. */
export function functions(elf) {
  const sections = Array.from({ length: elf.readUInt16LE(48) }, (_, index) => {
    const at = elf.readUInt32LE(32) + SECTION_LEN * index;
    const word = (offset) => elf.readUInt32LE(at + offset);
    return { type: word(4), offset: word(16), length: word(20), link: word(24) };
  });
  const table = sections.find((it) => it.type === SYMBOLS);
  const names = sections[table.link];
  const found = [];
  for (let at = table.offset; at < table.offset + table.length; at += SYMBOL_LEN) {
    const from = names.offset + elf.readUInt32LE(at);
    const name = elf.toString('latin1', from, elf.indexOf(0, from));
    if ((elf[at + 12] & 0xf) === FUNCTION) found.push({ name, address: elf.readUInt32LE(at + 4) & ~1 });
  }
  return found;
}

/**
 * Where the program panics: the instruction that loads the place of the panic, just before the call, and the line that this place names.
 * `flash` begins at `base`.
 */
export function panics(flash, base, elf) {
  const panicking = new Set(functions(elf).filter(({ name }) => /4core.*(9panicking|panic_already_borrowed|slice_index_fail)/.test(name))
    .map(({ address }) => address));
  const found = [];
  for (let at = 258; at + 4 <= flash.length; at += 2) {
    const [load, high, low] = [-2, 0, 2].map((offset) => flash.readUInt16LE(at + offset));
    // LDR from the constants behind the code; BL with eleven bits of the way in each half, as the compiler makes it for near calls.
    if (load >> 11 !== 0b01001 || high >> 11 !== 0b11110 || low >> 11 !== 0b11111) continue;
    const way = (((high & 0x7ff) << 21) >> 9) | ((low & 0x7ff) << 1);
    if (!panicking.has(base + at + 4 + way)) continue;
    const constant = ((at + 2) & ~3) + 4 * (load & 0xff);
    const place = flash.readUInt32LE(constant) - base;
    found.push({ address: base + at - 2, line: flash.readUInt32LE(place + 8) });
  }
  return found;
}
