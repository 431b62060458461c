//! A profile's help for hands that press what they do not mean.

use super::limits::{BOUNCE_MS, DWELL_MM, DWELL_MS, SLOW_MS, TREMOR_HZ, TREMOR_PER_MM};
use super::profile::{Access, Dwell, Tremor};
use crate::toml_text::diag::Findings;
use crate::toml_text::section::Section;

pub(super) const ACCESS_KEYS: [&str; 4] = ["slow_ms", "bounce_ms", "tremor_hz", "tremor_per_mm"];

/// Reads `[access]`; none where a number is unusable.
pub(super) fn read(table: &Section<'_>, findings: &mut Findings<'_>) -> Option<Access> {
    let slow = table.whole("slow_ms", SLOW_MS, findings);
    let bounce = table.whole("bounce_ms", BOUNCE_MS, findings);
    let cutoff = table.number("tremor_hz", TREMOR_HZ, findings);
    let per_mm = table.number("tremor_per_mm", TREMOR_PER_MM, findings);
    let is_calmed = table.place_of("tremor_hz").is_some();
    if let (false, Some(at)) = (is_calmed, table.place_of("tremor_per_mm")) {
        findings.error(
            at,
            "\"tremor_per_mm\" does nothing without \"tremor_hz\"",
            "remove it, or write \"tremor_hz\"",
        );
    }
    let tremor = Tremor { cutoff_hz: cutoff?.value, per_mm: per_mm?.value };
    Some(Access {
        slow_us: u64::from(slow?.value) * 1_000,
        bounce_us: u64::from(bounce?.value) * 1_000,
        tremor: is_calmed.then_some(tremor),
    })
}

/// Reads a button's dwell: the outer `None` where a number is unusable.
pub(super) fn read_dwell(table: &Section<'_>, findings: &mut Findings<'_>) -> Option<Option<Dwell>> {
    let radius = table.number("dwell_mm", DWELL_MM, findings);
    if table.place_of("dwell_ms").is_none() {
        if let Some(at) = table.place_of("dwell_mm") {
            findings.error(
                at,
                "\"dwell_mm\" does nothing without \"dwell_ms\"",
                "remove it, or write \"dwell_ms\"",
            );
        }
        return Some(None);
    }
    let ms = table.whole("dwell_ms", DWELL_MS, findings)?;
    Some(Some(Dwell { us: u64::from(ms.value) * 1_000, radius_mm: radius?.value }))
}
