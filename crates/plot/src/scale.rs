//! Axes: which values they span, where their ticks are and what is written there.

/// How values lie along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// By their logarithm; only positive values can be shown.
    Log10,
}

/// Larger values are taken as not finite: their differences would be.
const LARGEST: f64 = 1e150;
/// An axis may end so many times further out, where its last tick is.
const ROUNDING: f64 = 100.0;
/// Spans below this share of the values are no span.
const RESOLUTION: f64 = 1e-9;
/// About as many steps between ticks.
const STEPS: f64 = 6.0;
/// Labels on a logarithmic axis.
const LABELS_MAX: i32 = 8;

/// A span of values between two places on the page.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    pub(super) scale: Scale,
    /// Least and greatest value.
    pub(super) span: [f64; 2],
    /// Where they are.
    pub(super) page: [f64; 2],
}

/// A value with a mark at the axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// Where it is.
    pub value: f64,
    /// What is written there, `^{…}` being an exponent. Empty for a tick between labelled ones.
    pub label: String,
}

impl Scale {
    /// Whether an axis of this kind is made for a value.
    pub(super) fn shows(self, value: f64) -> bool {
        self.holds(value, LARGEST)
    }

    fn holds(self, value: f64, largest: f64) -> bool {
        match self {
            Self::Linear => value.abs() < largest,
            Self::Log10 => value > 1.0 / largest && value < largest,
        }
    }

    fn inner(self, value: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Log10 => value.log10(),
        }
    }

    /// The span of an axis that shows `values` and begins and ends at ticks.
    pub fn span(self, values: impl Iterator<Item = f64>) -> [f64; 2] {
        let shown = span_of(values.filter(|&value| self.shows(value)));
        match self {
            Self::Linear => {
                let [low, high] = apart(shown.unwrap_or([0.0, 1.0]));
                let step = nice_step((high - low) / STEPS);
                [(low / step + RESOLUTION).floor() * step, (high / step - RESOLUTION).ceil() * step]
            }
            Self::Log10 => {
                let [low, high] = shown.unwrap_or([1.0, 10.0]);
                let [below, above] = [nice_below(low), nice_step(high)];
                if below < above { [below, above] } else { [below / 10.0, above * 10.0] }
            }
        }
    }
}

impl Axis {
    /// The place of a value; not finite if the axis has none.
    pub(super) fn at(&self, value: f64) -> f64 {
        let [low, high] = self.span.map(|end| self.scale.inner(end));
        let share = (self.scale.inner(value) - low) / (high - low);
        let is_held = self.scale.holds(value, ROUNDING * LARGEST);
        if is_held { self.page[0] + share * (self.page[1] - self.page[0]) } else { f64::NAN }
    }

    pub(super) fn ticks(&self) -> Vec<Tick> {
        match self.scale {
            Scale::Linear => linear_ticks(self.span, STEPS),
            Scale::Log10 => log_ticks(self.span),
        }
    }
}

/// Least and greatest of the values that are finite and not absurd.
pub(super) fn span_of(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let fold = |span: Option<[f64; 2]>, value: f64| {
        let [low, high] = span.unwrap_or([value, value]);
        Some([low.min(value), high.max(value)])
    };
    values.filter(|&value| Scale::Linear.shows(value)).fold(None, fold)
}

/// A span that is one: around a single value as wide as itself, around zero from −1 to 1.
pub(super) fn apart([low, high]: [f64; 2]) -> [f64; 2] {
    let size = low.abs().max(high.abs());
    match () {
        () if size < 1.0 / LARGEST => [-1.0, 1.0],
        () if high - low < RESOLUTION * size => [low - 0.5 * size, high + 0.5 * size],
        () => [low, high],
    }
}

/// The least of 1, 2, 5 times a power of ten that is not below `step`.
fn nice_step(step: f64) -> f64 {
    round_above(step, &[1.0, 2.0, 5.0])
}

/// The least of `factors` (from 1 to below 10, increasing) times a power of ten that is not below `value`.
pub(super) fn round_above(value: f64, factors: &[f64]) -> f64 {
    let power = power_of_ten(value);
    let round = factors.iter().map(|factor| factor * power);
    round.into_iter().find(|&round| round >= value * (1.0 - RESOLUTION)).unwrap_or(10.0 * power)
}

pub(super) fn power_of_ten(value: f64) -> f64 {
    10.0_f64.powf((value.log10() + RESOLUTION).floor())
}

/// The greatest of 1, 2, 5 times a power of ten that is not above `value`.
fn nice_below(value: f64) -> f64 {
    let power = power_of_ten(value);
    let nice = [5.0, 2.0, 1.0].map(|factor| factor * power);
    nice.into_iter().find(|&nice| nice <= value * (1.0 + RESOLUTION)).unwrap_or(power)
}

/// Labelled ticks at even values, about `steps` apart.
pub fn linear_ticks([low, high]: [f64; 2], steps: f64) -> Vec<Tick> {
    let step = nice_step((high - low) / steps);
    let [first, last] = [(low / step - RESOLUTION).ceil(), (high / step + RESOLUTION).floor()];
    if !(step > 0.0 && last - first < 100.0) {
        return Vec::new();
    }
    let values = (0..=(last - first) as usize).map(|index| (first + index as f64) * step);
    values.map(|value| Tick { value, label: label(value, step) }).collect()
}

