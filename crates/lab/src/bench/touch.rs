//! A touch from its begin to its end, in what any of the inputs read: nobody knows yet which channel is which.

use super::samples::BenchSample;
use tactpad_core::quantity::CHANNELS;
use tactpad_numeric::statistics::mean_vector;

/// Samples are looked at in means over this time.
const BLOCK_S: f64 = 0.02;
/// A touch lasts so long at least, …
pub const HOLD_S: f64 = 0.8;
/// … and has ended when nothing was read for so long.
const LIFTED_BLOCKS: usize = 8;
/// The zero is the mean over so much of the time before a touch.
const ZERO_BLOCKS: usize = 25;
/// A block counts as touched if an input is off its zero by more than so many deviations of its noise.
const DEVIATIONS: f64 = 5.0;
/// A touch is read where it is at least this part of its largest.
const PLATEAU: f64 = 0.6;

/// What is going on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Touch {
    /// Nothing touches.
    None,
    /// Something has touched for so long.
    Held {
        /// Seconds.
        held_s: f64,
    },
    /// It was let go; what it read against the zero before it.
    Ended {
        /// One for each input, µV.
        uv: [f64; CHANNELS],
    },
    /// It was let go too early to be of use.
    TooShort,
}

/// Follows touches.
#[derive(Clone, Debug)]
pub struct TouchFinder {
    /// Inputs that count.
    is_told: [bool; CHANNELS],
    least_uv: [f64; CHANNELS],
    block: Vec<[f64; CHANNELS]>,
    block_end_s: Option<f64>,
    zeros: Vec<[f64; CHANNELS]>,
    touched: Vec<[f64; CHANNELS]>,
    lifted: usize,
}

impl TouchFinder {
    /// For inputs with so much noise in a sample, of a pad of so many samples a second; a touch reads `least_uv` at least.
    pub fn new(noise_uv: [f64; CHANNELS], rate_hz: f64, is_told: [bool; CHANNELS], least_uv: f64) -> Self {
        let of_block = (BLOCK_S * rate_hz).max(1.0).sqrt();
        Self {
            is_told,
            least_uv: noise_uv.map(|uv| (DEVIATIONS * uv / of_block).max(least_uv)),
            block: Vec::new(),
            block_end_s: None,
            zeros: Vec::new(),
            touched: Vec::new(),
            lifted: 0,
        }
    }

    /// The same before a touch whose zero is another one.
    #[must_use]
    pub fn anew(self) -> Self {
        let none = || Vec::new();
        Self { block: none(), block_end_s: None, zeros: none(), touched: none(), lifted: 0, ..self }
    }

    /// Whether a touch that reads this much in some input is told from noise in each.
    pub fn feels(&self, uv: f64) -> bool {
        (0..CHANNELS).all(|k| !self.is_told[k] || self.least_uv[k] <= uv)
    }

    /// Takes a sample; tells what is going on whenever a block has ended.
    pub fn push(&mut self, sample: &BenchSample) -> Option<Touch> {
        let end_s = *self.block_end_s.get_or_insert(sample.t_s + BLOCK_S);
        let is_over = sample.t_s >= end_s;
        let block = (is_over && !self.block.is_empty()).then(|| mean_vector(&self.block));
        if is_over {
            self.block.clear();
            self.block_end_s = Some(sample.t_s + BLOCK_S);
        }
        self.block.push(sample.uv);
        block.map(|block| self.look(block))
    }

    /// Whether the zero before the next touch is known.
    pub fn is_ready(&self) -> bool {
        self.zeros.len() >= ZERO_BLOCKS
    }

    fn look(&mut self, block: [f64; CHANNELS]) -> Touch {
        if !self.is_ready() {
            self.zeros.push(block);
            return Touch::None;
        }
        let zero = mean_vector(&self.zeros);
        let is_off = |k: usize| self.is_told[k] && (block[k] - zero[k]).abs() > self.least_uv[k];
        let is_touched = (0..CHANNELS).any(is_off);
        if self.touched.is_empty() && !is_touched {
            self.zeros.remove(0);
            self.zeros.push(block);
            return Touch::None;
        }
        self.lifted = if is_touched { 0 } else { self.lifted + 1 };
        self.touched.push(block);
        if self.lifted < LIFTED_BLOCKS {
            return Touch::Held { held_s: BLOCK_S * (self.touched.len() - self.lifted) as f64 };
        }
        let held = self.touched.len() - self.lifted;
        let touched = std::mem::take(&mut self.touched);
        self.lifted = 0;
        // What rests now is the zero of the next one.
        self.zeros.clear();
        if (held as f64) * BLOCK_S < HOLD_S {
            return Touch::TooShort;
        }
        Touch::Ended { uv: self.plateau(&touched, &zero) }
    }

    /// The mean of what was read where it was firm.
    fn plateau(&self, touched: &[[f64; CHANNELS]], zero: &[f64; CHANNELS]) -> [f64; CHANNELS] {
        let off =
            |block: &[f64; CHANNELS]| -> [f64; CHANNELS] { std::array::from_fn(|k| block[k] - zero[k]) };
        let size = |uv: &[f64; CHANNELS]| -> f64 {
            (0..CHANNELS).filter(|k| self.is_told[*k]).map(|k| uv[k] * uv[k]).sum::<f64>().sqrt()
        };
        let offs: Vec<[f64; CHANNELS]> = touched.iter().map(off).collect();
        let largest = offs.iter().map(size).fold(0.0, f64::max);
        let firm: Vec<[f64; CHANNELS]> =
            offs.into_iter().filter(|uv| size(uv) >= PLATEAU * largest).collect();
        mean_vector(&firm)
    }
}
