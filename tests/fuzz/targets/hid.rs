//! Any report: no panic, and what is read is written alike. Most inputs are made as long as a report must be.
#![no_main]

use firmware_proto::hid::{REPORT_LEN, decode_command, decode_message, encode_command, encode_message};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let mut report = [0; REPORT_LEN];
    report.iter_mut().zip(bytes).for_each(|(to, from)| *to = *from);
    for report in [bytes, &report] {
        if let Ok(message) = decode_message(report) {
            assert_eq!(decode_message(&encode_message(&message)), Ok(message));
        }
        if let Ok(command) = decode_command(report) {
            assert_eq!(decode_command(&encode_command(&command)), Ok(command));
        }
    }
});
