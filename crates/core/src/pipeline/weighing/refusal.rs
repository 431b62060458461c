//! Why a weighing tells nothing, for people: what is wrong, and the way out.

use std::fmt;

/// Why a weighing tells nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum WeighError {
    /// No pad is heard, or none that can be played with.
    NoPad,
    /// It has not the nine channels whose common gain a weight tells.
    NoNineChannels,
    /// The pad's zero was not known in time.
    NoZero,
    /// Nothing came to lie on the pad.
    NothingCame,
    /// Something lay there and did not rest.
    NotSteady,
    /// What rests presses with a force that is not the weight's, however old the pad is.
    OtherForce {
        /// Force by the decoder, N.
        force_n: f64,
        /// The weight that was told.
        weight_g: f64,
    },
    /// It stands at the rim of the plate or beyond it.
    OverRim,
    /// It is not one load on the decoder's pad.
    NotOneLoad,
    /// Frames or channels failed twice while it was weighed.
    Faults,
    /// The pad left, began anew or was tared meanwhile.
    Interrupted,
}

impl fmt::Display for WeighError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NoPad => "no pad is heard: plug it in, leave it untouched for a moment, and weigh again",
            Self::NoNineChannels => {
                "this pad has not the nine channels of a strain pad: what it reads of a known weight stands in its description \
                 (`tactpad source show`)"
            }
            Self::NoZero => {
                "the pad's zero is not known yet: take everything off it, wait a second, and weigh again"
            }
            Self::NothingCame => "no load came: weigh again, and put the weight on the plate within ten seconds",
            Self::NotSteady => {
                "what lay on the pad did not rest for two seconds: put the weight down, take the hand away, and weigh again"
            }
            Self::OtherForce { force_n, weight_g } => {
                return write!(
                    f,
                    "what lies there reads as {force_n:.2} N, and no pad changes so much that {weight_g} g do: check the weight \
                     and that nothing else touches the plate, or calibrate the pad anew"
                );
            }
            Self::OverRim => "the weight stands at the plate's rim: put it farther inwards, and weigh again",
            Self::NotOneLoad => {
                "what lies there is not one load on the decoder's pad: leave nothing but the weight on the plate, on one foot; if \
                 it is so, a part of the pad is at fault or the decoder is another pad's"
            }
            Self::Faults => "frames or channels failed while it was weighed: check the line, and weigh again",
            Self::Interrupted => {
                "the pad left, began anew or was tared while it was weighed: leave it untouched for a moment, and weigh again"
            }
        })
    }
}

impl std::error::Error for WeighError {}
