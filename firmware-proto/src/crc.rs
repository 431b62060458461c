//! CRC-32/ISO-HDLC, the checksum of Ethernet and zip files.
//!
//! Four bits at a time: the table of sixteen words costs a microcontroller 64 bytes of flash, and a sample
//! frame takes 108 look-ups.

/// Bytes of the checksum in a frame, little-endian.
pub(crate) const LEN: usize = 4;

/// The polynomial 0x04C11DB7 with its bits in reverse order.
const POLYNOMIAL_REFLECTED: u32 = 0xEDB8_8320;

const TABLE: [u32; 16] = table();

const fn table() -> [u32; 16] {
    let mut table = [0; 16];
    let mut nibble = 0;
    while nibble < 16 {
        let mut crc = nibble as u32;
        let mut bit = 0;
        while bit < 4 {
            crc = if crc & 1 == 1 { (crc >> 1) ^ POLYNOMIAL_REFLECTED } else { crc >> 1 };
            bit += 1;
        }
        table[nibble] = crc;
        nibble += 1;
    }
    table
}

/// The checksum of `bytes`; 0 for none.
pub fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        let low_done = shift_nibble(crc ^ u32::from(*byte));
        shift_nibble(low_done)
    })
}

/// Divides four more bits. The masked index cannot leave the table.
const fn shift_nibble(crc: u32) -> u32 {
    (crc >> 4) ^ TABLE[(crc & 0xF) as usize]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn check_value_of_the_published_catalogue() {
        assert_eq!(crc32(b"123456789"), 0xCBF4_3926);
    }

    #[test]
    fn agrees_with_division_bit_by_bit() {
        fn bitwise(bytes: &[u8]) -> u32 {
            let mut crc = u32::MAX;
            for bit in bytes.iter().flat_map(|byte| (0..8).map(move |i| u32::from(byte >> i & 1))) {
                let out = (crc ^ bit) & 1;
                crc = (crc >> 1) ^ (out * POLYNOMIAL_REFLECTED);
            }
            !crc
        }
        let all: [u8; 256] = core::array::from_fn(|i| i as u8);
        for len in 0..=all.len() {
            assert_eq!(crc32(&all[..len]), bitwise(&all[..len]));
        }
    }
}
