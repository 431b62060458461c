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
/// The zero is the mean over so many blocks before a touch, but for the last ones: in them the touch begins, too weakly to be seen.
const ZERO_BLOCKS: usize = 25;
const ONSET_BLOCKS: usize = 10;
/// A block counts as touched if an input is off its zero by more than so many deviations of its noise.
const DEVIATIONS: f64 = 5.0;
/// After a touch the zero is off by this part of it at most, by creep and hysteresis, …
const LAG: f64 = 0.1;
/// … but whatever is read for so long is the zero.
const FORGOTTEN_BLOCKS: usize = 250;
/// A touch is read without the first and the last of so many parts of it, in which it is put on and lifted, …
const EDGES: usize = 5;
/// … and where it is at least this part of its largest.
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
    /// The last touch, until the zero after it is known.
    last: Option<LastTouch>,
}

/// A touch that has ended.
#[derive(Clone, Copy, Debug)]
struct LastTouch {
    zero: [f64; CHANNELS],
    uv: [f64; CHANNELS],
    /// Blocks since then that were no zero.
    blocks: usize,
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
            last: None,
        }
    }

    /// The same before a touch whose zero is another one.
    #[must_use]
    pub fn anew(self) -> Self {
        let none = || Vec::new();
        Self {
            block: none(),
            block_end_s: None,
            zeros: none(),
            touched: none(),
            lifted: 0,
            last: None,
            ..self
        }
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
        self.zeros.len() >= ZERO_BLOCKS + ONSET_BLOCKS
    }

    fn look(&mut self, block: [f64; CHANNELS]) -> Touch {
        if !self.is_ready() {
            if self.is_zero(&block) {
                self.zeros.push(block);
            }
            return Touch::None;
        }
        let zero = mean_vector(self.zeros.iter().take(ZERO_BLOCKS));
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
        let touched = touched.get(held / EDGES..held - held / EDGES).unwrap_or_default();
        self.lifted = 0;
        let uv = self.plateau(touched, &zero);
        // What rests now is the zero of the next one.
        self.zeros.clear();
        self.last = Some(LastTouch { zero, uv, blocks: 0 });
        if (held as f64) * BLOCK_S < HOLD_S { Touch::TooShort } else { Touch::Ended { uv } }
    }

    /// Whether a block may be of the untouched pad: after a touch it is near the zero before, or somebody presses again already.
    fn is_zero(&mut self, block: &[f64; CHANNELS]) -> bool {
        let Some(last) = &mut self.last else { return true };
        let is_near = |k: usize| {
            let may_be_off_uv = self.least_uv[k] + LAG * last.uv[k].abs();
            !self.is_told[k] || (block[k] - last.zero[k]).abs() <= may_be_off_uv
        };
        if (0..CHANNELS).all(is_near) {
            return true;
        }
        last.blocks += 1;
        if last.blocks >= FORGOTTEN_BLOCKS {
            self.last = None;
        }
        false
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

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_numeric::random::SplitMix64;

    const RATE_HZ: f64 = 500.0;

    /// A course of so many seconds each at a part of a press.
    fn readings(course: &[(f64, f64)]) -> Vec<Touch> {
        let mut random = SplitMix64::new(7);
        let mut finder = TouchFinder::new([5.0; CHANNELS], RATE_HZ, [true; CHANNELS], 60.0);
        let mut ended = Vec::new();
        let mut samples = 0;
        for (seconds, part) in course {
            for _ in 0..(seconds * RATE_HZ) as usize {
                let press = std::array::from_fn(|k| [0.0, -900.0, 3_000.0][k % 3] * part);
                let uv = std::array::from_fn(|k: usize| {
                    let press: [f64; CHANNELS] = press;
                    100.0 * k as f64 + press[k] + 5.0 * f64::from(random.normal())
                });
                let sample =
                    BenchSample { t_s: f64::from(samples) / RATE_HZ, uv, is_out_of_range: [false; CHANNELS] };
                samples += 1;
                let seen = finder.push(&sample);
                ended.extend(seen.filter(|it| matches!(it, Touch::Ended { .. } | Touch::TooShort)));
            }
        }
        ended
    }

    #[test]
    fn a_touch_is_read_against_the_zero_before_it() {
        let touches = readings(&[(1.0, 0.0), (1.5, 1.0), (1.0, 0.0), (0.3, 1.0), (1.0, 0.0)]);
        let [Touch::Ended { uv }, Touch::TooShort] = touches[..] else { panic!("{touches:?}") };
        for (k, uv) in uv.iter().enumerate() {
            assert!((uv - [0.0, -900.0, 3_000.0][k % 3]).abs() < 5.0, "{uv:?}");
        }
    }

    #[test]
    fn the_onset_of_a_touch_is_no_zero() {
        let rise: Vec<(f64, f64)> = (0..10).map(|step| (0.02, 0.002 * f64::from(step))).collect();
        let course = [&[(1.0, 0.0)], &rise[..], &[(1.5, 0.04), (1.0, 0.0)]].concat();
        let touches = readings(&course);
        let [Touch::Ended { uv }] = touches[..] else { panic!("{touches:?}") };
        assert!((uv[2] - 120.0).abs() < 1.5, "{uv:?}");
    }

    #[test]
    fn a_press_that_comes_at_once_is_no_zero() {
        // Pressed again after 0.3 s, which is too soon for a zero; lifted and pressed once more.
        let touches =
            readings(&[(1.0, 0.0), (1.5, 1.0), (0.3, 0.0), (1.5, 1.0), (1.0, 0.0), (1.5, 0.5), (1.0, 0.0)]);
        let uv = |touch: &Touch| if let Touch::Ended { uv } = touch { uv[2] } else { f64::NAN };
        let z: Vec<f64> = touches.iter().map(uv).collect();
        assert!(z.len() == 2 && (z[0] - 3_000.0).abs() < 5.0 && (z[1] - 1_500.0).abs() < 5.0, "{z:?}");
    }
}
