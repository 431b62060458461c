//! Keys that go down together.

use crate::pipeline::control::{Code, OutputDevice};

/// The most keys that one press gives at once.
pub const KEYS_MAX: usize = 4;

/// Binding of a control: one key, or one axis pushed to a position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Binding {
    /// The device it is on.
    pub device: OutputDevice,
    /// The key or axis.
    pub code: Code,
    /// 1 for keys, −1 or 1 for the hat and the wheel.
    pub value: i32,
}

/// Controls that go down and up together, the first one first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Keys {
    all: [Option<Binding>; KEYS_MAX],
}

impl Keys {
    /// The first [`KEYS_MAX`] of these.
    pub fn new(bindings: impl IntoIterator<Item = Binding>) -> Self {
        let mut all = [None; KEYS_MAX];
        all.iter_mut().zip(bindings).for_each(|(place, binding)| *place = Some(binding));
        Self { all }
    }

    /// In their order.
    pub fn iter(&self) -> impl Iterator<Item = Binding> + use<> {
        self.all.into_iter().flatten()
    }
}
