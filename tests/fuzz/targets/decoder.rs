//! Any bytes as a decoder: no panic, a reason wherever there is none, and each that there is gives finite contacts and
//! reads back as it is written.
#![no_main]

use tactpad::network::onnx;
use tactpad::pipeline::contact::{Method, read};
use tactpad_fuzz::decoded::{contacts, sealed};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    for file in [bytes.to_vec(), sealed(bytes)] {
        let decoder = match read::decoder(&file) {
            Ok(decoder) => decoder,
            Err(error) => {
                assert!(error.to_string().len() > 20, "{error}");
                continue;
            }
        };
        let again = match &decoder.method {
            Method::Network(network) => Some(onnx::write(network)),
            _ => decoder.to_bytes("a note"),
        };
        let again = again.map(|bytes| read::decoder(&bytes).unwrap());
        assert!(again.is_none_or(|again| contacts(&again) == contacts(&decoder)));
    }
});
