//! What a sheet consists of, for both of its writers.

/// A4, upright.
pub(super) const A4_MM: [f64; 2] = [210.0, 297.0];
/// As wide as A4 and as high as a Letter: it fits both.
pub(super) const A4_AND_LETTER_MM: [f64; 2] = [210.0, 279.0];

/// Something that is drawn; places are on the page, from its upper left corner, y downwards.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Mark {
    Line {
        from_mm: [f64; 2],
        to_mm: [f64; 2],
        width_mm: f64,
    },
    Circle {
        centre_mm: [f64; 2],
        radius_mm: f64,
        width_mm: f64,
    },
    /// The text begins at the place, on its baseline.
    Text {
        at_mm: [f64; 2],
        size_mm: f64,
        text: String,
    },
}

/// To a thousandth, as nobody prints finer; zero has no sign.
pub(super) fn number(mm: f64) -> f64 {
    (1e3 * mm).round() / 1e3 + 0.0
}
