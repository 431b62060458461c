//! Decoders in memory, and what they make of anything.

use tactpad::pipeline::contact::Decoder;
use tactpad::pipeline::contact::file::MAGIC;
use tactpad::quantity::{CHANNELS, Contact, Strain};

const KINDS: [&[u8]; 4] = [b"inverse", b"linear", b"wrench", b"knn"];

/// A file of the program's own: the first byte chooses its kind, what follows is the body. No fuzzer guesses the sum.
pub fn sealed(bytes: &[u8]) -> Vec<u8> {
    let (kind, rest) = bytes.split_first().unwrap_or((&0, &[]));
    let kind = KINDS[usize::from(*kind) % KINDS.len()];
    let body = [&(kind.len() as u32).to_le_bytes(), kind, &[0; 4], rest].concat();
    [MAGIC, &body, &fnv1a(&body).to_le_bytes()].concat()
}

/// FNV-1a as its authors have it.
fn fnv1a(bytes: &[u8]) -> u64 {
    let step = |sum: u64, byte: &u8| (sum ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, step)
}

/// Contacts for channels of presses and for such as no pad gives; all are finite.
pub fn contacts(decoder: &Decoder) -> Vec<Contact> {
    let numbers = [0.0, 300.0, -55.5, 1e30, f32::MAX, f32::INFINITY, f32::NAN];
    let strain = |turn: usize| Strain {
        uv: std::array::from_fn(
            |k| if turn < CHANNELS { 100.0 } else { 0.0 } + numbers[(turn * (k + 1)) % numbers.len()],
        ),
    };
    let contacts: Vec<Contact> = (0..2 * CHANNELS).map(|turn| decoder.decode(&strain(turn))).collect();
    for Contact { x_mm, y_mm, fx_n, fy_n, fz_n } in &contacts {
        assert!([x_mm, y_mm, fx_n, fy_n, fz_n].iter().all(|number| number.is_finite()), "{contacts:?}");
    }
    contacts
}
