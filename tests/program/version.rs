//! One version: what the program says, the changelog's newest heading, and what packages have.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::ran::printed;

/// What stands behind the first line of a file that begins with `start`.
fn after(file: &str, start: &str) -> String {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).unwrap();
    let found = text.lines().find_map(|line| line.strip_prefix(start));
    found.unwrap_or_else(|| panic!("{file} has no line that begins with {start}")).to_owned()
}

#[test]
fn version_changelog_and_packages_agree() {
    let manifest = after("Cargo.toml", "version = ");
    let version = manifest.trim_matches('"');
    assert_eq!(printed(Path::new("."), "--version"), format!("tactpad {version}\n"));
    let heading = after("CHANGELOG.md", "## ");
    let (newest, day) = heading.split_once(" - ").unwrap();
    assert_eq!(newest, version, "CHANGELOG.md's newest heading");
    let is_day =
        day.split('-').map(str::len).eq([4, 2, 2]) && day.bytes().all(|it| it == b'-' || it.is_ascii_digit());
    assert!(day == "unreleased" || is_day, "the day of a release is written as 2026-01-31: {day}");
    assert_eq!(after("dist/PKGBUILD", "pkgver="), version);
}

/// A start that reads files, builds tables or starts threads touches hundreds of pages more. Half of this is the loader.
#[cfg(target_os = "linux")]
const PAGE_FAULTS_MAX: u64 = 1_000;

#[test]
#[cfg(target_os = "linux")]
fn the_version_is_told_without_work() {
    let mut child =
        Command::new(env!("CARGO_BIN_EXE_tactpad")).arg("--version").stdout(Stdio::piped()).spawn().unwrap();
    // Its output ends with it; until it is waited for the kernel keeps its account.
    let mut said = String::new();
    child.stdout.take().unwrap().read_to_string(&mut said).unwrap();
    let account = || fs::read_to_string(format!("/proc/{}/stat", child.id())).unwrap();
    let account = std::iter::repeat_with(account).find(|text| text.contains(") Z ")).unwrap();
    let faults: u64 = account.rsplit(") ").next().unwrap().split(' ').nth(7).unwrap().parse().unwrap();
    assert!(child.wait().unwrap().success() && said.starts_with("tactpad "));
    assert!((1..PAGE_FAULTS_MAX).contains(&faults), "{faults} page faults");
}
