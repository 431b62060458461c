//! Which decoders are compared, and what each learns from.

use std::fmt;

use serde::{Serialize, Serializer};

use crate::metrology::table3::{
    LINEAR_648, LINEAR_SIMULATED, NEIGHBOURS_648, NEIGHBOURS_SIMULATED, NETWORK_216, NETWORK_360,
    NETWORK_504, NETWORK_648, NETWORK_SIMULATED, PublishedErrors,
};
use tactpad_core::network::Zero;

/// Contacts of the paper's plan.
pub const CONTACTS: usize = 648;

/// Those of them that are normal; they come first.
const NORMAL: usize = 216;

/// A way from channels to a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Balance of forces and moments, with the numbers inside the program.
    Statics,
    /// The paper's.
    Network,
    /// The mean of the five nearest contacts.
    Knn,
    /// Linear functions of the channels.
    Linear,
    /// Linear functions to the wrench, and the place by division.
    Wrench,
    /// The pad's own field, inverted.
    Inverse,
}

/// Contacts to learn from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Samples {
    /// The simulated pad's; nothing is measured.
    Simulated,
    /// The same on raw channels, without a zero taken off, as in the paper.
    Untared,
    /// The first contacts of the paper's plan, by count: all normal ones, then more and more inclined ones.
    First(usize),
    /// Contacts of the paper's plan, by count, drawn as `adapt --rows` draws them.
    Drawn(usize),
    /// All contacts of the paper's plan on raw channels, as in the paper.
    Raw,
}

/// One row of the table.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AblationEntry {
    /// Its kind of decoder.
    pub method: Method,
    /// Its training samples.
    pub samples: Samples,
    /// The paper's published errors.
    pub paper: Option<PublishedErrors>,
    /// Where that is in conflict with the paper's other figures: the distance and force that a pad comes to if all that
    /// blurs its contacts goes to its bound. `docs/network.md` has the pad and what its other figures are then,
    /// `docs/ablation.md` what is no matter of the pad.
    pub conflict: Option<PublishedErrors>,
}

/// The paper's Table 3 in its order, its series of 162 to 648 contacts, and our own decoders.
pub const ENTRIES: &[AblationEntry] = &[
    published(Method::Network, Samples::Untared, NETWORK_SIMULATED),
    entry(Method::Network, Samples::Simulated),
    conflicting(Method::Network, Samples::First(NORMAL), NETWORK_216, errors(2.77, 0.14)),
    conflicting(Method::Network, Samples::First(360), NETWORK_360, errors(1.92, 0.103)),
    conflicting(Method::Network, Samples::First(504), NETWORK_504, errors(1.85, 0.094)),
    entry(Method::Network, Samples::Drawn(162)),
    entry(Method::Network, Samples::Drawn(324)),
    entry(Method::Network, Samples::Drawn(486)),
    conflicting(Method::Network, Samples::Drawn(CONTACTS), NETWORK_648, errors(1.62, 0.084)),
    published(Method::Knn, Samples::Untared, NEIGHBOURS_SIMULATED),
    entry(Method::Knn, Samples::Simulated),
    entry(Method::Knn, Samples::Drawn(20)),
    entry(Method::Knn, Samples::Drawn(73)),
    entry(Method::Knn, Samples::Drawn(216)),
    conflicting(Method::Knn, Samples::Raw, NEIGHBOURS_648, errors(3.8, 0.195)),
    entry(Method::Knn, Samples::Drawn(CONTACTS)),
    published(Method::Linear, Samples::Untared, LINEAR_SIMULATED),
    entry(Method::Linear, Samples::Simulated),
    entry(Method::Linear, Samples::Drawn(20)),
    entry(Method::Linear, Samples::Drawn(73)),
    entry(Method::Linear, Samples::Drawn(216)),
    conflicting(Method::Linear, Samples::Raw, LINEAR_648, errors(7.52, 0.133)),
    entry(Method::Linear, Samples::Drawn(CONTACTS)),
    entry(Method::Wrench, Samples::Drawn(20)),
    entry(Method::Wrench, Samples::Drawn(73)),
    entry(Method::Wrench, Samples::Drawn(216)),
    entry(Method::Wrench, Samples::Drawn(CONTACTS)),
    entry(Method::Statics, Samples::Simulated),
    entry(Method::Inverse, Samples::Simulated),
    entry(Method::Inverse, Samples::Drawn(20)),
    entry(Method::Inverse, Samples::Drawn(73)),
    entry(Method::Inverse, Samples::Drawn(216)),
    entry(Method::Inverse, Samples::Drawn(CONTACTS)),
];

