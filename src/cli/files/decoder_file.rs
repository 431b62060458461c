//! Decoders as files, or by the names of those that are inside the program.

use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use clap::Args;

use super::destination::Destination;
use crate::cli::failure::Failure;
use crate::cli::printing::written::{reason, say};
use tactpad::network::{Network, onnx};
use tactpad::pipeline::contact::nominal::PressErrors;
use tactpad::pipeline::contact::read::Unreadable;
use tactpad::pipeline::contact::{Decoder, read};
use tactpad::pipeline::shipped;

/// Far more than any decoder needs, and no more than a capture's entry holds.
const BYTES_MAX: u64 = 16_000_000;

/// The first bytes of decoders of all versions.
const KIND: &[u8; 16] = b"tactpad decoder ";

/// The decoder of a verb that plays.
#[derive(Debug, Args)]
pub(crate) struct DecoderChoice {
    /// What turns channels into a contact: a file that adapt or train wrote, inverse (the default), statics, or scdf.
    #[arg(long, value_name = "NAME|FILE")]
    decoder: Option<String>,
}

impl DecoderChoice {
    /// Whether one was chosen.
    pub(crate) const fn is_given(&self) -> bool {
        self.decoder.is_some()
    }

    /// The name or file of the decoder: the chosen one, or the default.
    pub(crate) fn name(&self) -> &str {
        self.decoder.as_deref().unwrap_or(shipped::INVERSE)
    }

    /// The decoder, as `read` takes it from its bytes, and the bytes.
    pub(crate) fn read_by(
        &self,
        read: impl Fn(&[u8]) -> Result<Decoder, Unreadable>,
    ) -> Result<(Decoder, Vec<u8>), Failure> {
        let path = Path::new(self.name());
        let bytes = bytes(path).map_err(|why| unusable(path, &why))?;
        let decoder = read(&bytes).map_err(|error| unusable(path, &error.to_string()))?;
        say_doubts(path, &bytes, &decoder);
        Ok((decoder, bytes))
    }
}

/// Whether a name or a file means a decoder of the program's own, be it damaged or of another version.
pub(crate) fn is_meant(path: &Path) -> bool {
    if path.to_str().is_some_and(shipped::is_known) {
        return true;
    }
    // Asked before it is opened: opening a pipe would wait for its other end.
    let file = fs::metadata(path).is_ok_and(|it| it.is_file()).then(|| File::open(path).ok());
    let mut first = [0; KIND.len()];
    file.flatten().is_some_and(|mut file| file.read_exact(&mut first).is_ok() && first == *KIND)
}

/// Reads any decoder.
pub(crate) fn read(path: &Path) -> Result<Decoder, Failure> {
    let bytes = bytes(path).map_err(|why| unusable(path, &why))?;
    let decoder = read::decoder(&bytes).map_err(|error| unusable(path, &error.to_string()))?;
    say_doubts(path, &bytes, &decoder);
    Ok(decoder)
}

/// The bytes of a decoder, which can be read.
pub(crate) fn whole(path: &Path) -> Result<Vec<u8>, Failure> {
    let bytes = bytes(path).map_err(|why| unusable(path, &why))?;
    check(&bytes).map_err(|error| unusable(path, &error.to_string()))?;
    Ok(bytes)
}

/// Whether bytes are those of a decoder.
pub(crate) fn check(bytes: &[u8]) -> Result<(), Unreadable> {
    read::decoder(bytes).map(drop)
}

/// Warns of a network that may be of another pad.
fn say_doubts(path: &Path, bytes: &[u8], decoder: &Decoder) {
    if let Some(PressErrors { place_mm, force_n, .. }) = read::doubts(bytes, decoder) {
        say(format_args!(
            "warning: decoder {}: it has no checksum of tactpad's, and misses presses of the nominal pad by {place_mm:.1} mm and \
             {force_n:.2} N: it may be of another pad",
            path.display()
        ));
    }
}

/// Reads a network.
pub(crate) fn read_network(path: &Path) -> Result<Network, Failure> {
    let bytes = bytes(path).map_err(|why| unusable(path, &why))?;
    read::perceptron(&bytes).map_err(|error| unusable(path, &error.to_string()))
}

/// Writes a network.
pub(crate) fn write_network(to: &Destination, network: &Network) -> Result<(), Failure> {
    to.write(&onnx::write(network))
}

/// The bytes of the decoder with this name or file. A file of a shipped decoder's name is meant by `./NAME`.
fn bytes(path: &Path) -> Result<Vec<u8>, String> {
    if let Some(bytes) = path.to_str().and_then(shipped::bytes) {
        return Ok(bytes.into_owned());
    }
    // Asked before it is opened: opening a pipe would wait for its other end.
    if !fs::metadata(path).map_err(|error| reason(&error))?.is_file() {
        return Err("it is no file; name one that train or adapt wrote".into());
    }
    let file = File::open(path).map_err(|error| reason(&error))?;
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
