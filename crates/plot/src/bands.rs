//! Levels of a function and the colours between them.

use super::colour::{ColourMap, Rgb};
use super::scale;

/// Bands of one colour each. Values below the first edge have the first colour, values above the last edge the
/// last one.
#[derive(Clone, Debug, PartialEq)]
pub struct Bands {
    /// One more than colours, increasing.
    pub(super) edges: Vec<f64>,
    /// What is written at the edges.
    pub(super) labels: Vec<String>,
    pub(super) colours: Vec<Rgb>,
}

/// Round distances of even edges.
const STEPS: [f64; 4] = [1.0, 2.0, 2.5, 5.0];
/// Edges of a decade, about equally far apart in ratio.
const DECADE: [f64; 6] = [1.0, 1.5, 2.0, 3.0, 5.0, 7.0];
/// More bands than can be told apart.
const BANDS_MAX: usize = 64;

impl Bands {
    /// About `count` equal bands over a span of values, with round edges. Where the span is none, one around it.
    pub fn sequential(span: Option<[f64; 2]>, count: usize) -> Self {
        let [low, high] = scale::apart(span.filter(drawable).unwrap_or([0.0, 1.0]));
        let step = scale::round_above((high - low) / count.clamp(1, BANDS_MAX) as f64, &STEPS);
        let [first, last] = [(low / step + 1e-9).floor(), (high / step - 1e-9).ceil()];
        let edges: Vec<f64> = (0..=(last - first) as usize).map(|k| (first + k as f64) * step).collect();
        let labels = edges.iter().map(|&edge| scale::label(edge, step)).collect();
        let count = edges.len() - 1;
        let share = |k: usize| k as f64 / (count.max(2) - 1) as f64;
        Self { labels, colours: (0..count).map(|k| ColourMap::Sequential.at(share(k))).collect(), edges }
    }

    /// Bands with edges 1, 1.5, 2, 3, 5, 7, 10, 15, … over a span of positive values: for fields that differ by orders.
    /// Where the span is none, the decade up to 1; at most three decades, the highest.
    pub fn sequential_decades(span: Option<[f64; 2]>) -> Self {
        let [low, high] = span
            .filter(|[low, high]| *low > 0.0 && low <= high && drawable(&[*low, *high]))
            .unwrap_or([0.1, 1.0]);
        let power = scale::power_of_ten(high);
        let all = (-3..=1).flat_map(|decade| DECADE.map(|step| step * power * 10.0_f64.powi(decade)));
        let all: Vec<f64> = all.collect();
        let last = all.iter().position(|&edge| edge >= high * (1.0 - 1e-9)).unwrap_or(all.len() - 1).max(1);
        let first = all.iter().rposition(|&edge| edge <= low * (1.0 + 1e-9)).unwrap_or(0).min(last - 1);
        let edges = all[first..=last].to_vec();
        let labels = edges.iter().map(|&edge| scale::label(edge, edge)).collect();
        let count = edges.len() - 1;
        let share = |k: usize| k as f64 / (count.max(2) - 1) as f64;
        Self { labels, colours: (0..count).map(|k| ColourMap::Sequential.at(share(k))).collect(), edges }
    }

    /// Equal bands with round edges on both sides of zero, about `per_side` on each, up to `largest`.
    pub fn diverging(largest: f64, per_side: usize) -> Self {
        let largest = if largest > 0.0 && drawable(&[0.0, largest]) { largest } else { 1.0 };
        let step = scale::round_above(largest / per_side.clamp(1, BANDS_MAX) as f64, &STEPS);
        let side = (largest / step - 1e-9).ceil() as i32;
        let edges: Vec<f64> = (-side..=side).map(|k| f64::from(k) * step).collect();
        let labels = edges.iter().map(|&edge| scale::label(edge, step)).collect();
        Self { labels, colours: diverging_colours(edges.len() - 1), edges }
    }

