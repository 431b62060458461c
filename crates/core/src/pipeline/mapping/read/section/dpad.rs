//! A profile's directions.

use crate::pipeline::control::OutputDevice;
use crate::pipeline::mapping::profile::words::DPAD_MODES;
use crate::pipeline::mapping::profile::{Direction, Dpad, DpadMode, When};
use crate::pipeline::mapping::read::common::binding::{Outputs, written_or};
use crate::pipeline::mapping::read::common::conflict::{Owner, Use};
use crate::pipeline::mapping::read::common::labels::LABEL;
use crate::pipeline::mapping::read::common::limits::{
    CENTRE_RADIUS_MM, DIAGONAL_DEG, FORCE_N, HYSTERESIS_DEG, HYSTERESIS_MM, RADIUS_HYSTERESIS_MM,
    RELEASE_RATIO, ROTATION_DEG, STICKY_DIAGONAL_DEG,
};
use crate::toml_text::diag::Findings;
use crate::toml_text::section::{Bounds, Placed, Section};

pub(crate) const DPAD_KEYS: [&str; 12] = [
    "mode",
    "centre_radius_mm",
    "radius_hysteresis_mm",
    "diagonal_deg",
    "hysteresis_deg",
    "hysteresis_mm",
    "min_force_n",
    "release_force_n",
    "rotation_deg",
    "gamepad",
    "keyboard",
    LABEL,
];
/// A direction's bindings on the gamepad and the keyboard, where none is written.
const fn defaults(direction: Direction) -> [&'static str; 2] {
    match direction {
        Direction::Up => ["ABS_HAT0Y-", "KEY_UP"],
        Direction::Down => ["ABS_HAT0Y+", "KEY_DOWN"],
        Direction::Left => ["ABS_HAT0X-", "KEY_LEFT"],
        Direction::Right => ["ABS_HAT0X+", "KEY_RIGHT"],
    }
}

/// A D-pad while it is read: what is unusable is `None` and reported.
pub(crate) struct DpadDraft {
    /// All but the bindings.
    shape: Option<Shape>,
    pub(crate) mode: Option<DpadMode>,
    directions: [Outputs; 4],
}

/// The numbers of [`Dpad`].
#[derive(Clone, Copy)]
struct Shape {
    centre_radius_mm: f32,
    radius_hysteresis_mm: f32,
    diagonal_deg: f32,
    hysteresis_deg: f32,
    hysteresis_mm: f32,
    rotation_deg: f32,
    min_force_n: f32,
    release_force_n: f32,
}

impl DpadDraft {
    /// Reads `[dpad]`.
    pub(crate) fn read(table: &Section<'_>, findings: &mut Findings<'_>) -> Self {
        let mode = match table.place_of("mode") {
            Some(_) => table.word("mode", &DPAD_MODES, findings).map(|word| word.value),
            None => Some(DpadMode::FourWay),
        };
        table.table(LABEL, "[dpad.label]".into(), &Direction::NAMES, findings);
        Self { shape: read_shape(table, mode, findings), mode, directions: read_directions(table, findings) }
    }

    /// Controls that its directions drive.
    pub(crate) fn uses(&self) -> impl Iterator<Item = Use> + use<> {
        let named = self.directions.into_iter().zip(Direction::NAMES);
        named.map(|(outputs, name)| Use {
            owner: Owner::Direction(name),
            outputs,
            toggles: false,
            place: None,
            when: When::Always,
        })
    }

    /// The D-pad on `device`; `None` if a part of it is missing.
    pub(crate) fn settle(self, device: OutputDevice) -> Option<Dpad> {
        let [up, down, left, right] = self.directions.map(|outputs| outputs.settle(device));
        let shape = self.shape?;
        Some(Dpad {
            mode: self.mode?,
            centre_radius_mm: shape.centre_radius_mm,
            radius_hysteresis_mm: shape.radius_hysteresis_mm,
            diagonal_deg: shape.diagonal_deg,
            hysteresis_deg: shape.hysteresis_deg,
            hysteresis_mm: shape.hysteresis_mm,
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
    let (diagonal, hysteresis) = read_diagonals(table, mode, findings);
    let arc = table.number("hysteresis_mm", HYSTERESIS_MM, findings);
    let (min_force_n, release_force_n) = read_gate(table, findings);
    Some(Shape {
        centre_radius_mm: centre?.value,
        radius_hysteresis_mm: slack?.value,
        diagonal_deg: diagonal?,
        hysteresis_deg: hysteresis?,
        // In the sticky mode the diagonal zones are the hysteresis.
        hysteresis_mm: if mode == Some(DpadMode::FourWaySticky) { 0.0 } else { arc?.value },
        rotation_deg: rotation?.value,
        min_force_n: min_force_n?,
        release_force_n: release_force_n?,
    })
}

/// The normal forces that start and end a direction, or the pointer, in newtons.
pub(crate) fn read_gate(table: &Section<'_>, findings: &mut Findings<'_>) -> (Option<f32>, Option<f32>) {
    let min_force = table.number("min_force_n", FORCE_N, findings);
    let share = min_force.map_or(FORCE_N.default, |force| force.value) / RELEASE_RATIO;
    let release = table.number("release_force_n", Bounds { low: 0.0, default: share, ..FORCE_N }, findings);
    table.require_less(("release_force_n", release), ("min_force_n", min_force), findings);
    (min_force.map(|force| force.value), release.map(|force| force.value))
}

/// The width of the diagonal zones and the hysteresis between zones, both in degrees.
fn read_diagonals(
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
        for (key, at) in
            ["hysteresis_deg", "hysteresis_mm"].iter().filter_map(|key| Some((key, table.place_of(key)?)))
        {
            let message = format!(
                "\"{key}\" does nothing in mode \"4way-sticky\": there the diagonal zone is the hysteresis"
            );
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
    let tables = direction_tables(table, "dpad", findings);
    Direction::ALL.map(|direction| {
        let defaults = defaults(direction).map(|value| Placed { value, at: table.at });
        written_direction(&tables, direction.name(), Some(defaults), findings)
    })
}

/// The tables `gamepad` and `keyboard` of directions.
pub(crate) fn direction_tables<'t>(
    table: &Section<'t>,
    title: &str,
    findings: &mut Findings<'_>,
) -> [Option<Section<'t>>; 2] {
    ["gamepad", "keyboard"]
        .map(|device| table.table(device, format!("[{title}.{device}]"), &Direction::NAMES, findings))
}

/// The direction `name` on both devices; its default, if it has one, where it is not written.
pub(crate) fn written_direction(
    [gamepad, keyboard]: &[Option<Section<'_>>; 2],
    name: &str,
    defaults: Option<[Placed<&str>; 2]>,
    findings: &mut Findings<'_>,
) -> Outputs {
    let [pad, key] = defaults.map_or([None; 2], |defaults| defaults.map(Some));
    Outputs {
        gamepad: written_or(OutputDevice::Gamepad, gamepad.as_ref(), name, pad, findings),
        keyboard: written_or(OutputDevice::Keyboard, keyboard.as_ref(), name, key, findings),
        pointer: None,
    }
}
