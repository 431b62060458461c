//! What holds for every profile and every contact.

use proptest::prelude::{Just, Strategy, any, prop, prop_assert, prop_assert_eq, prop_oneof, proptest};
use tactpad::pipeline::control::Code;
use tactpad::pipeline::mapping::live::engine::Engine;
use tactpad::pipeline::mapping::live::intent::Intents;
use tactpad::pipeline::mapping::profile::{Action, Effect, Mode, POINTER_SPEED_MAX, Profile};
use tactpad::pipeline::mapping::read::check::{OutputChoice, read};
use tactpad::pipeline::mapping::read::shipped;
use tactpad::quantity::Contact;
use tactpad::time::StreamInstant;

/// Eight directions, the pointer, six buttons, some on the same controls: as much as can go wrong at once.
const CROWDED: &str = r#"
schema = 1
name = "Crowded"
output = "gamepad"
[dpad]
mode = "8way"
rotation_deg = 170
[dpad.keyboard]
up = "KEY_Z"
[pointer]
speed_counts_per_s = 5000
[[button]]
force = "fz"
press_n = 1
tap = { pointer = "BTN_LEFT" }
hold = { gamepad = "BTN_SOUTH", keyboard = "KEY_Z" }
[[button]]
force = "fz"
press_n = 1
out = { gamepad = "BTN_SOUTH", keyboard = "KEY_Z" }
[[button]]
force = "fx"
press_n = 1
tap = { gamepad = "BTN_SOUTH", keyboard = "KEY_Z" }
hold = { gamepad = "BTN_EAST", keyboard = "KEY_X" }
long_press_ms = 50
hold_on_other_key_press = true
[[button]]
force = "-fx"
press_n = 1
out = { gamepad = "BTN_WEST", keyboard = "KEY_A" }
[[button]]
force = "fy"
press_n = 1
out = { gamepad = "BTN_NORTH", keyboard = "KEY_S" }
[[button]]
force = "-fy"
press_n = 0.5
tap = { gamepad = "BTN_TL", keyboard = "KEY_Q" }
hold = { gamepad = "BTN_TL", keyboard = "KEY_W" }
long_press_ms = 50
"#;

/// Keys together, toggled, in turbo, and by double presses.
const LIVELY: &str = r#"
schema = 1
name = "Lively"
output = "keyboard"
[dpad]
mode = "8way"
[dpad.keyboard]
up = "KEY_LEFTSHIFT+KEY_W"
[[button]]
force = "fz"
press_n = 1
tap = { gamepad = "BTN_SOUTH", keyboard = "KEY_LEFTCTRL+KEY_C" }
double = { gamepad = "BTN_EAST", keyboard = "KEY_LEFTSHIFT+KEY_C", turbo_ms = 80 }
hold = { gamepad = "BTN_WEST", keyboard = "KEY_X", toggle = true }
double_press_ms = 60
long_press_ms = 90
[[button]]
force = "fx"
press_n = 1
out = { gamepad = "BTN_NORTH", keyboard = "KEY_Y+KEY_Z", toggle = true }
[[button]]
force = "-fx"
press_n = 1
out = { pointer = "BTN_LEFT+BTN_RIGHT", turbo_ms = 100 }
[[button]]
force = "fy"
press_n = 1
tap = { gamepad = "BTN_TL+BTN_TR", keyboard = "KEY_Q", toggle = true }
"#;

/// Zones, stages, hair triggers, another hand.
const PLACED: &str = r#"
schema = 1
name = "Placed"
output = "gamepad"
left_handed = true
[access]
slow_ms = 20
bounce_ms = 40
tremor_hz = 2
[gain]
up = 1.5
left = 0.5
[dpad]
mode = "8way"
hysteresis_mm = 2.5
rotation_deg = 30
[[zone]]
name = "top"
from_deg = 30
to_deg = 150
inner_radius_mm = 5
[[zone]]
name = "ring"
inner_radius_mm = 8
outer_radius_mm = 16
[[button]]
force = "fz"
press_n = 1
zone = "top"
light = { gamepad = "BTN_SOUTH", keyboard = "KEY_Z" }
hard = { gamepad = "BTN_EAST", keyboard = "KEY_X", toggle = true }
hard_press_n = 2
skip = "may"
skip_ms = 30
[[button]]
force = "fz"
press_n = 1
zone = "ring"
light = { gamepad = "BTN_TL", keyboard = "KEY_A" }
hard = { gamepad = "BTN_TR", keyboard = "KEY_S", turbo_ms = 80 }
hard_press_n = 2
skip = "must"
skip_ms = 30
[[button]]
force = "fx"
press_n = 1
hair_n = 0.2
dwell_ms = 50
tap = { gamepad = "BTN_NORTH", keyboard = "KEY_Q", sticky = true }
hold = { gamepad = "BTN_WEST", keyboard = "KEY_W" }
long_press_ms = 60
[[button]]
force = "fz"
press_n = 2
zone = "left"
out = { pointer = "BTN_LEFT" }
"#;

