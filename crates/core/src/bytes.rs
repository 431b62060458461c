//! Little-endian numbers and texts in a row, as the program's own files keep them.

/// Remaining bytes of a file while it is read; `None` wherever it ends early or makes no sense.
#[derive(Clone, Copy, Debug)]
pub struct Reader<'b> {
    rest: &'b [u8],
}

impl<'b> Reader<'b> {
    /// Reads from the first of these bytes.
    pub const fn new(bytes: &'b [u8]) -> Self {
        Self { rest: bytes }
    }

    /// Whether all bytes were read.
    pub const fn is_at_end(&self) -> bool {
        self.rest.is_empty()
    }

    /// The next `length` bytes; `None` where there are fewer.
    pub fn take(&mut self, length: usize) -> Option<&'b [u8]> {
        let (taken, rest) = self.rest.split_at_checked(length)?;
        self.rest = rest;
        Some(taken)
    }

    /// The next `N` bytes of a little-endian number.
    pub fn number<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.take(N)?.first_chunk().copied()
    }

    /// The next four bytes as a number.
    pub fn float(&mut self) -> Option<f32> {
        self.number().map(f32::from_le_bytes)
    }

    /// The next eight bytes as a number.
    pub fn double(&mut self) -> Option<f64> {
        self.number().map(f64::from_le_bytes)
    }

    /// A double that is finite.
    pub fn finite(&mut self) -> Option<f64> {
        self.double().filter(|double| double.is_finite())
    }

    /// So many finite doubles.
    pub fn finites<const N: usize>(&mut self) -> Option<[f64; N]> {
        let mut doubles = [0.0; N];
        for double in &mut doubles {
            *double = self.finite()?;
        }
        Some(doubles)
    }

    /// The next eight bytes as a whole number.
    pub fn bits(&mut self) -> Option<u64> {
        self.number().map(u64::from_le_bytes)
    }

    /// The next four bytes as a count.
    pub fn length(&mut self) -> Option<usize> {
        self.number().map(|bytes| u32::from_le_bytes(bytes) as usize)
    }

    /// Bytes with their length before them.
    pub fn text(&mut self) -> Option<&'b [u8]> {
        let length = self.length()?;
        self.take(length)
    }

    /// Floats with their number before them.
    pub fn floats(&mut self) -> Option<Vec<f32>> {
        let length = self.length()?.checked_mul(4)?;
        Some(self.take(length)?.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect())
    }
}

/// Writes bytes with their length before them.
pub fn push_text(to: &mut Vec<u8>, text: &[u8]) {
    to.extend((text.len() as u32).to_le_bytes());
    to.extend(text);
}

/// Writes floats with their number before them.
pub fn push_floats(to: &mut Vec<u8>, floats: &[f32]) {
    to.extend((floats.len() as u32).to_le_bytes());
    to.extend(floats.iter().flat_map(|float| float.to_le_bytes()));
}

/// Writes doubles, without their number.
pub fn push_doubles(to: &mut Vec<u8>, doubles: &[f64]) {
    to.extend(doubles.iter().flat_map(|double| double.to_le_bytes()));
}

/// A file's bytes: what says what it is, its body, the body's sum (FNV-1a, 64 bits).
pub fn sealed(magic: &[u8], body: &[u8]) -> Vec<u8> {
    [magic, body, &fnv1a(body).to_le_bytes()].concat()
}

/// Why bytes are no such file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FormatError {
    /// They begin as something else.
    Magic,
    /// They end early, or their sum is another one.
    Damaged,
}

/// The body of a sealed file.
pub fn unsealed<'b>(magic: &[u8], bytes: &'b [u8]) -> Result<&'b [u8], FormatError> {
    let body = bytes.strip_prefix(magic).ok_or(FormatError::Magic)?;
    let (body, sum) = body.split_last_chunk::<8>().ok_or(FormatError::Damaged)?;
    if u64::from_le_bytes(*sum) == fnv1a(body) { Ok(body) } else { Err(FormatError::Damaged) }
}

/// Source: G. Fowler, L. C. Noll, K.-P. Vo, D. Eastlake, "The FNV Non-Cryptographic Hash Algorithm", section 2.
pub fn fnv1a(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_gives_the_published_values() {
        assert_eq!(fnv1a(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fnv1a(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(fnv1a(b"foobar"), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn what_is_written_is_read() {
        let mut body = Vec::new();
        push_text(&mut body, b"a pad");
        push_floats(&mut body, &[1.5, -2.0]);
        body.extend(7.25_f64.to_le_bytes());
        let file = sealed(b"magic\n", &body);
        let mut reader = Reader::new(unsealed(b"magic\n", &file).unwrap());
        assert_eq!(reader.text(), Some(&b"a pad"[..]));
        assert_eq!(reader.floats(), Some(vec![1.5, -2.0]));
        assert_eq!((reader.double(), reader.is_at_end(), reader.float()), (Some(7.25), true, None));
    }

    #[test]
    fn doubles_that_are_no_numbers_are_not_read() {
        let mut body = Vec::new();
        push_doubles(&mut body, &[1.5, -2.0, f64::NAN]);
        body.extend(7_u64.to_le_bytes());
        let mut reader = Reader::new(&body);
        assert_eq!(reader.finites(), Some([1.5, -2.0]));
        assert_eq!((reader.finite(), reader.bits()), (None, Some(7)));
    }

    #[test]
    fn damage_is_found() {
        let file = sealed(b"magic\n", &[1, 2, 3]);
        for at in 6..file.len() {
            let mut damaged = file.clone();
            damaged[at] ^= 4;
            assert_eq!(unsealed(b"magic\n", &damaged), Err(FormatError::Damaged));
        }
        assert_eq!(unsealed(b"other\n", &file), Err(FormatError::Magic));
        assert_eq!(unsealed(b"magic\n", &file[..9]), Err(FormatError::Damaged));
        assert_eq!(
            Reader::new(&[255, 255, 255, 255]).floats(),
            None,
            "no memory is asked for what is not there"
        );
    }
}
