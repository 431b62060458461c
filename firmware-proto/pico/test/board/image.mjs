// The file that is flashed: what a UF2 says, and what of it a boot ROM looks at.
//
// Written from Microsoft's specification of UF2 and the RP2040's data sheet (2.8.1.3.1), without a look at what makes the file.

export const FLASH = 0x10000000;
const RAM_END = 0x20042000;

/** The blocks of a UF2, each checked on its own. */
export function blocks(file) {
  if (file.length % 512 !== 0) throw new Error(`${file.length} bytes are no whole blocks`);
  const found = [];
  for (let at = 0; at < file.length; at += 512) {
    const word = (offset) => file.readUInt32LE(at + offset);
    if (word(0) !== 0x0a324655 || word(4) !== 0x9e5d5157 || word(508) !== 0x0ab16f30) throw new Error(`no block at byte ${at}`);
    found.push({
      flags: word(8), address: word(12), length: word(16), number: word(20), count: word(24), family: word(28),
      data: file.subarray(at + 32, at + 32 + word(16)),
    });
  }
  return found;
}

/** The flash as it is after the file was written to an erased one, up to the last byte of it. */
export function flash(file) {
  const all = blocks(file);
  const end = Math.max(...all.map((block) => block.address + block.length));
  const image = Buffer.alloc(end - FLASH, 0xff);
  for (const block of all) block.data.copy(image, block.address - FLASH);
  return image;
}

/** CRC-32 with polynomial 04C11DB7, started with FFFFFFFF, nothing reflected or inverted: the boot ROM's over its second stage. */
export function bootChecksum(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) {
    crc ^= byte << 24;
    for (let bit = 0; bit < 8; bit++) crc = crc & 0x80000000 ? (crc << 1) ^ 0x04c11db7 : crc << 1;
  }
  return crc >>> 0;
}

/** What is wrong with an image, in the boot ROM's and the processor's eyes. */
export function faults(image) {
  const wrong = [];
  if (bootChecksum(image.subarray(0, 252)) !== image.readUInt32LE(252)) wrong.push('the second boot stage has a wrong checksum');
  const [stack, reset] = [image.readUInt32LE(256), image.readUInt32LE(260)];
  if (stack % 8 !== 0 || stack <= 0x20000000 || stack > RAM_END) wrong.push(`the stack begins at ${stack.toString(16)}`);
  for (let number = 1; number < 16 + 26; number++) {
    const entry = image.readUInt32LE(256 + 4 * number);
    const inFlash = entry % 2 === 1 && entry >= FLASH + 256 && entry < FLASH + image.length;
    const reserved = (number >= 4 && number <= 10) || number === 12 || number === 13;
    if (reserved ? entry !== 0 : !inFlash) wrong.push(`vector ${number} is ${entry.toString(16)}`);
  }
  if (reset % 2 !== 1) wrong.push('the reset vector is no Thumb code');
  return wrong;
}
