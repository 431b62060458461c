//! What the tests of the virtual pad share: profiles with the shipped numbers, and a host's ear.

use firmware_proto::frame::Message;
use firmware_proto::link::MessageReceiver;

use crate::control::{Code, Device};
use crate::mapping::profile::{Action, Binding, Button, Dpad, DpadMode, Force, Profile};

pub(super) const HAT_X: Code = Code::Axis(0x10);
pub(super) const HAT_Y: Code = Code::Axis(0x11);
pub(super) const SOUTH: Code = Code::Key(0x130);
pub(super) const EAST: Code = Code::Key(0x131);

const fn key(code: Code) -> Binding {
    Binding { code, value: 1 }
}

fn dpad(mode: DpadMode, diagonal_deg: f32) -> Dpad {
    Dpad {
        mode,
        centre_radius_mm: 8.0,
        radius_hysteresis_mm: 1.5,
        diagonal_deg,
        hysteresis_deg: 8.0,
        rotation_deg: 0.0,
        min_force_n: 0.3,
        release_force_n: 0.2,
        up: Binding { code: HAT_Y, value: -1 },
        down: Binding { code: HAT_Y, value: 1 },
        left: Binding { code: HAT_X, value: -1 },
        right: Binding { code: HAT_X, value: 1 },
    }
}

fn profile(name: &str, dpad: Dpad, buttons: &[Button]) -> Profile {
    Profile {
        name: name.to_owned(),
        output: Device::Gamepad,
        filter_samples: 6,
        min_press_us: 40_000,
        dpad: Some(dpad),
        buttons: buttons.iter().copied().collect(),
    }
}

/// super-mario, tetris, tank-battle, contra.
pub(super) fn shipped_profiles() -> [Profile; 4] {
    let press = |force, press_n, release_n, action| Button { force, press_n, release_n, action };
    let tap_hold = Action::TapHold { tap: key(SOUTH), hold: key(EAST), long_press_us: 400_000 };
    let press_or_hold = [press(Force::Fz, 2.0, 1.4, tap_hold)];
    let jump_and_fire = [
        press(Force::Fz, 2.0, 1.4, Action::Hold(key(SOUTH))),
        press(Force::FyPositive, 1.2, 0.8, Action::Hold(key(EAST))),
    ];
    [
        profile("super-mario", dpad(DpadMode::FourWay, 45.0), &press_or_hold),
        profile("tetris", dpad(DpadMode::FourWaySticky, 30.0), &press_or_hold),
        profile("tank-battle", dpad(DpadMode::FourWaySticky, 30.0), &press_or_hold),
        profile("contra", dpad(DpadMode::EightWay, 45.0), &jump_and_fire),
    ]
}

/// Every message in `bytes`, all of which must be good.
pub(super) fn messages(bytes: &[u8]) -> Vec<Message> {
    let mut receiver = MessageReceiver::new();
    bytes.iter().filter_map(|byte| receiver.push(*byte)).map(|message| message.unwrap()).collect()
}
