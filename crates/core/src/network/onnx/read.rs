//! The way in: from a chain of steps to a network.

use std::array::from_fn;
use std::iter::Peekable;
use std::vec::IntoIter;

use super::chain::{RowOperation, steps};
use super::error::OnnxError;
use super::graph::Graph;
use crate::network::{LAYERS_MAX, Layer, Network, OUTPUTS, Scaler, WIDTH_MAX};
use crate::quantity::CHANNELS;

/// Steps that are not used yet.
type UnusedSteps = Peekable<IntoIter<RowOperation>>;

pub(super) fn network(bytes: &[u8]) -> Result<Network, OnnxError> {
    let graph = Graph::read(bytes)?;
    let mut rest = steps(&graph)?.into_iter().peekable();
    let input = Scaling::of(&mut rest)?.before()?;
    let layers = layers(&mut rest)?;
    let output = Scaling::of(&mut rest)?.after()?;
    if rest.next().is_some() {
        return Err(OnnxError::Unsupported("its steps come in another order".into()));
    }
    Ok(Network { zero: graph.zero, input, layers, output })
}

/// Scalers in a row, each number x to factor · x + shift. In doubles, so that each pair of floats that a
/// scaler is written with comes out as it went in.
struct Scaling<const N: usize> {
    factor: [f64; N],
    shift: [f64; N],
}

impl<const N: usize> Scaling<N> {
    /// Takes the scalers that come next, in whatever order; none change nothing.
    fn of(rest: &mut UnusedSteps) -> Result<Self, OnnxError> {
        let mut scaling = Self { factor: [1.0; N], shift: [0.0; N] };
        while let Some(step) = rest.next_if(RowOperation::is_scaler) {
            match &step {
                RowOperation::Subtract(row) => {
                    scaling.apply(row, |number, by| *number -= by, ScalerParts::Shift)?;
                }
                RowOperation::Add(row) => {
                    scaling.apply(row, |number, by| *number += by, ScalerParts::Shift)?;
                }
                RowOperation::Divide(row) => {
                    scaling.apply(row, |number, by| *number /= by, ScalerParts::Both)?;
                }
                RowOperation::Multiply(row) => {
                    scaling.apply(row, |number, by| *number *= by, ScalerParts::Both)?;
                }
                RowOperation::Connect(_) | RowOperation::Rectify => {}
            }
        }
        Ok(scaling)
    }

    fn apply(&mut self, row: &[f32], change: fn(&mut f64, f64), part: ScalerParts) -> Result<(), OnnxError> {
        let row: [f64; N] = match *row {
            [one] => [one.into(); N],
            _ => <[f32; N]>::try_from(row)
                .map_err(|_| OnnxError::Shape(format!("it scales {} numbers, not {N}", row.len())))?
                .map(f64::from),
        };
        let factors = if part == ScalerParts::Both { &mut self.factor[..] } else { &mut [] };
        factors.iter_mut().zip(row).for_each(|(factor, by)| change(factor, by));
        self.shift.iter_mut().zip(row).for_each(|(shift, by)| change(shift, by));
        Ok(())
    }

    /// As a scaler of what goes in: (number − mean) / deviation.
    fn before(&self) -> Result<Scaler<N>, OnnxError> {
        scaler(from_fn(|k| -self.shift[k] / self.factor[k]), self.factor.map(f64::recip))
    }

    /// As a scaler of what comes out: number · deviation + mean.
    fn after(&self) -> Result<Scaler<N>, OnnxError> {
        scaler(self.shift, self.factor)
    }
}

/// Parts of a scaler that change numbers: the shift alone, or shift and factor.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ScalerParts {
    Shift,
    Both,
}

fn scaler<const N: usize>(mean: [f64; N], deviation: [f64; N]) -> Result<Scaler<N>, OnnxError> {
    let [mean, deviation] = [mean, deviation].map(|row| row.map(|number| number as f32));
    // A mean of −0 would be written so and be another file.
    let mean = mean.map(|mean| mean + 0.0);
    let is_sound = mean.iter().all(|mean| mean.is_finite()) && deviation.iter().all(|it| it.is_normal());
    if is_sound { Ok(Scaler { mean, deviation }) } else { Err(OnnxError::NotANumber) }
}

fn added(step: &RowOperation) -> Option<&Vec<f32>> {
    if let RowOperation::Add(row) = step { Some(row) } else { None }
}

fn layers(rest: &mut UnusedSteps) -> Result<Vec<Layer>, OnnxError> {
    let mut layers = Vec::new();
    let mut width = CHANNELS;
    while let Some(RowOperation::Connect(layer)) =
        rest.next_if(|step| matches!(step, RowOperation::Connect(_)))
    {
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
        if rest.next_if(|step| matches!(step, RowOperation::Rectify)).is_none() {
            break;
        }
        if !matches!(rest.peek(), Some(RowOperation::Connect(_))) {
            return Err(OnnxError::Unsupported("its last layer is rectified".into()));
        }
    }
    if width == OUTPUTS && !layers.is_empty() {
        return Ok(layers);
    }
    Err(OnnxError::Shape(format!("it gives {width} numbers after {} layers", layers.len())))
}

/// The layer with the biases that an Add behind it holds, if it has none of its own.
fn biased(layer: Layer, rest: &mut UnusedSteps) -> Result<Layer, OnnxError> {
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
