//! Standard deviations of the prior, by kind of parameter: how carefully pads are built.
//!
//! They begin with what hands and parts are known to do. A pad that was built better shows it, as its parameters lie closer to
//! the prior's mean: the deviations are found by the evidence (D. J. C. MacKay, Neural Computation 4 (1992) 415).

/// Kinds of parameters that share a prior standard deviation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Of a module, mm.
    Shift,
    /// Of a module, degrees.
    Turn,
    /// Of a module, a factor's logarithm.
    Stiffness,
    /// Of the plate, a factor's logarithm.
    PlateThickness,
    /// Of a material of all modules, a factor's logarithm.
    CommonModulus,
    /// Of another channel's microvolts.
    Crosstalk,
    /// Remainder of a zero that was taken off, µV.
    Zero,
    /// Difference of a channel's hysteresis share from the mean of all channels.
    OwnHysteresis,
}

const KINDS: usize = 8;
/// Standard deviations that the search begins with. Modules are assembled by hand; stiffness is that of a modulus.
const SHIFT_MM: f64 = 0.3;
const TURN_DEG: f64 = 2.0;
const STIFFNESS: f64 = 0.3;
/// Sheets are rolled to some percent, and another sheet may have been at hand; glues and laminates cure as they do.
const PLATE_THICKNESS: f64 = 0.08;
const COMMON_MODULUS: f64 = 0.2;
const CROSSTALK: f64 = 0.02;
const ZERO_UV: f64 = 20.0;
/// Of unbalanced bridges: some tenths of a percent of a gauge.
const RAW_ZERO_UV: f64 = 2000.0;
const HYSTERESIS_OWN: f64 = 0.02;
/// Parameters of its kind that each initial deviation counts as.
const PSEUDO_COUNT: f64 = 4.0;

/// Prior standard deviations, by kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PriorDeviations {
    deviations: [f64; KINDS],
    /// Those that the search began with.
    initial: [f64; KINDS],
}

impl PriorDeviations {
    /// At the beginning, where zeros are taken off.
    pub(super) const TARED: Self = Self::with_zeros(ZERO_UV);
    /// At the beginning, where they are not.
    pub(super) const RAW: Self = Self::with_zeros(RAW_ZERO_UV);

    const fn with_zeros(zero_uv: f64) -> Self {
        let initial = [
            SHIFT_MM,
            TURN_DEG,
            STIFFNESS,
            PLATE_THICKNESS,
            COMMON_MODULUS,
            CROSSTALK,
            zero_uv,
            HYSTERESIS_OWN,
        ];
        Self { deviations: initial, initial }
    }

    /// The standard deviation of a kind.
    pub(super) const fn of(&self, kind: Kind) -> f64 {
        self.deviations[kind as usize]
    }

    /// The deviations by the evidence. Of each parameter: its kind, its difference θ − m from the prior's mean, and its posterior
    /// variance v. With κ pseudo-observations of the initial σ₀
    ///
    /// ```text
    /// σ² = (κ σ₀² + Σ (θ − m)²)/(κ + Σ γ),    γ = 1 − v/σ²
    /// ```
    ///
    /// where γ is how far the contacts determine a parameter (MacKay 1992).
    pub(super) fn reestimated(&self, numbers: impl Iterator<Item = (Kind, f64, f64)>) -> Self {
        let mut squares = self.initial.map(|deviation| PSEUDO_COUNT * deviation * deviation);
        let mut counts = [PSEUDO_COUNT; KINDS];
        for (kind, difference, variance) in numbers {
            // (θ − m)², γ = 1 − v/σ².
            squares[kind as usize] += difference * difference;
            counts[kind as usize] += (1.0 - variance / self.of(kind).powi(2)).clamp(0.0, 1.0);
        }
        // σ² = Σ (θ − m)²/Σ γ, both with the pseudo-observations.
        Self { deviations: std::array::from_fn(|kind| (squares[kind] / counts[kind]).sqrt()), ..*self }
    }
}
