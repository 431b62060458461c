//! Which further measurement tells confounded causes apart.

use super::report::Finding;

/// What tells creep from a gain.
const DWELLS: &str = "hold half of the contacts for 2 s and the others for 20 s, and write so under dwell_s: a gain does not know how long";

/// Two causes, and what separates them.
const PAIRS: [(&str, &str, &str); 12] = [
    (
        "excitation_gain",
        "reference_gain",
        "place known weights on the pad: they need no force sensor, so only a wrong excitation still shows",
    ),
    ("creep", "excitation_gain", DWELLS),
    ("creep", "reference_gain", DWELLS),
    ("creep", "channel_gain", DWELLS),
    (
        "hysteresis",
        "gauge_nonlinearity",
        "come to half of the contacts from a higher load, and write so under approach: only what keeps the load differs",
    ),
    (
        "thermal_zero",
        "zero_drift",
        "measure while the pad is warmed and cools again, or in a random order: time then no longer goes with temperature",
    ),
    (
        "thermal_gain",
        "ageing",
        "come back to the first contacts at their first temperature: what is lost by then is worn, not warm",
    ),
    (
        "stage_offset",
        "module_displaced",
        "clamp the pad turned by 120 degrees and repeat a third of the contacts: an offset stays with the stage, a module turns with the pad",
    ),
    (
        "stage_scale",
        "module_displaced",
        "measure the modules' places with a caliper: the stage has no part in that",
    ),
    (
        "stage_rotation",
        "module_rotated",
        "put a mark on pad and stage and take the angle between them: a turned module does not move the mark",
    ),
    (
        "contact_height",
        "channel_crosstalk",
        "repeat a third of the contacts with a cap of another height: crosstalk does not know the cap",
    ),
    (
        "contact_size",
        "module_displaced",
        "repeat the contacts over the modules with an indenter of another size: places stay where they are",
    ),
];

/// The measurement that separates the causes of a finding; `None` if it is named, or no measurement of this list does.
pub(super) fn separate_by(finding: &Finding) -> Option<String> {
    let others = || finding.confounded_with.iter().map(|(effect, _)| *effect);
    let separates = |(one, other, _): &&(&str, &str, &str)| {
        others().any(|rival| [(finding.effect, rival), (rival, finding.effect)].contains(&(one, other)))
    };
    PAIRS.iter().find(separates).map(|(_, _, how)| (*how).to_owned())
}
