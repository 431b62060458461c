//! What the pad's light says.

/// What the pad is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// It was asked to show itself: five flashes a second.
    Shown,
    /// The converters do not answer, or the supply is wrong: two short flashes, a pause.
    Fault,
    /// It restarted by itself: three short flashes, a pause.
    Restarted,
    /// No host has set it up: a short flash every second.
    Alone,
    /// The host sleeps: dark.
    Asleep,
    /// It sends: lit.
    Sending,
}

impl State {
    /// Whether the light is on at this time.
    #[must_use]
    pub const fn is_lit(self, time_ms: u64) -> bool {
        match self {
            Self::Shown => time_ms % 200 < 100,
            Self::Fault => matches!(time_ms % 1_000, 0..100 | 200..300),
            Self::Restarted => matches!(time_ms % 1_000, 0..100 | 200..300 | 400..500),
            Self::Alone => time_ms % 1_000 < 50,
            Self::Asleep => false,
            Self::Sending => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_state_is_lit_for_its_share_of_a_second() {
        let lit_ms = |state: State| (0..1_000).filter(|time_ms| state.is_lit(*time_ms)).count();
        let states =
            [State::Shown, State::Fault, State::Restarted, State::Alone, State::Asleep, State::Sending];
        assert_eq!(states.map(lit_ms), [500, 200, 300, 50, 0, 1_000]);
    }
}
