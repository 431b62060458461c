//! Compiles the C of this repository for a test.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::support::require;

/// Everything portable C may be asked to satisfy.
const STRICT: &[&str] = &["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror"];

/// Compiles `sources`, paths from the repository's root, to a program; `None` where there is no compiler.
///
/// # Panics
/// The sources do not compile without a warning.
pub(crate) fn compile(name: &str, sources: &[&str], flags: &[&str]) -> Option<PathBuf> {
    if !require("gcc", "apt-get install gcc libc6-dev") {
        return None;
    }
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    // Another run of the same test may be executing the old one.
    let unfinished = program.with_extension(std::process::id().to_string());
    let status = Command::new("gcc")
        .current_dir(root())
        .args(STRICT)
        .args(["-Ifirmware-proto/c", "-Ifirmware-proto/c/firmware"])
        .args(flags)
        .arg("-o")
        .arg(&unfinished)
        .args(sources)
        .status();
    assert!(status.unwrap().success(), "{sources:?} with {flags:?}");
    fs::rename(unfinished, &program).unwrap();
    Some(program)
}

/// The repository's root, from whichever of its packages is tested.
fn root() -> PathBuf {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    package.ancestors().filter(|folder| folder.join("firmware-proto").is_dir()).last().unwrap().to_path_buf()
}
