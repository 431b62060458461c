//! What is hidden: cause, place and size, in the program's own words.

use serde_json::{Map, Value, json};

/// The channels in the wire's order.
pub(crate) const CHANNELS: [&str; 9] = ["m0x", "m0y", "m0z", "m1x", "m1y", "m1z", "m2x", "m2y", "m2z"];

/// One cause that is hidden in a measured table.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Truth {
    pub(crate) effect: String,
    pub(crate) target: String,
    /// The source of a leak, or the other of two swapped channels.
    pub(crate) with: Option<String>,
    /// The side of a module, as `-x`.
    pub(crate) side: Option<String>,
    pub(crate) parameters: Vec<(String, f64)>,
}

impl Truth {
    pub(crate) fn new(effect: &str, target: &str, parameters: &[(&str, f64)]) -> Self {
        let parameters = parameters.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
        Self { effect: effect.to_owned(), target: target.to_owned(), with: None, side: None, parameters }
    }

    pub(crate) fn with(mut self, source: &str) -> Self {
        self.with = Some(source.to_owned());
        self
    }

    pub(crate) fn on(mut self, side: &str) -> Self {
        self.side = Some(side.to_owned());
        self
    }

    /// A parameter's value.
    ///
    /// # Panics
    /// The cause has no such parameter.
    pub(crate) fn value(&self, name: &str) -> f64 {
        let found = self.parameters.iter().find(|(own, _)| own == name);
        found.unwrap_or_else(|| panic!("{} has no {name}", self.effect)).1
    }

    /// A parameter's value, 0 where the cause does not have it.
    pub(crate) fn value_or_zero(&self, name: &str) -> f64 {
        self.parameters.iter().find(|(own, _)| own == name).map_or(0.0, |(_, value)| *value)
    }

    /// The channels that the target stands for: one, a module's three, or all.
    pub(crate) fn channels(&self) -> Vec<usize> {
        match channel(&self.target) {
            Some(one) => vec![one],
            None => {
                module(&self.target).map_or((0..9).collect(), |module| (3 * module..3 * module + 3).collect())
            }
        }
    }

    /// # Panics
    /// The target is not a module.
    pub(crate) fn module(&self) -> usize {
        module(&self.target).unwrap_or_else(|| panic!("{} is no module", self.target))
    }

    pub(crate) fn json(&self) -> Value {
        let parameters: Map<String, Value> =
            self.parameters.iter().map(|(name, value)| (name.clone(), json!(value))).collect();
        let mut document = json!({"effect": self.effect, "target": self.target, "parameters": parameters});
        for (key, value) in [("with", &self.with), ("side", &self.side)] {
            if let Some(value) = value {
                document[key] = json!(value);
            }
        }
        document
    }
}

/// A channel's place in the wire's order.
pub(crate) fn channel(name: &str) -> Option<usize> {
    CHANNELS.iter().position(|channel| *channel == name)
}

/// The index of `module0`, `module1`, `module2`.
pub(crate) fn module(name: &str) -> Option<usize> {
    name.strip_prefix("module")?.parse().ok().filter(|index| *index < 3)
}
