//! The numbers of the inverse decoder's fit, for people and as a document. They are coefficients of the decoder: only what a
//! diagnosis names is said to be a cause.

use std::fmt;

use serde::Serialize;

use super::checks::CheckResult;
use super::named::{NamedCauses, TableFinding};
use super::open::OpenNumber;
use super::thermal::FoundThermal;
use crate::cli::printing::wrapped::hanging;
use tactpad::lab::calibration::fit::Calibration;
use tactpad::lab::calibration::result::numbers::{Number, Pair, Quantity, ToldBy};
use tactpad::lab::diagnosis::data::target::Target;
use tactpad::numeric::memory::{PlayOperator, Relaxation};
use tactpad::numeric::statistics::mean;
use tactpad::quantity::{CHANNEL_NAMES, CHANNELS};

/// So many pairs that are not told apart are said to people; documents have all.
const PAIRS_SAID: usize = 5;

/// The result of the calibration.
pub(super) struct FoundPad {
    named: NamedCauses,
    calibration: Calibration,
}

/// The same as a document.
#[derive(Serialize)]
struct FoundPadDocument<'d> {
    gain: [f64; CHANNELS],
    noise_uv: [f64; CHANNELS],
    noise_share: [f64; CHANNELS],
    background_share: f64,
    /// Play operators: threshold and share, as means over the channels.
    friction: Vec<Friction>,
    #[serde(skip_serializing_if = "Option::is_none")]
    creep: Option<Creep>,
    parameters: Vec<DeviceParameter>,
    numbers: Vec<FitNumber>,
    not_told_apart: Vec<CorrelatedPair>,
    findings: Vec<TableFinding<'d>>,
    /// Why tables name nothing.
    not_diagnosed: &'d [String],
    /// Readings of the untouched pad in microvolts, where no row reads it.
    #[serde(skip_serializing_if = "Option::is_none")]
    zero_uv: Option<[f64; CHANNELS]>,
    /// How channels follow the temperature, where it was measured at several.
    #[serde(skip_serializing_if = "Option::is_none")]
    thermal: Option<FoundThermal>,
    /// Whether the field of `--from` was nearer than the simulated one.
    field_from_earlier: bool,
    /// The module's flaw that the field is fitted with.
    #[serde(skip_serializing_if = "Option::is_none")]
    flaw: Option<String>,
    /// Numbers that the rig leaves open.
    open_by_rig: Vec<OpenNumber>,
    /// Whether contacts miss alike in all parts of the measurement.
    checks: Vec<CheckResult>,
    /// The factor by which what the decoder states is wider than the fit, for checks that are missed; 1 without.
    widening: f64,
}

/// How well a number is known, and whether a diagnosis names its cause.
#[derive(Serialize)]
struct NumberCertainty {
    deviation: f64,
    told_by: &'static str,
    named: bool,
}

/// A number of the fit and of what it is.
#[derive(Serialize)]
struct FitNumber {
    #[serde(flatten)]
    place: NumberName,
    value: f64,
    /// Of a pad that does not differ from the device.
    expected: f64,
    prior_deviation: f64,
    #[serde(flatten)]
    standing: NumberCertainty,
}

#[derive(Serialize)]
struct NumberName {
    name: &'static str,
    target: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    with: Option<String>,
    /// Of a play operator, in strains before gains.
    #[serde(skip_serializing_if = "Option::is_none")]
    threshold_uv: Option<f64>,
}

#[derive(Serialize)]
struct CorrelatedPair {
    pair: [NumberName; 2],
    correlation: f64,
}

#[derive(Serialize)]
struct Friction {
    threshold_uv: f64,
    share: f64,
    #[serde(flatten)]
    standing: NumberCertainty,
}

/// The creep of a load: its share in the end, and its time constant.
#[derive(Serialize)]
struct Creep {
    time_s: f64,
    share: f64,
    #[serde(flatten)]
    standing: NumberCertainty,
}

/// How much a number of the device differs from the device's own.
#[derive(Serialize)]
struct DeviceParameter {
    name: &'static str,
    change: f64,
    #[serde(flatten)]
    standing: NumberCertainty,
}

impl FoundPad {
    pub(super) const fn of(calibration: Calibration, named: NamedCauses) -> Self {
        Self { named, calibration }
    }

    fn numbers(&self) -> impl Iterator<Item = &Number> {
        self.calibration.numbers.iter()
    }