    /// Bands on both sides of zero with edges 1, 1.5, 2, 3, 5, 7, 10, 15, … up to `largest` and down over as many
    /// decades: for fields whose peaks would hide the rest. The middle band, around zero, is white.
    pub fn diverging_decades(largest: f64, decades: usize) -> Self {
        let largest = if largest > 0.0 && drawable(&[0.0, largest]) { largest } else { 1.0 };
        let power = scale::power_of_ten(largest);
        let steps = DECADE.len() * decades.clamp(1, BANDS_MAX / (2 * DECADE.len()));
        let downwards = (-1..=steps as i32).map(|decade| power * 10.0_f64.powi(-decade));
        let edges = downwards.flat_map(|power| DECADE.iter().rev().map(move |step| step * power));
        let all: Vec<f64> = edges.collect();
        let first = all.iter().rposition(|&edge| edge >= largest * (1.0 - 1e-9)).unwrap_or(0);
        let side: Vec<f64> = all.into_iter().skip(first).take(steps + 1).collect();
        let minus = side.iter().map(|edge| -edge);
        let edges: Vec<f64> = minus.chain(side.iter().rev().copied()).collect();
        let labels = edges.iter().map(|&edge| scale::label(edge, edge.abs())).collect();
        Self { labels, colours: diverging_colours(edges.len() - 1), edges }
    }

    /// Each inner edge with the colours below and above it, upwards.
    pub(super) fn inner_edges(&self) -> impl Iterator<Item = (usize, f64, [Rgb; 2])> {
        let pairs = self.colours.windows(2).filter_map(|pair| <[Rgb; 2]>::try_from(pair).ok());
        let inner = self.edges.iter().copied().enumerate().skip(1);
        inner.zip(pairs).map(|((index, edge), colours)| (index, edge, colours))
    }
}

fn drawable(span: &[f64; 2]) -> bool {
    span.iter().all(|&end| scale::Scale::Linear.shows(end))
}

fn diverging_colours(count: usize) -> Vec<Rgb> {
    let share = |k: usize| k as f64 / (count.max(2) - 1) as f64;
    (0..count).map(|k| ColourMap::Diverging.at(share(k))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(bands: &Bands) -> String {
        bands.labels.join(" ")
    }

    #[test]
    fn edges_are_round_and_hold_the_span() {
        let bands = Bands::sequential(Some([0.13, 2.2]), 10);
        assert_eq!(labels(&bands), "0 0.25 0.50 0.75 1.00 1.25 1.50 1.75 2.00 2.25");
        let bands = Bands::sequential_decades(Some([0.16, 2.1]));
        assert_eq!(labels(&bands), "0.15 0.2 0.3 0.5 0.7 1 1.5 2 3");
        let bands = Bands::diverging(237.0, 3);
        assert_eq!(labels(&bands), "−300 −200 −100 0 100 200 300");
        let bands = Bands::diverging_decades(2400.0, 1);
        assert_eq!(labels(&bands), "−3000 −2000 −1500 −1000 −700 −500 −300 300 500 700 1000 1500 2000 3000");
        assert_eq!(labels(&Bands::diverging_decades(0.08, 1)).split(' ').nth(13), Some("0.1"));
        assert_eq!(labels(&Bands::diverging_decades(1.7, 1)).split(' ').nth(12), Some("1.5"));
    }

    #[test]
    fn diverging_bands_mirror() {
        for bands in [Bands::diverging(3.0, 4), Bands::diverging_decades(0.7, 1)] {
            let mirrored: Vec<f64> = bands.edges.iter().rev().map(|edge| -edge).collect();
            assert_eq!(bands.edges, mirrored);
            assert_eq!(bands.colours.len() + 1, bands.edges.len());
        }
        assert_eq!(Bands::diverging_decades(0.7, 1).colours[6], ColourMap::Diverging.at(0.5));
    }

    #[test]
    fn degenerate_spans_give_bands() {
        let spans =
            [None, Some([0.0, 0.0]), Some([7.0, 7.0]), Some([f64::NAN, 1.0]), Some([f64::MIN, f64::MAX])];
        for span in spans {
            let bands = Bands::sequential(span, 0);
            assert!(bands.edges.is_sorted_by(|a, b| a < b) && !bands.colours.is_empty(), "{bands:?}");
        }
        for largest in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-200] {
            let decades = Bands::sequential_decades(Some([largest, largest]));
            for bands in [
                Bands::diverging(largest, usize::MAX),
                Bands::diverging_decades(largest, usize::MAX),
                decades,
            ] {
                assert!(bands.edges.is_sorted_by(|a, b| a < b), "{bands:?}");
                assert!((1..200).contains(&bands.colours.len()));
            }
        }
    }
}
