//! Why a file is no network.

use std::fmt;

/// Why a file is no network that can be used. As text: what is wrong, and the way out.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum OnnxError {
    /// The bytes are no ONNX model, or end early.
    Damaged,
    /// Its checksum is not that of its bytes.
    Checksum,
    /// For a press of the nominal pad it gives a contact that is not finite, or farther and stronger than any.
    Absurd,
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
            Self::Checksum => f.write_str(
                "its checksum is not that of its numbers: the file is damaged; make it anew with train or adapt, or, if it was \
                 changed on purpose, take its property tactpad.checksum out",
            ),
            Self::Absurd => f.write_str(
                "a press on the nominal pad would be beyond 300 mm or 100 N, or no number: it is damaged, or takes something \
                 else than microvolts; export it again",
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
