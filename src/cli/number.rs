//! Numbers that people type: with a decimal comma or a point, with their unit behind them or without.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;

/// Reads a number of grams: `200`, `200g`, `200 g`, `8,5`.
pub(crate) fn grams(text: &str) -> Result<f64, String> {
    read(text, &["grams", "gram", "g"], |_| true, "grams, such as 200, 200g or 8.5")
}

/// Reads a number of millimetres.
pub(crate) fn millimetres(text: &str) -> Result<f64, String> {
    read(text, &["mm"], |_| true, "millimetres, such as 20, 20mm or 7.5")
}

/// Reads a factor.
pub(crate) fn factor(text: &str) -> Result<f64, String> {
    read(text, &[], |_| true, "a factor, such as 0.97")
}

/// Reads a share: `0.05`, `0,05`, `5 %`.
pub(crate) fn share(text: &str) -> Result<f64, String> {
    let example = "a share above 0 and below 1, such as 0.05 or 5%";
    let (number, whole) = text.trim_end().strip_suffix('%').map_or((text, 1.0), |percent| (percent, 100.0));
    read(number, &[], |it| (0.0..whole).contains(it) && *it > 0.0, example).map(|number| number / whole)
}

/// Reads what draws are drawn by.
pub(crate) fn seed(text: &str) -> Result<u64, String> {
    whole(text, &[], 0..=u64::MAX, "a whole number from 0 up, such as 7")
}

/// The allowed number of a text with one of these units, the longest first; else a sentence that shows how to write it.
pub(crate) fn read(
    text: &str,
    units: &[&str],
    is_allowed: impl Fn(&f64) -> bool,
    example: impl Display,
) -> Result<f64, String> {
    let number = bare(text, units);
    let is_doubtful = number.contains(',') && (number.contains('.') || number.matches(',').count() > 1);
    let value: Option<f64> = number.replacen(',', ".", 1).parse().ok();
    value
        .filter(|it| !is_doubtful && it.is_finite() && is_allowed(it))
        .ok_or_else(|| format!("write {example}"))
}

/// The whole number of a text within these limits, with one of these units or without; else a sentence that shows how to write it.
pub(crate) fn whole<T: FromStr + PartialOrd>(
    text: &str,
    units: &[&str],
    limits: RangeInclusive<T>,
    example: impl Display,
) -> Result<T, String> {
    let value = bare(text, units).parse().ok();
    value.filter(|it| limits.contains(it)).ok_or_else(|| format!("write {example}"))
}

fn bare<'a>(text: &'a str, units: &[&str]) -> &'a str {
    let plain = text.trim();
    units.iter().find_map(|unit| plain.strip_suffix(unit)).unwrap_or(plain).trim_end()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_comma_is_a_point_and_the_unit_may_stand_behind() {
        for (text, value) in [
            ("200", 200.0),
            ("200g", 200.0),
            (" 200 g", 200.0),
            ("8,5", 8.5),
            ("8.5 grams", 8.5),
            ("-1", -1.0),
        ] {
            assert_eq!(grams(text), Ok(value), "{text}");
        }
        assert_eq!((millimetres("7,5mm"), share("0,05"), share("5 %")), (Ok(7.5), Ok(0.05), Ok(0.05)));
        for text in ["", "g", "two", "200 kg", "1.000,5", "1,0,5", "20 mm", "inf", "1e999"] {
            assert_eq!(grams(text), Err("write grams, such as 200, 200g or 8.5".into()), "{text}");
        }
        for text in ["0", "1", "-0.1", "nan", "", "100%", "5 % %"] {
            assert!(share(text).is_err(), "{text}");
        }
    }

    #[test]
    fn whole_numbers_have_their_limits_and_units() {
        assert_eq!((seed("7"), whole("200 ms", &["ms"], 0..=5_000, "")), (Ok(7), Ok(200)));
        for text in ["", "-1", "1.5", "1e3", "seven", "7q", "99999999999999999999"] {
            assert_eq!(seed(text), Err("write a whole number from 0 up, such as 7".into()), "{text}");
        }
    }
}
