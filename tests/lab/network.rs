//! Networks as ONNX files: what was written reads back, those of others are understood, and no bytes do harm.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use proptest::prelude::*;
use tactpad::network::onnx;
use tactpad::network::onnx::error::OnnxError;
use tactpad::network::{Example, Network, Zero};

const GEMM: &[u8] = include_bytes!("network/gemm.onnx");
const MATMUL: &[u8] = include_bytes!("network/matmul.onnx");
const TRACED: &[u8] = include_bytes!("network/traced.onnx");
const TRANSLATED: &[u8] = include_bytes!("network/translated.onnx");
const RESIDUAL: &[u8] = include_bytes!("network/residual.onnx");

/// The channels that the foreign networks were asked about.
fn channels() -> [f32; 9] {
    [-1.0, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0]
}

/// A network with scalers of its own.
fn network(hidden: &[usize], zero: Zero) -> Network {
    let example = |k: u8| Example {
        uv: std::array::from_fn(|channel| f32::from(k) * 30.0 + channel as f32),
        contact: std::array::from_fn(|number| f32::from(k * k) - 5.0 * number as f32),
    };
    let examples: Vec<Example> = (0..9).map(example).collect();
    Network::untrained(hidden, zero, &examples, 6)
}

#[test]
fn what_is_written_reads_back_bit_by_bit() {
    for (hidden, zero) in [(&[][..], Zero::Tared), (&[17, 3], Zero::Raw), (&[128, 128, 64], Zero::Tared)] {
        let network = network(hidden, zero);
        let bytes = onnx::write(&network);
        let again = onnx::read(&bytes).unwrap();
        assert_eq!(again, network);
        assert_eq!(onnx::write(&again), bytes);
        assert_eq!(again.decode(&channels()), network.decode(&channels()));
    }
    assert_eq!(network(&[128, 128, 64], Zero::Tared).parameters(), 26_373);
}

#[test]
fn networks_of_others_give_what_onnxruntime_gives() {
    let wanted = [
        (GEMM, [0.914_275_17, 0.936_949_85, 0.380_200_03, -0.337_649_9, 2.171_2]),
        (MATMUL, [0.178_992_99, 0.330_872_18, 0.782_304_6, 0.185_448_9, 3.840_028]),
        (TRACED, [4.002_611, -5.377_047, -0.122_009_9, -0.019_887_49, 1.126_965]),
        (TRANSLATED, [-9.108_138, 19.544_01, -6.015_373, -4.044_91, 13.962_2]),
    ];
    for (bytes, wanted) in wanted {
        let network = onnx::read(bytes).unwrap();
        assert!(network.widths().iter().all(|width| [9, 6, 5].contains(width)), "{:?}", network.widths());
        assert_eq!(network.zero, Zero::Tared);
        for (found, wanted) in network.decode(&channels()).into_iter().zip(wanted) {
            assert!((found - wanted).abs() < 2e-6_f32 * wanted.abs().max(1.0), "{found} {wanted}");
        }
        assert_eq!(onnx::read(&onnx::write(&network)), Ok(network), "as ours it is the same");
    }
}

#[test]
fn decoding_allocates_nothing() {
    let network = network(&[128, 128, 64], Zero::Tared);
    let mut sum = 0.0;
    let allocated = allocation_counter::measure(|| sum += network.decode(&channels())[0]);
    assert!(sum != 0.0 && sum.is_finite());
    assert_eq!(allocated.count_total, 0);
}

/// The bytes with every `from` replaced by `to`, which is as long.
fn replaced(bytes: &[u8], from: &[u8], to: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    let places: Vec<usize> =
        (0..=bytes.len() - from.len()).filter(|at| bytes[*at..].starts_with(from)).collect();
    assert!(!places.is_empty() && from.len() == to.len());
    places.into_iter().for_each(|at| bytes[at..at + to.len()].copy_from_slice(to));
    bytes
}

/// The bytes of a file of ours as an earlier tactpad wrote them: its last property is left out.
fn without_checksum(bytes: &[u8]) -> Vec<u8> {
    let at = bytes.windows(KEY.len()).rposition(|window| window == KEY).unwrap();
    // Before the key: the property's field and length, the key's field and length.
    bytes[..at - 4].to_vec()
}

