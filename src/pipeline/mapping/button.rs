//! A profile's buttons: which force presses them, and what their kinds of press do.

use super::binding::{Outputs, with_keys};
use super::conflict::{Owner, Use};
use super::limits::{DOUBLE_PRESS_MS, FORCE_N, LONG_PRESS_MS, RELEASE_SHARE, TURBO_MS};
use super::profile::{Action, Button, Effect, Force, Mode, Role, Timed};
use crate::pipeline::control::OutputDevice;
use crate::toml_text::diag::Findings;
use crate::toml_text::section::{Bounds, Placed, Section};

const FORCES: [(&str, Force); 5] = [
    ("fz", Force::Fz),
    ("fy", Force::FyPositive),
    ("-fy", Force::FyNegative),
    ("fx", Force::FxPositive),
    ("-fx", Force::FxNegative),
];
pub(super) const BUTTON_KEYS: [&str; 9] =
    ["force", "press_n", "release_n", "out", "tap", "double", "hold", "double_press_ms", "long_press_ms"];
/// What an effect has beside its outputs.
const MODE_KEYS: [&str; 2] = ["toggle", "turbo_ms"];

/// A button while it is read: what is unusable is `None` and reported.
pub(super) struct ButtonDraft {
    force: Option<Force>,
    press_n: Option<f32>,
    release_n: Option<f32>,
    action: Option<ActionDraft>,
}

/// What a kind of press does.
#[derive(Clone, Copy)]
struct EffectDraft {
    outputs: Outputs,
    mode: Option<Mode>,
}

/// What its kinds of press do, in the order of [`Role::ALL`], and the times that tell them.
struct ActionDraft {
    effects: [Option<EffectDraft>; Role::ALL.len()],
    double_press_ms: Option<u32>,
    long_press_ms: Option<u32>,
}

impl ButtonDraft {
    /// Reads a `[[button]]`; nothing may be shorter than `min_press_ms`.
    pub(super) fn read(table: &Section<'_>, min_press_ms: Option<u32>, findings: &mut Findings<'_>) -> Self {
        table.require("force", "write the force that presses it, as force = \"fz\"", findings);
        let force = table.word("force", &FORCES, findings).map(|word| word.value);
        table.require("press_n", "write the force in newtons that presses it, as press_n = 2.0", findings);
        let press = table.number("press_n", FORCE_N, findings);
        let share = press.map_or(FORCE_N.default, |force| force.value) * RELEASE_SHARE;
        let release = table.number("release_n", Bounds { low: 0.0, default: share, ..FORCE_N }, findings);
        table.require_less(("release_n", release), ("press_n", press), findings);
        let action = ActionDraft::read(table, min_press_ms, findings);
        Self { force, press_n: press.map(|n| n.value), release_n: release.map(|n| n.value), action }
    }

    /// What the kinds of press of this button, the `number`th, drive.
    pub(super) fn uses(&self, number: usize) -> impl Iterator<Item = Use> + use<> {
        let effects = self.action.as_ref().map(|action| action.effects);
        let all = effects.into_iter().flat_map(|effects| Role::ALL.into_iter().zip(effects));
        all.filter_map(move |(role, effect)| {
            let EffectDraft { outputs, mode } = effect?;
            let owner = Owner::Button { number, role: role.name() };
            Some(Use { owner, outputs, toggles: mode == Some(Mode::Toggle) })
        })
    }

    /// The button on `device`; `None` if a part of it is missing.
    pub(super) fn settle(self, device: OutputDevice) -> Option<Button> {
        let action = self.action?.settle(device)?;
        Some(Button { force: self.force?, press_n: self.press_n?, release_n: self.release_n?, action })
    }
}

impl EffectDraft {
    /// Reads the table of a kind of press, if it is there.
    fn read(
        table: &Section<'_>,
        role: Role,
        min_press_ms: Option<u32>,
        findings: &mut Findings<'_>,
    ) -> Option<Self> {
        let title = format!("\"{}\" of {}", role.name(), table.title);
        let section = table.table(role.name(), title, &with_keys(&MODE_KEYS), findings)?;
        let outputs = Outputs::read(&section, findings);
        let toggles = match section.place_of("toggle") {
            Some(_) => section.flag("toggle", findings),
            None => Some(false),
        };
        let turbo = section.place_of("turbo_ms").map(|at| (at, read_turbo(&section, min_press_ms, findings)));
        if let (Some(true), Some((at, _))) = (toggles, turbo) {
            findings.error(
                at,
                format!("{} is both \"toggle\" and \"turbo_ms\"", section.title),
                "remove one of them",
            );
        }
        if let (Role::Tap, Some((at, _))) = (role, turbo) {
            findings.error(
                at,
                "a tap is over at once: it has no \"turbo_ms\"",
                "write it into \"out\", \"double\" or \"hold\"",
            );
        }
        let mode = match (toggles?, turbo) {
            (true, _) => Some(Mode::Toggle),
            (false, None) => Some(Mode::Plain),
            (false, Some((_, ms))) => ms.map(|ms| Mode::Turbo { period_us: u64::from(ms) * 1_000 }),
        };
        Some(Self { outputs, mode })
    }

