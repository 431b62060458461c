//! How large the nine channels of a table are, and how far the bridges' exact law is from the linear one.

use std::fmt;

use serde::Serialize;

use tactpad::pad::readout::Bridges;
use tactpad::quantity::{CHANNEL_NAMES, CHANNELS};

/// Sums over the rows of a table.
#[derive(Debug, Default)]
pub(crate) struct Summary {
    rows: usize,
    channels: [Sizes; CHANNELS],
}

/// The sizes of one channel.
#[derive(Clone, Copy, Debug, Default)]
struct Sizes {
    /// As it is written.
    read: Size,
    /// The bridge's linear signal.
    linear: Size,
    /// Exact minus linear signal.
    excess: Size,
}

/// How large a quantity is over the rows.
#[derive(Clone, Copy, Debug, Default)]
struct Size {
    max_uv: f64,
    square_uv2: f64,
}

impl Size {
    fn add(&mut self, uv: f64) {
        self.max_uv = self.max_uv.max(uv.abs());
        self.square_uv2 += uv * uv;
    }

    fn rms_uv(&self, rows: usize) -> f64 {
        (self.square_uv2 / rows.max(1) as f64).sqrt()
    }
}

impl Summary {
    /// Takes one row: its channels, and what the bridges carried.
    pub(crate) fn add(&mut self, channels_uv: &[f64; CHANNELS], bridges: &Bridges, excitation_v: f64) {
        let laws_uv = bridges.signal_uv.into_iter().zip(bridges.exact_uv(excitation_v));
        for ((sizes, read_uv), (linear_uv, exact_uv)) in
            self.channels.iter_mut().zip(channels_uv).zip(laws_uv)
        {
            sizes.read.add(*read_uv);
            sizes.linear.add(linear_uv);
            sizes.excess.add(exact_uv - linear_uv);
        }
        self.rows += 1;
    }

    /// The report of the rows.
    pub(crate) fn report(&self) -> ChannelReport {
        let channels = CHANNEL_NAMES.into_iter().zip(&self.channels);
        let channels = channels.map(|(channel, sizes)| sizes.report(channel, self.rows));
        ChannelReport { rows: self.rows, channels: channels.collect() }
    }
}

impl Sizes {
    fn report(&self, channel: &'static str, rows: usize) -> Channel {
        let full_scale_uv = self.linear.max_uv;
        let percent = |uv: f64| if full_scale_uv > 0.0 { 100.0 * uv / full_scale_uv } else { 0.0 };
        let (max_uv, rms_uv) = (self.excess.max_uv, self.excess.rms_uv(rows));
        Channel {
            channel,
            max_uv: self.read.max_uv,
            rms_uv: self.read.rms_uv(rows),
            bridge_nonlinearity: Nonlinearity {
                max_uv,
                rms_uv,
                max_percent: percent(max_uv),
                rms_percent: percent(rms_uv),
            },
        }
    }
}

/// The report of a table.
#[derive(Debug, Serialize)]
pub(crate) struct ChannelReport {
    rows: usize,
    channels: Vec<Channel>,
}

/// One channel as it is written: its largest magnitude and its root mean square.
#[derive(Debug, Serialize)]
struct Channel {
    channel: &'static str,
    max_uv: f64,
    rms_uv: f64,
    bridge_nonlinearity: Nonlinearity,
}

/// Exact minus linear signal, whichever of them is written; in percent of the largest linear signal, too.
#[derive(Debug, Serialize)]
struct Nonlinearity {
    max_uv: f64,
    rms_uv: f64,
    max_percent: f64,
    rms_percent: f64,
}

impl fmt::Display for ChannelReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let contacts = if self.rows == 1 { "contact" } else { "contacts" };
        write!(f, "{} {contacts}\n{:<7} {:>11} {:>11}", self.rows, "µV", "max", "rms")?;
        write!(f, "   exact bridge − linear: {:>9} {:>9}    % {:>7} {:>7}", "max", "rms", "max", "rms")?;
        self.channels.iter().try_for_each(|channel| write!(f, "\n{channel}"))
    }
}

impl fmt::Display for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { channel, max_uv, rms_uv, bridge_nonlinearity } = self;
        write!(f, "{channel:<7} {max_uv:>11.1} {rms_uv:>11.1}")?;
        let Nonlinearity { max_uv, rms_uv, max_percent, rms_percent } = bridge_nonlinearity;
        let space = " ".repeat(26);
        write!(f, "{space}{max_uv:>9.3} {rms_uv:>9.3}      {max_percent:>7.4} {rms_percent:>7.4}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn summary(rows: &[(f64, f64)]) -> ChannelReport {
        let mut summary = Summary::default();
        for (signal_uv, sum_uv) in rows {
            let bridges = Bridges { signal_uv: [*signal_uv; CHANNELS], sum_uv: [*sum_uv; CHANNELS] };
            summary.add(&[signal_uv + 7.0; CHANNELS], &bridges, 2.8);
        }
        summary.report()
    }

    #[test]
    fn sizes_are_those_of_the_rows() {
        let report = summary(&[(-407.0, 0.0), (293.0, 0.0)]);
        assert_eq!(report.rows, 2);
        for (channel, name) in report.channels.iter().zip(CHANNEL_NAMES) {
            assert_eq!(channel.channel, name);
            assert_eq!((channel.max_uv, channel.rms_uv), (400.0, (125_000_f64).sqrt()));
        }
    }

    #[test]
    fn nonlinearity_is_half_the_sum_of_the_signal() {
        // s = 0.02: the exact signal is the linear one over 1.01, also where an offset is written.
        let report = summary(&[(1010.0, 56_000.0), (0.0, 56_000.0)]);
        for channel in &report.channels {
            let found = &channel.bridge_nonlinearity;
            assert!((found.max_uv - 10.0).abs() < 1e-9 && (found.rms_uv - 50_f64.sqrt()).abs() < 1e-9);
            assert!((found.max_percent - 1000.0 / 1010.0).abs() < 1e-9);
            assert!((found.rms_percent * 1010.0 - 100.0 * found.rms_uv).abs() < 1e-6);
        }
        let text = report.to_string();
        let (head, row) = (text.lines().nth(1).unwrap(), text.lines().last().unwrap());
        assert!(row.starts_with("m2z  ") && row.contains("  10.000 "), "{text}");
        assert_eq!(head.chars().count(), row.chars().count(), "{text}");
    }

    #[test]
    fn a_silent_channel_is_no_division_by_zero() {
        assert_eq!(summary(&[(0.0, 100.0)]).channels[0].bridge_nonlinearity.max_percent, 0.0);
    }
}
