//! Networks as ONNX files.
//!
//! [`write`](fn@write) makes a standard model with the scalers inside: nine channels in, `[N, 9]`; five numbers of the contact out,
//! `[N, 5]`; Sub, Div, then Gemm and Relu by turns, then Mul and Add. [`read`](fn@read) takes such a file, and those of
//! others that are the same chain: with transposed or plain Gemm, or MatMul and Add, with or without scalers.
//!
//! Source: the ONNX standard, github.com/onnx/onnx, `onnx.proto` (field numbers) and operator set 13.

mod chain;
mod graph;
mod read;
mod tensor;
mod wire;
mod write;

use std::fmt;

use super::Network;
#[cfg(feature = "foreign-onnx")]
use super::Zero;

/// Where a file says what it takes; `tared` or `raw`. A file of others, which says nothing, takes tared channels.
const CHANNELS_KEY: &str = "tactpad.channels";

/// Why a file is no network that can be used. As text: what is wrong, and the way out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum OnnxError {
    /// The bytes are no ONNX model, or end early.
    Damaged,
    /// The weights are in another file.
    External,
    /// The model holds something else than a perceptron: what.
    Unsupported(String),
    /// It is a perceptron, but not one from nine channels to five numbers: how.
    Shape(String),
    /// A model that is no perceptron, and that tract does not run, either: what it says.
    #[cfg(feature = "foreign-onnx")]
    Foreign(String),
    /// A weight that is not finite, or a scaler that divides by zero.
    NotANumber,
}

impl fmt::Display for OnnxError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Damaged => f.write_str(
                "it is no ONNX model, or is damaged; make it with train or adapt, or export it again",
            ),
            Self::External => {
                f.write_str("its weights are in another file; export it as one file (external_data=False)")
            }
            Self::Unsupported(what) => write!(
                f,
                "{what}; only a chain of fully connected layers in 32-bit floats is read: scalers, then Gemm (or MatMul \
                 and Add) and Relu by turns, then scalers. Other graphs need a tactpad that was built with \
                 --features foreign-onnx"
            ),
            #[cfg(feature = "foreign-onnx")]
            Self::Foreign(what) => write!(f, "tract cannot run it: {what}"),
            Self::Shape(what) => write!(f, "{what}; a decoder takes 9 channels and gives x, y, Fx, Fy, Fz"),
            Self::NotANumber => {
                f.write_str("it holds a weight that is not finite, or divides by zero; train it again")
            }
        }
    }
}

impl std::error::Error for OnnxError {}

/// The bytes of a network's ONNX file; equal networks give equal bytes.
pub fn write(network: &Network) -> Vec<u8> {
    write::model(network)
}

/// What a model takes, as it says itself.
///
/// # Errors
/// Bytes that are no model.
#[cfg(feature = "foreign-onnx")]
pub(super) fn zero(bytes: &[u8]) -> Result<Zero, OnnxError> {
    graph::zero(bytes)
}

/// Reads a network; what [`write`](fn@write) wrote reads as the same again, bit by bit.
///
/// # Errors
/// Bytes that are none, or a model of another kind. No memory is taken that the bytes do not justify.
pub fn read(bytes: &[u8]) -> Result<Network, OnnxError> {
    read::network(bytes)
}
