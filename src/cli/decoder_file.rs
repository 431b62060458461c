//! Decoders as files.

use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;

use super::Failure;
use super::written::{create, reason};
use crate::network::{Network, onnx};

/// Far more than any decoder needs.
const BYTES_MAX: u64 = 16_000_000;

/// Reads a network.
pub(super) fn read(path: &Path) -> Result<Network, Failure> {
    let bytes = bytes(path).map_err(|why| unusable(path, &why))?;
    onnx::read(&bytes).map_err(|error| unusable(path, &error.to_string()))
}

/// Writes a network.
pub(super) fn write(path: &Path, network: &Network) -> Result<(), Failure> {
    let mut file = create(path)?;
    file.write_all(&onnx::write(network))?;
    Ok(file.flush()?)
}

fn bytes(path: &Path) -> Result<Vec<u8>, String> {
    let file = File::open(path).map_err(|error| reason(&error))?;
    if !file.metadata().is_ok_and(|file| file.is_file()) {
        return Err("it is no file; name one that train or adapt wrote".into());
    }
    let mut bytes = Vec::new();
    file.take(BYTES_MAX + 1).read_to_end(&mut bytes).map_err(|error| reason(&error))?;
    if bytes.len() as u64 > BYTES_MAX {
        return Err(format!("it is larger than {} MB: this is no decoder", BYTES_MAX / 1_000_000));
    }
    Ok(bytes)
}

fn unusable(path: &Path, why: &str) -> Failure {
    Failure::Unusable(format!("decoder {} cannot be read: {why}", path.display()))
}
