//! C programs for these tests, compiled once as for a pad and once to be watched.

use std::path::PathBuf;
use std::process::Command;

use crate::c_compiler::compile;
use crate::support::leave_out;

/// Stops the program at the first access out of bounds and the first undefined operation.
const SANITIZED: &[&str] = &["-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"];

/// The program as a pad would have it, and watched by the sanitizers where those are installed; none where there
/// is no compiler.
pub(crate) fn compile_plain_and_sanitized(name: &str, sources: &[&str]) -> Vec<PathBuf> {
    let Some(plain) = compile(name, sources, &["-Os"]) else { return Vec::new() };
    let mut programs = vec![plain];
    if sanitizers_are_installed() {
        programs.extend(compile(&format!("{name}-sanitized"), sources, SANITIZED));
    } else {
        leave_out("libasan or libubsan", "apt-get install gcc");
    }
    programs
}

fn sanitizers_are_installed() -> bool {
    let mut gcc = Command::new("gcc");
    gcc.args(SANITIZED).args(["-shared", "-x", "c", "/dev/null", "-o", "/dev/null"]);
    gcc.output().is_ok_and(|output| output.status.success())
}
