//! Text of a changed number.

use serde::Serialize;

use super::fitting::Change;
use super::knobs::Key;
use tactpad_core::pipeline::mapping::plain::settings::amount;
use tactpad_core::pipeline::mapping::profile::Profile;
use tactpad_core::toml_text::edit::Table;

/// A changed number for people and programs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChangedNumber {
    /// The key with the table it stands in, as `button.1.press_n`.
    pub key: String,
    /// What it was; nothing where it was not there and meant nothing then.
    pub from: Option<f64>,
    /// What it is.
    pub to: f64,
    /// What that means.
    pub words: String,
}

/// Keys, each with the table it stands in (none where any will do) and what it says of its value.
const MEANINGS: &[(&str, &str, &str)] = &[
    ("", "centre_x_mm", "the hand's centre is {} to the right of the plate's"),
    ("", "centre_y_mm", "the hand's centre is {} above the plate's"),
    ("dpad", "rotation_deg", "directions are turned by {}, counter-clockwise"),
    ("dpad", "min_force_n", "a direction begins at {}"),
    ("dpad", "release_force_n", "a direction ends below {}"),
    ("dpad", "centre_radius_mm", "a direction begins {} from the centre"),
    ("dpad", "radius_hysteresis_mm", "a direction ends {} closer to the centre than it begins"),
    ("dpad", "hysteresis_mm", "a held direction reaches {} into its neighbours, along the arc"),
    ("dpad", "diagonal_deg", "a diagonal is {} wide"),
    ("pointer", "min_force_n", "the pointer starts at {}"),
    ("pointer", "release_force_n", "the pointer rests below {}"),
    ("stick", "min_force_n", "it starts at {}"),
    ("stick", "release_force_n", "it rests below {}"),
    ("trigger", "from_n", "it rests up to {}"),
    ("trigger", "full_n", "it is at its end from {} on"),
    ("zone", "inner_radius_mm", "it begins {} from the centre"),
    ("zone", "outer_radius_mm", "it ends {} from the centre"),
    ("zone", "radius_hysteresis_mm", "while the finger is in it, it reaches {} farther in and out"),
    ("button", "press_n", "a press begins at {}"),
    ("button", "release_n", "a press ends below {}"),
    ("button", "hair_n", "a press ends {} below its highest force"),
    ("button", "hard_press_n", "a press is hard from {} on"),
    ("button", "hard_release_n", "a press is no longer hard below {}"),
    ("button", "long_press_ms", "a press is long from {} on"),
    ("button", "double_press_ms", "a second press is one of a double press up to {} after the first"),
    ("button", "dwell_ms", "a press counts once the finger has rested for {}"),
    ("button", "dwell_mm", "a finger rests if it stays within {}"),
    ("access", "tremor_hz", "what trembles faster than {} is calmed"),
    ("access", "rest_n", "a touch is {} more than what rests"),
    ("access", "slow_ms", "a press counts once it has lasted {}"),
    ("access", "bounce_ms", "a press that begins less than {} after the last one does not count"),
];

/// A key with the table it stands in, as `button.1.press_n`.
pub fn path((table, key): Key) -> String {
    match table {
        Table::Root => key.to_owned(),
        Table::Named(name) => format!("{name}.{key}"),
        Table::Listed(name, index) => format!("{name}.{}.{key}", index + 1),
    }
}

