//! Forwards and backwards through a network, a batch of examples at once (backpropagation).
//!
//! With the activations A of a layer's input, one example in each row, its weights W and biases b, and the loss
//! L = Σ (output − target)² over the batch:
//!
//! ```text
//! Z = A W + 1 bᵀ        A′ = max(Z, 0), or Z after the last layer
//! Δ = ∂L/∂Z = 2 (Z − target) after the last layer
//! ∂L/∂W = Aᵀ Δ        ∂L/∂b = Δᵀ 1        ∂L/∂Z of the layer below = (Δ Wᵀ) ⊙ [A > 0]
//! ```
//!
//! Source: D. E. Rumelhart, G. E. Hinton, R. J. Williams, Nature 323 (1986) 533.

use super::parameters::{LayerRange, Shape};
use super::product::{padded, product, transposed_product};
use crate::network::transposed::transposed;
use crate::network::{Example, OUTPUTS};
use crate::quantity::CHANNELS;

/// Examples as the trainer holds them: standardised, row by row, padded to whole tiles.
#[derive(Clone, Debug)]
pub(super) struct Batch {
    /// Number of examples, without padding.
    pub(super) count: usize,
    /// Of a row of inputs, and of one of targets.
    widths: [usize; 2],
    pub(super) inputs: Vec<f32>,
    pub(super) targets: Vec<f32>,
}

impl Batch {
    pub(super) fn empty(shape: &Shape) -> Self {
        let ends =
            [shape.layers.first().map(|place| place.inputs), shape.layers.last().map(|place| place.outputs)];
        let widths = ends.map(Option::unwrap_or_default);
        Self { count: 0, widths, inputs: Vec::new(), targets: Vec::new() }
    }

    /// Takes these examples in place of the previous ones.
    pub(super) fn fill(&mut self, examples: &[&Example]) {
        self.count = examples.len();
        for (matrix, width) in [&mut self.inputs, &mut self.targets].into_iter().zip(self.widths) {
            matrix.clear();
            matrix.resize(padded(self.count) * width, 0.0);
        }
        let [inputs, targets] = self.widths;
        let rows = self.inputs.chunks_exact_mut(inputs).zip(self.targets.chunks_exact_mut(targets));
        for ((inputs, targets), example) in rows.zip(examples) {
            inputs[..CHANNELS].copy_from_slice(&example.uv);
            targets[..OUTPUTS].copy_from_slice(&example.contact);
        }
    }
}

/// A forward and backward pass with one batch.
#[derive(Clone, Debug)]
pub(super) struct Pass {
    shape: Shape,
    /// Activations A of the input and of each layer; on the way back Δ takes their place.
    values: Vec<Vec<f32>>,
}

impl Pass {
    pub(super) fn new(shape: &Shape) -> Self {
        Self { shape: shape.clone(), values: vec![Vec::new(); shape.layers.len() + 1] }
    }

    /// Sends a batch through, and gives the sum of the squared errors over all outputs.
    pub(super) fn forward(&mut self, parameters: &[f32], batch: &Batch) -> f64 {
        let rows = padded(batch.count);
        self.values[0].clone_from(&batch.inputs);
        for (index, place) in self.shape.layers.iter().enumerate() {
            let [input, output] = sides(&mut self.values, index);
            // Z = A W, then the biases and ReLU.
            output.resize(rows * place.outputs, 0.0);
            product(output, input, &parameters[place.weights.clone()], [place.inputs, place.outputs]);
            let is_last = index + 1 == self.shape.layers.len();
            finish(output, &parameters[place.biases.clone()], is_last);
        }
        self.compare(batch)
    }

    /// Puts the errors, output − target, in place of the outputs; padded rows have none. Gives the sum of their squares.
    fn compare(&mut self, batch: &Batch) -> f64 {
        let Some((outputs, place)) = self.values.last_mut().zip(self.shape.layers.last()) else { return 0.0 };
        let (real, padding) = outputs.split_at_mut(batch.count * place.outputs);
        real.iter_mut().zip(&batch.targets).for_each(|(value, target)| *value -= target);
        padding.fill(0.0);
        real.chunks(place.outputs)
            .map(|row| f64::from(row.iter().map(|error| error * error).sum::<f32>()))
            .sum()
    }

