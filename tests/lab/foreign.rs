//! Networks of others that are more than a chain of layers, run by tract.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use tactpad::network::foreign::Foreign;
use tactpad::network::{Network, Zero, onnx};
use tactpad::pipeline::contact::{Decoder, Method, read};
use tactpad::pipeline::shipped;
use tactpad::quantity::{CHANNELS, Contact, Strain};

const RESIDUAL: &[u8] = include_bytes!("network/residual.onnx");

/// What its writer asked onnxruntime about, and the answer.
const CHANNELS_UV: [f32; CHANNELS] = [-1.0, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0];
const WANTED: [f32; 5] = [1.503_143, 1.441_045, -0.734_037_5, 2.613_658, 0.280_536_4];

fn near(found: [f32; 5], wanted: [f32; 5]) {
    for (found, wanted) in found.into_iter().zip(wanted) {
        assert!((found - wanted).abs() <= 1e-5 * wanted.abs().max(1.0), "{found} {wanted}");
    }
}

#[test]
fn what_is_no_chain_decodes_again_and_again() {
    // Its random weights are for channels around 1: of microvolts they make kilonewtons.
    assert!(read::playing(RESIDUAL).unwrap_err().to_string().contains("beyond 300 mm or 100 N"));
    let network = Foreign::read(RESIDUAL).unwrap();
    let other = network.clone();
    for _ in 0..3 {
        near(network.decode(&CHANNELS_UV), WANTED);
        near(other.decode(&CHANNELS_UV), WANTED);
        assert_ne!(network.decode(&[0.0; CHANNELS]), network.decode(&CHANNELS_UV));
    }
    let decoder = Decoder::from(network);
    assert_eq!((decoder.name(), decoder.to_bytes("")), ("foreign network", None));
    let strain = Strain { uv: [f32::NAN; CHANNELS] };
    assert_eq!(decoder.decode(&strain), Contact::default());
    assert!(decoder.decode(&Strain { uv: CHANNELS_UV }).fz_n > 0.2);
}

#[test]
fn tract_gives_what_the_program_gives_for_the_shipped_network() {
    let bytes = shipped::bytes("scdf").unwrap().into_owned();
    let (ours, theirs) = (onnx::read(&bytes).unwrap(), Foreign::read(&bytes).unwrap());
    let full_scale = [20.0_f32, 20.0, 2.0, 2.0, 5.0];
    for place in 0..500_u16 {
        let uv = std::array::from_fn(|k| f32::from(place * (k as u16 + 3) % 997) - 500.0);
        for ((ours, theirs), full_scale) in
            ours.decode(&uv).into_iter().zip(theirs.decode(&uv)).zip(full_scale)
        {
            assert!((ours - theirs).abs() <= 1e-5 * full_scale.max(ours.abs()), "{ours} {theirs}");
        }
    }
    assert!(
        matches!(read::decoder(&bytes).unwrap().method, Method::Network(_)),
        "ours is taken where it can be"
    );
}

#[test]
fn what_nobody_can_run_is_refused_with_a_sentence() {
    let told = |bytes: &[u8]| read::decoder(bytes).unwrap_err().to_string();
    let with = |from: &[u8], to: &[u8]| {
        let mut bytes = RESIDUAL.to_vec();
        let at = bytes.windows(from.len()).position(|found| found == from).unwrap();
        bytes[at..at + to.len()].copy_from_slice(to);
        bytes
    };
    let unknown = told(&with(b"Tanh", b"Hnat"));
    assert!(unknown.contains("tract cannot run it") && unknown.len() < 300, "{unknown}");
    let reshaped = told(&with(&[255; 8], &2_u64.to_le_bytes()));
    assert!(reshaped.contains("tract cannot run it"), "five numbers are no two rows: {reshaped}");
    assert!(told(&RESIDUAL[..RESIDUAL.len() / 2]).contains("no ONNX model"));
    let raw = onnx::write(&Network::untrained(&[3], Zero::Raw, &[], 1));
    assert_eq!(Foreign::read(&raw).unwrap().zero, Zero::Raw);
}
