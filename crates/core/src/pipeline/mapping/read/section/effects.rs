//! Effect of a kind of press, as a profile writes it.

use arrayvec::ArrayString;

use crate::pipeline::control::OutputDevice;
use crate::pipeline::mapping::profile::words::COMMANDS;
use crate::pipeline::mapping::profile::{Command, Effect, Mode, Output, Role};
use crate::pipeline::mapping::read::common::binding::{DEVICE_KEYS, Outputs, with_keys};
use crate::pipeline::mapping::read::common::labels::LABEL;
use crate::pipeline::mapping::read::common::limits::TURBO_MS;
use crate::pipeline::mapping::read::common::named;
use crate::toml_text::diag::{Findings, quoted};
use crate::toml_text::section::{Placed, Section};

/// Keys that may stand in place of a device.
const TARGET_KEYS: [&str; 3] = ["layer", "macro", "bridge"];
/// How it follows the press.
const MODE_KEYS: [&str; 3] = ["toggle", "sticky", "turbo_ms"];

/// Context in which an effect is read.
#[derive(Clone, Copy)]
pub(crate) struct EffectContext<'p> {
    /// Nothing may be shorter than this.
    pub(crate) min_press_ms: Option<u32>,
    pub(crate) layers: &'p [&'p str],
    pub(crate) macros: &'p [&'p str],
}

/// Effect of a kind of press, while it is read.
#[derive(Clone, Copy)]
pub(crate) struct EffectDraft {
    target: Target,
    mode: Option<Mode>,
}

/// Target that it acts on: devices, or on something else, which is `None` where that is unusable.
#[derive(Clone, Copy)]
enum Target {
    Devices(Outputs),
    Other(Option<Output>),
}

impl EffectDraft {
    /// Reads the table of a kind of press, if it is there.
    pub(crate) fn read(
        table: &Section<'_>,
        role: Role,
        around: EffectContext<'_>,
        findings: &mut Findings<'_>,
    ) -> Option<Self> {
        let title = format!("\"{}\" of {}", role.name(), table.title);
        let known = with_keys(&[&TARGET_KEYS[..], &MODE_KEYS, &[LABEL]].concat());
        let section = table.table(role.name(), title, &known, findings)?;
        let target = Target::read(&section, around, findings);
        Some(Self { target, mode: read_mode(&section, role, around.min_press_ms, findings) })
    }

    /// Controls that it drives; none where that is no device.
    pub(crate) const fn outputs(&self) -> Option<Outputs> {
        match self.target {
            Target::Devices(outputs) => Some(outputs),
            Target::Other(_) => None,
        }
    }

    /// Whether its keys stay down when the press is over.
    pub(crate) const fn stays(&self) -> bool {
        matches!(self.mode, Some(Mode::Toggle | Mode::Sticky))
    }

    /// The effect on `device`; `None` if a part of it is missing.
    pub(crate) fn settle(self, device: OutputDevice) -> Option<Effect> {
        let output = match self.target {
            Target::Devices(outputs) => Output::Keys(outputs.settle(device)?),
            Target::Other(output) => output?,
        };
        Some(Effect { output, mode: self.mode? })
    }
}

impl Target {
    fn read(section: &Section<'_>, around: EffectContext<'_>, findings: &mut Findings<'_>) -> Self {
        let mut written = TARGET_KEYS.iter().filter_map(|key| Some((*key, section.place_of(key)?)));
        let Some((key, at)) = written.next() else { return Self::Devices(Outputs::read(section, findings)) };
        if written.next().is_some() || DEVICE_KEYS.iter().any(|key| section.place_of(key).is_some()) {
            let message = format!("{} names a {key} beside other things", section.title);
            findings.error(at, message, "write it alone");
        }
        let by_name = |kind: &str, known: &[&str], findings: &mut Findings<'_>| {
            let asked = section.text(kind, findings)?;
            named::find(asked, kind, known, findings)
        };
        let layer = by_name("layer", around.layers, findings).map(Output::Layer);
        let run = by_name("macro", around.macros, findings).map(Output::Macro);
        let command = section.text("bridge", findings).and_then(|text| read_command(text, findings));
        check_mode(section, key, findings);
        Self::Other(layer.or(run).or(command.map(Output::Bridge)))
    }
}

/// `"pause"`, or `"profile NAME"`.
fn read_command(Placed { value: text, at }: Placed<&str>, findings: &mut Findings<'_>) -> Option<Command> {
    if let Some(name) = text.strip_prefix("profile ") {
        let name = ArrayString::from(name.trim()).ok().filter(|name| !name.is_empty());
        if name.is_none() {
            findings.error(at, format!("{} names no profile", quoted(text)), "write \"profile tetris\"");
        }
        return name.map(Command::Profile);
    }
    let known: Vec<&str> = COMMANDS.iter().map(|(word, _)| *word).chain(["profile NAME"]).collect();
    let number = named::find(Placed { value: text, at }, "bridge action", &known, findings)?;
    COMMANDS.get(number).map(|(_, command)| *command)
}

/// What begins once is not held, so there is nothing to toggle or to repeat; and a layer does not flicker.
fn check_mode(section: &Section<'_>, target: &str, findings: &mut Findings<'_>) {
    let refused = if target == "layer" { &["turbo_ms"][..] } else { &MODE_KEYS[..] };
    if let Some((key, at)) = refused.iter().find_map(|key| Some((key, section.place_of(key)?))) {
        findings.error(at, format!("a {target} has no \"{key}\""), "remove it");
    }
}

/// A mode that is written.
struct WrittenMode {
    key: &'static str,
    at: usize,
    /// `None` where it is unusable.
    mode: Option<Mode>,
}

/// How the keys follow the press; `None` where that is unusable.
fn read_mode(
    section: &Section<'_>,
    role: Role,
    min_press_ms: Option<u32>,
    findings: &mut Findings<'_>,
) -> Option<Mode> {
    let toggle = read_flag(section, "toggle", Mode::Toggle, findings);
    let sticky = read_flag(section, "sticky", Mode::Sticky, findings);
    let turbo = section.place_of("turbo_ms").map(|at| {
        let ms = read_turbo(section, min_press_ms, findings);
        if role == Role::Tap {
            let help = "write it into \"out\", \"double\" or \"hold\"";
            findings.error(at, "a tap is over at once: it has no \"turbo_ms\"", help);
        }
        let mode = ms.map(|ms| Mode::Turbo { period_us: u64::from(ms) * 1_000 });
        WrittenMode { key: "turbo_ms", at, mode }
    });
    let mut written = [toggle, sticky, turbo].into_iter().flatten();
    let Some(first) = written.next() else { return Some(Mode::Plain) };
    if let Some(WrittenMode { key, at, .. }) = written.next() {
        let message = format!("{} is both \"{}\" and \"{key}\"", section.title, first.key);
        findings.error(at, message, "remove one of them");
    }
    first.mode
}

/// A mode that is switched on by a flag; none where it is off.
fn read_flag(
    section: &Section<'_>,
    key: &'static str,
    mode: Mode,
    findings: &mut Findings<'_>,
) -> Option<WrittenMode> {
    let at = section.place_of(key)?;
    match section.flag(key, findings) {
        Some(false) => None,
        is_set => Some(WrittenMode { key, at, mode: is_set.map(|_| mode) }),
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
