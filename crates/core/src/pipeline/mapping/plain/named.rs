//! What the parts of a profile are called: the plain word, and behind it what a person named it: `A: jump`.

use std::collections::BTreeMap;

use super::controls;
use super::{settings, values};
use crate::pipeline::control::{Code, OutputDevice};
use crate::pipeline::mapping::profile::words::{COMMANDS, word};
use crate::pipeline::mapping::profile::{
    Command, Direction, Effect, Labelled, Mode, Output, Profile, Role, Side,
};

/// A word, and the name that a person gave, if there is one.
pub(super) fn with_label(word: &str, label: Option<&str>) -> String {
    label.map_or_else(|| word.to_owned(), |label| format!("{word}: {label}"))
}

/// A stick.
pub fn stick(profile: &Profile, side: Side) -> String {
    let word = if side == Side::Left { "left stick" } else { "right stick" };
    with_label(word, profile.labels.of(Labelled::Stick(side)))
}

/// A trigger.
pub fn trigger(profile: &Profile, side: Side) -> String {
    let word = if side == Side::Left { "left trigger" } else { "right trigger" };
    with_label(word, profile.labels.of(Labelled::Trigger(side)))
}

/// A direction of the plate: `up: climb`.
pub fn direction(profile: &Profile, direction: Direction) -> String {
    with_label(direction.name(), profile.labels.of(Labelled::Direction(direction)))
}

/// What a kind of press of the button at `index` does: `A: jump`.
pub fn effect(profile: &Profile, index: usize, role: Role, effect: &Effect) -> String {
    let named = |all: Option<String>| all.unwrap_or_default();
    let acts_on = match &effect.output {
        Output::Keys(keys) => controls::all_of(keys),
        Output::Layer(number) => named(profile.layers.get(*number).map(|it| format!("layer {}", it.name))),
        Output::Macro(number) => named(profile.macros.get(*number).map(|it| format!("macro {}", it.name))),
        Output::Bridge(Command::Profile(name)) => format!("profile {name}"),
        Output::Bridge(command) => values::word("button.out.bridge", word(&COMMANDS, command)).to_owned(),
    };
    let follows = match effect.mode {
        Mode::Plain => String::new(),
        Mode::Toggle => format!(", {}", settings::word("button.out.toggle")),
        Mode::Sticky => format!(", {}", settings::word("button.out.sticky")),
        Mode::Turbo { period_us } => {
            format!(", {} {} ms", settings::word("button.out.turbo_ms"), period_us / 1_000)
        }
    };
    with_label(&acts_on, profile.labels.of(Labelled::Press(index, role))) + &follows
}

/// The button at `index` by what it does: `A: jump / B: run`.
pub fn button(profile: &Profile, index: usize) -> Option<String> {
    let effects = Role::ALL.into_iter().zip(profile.buttons.get(index)?.effects());
    let mut words: Vec<String> = Vec::new();
    for (role, of) in effects {
        let word = of.map(|of| effect(profile, index, role, &of));
        words.extend(word.filter(|word| !words.contains(word)));
    }
    Some(words.join(" / "))
}

/// A control where it has this value, by what controls do in the game: `A: jump`.
pub fn control(labels: &BTreeMap<String, String>, device: OutputDevice, code: Code, value: i32) -> String {
    let label = labels.get(&controls::written(code, value));
    with_label(&controls::word(device, code, value), label.map(String::as_str))
}

/// What controls do in the game, by the controls as bindings write them; of keys that go down together by the last one.
pub fn labels(profile: &Profile) -> BTreeMap<String, String> {
    let mut all: BTreeMap<String, String> = BTreeMap::new();
    let mut add = |code: Code, value: i32, part: Labelled| {
        let Some(label) = profile.labels.of(part) else { return };
        let known = all.entry(controls::written(code, value)).or_default();
        if known.is_empty() {
            label.clone_into(known);
        } else if known.split(" / ").all(|it| it != label) {
            *known += &format!(" / {label}");
        }
    };
    if let Some(dpad) = &profile.dpad {
        let keys = [dpad.up, dpad.down, dpad.left, dpad.right];
        for (direction, keys) in Direction::ALL.into_iter().zip(keys) {
            let last = keys.iter().last();
            last.iter().for_each(|it| add(it.code, it.value, Labelled::Direction(direction)));
        }
    }
    for (index, button) in profile.buttons.iter().enumerate() {
        for (role, effect) in Role::ALL.into_iter().zip(button.effects()) {
            let last = effect.and_then(|effect| effect.output.bindings().last());
            last.iter().for_each(|it| add(it.code, it.value, Labelled::Press(index, role)));
        }
    }
    let both = |code: Code| [(code, -1), (code, 1)];
    for stick in &profile.sticks {
        let axes = stick.axes().into_iter().flat_map(both);
        axes.for_each(|(code, value)| add(code, value, Labelled::Stick(stick.side)));
    }
    for trigger in &profile.triggers {
        both(trigger.axis())
            .into_iter()
            .for_each(|(code, value)| add(code, value, Labelled::Trigger(trigger.side)));
    }
    all
}