    /// The errors that [`Self::forward`] has left, example by example.
    pub(super) fn errors(&self, batch: &Batch) -> impl Iterator<Item = &[f32]> {
        let width = self.shape.layers.last().map_or(1, |place| place.outputs);
        self.values.last().into_iter().flat_map(move |errors| errors.chunks(width)).take(batch.count)
    }

    /// The gradient of the sum of the batch's squared errors, after [`Self::forward`].
    pub(super) fn backward(&mut self, parameters: &[f32], gradient: &mut [f32]) {
        // Δ = 2 (output − target).
        self.values.last_mut().into_iter().flatten().for_each(|error| *error *= 2.0);
        for (index, place) in self.shape.layers.iter().enumerate().rev() {
            let [input, delta] = sides(&mut self.values, index);
            // ∂L/∂W = Aᵀ Δ, ∂L/∂b = Δᵀ 1.
            let weights = &mut gradient[place.weights.clone()];
            transposed_product(weights, input, delta, [place.inputs, place.outputs]);
            sum_rows(&mut gradient[place.biases.clone()], delta);
            if index > 0 {
                propagate_back(input, delta, &parameters[place.weights.clone()], place);
            }
        }
    }
}

/// Input and output of a layer.
fn sides(values: &mut [Vec<f32>], index: usize) -> [&mut Vec<f32>; 2] {
    let (inputs, outputs) = values.split_at_mut(index + 1);
    [&mut inputs[index], &mut outputs[0]]
}

/// Adds the biases; then ReLU, but for the last layer.
fn finish(values: &mut [f32], biases: &[f32], is_last: bool) {
    let least = if is_last { f32::NEG_INFINITY } else { 0.0 };
    for row in values.chunks_exact_mut(biases.len()) {
        row.iter_mut().zip(biases).for_each(|(value, bias)| *value = (*value + bias).max(least));
    }
}

fn sum_rows(into: &mut [f32], rows: &[f32]) {
    into.fill(0.0);
    for row in rows.chunks_exact(into.len()) {
        into.iter_mut().zip(row).for_each(|(sum, value)| *sum += value);
    }
}

/// Replaces the input's activations A by (Δ Wᵀ) ⊙ [A > 0]: a neuron that ReLU silenced passes no gradient.
fn propagate_back(input: &mut [f32], delta: &[f32], weights: &[f32], place: &LayerRange) {
    let mut slopes = vec![0.0; input.len()];
    product(&mut slopes, delta, &transposed(weights, place.outputs), [place.outputs, place.inputs]);
    for (value, slope) in input.iter_mut().zip(slopes) {
        *value = if *value > 0.0 { slope } else { 0.0 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{Network, Zero};
    use tactpad_numeric::random::SplitMix64;

    #[test]
    fn gradients_are_the_differences_of_the_loss() {
        let network = Network::untrained(&[13, 24], Zero::Tared, &[], 5);
        let shape = Shape::of(&network);
        let mut random = SplitMix64::new(8);
        let mut draw = || Example {
            uv: std::array::from_fn(|_| random.uniform()),
            contact: std::array::from_fn(|_| random.uniform()),
        };
        let examples: Vec<Example> = (0..11).map(|_| draw()).collect();
        let mut batch = Batch::empty(&shape);
        batch.fill(&examples.iter().collect::<Vec<_>>());
        let (mut parameters, mut pass) = (shape.pack(&network), Pass::new(&shape));
        let mut gradient = vec![0.0; parameters.len()];
        pass.forward(&parameters, &batch);
        pass.backward(&parameters, &mut gradient);
        let mut seen = 0;
        for index in (0..parameters.len()).step_by(3) {
            let here = parameters[index];
            let mut loss = |at: f32| {
                parameters[index] = at;
                pass.forward(&parameters, &batch)
            };
            let step = 5e-4;
            let difference = (loss(here + step) - loss(here - step)) / f64::from(2.0 * step);
            parameters[index] = here;
            assert!((difference - f64::from(gradient[index])).abs() < 0.02, "{index}: {difference}");
            seen += usize::from(gradient[index].abs() > 0.1);
        }
        assert!(seen > 40, "{seen} gradients say something");
        let padded_weight = shape.layers[0].weights.end - 1;
        assert_eq!((parameters[padded_weight], gradient[padded_weight]), (0.0, 0.0));
    }
}
