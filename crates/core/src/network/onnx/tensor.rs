//! Numbers with their sides.

use super::error::OnnxError;
use super::wire::{Fields, Value, varint};
use crate::network::WIDTH_MAX;
use crate::network::transposed::transposed;

/// 32-bit floats.
pub(super) const FLOAT: u64 = 1;
const EXTERNAL: u64 = 1;

/// More sides than any tensor of a perceptron has.
const SIDES_MAX: usize = 4;

/// The weights between two layers of the widest kind.
const NUMBERS_MAX: usize = WIDTH_MAX * WIDTH_MAX;

/// A tensor of 32-bit floats.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Tensor {
    pub(super) sides: Vec<usize>,
    /// As many as the sides' product; all finite.
    pub(super) numbers: Vec<f32>,
}

impl Tensor {
    /// Reads a TensorProto and its name.
    pub(super) fn read(message: &[u8]) -> Result<(&[u8], Self), OnnxError> {
        let (mut name, mut tensor, mut kind) = (&[][..], Self::default(), 0);
        for field in Fields::of(message) {
            match field.ok_or(OnnxError::Damaged)? {
                (1, Value::Number(side)) => tensor.push_side(side)?,
                (1, Value::Bytes(mut packed)) => {
                    while !packed.is_empty() {
                        tensor.push_side(varint(&mut packed).ok_or(OnnxError::Damaged)?)?;
                    }
                }
                (2, Value::Number(number)) => kind = number,
                (4, Value::Float(number)) => tensor.numbers.push(number),
                (4 | 9, Value::Bytes(bytes)) => tensor.push_numbers(bytes),
                (8, Value::Bytes(bytes)) => name = bytes,
                (14, Value::Number(EXTERNAL)) => return Err(OnnxError::External),
                _ => {}
            }
        }
        match kind {
            FLOAT => tensor.checked().map(|tensor| (name, tensor)),
            // Others may hold what no layer needs, such as the shape of something; they count as empty.
            _ => Ok((name, Self::default())),
        }
    }

    /// A number that stands for a row of any length.
    pub(super) fn scalar(number: f32) -> Self {
        Self { sides: Vec::new(), numbers: vec![number] }
    }

    /// A matrix turned, `None` for anything else.
    pub(super) fn transposed(&self) -> Option<Self> {
        let [rows, columns] = self.matrix()?;
        let numbers = if rows * columns == 0 { Vec::new() } else { transposed(&self.numbers, columns) };
        Some(Self { sides: vec![columns, rows], numbers })
    }

    fn push_side(&mut self, side: u64) -> Result<(), OnnxError> {
        let side = usize::try_from(side).map_err(|_| OnnxError::Damaged)?;
        self.sides.push(side);
        if self.sides.len() > SIDES_MAX { Err(too_many_sides()) } else { Ok(()) }
    }

    /// Little-endian numbers; bytes beyond the last whole one make the count wrong or do no harm.
    fn push_numbers(&mut self, bytes: &[u8]) {
        self.numbers.extend(bytes.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)));
    }

    fn checked(self) -> Result<Self, OnnxError> {
        let count = self.sides.iter().try_fold(1_usize, |product, side| product.checked_mul(*side));
        match () {
            () if count != Some(self.numbers.len()) => Err(OnnxError::Damaged),
            () if self.numbers.len() > NUMBERS_MAX => Err(too_large()),
            () if !self.numbers.iter().all(|number| number.is_finite()) => Err(OnnxError::NotANumber),
            () => Ok(self),
        }
    }

    /// The numbers of a row, `[n]` or `[1, n]`, or the one that stands for a row.
    pub(super) fn row(&self) -> Option<&[f32]> {
        let leading = self.sides.split_last().map_or(&[][..], |(_, leading)| leading);
        leading.iter().all(|side| *side == 1).then_some(&self.numbers)
    }

    /// Rows and columns of a matrix.
    pub(super) fn matrix(&self) -> Option<[usize; 2]> {
        self.sides.as_slice().try_into().ok()
    }
}

fn too_large() -> OnnxError {
    OnnxError::Unsupported(format!("a tensor has more than {NUMBERS_MAX} numbers"))
}

fn too_many_sides() -> OnnxError {
    OnnxError::Unsupported(format!("a tensor has more than {SIDES_MAX} sides"))
}
