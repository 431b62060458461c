//! Channels that stand in each other's place or have the wrong sign, as signed permutations.
//!
//! As text, what people type to mend a pad's wiring: `m0x=m1y,m1y=-m0x` says that what the pad sends as m1y is m0x, and what it sends as
//! m0x is m1y with the other sign. Channels that are not named are what they are sent as.

use std::fmt;
use std::str::FromStr;

use crate::quantity::{CHANNEL_NAMES, CHANNELS, MODULES};

/// Channels of a module.
const AXES: usize = CHANNELS / MODULES;

/// What each channel of the pad is read as: uₖ = σₖ yₚ₍ₖ₎ of the readings y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignedPermutation {
    from: [usize; CHANNELS],
    sign: [f64; CHANNELS],
}

impl SignedPermutation {
    /// As it should be.
    pub const IDENTITY: Self = Self { from: [0, 1, 2, 3, 4, 5, 6, 7, 8], sign: [1.0; CHANNELS] };

    /// `None` where two channels come from one.
    pub fn new(from: [usize; CHANNELS], sign: [f64; CHANNELS]) -> Option<Self> {
        let is_taken = |channel: usize| from.contains(&channel);
        (0..CHANNELS).all(is_taken).then_some(Self { from, sign })
    }

    /// Which reading each channel of the pad comes from, and whether with the other sign.
    pub fn sources(&self) -> [(usize, bool); CHANNELS] {
        std::array::from_fn(|k| (self.from[k], self.sign[k] < 0.0))
    }

    /// The pad's channels by the readings.
    pub fn of(&self, readings: &[f64; CHANNELS]) -> [f64; CHANNELS] {
        std::array::from_fn(|k| self.sign[k] * readings[self.from[k]])
    }

    /// This one of what another one gives.
    pub fn after(&self, first: &Self) -> Self {
        Self {
            from: self.from.map(|from| first.from[from]),
            sign: std::array::from_fn(|k| self.sign[k] * first.sign[self.from[k]]),
        }
    }

    /// The readings by the pad's channels.
    pub fn inverse(&self) -> Self {
        let mut inverse = Self::IDENTITY;
        for (k, from) in self.from.into_iter().enumerate() {
            (inverse.from[from], inverse.sign[from]) = (k, self.sign[k]);
        }
        inverse
    }

    /// Pairs of channels in each other's place, and of a larger circle each channel with the one that it comes from.
    pub fn exchanged(&self) -> Vec<[usize; 2]> {
        let moved = (0..CHANNELS).filter(|k| self.from[*k] != *k);
        let is_first = |k: &usize| *k < self.from[*k] || self.from[self.from[*k]] != *k;
        moved.filter(is_first).map(|k| [k, self.from[k]]).collect()
    }

    /// Channels of the wrong sign.
    pub fn reversed(&self) -> Vec<usize> {
        (0..CHANNELS).filter(|k| self.sign[*k] < 0.0).collect()
    }

    /// How many mistakes it takes: cables of modules, supplies and single channels.
    pub fn mistakes(&self) -> usize {
        let of_module = |module: usize| self.from[AXES * module] / AXES;
        let are_cables = (0..CHANNELS).all(|k| self.from[k] == AXES * of_module(k / AXES) + k % AXES);
        let moved = (0..CHANNELS).filter(|k| self.from[*k] != *k).count();
        let moves = if are_cables { usize::from(moved > 0) } else { moved.div_ceil(2) };
        let signs = |all: f64| {
            let of_module = |module: usize| {
                let reversed = (0..AXES).filter(|axis| all * self.sign[AXES * module + axis] < 0.0).count();
                if reversed == AXES { 1 } else { reversed }
            };
            (0..MODULES).map(of_module).sum::<usize>()
        };
        moves + signs(1.0).min(1 + signs(-1.0))
    }

    /// All that are one mistake: two channels exchanged, one reversed, cables of two modules exchanged or of all three in a circle, a module's
    /// supply reversed.
    pub fn single_mistakes() -> Vec<Self> {
        let exchanged = |pairs: &[[usize; 2]]| {
            let mut exchange = Self::IDENTITY;
            pairs.iter().for_each(|[one, other]| exchange.from.swap(*one, *other));
            exchange
        };
        let reversed = |channels: &[usize]| {
            let mut reversal = Self::IDENTITY;
            channels.iter().for_each(|k| reversal.sign[*k] = -1.0);
            reversal
        };
        let channels = |module: usize| [0, 1, 2].map(|axis| AXES * module + axis);
        let mut all: Vec<Self> = (0..CHANNELS)
            .flat_map(|one| (one + 1..CHANNELS).map(move |other| [one, other]))
            .map(|pair| exchanged(&[pair]))
            .collect();
        for (one, other) in [(0, 1), (0, 2), (1, 2)] {
            let [one, other] = [channels(one), channels(other)];
            all.push(exchanged(&[0, 1, 2].map(|axis| [one[axis], other[axis]])));
        }
        let circle = Self { from: std::array::from_fn(|k| (k + AXES) % CHANNELS), ..Self::IDENTITY };
        all.extend([circle, circle.inverse()]);
        all.extend((0..CHANNELS).map(|k| reversed(&[k])));
        all.extend((0..MODULES).map(|module| reversed(&channels(module))));
        all
    }
}

