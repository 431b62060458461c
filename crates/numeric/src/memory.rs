//! Two operators that remember: friction, and slow giving way.

/// A play operator's state when its input went here: it stays where it is until the input is further off than the threshold, and is
/// then pulled along.
///
/// Source: M. A. Krasnosel'skii, A. V. Pokrovskii, Systems with Hysteresis (1989), section 2.
pub const fn pulled(state: f64, input: f64, threshold: f64) -> f64 {
    // p ← min(max(p, e − r), e + r)
    state.max(input - threshold).min(input + threshold)
}

/// The state of a first-order low pass after `times` time constants in which its input went evenly between two values;
/// `kept` is exp(−`times`).
pub fn low_passed(state: f64, [from, to]: [f64; 2], times: f64, kept: f64) -> f64 {
    if times <= 0.0 {
        return state;
    }
    // The input is a ramp of slope v per time constant; the low pass follows it with the lag v, and what differs decays:
    // y = to − v + (y₀ − from + v) exp(−times).
    let lag = (to - from) / times;
    to - lag + (state - from + lag) * kept
}