const KEY: &[u8] = b"tactpad.checksum";

#[test]
fn the_checksum_finds_every_flipped_bit_that_changes_anything() {
    let network = network(&[6], Zero::Raw);
    let bytes = onnx::write(&network);
    let mut taken = 0;
    for bit in 0..8 * bytes.len() {
        let mut flipped = bytes.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        if let Ok(read) = onnx::read(&flipped) {
            assert_eq!(read, network, "bit {bit}");
            taken += 1;
        }
    }
    // In the name of the checksum itself: then the file is one without.
    assert!(taken <= 8 * (KEY.len() + 4), "{taken} of {} flips are taken", 8 * bytes.len());
    let mut longer = bytes.clone();
    longer.extend_from_slice(&bytes);
    assert_eq!(onnx::read(&longer), Err(OnnxError::Checksum));
    assert!(onnx::read(&replaced(&bytes, b"raw", b"wet")) == Err(OnnxError::Checksum));
    let earlier = without_checksum(&bytes);
    assert_eq!(onnx::read(&earlier), Ok(network));
    assert_eq!([&bytes, &earlier].map(|bytes| onnx::is_sealed(bytes)), [Ok(true), Ok(false)]);
}

#[test]
fn other_models_are_refused_with_the_reason() {
    let told = |bytes: &[u8]| onnx::read(bytes).unwrap_err().to_string();
    assert!(
        told(&replaced(GEMM, b"Relu", b"Tanh")).starts_with("an operator Tanh is no step of a perceptron; ")
    );
    assert!(told(&replaced(MATMUL, b"Relu", b"Sqrt")).contains("operator Sqrt"));
    let exotic = told(RESIDUAL);
    assert!(exotic.contains("operator Tanh") && exotic.contains("--features foreign-onnx"), "{exotic}");
    // What follows the checksum's sum is not asked for where there is none.
    let own = without_checksum(&onnx::write(&network(&[4], Zero::Raw)));
    let weighty = told(&replaced(&own, b"Gemm", b"Relu"));
    assert!(weighty.contains("operator Relu"), "{weighty}");
    let divided = onnx::read(&replaced(TRANSLATED, &0.125_f32.to_le_bytes(), &[0; 4]));
    assert_eq!(divided, Err(OnnxError::NotANumber));
    assert_eq!(onnx::read(&replaced(&own, b"raw", b"wet")), Err(OnnxError::Damaged));
    let nan = replaced(GEMM, &0.6_f32.to_le_bytes(), &f32::NAN.to_le_bytes());
    assert_eq!(onnx::read(&nan), Err(OnnxError::NotANumber));
    assert_eq!(onnx::read(b""), Err(OnnxError::Damaged));
}

#[test]
fn every_truncation_is_refused() {
    for bytes in [GEMM, MATMUL, &onnx::write(&network(&[3], Zero::Raw))] {
        let whole = onnx::read(bytes).unwrap();
        for length in 0..bytes.len() {
            // Cut behind the graph, what is lost is only what says who wrote it, or what it takes.
            let mut cut = onnx::read(&bytes[..length]);
            cut.iter_mut().for_each(|cut| cut.zero = whole.zero);
            assert!(cut.is_err() || cut.as_ref() == Ok(&whole), "{length}");
        }
        assert!(onnx::read(&bytes[..bytes.len() / 2]).is_err());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn bytes_do_no_harm(noise: Vec<u8>, at: prop::sample::Index, change: u8, foreign: bool) {
        let mut bytes = if foreign { MATMUL.to_vec() } else { onnx::write(&network(&[3], Zero::Tared)) };
        let at = at.index(bytes.len());
        bytes[at] ^= change;
        for bytes in [&noise, &bytes] {
            let allocated = allocation_counter::measure(|| {
                if let Ok(network) = onnx::read(bytes) {
                    network.decode(&channels());
                }
            });
            prop_assert!(allocated.bytes_max < 100_000, "{} bytes", allocated.bytes_max);
        }
    }
}
