//! The words by which people name what a profile can press.

use tactpad_core::pipeline::control::Code;
use tactpad_core::pipeline::control::names;
use tactpad_core::pipeline::mapping::profile::{Binding, Profile, Role};
use tactpad_core::toml_text::diag::quoted;
use tactpad_core::toml_text::spelling;

/// The word for nothing.
pub const NONE: &str = "none";

/// A profile's words, each with what it presses.
#[derive(Clone, Debug)]
pub struct Vocabulary(Vec<(String, Vec<Binding>)>);

impl Vocabulary {
    /// Directions, then buttons by their number in the file (as `button 1`; with several kinds of press `button 1 tap`), then
    /// controls by the kernel's names.
    pub fn of(profile: &Profile) -> Self {
        let mut words = Vec::new();
        if let Some(dpad) = &profile.dpad {
            let directions =
                [("up", dpad.up), ("down", dpad.down), ("left", dpad.left), ("right", dpad.right)];
            words.extend(directions.map(|(name, keys)| (name.to_owned(), keys.iter().collect())));
        }
        for (number, button) in (1..).zip(&profile.buttons) {
            let effects = Role::ALL.into_iter().zip(button.effects());
            let effects: Vec<_> = effects.filter_map(|(role, effect)| Some((role, effect?))).collect();
            let is_one = effects.len() == 1;
            words.extend(effects.into_iter().map(|(role, effect)| {
                let kind = if is_one { String::new() } else { format!(" {}", role.name()) };
                (format!("button {number}{kind}"), effect.output.bindings().collect())
            }));
        }
        for binding in profile.bindings() {
            let name = name_of(binding);
            if words.iter().all(|(word, _)| *word != name) {
                words.push((name, vec![binding]));
            }
        }
        Self(words)
    }

    /// What a text means: a word, several with `+` between them, or [`NONE`]. In order, each control once.
    ///
    /// # Errors
    /// Says which word the profile does not have, and those that it has.
    pub fn meant(&self, text: &str) -> Result<Vec<Binding>, String> {
        if text.trim().eq_ignore_ascii_case(NONE) {
            return Ok(Vec::new());
        }
        let mut bindings = Vec::new();
        for word in split(text) {
            bindings.extend(self.find(&word).ok_or_else(|| self.unknown(&word))?);
        }
        Ok(in_order(bindings))
    }

    /// The shortest name of what is pressed together.
    pub fn name(&self, bindings: &[Binding]) -> String {
        if bindings.is_empty() {
            return NONE.to_owned();
        }
        let whole = self
            .0
            .iter()
            .find(|(word, keys)| !word.starts_with("button") && in_order(keys.clone()) == bindings);
        whole.map_or_else(
            || {
                let names: Vec<_> = bindings.iter().map(|binding| self.name_of_one(*binding)).collect();
                names.join("+")
            },
            |(word, _)| word.clone(),
        )
    }

    fn name_of_one(&self, binding: Binding) -> String {
        let direction = self.0.iter().find(|(word, keys)| !word.starts_with("button") && *keys == [binding]);
        direction.map_or_else(|| name_of(binding), |(word, _)| word.clone())
    }

    fn find(&self, word: &str) -> Option<Vec<Binding>> {
        let known = |(name, _): &&(String, Vec<Binding>)| name.eq_ignore_ascii_case(word);
        if let Some((_, keys)) = self.0.iter().find(known) {
            return Some(keys.clone());
        }
        // The kernel's second names, and keys without KEY_.
        let code = names::parse(word).or_else(|| names::parse(&format!("BTN_{word}")))?;
        let named = |(_, keys): &&(String, Vec<Binding>)| matches!(keys[..], [key] if key.code == code && is_key(code));
        self.0.iter().find(named).map(|(_, keys)| keys.clone())
    }

    fn unknown(&self, word: &str) -> String {
        let words = || self.0.iter().map(|(name, _)| name.as_str()).chain([NONE]);
        let told = match spelling::nearest(word, words()) {
            Some(near) => format!("did you mean {}?", quoted(near)),
            None => format!("write one of {}", words().collect::<Vec<_>>().join(", ")),
        };
        format!("the profile has nothing that is called {}: {told}", quoted(word))
    }
}

const fn is_key(code: Code) -> bool {
    matches!(code, Code::Key(_))
}

/// Controls in a fixed order, each once.
pub(super) fn in_order(mut bindings: Vec<Binding>) -> Vec<Binding> {
    bindings.sort_by_key(|binding| (binding.device, binding.code, binding.value));
    bindings.dedup();
    bindings
}

/// A control's name in profiles.
fn name_of(Binding { code, value, .. }: Binding) -> String {
    match code {
        Code::Axis(_) => format!("{code}{}", if value < 0 { '-' } else { '+' }),
        Code::Key(_) | Code::Relative(_) => code.to_string(),
    }
}

/// The words between `+`; one right behind an axis is its direction.
fn split(text: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    for part in text.split('+') {
        let part = part.split_whitespace().collect::<Vec<_>>().join(" ");
        match words.last_mut() {
            Some(last)
                if part.is_empty()
                    && last.to_ascii_uppercase().starts_with("ABS_")
                    && !last.ends_with('+') =>
            {
                last.push('+');
            }
            _ => words.push(part),
        }
    }
    words
}
