//! The bridge on a real Linux input stack: every test boots a kernel of its own and runs its body inside.
#![cfg(all(feature = "live", target_os = "linux"))]
#![allow(
    clippy::expect_used,
    clippy::print_stdout,
    reason = "a test fails by panicking and shows what it saw"
)]

#[path = "kernel/guest.rs"]
mod guest;
mod support;

use guest::in_guest;

#[test]
fn guest_kernel_has_uinput() {
    in_guest("guest_kernel_has_uinput", || {
        assert!(std::path::Path::new("/dev/uinput").exists());
    });
}
