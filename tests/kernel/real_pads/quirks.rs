//! What real devices do beside strokes: worn tips, palms, erasers, pens that never leave, and a gesture in a recording.

use evdev::KeyCode;

use super::hand::{Hand, Pose};
use super::{device, gesture, press};
use crate::bridge::TACTPAD;
use crate::owned_pads::{comes_true, pause, start};
use crate::program::Running;
use crate::reader::find;

const RIGHT: Pose = Pose { x: 0.95, y: 0.5, pressure: 0.25, distance: 0.0 };

/// What a press to the right is.
const TO_THE_RIGHT: [(&str, i32); 2] = [("ABS_HAT0X", 1), ("ABS_HAT0X", 0)];

/// Each quirk, and that a sound press plays after it.
pub(crate) fn quirks() {
    for (name, source, quirk) in [
        ("wacom-intuos5-pen", "tablet", worn as fn(&mut Hand)),
        ("wacom-cintiq-pro-16-pen", "tablet", away_without_a_lift),
        ("huion-pentablet", "tablet", side_button_in_play),
        ("synaptics-rmi4", "touchpad", palm),
        ("synaptics-pressurepad", "touchpad", palm),
    ] {
        let mut hand = Hand::plug_in(device(name));
        let (program, mut gamepad) = start(source, &[]);
        quirk(&mut hand);
        pause(200);
        gamepad.read_available();
        let expected: &[_] = if name.starts_with("wacom-cintiq") { &TO_THE_RIGHT } else { &[] };
        assert_eq!(gamepad.edges(), expected, "{name}: {}", program.complaints());
        gamepad.seen.clear();
        let pressure = if hand.is_pen() { 0.25 } else { 0.15 };
        press(&mut hand, &Pose { pressure, ..RIGHT });
        gamepad.read_available();
        assert_eq!(gamepad.edges(), TO_THE_RIGHT, "{name} after it: {}", program.complaints());
        drop(program);
        comes_true("the gamepad goes", || find(KeyCode::BTN_SOUTH).is_none());
    }
}

/// A worn tip tells pressure and a touch in the air, at the side.
fn worn(hand: &mut Hand) {
    hand.come(&Pose { pressure: 0.15, distance: 0.9, ..RIGHT });
    for distance in [0.8, 0.6, 0.4, 0.2] {
        hand.touch(&Pose { pressure: 0.15, distance, ..RIGHT }, true);
        pause(50);
    }
    hand.lift(&Pose { distance: 0.5, ..RIGHT });
    hand.leave();
}

/// A pen is torn away while it presses: the tablet says that it has left, and nothing of a lift.
fn away_without_a_lift(hand: &mut Hand) {
    hand.come(&Pose { pressure: 0.0, distance: 0.5, ..RIGHT });
    hand.touch(&RIGHT, true);
    pause(150);
    hand.leave();
    pause(150);
    hand.lift(&Pose { x: 0.9, ..RIGHT });
}

/// A grip that holds the side button is no gesture and no press.
fn side_button_in_play(hand: &mut Hand) {
    hand.come(&Pose { x: 0.5, ..Pose { pressure: 0.0, ..RIGHT } });
    for k in 0..40 {
        hand.hover(&Pose { x: 0.3 + 0.01 * f64::from(k), pressure: 0.0, ..RIGHT }, 1);
        pause(50);
    }
    hand.hover(&Pose { x: 0.6, pressure: 0.0, ..RIGHT }, 0);
    hand.leave();
}

/// A palm lies on the touchpad, first or as what a finger turned out to be.
fn palm(hand: &mut Hand) {
    hand.palm(&Pose { pressure: 0.8, ..RIGHT });
    pause(300);
    hand.lift(&RIGHT);
    pause(50);
}

/// A gesture that pauses a recording replays to the same events.
pub(crate) fn recorded() {
    let mut hand = Hand::plug_in(device("wacom-bamboo-16fg-pen"));
    let folder = tempfile::tempdir().expect("a folder");
    let record = ["record", "left.cap", "--pad", "tablet", "--output", "log:live", "--seconds", "5"];
    let mut program =
        Running::start_command(std::process::Command::new(TACTPAD).args(record).current_dir(folder.path()));
    let capture = folder.path().join("left.cap");
    comes_true("the capture", || capture.metadata().is_ok_and(|file| file.len() > 0));
    pause(300);
    press(&mut hand, &RIGHT);
    gesture(&mut hand, true);
    pause(1_700);
    gesture(&mut hand, false);
    press(&mut hand, &Pose { x: 0.05, ..RIGHT });
    assert!(program.wait(5_000).success(), "{}", program.complaints());
    let live = std::fs::read_to_string(folder.path().join("live")).expect("a log");
    let replayed =
        std::process::Command::new(TACTPAD).args(["replay", "left.cap"]).current_dir(folder.path()).output();
    let replayed = String::from_utf8(replayed.expect("replay runs").stdout).expect("text");
    assert!(live.contains("ABS_HAT0X") && !live.contains("-1"), "{live}");
    assert_eq!(replayed, live);
}
