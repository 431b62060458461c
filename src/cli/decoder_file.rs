//! Decoders as files, or by the names of those that are inside the program.

use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;

use clap::Args;

use super::Failure;
use super::written::{create, reason};
use crate::contact::{Decoder, read, shipped};
use crate::network::{Network, onnx};

/// Far more than any decoder needs, and no more than a capture's entry holds.
const BYTES_MAX: u64 = 16_000_000;

/// The decoder of a verb that plays.
#[derive(Debug, Args)]
pub(super) struct Choice {
    /// What turns channels into a contact: a file that adapt or train wrote, statics, or scdf.
    #[arg(long, value_name = "NAME|FILE")]
    decoder: Option<String>,
}

/// A decoder that is to play.
#[derive(Clone, Debug)]
pub(super) struct Chosen {
    pub(super) decoder: Decoder,
    /// As people are told of it.
    pub(super) name: String,
    /// What captures keep of it; nothing for the statics that are inside the program.
    pub(super) bytes: Option<Vec<u8>>,
}

impl Choice {
    /// The file that is read, if it is one.
    pub(super) fn file(&self) -> Option<&Path> {
        self.decoder.as_deref().filter(|name| shipped::bytes(name).is_none()).map(Path::new)
    }

    /// Whether one was chosen.
    pub(super) const fn is_given(&self) -> bool {
        self.decoder.is_some()
    }

    /// Reads it.
    pub(super) fn read(&self) -> Result<Chosen, Failure> {
        let name = self.decoder.as_deref().unwrap_or(shipped::STATICS);
        let path = Path::new(name);
        let bytes = bytes(path).map_err(|why| unusable(path, &why))?;
        let decoder = read::playing(&bytes).map_err(|error| unusable(path, &error.to_string()))?;
        let kind = decoder.name();
        let name = if name == kind { name.into() } else { format!("{kind} ({name})") };
        Ok(Chosen { decoder, bytes: Some(bytes).filter(|_| name != shipped::STATICS), name })
    }
}

/// Reads any decoder.
pub(super) fn read(path: &Path) -> Result<Decoder, Failure> {
    let bytes = bytes(path).map_err(|why| unusable(path, &why))?;
    read::decoder(&bytes).map_err(|error| unusable(path, &error.to_string()))
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

/// What a name or a file stands for. A file of a shipped decoder's name is meant by `./NAME`.
fn bytes(path: &Path) -> Result<Vec<u8>, String> {
    if let Some(bytes) = path.to_str().and_then(shipped::bytes) {
        return Ok(bytes.into());
    }
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
