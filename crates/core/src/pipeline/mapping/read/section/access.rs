//! A profile's help for hands that press what they do not mean.

use crate::pipeline::mapping::profile::{Access, Dwell, RestRejection, Tremor};
use crate::pipeline::mapping::read::common::limits::{
    BOUNCE_MS, DWELL_MM, DWELL_MS, REST_MS, REST_N, SLOW_MS, TREMOR_HZ, TREMOR_PER_MM,
};
use crate::toml_text::diag::Findings;
use crate::toml_text::section::Section;

pub(crate) const ACCESS_KEYS: [&str; 6] =
    ["slow_ms", "bounce_ms", "tremor_hz", "tremor_per_mm", "rest_n", "rest_ms"];

/// Reads `[access]`; none where a number is unusable.
pub(crate) fn read(table: &Section<'_>, findings: &mut Findings<'_>) -> Option<Access> {
    let slow = table.whole("slow_ms", SLOW_MS, findings);
    let bounce = table.whole("bounce_ms", BOUNCE_MS, findings);
    let cutoff = table.number("tremor_hz", TREMOR_HZ, findings);
    let per_mm = table.number("tremor_per_mm", TREMOR_PER_MM, findings);
    let force = table.number("rest_n", REST_N, findings);
    let time = table.whole("rest_ms", REST_MS, findings);
    let [is_calmed, rests] = [("tremor_hz", "tremor_per_mm"), ("rest_n", "rest_ms")].map(|(main, other)| {
        let is_written = table.place_of(main).is_some();
        if let (false, Some(at)) = (is_written, table.place_of(other)) {
            let message = format!("\"{other}\" does nothing without \"{main}\"");
            findings.error(at, message, format!("remove it, or write \"{main}\""));
        }
        is_written
    });
    let tremor = Tremor { cutoff_hz: cutoff?.value, per_mm: per_mm?.value };
    let rest = RestRejection { n: force?.value, us: u64::from(time?.value) * 1_000 };
    Some(Access {
        slow_us: u64::from(slow?.value) * 1_000,
        bounce_us: u64::from(bounce?.value) * 1_000,
        tremor: is_calmed.then_some(tremor),
        rest: rests.then_some(rest),
    })
}

/// Reads a button's dwell: the outer `None` where a number is unusable.
pub(crate) fn read_dwell(table: &Section<'_>, findings: &mut Findings<'_>) -> Option<Option<Dwell>> {
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
