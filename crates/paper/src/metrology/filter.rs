//! The paper's mean filter on microvolts that were already measured; the live one works on counts.
//!
//! Source: *Sensors* 2026, 26, 1378, section 3.1.

use tactpad_core::quantity::CHANNELS;
use tactpad_numeric::statistics::mean_vector;

/// The paper's window W.
pub(super) const WINDOW: usize = 6;

/// The mean of each sample and those before it, [`WINDOW`] at most.
pub(super) fn means<T>(
    samples: &[T],
    uv: impl Fn(&T) -> [f64; CHANNELS],
) -> impl Iterator<Item = [f64; CHANNELS]> {
    (1..=samples.len()).map(move |end| {
        let window = &samples[end.saturating_sub(WINDOW)..end];
        let mut raw_uv = [[0.0; CHANNELS]; WINDOW];
        raw_uv.iter_mut().zip(window).for_each(|(raw_uv, sample)| *raw_uv = uv(sample));
        mean_vector(&raw_uv[..window.len()])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_core::pipeline::signal::filter::MeanFilter;

    #[test]
    fn it_is_the_live_filter() {
        let counts: Vec<i32> = (0..20).map(|k| k * k * 37 % 101 - 50).collect();
        let samples: Vec<_> = counts.iter().map(|&count| [f64::from(count); CHANNELS]).collect();
        let mut live = MeanFilter::new(WINDOW);
        for (mean, count) in means(&samples, |uv| *uv).zip(counts) {
            assert!((mean[4] - live.push(&[count; CHANNELS])[4]).abs() < 1e-12);
        }
    }
}
