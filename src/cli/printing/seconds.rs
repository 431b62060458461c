//! `--seconds`: how long a verb goes on.

use crate::cli::number;

/// A day; a longer run is one without an end.
const SECONDS_MAX: f64 = 86_400.0;

/// Reads a duration in seconds. Clap calls it before the verb begins, so before any file is touched.
pub(crate) fn parse(text: &str) -> Result<f64, String> {
    let example = format_args!("a number of seconds above 0 and up to {SECONDS_MAX}, such as 20 or 0.5s");
    number::read(text, &["seconds", "s"], |seconds| *seconds > 0.0 && *seconds <= SECONDS_MAX, example)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_end_at_a_day_and_begin_after_nothing() {
        for (text, seconds) in
            [("0.5", 0.5), ("0,5 s", 0.5), ("1", 1.0), ("86400", 86_400.0), ("1e-3", 0.001)]
        {
            assert_eq!(parse(text), Ok(seconds));
        }
        for text in
            ["0", "-0", "-1", "nan", "inf", "-inf", "1e300", "86400.1", "1e-400", "abc", "", "1 m", "--json"]
        {
            assert!(parse(text).is_err(), "{text}");
        }
    }
}
