//! Sample frames, written from the wire's description and not with the crate's encoder, so that the two check
//! each other.

/// Body of a sample: version, kind, sequence, time, nine counts, temperature, status, checksum.
const BODY_LEN: usize = 2 + 4 + 8 + 9 * 4 + 2 + 2 + 4;

/// Status bit of the first sample after the pad started.
const RESTARTED: u16 = 1 << 10;

/// The bytes of one sample on a serial line, its closing zero included.
pub(crate) fn sample_frame(sequence: u32, time_us: u64, counts: [i32; 9]) -> Vec<u8> {
    let mut body = Vec::with_capacity(BODY_LEN);
    body.extend([1, 0x01]);
    body.extend(sequence.to_le_bytes());
    body.extend(time_us.to_le_bytes());
    body.extend(counts.iter().flat_map(|count| count.to_le_bytes()));
    body.extend(2_345_i16.to_le_bytes());
    let status = if sequence == 0 { RESTARTED } else { 0 };
    body.extend(status.to_le_bytes());
    body.extend(crc32(&body).to_le_bytes());
    stuff(&body)
}

/// CRC-32/ISO-HDLC, bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    for byte in bytes {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 };
        }
    }
    !crc
}

/// Consistent overhead byte stuffing of fewer than 255 bytes: every run of non-zero bytes follows its length plus one.
fn stuff(body: &[u8]) -> Vec<u8> {
    assert!(body.len() < 255, "longer bodies need split runs");
    let mut frame = Vec::with_capacity(body.len() + 2);
    for run in body.split(|byte| *byte == 0) {
        frame.push(u8::try_from(run.len() + 1).expect("checked above"));
        frame.extend(run);
    }
    frame.push(0);
    frame
}
