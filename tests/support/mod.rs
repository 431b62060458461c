//! What tests need from the machine, and what happens where it is missing.

use std::env;
use std::io::{Write, stderr};

/// Says whether `program` is in the search path.
///
/// Where it is missing, prints one line with the command that installs it and returns `false`, so that the
/// test can pass without having run.
///
/// # Panics
/// The program is missing and `TACTPAD_REQUIRE_ALL` is `1`: then nothing may be left out.
pub(crate) fn require(program: &str, install: &str) -> bool {
    let path = env::var_os("PATH").unwrap_or_default();
    if env::split_paths(&path).any(|folder| folder.join(program).is_file()) {
        return true;
    }
    leave_out(program, install);
    false
}

/// Says that a test does without `what`, and the command that installs it.
///
/// # Panics
/// `TACTPAD_REQUIRE_ALL` is `1`: then nothing may be left out.
pub(crate) fn leave_out(what: &str, install: &str) {
    let line = format!("left out: {what} is missing, install it with `{install}`");
    assert!(env::var("TACTPAD_REQUIRE_ALL").as_deref() != Ok("1"), "{line}");
    // Past the test runner, which keeps what a passing test prints to itself.
    let _ = writeln!(stderr(), "{line}");
}
