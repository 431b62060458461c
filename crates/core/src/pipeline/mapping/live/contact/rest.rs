//! A hand that rests on the pad: load that came slowly, or is light, is no touch.

use crate::pipeline::mapping::profile::RestRejection;
use crate::quantity::Contact;
use crate::time::StreamInstant;

/// Of the force that makes a touch, what is left when it ends.
const END_SHARE: f32 = 2.0 / 3.0;

/// The load that rests, and whether there is a touch on top of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RestDetector {
    resting_n: f32,
    at: StreamInstant,
    /// Since when there is no touch; while there is one, the last sample.
    since: StreamInstant,
    is_touch: bool,
}

/// What a contact is taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Load {
    /// A touch.
    Touch,
    /// A hand that rests, or a touch that has not come to its force yet.
    Rest {
        /// Whether it has lasted for `rest.us` with this sample, for the first time since a lift or a touch.
        is_news: bool,
    },
}

impl RestDetector {
    /// What the contact at `t` is. A touch: its force is by `rest.n` above the load that rests, which follows it as long as it is none:
    /// db/dt = (Fz − b)/τ. So load that grows by less than n/τ never is one. `None` is a pad that nothing has lain on since the last lift.
    pub(crate) fn step(
        resting: &mut Option<Self>,
        rest: RestRejection,
        t: StreamInstant,
        contact: &Contact,
    ) -> Load {
        let before = resting.unwrap_or(Self { resting_n: 0.0, at: t, since: t, is_touch: false });
        let above_n = contact.fz_n - before.resting_n;
        let is_touch = above_n >= if before.is_touch { END_SHARE * rest.n } else { rest.n };
        let elapsed = t.us_since(before.at) as f32 / rest.us.max(1) as f32;
        // What is lighter than the load that rested is what rests now.
        let follows = if above_n < 0.0 { 1.0 } else { 1.0 - libm::expf(-elapsed) };
        let resting_n = before.resting_n + if is_touch { 0.0 } else { above_n * follows };
        let since = if is_touch || before.is_touch { t } else { before.since };
        *resting = Some(Self { resting_n, at: t, since, is_touch });
        if is_touch {
            return Load::Touch;
        }
        Load::Rest { is_news: t.us_since(since) >= rest.us && before.at.us_since(since) < rest.us }
    }
}