impl ChangedNumber {
    /// Says what a change means in this profile.
    pub fn of(change: &Change, profile: &Profile) -> Self {
        let Change { table, key, from, to } = *change;
        let (name, whose) = match table {
            Table::Root => ("", String::new()),
            Table::Named(name) => (name, String::new()),
            Table::Listed(name, index) => {
                let zone = profile.zones.get(index).filter(|_| name == "zone");
                let whose = zone.map_or_else(
                    || format!("{name} {}", index + 1),
                    |zone| format!("zone \"{}\"", zone.name),
                );
                (name, format!("{whose}: "))
            }
        };
        let meaning = MEANINGS.iter().find(|(table, known, _)| *table == name && *known == key);
        let meaning = meaning.map_or("it is {}", |(_, _, meaning)| *meaning);
        let place = if name.is_empty() { key.to_owned() } else { format!("{name}.{key}") };
        let before = from.map_or_else(|| "not at all".to_owned(), |from| amount(&place, from));
        let said = meaning.replace("{}", &amount(&place, to));
        Self { key: path((table, key)), from, to, words: format!("{whose}{said}; before: {before}") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tuning::force_range::levels;
    use crate::tuning::knobs;
    use tactpad_core::pipeline::mapping::read::check::{OutputChoice, read};

    /// A profile with everything that is fitted.
    const TEXT: &str = "schema = 1\nname = \"All\"\noutput = \"gamepad\"\naccess = { tremor_hz = 2 }\n\
        [dpad]\nmode = \"8way\"\n[[zone]]\nname = \"ring\"\ninner_radius_mm = 5\nouter_radius_mm = 15\n\
        [[button]]\nzone = \"ring\"\nforce = \"fz\"\npress_n = 2\nrelease_n = 1\ndwell_ms = 300\n\
        tap = { gamepad = \"BTN_SOUTH\", keyboard = \"KEY_Z\" }\ndouble = { gamepad = \"BTN_EAST\", keyboard = \"KEY_X\" }\n\
        hold = { gamepad = \"BTN_WEST\", keyboard = \"KEY_C\" }\n\
        [[button]]\nforce = \"fx\"\npress_n = 1\nlight = { gamepad = \"BTN_TL\", keyboard = \"KEY_A\" }\n\
        hard = { gamepad = \"BTN_TR\", keyboard = \"KEY_S\" }\nhard_press_n = 3\n";

    #[test]
    fn each_number_that_is_fitted_has_its_words() {
        let profile = read(TEXT, OutputChoice::AsWritten).0.unwrap();
        let knobs = knobs::all(&profile, TEXT);
        assert!(knobs.len() >= 18, "{}", knobs.len());
        for knob in knobs {
            let (table, key) = knob.key;
            let told = ChangedNumber::of(&Change { table, key, from: knob.present, to: 1.0 }, &profile);
            assert!(!told.words.contains("it is"), "{}", told.words);
            assert_eq!(knob.values.iter().filter(|value| **value == knob.present).count(), 1, "{key}");
        }
        let change =
            Change { table: Table::Listed("zone", 0), key: "outer_radius_mm", from: Some(15.0), to: 6.5 };
        let told = ChangedNumber::of(&change, &profile);
        assert_eq!(told.words, "zone \"ring\": it ends 6.5 mm from the centre; before: 15 mm");
        assert_eq!(told.key, "zone.1.outer_radius_mm");
    }

    #[test]
    fn each_force_that_is_fitted_to_a_hand_has_its_words() {
        let text = "schema = 1\nname = \"All\"\noutput = \"gamepad\"\n[dpad]\n[pointer]\n[[stick]]\nstick = \"left\"\n\
            [[trigger]]\ntrigger = \"left\"\n[[button]]\nforce = \"fz\"\npress_n = 2\nhair_n = 0.2\n\
            light = { gamepad = \"BTN_TL\", keyboard = \"KEY_A\" }\nhard = { gamepad = \"BTN_TR\", keyboard = \"KEY_S\" }\n\
            hard_press_n = 3\n";
        let profile = read(text, OutputChoice::AsWritten).0.unwrap();
        let levels = levels::all(&profile, text);
        assert_eq!(levels.len(), 7);
        let releases = [("pointer", "release_force_n"), ("access", "rest_n")]
            .map(|(name, key)| (Table::Named(name), key));
        let listed = [("stick", "release_force_n"), ("button", "hair_n")]
            .map(|(name, key)| (Table::Listed(name, 0), key));
        for (table, key) in levels.iter().map(|level| level.key).chain(releases).chain(listed) {
            let told = ChangedNumber::of(&Change { table, key, from: Some(2.0), to: 1.0 }, &profile);
            assert!(!told.words.contains("it is 1 N"), "{}", told.words);
        }
    }
}
