//! Interruptions of the stream of contacts, and what becomes of each part of the pipeline then: one table.

use crate::pipeline::link::Fault;

/// Why the stream of contacts does not just go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Cause {
    /// The pad was unplugged: what comes next may be another one.
    Unplugged,
    /// The link fell silent; it is the same pad, and what happens to it meanwhile is not known.
    Lost,
    /// The pad began anew.
    Restarted,
    /// The pad identified itself, with another scale than was thought.
    Rescaled,
    /// The pad identified itself, with the scale that was thought.
    Identified,
    /// The pad identified itself as another one than before, though it was not unplugged.
    Exchanged,
    /// The pad identified itself with numbers that no pad of ours has.
    Unsuitable,
    /// The pad speaks a newer version of the protocol.
    NewerVersion,
    /// Frames were lost, or one repeated, or the pad's clock jumped.
    Discontinuity,
    /// A channel of this sample cannot be trusted.
    Faulty,
    /// The zero is being measured: this sample has none.
    Taring,
    /// What looks like a touch is a wrong zero.
    Drifted,
    /// A channel read by itself, which is no load; its zero is known anew.
    Stray,
    /// A channel of this touch cannot be believed.
    Doubted,
    /// The zero was measured with something on the pad.
    Loaded,
    /// The player has the zero measured again.
    Retared,
    /// The player paused, or released everything.
    Released,
    /// The player begins to weigh a known weight.
    Weighing,
}

/// What becomes of a part of the pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// It goes on as if nothing had happened.
    Keep,
    /// What is under way ends. What was learnt stays, but is not certain any more.
    Doubt,
    /// It begins anew.
    Forget,
}

/// What becomes of all parts. Scale, gain, filter and thermometer have nothing to doubt: they are kept or forgotten.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effects {
    /// What a count means.
    pub scale: Effect,
    /// By how much the pad's readings have changed since the calibration: it belongs to the pad.
    pub gain: Effect,
    /// What was learnt of the raw channels; in doubt, what was learnt at rest is forgotten.
    pub channels: Effect,
    /// The mean filter.
    pub filter: Effect,
    /// What the untouched pad reads; in doubt, it is less load than what was thought.
    pub zero: Effect,
    /// What the pad remembers of earlier loads; in doubt, it may be anything, and is thought to be what it was.
    pub memory: Effect,
    /// The temperature that is followed.
    pub thermometer: Effect,
    /// The touch; in doubt, it ends.
    pub touch: Effect,
    /// The weight of who stands on the pad; in doubt, the weighing that is under way begins anew.
    pub standing: Effect,
    /// What is watched for warnings; in doubt, the stretch of time that was begun is not gone on with.
    pub watch: Effect,
    /// A weighing that is under way; in doubt, its mean begins anew, and a second time ends it. Forgotten, it ends.
    pub weighing: Effect,
    /// The contact that is mapped; in doubt, it ends, presses are forgotten, everything is released at once, and contacts
    /// are not believed for a while.
    pub contact: Effect,
}

