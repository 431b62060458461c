//! Any file as a capture: no panic, what is read is written alike, and it replays to the same events each time.
#![no_main]

use tactpad_fuzz::captured::{MAGIC, read, replayed, sealed, written};

libfuzzer_sys::fuzz_target!(|entries: &[u8]| {
    assert!(read(entries).is_empty() || entries.starts_with(MAGIC));
    for file in [[MAGIC, entries].concat(), sealed(entries)] {
        let again = written(&file);
        // What holds no play is no capture, though its beginning can be read.
        assert!(
            read(&again).is_empty() || read(&again) == read(&file),
            "what was read is not what is written"
        );
        assert_eq!(replayed(&file), replayed(&file));
    }
});
