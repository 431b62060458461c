//! Compiles the C of this repository for a test.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::support::{leave_out, require};

const INSTALL: &str = "apt-get install gcc libc6-dev";

/// Everything portable C may be asked to satisfy.
pub(crate) const STRICT: &[&str] =
    &["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror"];

/// Stops the program at the first access out of bounds and the first undefined operation.
pub(crate) const SANITIZED: &[&str] =
    &["-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"];

/// Compiles `sources`, paths from the repository's root, to a program; `None` where there is no compiler.
///
/// # Panics
/// The sources do not compile without a warning.
pub(crate) fn compile(name: &str, sources: &[&str], flags: &[&str]) -> Option<PathBuf> {
    if !require("gcc", INSTALL) {
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

/// The same sources twice: as a pad would have them, and watched by the sanitizers where those are installed.
pub(crate) fn compile_plain_and_sanitized(name: &str, sources: &[&str]) -> Vec<PathBuf> {
    let Some(plain) = compile(name, sources, &["-Os"]) else { return Vec::new() };
    let mut programs = vec![plain];
    if sanitizers_are_installed() {
        programs.extend(compile(&format!("{name}-sanitized"), sources, SANITIZED));
    } else {
        leave_out("libasan or libubsan", INSTALL);
    }
    programs
}

fn sanitizers_are_installed() -> bool {
    let linked = Command::new("gcc")
        .args(SANITIZED)
        .args(["-shared", "-x", "c", "/dev/null", "-o", "/dev/null"])
        .output();
    linked.is_ok_and(|output| output.status.success())
}

/// The repository's root, from whichever of its packages is tested.
fn root() -> PathBuf {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    package.ancestors().filter(|folder| folder.join("firmware-proto").is_dir()).last().unwrap().to_path_buf()
}
