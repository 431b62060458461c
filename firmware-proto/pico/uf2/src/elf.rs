//! What of a linked program lies in the flash.

/// Where the flash begins.
pub(crate) const FLASH: u32 = 0x1000_0000;

/// Bytes of the flash.
const FLASH_LEN: u32 = 2 << 20;

fn half(bytes: &[u8], at: usize) -> Option<usize> {
    Some(usize::from(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?)))
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}

/// The flash from its first byte to the program's last; between parts lies what an erased flash holds. `None` if it is no 32-bit
/// little-endian ELF, if a part lies outside of the flash, or if nothing lies at its first byte.
pub(crate) fn flash_image(elf: &[u8]) -> Option<Vec<u8>> {
    const LOADED: u32 = 1;
    if elf.get(..6)? != b"\x7FELF\x01\x01" {
        return None;
    }
    let (table, size, count) = (word(elf, 28)? as usize, half(elf, 42)?, half(elf, 44)?);
    let mut image = Vec::new();
    let mut begins = false;
    for index in 0..count {
        let header = elf.get(table + index * size..)?;
        let (kind, from, address, len) =
            (word(header, 0)?, word(header, 4)?, word(header, 12)?, word(header, 16)?);
        if kind != LOADED || len == 0 {
            continue;
        }
        let offset = address.checked_sub(FLASH).filter(|offset| offset + len <= FLASH_LEN)? as usize;
        let bytes = elf.get(from as usize..from as usize + len as usize)?;
        begins |= offset == 0;
        image.resize(image.len().max(offset + bytes.len()), 0xFF);
        image[offset..offset + bytes.len()].copy_from_slice(bytes);
    }
    begins.then_some(image)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An ELF of parts: where each is loaded, and its bytes.
    fn elf(parts: &[(u32, &[u8])]) -> Vec<u8> {
        let mut elf = vec![0; 52];
        elf[..6].copy_from_slice(b"\x7FELF\x01\x01");
        elf[28..32].copy_from_slice(&52_u32.to_le_bytes());
        elf[42..44].copy_from_slice(&32_u16.to_le_bytes());
        elf[44..46].copy_from_slice(&(parts.len() as u16).to_le_bytes());
        let mut at = 52 + 32 * parts.len() as u32;
        for (address, bytes) in parts {
            for word in [1, at, 0, *address, bytes.len() as u32, 0, 0, 0] {
                elf.extend(u32::to_le_bytes(word));
            }
            at += bytes.len() as u32;
        }
        parts.iter().for_each(|(_, bytes)| elf.extend(*bytes));
        elf
    }

    #[test]
    fn parts_lie_where_they_are_loaded_and_gaps_are_erased() {
        let image = flash_image(&elf(&[(FLASH, b"boot"), (FLASH + 6, b"go")])).unwrap();
        assert_eq!(image, *b"boot\xFF\xFFgo");
    }

    #[test]
    fn what_is_no_program_for_the_flash_is_refused() {
        assert_eq!(flash_image(b""), None);
        assert_eq!(flash_image(b"\x7FELF\x02\x01"), None);
        for address in [0x2000_0000, FLASH + FLASH_LEN, FLASH - 4, FLASH + 4] {
            assert_eq!(flash_image(&elf(&[(address, b"code")])), None, "{address:#x}");
        }
        let whole = elf(&[(FLASH, b"boot")]);
        for len in 0..whole.len() {
            assert_eq!(flash_image(&whole[..len]), None, "cut off after {len} bytes");
        }
    }
}