const fn entry(method: Method, samples: Samples) -> AblationEntry {
    AblationEntry { method, samples, paper: None, conflict: None }
}

const fn published(method: Method, samples: Samples, paper: PublishedErrors) -> AblationEntry {
    AblationEntry { paper: Some(paper), ..entry(method, samples) }
}

const fn conflicting(
    method: Method,
    samples: Samples,
    paper: PublishedErrors,
    reached: PublishedErrors,
) -> AblationEntry {
    AblationEntry { conflict: Some(reached), ..published(method, samples, paper) }
}

const fn errors(position_mae_mm: f64, force_mae_n: f64) -> PublishedErrors {
    PublishedErrors { position_mae_mm, force_mae_n }
}

impl Method {
    /// As `adapt` calls it, but for the network.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Statics => "statics",
            Self::Network => "network",
            Self::Knn => "knn",
            Self::Linear => "linear",
            Self::Wrench => "wrench",
            Self::Inverse => "inverse",
        }
    }
}

impl Samples {
    /// Number of measured contacts.
    pub const fn measured(self) -> usize {
        match self {
            Self::Simulated | Self::Untared => 0,
            Self::First(count) | Self::Drawn(count) => count,
            Self::Raw => CONTACTS,
        }
    }

    /// What the channels are relative to that a decoder takes which learnt from them.
    pub const fn zero(self) -> Zero {
        match self {
            Self::Untared | Self::Raw => Zero::Raw,
            Self::Simulated | Self::First(_) | Self::Drawn(_) => Zero::Tared,
        }
    }
}

impl AblationEntry {
    /// What was measured is a sample of all that the plan has.
    pub const fn is_drawn(&self) -> bool {
        matches!(self.samples, Samples::Drawn(_))
    }

    /// It learnt from the whole plan, relative to the untouched pad.
    pub fn has_all(&self) -> bool {
        self.samples == Samples::Drawn(CONTACTS)
    }
}

impl fmt::Display for Samples {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Simulated => f.write_str("simulated"),
            Self::Untared => f.write_str("untared"),
            Self::First(count @ ..=NORMAL) => write!(f, "{count} Fz"),
            Self::First(count) => write!(f, "{NORMAL} Fz + {}", count - NORMAL),
            Self::Drawn(count) => write!(f, "{count}"),
            Self::Raw => write!(f, "{CONTACTS} untared"),
        }
    }
}

impl fmt::Display for AblationEntry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {}", self.method.name(), self.samples)
    }
}

impl Serialize for Samples {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_named_by_what_they_learn_from() {
        let names: Vec<String> = ENTRIES.iter().map(ToString::to_string).collect();
        assert_eq!(
            names[..4],
            ["network, untared", "network, simulated", "network, 216 Fz", "network, 216 Fz + 144"]
        );
        assert_eq!(names.last().map(String::as_str), Some("inverse, 648"));
        assert!(
            names.contains(&"knn, untared".to_owned()) && names.contains(&"linear, 648 untared".to_owned())
        );
        let mut once = names.clone();
        once.sort();
        once.dedup();
        assert_eq!(once.len(), names.len());
    }

    #[test]
    fn what_is_published_gets_better_with_each_contact() {
        let network: Vec<&AblationEntry> =
            ENTRIES.iter().filter(|entry| entry.method == Method::Network && entry.paper.is_some()).collect();
        let falls = |of: fn(&PublishedErrors) -> f64| {
            network.windows(2).all(|pair| {
                let [before, after] = [pair[0], pair[1]].map(|entry| entry.paper.as_ref().map(of));
                pair[0].samples.measured() < pair[1].samples.measured() && before > after
            })
        };
        assert_eq!(network.len(), 5);
        assert!(falls(|paper| paper.position_mae_mm) && falls(|paper| paper.force_mae_n));
    }
}
