//! Two operators that remember: friction, and slow giving way.

/// A play operator. Its state p follows its input e and stays up to a threshold r behind, p ← min(max(p, e − r), e + r); it adds
/// w (p − e) to what is read. Where the input turns far apart, ways up and down differ by 2 w r.
///
/// Source: M. A. Krasnosel'skii, A. V. Pokrovskii, Systems with Hysteresis (1989), section 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlayOperator {
    /// r: half the width of its band, in the input's unit.
    pub threshold: f64,
    /// w; one below zero corrects another operator's.
    pub share: f64,
}

impl PlayOperator {
    /// One that does nothing.
    pub const NONE: Self = Self { threshold: 0.0, share: 0.0 };

    /// Its state when its input went here.
    pub const fn pulled(&self, state: f64, input: f64) -> f64 {
        state.max(input - self.threshold).min(input + self.threshold)
    }

    /// What it adds.
    pub const fn added(&self, state: f64, input: f64) -> f64 {
        self.share * (state - input)
    }
}

/// A relaxation, one term of a Prony series. Its state u is its input e low-passed, τ u̇ = e − u; it adds c u to what is read. A step
/// of the input reads 1 at once and 1 + c in the end.
///
/// Source: J. D. Ferry, Viscoelastic Properties of Polymers (1980), chapter 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relaxation {
    /// τ.
    pub time_s: f64,
    /// c.
    pub share: f64,
}

impl Relaxation {
    /// One that does nothing.
    pub const NONE: Self = Self { time_s: 0.0, share: 0.0 };

    /// Share of the state's distance from the input that is left when that was held for so long.
    pub fn left(&self, held_s: f64) -> f64 {
        if held_s > 0.0 { libm::exp(-held_s / self.time_s) } else { 1.0 }
    }

    /// Its state when the input was held for so long.
    pub fn held(&self, state: f64, input: f64, held_s: f64) -> f64 {
        relaxed(state, input, self.left(held_s))
    }

    /// Its state when the input went evenly from one value to another within so long.
    pub fn followed(&self, state: f64, ends: [f64; 2], after_s: f64) -> f64 {
        ramped(state, ends, after_s / self.time_s, self.left(after_s))
    }

    /// What it adds.
    pub const fn added(&self, state: f64) -> f64 {
        self.share * state
    }
}

/// A relaxation's state when its input went evenly from one value to another within so many time constants; `left` is exp(−`times`).
pub fn ramped(state: f64, [from, to]: [f64; 2], times: f64, left: f64) -> f64 {
    if times.is_nan() || times <= 0.0 {
        return state;
    }
    // A ramp of slope v per time constant is followed with the lag v, and what differs decays:
    // u = to − v + (u₀ − from + v) exp(−t/τ).
    let lag = (to - from) / times;
    to - lag + (state - from + lag) * left
}

/// A state whose input was held until this share of its distance was left: u ← e + (u − e) exp(−Δt/τ).
pub const fn relaxed(state: f64, input: f64, left: f64) -> f64 {
    input + left * (state - input)
}
