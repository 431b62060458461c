//! A force that presses from one threshold on, and releases below another or as soon as it eases.

/// Whether a force presses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Gate {
    /// It does not.
    Off,
    /// It does, and was this high since then.
    On { highest_n: f32 },
    /// It has eased and was this low since then.
    Eased { lowest_n: f32 },
}

/// The forces of a gate, in newtons.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Thresholds {
    /// On from here,
    pub(crate) press_n: f32,
    /// off below this.
    pub(crate) release_n: f32,
    /// Off, too, so much below the highest, and on again so much above the lowest.
    pub(crate) hair_n: Option<f32>,
}

/// What the forces say of a button.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touch {
    /// Whether the button's force is on.
    pub(crate) is_on: bool,
    /// Whether it is hard.
    pub(crate) is_hard: bool,
    /// Whether the contact is where the button counts; a lifted one is where it was.
    pub(crate) is_in_place: bool,
}

impl Gate {
    /// Whether it is on with this force; `None` means that the contact has ended.
    pub(crate) fn step(&mut self, thresholds: Thresholds, force_n: Option<f32>) -> bool {
        let Thresholds { press_n, release_n, hair_n } = thresholds;
        *self = match (*self, force_n) {
            (_, None) => Self::Off,
            (Self::On { .. } | Self::Eased { .. }, Some(n)) if n < release_n => Self::Off,
            (Self::Off, Some(n)) => {
                if n >= press_n {
                    Self::On { highest_n: n }
                } else {
                    Self::Off
                }
            }
            (Self::On { highest_n }, Some(n)) => match hair_n {
                Some(hair_n) if n <= highest_n - hair_n => Self::Eased { lowest_n: n },
                _ => Self::On { highest_n: highest_n.max(n) },
            },
            (Self::Eased { lowest_n }, Some(n)) => match hair_n {
                Some(hair_n) if n < lowest_n + hair_n => Self::Eased { lowest_n: lowest_n.min(n) },
                _ => Self::On { highest_n: n },
            },
        };
        self.is_on()
    }

    /// Whether it is on.
    pub(crate) const fn is_on(self) -> bool {
        matches!(self, Self::On { .. })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on(hair_n: Option<f32>, forces: &[f32]) -> Vec<bool> {
        let mut gate = Gate::Off;
        let thresholds = Thresholds { press_n: 2.0, release_n: 1.0, hair_n };
        forces.iter().map(|n| gate.step(thresholds, Some(*n))).collect()
    }

    #[test]
    fn it_goes_on_at_one_force_and_off_below_another() {
        assert_eq!(on(None, &[1.99, 2.0, 5.0, 1.0, 0.99, 1.99]), [false, true, true, true, false, false]);
        let mut gate = Gate::On { highest_n: 2.0 };
        assert!(!gate.step(Thresholds { press_n: 2.0, release_n: 1.0, hair_n: None }, None));
    }

    #[test]
    fn a_hair_trigger_goes_with_the_turns_of_the_force() {
        let hair = Some(0.25);
        assert_eq!(
            on(hair, &[2.0, 3.0, 2.76, 2.75, 2.5, 2.74, 2.75]),
            [true, true, true, false, false, false, true]
        );
        // Below the release it takes the whole press again.
        assert_eq!(on(hair, &[2.0, 0.9, 1.5, 1.99, 2.0]), [true, false, false, false, true]);
    }
}
