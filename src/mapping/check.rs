//! From a profile's text to a [`Profile`]: names, types, ranges, and how the numbers stand to each other.
//!
//! `mappings/README.md` documents every key for people. All findings are reported at once.

use arrayvec::ArrayVec;

use super::binding::{DEVICE_KEYS, Outputs, written_or};
use super::conflict::{self, Owner, Use};
use super::profile::{
    Action, BUTTONS_MAX, Button, Dpad, DpadMode, Force, POINTER_SPEED_MAX, Pointer, Profile,
};
use crate::control::Device;
use crate::toml_text;
use crate::toml_text::diag::{Diagnostic, Report};
use crate::toml_text::section::{Bounds, Placed, Section};

/// Which of a profile's two sets of bindings to use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputChoice {
    /// The one that the profile's `output` names.
    AsWritten,
    /// The keyboard's, for outputs that only have keys.
    Keyboard,
}

const FILTER_SAMPLES: Bounds<u32> = Bounds { low: 1, high: 64, default: 6 };
const MIN_PRESS_MS: Bounds<u32> = Bounds { low: 0, high: 1_000, default: 40 };
const LONG_PRESS_MS: Bounds<u32> = Bounds { low: 1, high: 10_000, default: 400 };
/// The plate's radius is 30 mm; on its rim there is nothing left to steer with.
const CENTRE_RADIUS_MM: Bounds<f32> = Bounds { low: 2.0, high: 29.0, default: 8.0 };
const RADIUS_HYSTERESIS_MM: Bounds<f32> = Bounds { low: 0.0, high: 29.0, default: 1.5 };
const ROTATION_DEG: Bounds<f32> = Bounds { low: -180.0, high: 180.0, default: 0.0 };
const HYSTERESIS_DEG: Bounds<f32> = Bounds { low: 0.0, high: 45.0, default: 8.0 };
const DIAGONAL_DEG: Bounds<f32> = Bounds { low: 5.0, high: 85.0, default: 45.0 };
const STICKY_DIAGONAL_DEG: f32 = 30.0;
const FORCE_N: Bounds<f32> = Bounds { low: 0.05, high: 50.0, default: 0.3 };
/// Default of a button's release force over its press force.
const RELEASE_SHARE: f32 = 0.7;
/// Force that starts a direction, or the pointer, over the default of the force that ends it.
const RELEASE_RATIO: f32 = 1.5;
const POINTER_CENTRE_MM: Bounds<f32> = Bounds { default: 5.0, ..CENTRE_RADIUS_MM };
const FULL_RADIUS_MM: Bounds<f32> = Bounds { low: 3.0, high: 30.0, default: 24.0 };
const SPEED_COUNTS_PER_S: Bounds<f32> = Bounds { low: 10.0, high: POINTER_SPEED_MAX as f32, default: 800.0 };
const CURVE: Bounds<f32> = Bounds { low: 1.0, high: 3.0, default: 2.0 };

const MODES: [(&str, DpadMode); 3] =
    [("4way", DpadMode::FourWay), ("4way-sticky", DpadMode::FourWaySticky), ("8way", DpadMode::EightWay)];
const FORCES: [(&str, Force); 5] = [
    ("fz", Force::Fz),
    ("fy", Force::FyPositive),
    ("-fy", Force::FyNegative),
    ("fx", Force::FxPositive),
    ("-fx", Force::FxNegative),
];
const OUTPUTS: [(&str, Device); 2] = [("gamepad", Device::Gamepad), ("keyboard", Device::Keyboard)];

const ROOT_KEYS: [&str; 8] =
    ["schema", "name", "output", "filter_samples", "min_press_ms", "dpad", "pointer", "button"];
const DPAD_KEYS: [&str; 10] = [
    "mode",
    "centre_radius_mm",
    "radius_hysteresis_mm",
    "diagonal_deg",
    "hysteresis_deg",
    "min_force_n",
    "release_force_n",
    "rotation_deg",
    "gamepad",
    "keyboard",
];
const POINTER_KEYS: [&str; 6] =
    ["centre_radius_mm", "full_radius_mm", "speed_counts_per_s", "curve", "min_force_n", "release_force_n"];