/// Why a text is no wiring.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum WiringTextError {
    /// Something else stands in place of `CHANNEL=SENT`.
    Entry {
        /// The text in its place.
        entry: String,
    },
    /// A channel is said twice.
    Twice {
        /// Its name.
        channel: &'static str,
    },
    /// Two channels would come from one.
    Shared {
        /// The name of what is sent.
        sent: &'static str,
    },
}

impl fmt::Display for WiringTextError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Entry { entry } => write!(
                f,
                "`{entry}` is not CHANNEL=SENT, as in m0z=-m0z for a reversed channel, or m0x=m1y,m1y=m0x for two exchanged ones"
            ),
            Self::Twice { channel } => write!(f, "{channel} is said twice: leave one out"),
            Self::Shared { sent } => write!(
                f,
                "two channels would be what is sent as {sent}: say of every channel in a circle what it is sent as, as in \
                 m0x=m1y,m1y=m0x"
            ),
        }
    }
}

impl std::error::Error for WiringTextError {}

impl FromStr for SignedPermutation {
    type Err = WiringTextError;

    fn from_str(text: &str) -> Result<Self, WiringTextError> {
        let mut wiring = Self::IDENTITY;
        let mut is_said = [false; CHANNELS];
        let index = |name: &str| CHANNEL_NAMES.iter().position(|known| *known == name);
        for entry in text.split(',') {
            let bad = || WiringTextError::Entry { entry: entry.into() };
            let (channel, sent) = entry.split_once('=').ok_or_else(bad)?;
            let (sent, sign) = sent.strip_prefix('-').map_or((sent, 1.0), |sent| (sent, -1.0));
            let (channel, sent) = index(channel).zip(index(sent)).ok_or_else(bad)?;
            if std::mem::replace(&mut is_said[channel], true) {
                return Err(WiringTextError::Twice { channel: CHANNEL_NAMES[channel] });
            }
            (wiring.from[channel], wiring.sign[channel]) = (sent, sign);
        }
        let users = |sent: usize| wiring.from.iter().filter(|from| **from == sent).count();
        match (0..CHANNELS).find(|sent| users(*sent) > 1) {
            Some(sent) => Err(WiringTextError::Shared { sent: CHANNEL_NAMES[sent] }),
            None => Ok(wiring),
        }
    }
}

/// The channels that are not what they are sent as; nothing where all are.
impl fmt::Display for SignedPermutation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let changed = self.sources().into_iter().enumerate().filter(|(k, from)| *from != (*k, false));
        for (at, (channel, (sent, is_reversed))) in changed.enumerate() {
            let (comma, minus) = (if at > 0 { "," } else { "" }, if is_reversed { "-" } else { "" });
            write!(f, "{comma}{}={minus}{}", CHANNEL_NAMES[channel], CHANNEL_NAMES[sent])?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn permutations_follow_each_other_and_come_back() {
        let readings: [f64; CHANNELS] = std::array::from_fn(|k| 1.0 + k as f64);
        let all = SignedPermutation::single_mistakes();
        assert_eq!(all.len(), 36 + 3 + 2 + 9 + 3);
        for (one, other) in all.iter().zip(all.iter().rev()) {
            assert_eq!(one.after(other).of(&readings), one.of(&other.of(&readings)));
            assert_eq!(one.inverse().of(&one.of(&readings)), readings);
            assert_eq!(one.mistakes(), 1, "{one:?}");
        }
    }

    #[test]
    fn mistakes_are_counted_by_cables_and_supplies() {
        assert_eq!(SignedPermutation::IDENTITY.mistakes(), 0);
        let all_reversed = SignedPermutation { sign: [-1.0; CHANNELS], ..SignedPermutation::IDENTITY };
        assert_eq!((all_reversed.mistakes(), all_reversed.reversed().len()), (1, 9));
        let circle = SignedPermutation::single_mistakes()[39];
        assert_eq!(circle.exchanged().len(), 9);
    }

    #[test]
    fn texts_are_read_as_they_are_written() {
        let read = |text: &str| text.parse::<SignedPermutation>();
        for wiring in SignedPermutation::single_mistakes() {
            assert_eq!(read(&wiring.to_string()), Ok(wiring));
        }
        assert_eq!(SignedPermutation::IDENTITY.to_string(), "");
        let wiring = read("m0x=m1y,m1y=-m0x").unwrap();
        let readings: [f64; CHANNELS] = std::array::from_fn(|k| 1.0 + k as f64);
        assert_eq!(wiring.of(&readings), [5.0, 2.0, 3.0, 4.0, -1.0, 6.0, 7.0, 8.0, 9.0]);
        for (text, wanted) in [
            ("", "`` is not CHANNEL=SENT"),
            ("m0x", "`m0x` is not CHANNEL=SENT"),
            ("m0x=m3x", "`m0x=m3x` is not CHANNEL=SENT"),
            ("m0x=m1y", "two channels would be what is sent as m1y"),
            ("m0x=-m0x,m0x=m0x", "m0x is said twice"),
        ] {
            let told = read(text).unwrap_err().to_string();
            assert!(told.contains(wanted), "{text}: {told}");
        }
    }
}