    fn settle(self, device: OutputDevice) -> Option<Effect> {
        Some(Effect { keys: self.outputs.settle(device)?, mode: self.mode? })
    }
}

/// The period of presses, half of which must have room for the minimum press.
fn read_turbo(section: &Section<'_>, min_press_ms: Option<u32>, findings: &mut Findings<'_>) -> Option<u32> {
    let Placed { value: ms, at } = section.whole("turbo_ms", TURBO_MS, findings)?;
    if let Some(min_ms) = min_press_ms.filter(|min_ms| 2 * min_ms > ms) {
        let message = format!("\"turbo_ms\" ({ms}) is faster than \"min_press_ms\" ({min_ms}) allows");
        findings.error(at, message, format!("write at least {}, or a shorter \"min_press_ms\"", 2 * min_ms));
    }
    Some(ms)
}

impl ActionDraft {
    fn read(table: &Section<'_>, min_press_ms: Option<u32>, findings: &mut Findings<'_>) -> Option<Self> {
        let effects = Role::ALL.map(|role| EffectDraft::read(table, role, min_press_ms, findings));
        let double = read_time(table, (Role::Double, "double_press_ms"), DOUBLE_PRESS_MS, findings);
        let long = read_time(table, (Role::Hold, "long_press_ms"), LONG_PRESS_MS, findings);
        let place = |role: Role| table.place_of(role.name());
        let by_time = [Role::Tap, Role::Double, Role::Hold].into_iter().find_map(place);
        match (place(Role::Out), by_time) {
            (Some(_), Some(at)) => {
                let message = format!("{} has both \"out\" and keys of a tap/hold button", table.title);
                findings.error(at, message, "remove \"out\", or remove \"tap\", \"double\" and \"hold\"");
                return None;
            }
            (Some(_), None) => {}
            (None, _) => require_tap(table, by_time, findings),
        }
        check_times(table, [double, long], min_press_ms, findings);
        let ms = |time: Option<Placed<u32>>| time.map(|time| time.value);
        Some(Self { effects, double_press_ms: ms(double), long_press_ms: ms(long) })
    }

    fn settle(self, device: OutputDevice) -> Option<Action> {
        let [out, tap, double, hold] =
            self.effects.map(|effect| effect.and_then(|effect| effect.settle(device)));
        let timed = |effect: Option<Effect>, ms: Option<u32>| {
            effect.zip(ms).map(|(effect, ms)| Timed { effect, us: u64::from(ms) * 1_000 })
        };
        let (double, hold) = (timed(double, self.double_press_ms), timed(hold, self.long_press_ms));
        out.map(Action::Hold).or_else(|| tap.map(|tap| Action::ByTime { tap, double, hold }))
    }
}

/// The time that tells a kind of press; none where there is no such kind.
fn read_time(
    table: &Section<'_>,
    (role, key): (Role, &str),
    bounds: Bounds<u32>,
    findings: &mut Findings<'_>,
) -> Option<Placed<u32>> {
    if table.place_of(role.name()).is_some() {
        return table.whole(key, bounds, findings);
    }
    if let Some(at) = table.place_of(key) {
        let message = format!("\"{key}\" does nothing without \"{}\"", role.name());
        findings.error(at, message, format!("remove it, or write \"{}\"", role.name()));
    }
    None
}

/// A button that does something by time has at least a tap.
fn require_tap(table: &Section<'_>, by_time: Option<usize>, findings: &mut Findings<'_>) {
    const HELP: &str =
        "write out = { gamepad = \"BTN_…\", keyboard = \"KEY_…\" }, or tap, double and hold instead of out";
    match (by_time, table.place_of(Role::Hold.name())) {
        (None, _) => table.require("out", HELP, findings),
        (Some(_), Some(_)) => table.require("tap", "a button with \"hold\" needs \"tap\", too", findings),
        (Some(_), None) => table.require("tap", "a button with \"double\" needs \"tap\", too", findings),
    }
}

/// Reports times that hide each other.
fn check_times(
    table: &Section<'_>,
    [double, long]: [Option<Placed<u32>>; 2],
    min_press_ms: Option<u32>,
    findings: &mut Findings<'_>,
) {
    table.require_less(("double_press_ms", double), ("long_press_ms", long), findings);
    if let (Some(long), Some(min_ms)) = (long, min_press_ms)
        && min_ms >= long.value
    {
        let message =
            format!("\"long_press_ms\" ({}) must be more than \"min_press_ms\" ({min_ms})", long.value);
        findings.error(long.at, message, "");
    }
}