const BUTTON_KEYS: [&str; 7] = ["force", "press_n", "release_n", "out", "tap", "hold", "long_press_ms"];
const DIRECTION_KEYS: [&str; 4] = ["up", "down", "left", "right"];
/// Each direction with its default bindings on the gamepad and the keyboard.
const DIRECTIONS: [(&str, &str, &str); 4] = [
    ("up", "ABS_HAT0Y-", "KEY_UP"),
    ("down", "ABS_HAT0Y+", "KEY_DOWN"),
    ("left", "ABS_HAT0X-", "KEY_LEFT"),
    ("right", "ABS_HAT0X+", "KEY_RIGHT"),
];

/// Reads a profile from TOML text.
///
/// Returns what there is to say about the text, in its order; after 50 findings a closing one says that there is
/// more. The profile is `None` exactly if there is an error among it; warnings leave it usable. A text above
/// [`toml_text::TEXT_BYTES_MAX`] is not read.
pub fn read(text: &str, output: OutputChoice) -> (Option<Profile>, Vec<Diagnostic>) {
    let mut report = Report::new(text);
    let Some(tree) = toml_text::parse(text, "a profile is a few lines of TOML", &mut report) else {
        return (None, report.finish());
    };
    let root = Section::root(&tree, "the profile", &ROOT_KEYS, &mut report);
    let draft = Draft::read(&root, &mut report);
    draft.check_conflicts(&mut report);
    let profile = if report.failed() { None } else { draft.settle(output) };
    (profile, report.finish())
}

/// A profile while it is read: what is unusable is `None` and reported.
struct Draft {
    name: Option<String>,
    output: Option<Device>,
    filter_samples: Option<usize>,
    min_press_ms: Option<u32>,
    dpad: Option<DpadDraft>,
    /// The inner `None` where a part of it is unusable.
    pointer: Option<Option<Pointer>>,
    buttons: Vec<ButtonDraft>,
}

struct DpadDraft {
    /// All but the bindings.
    shape: Option<Shape>,
    mode: Option<DpadMode>,
    directions: [Outputs; 4],
}

/// The numbers of [`Dpad`].
#[derive(Clone, Copy)]
struct Shape {
    centre_radius_mm: f32,
    radius_hysteresis_mm: f32,
    diagonal_deg: f32,
    hysteresis_deg: f32,
    rotation_deg: f32,
    min_force_n: f32,
    release_force_n: f32,
}

struct ButtonDraft {
    force: Option<Force>,
    press_n: Option<f32>,
    release_n: Option<f32>,
    action: Option<ActionDraft>,
}

enum ActionDraft {
    Hold(Outputs),
    TapHold { tap: Outputs, hold: Outputs, long_press_ms: Option<u32> },
}

impl Draft {
    fn read(root: &Section<'_>, report: &mut Report<'_>) -> Self {
        read_schema(root, report);
        let output = root.word("output", &OUTPUTS, report).map(|word| word.value);
        root.require("output", "write output = \"gamepad\" or output = \"keyboard\"", report);
        let min_press_ms = root.whole("min_press_ms", MIN_PRESS_MS, report).map(|ms| ms.value);
        let dpad = root.table("dpad", "[dpad]".to_owned(), &DPAD_KEYS, report);
        let pointer = root.table("pointer", "[pointer]".to_owned(), &POINTER_KEYS, report);
        // One more than there can be, so that the first one too many is known by its place.
        let buttons = root.tables("button", &BUTTON_KEYS, BUTTONS_MAX + 1, report);
        if ["dpad", "pointer", "button"].iter().all(|key| root.place_of(key).is_none()) {
            report.warning(
                root.at,
                "the profile does nothing",
                "add a [dpad], [pointer] or [[button]] table",
            );
        }
        if let Some(extra) = buttons.get(BUTTONS_MAX) {
            report.error(extra.at, format!("a profile has at most {BUTTONS_MAX} buttons"), "remove this one");
        }
        Self {
            name: read_name(root, report),
            output,
            filter_samples: root
                .whole("filter_samples", FILTER_SAMPLES, report)
                .map(|count| count.value as usize),
            min_press_ms,
            dpad: dpad.map(|dpad| DpadDraft::read(&dpad, report)),
            pointer: pointer.map(|pointer| read_pointer(&pointer, report)),
            buttons: buttons.iter().map(|button| ButtonDraft::read(button, min_press_ms, report)).collect(),
        }
    }

