// Frames of the wire, from the specification (firmware-proto/README.md) alone.

const table = new Uint32Array(256).map((_, index) => {
  let crc = index;
  for (let bit = 0; bit < 8; bit++) crc = crc & 1 ? (crc >>> 1) ^ 0xedb88320 : crc >>> 1;
  return crc;
});

/** CRC-32 as of Ethernet and zip. */
export function checksum(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) crc = table[(crc ^ byte) & 0xff] ^ (crc >>> 8);
  return ~crc >>> 0;
}

/** A body as a message of the pad. */
export function message(body) {
  const bytes = Buffer.from(body);
  if (bytes[0] !== 1) throw new Error(`version ${bytes[0]}`);
  switch (bytes[1]) {
    case 0x01:
      return {
        kind: 'sample',
        sequence: bytes.readUInt32LE(2),
        timeUs: Number(bytes.readBigUInt64LE(6)),
        counts: Array.from({ length: 9 }, (_, channel) => bytes.readInt32LE(14 + 4 * channel)),
        centiC: bytes.readInt16LE(50),
        status: bytes.readUInt16LE(52),
      };
    case 0x05:
      return {
        kind: 'contact',
        sequence: bytes.readUInt32LE(2),
        timeUs: Number(bytes.readBigUInt64LE(6)),
        placeUm: [14, 18].map((at) => bytes.readInt32LE(at)),
        forceMn: [22, 26, 30].map((at) => bytes.readInt32LE(at)),
        touched: (bytes.readUInt16LE(40) & 1) !== 0,
        shear: (bytes.readUInt16LE(40) & 2) !== 0,
        status: bytes.readUInt16LE(42),
      };
    case 0x02:
      return {
        kind: 'identity',
        serialNumber: bytes.subarray(2, 18).toString('latin1').replace(/\0.*/, ''),
        channels: bytes[18], bits: bytes[19], rateHz: bytes.readUInt16LE(20), picovolts: bytes.readUInt32LE(22),
      };
    case 0x03:
      return { kind: 'acknowledgement', command: bytes[2], result: bytes[3] };
    default:
      throw new Error(`kind ${bytes[1]}`);
  }
}

/** The frame of a command, or of any body. */
export function frame(body) {
  const plain = Buffer.concat([Buffer.from(body), Buffer.alloc(4)]);
  plain.writeUInt32LE(checksum(plain.subarray(0, -4)), plain.length - 4);
  const out = [];
  let run = [];
  for (const byte of [...plain, 0]) {
    if (byte !== 0) run.push(byte);
    else {
      out.push(run.length + 1, ...run);
      run = [];
    }
  }
  return Buffer.from([...out, 0]);
}

export const IDENTIFY = [1, 0x81];
export const setRate = (hz) => [1, 0x82, hz & 0xff, hz >> 8];
export const setOutput = (output) => [1, 0x84, output, 0];
export const blink = (ms) => [1, 0x83, ms & 0xff, ms >> 8];

/** Takes bytes of a serial line; calls `onMessage` for each good frame and counts the others. */
export class Receiver {
  constructor(onMessage) {
    this.onMessage = onMessage;
    this.bytes = [];
    this.damaged = 0;
  }

  push(bytes) {
    for (const byte of bytes) {
      if (byte !== 0) this.bytes.push(byte);
      else if (this.bytes.length > 0) {
        this.end(this.bytes);
        this.bytes = [];
      }
    }
  }

  end(stuffed) {
    const plain = [];
    for (let at = 0; at < stuffed.length; at += stuffed[at]) {
      if (at > 0) plain.push(0);
      plain.push(...stuffed.slice(at + 1, at + stuffed[at]));
    }
    const bytes = Buffer.from(plain);
    if (bytes.length < 6 || checksum(bytes.subarray(0, -4)) !== bytes.readUInt32LE(bytes.length - 4)) this.damaged++;
    else this.onMessage(message(bytes.subarray(0, -4)));
  }
}
