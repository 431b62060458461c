//! How the numbers of hysteresis and creep become terms of a channel's memory.

/// Thresholds of the play operators as shares of full scale, evenly spread in their logarithm.
pub(super) const THRESHOLDS: [f64; 5] = [0.01, 0.025, 0.063, 0.158, 0.4];
/// Relaxation times evenly spread in their logarithm, over all that a recording shows, s.
pub(super) const TIMES_S: [f64; 5] = [0.5, 2.0, 8.0, 32.0, 128.0];

/// Thresholds and shares of the play operators of hysteresis: values are the height of a full stroke's loop as a share of full
/// scale, the operators' parts, how far above a static load came from, and the factor of full scale.
///
/// How soon a loop has opened differs from glue to glue: the parts are fitted beside the height, and by any parts Prandtl's and
/// Ishlinskii's model has any such loop.
/// Source: M. A. Krasnosel'skii, A. V. Pokrovskii, Systems with Hysteresis (1989), section 2.
pub(crate) fn plays(values: &[f64]) -> impl Iterator<Item = [f64; 2]> {
    let (parts, others) = values[1..].split_at(THRESHOLDS.len());
    let height = values[0] * others[1] / parts.iter().sum::<f64>();
    // A loop is 2 w r high.
    THRESHOLDS
        .into_iter()
        .zip(parts)
        .map(move |(threshold, part)| [threshold, height * part / (2.0 * threshold)])
}

/// Relaxation times (s) and shares of creep: values are the creep after 20 s as a share of the load, and the parts of the times.
///
/// How creep goes differs from glue to glue: the parts are fitted beside the share.
/// Source: J. D. Ferry, Viscoelastic Properties of Polymers (1980), chapter 3 (spectra of relaxation times).
pub(crate) fn terms(values: &[f64]) -> impl Iterator<Item = [f64; 2]> {
    let whole: f64 = values[1..].iter().sum();
    // Parts are those of what has come after 20 s: c (1 − exp(−20 s/τ)).
    let share = move |time_s: f64, part: f64| values[0] * part / whole / -libm::expm1(-20.0 / time_s);
    TIMES_S.into_iter().zip(&values[1..]).map(move |(time_s, part)| [time_s, share(time_s, *part)])
}