    fn check_conflicts(&self, report: &mut Report<'_>) {
        let mut uses = Vec::new();
        if let Some(DpadDraft { directions, .. }) = &self.dpad {
            let named = directions.iter().zip(DIRECTIONS);
            uses.extend(
                named.map(|(outputs, (name, ..))| Use { owner: Owner::Direction(name), outputs: *outputs }),
            );
        }
        for (number, button) in (1..).zip(&self.buttons) {
            let owner = |role| Owner::Button { number, role };
            match &button.action {
                Some(ActionDraft::Hold(out)) => uses.push(Use { owner: owner("out"), outputs: *out }),
                Some(ActionDraft::TapHold { tap, hold, .. }) => {
                    uses.push(Use { owner: owner("tap"), outputs: *tap });
                    uses.push(Use { owner: owner("hold"), outputs: *hold });
                }
                None => {}
            }
        }
        conflict::check(&uses, self.dpad.as_ref().and_then(|dpad| dpad.mode), report);
    }

    /// The finished profile; `None` if a part of it is missing.
    fn settle(self, choice: OutputChoice) -> Option<Profile> {
        let output = match choice {
            OutputChoice::AsWritten => self.output?,
            OutputChoice::Keyboard => Device::Keyboard,
        };
        let dpad = match self.dpad {
            Some(draft) => Some(draft.settle(output)?),
            None => None,
        };
        let pointer = match self.pointer {
            Some(pointer) => Some(pointer?),
            None => None,
        };
        let mut buttons = ArrayVec::new();
        for draft in self.buttons {
            buttons.try_push(draft.settle(output)?).ok()?;
        }
        Some(Profile {
            name: self.name?,
            output,
            filter_samples: self.filter_samples?,
            min_press_us: u64::from(self.min_press_ms?) * 1_000,
            dpad,
            pointer,
            buttons,
        })
    }
}

fn read_schema(root: &Section<'_>, report: &mut Report<'_>) {
    root.require("schema", "write schema = 1 as the first line", report);
    root.whole("schema", Bounds { low: 1, high: 1, default: 1 }, report);
}

fn read_name(root: &Section<'_>, report: &mut Report<'_>) -> Option<String> {
    root.require("name", "write name = \"…\", the game's name", report);
    root.name("name", report).map(str::to_owned)
}

impl DpadDraft {
    fn read(table: &Section<'_>, report: &mut Report<'_>) -> Self {
        let mode = match table.place_of("mode") {
            Some(_) => table.word("mode", &MODES, report).map(|word| word.value),
            None => Some(DpadMode::FourWay),
        };
        Self { shape: read_shape(table, mode, report), mode, directions: read_directions(table, report) }
    }

    fn settle(self, device: Device) -> Option<Dpad> {
        let [up, down, left, right] = self.directions.map(|outputs| outputs.settle(device));
        let shape = self.shape?;
        Some(Dpad {
            mode: self.mode?,
            centre_radius_mm: shape.centre_radius_mm,
            radius_hysteresis_mm: shape.radius_hysteresis_mm,
            diagonal_deg: shape.diagonal_deg,
            hysteresis_deg: shape.hysteresis_deg,
            rotation_deg: shape.rotation_deg,
            min_force_n: shape.min_force_n,
            release_force_n: shape.release_force_n,
            up: up?,
            down: down?,
            left: left?,
            right: right?,
        })
    }
}

fn read_shape(table: &Section<'_>, mode: Option<DpadMode>, report: &mut Report<'_>) -> Option<Shape> {
    let centre = table.number("centre_radius_mm", CENTRE_RADIUS_MM, report);
    let slack = table.number("radius_hysteresis_mm", RADIUS_HYSTERESIS_MM, report);
    require_less(table, ("radius_hysteresis_mm", slack), ("centre_radius_mm", centre), report);
    let rotation = table.number("rotation_deg", ROTATION_DEG, report);
    let (diagonal, hysteresis) = read_zones(table, mode, report);
    let (min_force_n, release_force_n) = read_gate(table, report);
    Some(Shape {
        centre_radius_mm: centre?.value,
        radius_hysteresis_mm: slack?.value,
        diagonal_deg: diagonal?,
        hysteresis_deg: hysteresis?,
        rotation_deg: rotation?.value,
        min_force_n: min_force_n?,
        release_force_n: release_force_n?,
    })
}

