//! The key of this user on this machine: with it the program proves itself to a page that it gave, and pages keep their drafts.
//!
//! Where the page was, another user's program may answer once the bridge has ended. A page that runs asks with a nonce, a number
//! that was never used before, and whoever answers without the key is told nothing. The key itself is never sent: what pages get is derived from it.

use std::fmt::{self, Write};
use std::fs::File;
use std::io::{self, Read};

use hmac::digest::Key;
use hmac::{Hmac, Mac};
use sha2::Sha256;

/// So many bytes have the key, what is derived from it, and a proof.
const BYTES: usize = 32;

/// A secret of the user's own.
#[derive(Clone, PartialEq, Eq)]
pub struct UserKey([u8; BYTES]);

/// What a proof is about.
#[derive(Clone, Copy, Debug)]
pub(super) struct Proven<'a> {
    /// The host that was asked: an answer to one does not do for another.
    pub(super) host: &'a str,
    /// The page's nonce.
    pub(super) nonce: &'a str,
    /// Where the page is now.
    pub(super) origin: &'a str,
    /// Its token, if it is told.
    pub(super) token: &'a str,
}

impl UserKey {
    /// A new one.
    ///
    /// # Errors
    /// The system has no random numbers.
    pub fn fresh() -> io::Result<Self> {
        random().map(Self)
    }

    /// The key that [`UserKey::hex`] wrote.
    pub fn from_hex(text: &str) -> Option<Self> {
        let digits = text.trim_end().as_bytes();
        let mut bytes = [0; BYTES];
        if digits.len() != 2 * BYTES {
            return None;
        }
        for (byte, pair) in bytes.iter_mut().zip(digits.chunks_exact(2)) {
            *byte = u8::from_str_radix(str::from_utf8(pair).ok()?, 16).ok()?;
        }
        Some(Self(bytes))
    }

    /// The key as text, for the file that keeps it.
    pub fn hex(&self) -> String {
        hex(&self.0)
    }

    /// The key by which pages tell that an answer is the program's.
    pub(super) fn of_proofs(&self) -> String {
        hex(&mac(&self.0, &["tactpad proofs"]))
    }

    /// The key by which pages keep drafts where others may look.
    pub(super) fn of_drafts(&self) -> String {
        hex(&mac(&self.0, &["tactpad drafts"]))
    }

    /// That whoever answers has this key.
    pub(super) fn proof(&self, Proven { host, nonce, origin, token }: Proven<'_>) -> String {
        hex(&mac(&mac(&self.0, &["tactpad proofs"]), &[host, nonce, origin, token]))
    }
}

/// No log tells the key.
impl fmt::Debug for UserKey {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str("UserKey")
    }
}

/// The code of these words, none of which has a line end.
fn mac(key: &[u8; BYTES], words: &[&str]) -> [u8; BYTES] {
    // A key that is shorter than a block is filled with zeros.
    let mut block = Key::<Hmac<Sha256>>::default();
    block[..BYTES].copy_from_slice(key);
    let mut mac = Hmac::<Sha256>::new(&block);
    for (index, word) in words.iter().enumerate() {
        if index > 0 {
            mac.update(b"\n");
        }
        mac.update(word.as_bytes());
    }
    mac.finalize().into_bytes().into()
}

/// Random bytes of the system.
pub(super) fn random<const COUNT: usize>() -> io::Result<[u8; COUNT]> {
    let mut bytes = [0; COUNT];
    File::open("/dev/urandom")?.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// Bytes as text.
pub(super) fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key() -> UserKey {
        UserKey([7; BYTES])
    }

    #[test]
    fn the_code_is_that_of_the_standard() {
        // RFC 4231, the first two cases; keys are filled with zeros there, too.
        let mut first = [0; BYTES];
        first[..20].fill(0x0b);
        assert_eq!(
            hex(&mac(&first, &["Hi There"])),
            "b0344c61d8db38535ca8afceaf0bf12b881dc200c9833da726e9376c2e32cff7"
        );
        let mut second = [0; BYTES];
        second[..4].copy_from_slice(b"Jefe");
        assert_eq!(
            hex(&mac(&second, &["what do ya want for nothing?"])),
            "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843"
        );
    }

    #[test]
    fn a_key_is_read_as_it_was_written_and_nothing_else_is() {
        assert_eq!(UserKey::from_hex(&format!("{}\n", key().hex())), Some(key()));
        for text in ["", "07", &"0g".repeat(BYTES), &"07".repeat(BYTES + 1), &"é".repeat(BYTES)] {
            assert_eq!(UserKey::from_hex(text), None, "{text}");
        }
        assert!(UserKey::fresh().unwrap() != UserKey::fresh().unwrap());
    }

    #[test]
    fn a_proof_is_of_this_key_and_of_each_word() {
        let proven = Proven { host: "a", nonce: "b", origin: "c", token: "d" };
        let others = [
            key().proof(Proven { host: "x", ..proven }),
            key().proof(Proven { nonce: "x", ..proven }),
            key().proof(Proven { origin: "x", ..proven }),
            key().proof(Proven { token: "", ..proven }),
            UserKey([8; BYTES]).proof(proven),
            key().of_proofs(),
            key().of_drafts(),
            key().hex(),
        ];
        let all: std::collections::BTreeSet<_> = others.into_iter().chain([key().proof(proven)]).collect();
        assert_eq!(all.len(), 9);
    }
}
