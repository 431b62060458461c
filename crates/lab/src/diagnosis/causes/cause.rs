//! Interface of a cause.

use crate::diagnosis::data::target::Target;
use crate::diagnosis::model::Parameter;
use crate::diagnosis::model::chain::Chain;
use crate::diagnosis::model::setting::Setting;

/// Where in the chain a cause acts first. What lies before it need not be computed anew.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ChainStage {
    /// On the contact itself.
    Contact,
    /// On the strains under it.
    Mechanics,
    /// On the channels.
    Channels,
}

/// A cause of a difference between a pad and its model.
pub(crate) trait Cause: Sync {
    /// Its name in reports.
    fn effect(&self) -> &'static str;
    /// Its numbers.
    fn parameters(&self, setting: &Setting) -> Vec<Parameter>;
    /// Where it acts first.
    fn stage(&self) -> ChainStage;
    /// The places where it may be.
    fn targets(&self, setting: &Setting) -> Vec<Target>;
    /// The column without which it cannot be seen, if that is missing or stays the same.
    fn missing(&self, _setting: &Setting) -> Option<&'static str> {
        None
    }
    /// Whether each target has its own by make or by wear. Several at once of another cause call for one reason.
    fn is_individual(&self) -> bool {
        false
    }
    /// Puts it into the chain, with these values of its numbers.
    fn apply(&self, target: &Target, values: &[f64], setting: &Setting, chain: &mut Chain);
}

/// Sets a number of each channel: of one, or of all for [`Target::Pad`].
pub(crate) fn each_channel(target: &Target, numbers: &mut [f64], value: f64) {
    match *target {
        Target::Channel(channel) => numbers[channel] += value,
        _ => numbers.iter_mut().for_each(|number| *number += value),
    }
}

/// The channels of a target: one, or all.
pub(crate) fn channels_of(target: &Target, setting: &Setting) -> std::ops::Range<usize> {
    match *target {
        Target::Channel(channel) => channel..channel + 1,
        _ => 0..setting.channels,
    }
}

/// All channels, and the pad as a whole.
pub(crate) fn pad_and_channels(setting: &Setting) -> Vec<Target> {
    std::iter::once(Target::Pad).chain(setting.each_channel()).collect()
}