impl Cause {
    /// What becomes of each part.
    #[rustfmt::skip]
    pub const fn effects(self) -> Effects {
        use Effect::{Doubt, Forget, Keep};
        let [scale, gain, channels, filter, zero, memory, thermometer, touch, standing, watch, weighing, contact] = match self {
            //                     scale   gain    channels filter  zero    memory  thermo. touch   standing  watch   weighing contact
            Self::Unplugged    => [Forget, Forget, Forget,  Forget, Forget, Forget, Forget, Doubt,  Forget,   Forget, Forget,  Doubt],
            Self::Lost         => [Keep,   Keep,   Keep,    Forget, Keep,   Doubt,  Keep,   Doubt,  Doubt,    Doubt,  Forget,  Doubt],
            Self::Restarted    => [Keep,   Keep,   Forget,  Forget, Forget, Doubt,  Keep,   Forget, Forget,   Doubt,  Forget,  Doubt],
            // The new scale is set; whatever was measured in the old one is of no use.
            Self::Rescaled     => [Keep,   Forget, Forget,  Forget, Forget, Doubt,  Keep,   Forget, Forget,   Doubt,  Forget,  Doubt],
            Self::Identified   => [Keep,   Keep,   Keep,    Keep,   Keep,   Doubt,  Keep,   Forget, Doubt,    Doubt,  Doubt,   Doubt],
            Self::Exchanged    => [Keep,   Forget, Forget,  Forget, Forget, Forget, Forget, Forget, Forget,   Forget, Forget,  Doubt],
            Self::Unsuitable   => [Keep,   Keep,   Keep,    Keep,   Keep,   Keep,   Keep,   Forget, Forget,   Doubt,  Forget,  Doubt],
            Self::NewerVersion => [Keep,   Keep,   Keep,    Keep,   Keep,   Keep,   Keep,   Keep,   Doubt,    Doubt,  Forget,  Doubt],
            Self::Discontinuity => [Keep,   Keep,   Keep,    Forget, Keep,   Keep,   Keep,   Keep,   Doubt,    Doubt,  Doubt,   Doubt],
            Self::Faulty       => [Keep,   Keep,   Keep,    Forget, Keep,   Keep,   Keep,   Keep,   Doubt,    Doubt,  Doubt,   Doubt],
            // There is no contact, which is certain: it is mapped as a lift.
            Self::Taring       => [Keep,   Keep,   Keep,    Keep,   Keep,   Keep,   Keep,   Keep,   Doubt,    Doubt,  Keep,    Keep],
            // Memory that was followed from a wrong zero is wrong, too. The touch has begun anew by itself, and is lifted.
            Self::Drifted      => [Keep,   Keep,   Doubt,   Keep,   Forget, Forget, Keep,   Keep,   Forget,   Keep,   Keep,    Keep],
            Self::Stray        => [Keep,   Keep,   Keep,    Forget, Keep,   Forget, Keep,   Forget, Doubt,    Doubt,  Doubt,   Doubt],
            // What memory followed is wrong. The touch is looked at as long as it lasts.
            Self::Doubted      => [Keep,   Keep,   Keep,    Keep,   Keep,   Forget, Keep,   Keep,   Doubt,    Doubt,  Doubt,   Doubt],
            Self::Loaded       => [Keep,   Keep,   Doubt,   Keep,   Doubt,  Forget, Keep,   Keep,   Forget,   Doubt,  Keep,    Keep],
            // A weight that lies there would be the new zero.
            Self::Retared      => [Keep,   Keep,   Doubt,   Keep,   Forget, Keep,   Keep,   Forget, Forget,   Doubt,  Forget,  Doubt],
            // A paused pad can be weighed on, too: nothing is pressed either way.
            Self::Released     => [Keep,   Keep,   Keep,    Keep,   Keep,   Keep,   Keep,   Keep,   Keep,     Doubt,  Keep,    Doubt],
            Self::Weighing     => [Keep,   Keep,   Keep,    Keep,   Keep,   Keep,   Keep,   Keep,   Keep,     Doubt,  Keep,    Doubt],
        };
        Effects { scale, gain, channels, filter, zero, memory, thermometer, touch, standing, watch, weighing, contact }
    }
}

impl From<Fault> for Cause {
    fn from(fault: Fault) -> Self {
        if fault == Fault::Restarted { Self::Restarted } else { Self::Discontinuity }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Cause; 18] = [
        Cause::Unplugged,
        Cause::Lost,
        Cause::Restarted,
        Cause::Rescaled,
        Cause::Identified,
        Cause::Exchanged,
        Cause::Unsuitable,
        Cause::NewerVersion,
        Cause::Discontinuity,
        Cause::Faulty,
        Cause::Taring,
        Cause::Drifted,
        Cause::Stray,
        Cause::Doubted,
        Cause::Loaded,
        Cause::Retared,
        Cause::Released,
        Cause::Weighing,
    ];

    #[test]
    fn what_cannot_be_doubted_is_kept_or_forgotten() {
        for cause in ALL {
            let Effects { scale, gain, filter, thermometer, .. } = cause.effects();
            assert!(![scale, gain, filter, thermometer].contains(&Effect::Doubt), "{cause:?}");
        }
    }

    #[test]
    fn what_hangs_on_another_part_goes_with_it() {
        for cause in ALL {
            let Effects { scale, gain, channels, zero, touch, watch, weighing, contact, .. } =
                cause.effects();
            let keeps = |effect| effect == Effect::Keep;
            assert!(keeps(scale) || !keeps(zero), "{cause:?}: a zero in another scale");
            assert!(keeps(zero) || !keeps(channels), "{cause:?}: a pad at rest that has no zero");
            assert!(keeps(touch) || !keeps(contact), "{cause:?}: a contact without a touch");
            assert!(keeps(contact) || !keeps(watch), "{cause:?}: a contact that ended is watched");
            assert!(keeps(gain) || !keeps(zero), "{cause:?}: another pad with the zero of this one");
            assert!(
                keeps(gain) || weighing == Effect::Forget,
                "{cause:?}: another pad under the same weight"
            );
        }
    }
}
