//! Words and numbers of a diagnosis.

use tactpad::lab::diagnosis::report::{Estimate, Gain, Verdict};

/// A share in whole per cent, `less than 1 %` where that would be none.
pub(super) fn percent(share: f64) -> String {
    if share < 0.005 { "less than 1 %".to_owned() } else { format!("{:.0} %", 100.0 * share) }
}

/// How parameters' names end, and the unit that people read.
const UNITS: [(&str, &str); 11] = [
    ("uv_per_c", "µV/°C"),
    ("uv_per_h", "µV/h"),
    ("per_c", "/°C"),
    ("percent_fs", "% of full scale"),
    ("mm", "mm"),
    ("deg", "°"),
    ("uv", "µV"),
    ("us", "µs"),
    ("ms", "ms"),
    ("hz", "Hz"),
    ("n", "N"),
];
/// Digits behind the point at most.
const DECIMALS_MAX: i32 = 9;

/// A verdict as documents write it.
pub(super) const fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::NoDiscrepancy => "no_discrepancy",
        Verdict::Explained => "explained",
        Verdict::PartlyExplained => "partly_explained",
        Verdict::Unexplained => "unexplained",
    }
}

/// A number with its interval: `radial 0.71 mm (0.69 to 0.73)`.
pub(super) fn estimate(estimate: &Estimate) -> String {
    let [low, high] = estimate.interval95;
    let decimals = carried(estimate.value, estimate.interval95);
    let [value, low, high] = [estimate.value, low, high].map(|value| rounded(value, decimals));
    format!("{} ({low} to {high})", named(estimate.name, &value))
}

/// How many digits behind the point a value's interval carries.
pub(super) fn carried(value: f64, [low, high]: [f64; 2]) -> usize {
    let half = 0.5 * (high - low);
    decimals(if half.is_finite() { half } else { value })
}

/// Errors of decoded contacts as people read them.
pub(super) struct Decoded {
    pub(super) nominal: String,
    pub(super) extended: String,
    /// Ends of the interval of the change.
    pub(super) change: [String; 2],
}

/// How far decoded places and loads are off, as far as a model has any.
pub(super) fn decoded(gain: &Gain) -> impl Iterator<Item = (&'static str, Decoded)> {
    let all = [("places", "mm", &gain.position_mae), ("forces", "N", &gain.force_mae)];
    all.into_iter().filter_map(|(of, unit, errors)| {
        let errors = errors.as_ref()?;
        let digits = carried(errors.extended, errors.change_interval95).max(2);
        let told = |value: f64| with_unit(&rounded(value, digits), unit);
        let change = errors.change_interval95.map(told);
        Some((of, Decoded { nominal: told(errors.nominal), extended: told(errors.extended), change }))
    })
}

/// Values of a number, from the least to the greatest.
pub(super) fn range(name: &str, least: f64, greatest: f64) -> String {
    let [low, high] = [least, greatest].map(|value| rounded(value, decimals(least)));
    if low == high { named(name, &low) } else { named(name, &format!("{low} to {high}")) }
}

/// A value under its name: what it is before, its unit behind.
pub(super) fn named(name: &str, value: &str) -> String {
    let (what, unit) = parts(name);
    format!("{what} {}", with_unit(value, unit)).trim().to_owned()
}

/// A value with its unit behind.
pub(super) fn with_unit(value: &str, unit: &str) -> String {
    let gap = if unit.is_empty() || unit == "°" { "" } else { " " };
    format!("{value}{gap}{unit}")
}

/// The quantity of a number, and its unit: `radial_mm` is a `radial` in `mm`.
pub(super) fn parts(name: &str) -> (String, &'static str) {
    let ends = |(ending, _): &&(&str, &str)| {
        name.strip_suffix(ending).is_some_and(|before| before.is_empty() || before.ends_with('_'))
    };
    let (ending, unit) = UNITS.iter().find(ends).copied().unwrap_or_default();
    (name.strip_suffix(ending).unwrap_or(name).trim_end_matches('_').replace('_', " "), unit)
}

/// How many digits behind the point show two figures of `size`.
pub(super) fn decimals(size: f64) -> usize {
    // A difference of decimal fractions may fall short of a power of ten by its rounding.
    let magnitude = (size.abs().log10() + 1e-9).floor();
    if magnitude.is_finite() { (1 - magnitude as i32).clamp(0, DECIMALS_MAX) as usize } else { 2 }
}

pub(super) fn rounded(value: f64, decimals: usize) -> String {
    if value.is_nan() {
        return "unknown".into();
    }
    if value.is_infinite() {
        return if value > 0.0 { "∞".into() } else { "−∞".into() };
    }
    let text = format!("{value:.decimals$}");
    // No minus in front of nothing.
    match text.strip_prefix('-') {
        Some(zero) if zero.chars().all(|digit| matches!(digit, '0' | '.')) => zero.to_owned(),
        Some(positive) => format!("−{positive}"),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(name: &'static str, value: f64, interval95: [f64; 2]) -> String {
        estimate(&Estimate { name, value, interval95 })
    }

    #[test]
    fn numbers_have_units_and_as_many_digits_as_their_intervals() {
        assert_eq!(told("deg", 2.13, [1.8, 2.46]), "2.13° (1.80 to 2.46)");
        assert_eq!(told("radial_mm", -0.7123, [-0.76, -0.66]), "radial −0.712 mm (−0.760 to −0.660)");
        assert_eq!(told("uv_per_c", 31.26, [11.0, 51.0]), "31 µV/°C (11 to 51)");
        assert_eq!(told("gain", 1.12, [1.11, 1.13]), "gain 1.120 (1.110 to 1.130)");
        assert_eq!(told("share_at_end", -1e-9, [-0.2, 0.2]), "share at end 0.00 (−0.20 to 0.20)");
        assert_eq!(told("area_share", 0.4, [f64::NEG_INFINITY, f64::INFINITY]), "area share 0.40 (−∞ to ∞)");
        assert_eq!(told("gain", f64::NAN, [f64::NAN; 2]), "gain unknown (unknown to unknown)");
        assert_eq!(range("fx_n", 0.0213, 0.0479), "fx 0.021 to 0.048 N");
        assert_eq!(range("mm", 0.5, 0.5), "0.50 mm");
    }
}
