//! Any text as a table of each kind, placements of weights among them: no panic, a line and a reason wherever there is none, and what is read is written so that it is read as
//! the same.
#![no_main]

use tactpad::lab::play::weights;
use tactpad::tables::measured::columns::TableKind;
use tactpad::tables::measured::{read, write};

/// Places reach so far, mm.
const PLACE_MAX_MM: f64 = 30.0;

libfuzzer_sys::fuzz_target!(|text: &[u8]| {
    let text_of = String::from_utf8_lossy(text);
    match weights::read(&text_of, PLACE_MAX_MM) {
        Ok(placements) => {
            let written = weights::written(&placements.all);
            let again = weights::read(&written, PLACE_MAX_MM).expect("it was read before");
            assert_eq!(written, weights::written(&again.all));
        }
        Err(error) => assert!(error.line != Some(0) && !error.why.is_empty(), "{error:?}"),
    }
    for kind in [TableKind::Contacts, TableKind::Plan, TableKind::Measured] {
        let table = match read::table(text, kind, PLACE_MAX_MM) {
            Ok(table) => table,
            Err(error) => {
                assert!(error.line > 0 && !error.fault.to_string().is_empty(), "{error:?}");
                continue;
            }
        };
        let mut written = Vec::new();
        write::table(&mut written, &table).expect("memory takes it");
        let again = read::table(&written[..], kind, PLACE_MAX_MM).expect("it was read before");
        let mut rewritten = Vec::new();
        write::table(&mut rewritten, &again).expect("memory takes it");
        assert!(written == rewritten, "{}", String::from_utf8_lossy(&written));
    }
});
