//! The way in: from a chain of steps to a network.

use std::iter::Peekable;
use std::vec::IntoIter;

use super::OnnxError;
use super::chain::{Step, steps};
use super::graph::Graph;
use crate::network::{LAYERS_MAX, Layer, Network, OUTPUTS, Scaler, WIDTH_MAX};
use crate::quantity::CHANNELS;

/// Steps that are not used yet.
type Rest = Peekable<IntoIter<Step>>;

pub(super) fn network(bytes: &[u8]) -> Result<Network, OnnxError> {
    let graph = Graph::read(bytes)?;
    let mut rest = steps(&graph)?.into_iter().peekable();
    let input = Scaler {
        mean: row(&mut rest, |step| if let Step::Subtract(row) = step { Some(row) } else { None }, 0.0)?,
        deviation: row(&mut rest, |step| if let Step::Divide(row) = step { Some(row) } else { None }, 1.0)?,
    };
    let layers = layers(&mut rest)?;
    let output = Scaler {
        deviation: row(&mut rest, |step| if let Step::Multiply(row) = step { Some(row) } else { None }, 1.0)?,
        mean: row(&mut rest, added, 0.0)?,
    };
    if rest.next().is_some() {
        return Err(OnnxError::Unsupported("its steps come in another order".into()));
    }
    if input.deviation.iter().chain(&output.deviation).any(|deviation| *deviation == 0.0) {
        return Err(OnnxError::NotANumber);
    }
    Ok(Network { zero: graph.zero, input, layers, output })
}

fn added(step: &Step) -> Option<&Vec<f32>> {
    if let Step::Add(row) = step { Some(row) } else { None }
}

/// The next step's row, if it is the step in question; else a row that changes nothing.
fn row<const N: usize>(
    rest: &mut Rest,
    of: impl Fn(&Step) -> Option<&Vec<f32>>,
    otherwise: f32,
) -> Result<[f32; N], OnnxError> {
    let Some(found) = rest.peek().and_then(of) else { return Ok([otherwise; N]) };
    let row = found.as_slice().try_into();
    let row = row.map_err(|_| OnnxError::Shape(format!("it scales {} numbers, not {N}", found.len())))?;
    rest.next();
    Ok(row)
}

fn layers(rest: &mut Rest) -> Result<Vec<Layer>, OnnxError> {
    let mut layers = Vec::new();
    let mut width = CHANNELS;
    while let Some(Step::Connect(layer)) = rest.next_if(|step| matches!(step, Step::Connect(_))) {
        let layer = biased(layer, rest)?;
        if layer.inputs() != width {
            return Err(OnnxError::Shape(format!("a layer takes {} numbers of {width}", layer.inputs())));
        }
        width = layer.biases.len();
        layers.push(layer);
        if width > WIDTH_MAX || layers.len() > LAYERS_MAX {
            let most = format!("it has more than {LAYERS_MAX} layers or {WIDTH_MAX} neurons in one");
            return Err(OnnxError::Unsupported(most));
        }
        if rest.next_if(|step| matches!(step, Step::Rectify)).is_none() {
            break;
        }
        if !matches!(rest.peek(), Some(Step::Connect(_))) {
            return Err(OnnxError::Unsupported("its last layer is rectified".into()));
        }
    }
    if width == OUTPUTS && !layers.is_empty() {
        return Ok(layers);
    }
    Err(OnnxError::Shape(format!("it gives {width} numbers after {} layers", layers.len())))
}

/// The layer with the biases that an Add behind it holds, if it has none of its own.
fn biased(layer: Layer, rest: &mut Rest) -> Result<Layer, OnnxError> {
    let Some(row) = rest.peek().and_then(added).filter(|_| layer.biases.iter().all(|bias| *bias == 0.0))
    else {
        return Ok(layer);
    };
    if row.len() != layer.biases.len() {
        return Err(OnnxError::Shape(format!("it adds {} numbers to {}", row.len(), layer.biases.len())));
    }
    let biased = Layer { biases: row.clone(), ..layer };
    rest.next();
    Ok(biased)
}
