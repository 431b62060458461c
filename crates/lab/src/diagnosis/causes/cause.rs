//! What a row of the catalogue says of a cause.

use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::memory::Dwells;
use crate::diagnosis::model::setting::Setting;
use crate::effect::Effect;
use tactpad_inference::hypothesis::Parameter;

/// Where in the chain a cause acts first. What lies before it need not be computed anew.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ChainStage {
    /// On the contact itself.
    Contact,
    /// On the strains under it.
    Mechanics,
    /// On what modules take of each other's strains.
    Coupling,
    /// On the channels.
    Channels,
}

/// Where a cause may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Places {
    Channels,
    /// From each channel into each other one.
    ChannelPairs,
    Modules,
    /// From each module into each other one.
    ModulePairs,
    ModuleSides,
    Pad,
    /// The pad, where its channels answer to a field.
    PadWithField,
    /// Each channel, and the pad as a whole.
    PadAndChannels,
    /// The pad; each channel only where loads were reached from both sides, as else its hysteresis is a gain, or bends it.
    PadAndChannelsBothWays,
    /// The pad; each channel only where loads are not all held equally long, as else its creep is a gain.
    PadAndChannelsHeld,
    Rig,
}

impl Places {
    fn targets(self, setting: &Setting) -> Vec<Target> {
        let pairs = |count: usize| {
            let all = (0..count).flat_map(move |into| (0..count).map(move |from| (into, from)));
            all.filter(|(into, from)| into != from)
        };
        let pad_and_channels = |are_told_apart: bool| {
            let channels = setting.each_channel().take(if are_told_apart { usize::MAX } else { 0 });
            std::iter::once(Target::Pad).chain(channels).collect()
        };
        match self {
            Self::Channels => setting.each_channel().collect(),
            Self::ChannelPairs => {
                pairs(setting.channels).map(|(into, from)| Target::Channels { into, from }).collect()
            }
            Self::Modules => setting.each_module().collect(),
            Self::ModulePairs => {
                pairs(setting.modules).map(|(into, from)| Target::Modules { into, from }).collect()
            }
            Self::ModuleSides => setting.each_side(),
            Self::Pad => vec![Target::Pad],
            Self::PadWithField if setting.has_field => vec![Target::Pad],
            Self::PadWithField => Vec::new(),
            Self::PadAndChannels => pad_and_channels(true),
            Self::PadAndChannelsBothWays => pad_and_channels(setting.has_both_ways),
            Self::PadAndChannelsHeld => {
                pad_and_channels(setting.has_series || setting.dwells == Dwells::Different)
            }
            Self::Rig => setting.rig(),
        }
    }
}

/// What a cause cannot be seen without.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Need {
    /// Time that goes on from row to row.
    Time,
    /// Temperatures that differ.
    Temperatures,
    /// Cycles of load that differ.
    Cycles,
    /// Rows that are a time series.
    Series,
    /// How long loads were held, or a time series.
    Dwells,
}

impl Need {
    const fn is_met(self, setting: &Setting) -> bool {
        match self {
            Self::Time => setting.has_time,
            Self::Temperatures => setting.has_temperature,
            Self::Cycles => setting.has_cycles,
            Self::Series => setting.has_series,
            Self::Dwells => setting.has_series || !matches!(setting.dwells, Dwells::Unknown),
        }
    }

    /// The table's column that has it.
    const fn column(self) -> &'static str {
        match self {
            Self::Time => "t_s",
            Self::Temperatures => "temp_c",
            Self::Cycles => "cycle",
            Self::Series => "trial",
            Self::Dwells => "dwell_s",
        }
    }
}

/// Puts a cause into the chain, with these values of its numbers.
type Apply = fn(&Target, &[f64], &Setting, &mut Chain);

/// A cause of a difference between a pad and its model.
pub(crate) struct Cause {
    /// Its name in reports.
    pub(crate) effect: Effect,
    /// Where it acts first.
    pub(crate) stage: ChainStage,
    places: Places,
    parameters: fn(&Setting) -> Vec<Parameter>,
    apply: Apply,
    need: Option<Need>,
    /// Whether each target has its own by make or by wear. Several at once of another cause call for one reason.
    pub(crate) is_individual: bool,
    /// Standard deviation of its first number in any pad; 0 where it is there or is not.
    pub(crate) prior_deviation: f64,
}

impl Cause {
    pub(super) const fn new(
        effect: Effect,
        stage: ChainStage,
        places: Places,
        parameters: fn(&Setting) -> Vec<Parameter>,
        apply: Apply,
    ) -> Self {
        Self {
            effect,
            stage,
            places,
            parameters,
            apply,
            need: None,
            is_individual: false,
            prior_deviation: 0.0,
        }
    }

    pub(super) const fn with(self, need: Need) -> Self {
        Self { need: Some(need), ..self }
    }

    pub(super) const fn prior_deviation(self, prior_deviation: f64) -> Self {
        Self { prior_deviation, ..self }
    }

    pub(super) const fn individual(self) -> Self {
        Self { is_individual: true, ..self }
    }

    /// Its numbers.
    pub(crate) fn parameters(&self, setting: &Setting) -> Vec<Parameter> {
        (self.parameters)(setting)
    }

    /// The places where it may be.
    pub(crate) fn targets(&self, setting: &Setting) -> Vec<Target> {
        self.places.targets(setting)
    }

    /// The column without which it cannot be seen, if that is missing or stays the same.
    pub(crate) fn missing(&self, setting: &Setting) -> Option<&'static str> {
        self.need.filter(|need| !need.is_met(setting)).map(Need::column)
    }

    /// Puts it into the chain, with these values of its numbers.
    pub(crate) fn apply(&self, target: &Target, values: &[f64], setting: &Setting, chain: &mut Chain) {
        (self.apply)(target, values, setting, chain);
    }
}