/// The normal forces that start and end a direction, or the pointer, in newtons.
fn read_gate(table: &Section<'_>, report: &mut Report<'_>) -> (Option<f32>, Option<f32>) {
    let min_force = table.number("min_force_n", FORCE_N, report);
    let share = min_force.map_or(FORCE_N.default, |force| force.value) / RELEASE_RATIO;
    let release = table.number("release_force_n", Bounds { low: 0.0, default: share, ..FORCE_N }, report);
    require_less(table, ("release_force_n", release), ("min_force_n", min_force), report);
    (min_force.map(|force| force.value), release.map(|force| force.value))
}

fn read_pointer(table: &Section<'_>, report: &mut Report<'_>) -> Option<Pointer> {
    let centre = table.number("centre_radius_mm", POINTER_CENTRE_MM, report);
    let full = table.number("full_radius_mm", FULL_RADIUS_MM, report);
    require_less(table, ("centre_radius_mm", centre), ("full_radius_mm", full), report);
    let speed = table.number("speed_counts_per_s", SPEED_COUNTS_PER_S, report);
    let curve = table.number("curve", CURVE, report);
    let (min_force_n, release_force_n) = read_gate(table, report);
    Some(Pointer {
        centre_radius_mm: centre?.value,
        full_radius_mm: full?.value,
        speed_counts_per_s: speed?.value,
        curve: curve?.value,
        min_force_n: min_force_n?,
        release_force_n: release_force_n?,
    })
}

/// The width of the diagonal zones and the hysteresis between zones, both in degrees.
fn read_zones(
    table: &Section<'_>,
    mode: Option<DpadMode>,
    report: &mut Report<'_>,
) -> (Option<f32>, Option<f32>) {
    let sticky = mode == Some(DpadMode::FourWaySticky);
    let default = if sticky { STICKY_DIAGONAL_DEG } else { DIAGONAL_DEG.default };
    let diagonal = table.number("diagonal_deg", Bounds { default, ..DIAGONAL_DEG }, report);
    if let (Some(DpadMode::FourWay), Some(at)) = (mode, table.place_of("diagonal_deg")) {
        report.warning(
            at,
            "\"diagonal_deg\" does nothing in mode \"4way\"",
            "remove it, or choose another mode",
        );
    }
    let hysteresis = table.number("hysteresis_deg", HYSTERESIS_DEG, report);
    if sticky {
        if let Some(at) = table.place_of("hysteresis_deg") {
            let message = "\"hysteresis_deg\" does nothing in mode \"4way-sticky\": there the diagonal zone is the \
                           hysteresis";
            report.warning(at, message, "remove it; \"diagonal_deg\" sets how far a direction is kept");
        }
        return (diagonal.map(|width| width.value), hysteresis.map(|_| 0.0));
    }
    if let (Some(mode), Some(width), Some(hysteresis)) = (mode, diagonal, hysteresis) {
        check_hysteresis(table, mode, width, hysteresis.value, report);
    }
    (diagonal.map(|width| width.value), hysteresis.map(|slack| slack.value))
}

/// Reports a hysteresis that reaches so far into the next zone that it would hide it.
fn check_hysteresis(
    table: &Section<'_>,
    mode: DpadMode,
    width: Placed<f32>,
    hysteresis_deg: f32,
    report: &mut Report<'_>,
) {
    let smallest = match mode {
        DpadMode::FourWay => 90.0,
        DpadMode::FourWaySticky | DpadMode::EightWay => width.value.min(90.0 - width.value),
    };
    if hysteresis_deg >= smallest / 2.0 {
        let at = table.place_of("hysteresis_deg").unwrap_or(width.at);
        let message = format!("\"hysteresis_deg\" ({hysteresis_deg}) reaches the middle of the next zone");
        let help = format!("the smallest zone is {smallest}° wide; write less than {}", smallest / 2.0);
        report.error(at, message, help);
    }
}

/// Reports it if the first number is not less than the second, at whichever of them is written.
fn require_less(
    table: &Section<'_>,
    (low_key, low): (&str, Option<Placed<f32>>),
    (high_key, high): (&str, Option<Placed<f32>>),
    report: &mut Report<'_>,
) {
    let (Some(low), Some(high)) = (low, high) else { return };
    if low.value >= high.value {
        let at = if table.place_of(low_key).is_some() { low.at } else { high.at };
        let message =
            format!("\"{low_key}\" ({}) must be less than \"{high_key}\" ({})", low.value, high.value);
        report.error(at, message, "");
    }
}

