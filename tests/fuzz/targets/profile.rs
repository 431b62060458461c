//! Any text as a profile: no panic, a reason wherever there is no profile, and every profile that there is plays.
#![no_main]

use tactpad::pipeline::mapping::read::check::{self, OutputChoice};
use tactpad::toml_text::diag::Severity;
use tactpad_fuzz::rig::Rig;

libfuzzer_sys::fuzz_target!(|text: &str| {
    for choice in [OutputChoice::AsWritten, OutputChoice::Keyboard] {
        let (profile, found) = check::read(text, choice);
        let errors = found.iter().filter(|finding| finding.severity == Severity::Error).count();
        assert_eq!(profile.is_none(), errors > 0, "{found:?}");
        assert!(found.iter().all(|finding| finding.line > 0 && finding.render("x").starts_with("x:")));
        profile.into_iter().for_each(|profile| Rig::new(profile).sweep());
    }
});
