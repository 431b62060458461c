//! Residuals as dots: the larger the residual the larger the dot; a disc reads too much, a ring too little.

use super::drawing::Drawing;
use tactpad::lab::diagnosis::report::Residuals;

/// Radius of the largest dot, as a share of the map's width.
const RADIUS_MAX: f64 = 0.042;
/// So small a dot still shows where a contact was.
const RADIUS_MIN: f64 = 0.004;
/// One residual in so many may be larger than the largest dot.
const LARGEST_ONE_IN: usize = 200;
/// The scale ends no lower: noise alone must not look large.
const LEAST_FULL: f64 = 5.0;

/// The scale of the dots: all maps of a page have the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DotScale {
    /// The residual of the largest dot, in multiples of a channel's noise.
    pub(super) full: f64,
}

impl DotScale {
    pub(super) fn of(residuals: &Residuals) -> Self {
        let channels = residuals.nominal.iter().zip(&residuals.noise);
        let mut levels: Vec<f64> = channels
            .flat_map(|(channel, noise)| channel.iter().map(|it| level(*it, *noise).abs()))
            .filter(|level| level.is_finite())
            .collect();
        levels.sort_by(f64::total_cmp);
        let at = levels.len() - levels.len().div_ceil(LARGEST_ONE_IN).min(levels.len());
        Self { full: levels.get(at).copied().unwrap_or(0.0).max(LEAST_FULL) }
    }

    /// Radius of a dot: its area is proportional to the residual.
    pub(super) fn radius(self, level: f64, width: f64) -> f64 {
        let share = (level.abs() / self.full).min(1.0).sqrt();
        width * (RADIUS_MAX * share).max(RADIUS_MIN)
    }

    /// Draws dots at places, the largest first, so that none hides another.
    pub(super) fn draw(self, drawing: &mut Drawing, dots: &[([f64; 2], f64)], width: f64) {
        let mut dots: Vec<_> = dots.iter().filter(|(_, level)| level.is_finite()).collect();
        dots.sort_by(|(_, one), (_, other)| other.abs().total_cmp(&one.abs()));
        for (place, level) in dots {
            let class = if *level < 0.0 { "less" } else { "more" };
            drawing.circle(class, *place, self.radius(*level, width));
        }
    }

    /// Sizes for a legend: the largest, and what is left of it in steps down to the noise.
    pub(super) fn examples(self) -> Vec<f64> {
        let middle = self.full.sqrt();
        if middle > 2.5 { vec![1.0, middle, self.full] } else { vec![1.0, self.full] }
    }
}

/// A residual in multiples of the channel's noise.
pub(super) fn level(residual: f64, noise: f64) -> f64 {
    residual / noise.max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_spares_single_outliers() {
        let channel: Vec<f64> = (0..400).map(|at| if at == 0 { 1e6 } else { f64::from(at % 41) }).collect();
        let residuals =
            Residuals { noise: vec![2.0], nominal: vec![channel.clone()], ..Residuals::default() };
        assert_eq!(DotScale::of(&residuals), DotScale { full: 20.0 });
        assert_eq!(DotScale::of(&Residuals::default()), DotScale { full: LEAST_FULL });
        let scale = DotScale { full: 20.0 };
        assert_eq!(scale.radius(1e9, 1.0), scale.radius(-20.0, 1.0));
        assert!(scale.radius(5.0, 1.0) * 2.0 - scale.radius(20.0, 1.0) < 1e-12, "areas grow with residuals");
    }
}
