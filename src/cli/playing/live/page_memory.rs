//! What stays of the page from one start to the next: the addresses at which tabs may still wait for it, and the key by which they know it.

use std::fs;
use std::io::Write;
use std::net::SocketAddrV4;
use std::os::unix::fs::MetadataExt;
use std::path::Path;

use rustix::process::getuid;

use crate::cli::failure::Failure;
use crate::cli::files::state_file;
use tactpad::dashboard::user_key::UserKey;

/// The file of the key, which all bridges of a user have in common.
const KEY_FILE: &str = "page-key";

/// Only this user may have read it.
const OTHERS: u32 = 0o077;

/// So many addresses are remembered: a tab that slept through more starts no longer finds the page.
const ADDRESSES_MAX: usize = 8;

/// The addresses in a file, the newest first.
pub(super) fn addresses(file: &str) -> Vec<SocketAddrV4> {
    let text = state_file::read(file);
    let is_loopback = |address: &SocketAddrV4| address.ip().is_loopback() && address.port() > 0;
    let read = text.lines().filter_map(|line| line.parse().ok()).filter(is_loopback);
    read.take(ADDRESSES_MAX).collect()
}

/// Keeps a new address before the earlier ones. Without it only tabs that wait do not find the next start.
pub(super) fn keep(file: &str, newest: SocketAddrV4, earlier: &[SocketAddrV4]) -> Result<(), Failure> {
    let all = [newest].into_iter().chain(earlier.iter().copied()).take(ADDRESSES_MAX);
    let text: String = all.map(|address| format!("{address}\n")).collect();
    state_file::write(file, &text)
}

/// The user's key: the one that is kept, else a new one, which is kept where there is a place for it.
pub(super) fn key() -> Result<UserKey, Failure> {
    let fresh = UserKey::fresh()?;
    let Some(path) = state_file::place(KEY_FILE) else { return Ok(fresh) };
    Ok(kept(&path).or_else(|| keep_key(&path, &fresh)).unwrap_or(fresh))
}

/// The key in a file that nobody else can have read.
fn kept(path: &Path) -> Option<UserKey> {
    let it = path.symlink_metadata().ok()?;
    let is_private = it.is_file() && it.uid() == getuid().as_raw() && it.mode() & OTHERS == 0;
    UserKey::from_hex(&fs::read_to_string(path).ok().filter(|_| is_private)?)
}

/// Keeps a key; if another start was faster, that one's is given.
fn keep_key(path: &Path, fresh: &UserKey) -> Option<UserKey> {
    let folder = path.parent()?;
    fs::create_dir_all(folder).ok()?;
    // A temporary file is its owner's alone.
    let mut file = tempfile::NamedTempFile::new_in(folder).ok()?;
    file.write_all(format!("{}\n", fresh.hex()).as_bytes()).ok()?;
    if path.symlink_metadata().is_ok() && kept(path).is_none() {
        fs::remove_file(path).ok()?;
    }
    let _ = file.persist_noclobber(path);
    kept(path)
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::{PermissionsExt, symlink};

    use super::*;

    #[test]
    fn a_key_is_kept_for_its_user_alone_and_one_that_others_could_read_is_made_anew() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("tactpad").join(KEY_FILE);
        let [first, second] = [UserKey::fresh().unwrap(), UserKey::fresh().unwrap()];
        assert_eq!(keep_key(&path, &first), Some(first.clone()));
        assert_eq!(path.metadata().unwrap().mode() & 0o777, 0o600);
        assert_eq!(keep_key(&path, &second), Some(first), "another start was faster");
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        assert_eq!(kept(&path), None);
        assert_eq!(keep_key(&path, &second), Some(second.clone()));
        fs::rename(&path, folder.path().join("elsewhere")).unwrap();
        symlink(folder.path().join("elsewhere"), &path).unwrap();
        assert_eq!(kept(&path), None, "a link could lead to a file that is not this one");
    }
}
