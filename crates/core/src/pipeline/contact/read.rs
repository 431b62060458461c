//! Decoders from bytes, whatever their form: files of the program's own, networks as ONNX, the numbers of statics as TOML.

use std::fmt;

use super::file::DecoderFileError;
use super::nominal::{self, PressErrors};
use super::statics::{ModelError, Statics, StaticsModel};
use super::{Decoder, Method};
#[cfg(feature = "foreign-onnx")]
use crate::network::foreign::Foreign;
use crate::network::onnx::error::OnnxError;
use crate::network::{Network, Zero, onnx};
use crate::source;

/// How files of the program's own begin, of whatever version.
const OWN: &[u8] = b"tactpad decoder ";

/// Why bytes are no decoder that can be used. As text: what is wrong, and the way out.
#[derive(Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Unreadable {
    /// A file of the program's own that is damaged, or of another version.
    Own(DecoderFileError),
    /// No network that can be used; anything that looks like nothing else ends here.
    Network(OnnxError),
    /// Numbers of statics that are incomplete or impossible.
    Statics(ModelError),
    /// A description of a pad with mistakes: the first, with its line.
    Description(String),
    /// A decoder that learnt raw channels, where the zero is taken off them.
    TakesRaw,
    /// A decoder that is made to be compared, not to play: its name, and why.
    CannotPlay(&'static str, &'static str),
}

impl fmt::Display for Unreadable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Own(error) => write!(f, "it {error}"),
            Self::Network(error) => error.fmt(f),
            Self::Statics(error) => {
                write!(f, "{error}; a decoder is what adapt or train wrote, or has the form of models/statics.toml")
            }
            Self::Description(mistake) => {
                write!(f, "{mistake}; `tactpad source check` tells all that is wrong with it")
            }
            Self::TakesRaw => f.write_str(
                "it learnt channels with the pad's offset in them, and in play the zero is taken off; adapt it to a table \
                 that has rows without force",
            ),
            Self::CannotPlay(name, why) => write!(
                f,
                "{name} is for comparison and cannot play: {why}; evaluate and replay take it, and adapt --method inverse \
                 makes one that plays"
            ),
        }
    }
}

impl std::error::Error for Unreadable {}

/// Reads any decoder.
///
/// # Errors
/// Bytes that are none.
pub fn decoder(bytes: &[u8]) -> Result<Decoder, Unreadable> {
    if bytes.starts_with(OWN) {
        return Decoder::from_bytes(bytes).map(|(decoder, _)| decoder).map_err(Unreadable::Own);
    }
    match text(bytes) {
        Some(text) if source::read::is_meant(text) => described(text),
        Some(text) => statics(text).map_err(Unreadable::Statics),
        None => network(bytes).map_err(Unreadable::Network),
    }
}

/// Reads a decoder that takes channels relative to the untouched pad, as the pipeline has them.
///
/// # Errors
/// Bytes that are none, or a decoder that takes raw channels.
pub fn tared(bytes: &[u8]) -> Result<Decoder, Unreadable> {
    match decoder(bytes)? {
        decoder if decoder.zero() == Zero::Raw => Err(Unreadable::TakesRaw),
        decoder => Ok(decoder),
    }
}

/// Reads a decoder that can play: it takes channels relative to the untouched pad, and sees lifts and places.
///
/// # Errors
/// Bytes that are none, or a decoder that cannot play.
pub fn playing(bytes: &[u8]) -> Result<Decoder, Unreadable> {
    let decoder = tared(bytes)?;
    match decoder.cannot_play() {
        Some(why) => Err(Unreadable::CannotPlay(decoder.name(), why)),
        None => Ok(decoder),
    }
}

/// The bytes as a text that people could have written. An ONNX file has control characters from its first byte on.
fn text(bytes: &[u8]) -> Option<&str> {
    let is_written = |c: char| !c.is_control() || c.is_whitespace();
    std::str::from_utf8(bytes).ok().filter(|text| !text.is_empty() && text.chars().all(is_written))
}

/// The decoder of a described pad.
fn described(text: &str) -> Result<Decoder, Unreadable> {
    let (source, found) = source::read::read(text);
    source.and_then(|source| source.decoder()).ok_or_else(|| {
        let first = found.first().map(|found| format!("line {}: {}", found.line, found.message));
        Unreadable::Description(first.unwrap_or_else(|| "it describes no pad that can be played with".into()))
    })
}

fn statics(text: &str) -> Result<Decoder, ModelError> {
    StaticsModel::from_toml(text).and_then(Statics::new).map(Decoder::from)
}

/// Reads a perceptron.
///
/// # Errors
/// Bytes that are none, a checksum that is wrong, or, without a checksum, contacts that no pad has.
pub fn perceptron(bytes: &[u8]) -> Result<Network, OnnxError> {
    let network = onnx::read(bytes)?;
    let is_sound = onnx::is_sealed(bytes)? || nominal::misses(|uv| network.decode(uv)).is_some();
    if is_sound { Ok(network) } else { Err(OnnxError::Absurd) }
}

/// A perceptron; with the feature for it, what else tract can run.
fn network(bytes: &[u8]) -> Result<Decoder, OnnxError> {
    match perceptron(bytes) {
        #[cfg(feature = "foreign-onnx")]
        Err(OnnxError::Unsupported(_) | OnnxError::Shape(_)) => foreign(bytes),
        read => read.map(Decoder::from),
    }
}

#[cfg(feature = "foreign-onnx")]
fn foreign(bytes: &[u8]) -> Result<Decoder, OnnxError> {
    let network = Foreign::read(bytes)?;
    nominal::misses(|uv| network.decode(uv)).ok_or(OnnxError::Absurd)?;
    Ok(network.into())
}

/// How far a network without checksum is from presses of the nominal pad, if that is far: it may be of another pad. One that
/// takes raw channels cannot be asked.
pub fn doubts(bytes: &[u8], decoder: &Decoder) -> Option<PressErrors> {
    if decoder.zero() == Zero::Raw || onnx::is_sealed(bytes) == Ok(true) {
        return None;
    }
    let misses = match &decoder.method {
        Method::Network(network) => nominal::misses(|uv| network.decode(uv)),
        #[cfg(feature = "foreign-onnx")]
        Method::Foreign(network) => nominal::misses(|uv| network.decode(uv)),
        _ => None,
    };
    misses.filter(PressErrors::are_large)
}
