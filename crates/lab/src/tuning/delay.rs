//! How late a profile decides.

use tactpad_core::pipeline::mapping::profile::{Action, Button, Profile, Skip};

/// The longest that a profile lets an action wait beyond what the finger does, for a pad whose samples are `period_us` apart:
///
/// ```text
/// all          half of the filter's window: (filter_samples − 1)/2 samples, or one with filter_adapts
/// direction    and slow_ms, and the tremor filter's lag at rest: 1/(2π tremor_hz)
/// button       and slow_ms, or dwell_ms where that is more; for a tap with "double" also double_press_ms,
///              for a light press that may turn hard also skip_ms
/// ```
///
/// How long a press must last to be long is what the player does, and no delay.
pub fn delay_us(profile: &Profile, period_us: u64) -> u64 {
    let filter_us = (profile.filter_delay_samples() * period_us as f64) as u64;
    let lag_us = profile.access.tremor.map_or(0, |tremor| (f64::from(tremor.delay_s()) * 1e6).round() as u64);
    let places_us = match (&profile.dpad, &profile.pointer) {
        (Some(_), _) => lag_us + profile.access.slow_us,
        (None, Some(_)) => lag_us,
        (None, None) => 0,
    };
    let buttons_us = profile.buttons.iter().map(|button| {
        let place_us = if button.place.is_some() { lag_us } else { 0 };
        place_us + wait_us(button, profile.access.slow_us)
    });
    filter_us + buttons_us.max().unwrap_or(0).max(places_us)
}

/// How long a press waits for what it becomes.
fn wait_us(button: &Button, slow_us: u64) -> u64 {
    let told_us = match button.action {
        Action::Hold(_) => 0,
        Action::ByTime { double, .. } => double.map_or(0, |double| double.us),
        Action::ByForce { skip, .. } => match skip {
            Skip::No => 0,
            Skip::May { us } | Skip::Must { us } => us,
        },
    };
    slow_us.max(button.dwell.map_or(0, |dwell| dwell.us)) + told_us
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad_core::pipeline::mapping::read::check::{OutputChoice, read};

    #[test]
    fn each_wait_counts() {
        let late_us = |lines: &str| {
            let head = "schema = 1\nname = \"x\"\noutput = \"gamepad\"\nfilter_samples = 7\n";
            delay_us(&read(&format!("{head}{lines}"), OutputChoice::AsWritten).0.unwrap(), 1_000)
        };
        let button = "[[button]]\nforce = \"fz\"\npress_n = 1\n";
        let tap = "tap = { gamepad = \"BTN_SOUTH\", keyboard = \"KEY_Z\" }\n";
        let double = "double = { gamepad = \"BTN_EAST\", keyboard = \"KEY_X\" }\ndouble_press_ms = 200\n";
        assert_eq!(late_us("[dpad]\n"), 3_000);
        assert_eq!(late_us("access = { tremor_hz = 2 }\n[dpad]\n"), 3_000 + 79_577);
        assert_eq!(late_us("access = { slow_ms = 50 }\n[dpad]\n"), 53_000);
        assert_eq!(late_us(&format!("access = {{ tremor_hz = 2, slow_ms = 50 }}\n{button}{tap}")), 53_000);
        assert_eq!(late_us(&format!("{button}{tap}{double}")), 203_000);
        assert_eq!(
            late_us(&format!("access = {{ slow_ms = 50 }}\n{button}{tap}{double}dwell_ms = 80\n")),
            283_000
        );
    }
}
