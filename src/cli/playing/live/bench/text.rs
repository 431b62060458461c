//! The report, for people.

use std::io::{self, Write};

use crate::cli::printing::written::{printable, stdout};
use tactpad::lab::bench::report::{BenchReport, ChannelReport, DeedReport, InputReport, WeightReport};
use tactpad::quantity::{CHANNEL_NAMES, CHANNELS};

pub(super) fn print(report: &BenchReport) -> io::Result<()> {
    let mut out = stdout();
    let BenchReport { rate_hz, frames_lost, frames_damaged, expected_noise_uv, .. } = report;
    let name = report
        .serial_number
        .as_deref()
        .map_or("the pad".into(), |number| format!("pad {}", printable(number)));
    writeln!(
        out,
        "{name}: {rate_hz:.0} samples per second, {frames_lost} frames lost, {frames_damaged} damaged"
    )?;
    writeln!(
        out,
        "\nAt rest, as it is sent; the converter's data sheet lets expect {expected_noise_uv:.1} µV of noise"
    )?;
    writeln!(out, "{:<7} {:>9} {:>13} {:>14}  hum", "sent as", "zero µV", "noise µV rms", "drift µV/min")?;
    for InputReport { name, rest } in &report.inputs {
        let hum = rest.hum.map_or("none seen".into(), |hum| {
            format!("{:.1} µV of {:.0} Hz", hum.amplitude_uv, hum.frequency_hz)
        });
        let (zero_uv, noise_uv, drift) = (rest.zero_uv, rest.noise_uv, rest.drift_uv_per_min);
        writeln!(out, "{name:<7} {zero_uv:>9.1} {noise_uv:>13.2} {drift:>14.1}  {hum}")?;
    }
    if let Some(weight) = &report.weight {
        print_weight(&mut out, weight)?;
    }
    if !report.deeds.is_empty() {
        writeln!(out, "\nPresses, µV")?;
        writeln!(out, "{:<22}{}", "", row(&CHANNEL_NAMES.map(str::to_owned)))?;
    }
    for DeedReport { deed, channels_uv, .. } in &report.deeds {
        writeln!(out, "{deed:<22}{}", row(&channels_uv.map(|uv| format!("{uv:.0}"))))?;
    }
    for DeedReport { deed, contact, unexplained, .. } in &report.deeds {
        if let Some((contact, (channel, share))) = contact.zip(*unexplained) {
            writeln!(
                out,
                "{deed}: {:.1} N at ({:.0}, {:.0}) mm, ({:.1}, {:.1}) N along the plate; {:.1} % of the largest reading is left over in \
                 {channel}",
                contact.fz_n,
                contact.x_mm,
                contact.y_mm,
                contact.fx_n,
                contact.fy_n,
                100.0 * share
            )?;
        }
    }
    writeln!(out, "\n{:<8} is sent as", "channel")?;
    for channel in &report.channels {
        writeln!(out, "{:<8} {}", channel.name, sent(channel))?;
    }
    writeln!(out)?;
    for fault in &report.faults {
        writeln!(out, "mend  {fault}")?;
    }
    for open in &report.open {
        writeln!(out, "open  {open}")?;
    }
    if let Some(wiring) = &report.wiring {
        writeln!(out, "\nUntil that is mended, say to run, record, calibrate and latency how it is wired:")?;
        writeln!(out, "tactpad run --wiring {wiring}")?;
    }
    if report.is_good() {
        writeln!(out, "nothing to mend: every channel is where it should be, with its sign")?;
    }
    Ok(())
}

fn print_weight(out: &mut impl Write, weight: &WeightReport) -> io::Result<()> {
    let WeightReport { weight_g, force_n, step_uv, decoded, resolution_n, mean_resolution_n } = weight;
    writeln!(out, "\n{weight_g} g on the middle, {force_n:.3} N, µV")?;
    writeln!(out, "{}", row(&CHANNEL_NAMES.map(str::to_owned)))?;
    writeln!(out, "{}", row(&step_uv.map(|uv| format!("{uv:.1}"))))?;
    if let Some(contact) = decoded {
        let (fz_n, x_mm, y_mm) = (contact.fz_n, contact.x_mm, contact.y_mm);
        writeln!(out, "decoded as of the nominal pad: {fz_n:.3} N at ({x_mm:.1}, {y_mm:.1}) mm")?;
    }
    writeln!(
        out,
        "resolution by the noise: {:.1} mN rms in a sample, {:.1} mN in the mean of 10 ms",
        1e3 * resolution_n,
        1e3 * mean_resolution_n
    )
}

fn row(cells: &[String; CHANNELS]) -> String {
    cells.iter().map(|cell| format!("{cell:>8}")).collect()
}

fn sent(channel: &ChannelReport) -> String {
    let mark = |is_other: bool| if is_other { "   <-" } else { "" };
    match (channel.sent_as, channel.is_reversed) {
        (None, _) => "cannot tell".into(),
        (Some(sent), None) => format!("{sent}, cannot tell with which sign"),
        (Some(sent), Some(is_reversed)) => {
            let minus = if is_reversed { "-" } else { "" };
            format!("{minus}{sent}{}", mark(is_reversed || sent != channel.name))
        }
    }
}
