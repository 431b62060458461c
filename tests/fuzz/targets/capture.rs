//! Any file as a capture: no panic, what is read is written alike, and it replays to the same events each time.
#![no_main]

use tactpad_fuzz::captured::{MAGIC, calls, replayed, sealed, written};

libfuzzer_sys::fuzz_target!(|entries: &[u8]| {
    assert!(calls(entries).is_empty() || entries.starts_with(MAGIC));
    for file in [[MAGIC, entries].concat(), sealed(entries)] {
        let calls = calls(&file);
        assert!(file.starts_with(&written(&calls)), "what was read is not what stands there");
        assert_eq!(replayed(&calls), replayed(&calls));
    }
});
