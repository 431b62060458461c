//! Numbers that people type: with a decimal comma or a point, with their unit behind them or without.

/// Reads a number of grams: `200`, `200g`, `200 g`, `8,5`.
pub(crate) fn grams(text: &str) -> Result<f64, String> {
    read(text, &["grams", "gram", "g"], "grams, such as 200, 200g or 8.5")
}

/// Reads a number of millimetres.
pub(crate) fn millimetres(text: &str) -> Result<f64, String> {
    read(text, &["mm"], "millimetres, such as 20, 20mm or 7.5")
}

/// Reads a factor.
pub(crate) fn factor(text: &str) -> Result<f64, String> {
    read(text, &[], "a factor, such as 0.97")
}

/// Reads a share.
pub(crate) fn share(text: &str) -> Result<f64, String> {
    read(text, &[], "a share of 1, such as 0.05")
}

/// The number of a text with one of these units, the longest first; else a sentence that shows how to write it.
pub(crate) fn read(text: &str, units: &[&str], example: &str) -> Result<f64, String> {
    let plain = text.trim();
    let number = units.iter().find_map(|unit| plain.strip_suffix(unit)).unwrap_or(plain).trim_end();
    let is_doubtful = number.contains(',') && (number.contains('.') || number.matches(',').count() > 1);
    let value = number.replacen(',', ".", 1).parse().ok();
    value.filter(|_| !is_doubtful).ok_or_else(|| format!("write {example}"))
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
        assert_eq!((millimetres("7,5mm"), share("0,05")), (Ok(7.5), Ok(0.05)));
        for text in ["", "g", "two", "200 kg", "1.000,5", "1,0,5", "20 mm"] {
            assert_eq!(grams(text), Err("write grams, such as 200, 200g or 8.5".into()), "{text}");
        }
    }
}
