//! Networks as ONNX files.
//!
//! [`write`](fn@write) makes a standard model with the scalers inside: nine channels in, `[N, 9]`; five numbers of the contact out,
//! `[N, 5]`; Sub, Div, then Gemm and Relu by turns, then Mul and Add; and a checksum, which a file need not have. [`read`](fn@read) takes such a file, and those of
//! others that are the same chain: with transposed or plain Gemm, or MatMul and Add, with or without scalers.
//!
//! Source: the ONNX standard, github.com/onnx/onnx, `onnx.proto` (field numbers) and operator set 13.

mod chain;
mod checksum;
pub mod error;
mod graph;
mod read;
mod tensor;
mod wire;
mod write;

use self::error::OnnxError;
use super::Network;
#[cfg(feature = "foreign-onnx")]
use super::Zero;

/// The bytes of a network's ONNX file; equal networks give equal bytes.
pub fn write(network: &Network) -> Vec<u8> {
    write::model(network)
}

/// Zero of the channels that a model takes, as it says itself.
///
/// # Errors
/// Bytes that are no model.
#[cfg(feature = "foreign-onnx")]
pub(super) fn zero(bytes: &[u8]) -> Result<Zero, OnnxError> {
    graph::zero(bytes)
}

/// Whether a model has the checksum of the program's own files.
///
/// # Errors
/// Bytes that are no model, or whose checksum is another one.
pub fn is_sealed(bytes: &[u8]) -> Result<bool, OnnxError> {
    checksum::is_there(bytes)
}

/// Reads a network; what [`write`](fn@write) wrote reads as the same again, bit by bit.
///
/// # Errors
/// Bytes that are none, or a model of another kind. No memory is taken that the bytes do not justify.
pub fn read(bytes: &[u8]) -> Result<Network, OnnxError> {
    checksum::is_there(bytes)?;
    read::network(bytes)
}
