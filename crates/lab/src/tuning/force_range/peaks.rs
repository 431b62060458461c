//! The presses of a recording in which somebody presses lightly at first and hard afterwards.

use crate::tuning::trace::{Trace, TraceEvents, TracePoint};

/// Touches that are no farther apart are one press: a light finger that trembles crosses the touch threshold more than once.
const GAP_US: u64 = 100_000;

/// What is shorter is a brush, or noise at the touch threshold.
const PRESS_MIN_US: u64 = 30_000;

/// Of the recording's length, what does not count on either side of its middle: people do not turn from light to hard at once. In 30 s
/// it is one second.
const TURN_SHARE: f64 = 1.0 / 30.0;

/// The highest normal force of each press, in newtons, in order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Peaks {
    /// Of those in the first half.
    pub light_n: Vec<f64>,
    /// Of those in the second.
    pub hard_n: Vec<f64>,
}

impl Peaks {
    /// Those of a recording. Left out are presses near its middle, such as were under way at its begin or end, and such as were
    /// interrupted. Without presses there are none.
    pub fn of(trace: &Trace) -> Self {
        let middle_us = 0.5 * trace.duration_us() as f64;
        let turn_us = 2.0 * TURN_SHARE * middle_us;
        let mut peaks = Self::default();
        for press in presses(trace.moments()) {
            if (press.end_us as f64) < middle_us - turn_us {
                peaks.light_n.push(press.peak_n);
            } else if press.begin_us as f64 > middle_us + turn_us {
                peaks.hard_n.push(press.peak_n);
            }
        }
        peaks
    }

    /// The earlier half of both kinds, and the later one.
    pub fn halves(&self) -> [Self; 2] {
        let [light, hard] = [&self.light_n, &self.hard_n].map(|all| all.split_at(all.len() / 2));
        [(light.0, hard.0), (light.1, hard.1)]
            .map(|(light, hard)| Self { light_n: light.to_vec(), hard_n: hard.to_vec() })
    }
}

/// From one touch on.
#[derive(Clone, Copy)]
struct Press {
    begin_us: u64,
    end_us: u64,
    peak_n: f64,
    /// Whether its begin was seen, and nothing interrupted it.
    is_whole: bool,
}

/// The whole presses, in order of time.
fn presses(moments: &[TracePoint]) -> Vec<Press> {
    let mut presses: Vec<Press> = Vec::new();
    // Before the first sample the finger may have been down already.
    let mut before = TraceEvents::Doubt;
    for TracePoint { at, heard } in moments {
        let us = at.as_us();
        match heard {
            TraceEvents::Contact(contact) => {
                let peak_n = f64::from(contact.fz_n);
                match presses.last_mut() {
                    Some(last) if us - last.end_us <= GAP_US => {
                        (last.end_us, last.peak_n) = (us, last.peak_n.max(peak_n));
                        last.is_whole &= before != TraceEvents::Doubt;
                    }
                    _ => presses.push(Press {
                        begin_us: us,
                        end_us: us,
                        peak_n,
                        is_whole: before != TraceEvents::Doubt,
                    }),
                }
            }
            TraceEvents::Doubt if matches!(before, TraceEvents::Contact(_)) => {
                presses.iter_mut().next_back().into_iter().for_each(|last| last.is_whole = false);
            }
            TraceEvents::Doubt | TraceEvents::Nothing => {}
        }
        before = *heard;
    }
    if matches!(before, TraceEvents::Contact(_)) {
        presses.pop();
    }
    presses.retain(|press| press.is_whole && press.end_us - press.begin_us >= PRESS_MIN_US);
    presses
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_core::quantity::Contact;
    use tactpad_core::time::StreamInstant;

    /// 3 s in milliseconds, with presses from, to and with a force, and doubt in between.
    fn peaks(presses: &[(u64, u64, f32)], doubt: std::ops::Range<u64>) -> Peaks {
        let moment = |ms: u64| {
            let press = presses.iter().find(|(from, to, _)| (*from..*to).contains(&ms));
            let heard = match press {
                _ if doubt.contains(&ms) => TraceEvents::Doubt,
                Some((.., fz_n)) => TraceEvents::Contact(Contact { fz_n: *fz_n, ..Contact::default() }),
                None => TraceEvents::Nothing,
            };
            TracePoint { at: StreamInstant::from_us(1_000 * ms), heard }
        };
        Peaks::of(&Trace::new((0..3_001).map(moment).collect()))
    }

    #[test]
    fn light_ones_come_before_the_middle_and_hard_ones_after_it() {
        let presses = [
            (100, 200, 0.5),
            (600, 900, 0.25),
            // Within the turn, across it, and a brush.
            (1_300, 1_405, 3.0),
            (1_450, 1_650, 3.0),
            (2_000, 2_020, 3.0),
            (2_200, 2_300, 2.0),
        ];
        assert_eq!(peaks(&presses, 0..0), Peaks { light_n: vec![0.5, 0.25], hard_n: vec![2.0] });
    }

    #[test]
    fn a_touch_that_flickers_is_one_press() {
        let presses = [(100, 200, 0.5), (290, 400, 0.75), (510, 600, 0.25)];
        assert_eq!(peaks(&presses, 0..0).light_n, [0.75, 0.25]);
    }

    #[test]
    fn what_was_not_seen_whole_does_not_count() {
        let presses = [(0, 100, 0.5), (300, 500, 0.5), (700, 800, 0.25), (2_900, 3_001, 2.0)];
        assert_eq!(peaks(&presses, 400..420), Peaks { light_n: vec![0.25], hard_n: vec![] });
        assert_eq!(Peaks::of(&Trace::default()), Peaks::default());
    }

    #[test]
    fn halves_are_the_earlier_and_the_later_ones() {
        let all = Peaks { light_n: vec![1.0, 2.0, 3.0], hard_n: vec![4.0, 5.0] };
        let [first, second] = all.halves();
        assert_eq!(first, Peaks { light_n: vec![1.0], hard_n: vec![4.0] });
        assert_eq!(second, Peaks { light_n: vec![2.0, 3.0], hard_n: vec![5.0] });
    }
}
