//! One version: what the program says, the changelog's newest heading, and what packages have.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::path::Path;

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
