//! The battery of an input device.

use std::fmt;
use std::os::fd::AsFd;
use std::path::Path;

use rustix::event::{PollFd, PollFlags, poll};
use serde::Serialize;
use tactpad_core::source::Reports;

use super::balance_board::battery_v;
use super::beside::{battery_percent, raw_node};
use super::reports::{REPORT_LEN, open};
use crate::transport::pacing::{limit, monotonic_us};

/// How long a device may take to report, µs: it reports a hundred times a second once it is asked to.
const REPORT_LIMIT_US: u64 = 500_000;

/// Four cells with less than 1.1 V each are nearly empty.
const LOW_V: f32 = 4.4;

/// A battery with less is low where only its charge is known, percent.
const LOW_PERCENT: u8 = 20;

/// What is known of a battery.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Battery {
    /// Its voltage, V.
    Volts(f32),
    /// Its charge, by the driver.
    Percent(u8),
}

impl Battery {
    /// The battery of the device whose input device is at `node`: by its own reports, where these are known and may be read, else by its
    /// driver. `None` where neither says anything. This may take a second or two: it is not for the bridge's loop.
    ///
    /// A Balance Board is said to tell its driver the same charge all the time, so its reports come first.
    pub fn of(node: &Path, reports: Option<Reports>) -> Option<Self> {
        let by_report = reports.and_then(|Reports::BalanceBoard| reported_v(node)).map(Self::Volts);
        by_report.or_else(|| battery_percent(node).map(Self::Percent))
    }

    /// Whether it will not last.
    pub const fn is_low(self) -> bool {
        match self {
            Self::Volts(volts) => volts < LOW_V,
            Self::Percent(percent) => percent <= LOW_PERCENT,
        }
    }
}

impl fmt::Display for Battery {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Volts(volts) => write!(f, "battery at {volts:.1} V"),
            Self::Percent(percent) => write!(f, "battery at {percent} %"),
        }
    }
}

/// The voltage by the next report that says it.
fn reported_v(node: &Path) -> Option<f32> {
    // The driver asks the board for such reports while its input device is open.
    let (_device, raw) = (open(node)?, open(&raw_node(node)?.path)?);
    let until_us = monotonic_us() + REPORT_LIMIT_US;
    loop {
        let left_us = until_us.saturating_sub(monotonic_us());
        let mut fds = [PollFd::from_borrowed_fd(raw.as_fd(), PollFlags::IN)];
        if left_us == 0 || poll(&mut fds, Some(&limit(left_us))).ok()? == 0 {
            return None;
        }
        let mut report = [0; REPORT_LEN];
        let length = rustix::io::read(&raw, &mut report).ok()?;
        if let Some(volts) = battery_v(report.get(..length).unwrap_or_default()) {
            return Some(volts);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_battery_is_low_before_it_is_empty() {
        assert!(Battery::Volts(4.3).is_low() && !Battery::Volts(5.2).is_low());
        assert!(Battery::Percent(20).is_low() && !Battery::Percent(21).is_low());
        assert_eq!(Battery::Volts(5.18).to_string(), "battery at 5.2 V");
        assert_eq!(Battery::Percent(57).to_string(), "battery at 57 %");
    }
}
