//! Blocks of 512 bytes, each with a part of the flash and what a boot loader must know of it.

use crate::elf::FLASH;

/// Bytes of the flash in a block.
const PART: usize = 256;

/// The family RP2040.
const FAMILY: u32 = 0xE48B_FF56;

/// Flag: the family is named.
const FAMILY_NAMED: u32 = 0x2000;

/// The blocks of a flash image that begins at the flash's first byte.
pub(crate) fn of(image: &[u8]) -> Vec<u8> {
    let count = image.len().div_ceil(PART) as u32;
    let mut blocks = Vec::new();
    for (number, part) in (0..).zip(image.chunks(PART)) {
        let address = FLASH + number * PART as u32;
        let head = [0x0A32_4655, 0x9E5D_5157, FAMILY_NAMED, address, PART as u32, number, count, FAMILY];
        blocks.extend(head.into_iter().flat_map(u32::to_le_bytes));
        blocks.extend(part);
        blocks.resize(blocks.len().next_multiple_of(512) - 4, 0);
        blocks.extend(0x0AB1_6F30_u32.to_le_bytes());
    }
    blocks
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The words of a block as the specification numbers them.
    fn words(block: &[u8]) -> Vec<u32> {
        block.chunks(4).map(|word| u32::from_le_bytes(word.try_into().unwrap())).collect()
    }

    #[test]
    fn a_block_says_where_its_part_goes() {
        let image: Vec<u8> = (0..600).map(|at| (at % 251) as u8 + 1).collect();
        let blocks = of(&image);
        assert_eq!(blocks.len(), 3 * 512);
        for (number, block) in blocks.chunks(512).enumerate() {
            let words = words(block);
            assert_eq!((words[0], words[1], words[127]), (0x0A32_4655, 0x9E5D_5157, 0x0AB1_6F30));
            assert_eq!((words[2], words[4], words[6], words[7]), (0x2000, 256, 3, 0xE48B_FF56));
            assert_eq!((words[3] as usize, words[5] as usize), (0x1000_0000 + 256 * number, number));
            let part = &image[256 * number..image.len().min(256 * (number + 1))];
            assert_eq!(&block[32..32 + part.len()], part);
            assert!(block[32 + part.len()..508].iter().all(|byte| *byte == 0));
        }
    }
}