fn read_directions(table: &Section<'_>, report: &mut Report<'_>) -> [Outputs; 4] {
    let gamepad = table.table("gamepad", "[dpad.gamepad]".to_owned(), &DIRECTION_KEYS, report);
    let keyboard = table.table("keyboard", "[dpad.keyboard]".to_owned(), &DIRECTION_KEYS, report);
    DIRECTIONS.map(|(name, pad, key)| {
        let default = |value| Placed { value, at: table.at };
        Outputs {
            gamepad: written_or(Device::Gamepad, gamepad.as_ref(), name, default(pad), report),
            keyboard: written_or(Device::Keyboard, keyboard.as_ref(), name, default(key), report),
            pointer: None,
        }
    })
}

impl ButtonDraft {
    fn read(table: &Section<'_>, min_press_ms: Option<u32>, report: &mut Report<'_>) -> Self {
        table.require("force", "write the force that presses it, as force = \"fz\"", report);
        let force = table.word("force", &FORCES, report).map(|word| word.value);
        table.require("press_n", "write the force in newtons that presses it, as press_n = 2.0", report);
        let press = table.number("press_n", FORCE_N, report);
        let share = press.map_or(FORCE_N.default, |force| force.value) * RELEASE_SHARE;
        let release = table.number("release_n", Bounds { low: 0.0, default: share, ..FORCE_N }, report);
        require_less(table, ("release_n", release), ("press_n", press), report);
        let action = ActionDraft::read(table, min_press_ms, report);
        Self { force, press_n: press.map(|n| n.value), release_n: release.map(|n| n.value), action }
    }

    fn settle(self, device: Device) -> Option<Button> {
        let action = match self.action? {
            ActionDraft::Hold(out) => Action::Hold(out.settle(device)?),
            ActionDraft::TapHold { tap, hold, long_press_ms } => Action::TapHold {
                tap: tap.settle(device)?,
                hold: hold.settle(device)?,
                long_press_us: u64::from(long_press_ms?) * 1_000,
            },
        };
        Some(Button { force: self.force?, press_n: self.press_n?, release_n: self.release_n?, action })
    }
}

impl ActionDraft {
    fn read(table: &Section<'_>, min_press_ms: Option<u32>, report: &mut Report<'_>) -> Option<Self> {
        const HELP: &str =
            "write out = { gamepad = \"BTN_…\", keyboard = \"KEY_…\" }, or tap and hold instead of out";
        let [out, tap, hold] = ["out", "tap", "hold"].map(|key| {
            let section = table.table(key, format!("\"{key}\" of {}", table.title), &DEVICE_KEYS, report)?;
            Some(Outputs::read(&section, report))
        });
        let [has_out, has_tap, has_hold, has_long] =
            ["out", "tap", "hold", "long_press_ms"].map(|key| table.place_of(key));
        if let (Some(_), Some(at)) = (has_out, has_tap.or(has_hold).or(has_long)) {
            let message = format!("{} has both \"out\" and keys of a tap/hold button", table.title);
            report.error(at, message, "remove \"out\", or remove \"tap\", \"hold\" and \"long_press_ms\"");
            return None;
        }
        match (has_out, has_tap, has_hold) {
            (Some(_), ..) => return out.map(Self::Hold),
            (_, None, None) => table.require("out", HELP, report),
            (_, Some(_), None) => table.require("hold", "a button with \"tap\" needs \"hold\", too", report),
            (_, None, Some(_)) => table.require("tap", "a button with \"hold\" needs \"tap\", too", report),
            _ => {}
        }
        let long_press_ms = read_long_press(table, min_press_ms, report);
        Some(Self::TapHold { tap: tap?, hold: hold?, long_press_ms })
    }
}

fn read_long_press(table: &Section<'_>, min_press_ms: Option<u32>, report: &mut Report<'_>) -> Option<u32> {
    let Placed { value: long_ms, at } = table.whole("long_press_ms", LONG_PRESS_MS, report)?;
    if let Some(min_ms) = min_press_ms.filter(|min_ms| *min_ms >= long_ms) {
        let message = format!("\"long_press_ms\" ({long_ms}) must be more than \"min_press_ms\" ({min_ms})");
        report.error(at, message, "");
    }
    Some(long_ms)
}
