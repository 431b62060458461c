//! Files of earlier programs: each version that ever was is read, and plays to the same events.
#![allow(clippy::unwrap_used, reason = "a test that cannot set its scene fails")]

use std::fs;
use std::path::{Path, PathBuf};

use firmware_proto::identity::SerialNumber;
use tactpad::lab::play::kept::KeptPlay;

use crate::ran::printed;

/// The folders of `tests/golden` that hold what one version wrote.
fn versions() -> Vec<PathBuf> {
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    let folders = fs::read_dir(golden).unwrap().map(|entry| entry.unwrap().path());
    let versions: Vec<PathBuf> = folders.filter(|folder| folder.join("play.capture").is_file()).collect();
    assert!(!versions.is_empty());
    versions
}

/// The first line of a file of the program's own, which names its form.
fn form(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes.split(|byte| *byte == b'\n').next().unwrap()).into_owned()
}

#[test]
fn captures_and_decoders_of_each_version_play_to_the_same_events() {
    for folder in versions() {
        let events = |name: &str| fs::read_to_string(folder.join(name)).unwrap();
        assert_eq!(printed(&folder, "replay play.capture"), events("play.events"), "{}", folder.display());
        for decoder in ["inverse", "linear", "wrench", "knn"] {
            let played = printed(&folder, &format!("replay play.capture --decoder {decoder}.decoder"));
            assert_eq!(played, events(&format!("{decoder}.events")), "{}: {decoder}", folder.display());
        }
    }
}

#[test]
fn kept_play_of_each_version_is_read() {
    for folder in versions() {
        let kept = KeptPlay::from_bytes(&fs::read(folder.join("kept.play")).unwrap()).unwrap();
        assert!(!kept.windows().is_empty(), "{}", folder.display());
        assert_eq!(KeptPlay::from_bytes(&kept.to_bytes()), Ok(kept), "{}", folder.display());
    }
}

#[test]
fn each_form_that_is_written_today_is_among_them() {
    let folder = tempfile::tempdir().unwrap();
    printed(folder.path(), "twin --plan play --seconds 5 --out now.capture");
    printed(folder.path(), "twin --plan paper --out now.csv");
    printed(folder.path(), "adapt --method linear --measured now.csv --rows 20 --out now.decoder");
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    let kept = KeptPlay::new(SerialNumber::from_ascii("PAD").unwrap(), 1).to_bytes();
    for (name, now) in
        [("play.capture", read("now.capture")), ("linear.decoder", read("now.decoder")), ("kept.play", kept)]
    {
        let forms: Vec<String> =
            versions().iter().map(|version| form(&fs::read(version.join(name)).unwrap())).collect();
        assert!(
            forms.contains(&form(&now)),
            "{:?} is in none of tests/golden: its README says how to add it",
            form(&now)
        );
    }
}
