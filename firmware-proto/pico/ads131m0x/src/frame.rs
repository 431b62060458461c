//! What the converter sends in one frame: its answer, a code of each channel, a checksum.

/// Bytes of a word.
pub const WORD_LEN: usize = 3;

/// Bytes of the longest frame, that of eight channels.
pub const FRAME_MAX: usize = frame_len(8);

/// Bytes of the frame of a converter with so many channels.
#[must_use]
pub const fn frame_len(channels: usize) -> usize {
    (channels + 2) * WORD_LEN
}

/// CRC-16 of CCITT as the converter has it: polynomial 0x1021, started with 0xFFFF, nothing reflected or inverted.
#[must_use]
pub fn crc16(bytes: &[u8]) -> u16 {
    // Four bits at a time: sixteen words of table, and a chip without caches does a frame in microseconds.
    const TABLE: [u16; 16] = {
        let mut table = [0; 16];
        let mut index = 0;
        while index < 16 {
            let mut crc = (index as u16) << 12;
            let mut bit = 0;
            while bit < 4 {
                crc = if crc & 0x8000 != 0 { crc << 1 ^ 0x1021 } else { crc << 1 };
                bit += 1;
            }
            table[index] = crc;
            index += 1;
        }
        table
    };
    let step = |crc: u16, nibble: u8| crc << 4 ^ TABLE[usize::from((crc >> 12) as u8 ^ nibble) & 0xF];
    bytes.iter().fold(0xFFFF, |crc, byte| step(step(crc, byte >> 4), byte & 0xF))
}

/// The status word, the answer to a frame that asks nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Status(pub u16);

impl Status {
    /// Whether the converter was reset since the mark was taken off: it is no longer set to what it was.
    #[must_use]
    pub const fn was_reset(self) -> bool {
        self.0 & 0x0400 != 0
    }

    /// Whether the last frame to the converter came with a wrong checksum.
    #[must_use]
    pub const fn input_damaged(self) -> bool {
        self.0 & 0x1000 != 0
    }

    /// Whether all of the first `channels` channels have a code that was not read before.
    #[must_use]
    pub const fn all_new(self, channels: usize) -> bool {
        let all = (1 << channels) - 1;
        self.0 & all == all
    }
}

/// One frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<const CHANNELS: usize> {
    /// The answer to the command of the frame before.
    pub answer: u16,
    /// One code of each channel: 24 bits, sign-extended.
    pub codes: [i32; CHANNELS],
}

impl<const CHANNELS: usize> Frame<CHANNELS> {
    /// Reads the first bytes of `bytes`; `None` if they are too few or their checksum is wrong.
    #[must_use]
    pub fn read(bytes: &[u8]) -> Option<Self> {
        let bytes = bytes.get(..frame_len(CHANNELS))?;
        let (body, checksum) = bytes.split_last_chunk::<WORD_LEN>()?;
        if crc16(body) != u16::from_be_bytes([checksum[0], checksum[1]]) {
            return None;
        }
        let mut words =
            body.chunks_exact(WORD_LEN).map(|word| i32::from_be_bytes([word[0], word[1], word[2], 0]));
        let answer = (words.next()? as u32 >> 16) as u16;
        let mut codes = [0; CHANNELS];
        for (code, word) in codes.iter_mut().zip(words) {
            *code = word >> 8;
        }
        Some(Self { answer, codes })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The data sheet names polynomial and start. The values are the catalogues', where it is called CRC-16/IBM-3740 or CCITT-FALSE;
    /// those of whole frames stand in frames.txt.
    #[test]
    fn the_checksum_has_the_catalogues_values() {
        assert_eq!(
            [crc16(b"123456789"), crc16(b"A"), crc16(&[b'A'; 256]), crc16(&[])],
            [0x29B1, 0xB915, 0xEA0B, 0xFFFF]
        );
    }

    fn sealed(body: &[u8; 12]) -> [u8; 15] {
        let mut frame = [0; 15];
        frame[..12].copy_from_slice(body);
        frame[12..14].copy_from_slice(&crc16(body).to_be_bytes());
        frame
    }

    /// The data sheet's ideal codes: 7FFFFF at or above full scale, 000001 one step above nothing, FFFFFF one below, 800000 at or
    /// below negative full scale.
    #[test]
    fn codes_are_twos_complement_of_24_bits() {
        let ends = sealed(&[0x05, 0x07, 0, 0x7F, 0xFF, 0xFF, 0x80, 0, 0, 0xFF, 0xFF, 0xFF]);
        let read = Frame::<3>::read(&ends).unwrap();
        assert_eq!(read, Frame { answer: 0x0507, codes: [8_388_607, -8_388_608, -1] });
        let small = sealed(&[0x01, 0x07, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]);
        assert_eq!(Frame::<3>::read(&small).unwrap().codes, [1, 0, 256]);
    }

    #[test]
    fn one_wrong_bit_anywhere_is_found() {
        let good = sealed(&[0x05, 0x07, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9]);
        for bit in 0..14 * 8 {
            let mut bad = good;
            bad[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(Frame::<3>::read(&bad), None, "bit {bit}");
        }
        assert_eq!(Frame::<3>::read(&good[..14]), None);
        assert!(
            Frame::<3>::read(&[0; 15]).is_none() && Frame::<3>::read(&[0xFF; 15]).is_none(),
            "a dead line"
        );
    }

    #[test]
    fn the_status_word_says_what_its_bits_say() {
        // The word after power-on, 0x0500: reset, words of 24 bits.
        assert!(Status(0x0500).was_reset() && !Status(0x0500).all_new(3));
        assert!(Status(0x0107).all_new(3) && !Status(0x0107).was_reset());
        assert!(!Status(0x0105).all_new(3));
        assert!(Status(0x1000).input_damaged());
    }
}
