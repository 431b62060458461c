//! Any text as a description of a pad: no panic, a reason wherever there is none, and every one that there is has a decoder whose contacts
//! are numbers.
#![no_main]

use tactpad::quantity::Strain;
use tactpad::source::read;
use tactpad::toml_text::diag::Severity;

/// What channels may read, µV: nothing, a press, what no pad reads, and no number.
const READINGS_UV: [f32; 6] = [0.0, 700.0, -3e4, f32::MAX, f32::INFINITY, f32::NAN];

libfuzzer_sys::fuzz_target!(|text: &str| {
    let (source, found) = read::read(text);
    let errors = found.iter().filter(|finding| finding.severity == Severity::Error).count();
    assert_eq!(source.is_none(), errors > 0, "{found:?}");
    assert!(found.iter().all(|finding| finding.line > 0 && finding.render("x").starts_with("x:")));
    let Some(source) = source else { return };
    assert!(read::is_meant(text));
    let Some(decoder) = source.decoder() else { panic!("{source:?} has no decoder") };
    assert_eq!(decoder.channels(), source.channel_names().len());
    for shift in 0..READINGS_UV.len() {
        let uv = std::array::from_fn(|k| READINGS_UV[(k + shift) % READINGS_UV.len()]);
        let contact = decoder.decode(&Strain { uv });
        let numbers = [contact.x_mm, contact.y_mm, contact.fx_n, contact.fy_n, contact.fz_n];
        assert!(numbers.into_iter().all(f32::is_finite), "{contact:?} of {uv:?}");
    }
});
