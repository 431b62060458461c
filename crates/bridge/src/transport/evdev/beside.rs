//! What the kernel has beside an input device: the raw node of the same device, files of its driver, its battery.

use std::fs;
use std::path::{Path, PathBuf};

use rustix::fs::{Access, access};

use super::found::CLASS;

/// A raw node of a device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RawNode {
    /// The node to open.
    pub path: PathBuf,
    /// Whether this user may read it.
    pub is_readable: bool,
}

/// The folder of sysfs of the device of which the input device at `node` is a part.
pub(super) fn folder(node: &Path) -> Option<PathBuf> {
    let node = fs::canonicalize(node).ok()?;
    Some(Path::new(CLASS).join(node.file_name()?).join("device/device"))
}

/// The raw node of the device of which the input device at `node` is a part; `None` where it has none.
pub fn raw_node(node: &Path) -> Option<RawNode> {
    let path = Path::new("/dev").join(only_name(&folder(node)?.join("hidraw"))?);
    let is_readable = access(&path, Access::READ_OK).is_ok();
    path.exists().then_some(RawNode { path, is_readable })
}

/// What the driver says of the charge of the device's battery, percent; `None` where it says nothing. The driver may have to ask the device:
/// this may take a second.
pub(super) fn battery_percent(node: &Path) -> Option<u8> {
    let batteries = folder(node)?.join("power_supply");
    let charge = fs::read_to_string(batteries.join(only_name(&batteries)?).join("capacity")).ok()?;
    charge.trim().parse().ok()
}

/// The name of the first thing in a folder.
fn only_name(folder: &Path) -> Option<PathBuf> {
    Some(fs::read_dir(folder).ok()?.flatten().next()?.file_name().into())
}
