//! From a profile's text to a [`Profile`]: names, types, ranges, and how the numbers stand to each other.
//!
//! `mappings/README.md` documents every key for people. All findings are reported at once.

use arrayvec::ArrayVec;

use super::binding::{Outputs, written_or};
use super::button::{BUTTON_KEYS, ButtonDraft};
use super::conflict::{self, Owner, Use};
use super::limits::{
    CENTRE_RADIUS_MM, CURVE, DIAGONAL_DEG, FILTER_SAMPLES, FORCE_N, FULL_RADIUS_MM, HYSTERESIS_DEG,
    MIN_PRESS_MS, POINTER_CENTRE_MM, RADIUS_HYSTERESIS_MM, RELEASE_RATIO, ROTATION_DEG, SPEED_COUNTS_PER_S,
    STICKY_DIAGONAL_DEG,
};
use super::profile::{BUTTONS_MAX, Dpad, DpadMode, Pointer, Profile};
use crate::pipeline::control::OutputDevice;
use crate::toml_text;
use crate::toml_text::diag::{Diagnostic, Findings};
use crate::toml_text::section::{Bounds, Placed, Section};

/// Which of a profile's two sets of bindings to use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputChoice {
    /// The one that the profile's `output` names.
    AsWritten,
    /// The keyboard's, for outputs that only have keys.
    Keyboard,
}

const MODES: [(&str, DpadMode); 3] =
    [("4way", DpadMode::FourWay), ("4way-sticky", DpadMode::FourWaySticky), ("8way", DpadMode::EightWay)];
const OUTPUTS: [(&str, OutputDevice); 2] =
    [("gamepad", OutputDevice::Gamepad), ("keyboard", OutputDevice::Keyboard)];

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
    let mut findings = Findings::new(text);
    let Some(tree) = toml_text::parse(text, "a profile is a few lines of TOML", &mut findings) else {
        return (None, findings.finish());
    };
    let root = Section::root(&tree, "the profile", &ROOT_KEYS, &mut findings);
    let draft = Draft::read(&root, &mut findings);
    draft.check_conflicts(&mut findings);
    let profile = if findings.failed() { None } else { draft.settle(output) };
    (profile, findings.finish())
}

/// A profile while it is read: what is unusable is `None` and reported.
struct Draft {
    name: Option<String>,
    output: Option<OutputDevice>,
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

impl Draft {
    fn read(root: &Section<'_>, findings: &mut Findings<'_>) -> Self {
        read_schema(root, findings);
        let output = root.word("output", &OUTPUTS, findings).map(|word| word.value);
        root.require("output", "write output = \"gamepad\" or output = \"keyboard\"", findings);
        let min_press_ms = root.whole("min_press_ms", MIN_PRESS_MS, findings).map(|ms| ms.value);
        let dpad = root.table("dpad", "[dpad]".to_owned(), &DPAD_KEYS, findings);
        let pointer = root.table("pointer", "[pointer]".to_owned(), &POINTER_KEYS, findings);
        // One more than there can be, so that the first one too many is known by its place.
        let buttons = root.tables("button", &BUTTON_KEYS, BUTTONS_MAX + 1, findings);
        if ["dpad", "pointer", "button"].iter().all(|key| root.place_of(key).is_none()) {
            findings.warning(
                root.at,
                "the profile does nothing",
                "add a [dpad], [pointer] or [[button]] table",
            );
        }
        if let Some(extra) = buttons.get(BUTTONS_MAX) {
            findings.error(
                extra.at,
                format!("a profile has at most {BUTTONS_MAX} buttons"),
                "remove this one",
            );
        }
        Self {
            name: read_name(root, findings),
            output,
            filter_samples: root
                .whole("filter_samples", FILTER_SAMPLES, findings)
                .map(|count| count.value as usize),
            min_press_ms,
            dpad: dpad.map(|dpad| DpadDraft::read(&dpad, findings)),
            pointer: pointer.map(|pointer| read_pointer(&pointer, findings)),
            buttons: buttons.iter().map(|button| ButtonDraft::read(button, min_press_ms, findings)).collect(),
        }
    }

    fn check_conflicts(&self, findings: &mut Findings<'_>) {
        let mut uses = Vec::new();
        if let Some(DpadDraft { directions, .. }) = &self.dpad {
            let named = directions.iter().zip(DIRECTIONS);
            uses.extend(named.map(|(outputs, (name, ..))| Use {
                owner: Owner::Direction(name),
                outputs: *outputs,
                toggles: false,
            }));
        }
        for (number, button) in (1..).zip(&self.buttons) {
            uses.extend(button.uses(number));
        }
        conflict::check(&uses, self.dpad.as_ref().and_then(|dpad| dpad.mode), findings);
    }