/// Layers, macros, commands, axes, a hand that rests.
const LAYERED: &str = r#"
schema = 1
name = "Layered"
output = "gamepad"
[access]
rest_n = 0.5
slow_ms = 10
[dpad]
[[layer]]
name = "menu"
gamepad = { up = "BTN_SELECT", left = "BTN_MODE" }
keyboard = { up = "KEY_PAGEUP", left = "KEY_HOME" }
[[macro]]
name = "combo"
steps = [
  { gamepad = "ABS_HAT0Y++ABS_HAT0X+", keyboard = "KEY_DOWN+KEY_RIGHT" },
  { wait_ms = 20 },
  { gamepad = "BTN_SOUTH", keyboard = "KEY_Z", for_ms = 60 },
  { pointer = "BTN_MIDDLE" },
]
[[stick]]
stick = "left"
centre_radius_mm = 2
[[stick]]
stick = "right"
from = "shear"
curve = 2
[[trigger]]
trigger = "left"
zone = "up"
[[button]]
force = "fx"
press_n = 1
tap = { macro = "combo" }
hold = { layer = "menu", toggle = true }
long_press_ms = 60
permissive_hold = true
[[button]]
force = "-fx"
press_n = 1
out = { layer = "menu", sticky = true }
[[button]]
force = "fy"
press_n = 1
layer = "menu"
tap = { bridge = "next-profile" }
hold = { gamepad = "BTN_START", keyboard = "KEY_ENTER", toggle = true }
long_press_ms = 60
[[button]]
force = "fz"
press_n = 1
layer = "base"
out = { gamepad = "BTN_SOUTH", keyboard = "KEY_Z" }
"#;

/// Whether keys may be down while nothing touches the plate: toggled ones, a macro, or the tap that might have become a
/// double press.
fn may_hold_untouched(profile: &Profile) -> bool {
    let toggles =
        |effect: &Option<_>| matches!(effect, Some(Effect { mode: Mode::Toggle | Mode::Sticky, .. }));
    let has_macros = !profile.macros.is_empty();
    has_macros
        || profile.buttons.iter().any(|button| {
            button.effects().iter().any(toggles)
                || matches!(button.action, Action::ByTime { double: Some(_), .. })
        })
}

#[derive(Clone, Debug)]
enum Call {
    Step(Option<Contact>),
    Cancel,
    Replace(Box<Profile>),
}

fn profiles() -> impl Strategy<Value = Profile> {
    let texts: Vec<_> =
        shipped::names().filter_map(shipped::text).chain([CROWDED, LIVELY, PLACED, LAYERED]).collect();
    let output = prop_oneof![Just(OutputChoice::AsWritten), Just(OutputChoice::Keyboard)];
    (prop::sample::select(texts), output)
        .prop_filter_map("a usable profile", |(text, output)| read(text, output).0)
}

fn contacts() -> impl Strategy<Value = Contact> {
    let number = || prop_oneof![8 => -30.0f32..30.0, 4 => -3.0f32..3.0, 1 => prop::num::f32::ANY];
    let fields = [number(), number(), number(), number(), number()];
    fields.prop_map(|[x_mm, y_mm, fx_n, fy_n, fz_n]| Contact { x_mm, y_mm, fx_n, fy_n, fz_n })
}

fn calls() -> impl Strategy<Value = Vec<(u64, Call)>> {
    let call = prop_oneof![
        20 => contacts().prop_map(|contact| Call::Step(Some(contact))),
        3 => Just(Call::Step(None)),
        1 => Just(Call::Cancel),
        1 => profiles().prop_map(|profile| Call::Replace(Box::new(profile))),
    ];
    prop::collection::vec((0..100_000u64, call), 1..60)
}

fn is_finite(contact: &Contact) -> bool {
    [contact.x_mm, contact.y_mm, contact.fx_n, contact.fy_n, contact.fz_n].iter().all(|n| n.is_finite())
}

/// Levels that any game can take: each control once, values in range, all on devices that the profile uses.
fn assert_sound(levels: &Intents, profile: &Profile) {
    for (index, level) in levels.iter().enumerate() {
        assert!(levels.iter().skip(index + 1).all(|other| other.code != level.code), "twice in {levels:?}");
        assert!(profile.uses(level.device), "{level:?}");
        match level.code {
            Code::Relative(_) => {
                assert!(level.value != 0 && level.value.abs() <= POINTER_SPEED_MAX, "{level:?}");
            }
            Code::Axis(0..6) => {
                assert!(level.value != 0 && (-32_768..32_768).contains(&level.value), "{level:?}");
            }
            Code::Key(_) | Code::Axis(_) => assert!(level.value == 1 || level.value == -1, "{level:?}"),
        }
    }
}

#[test]
fn the_profiles_of_these_tests_are_usable() {
    for text in [CROWDED, LIVELY, PLACED, LAYERED] {
        let (profile, found) = read(text, OutputChoice::Keyboard);
        assert!(profile.is_some(), "{found:?}");
    }
}

