//! Any text as a device and over one: no panic, a reason wherever there is none, and what is read is written back.
#![no_main]

use tactpad::pad::device::Device;

libfuzzer_sys::fuzz_target!(|text: &str| {
    for (device, found) in [Device::from_toml(text), Device::nominal().with_imperfections(text)] {
        assert_eq!(device.is_none(), !found.is_empty(), "{found:?}");
        assert!(found.iter().all(|finding| finding.line > 0 && finding.render("x").starts_with("x:")));
        device.into_iter().for_each(|device| {
            assert_eq!(Device::from_toml(&device.to_toml()), (Some(device.clone()), vec![]));
        });
    }
});
