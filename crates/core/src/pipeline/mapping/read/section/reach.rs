//! Whether anything can come of what a profile has: layers that nothing switches on or off, macros that nothing begins.

use crate::pipeline::mapping::profile::{Action, Button, Command, Effect, Mode, Output, Profile, When};
use crate::toml_text::diag::Findings;

/// Where a profile's layers and macros stand in its text, in their order.
pub(crate) struct Places {
    pub(crate) layers: Vec<usize>,
    pub(crate) macros: Vec<usize>,
}

/// Warns of layers and macros of which nothing can come, and of layers that nobody can leave.
pub(crate) fn check(profile: &Profile, places: &Places, findings: &mut Findings<'_>) {
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
    profile.buttons.iter().flat_map(|button| {
        let effects = match button.action {
            Action::Hold(out) => [Some(out), None, None],
            Action::ByTime { tap, double, hold } => {
                [Some(tap), double.map(|it| it.effect), hold.map(|it| it.effect)]
            }
            Action::ByForce { light, hard, .. } => [Some(light), Some(hard), None],
        };
        effects.into_iter().flatten().map(move |effect| (button, effect))
    })
}
