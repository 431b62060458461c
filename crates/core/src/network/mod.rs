//! Multilayer perceptrons from nine channels to a contact: how they decode, how they learn, how they are kept.
//!
//! A [`Network`] is what the paper calls the SCDF's decoder: standardised channels, fully connected layers with ReLU
//! between them, a linear output, and the contact out of standardised numbers. [`training`] fits one to examples,
//! [`onnx`] writes and reads it. Which examples, and in which stages, is the business of `scdf`.
//!
//! Source: Wu et al., *Sensors* 2026, 26(4), 1378, section 2.5.

#[cfg(feature = "foreign-onnx")]
pub mod foreign;
pub mod onnx;
#[cfg(feature = "lab")]
pub mod training;
mod transposed;

use crate::quantity::{CHANNELS, Contact};
use tactpad_numeric::random::SplitMix64;

/// Numbers of a contact: x, y, Fx, Fy, Fz.
pub const OUTPUTS: usize = 5;

/// Most neurons in a layer.
pub const WIDTH_MAX: usize = 512;

/// Most layers with weights.
pub const LAYERS_MAX: usize = 16;

/// Zero of the nine inputs of a network: tared or raw channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Zero {
    /// The untouched pad reads zero: channels minus their zeros.
    Tared,
    /// Channels as the pad has them, offset included.
    Raw,
}

/// Standardisation: (value − mean)/deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scaler<const N: usize> {
    /// Of each value over the examples.
    pub mean: [f32; N],
    /// Of each value over the examples; never zero.
    pub deviation: [f32; N],
}

/// Fully connected neurons.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Layer {
    /// `[inputs × biases]`: from the first input to all neurons, from the second one, and so on.
    pub(crate) weights: Vec<f32>,
    /// One for each neuron.
    pub(crate) biases: Vec<f32>,
}

/// A perceptron with its scalers.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    /// What it takes.
    pub zero: Zero,
    input: Scaler<CHANNELS>,
    /// At least one; each takes what the one before gives, the first one the channels, and the last one gives a contact.
    layers: Vec<Layer>,
    output: Scaler<OUTPUTS>,
}

/// Training example: a contact and the channels that a pad reads for it, µV.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Example {
    /// Channels, microvolts.
    pub uv: [f32; CHANNELS],
    /// The contact as [`numbers`] has it.
    pub contact: [f32; OUTPUTS],
}

/// A contact as a network gives it: x, y in millimetres, Fx, Fy, Fz in newtons.
pub const fn numbers(contact: &Contact) -> [f32; OUTPUTS] {
    [contact.x_mm, contact.y_mm, contact.fx_n, contact.fy_n, contact.fz_n]
}

impl<const N: usize> Scaler<N> {
    /// Mean and deviation of these values. What is the same in all of them is not scaled.
    fn of<'v>(values: impl Iterator<Item = &'v [f32; N]> + Clone) -> Self {
        let count = values.clone().count().max(1) as f64;
        let sum = |of: &dyn Fn(usize, f64) -> f64| -> [f64; N] {
            std::array::from_fn(|k| {
                values.clone().map(|value| of(k, f64::from(value[k]))).sum::<f64>() / count
            })
        };
        // μ = Σ v/n, σ² = Σ (v − μ)²/n.
        let mean = sum(&|_, value| value);
        let square = sum(&|k, value| (value - mean[k]) * (value - mean[k]));
        let deviation = square.map(|square| if square > 0.0 { square.sqrt() as f32 } else { 1.0 });
        Self { mean: mean.map(|mean| mean as f32), deviation }
    }

    fn scaled(&self, values: &[f32; N]) -> [f32; N] {
        std::array::from_fn(|k| (values[k] - self.mean[k]) / self.deviation[k])
    }

    fn unscaled(&self, values: &[f32; N]) -> [f32; N] {
        std::array::from_fn(|k| values[k] * self.deviation[k] + self.mean[k])
    }
}

impl Layer {
    fn inputs(&self) -> usize {
        self.weights.len() / self.biases.len()
    }

    /// Each weight and bias evenly in ±1/√inputs, as PyTorch draws them unless it is told otherwise.
    fn drawn(inputs: usize, outputs: usize, random: &mut SplitMix64) -> Self {
        let limit = 1.0 / (inputs as f32).sqrt();
        let mut draw = |count: usize| (0..count).map(|_| limit * random.uniform()).collect();
        Self { weights: draw(inputs * outputs), biases: draw(outputs) }
    }

    /// Writes z = Wᵀ a + b, the neurons' values without ReLU.
    fn apply(&self, from: &[f32], into: &mut [f32]) {
        // zⱼ = bⱼ + Σᵢ aᵢ wᵢⱼ, one input after the other.
        into.copy_from_slice(&self.biases);
        for (value, weights) in from.iter().zip(self.weights.chunks_exact(self.biases.len())) {
            into.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += value * weight);
        }
    }
}

impl Network {
    /// A network that has learnt nothing, with scalers for these examples and `hidden` neurons in the layers between.
    ///
    /// At most [`LAYERS_MAX`] − 1 hidden layers of 1 to [`WIDTH_MAX`] neurons count; others are cut.
    pub fn untrained(hidden: &[usize], zero: Zero, examples: &[Example], seed: u64) -> Self {
        let mut random = SplitMix64::named(seed, "weights");
        let hidden = hidden.iter().take(LAYERS_MAX - 1).map(|width| (*width).clamp(1, WIDTH_MAX));
        let widths: Vec<usize> = [CHANNELS].into_iter().chain(hidden).chain([OUTPUTS]).collect();
        Self {
            zero,
            input: Scaler::of(examples.iter().map(|example| &example.uv)),
            layers: widths.windows(2).map(|pair| Layer::drawn(pair[0], pair[1], &mut random)).collect(),
            output: Scaler::of(examples.iter().map(|example| &example.contact)),
        }
    }

    /// Neurons of each layer, from the channels to the contact.
    pub fn widths(&self) -> Vec<usize> {
        [CHANNELS].into_iter().chain(self.layers.iter().map(|layer| layer.biases.len())).collect()
    }

    /// Weights and biases.
    pub fn parameters(&self) -> usize {
        self.layers.iter().map(|layer| layer.weights.len() + layer.biases.len()).sum()
    }

    /// The contact for these channels, in microvolts: see [`Self::zero`] for what they are, [`numbers`] for the order.
    ///
    /// It allocates nothing. A channel that is not finite gives numbers that mean nothing, and may not be finite.
    pub fn decode(&self, uv: &[f32; CHANNELS]) -> [f32; OUTPUTS] {
        let [mut here, mut there] = [[0.0; WIDTH_MAX]; 2];
        let [mut from, mut into] = [&mut here, &mut there];
        from[..CHANNELS].copy_from_slice(&self.input.scaled(uv));
        let mut width = CHANNELS;
        for (index, layer) in self.layers.iter().enumerate() {
            let outputs = layer.biases.len();
            layer.apply(&from[..width], &mut into[..outputs]);
            if index + 1 < self.layers.len() {
                into[..outputs].iter_mut().for_each(|value| *value = value.max(0.0));
            }
            std::mem::swap(&mut from, &mut into);
            width = outputs;
        }
        self.output.unscaled(&std::array::from_fn(|k| from[k]))
    }

    /// A contact in the network's own standardised numbers, in which the paper states its errors.
    pub fn standardised(&self, contact: &[f32; OUTPUTS]) -> [f32; OUTPUTS] {
        self.output.scaled(contact)
    }
}
