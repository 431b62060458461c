//! A graph as a chain of steps, each of which takes what the one before gives.

use super::error::OnnxError;
use super::graph::{Graph, Node};
use super::tensor::{FLOAT, Tensor};
use crate::network::Layer;
use crate::network::transposed::transposed;

/// Operation on a row of numbers.
#[derive(Debug)]
pub(super) enum RowOperation {
    Subtract(Vec<f32>),
    Divide(Vec<f32>),
    Multiply(Vec<f32>),
    Add(Vec<f32>),
    Connect(Layer),
    Rectify,
}

impl RowOperation {
    /// Whether it changes each number by itself.
    pub(super) const fn is_scaler(&self) -> bool {
        !matches!(self, Self::Connect(_) | Self::Rectify)
    }
}

/// The steps from the graph's input to its output.
pub(super) fn steps(graph: &Graph<'_>) -> Result<Vec<RowOperation>, OnnxError> {
    // Older files list their tensors among the inputs.
    let mut inputs = graph.inputs.iter().filter(|name| !graph.tensors.contains_key(**name));
    let (Some(mut last), None) = (inputs.next().copied(), inputs.next()) else {
        return Err(OnnxError::Shape("it has not one input".into()));
    };
    let mut steps = Vec::new();
    for node in &graph.nodes {
        if !is_nothing(node) {
            steps.push(step(node, last, graph)?);
        } else if node.takes != [last] {
            return Err(unsupported(node, "takes something else than the step before it gives"));
        }
        last = node.gives;
    }
    if graph.outputs == [last] {
        Ok(steps)
    } else {
        Err(OnnxError::Shape("its last step is not its one output".into()))
    }
}

/// Whether rows of floats go through unchanged.
fn is_nothing(node: &Node<'_>) -> bool {
    match node.operator {
        b"Identity" => true,
        b"Cast" => node.whole(b"to", 0) == FLOAT,
        b"Flatten" => node.whole(b"axis", 1) == 1,
        _ => false,
    }
}

fn step(node: &Node<'_>, last: &[u8], graph: &Graph<'_>) -> Result<RowOperation, OnnxError> {
    let wrong = |why| unsupported(node, why);
    let others: Vec<&[u8]> = node.takes.iter().copied().filter(|name| *name != last).collect();
    let is_symmetric = matches!(node.operator, b"Add" | b"Mul");
    if others.len() + 1 != node.takes.len() || !(is_symmetric || node.takes.first() == Some(&last)) {
        return Err(wrong("takes something else than the step before it gives"));
    }
    let tensors: Option<Vec<&Tensor>> = others.iter().map(|name| graph.tensors.get(*name)).collect();
    let tensors = tensors.ok_or_else(|| wrong("takes what is no constant"))?;
    let row = || match tensors[..] {
        [tensor] => tensor.row().map(<[f32]>::to_vec).ok_or_else(|| wrong("takes something else than a row")),
        _ => Err(wrong("takes not one tensor")),
    };
    match node.operator {
        b"Sub" => row().map(RowOperation::Subtract),
        b"Div" => row().map(RowOperation::Divide),
        b"Mul" => row().map(RowOperation::Multiply),
        b"Add" => row().map(RowOperation::Add),
        b"Relu" if tensors.is_empty() => Ok(RowOperation::Rectify),
        b"Gemm" | b"MatMul" => layer(node, &tensors).map(RowOperation::Connect),
        _ => Err(wrong("is no step of a perceptron")),
    }
}

fn layer(node: &Node<'_>, tensors: &[&Tensor]) -> Result<Layer, OnnxError> {
    let wrong = |why| unsupported(node, why);
    if node.whole(b"transA", 0) != 0 || node.float(b"alpha", 1.0) != 1.0 || node.float(b"beta", 1.0) != 1.0 {
        return Err(wrong("is scaled, or turns what it takes"));
    }
    let (Some(weights), None) = (tensors.first(), tensors.get(2)) else {
        return Err(wrong("takes not weights and biases"));
    };
    let [rows, columns] = weights.matrix().ok_or_else(|| wrong("has weights that are no matrix"))?;
    let is_turned = node.whole(b"transB", 0) != 0;
    let outputs = if is_turned { rows } else { columns };
    let biases = match tensors.get(1) {
        Some(biases) => biases.row().ok_or_else(|| wrong("has biases that are no row"))?.to_vec(),
        None => vec![0.0; outputs],
    };
    if weights.numbers.is_empty() || biases.len() != outputs {
        return Err(wrong("has weights and biases that do not fit together"));
    }
    let weights = if is_turned { transposed(&weights.numbers, columns) } else { weights.numbers.clone() };
    Ok(Layer { weights, biases })
}

fn unsupported(node: &Node<'_>, why: &str) -> OnnxError {
    let operator: String = String::from_utf8_lossy(node.operator).chars().take(40).collect();
    // A name may hold what a terminal obeys.
    OnnxError::Unsupported(format!("an operator {} {why}", operator.escape_debug()))
}
