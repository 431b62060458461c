//! The parts of a model: nodes, and tensors by their names.

use std::collections::BTreeMap;

use super::tensor::Tensor;
use super::wire::{Fields, Value};
use super::{CHANNELS_KEY, OnnxError};
use crate::network::Zero;

/// What is read of a model.
#[derive(Debug)]
pub(super) struct Graph<'b> {
    pub(super) zero: Zero,
    /// In the file's order, in which each comes after those that it needs.
    pub(super) nodes: Vec<Node<'b>>,
    pub(super) tensors: BTreeMap<&'b [u8], Tensor>,
    pub(super) inputs: Vec<&'b [u8]>,
    pub(super) outputs: Vec<&'b [u8]>,
}

/// An operator with the names of what it takes and gives.
#[derive(Debug, Default)]
pub(super) struct Node<'b> {
    pub(super) operator: &'b [u8],
    pub(super) takes: Vec<&'b [u8]>,
    pub(super) gives: &'b [u8],
    pub(super) attributes: Vec<Attribute<'b>>,
}

/// A constant of a node.
#[derive(Debug, Default)]
pub(super) struct Attribute<'b> {
    pub(super) name: &'b [u8],
    pub(super) float: Option<f32>,
    pub(super) whole: Option<u64>,
    pub(super) tensor: Option<&'b [u8]>,
}

impl<'b> Graph<'b> {
    /// Reads a ModelProto.
    pub(super) fn read(model: &'b [u8]) -> Result<Self, OnnxError> {
        let mut graph = None;
        let mut zero = Zero::Tared;
        for field in Fields::of(model) {
            match field.ok_or(OnnxError::Damaged)? {
                (7, Value::Bytes(bytes)) => graph = Some(bytes),
                (14, Value::Bytes(property)) => zero = zero_of(property)?.unwrap_or(zero),
                _ => {}
            }
        }
        let mut read =
            Self { zero, nodes: vec![], tensors: BTreeMap::new(), inputs: vec![], outputs: vec![] };
        read.fill(graph.ok_or(OnnxError::Damaged)?)?;
        Ok(read)
    }

    /// Reads a GraphProto.
    fn fill(&mut self, graph: &'b [u8]) -> Result<(), OnnxError> {
        for field in Fields::of(graph) {
            match field.ok_or(OnnxError::Damaged)? {
                (1, Value::Bytes(bytes)) => self.add(Node::read(bytes)?)?,
                (5, Value::Bytes(bytes)) => self.tensors.extend([Tensor::read(bytes)?]),
                (11, Value::Bytes(bytes)) => self.inputs.push(text_field(bytes, 1)?),
                (12, Value::Bytes(bytes)) => self.outputs.push(text_field(bytes, 1)?),
                _ => {}
            }
        }
        Ok(())
    }

    /// A node, or a tensor that is written as one.
    fn add(&mut self, node: Node<'b>) -> Result<(), OnnxError> {
        match node.attributes.iter().find_map(|attribute| attribute.tensor) {
            Some(tensor) if node.operator == b"Constant" => {
                self.tensors.insert(node.gives, Tensor::read(tensor)?.1);
            }
            _ => self.nodes.push(node),
        }
        Ok(())
    }
}

impl<'b> Node<'b> {
    fn read(message: &'b [u8]) -> Result<Self, OnnxError> {
        let mut node = Self::default();
        for field in Fields::of(message) {
            match field.ok_or(OnnxError::Damaged)? {
                (1, Value::Bytes(name)) => node.takes.push(name),
                (2, Value::Bytes(name)) => node.gives = name,
                (4, Value::Bytes(name)) => node.operator = name,
                (5, Value::Bytes(bytes)) => node.attributes.push(Attribute::read(bytes)?),
                _ => {}
            }
        }
        Ok(node)
    }

    /// A constant's number, or what the standard takes where none is written.
    pub(super) fn float(&self, name: &[u8], otherwise: f32) -> f32 {
        self.attribute(name).and_then(|attribute| attribute.float).unwrap_or(otherwise)
    }

    /// Whether a constant is written and not zero.
    pub(super) fn is_set(&self, name: &[u8]) -> bool {
        self.attribute(name).and_then(|attribute| attribute.whole).is_some_and(|whole| whole != 0)
    }

    fn attribute(&self, name: &[u8]) -> Option<&Attribute<'b>> {
        self.attributes.iter().find(|attribute| attribute.name == name)
    }
}

impl<'b> Attribute<'b> {
    fn read(message: &'b [u8]) -> Result<Self, OnnxError> {
        let mut attribute = Self::default();
        for field in Fields::of(message) {
            match field.ok_or(OnnxError::Damaged)? {
                (1, Value::Bytes(name)) => attribute.name = name,
                (2, Value::Float(number)) => attribute.float = Some(number),
                (3, Value::Number(number)) => attribute.whole = Some(number),
                (5, Value::Bytes(tensor)) => attribute.tensor = Some(tensor),
                _ => {}
            }
        }
        Ok(attribute)
    }
}

/// What a property of the model says about its channels, if it says that.
fn zero_of(property: &[u8]) -> Result<Option<Zero>, OnnxError> {
    if text_field(property, 1)? != CHANNELS_KEY.as_bytes() {
        return Ok(None);
    }
    let written = text_field(property, 2)?;
    let zero = [Zero::Tared, Zero::Raw].into_iter().find(|zero| zero.name().as_bytes() == written);
    zero.map(Some).ok_or(OnnxError::Damaged)
}

/// The bytes of a message's field; none are none.
fn text_field(message: &[u8], number: u64) -> Result<&[u8], OnnxError> {
    let mut text = &[][..];
    for field in Fields::of(message) {
        match field.ok_or(OnnxError::Damaged)? {
            (found, Value::Bytes(bytes)) if found == number => text = bytes,
            _ => {}
        }
    }
    Ok(text)
}
