//! The parts of a model: nodes, and tensors by their names.

use std::collections::BTreeMap;

use super::error::OnnxError;
use super::tensor::Tensor;
use super::wire::{Fields, Value};
use crate::network::{LAYERS_MAX, Zero};

/// The steps of the deepest perceptron, and as many constants that stand as nodes. Each may copy a tensor, so that more
/// would take memory that the file does not justify.
const NODES_MAX: usize = 8 * LAYERS_MAX;

/// Where a file says what it takes; `tared` or `raw`. A file of others, which says nothing, takes tared channels.
pub(super) const CHANNELS_KEY: &str = "tactpad.channels";

/// Graph of an ONNX model, as far as it is read.
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
        for field in Fields::of(model) {
            if let (7, Value::Bytes(bytes)) = field.ok_or(OnnxError::Damaged)? {
                graph = Some(bytes);
            }
        }
        let zero = zero(model)?;
        let mut read =
            Self { zero, nodes: vec![], tensors: BTreeMap::new(), inputs: vec![], outputs: vec![] };
        read.fill(graph.ok_or(OnnxError::Damaged)?)?;
        Ok(read)
    }

    /// Reads a GraphProto.
    fn fill(&mut self, graph: &'b [u8]) -> Result<(), OnnxError> {
        let mut nodes = Vec::new();
        for field in Fields::of(graph) {
            match field.ok_or(OnnxError::Damaged)? {
                (1, Value::Bytes(bytes)) => nodes.push(Node::read(bytes)?),
                (5, Value::Bytes(bytes)) => self.tensors.extend([Tensor::read(bytes)?]),
                (11, Value::Bytes(bytes)) => self.inputs.push(text_field(bytes, 1)?),
                (12, Value::Bytes(bytes)) => self.outputs.push(text_field(bytes, 1)?),
                _ => {}
            }
        }
        if nodes.len() > NODES_MAX {
            return Err(OnnxError::Unsupported(format!("it has more than {NODES_MAX} nodes")));
        }
        // Tensors stand behind the nodes that take them.
        nodes.into_iter().try_for_each(|node| self.add(node))
    }

    /// Takes a node; what it makes of constants alone is a tensor.
    fn add(&mut self, node: Node<'b>) -> Result<(), OnnxError> {
        match self.constant(&node)? {
            Some(tensor) => {
                self.tensors.insert(node.gives, tensor);
            }
            None => self.nodes.push(node),
        }
        Ok(())
    }

    /// The tensor that a node writes out, names anew or turns.
    fn constant(&self, node: &Node<'b>) -> Result<Option<Tensor>, OnnxError> {
        let taken = || node.takes.first().and_then(|name| self.tensors.get(name));
        Ok(match node.operator {
            b"Constant" => match node.attributes.iter().find_map(|attribute| attribute.tensor) {
                Some(tensor) => Some(Tensor::read(tensor)?.1),
                None => {
                    node.attribute(b"value_float").and_then(|attribute| attribute.float).map(Tensor::scalar)
                }
            },
            b"Identity" => taken().cloned(),
            b"Transpose" => taken().and_then(Tensor::transposed),
            _ => None,
        })
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

    /// The same for a whole number.
    pub(super) fn whole(&self, name: &[u8], otherwise: u64) -> u64 {
        self.attribute(name).and_then(|attribute| attribute.whole).unwrap_or(otherwise)
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

/// Zero of the channels that a ModelProto takes; tared channels if it says nothing.
pub(super) fn zero(model: &[u8]) -> Result<Zero, OnnxError> {
    let mut zero = Zero::Tared;
    for field in Fields::of(model) {
        if let (14, Value::Bytes(property)) = field.ok_or(OnnxError::Damaged)? {
            zero = zero_of(property)?.unwrap_or(zero);
        }
    }
    Ok(zero)
}

/// Zero of the channels by a property of the model, if that is such a property.
fn zero_of(property: &[u8]) -> Result<Option<Zero>, OnnxError> {
    if text_field(property, 1)? != CHANNELS_KEY.as_bytes() {
        return Ok(None);
    }
    let written = text_field(property, 2)?;
    let zero = [Zero::Tared, Zero::Raw].into_iter().find(|zero| zero.name().as_bytes() == written);
    zero.map(Some).ok_or(OnnxError::Damaged)
}

/// The bytes of a message's field; none are none.
pub(super) fn text_field(message: &[u8], number: u64) -> Result<&[u8], OnnxError> {
    let mut text = &[][..];
    for field in Fields::of(message) {
        match field.ok_or(OnnxError::Damaged)? {
            (found, Value::Bytes(bytes)) if found == number => text = bytes,
            _ => {}
        }
    }
    Ok(text)
}