fn log_ticks([low, high]: [f64; 2]) -> Vec<Tick> {
    let [first, last] = [low.log10().floor() as i32, (high.log10() + RESOLUTION).floor() as i32];
    let every = (last - first) / LABELS_MAX + 1;
    let mut ticks = Vec::new();
    for decade in first..=last {
        for digit in 1..=9_i32 {
            let value = f64::from(digit) * 10.0_f64.powi(decade);
            let inside = value >= low * (1.0 - RESOLUTION) && value <= high * (1.0 + RESOLUTION);
            let labelled = match (last - first, digit) {
                (_, 1) => decade.rem_euclid(every) == 0,
                (0..=1, 2 | 5) => true,
                _ => false,
            };
            if inside && (labelled || every == 1) {
                ticks.push(Tick {
                    value,
                    label: if labelled { power_label(value, [low, high]) } else { String::new() },
                });
            }
        }
    }
    ticks
}

fn power_label(value: f64, [low, high]: [f64; 2]) -> String {
    if low >= 1e-3 && high <= 1e5 { label(value, power_of_ten(value)) } else { scientific(value, value) }
}

/// A value as text, with as many digits as steps of `step` need, and a true minus sign.
pub(super) fn label(value: f64, step: f64) -> String {
    if value.abs() < 0.5 * step.min(LARGEST) || !value.is_finite() {
        return if value.is_finite() { "0".to_owned() } else { String::new() };
    }
    if value.abs() >= 1e5 || step < 1e-4 {
        return scientific(value, step);
    }
    format!("{value:.0$}", digits_below_one(step)).replace('-', "−")
}

fn scientific(value: f64, step: f64) -> String {
    let power = power_of_ten(value.abs());
    let digits = digits_below_one(step / power);
    let (mantissa, exponent) = (value / power, power.log10().round());
    let text = if mantissa == 1.0 { String::new() } else { format!("{mantissa:.digits$}×") };
    format!("{text}10^{{{exponent}}}").replace('-', "−")
}

/// So many that the step's first digit shows, and its second one if that is not 0.
fn digits_below_one(step: f64) -> usize {
    let leading = step / power_of_ten(step);
    let more = if (leading - leading.round()).abs() > 0.01 { 1.0 } else { 0.0 };
    (more - (step.log10() + RESOLUTION).floor()).clamp(0.0, 12.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn labels(ticks: &[Tick]) -> Vec<&str> {
        ticks.iter().map(|tick| tick.label.as_str()).filter(|label| !label.is_empty()).collect()
    }

    fn axis(scale: Scale, values: &[f64]) -> Axis {
        Axis { scale, span: scale.span(values.iter().copied()), page: [0.0, 100.0] }
    }

    #[test]
    fn linear_axes_end_at_ticks() {
        let axis = axis(Scale::Linear, &[0.3, 9.1, f64::NAN]);
        assert_eq!(axis.span, [0.0, 10.0]);
        assert_eq!(labels(&axis.ticks()), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(axis.at(5.0), 50.0);
    }

    #[test]
    fn labels_have_the_digits_of_their_step() {
        assert_eq!(labels(&linear_ticks([-0.1, 0.1], 4.0)), ["−0.10", "−0.05", "0", "0.05", "0.10"]);
        assert_eq!(labels(&linear_ticks([0.0, 3e5], 3.0)), ["0", "10^{5}", "2×10^{5}", "3×10^{5}"]);
        assert_eq!(label(-2.5e-6, 5e-7), "−2.5×10^{−6}");
    }

    #[test]
    fn logarithmic_axes_label_decades() {
        let wide = axis(Scale::Log10, &[2e-6, 0.5, -1.0, 0.0]);
        assert_eq!(wide.span, [2e-6, 0.5]);
        assert_eq!(labels(&wide.ticks()), ["10^{−5}", "10^{−4}", "10^{−3}", "10^{−2}", "10^{−1}"]);
        let narrow = axis(Scale::Log10, &[3.0, 40.0]);
        assert_eq!(labels(&narrow.ticks()), ["2", "5", "10", "20", "50"]);
        assert!((narrow.at(10.0) - 50.0).abs() < 1e-9);
        assert!(narrow.at(0.0).is_nan());
    }

    #[test]
    fn degenerate_values_still_give_an_axis() {
        for scale in [Scale::Linear, Scale::Log10] {
            for values in [
                &[][..],
                &[0.0],
                &[5.0],
                &[-3.0, -3.0],
                &[f64::NAN],
                &[1e-320, 0.0],
                &[f64::MAX, f64::MIN],
                &[0.0, 9e149],
                &[-9.99e149, 2e-150],
            ] {
                let axis = axis(scale, values);
                assert!(axis.span[0] < axis.span[1], "{scale:?} {values:?}: {:?}", axis.span);
                let ticks = axis.ticks();
                assert!(ticks.len() > 1, "{scale:?} {values:?}");
                assert!(ticks.iter().all(|tick| axis.at(tick.value).is_finite()), "{scale:?} {values:?}");
            }
        }
    }

    proptest! {
        #[test]
        fn every_span_holds_its_values_and_has_distinct_labels(a: f64, b: f64) {
            for scale in [Scale::Linear, Scale::Log10] {
                let axis = axis(scale, &[a, b]);
                let ticks = axis.ticks();
                prop_assert!(ticks.len() <= 100);
                prop_assert!(ticks.iter().all(|tick| axis.at(tick.value).is_finite()));
                for value in [a, b].into_iter().filter(|&value| scale.shows(value)) {
                    let at = axis.at(value);
                    prop_assert!((-1e-3..=100.001).contains(&at), "{value} is at {at} in {:?}", axis.span);
                }
                let mut found = labels(&ticks);
                found.sort_unstable();
                let all = found.len();
                found.dedup();
                prop_assert_eq!(found.len(), all, "{:?}", axis.span);
            }
        }
    }
}
