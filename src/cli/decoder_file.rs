//! Decoders as files.

use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;

use super::Failure;
use super::written::{create, reason};
use crate::contact::Decoder;
use crate::contact::file::MAGIC;
use crate::network::{Network, onnx};

/// Far more than any decoder needs.
const BYTES_MAX: u64 = 16_000_000;

/// Reads any decoder.
pub(super) fn read(path: &Path) -> Result<Decoder, Failure> {
    let bytes = bytes(path).map_err(|why| unusable(path, &why))?;
    if bytes.starts_with(MAGIC) {
        let read = Decoder::from_bytes(&bytes);
        return read.map(|(decoder, _)| decoder).map_err(|error| unusable(path, &format!("it {error}")));
    }
    let network = onnx::read(&bytes).map_err(|error| unusable(path, &error.to_string()))?;
    Ok(Decoder::Network(Box::new(network)))
}

/// Reads a network.
pub(super) fn read_network(path: &Path) -> Result<Network, Failure> {
    let bytes = bytes(path).map_err(|why| unusable(path, &why))?;
    onnx::read(&bytes).map_err(|error| unusable(path, &error.to_string()))
}

/// Writes a network.
pub(super) fn write_network(path: &Path, network: &Network) -> Result<(), Failure> {
    write(path, &onnx::write(network))
}

/// Writes the bytes of a decoder.
pub(super) fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let mut file = create(path)?;
    file.write_all(bytes)?;
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
