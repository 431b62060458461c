//! Residuals as dots: the larger the residual the larger the dot; a disc reads too much, a ring too little, a square both.

use std::collections::BTreeMap;

use super::drawing::Drawing;
use tactpad::lab::diagnosis::report::Residuals;
use tactpad::numeric::statistics::rms;

/// Radius of the largest dot, as a share of the map's width.
const RADIUS_MAX: f64 = 0.042;
/// So small a dot still shows where a contact was.
const RADIUS_MIN: f64 = 0.004;
/// One residual in so many may be larger than the largest dot.
const LARGEST_ONE_IN: usize = 200;
/// The scale ends no lower: noise alone must not look large.
const LEAST_FULL: f64 = 5.0;

/// Contacts within these parts of a map's width are one dot: the first that makes few enough.
const CELLS: [f64; 5] = [96.0, 64.0, 48.0, 32.0, 24.0];
/// More of the residuals than this are of one sign, or the dot has none.
const ONE_SIGN: f64 = 0.5;

/// Contacts near each other.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Place {
    /// Their middle.
    pub(super) at: [f64; 2],
    /// Their rows.
    pub(super) rows: Vec<usize>,
}

/// The contacts' places on a map of this width, no more than `count` of them if that can be.
pub(super) fn places(places_mm: &[[f64; 2]], width: f64, count: usize) -> Vec<Place> {
    let mut cells = BTreeMap::new();
    for parts in CELLS {
        cells = BTreeMap::<[i64; 2], Vec<usize>>::new();
        for (row, place) in
            places_mm.iter().enumerate().filter(|(_, place)| place.iter().all(|it| it.is_finite()))
        {
            cells.entry(place.map(|mm| (mm / width * parts).round() as i64)).or_default().push(row);
        }
        if cells.len() <= count {
            break;
        }
    }
    let middle = |rows: &[usize], axis: usize| {
        rows.iter().map(|row| places_mm[*row][axis]).sum::<f64>() / rows.len() as f64
    };
    cells.into_values().map(|rows| Place { at: [0, 1].map(|axis| middle(&rows, axis)), rows }).collect()
}

/// The residuals of contacts near each other: their root mean square, with a sign if they have one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Dot {
    /// Where.
    pub(super) at: [f64; 2],
    /// In multiples of the noise.
    pub(super) level: f64,
    /// The sum of the residuals over the sum of their sizes.
    pub(super) sign: f64,
}

impl Dot {
    /// Of levels at a place; none where there are none.
    pub(super) fn of(at: [f64; 2], levels: impl Iterator<Item = f64>) -> Option<Self> {
        let levels: Vec<f64> = levels.filter(|level| level.is_finite()).collect();
        let sum: f64 = levels.iter().sum();
        let sizes: f64 = levels.iter().map(|level| level.abs()).sum();
        let sign = if sizes > 0.0 { sum / sizes } else { 0.0 };
        (!levels.is_empty()).then(|| Self { at, level: rms(levels), sign })
    }
}

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

    /// Draws dots, the largest first, so that none hides another.
    pub(super) fn draw(self, drawing: &mut Drawing, mut dots: Vec<Dot>, width: f64) {
        dots.sort_by(|one, other| other.level.total_cmp(&one.level));
        for Dot { at, level, sign } in dots {
            let radius = self.radius(level, width);
            match sign {
                it if it > ONE_SIGN => drawing.circle("more", at, radius),
                it if it < -ONE_SIGN => drawing.circle("less", at, radius),
                _ => {
                    // As large as a disc of the same radius.
                    let half = 0.5 * radius * std::f64::consts::PI.sqrt();
                    drawing.rectangle("both", at.map(|mm| mm - half), at.map(|mm| mm + half));
                }
            }
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
    fn contacts_of_one_place_are_one_dot() {
        let all: Vec<[f64; 2]> =
            (0..1000).map(|at| [f64::from(at % 10) * 6.0, 0.001 * f64::from(at / 10)]).collect();
        let found = places(&all, 60.0, 500);
        assert_eq!((found.len(), found[0].rows.len()), (10, 100));
        let spread: Vec<[f64; 2]> =
            (0..10_000).map(|at| [f64::from(at % 100), f64::from(at / 100)]).collect();
        assert!(places(&spread, 100.0, 700).len() <= 700);
        assert!(places(&[[f64::NAN, 0.0]], 1.0, 5).is_empty());
    }

    #[test]
    fn dots_of_both_signs_have_none() {
        let of = |levels: [f64; 2]| Dot::of([0.0; 2], levels.into_iter()).map(|dot| dot.sign);
        assert_eq!(
            [of([3.0, -3.0]), of([1.0, 2.0]), of([-1.0, f64::NAN])],
            [Some(0.0), Some(1.0), Some(-1.0)]
        );
        assert_eq!(of([f64::NAN; 2]), None);
    }

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