    /// The finished profile; `None` if a part of it is missing.
    fn settle(self, choice: OutputChoice) -> Option<Profile> {
        let output = match choice {
            OutputChoice::AsWritten => self.output?,
            OutputChoice::Keyboard => OutputDevice::Keyboard,
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

fn read_schema(root: &Section<'_>, findings: &mut Findings<'_>) {
    root.require("schema", "write schema = 1 as the first line", findings);
    root.whole("schema", Bounds { low: 1, high: 1, default: 1 }, findings);
}

fn read_name(root: &Section<'_>, findings: &mut Findings<'_>) -> Option<String> {
    root.require("name", "write name = \"…\", the game's name", findings);
    root.name("name", findings).map(str::to_owned)
}

impl DpadDraft {
    fn read(table: &Section<'_>, findings: &mut Findings<'_>) -> Self {
        let mode = match table.place_of("mode") {
            Some(_) => table.word("mode", &MODES, findings).map(|word| word.value),
            None => Some(DpadMode::FourWay),
        };
        Self { shape: read_shape(table, mode, findings), mode, directions: read_directions(table, findings) }
    }

    fn settle(self, device: OutputDevice) -> Option<Dpad> {
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

fn read_shape(table: &Section<'_>, mode: Option<DpadMode>, findings: &mut Findings<'_>) -> Option<Shape> {
    let centre = table.number("centre_radius_mm", CENTRE_RADIUS_MM, findings);
    let slack = table.number("radius_hysteresis_mm", RADIUS_HYSTERESIS_MM, findings);
    table.require_less(("radius_hysteresis_mm", slack), ("centre_radius_mm", centre), findings);
    let rotation = table.number("rotation_deg", ROTATION_DEG, findings);
    let (diagonal, hysteresis) = read_zones(table, mode, findings);
    let (min_force_n, release_force_n) = read_gate(table, findings);
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
fn read_gate(table: &Section<'_>, findings: &mut Findings<'_>) -> (Option<f32>, Option<f32>) {
    let min_force = table.number("min_force_n", FORCE_N, findings);
    let share = min_force.map_or(FORCE_N.default, |force| force.value) / RELEASE_RATIO;
    let release = table.number("release_force_n", Bounds { low: 0.0, default: share, ..FORCE_N }, findings);
    table.require_less(("release_force_n", release), ("min_force_n", min_force), findings);
    (min_force.map(|force| force.value), release.map(|force| force.value))
}

fn read_pointer(table: &Section<'_>, findings: &mut Findings<'_>) -> Option<Pointer> {
    let centre = table.number("centre_radius_mm", POINTER_CENTRE_MM, findings);
    let full = table.number("full_radius_mm", FULL_RADIUS_MM, findings);
    table.require_less(("centre_radius_mm", centre), ("full_radius_mm", full), findings);
    let speed = table.number("speed_counts_per_s", SPEED_COUNTS_PER_S, findings);
    let curve = table.number("curve", CURVE, findings);
    let (min_force_n, release_force_n) = read_gate(table, findings);
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
    findings: &mut Findings<'_>,
) -> (Option<f32>, Option<f32>) {
    let sticky = mode == Some(DpadMode::FourWaySticky);
    let default = if sticky { STICKY_DIAGONAL_DEG } else { DIAGONAL_DEG.default };
    let diagonal = table.number("diagonal_deg", Bounds { default, ..DIAGONAL_DEG }, findings);
    if let (Some(DpadMode::FourWay), Some(at)) = (mode, table.place_of("diagonal_deg")) {
        findings.warning(
            at,
            "\"diagonal_deg\" does nothing in mode \"4way\"",
            "remove it, or choose another mode",
        );
    }
    let hysteresis = table.number("hysteresis_deg", HYSTERESIS_DEG, findings);
    if sticky {
        if let Some(at) = table.place_of("hysteresis_deg") {
            let message = "\"hysteresis_deg\" does nothing in mode \"4way-sticky\": there the diagonal zone is the \
                           hysteresis";
            findings.warning(at, message, "remove it; \"diagonal_deg\" sets how far a direction is kept");
        }
        return (diagonal.map(|width| width.value), hysteresis.map(|_| 0.0));
    }
    if let (Some(mode), Some(width), Some(hysteresis)) = (mode, diagonal, hysteresis) {
        check_hysteresis(table, mode, width, hysteresis.value, findings);
    }
    (diagonal.map(|width| width.value), hysteresis.map(|slack| slack.value))
}

/// Reports a hysteresis that reaches so far into the next zone that it would hide it.
fn check_hysteresis(
    table: &Section<'_>,
    mode: DpadMode,
    width: Placed<f32>,
    hysteresis_deg: f32,
    findings: &mut Findings<'_>,
) {
    let smallest = match mode {
        DpadMode::FourWay => 90.0,
        DpadMode::FourWaySticky | DpadMode::EightWay => width.value.min(90.0 - width.value),
    };
    if hysteresis_deg >= smallest / 2.0 {
        let at = table.place_of("hysteresis_deg").unwrap_or(width.at);
        let message = format!("\"hysteresis_deg\" ({hysteresis_deg}) reaches the middle of the next zone");
        let help = format!("the smallest zone is {smallest}° wide; write less than {}", smallest / 2.0);
        findings.error(at, message, help);
    }
}

fn read_directions(table: &Section<'_>, findings: &mut Findings<'_>) -> [Outputs; 4] {
    let gamepad = table.table("gamepad", "[dpad.gamepad]".to_owned(), &DIRECTION_KEYS, findings);
    let keyboard = table.table("keyboard", "[dpad.keyboard]".to_owned(), &DIRECTION_KEYS, findings);
    DIRECTIONS.map(|(name, pad, key)| {
        let default = |value| Placed { value, at: table.at };
        Outputs {
            gamepad: written_or(OutputDevice::Gamepad, gamepad.as_ref(), name, default(pad), findings),
            keyboard: written_or(OutputDevice::Keyboard, keyboard.as_ref(), name, default(key), findings),
            pointer: None,
        }
    })
}
