//! Whether anything can come of what a profile has: zones that lie behind others, layers that nothing switches on or off, macros that
//! nothing begins.

use crate::pipeline::mapping::profile::angle::wrapped;
use crate::pipeline::mapping::profile::{Button, Command, Effect, Mode, Output, Profile, When, Zone};
use crate::toml_text::diag::{Findings, quoted};

/// Where a profile's zones, layers and macros stand in its text, in their order.
pub(crate) struct Places {
    pub(crate) zones: Vec<usize>,
    pub(crate) layers: Vec<usize>,
    pub(crate) macros: Vec<usize>,
}

/// Warns of zones, layers and macros of which nothing can come, and of layers that nobody can leave.
pub(crate) fn check(profile: &Profile, places: &Places, findings: &mut Findings<'_>) {
    for (number, (zone, at)) in profile.zones.iter().zip(&places.zones).enumerate() {
        let (before, _) = profile.zones.split_at(number);
        let hiding = hiding(zone, before);
        let Some(first) = hiding.first() else { continue };
        let names: Vec<_> = hiding.iter().map(|name| quoted(name)).collect();
        let (all, have) = (names.join(" and "), if hiding.len() > 1 { "have" } else { "has" });
        findings.warning(
            *at,
            format!("no touch comes into zone {}: {all} before it {have} all its places", quoted(&zone.name)),
            format!("write it before {}, or remove it", quoted(first)),
        );
    }
    for (number, (layer, at)) in profile.layers.iter().zip(&places.layers).enumerate() {
        let name = &layer.name;
        let switches: Vec<_> =
            effects(profile).filter(|(_, effect)| effect.output == Output::Layer(number)).collect();
        let ends_itself = |(button, effect): &(&Button, Effect)| {
            effect.mode == Mode::Plain && !button.when.is_met(Some(number))
        };
        let stays = |(_, effect): &(&Button, Effect)| effect.mode == Mode::Toggle;
        if switches.is_empty() {
            let help = format!("give a press out = {{ layer = \"{name}\" }}, or remove the layer");
            findings.warning(*at, format!("nothing switches layer \"{name}\" on"), help);
        } else if switches.iter().all(ends_itself) {
            findings.warning(
                *at,
                format!("layer \"{name}\" ends as soon as it begins: its button does not count in it"),
                "remove \"layer\" from that button",
            );
        } else if switches.iter().any(stays) && !leads_out(profile, number) {
            findings.warning(
                *at,
                format!("layer \"{name}\" has no way out: no button that counts in it switches it off"),
                "remove \"layer\" from the button that switches it on, so that it switches it off, too",
            );
        }
    }
    for (number, (it, at)) in profile.macros.iter().zip(&places.macros).enumerate() {
        if !effects(profile).any(|(_, effect)| effect.output == Output::Macro(number)) {
            let help = format!("give a press tap = {{ macro = \"{}\" }}, or remove it", it.name);
            findings.warning(*at, format!("nothing begins macro \"{}\"", it.name), help);
        }
    }
}

/// Whether a press that counts in this layer switches it off, or goes over to another profile.
fn leads_out(profile: &Profile, layer: usize) -> bool {
    effects(profile).any(|(button, effect)| {
        let counts = matches!(button.when, When::Always) || button.when == When::Layer(layer);
        counts
            && (effect.output == Output::Layer(layer)
                || matches!(effect.output, Output::Bridge(Command::NextProfile | Command::Profile(_))))
    })
}

/// All effects of all buttons.
fn effects(profile: &Profile) -> impl Iterator<Item = (&Button, Effect)> {
    let of = |button: &'_ Button| button.effects().into_iter().flatten();
    profile.buttons.iter().flat_map(move |button| of(button).map(move |effect| (button, effect)))
}

/// What is narrower comes of rounding, in degrees and millimetres.
const WIDTH_MIN: f32 = 0.01;

/// The names of those of the zones `before` this one that share all its places; none where a touch can come into it.
///
/// The edges of all zones cut its places into pieces, of each of which a zone has all or nothing: the middle tells.
fn hiding<'z>(zone: &Zone, before: &'z [Zone]) -> Vec<&'z str> {
    let radii = before.iter().flat_map(|it| [it.inner_radius_mm, it.outer_radius_mm]);
    let sectors = before.iter().filter(|it| it.half_width_deg < 180.0);
    let edges = sectors.flat_map(|it| [it.middle_deg - it.half_width_deg, it.middle_deg + it.half_width_deg]);
    let offsets = edges.map(|edge_deg| wrapped(wrapped(edge_deg) - zone.middle_deg));
    let radii = middles([zone.inner_radius_mm, zone.outer_radius_mm], radii);
    let offsets = middles([-zone.half_width_deg, zone.half_width_deg], offsets);
    let mut hiding = vec![false; before.len()];
    for (radius_mm, offset_deg) in
        radii.iter().flat_map(|radius| offsets.iter().map(move |it| (*radius, *it)))
    {
        let angle_deg = wrapped(zone.middle_deg + offset_deg);
        let first = before.iter().zip(&mut hiding).find(|(it, _)| it.holds(radius_mm, 0.0, angle_deg, 0.0));
        let Some((_, is_hiding)) = first else { return Vec::new() };
        *is_hiding = true;
    }
    let names = before.iter().zip(hiding).filter(|(_, is_hiding)| *is_hiding);
    names.map(|(it, _)| it.name.as_str()).collect()
}

/// The middles of the pieces into which `cuts` divide what is between `low` and `high`.
fn middles([low, high]: [f32; 2], cuts: impl Iterator<Item = f32>) -> Vec<f32> {
    let mut cuts: Vec<f32> = cuts.filter(|cut| *cut > low && *cut < high).chain([low, high]).collect();
    cuts.sort_by(f32::total_cmp);
    let pieces = cuts.iter().zip(cuts.iter().skip(1)).filter(|(from, to)| *to - *from > WIDTH_MIN);
    pieces.map(|(from, to)| f32::midpoint(*from, *to)).collect()
}