proptest! {
    #[test]
    fn levels_are_sound_whatever_happens(profile in profiles(), calls in calls()) {
        let mut engine = Engine::new(profile);
        let mut us = 0;
        let mut lifted = true;
        for (pause_us, call) in calls {
            us += pause_us;
            match call {
                Call::Step(contact) => {
                    let levels = engine.step(StreamInstant::from_us(us), contact.as_ref());
                    assert_sound(&levels, engine.profile());
                    let unusable = contact.is_some_and(|contact| !is_finite(&contact));
                    prop_assert!(levels.is_empty() || !unusable, "not a number gives {levels:?}");
                    let untouched = lifted && contact.is_none() && !may_hold_untouched(engine.profile());
                    let held_by_nothing = untouched && !levels.is_empty();
                    prop_assert!(!held_by_nothing, "nothing on the pad gives {levels:?}");
                    lifted = contact.is_none();
                }
                Call::Cancel => {
                    engine.cancel();
                    lifted = true;
                }
                Call::Replace(profile) => engine.replace_profile(*profile),
            }
        }
        engine.step(StreamInstant::from_us(us + 1), None);
        let untouched = engine.step(StreamInstant::from_us(us + 2), None);
        prop_assert!(untouched.is_empty() || may_hold_untouched(engine.profile()));
        engine.cancel();
        prop_assert!(engine.step(StreamInstant::from_us(us + 3), None).is_empty());
    }

    #[test]
    fn what_is_held_long_enough_counts(
        (slow_ms, bounce_ms) in (0..400_u64, 0..400_u64),
        // Times in milliseconds, and what the finger does meanwhile: right, the middle, pressing there, off the pad.
        history in prop::collection::vec((1..500_u64, 0..4_usize), 0..12),
        is_pressed in any::<bool>(),
    ) {
        let text = format!(
            "schema = 1\nname = \"Held\"\noutput = \"gamepad\"\nfilter_samples = 1\nmin_press_ms = 10\n[access]\n\
             slow_ms = {slow_ms}\nbounce_ms = {bounce_ms}\n[dpad]\n[[button]]\nforce = \"fz\"\npress_n = 2\nout = \
             {{ gamepad = \"BTN_SOUTH\", keyboard = \"KEY_Z\" }}\n"
        );
        let mut engine = Engine::new(read(&text, OutputChoice::AsWritten).0.unwrap());
        let contact = |x_mm, fz_n| Some(Contact { x_mm, fz_n, ..Contact::default() });
        let does = [contact(20.0, 1.0), contact(0.0, 1.0), contact(0.0, 3.0), None];
        let held = if is_pressed { does[2] } else { does[0] };
        let mut ms = 0;
        let mut step = |finger: Option<Contact>| {
            ms += 1;
            !engine.step(StreamInstant::from_us(1_000 * ms), finger.as_ref()).is_empty()
        };
        for (during_ms, what) in history {
            for _ in 0..during_ms {
                step(does[what]);
            }
        }
        (0..slow_ms.max(bounce_ms)).for_each(|_| {
            step(held);
        });
        prop_assert!(step(held), "held for {} ms", slow_ms.max(bounce_ms));
    }

    #[test]
    fn the_same_calls_give_the_same_levels(profile in profiles(), calls in calls()) {
        let run = || {
            let mut engine = Engine::new(profile.clone());
            let mut all = Vec::new();
            for (us, call) in calls.clone() {
                match call {
                    Call::Step(contact) => {
                        all.push(engine.step(StreamInstant::from_us(us), contact.as_ref()));
                    }
                    Call::Cancel => engine.cancel(),
                    Call::Replace(profile) => engine.replace_profile(*profile),
                }
            }
            all
        };
        prop_assert_eq!(run(), run());
    }

    #[test]
    fn any_text_is_read_without_a_panic(text in ".{0,200}") {
        let (profile, found) = read(&text, OutputChoice::AsWritten);
        prop_assert!(profile.is_some() || !found.is_empty());
    }

    #[test]
    fn a_damaged_profile_is_read_without_a_panic(
        name in prop::sample::select(shipped::names().collect::<Vec<_>>()),
        at in any::<prop::sample::Index>(),
        length in 0usize..40,
        insert in r#"[\[\]{}="'.,#\n a-z0-9+-]{0,12}|nan|inf|\PC{0,4}"#,
    ) {
        let letters: Vec<char> = shipped::text(name).unwrap().chars().collect();
        let start = at.index(letters.len());
        let end = (start + length).min(letters.len());
        let (before, after) = (letters[..start].iter().copied(), letters[end..].iter().copied());
        let text: String = before.chain(insert.chars()).chain(after).collect();
        let (profile, found) = read(&text, OutputChoice::Keyboard);
        let lines = text.split('\n').count();
        for finding in &found {
            prop_assert!((1..=lines).contains(&finding.line), "{finding:?}");
            prop_assert!(!finding.message.contains('\n'), "{finding:?}");
        }
        prop_assert!(profile.is_some() || !found.is_empty());
    }
}