    fn document(&self) -> FoundPadDocument<'_> {
        let Calibration { gain, noise, background, compensation, thermal, .. } = &self.calibration;
        FoundPadDocument {
            gain: *gain,
            noise_uv: noise.additive_uv,
            noise_share: noise.share,
            background_share: *background,
            friction: self.frictions().collect(),
            creep: self.creep(),
            parameters: self.numbers().filter_map(|it| self.parameter(it)).collect(),
            numbers: self.numbers().map(|it| self.told(it)).collect(),
            not_told_apart: self
                .calibration
                .not_told_apart
                .iter()
                .map(|it| self.not_told_apart(it))
                .collect(),
            findings: self.named.documents(),
            not_diagnosed: self.named.unfit(),
            zero_uv: compensation.zero_uv,
            thermal: thermal.as_ref().map(FoundThermal::of),
            field_from_earlier: self.calibration.from_earlier,
            flaw: self.calibration.flaw.map(|(module, flaw)| format!("module{module} {flaw}")),
            open_by_rig: self.calibration.open_by_rig.iter().map(OpenNumber::of).collect(),
            checks: self.calibration.checks.iter().map(CheckResult::of).collect(),
            widening: self.calibration.widening,
        }
    }

    fn standing(&self, number: &Number) -> NumberCertainty {
        let told_by = match number.told_by() {
            ToldBy::Data => "data",
            ToldBy::Prior => "prior",
        };
        NumberCertainty { deviation: number.deviation, told_by, named: self.named.names(number) }
    }

    fn told(&self, number: &Number) -> FitNumber {
        FitNumber {
            place: NumberName::of(number),
            value: number.value,
            expected: number.expected,
            prior_deviation: number.prior_deviation,
            standing: self.standing(number),
        }
    }

    fn not_told_apart(&self, pair: &Pair) -> CorrelatedPair {
        let place = |at: usize| NumberName::of(&self.calibration.numbers[at]);
        CorrelatedPair { pair: pair.places.map(place), correlation: pair.correlation }
    }

    fn parameter(&self, number: &Number) -> Option<DeviceParameter> {
        let Quantity::Physical(_) = number.quantity else { return None };
        let (name, change) = (number.quantity.name(), number.value - number.expected);
        Some(DeviceParameter { name, change, standing: self.standing(number) })
    }

    /// The play operators that the fit has.
    fn frictions(&self) -> impl Iterator<Item = Friction> {
        let is_mean =
            |it: &&Number| matches!((it.quantity, it.target), (Quantity::Friction { .. }, Target::Pad));
        let threshold_uv = |plays: &[PlayOperator; CHANNELS]| mean(plays.map(|play| play.threshold));
        let plays = self.calibration.compensation.hysteresis.iter();
        let plays = plays.filter(move |plays| threshold_uv(plays) > 0.0);
        plays
            .zip(self.numbers().filter(is_mean))
            .map(move |(plays, number)| Friction {
                threshold_uv: threshold_uv(plays),
                share: mean(plays.map(|play| play.share)),
                standing: self.standing(number),
            })
            .filter(|it| it.share > 0.0)
    }

    fn creep(&self) -> Option<Creep> {
        let creep = self.calibration.compensation.creep;
        let number = self.numbers().find(|it| it.quantity == Quantity::Creep)?;
        let standing = self.standing(number);
        (creep != Relaxation::NONE).then_some(Creep { time_s: creep.time_s, share: creep.share, standing })
    }
}

impl NumberName {
    fn of(number: &Number) -> Self {
        let channels = CHANNEL_NAMES.map(str::to_owned);
        let threshold_uv = match number.quantity {
            Quantity::Friction { threshold_uv } => Some(threshold_uv),
            _ => None,
        };
        let (target, with) = (number.target.name(&channels), number.target.with(&channels));
        Self { name: number.quantity.name(), target, with, threshold_uv }
    }
}

impl Serialize for FoundPad {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        self.document().serialize(to)
    }
}

/// Which number, in words: `m1z's gain`.
fn words(number: &Number) -> String {
    let channels = CHANNEL_NAMES.map(str::to_owned);
    let from = number.target.with(&channels).map(|it| format!(" from {it}")).unwrap_or_default();
    format!("{}'s {}{from}", number.target.name(&channels), number.quantity.words())
}

/// The kind under which a number without a column is counted.
const fn kind_of(quantity: Quantity) -> Option<&'static str> {
    match quantity {
        Quantity::Physical(_) => Some("poses and stiffnesses"),
        Quantity::Crosstalk => Some("crosstalks"),
        Quantity::Friction { .. } => Some("frictions"),
        Quantity::Creep => Some("creep"),
        Quantity::Blur => Some("blur"),
        Quantity::Ageing => Some("ageing"),
        Quantity::Rig(_) => Some("errors of the rig"),
        Quantity::Gain | Quantity::GainSlope | Quantity::Zero => None,
    }
}

/// Behind a number that only the prior holds.
fn mark(number: &Number) -> &'static str {
    match number.told_by() {
        ToldBy::Data => "",
        ToldBy::Prior => "*",
    }
}

