//! Command words, and what the converter answers to them in the frame after.

/// Does nothing; the answer is the status word.
pub const NULL: u16 = 0x0000;

/// Back to the state after power-on. The answer is 0xFF20 and the number of channels in the lowest bits.
pub const RESET: u16 = 0x0011;

/// The most registers that [`write_registers`] and the driver move at once.
pub const REGISTERS_MAX: usize = 8;

/// Reads the register at `address`; the answer is its content.
#[must_use]
pub const fn read_register(address: u8) -> u16 {
    0xA000 | (address as u16 & 0x3F) << 7
}

/// Writes `count` registers from `address` on; their contents follow, one word each.
#[must_use]
pub const fn write_registers(address: u8, count: usize) -> u16 {
    0x6000 | (address as u16 & 0x3F) << 7 | (count as u16).wrapping_sub(1) & 0x7F
}

/// The answer to [`write_registers`] when all of them were written.
#[must_use]
pub const fn written(address: u8, count: usize) -> u16 {
    0x4000 | (address as u16 & 0x3F) << 7 | (count as u16).wrapping_sub(1) & 0x7F
}

/// The answer to [`RESET`] of a converter with so many channels.
#[must_use]
pub const fn was_reset(channels: usize) -> u16 {
    0xFF20 | channels as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bit patterns of the data sheet's table of commands: RREG 101a aaaa annn nnnn, WREG 011a aaaa annn nnnn, and its answer
    /// 010a aaaa ammm mmmm.
    #[test]
    fn words_have_the_pattern_of_the_table() {
        assert_eq!(read_register(0x00), 0b1010_0000_0000_0000);
        assert_eq!(read_register(0x01), 0b1010_0000_1000_0000);
        assert_eq!(read_register(0x3E), 0b1011_1111_0000_0000);
        assert_eq!(write_registers(0x02, 1), 0b0110_0001_0000_0000);
        assert_eq!(write_registers(0x02, 3), 0b0110_0001_0000_0010);
        assert_eq!(written(0x02, 3), 0b0100_0001_0000_0010);
        assert_eq!(was_reset(3), 0b1111_1111_0010_0011);
        assert_eq!(was_reset(8), 0b1111_1111_0010_1000);
    }
}
