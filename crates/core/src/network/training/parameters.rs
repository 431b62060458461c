//! A network's weights and biases as the trainer holds them: one row of numbers, every layer padded to whole tiles.
//!
//! What is padded is zero and stays zero: nothing flows through it, so its gradient is zero.

use std::ops::Range;

use super::product::padded;
use crate::network::{Layer, Network};

/// Where each layer's numbers are.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    pub(super) layers: Vec<LayerRange>,
}

/// A layer's place among the parameters.
#[derive(Clone, Debug)]
pub(super) struct LayerRange {
    /// Padded.
    pub(super) inputs: usize,
    /// Padded.
    pub(super) outputs: usize,
    pub(super) weights: Range<usize>,
    pub(super) biases: Range<usize>,
}

impl Shape {
    pub(super) fn of(network: &Network) -> Self {
        let mut end = 0;
        let place = |layer: &Layer| {
            let (inputs, outputs) = (padded(layer.inputs()), padded(layer.biases.len()));
            let weights = end..end + inputs * outputs;
            let biases = weights.end..weights.end + outputs;
            end = biases.end;
            LayerRange { inputs, outputs, weights, biases }
        };
        Self { layers: network.layers.iter().map(place).collect() }
    }

    fn parameters(&self) -> usize {
        self.layers.last().map_or(0, |place| place.biases.end)
    }

    /// All parameters of a network of this shape.
    pub(super) fn pack(&self, network: &Network) -> Vec<f32> {
        let mut packed = vec![0.0; self.parameters()];
        for (place, layer) in self.layers.iter().zip(&network.layers) {
            let width = layer.biases.len();
            let rows = packed[place.weights.clone()].chunks_exact_mut(place.outputs);
            rows.zip(layer.weights.chunks_exact(width))
                .for_each(|(row, from)| row[..width].copy_from_slice(from));
            packed[place.biases.clone()][..width].copy_from_slice(&layer.biases);
        }
        packed
    }

    /// `network` with these parameters.
    pub(super) fn unpack(&self, packed: &[f32], network: &Network) -> Network {
        let layers = self.layers.iter().zip(&network.layers).map(|(place, layer)| {
            let width = layer.biases.len();
            let rows = packed[place.weights.clone()].chunks_exact(place.outputs).take(layer.inputs());
            Layer {
                weights: rows.flat_map(|row| &row[..width]).copied().collect(),
                biases: packed[place.biases.clone()][..width].to_vec(),
            }
        });
        Network { layers: layers.collect(), ..network.clone() }
    }
}
