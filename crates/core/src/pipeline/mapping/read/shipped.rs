//! The profiles that are inside the program, so that it runs from any folder.

const SHIPPED: [(&str, &str); 16] = [
    ("super-mario", include_str!("../../../../../../mappings/super-mario.toml")),
    ("tetris", include_str!("../../../../../../mappings/tetris.toml")),
    ("tank-battle", include_str!("../../../../../../mappings/tank-battle.toml")),
    ("contra", include_str!("../../../../../../mappings/contra.toml")),
    ("pointer", include_str!("../../../../../../mappings/pointer.toml")),
    ("one-button", include_str!("../../../../../../mappings/one-button.toml")),
    ("super-mario-left", include_str!("../../../../../../mappings/super-mario-left.toml")),
    ("super-mario-light", include_str!("../../../../../../mappings/super-mario-light.toml")),
    ("supertux", include_str!("../../../../../../mappings/supertux.toml")),
    ("vitetris", include_str!("../../../../../../mappings/vitetris.toml")),
    ("btanks", include_str!("../../../../../../mappings/btanks.toml")),
    ("tablet", include_str!("../../../../../../mappings/tablet.toml")),
    ("touchpad", include_str!("../../../../../../mappings/touchpad.toml")),
    ("board-seated", include_str!("../../../../../../mappings/board-seated.toml")),
    ("board-standing", include_str!("../../../../../../mappings/board-standing.toml")),
    ("vitetris-board", include_str!("../../../../../../mappings/vitetris-board.toml")),
];

/// The names under which profiles are shipped.
pub fn names() -> impl Iterator<Item = &'static str> {
    SHIPPED.iter().map(|(name, _)| *name)
}

/// The TOML text of the shipped profile `name`, or `None` if there is none of that name.
pub fn text(name: &str) -> Option<&'static str> {
    SHIPPED.iter().find(|(shipped, _)| *shipped == name).map(|(_, text)| *text)
}

/// The profiles' language as a JSON Schema, which editors read.
pub const fn schema() -> &'static str {
    include_str!("../../../../../../mappings/profile.schema.json")
}

/// The first line of a profile beside which the schema lies: editors look for it.
pub const SCHEMA_LINE: &str = "#:schema ./profile.schema.json\n";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::control::{Code, OutputDevice};
    use crate::pipeline::mapping::profile::{
        Action, Binding, DpadMode, Effect, Force, HoldOn, Keys, Mode, Output, Profile, TimedEffect,
    };
    use crate::pipeline::mapping::read::check::{OutputChoice, read};

    const SOUTH: Binding = Binding { device: OutputDevice::Gamepad, code: Code::Key(0x130), value: 1 };
    const EAST: Binding = Binding { device: OutputDevice::Gamepad, code: Code::Key(0x131), value: 1 };
    const KEY_Z: Binding = Binding { device: OutputDevice::Keyboard, code: Code::Key(44), value: 1 };
    const KEY_X: Binding = Binding { device: OutputDevice::Keyboard, code: Code::Key(45), value: 1 };

    fn plain(binding: Binding) -> Effect {
        Effect { output: Output::Keys(Keys::new([binding])), mode: Mode::Plain }
    }

    fn shipped(name: &str, output: OutputChoice) -> Profile {
        read(text(name).unwrap(), output).0.unwrap()
    }

    /// Force, press and release threshold of every button.
    fn forces(profile: &Profile) -> Vec<(Force, f32, f32)> {
        profile.buttons.iter().map(|button| (button.force, button.press_n, button.release_n)).collect()
    }

    #[test]
    fn one_button_games_tap_and_hold() {
        for (name, mode) in [
            ("super-mario", DpadMode::FourWay),
            ("tetris", DpadMode::FourWaySticky),
            ("tank-battle", DpadMode::FourWaySticky),
        ] {
            for (output, tap, hold) in
                [(OutputChoice::AsWritten, SOUTH, EAST), (OutputChoice::Keyboard, KEY_Z, KEY_X)]
            {
                let profile = shipped(name, output);
                assert_eq!(profile.dpad.map(|dpad| dpad.mode), Some(mode));
                assert_eq!(forces(&profile), [(Force::Fz, 2.0, 1.4)]);
                let hold = Some(TimedEffect { effect: plain(hold), us: 400_000 });
                assert_eq!(
                    profile.buttons[0].action,
                    Action::ByTime { tap: plain(tap), double: None, hold, hold_on: HoldOn::Time }
                );
            }
        }
    }

    #[test]
    fn contra_jumps_and_fires() {
        for (output, jump, fire) in
            [(OutputChoice::AsWritten, SOUTH, EAST), (OutputChoice::Keyboard, KEY_Z, KEY_X)]
        {
            let profile = shipped("contra", output);
            assert_eq!(profile.dpad.map(|dpad| dpad.mode), Some(DpadMode::EightWay));
            assert_eq!(forces(&profile), [(Force::Fz, 2.0, 1.4), (Force::FyPositive, 1.2, 0.8)]);
            let actions: Vec<_> = profile.buttons.iter().map(|button| button.action).collect();
            assert_eq!(actions, [Action::Hold(plain(jump)), Action::Hold(plain(fire))]);
        }
    }

    #[test]
    fn pointer_plays_on_the_mouse_alone() {
        for output in [OutputChoice::AsWritten, OutputChoice::Keyboard] {
            let profile = shipped("pointer", output);
            let used = [OutputDevice::Gamepad, OutputDevice::Keyboard, OutputDevice::Pointer]
                .map(|device| profile.uses(device));
            assert_eq!(used, [false, false, true]);
            assert_eq!(forces(&profile), [(Force::Fz, 2.0, 1.4), (Force::FxPositive, 1.2, 0.8)]);
            let codes: Vec<_> = profile.bindings().map(|binding| binding.code).collect();
            assert_eq!(codes, [Code::Key(0x110), Code::Key(0x111)], "left and right");
        }
    }

    #[test]
    fn every_name_has_a_text_and_no_other() {
        assert_eq!(
            names().collect::<Vec<_>>(),
            [
                "super-mario",
                "tetris",
                "tank-battle",
                "contra",
                "pointer",
                "one-button",
                "super-mario-left",
                "super-mario-light",
                "supertux",
                "vitetris",
                "btanks",
                "tablet",
                "touchpad",
                "board-seated",
                "board-standing",
                "vitetris-board"
            ]
        );
        assert!(names().all(|name| text(name).is_some_and(|text| text.starts_with(SCHEMA_LINE))));
        assert_eq!(text("Contra"), None);
    }
}
