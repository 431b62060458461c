//! Texts that people wrote: profiles and devices.

use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use crate::cli::printing::written::reason;
use tactpad::toml_text::{self, TEXT_BYTES_MAX};

/// The text of a file, or why there is none.
pub(crate) fn read(path: &Path) -> Result<String, String> {
    // Asked before it is opened: opening a pipe would wait for its other end.
    let file = fs::metadata(path).map_err(|error| reason(&error))?;
    if !file.is_file() {
        return Err(format!(
            "it is {}, not a file",
            if file.is_dir() { "a directory" } else { "a device or a pipe" }
        ));
    }
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(|error| reason(&error))?;
    file.take(TEXT_BYTES_MAX as u64 + 1).read_to_end(&mut bytes).map_err(|error| reason(&error))?;
    if bytes.len() > TEXT_BYTES_MAX {
        return Err(toml_text::too_long());
    }
    if toml_text::is_utf16(&bytes) {
        return Err("it is UTF-16: save it as UTF-8".into());
    }
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let line = 1 + error.as_bytes().iter().take(at).filter(|byte| **byte == b'\n').count();
        format!("it is not text: byte {} in line {line} is not UTF-8", at + 1)
    })
}