impl fmt::Display for FoundPad {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "\n{}\n", self.named)?;
        let heading = "The decoder's own coefficients. They serve the decoder and are no findings. ± is one \
                       standard deviation, if the pad differs in nothing but the fit's numbers; * is held by the \
                       prior, not by the data.";
        writeln!(f, "{}", hanging("", heading))?;
        self.write_channels(f)?;
        if let Some(thermal) = &self.calibration.thermal {
            FoundThermal::of(thermal).fmt(f)?;
        }
        self.write_named(f)?;
        writeln!(f, "{}", hanging("", &self.nameless()))?;
        self.write_pairs(f)?;
        if let Some((module, flaw)) = self.calibration.flaw {
            let fitted = format!(
                "The field is that of a pad whose module {module} has the flaw \"{flaw}\": with any crosstalk of a whole module in \
                 its place the contacts are less likely. It serves the decoder and is no finding."
            );
            writeln!(f, "{}", hanging("", &fitted))?;
        }
        for open in &self.calibration.open_by_rig {
            writeln!(f, "{}", hanging("", &OpenNumber::of(open).words()))?;
        }
        for check in self.calibration.checks.iter().filter(|it| it.is_missed()) {
            writeln!(f, "{}", hanging("", &CheckResult::of(check).words()))?;
        }
        let widening = self.calibration.widening;
        if widening > 1.0 {
            let widened = format!(
                "The deviations that the decoder states are {widening:.2} times the fit's, for that."
            );
            writeln!(f, "{}", hanging("", &widened))?;
        }
        write!(f, "smooth background: {:.1} % of each map", 100.0 * self.calibration.background)?;
        let is_earlier = self.calibration.from_earlier;
        if is_earlier { write!(f, ", beside the earlier pad's field") } else { Ok(()) }
    }
}

impl FoundPad {
    /// The numbers of one kind, channel by channel.
    fn by_channel(&self, quantity: Quantity) -> Vec<&Number> {
        self.numbers().filter(|it| it.quantity == quantity).collect()
    }

    fn write_channels(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let noise = &self.calibration.noise;
        let (gains, zeros) = (self.by_channel(Quantity::Gain), self.by_channel(Quantity::Zero));
        let untouched = if zeros.is_empty() { "" } else { "  untouched µV" };
        writeln!(f, "channel           gain  noise µV  noise %{untouched}")?;
        for (k, (name, gain)) in CHANNEL_NAMES.iter().zip(&gains).enumerate() {
            let told = format!("{:.3} ± {:.3}{:1}", gain.value, gain.deviation, mark(gain));
            let (noise_uv, share) = (noise.additive_uv[k], 100.0 * noise.share[k]);
            write!(f, "{name:<7} {told:>14} {noise_uv:>9.1} {share:>8.2}")?;
            if let Some(zero) = zeros.get(k) {
                let told = format!("{:.0} ± {:.0}{}", zero.value, zero.deviation, mark(zero));
                write!(f, "  {told:>12}")?;
            }
            writeln!(f)?;
        }
        Ok(())
    }

    /// Whether a number has no column of its own.
    const fn is_other(number: &Number) -> bool {
        !matches!(number.quantity, Quantity::Gain | Quantity::Zero | Quantity::GainSlope)
    }

    /// The numbers without a column whose cause is named.
    fn write_named(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for number in self.numbers().filter(|it| Self::is_other(it) && self.named.names(it)) {
            let (value, deviation) = (number.value, number.deviation);
            writeln!(f, "{:<45} {value:+.3} ± {deviation:.3}{}", words(number), mark(number))?;
        }
        Ok(())
    }

    /// How many others there are, and how many of them the data hold.
    fn nameless(&self) -> String {
        let kinds = [
            "poses and stiffnesses",
            "crosstalks",
            "frictions",
            "creep",
            "blur",
            "ageing",
            "errors of the rig",
        ];
        let counted = kinds.into_iter().filter_map(|kind| {
            let is_of_kind = |it: &&Number| kind_of(it.quantity) == Some(kind) && !self.named.names(it);
            let of_kind: Vec<&Number> = self.numbers().filter(is_of_kind).collect();
            let told = of_kind.iter().filter(|it| it.told_by() == ToldBy::Data).count();
            match of_kind.len() {
                0 => None,
                1 => Some(format!("{kind} ({told})")),
                count => Some(format!("{count} {kind} ({told})")),
            }
        });
        format!(
            "Further numbers of the fit, in brackets how many the data hold and not the prior: {}. They take up what \
             no named cause explains and are no findings; --json has them all.",
            counted.collect::<Vec<_>>().join(", ")
        )
    }

    /// Writes the pairs of numbers that the data do not tell apart.
    fn write_pairs(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let pairs = &self.calibration.not_told_apart;
        for Pair { places, .. } in pairs.iter().take(PAIRS_SAID) {
            let [one, other] = places.map(|at| words(&self.calibration.numbers[at]));
            writeln!(f, "{}", hanging("", &format!("The data cannot tell {one} from {other}.")))?;
        }
        let more = pairs.len().saturating_sub(PAIRS_SAID);
        if more > 0 {
            writeln!(f, "Nor do they tell apart {more} more pairs; --json has them.")
        } else {
            Ok(())
        }
    }
}
