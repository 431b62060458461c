//! A profile's macros: keys that are pressed one after the other.

use crate::pipeline::control::OutputDevice;
use crate::pipeline::mapping::profile::{MACROS_MAX, Macro, MacroStep, STEPS_MAX, When};
use crate::pipeline::mapping::read::common::binding::{Outputs, with_keys};
use crate::pipeline::mapping::read::common::conflict::{Owner, Use};
use crate::pipeline::mapping::read::common::limits::{STEP_MS, WAIT_MS};
use crate::pipeline::mapping::read::common::named;
use crate::toml_text::diag::Findings;
use crate::toml_text::section::Section;

const MACRO_KEYS: [&str; 2] = ["name", "steps"];

/// A macro while it is read.
pub(crate) struct MacroDraft {
    pub(crate) name: String,
    /// Byte offset of its header.
    pub(crate) at: usize,
    steps: Vec<StepDraft>,
}

/// A step: keys or a pause, and how long it takes; `None` where that is unusable.
#[derive(Clone, Copy)]
struct StepDraft {
    outputs: Option<Outputs>,
    ms: Option<u32>,
}

impl MacroDraft {
    /// Reads all `[[macro]]`s; one without a name is left out and reported.
    pub(crate) fn read_all(
        root: &Section<'_>,
        min_press_ms: Option<u32>,
        findings: &mut Findings<'_>,
    ) -> Vec<Self> {
        let tables = root.tables("macro", &MACRO_KEYS, MACROS_MAX + 1, findings);
        named::check_count(&tables, "macro", MACROS_MAX, findings);
        let mut macros: Vec<Self> = Vec::new();
        for table in &tables {
            let is_taken = |name: &str| macros.iter().any(|it| it.name == name);
            let name = named::read(table, "macro", is_taken, findings);
            let steps = read_steps(table, min_press_ms, findings);
            macros.extend(name.map(|name| Self { name, at: table.at, steps }));
        }
        macros
    }

    /// Controls that the steps of this macro, the `number`th, drive.
    pub(crate) fn uses(&self, number: usize) -> impl Iterator<Item = Use> + '_ {
        self.steps.iter().filter_map(move |step| {
            let (owner, outputs) = (Owner::Macro(number), step.outputs?);
            Some(Use { owner, outputs, toggles: false, place: None, when: When::Always })
        })
    }

    /// The macro on `device`; `None` if a part of it is missing.
    pub(crate) fn settle(self, device: OutputDevice) -> Option<Macro> {
        let mut until_us = 0;
        let step = |StepDraft { outputs, ms }: &StepDraft| {
            until_us += u64::from((*ms)?) * 1_000;
            let keys = match outputs {
                Some(outputs) => Some(outputs.settle(device)?),
                None => None,
            };
            Some(MacroStep { keys, until_us })
        };
        let steps = self.steps.iter().map(step).collect::<Option<Vec<_>>>()?;
        Some(Macro { name: self.name, steps })
    }
}

fn read_steps(table: &Section<'_>, min_press_ms: Option<u32>, findings: &mut Findings<'_>) -> Vec<StepDraft> {
    table.require("steps", "write the keys in their order, as steps = [{ … }, { … }]", findings);
    let steps = table.tables("steps", &with_keys(&["for_ms", "wait_ms"]), STEPS_MAX + 1, findings);
    if let Some(extra) = steps.get(STEPS_MAX) {
        findings.error(extra.at, format!("a macro has at most {STEPS_MAX} steps"), "remove this one");
    }
    if let (true, Some(at)) = (steps.is_empty(), table.place_of("steps")) {
        findings.error(at, format!("{} has no steps", table.title), "write at least one, or remove it");
    }
    steps.iter().map(|step| read_step(step, min_press_ms, findings)).collect()
}

/// A step: `{ gamepad = "…", keyboard = "…", for_ms = 50 }` or `{ wait_ms = 50 }`.
fn read_step(step: &Section<'_>, min_press_ms: Option<u32>, findings: &mut Findings<'_>) -> StepDraft {
    let keys = with_keys(&["for_ms"]);
    if step.place_of("wait_ms").is_some() {
        let ms = step.whole("wait_ms", WAIT_MS, findings).map(|ms| ms.value);
        if let Some((key, at)) = keys.iter().find_map(|key| Some((key, step.place_of(key)?))) {
            let message = format!("{} is a pause, and has \"{key}\"", step.title);
            findings.error(at, message, "write the pause as a step of its own");
        }
        return StepDraft { outputs: None, ms };
    }
    let outputs = Outputs::read(step, findings);
    let for_ms = step.whole("for_ms", STEP_MS, findings);
    if let (Some(ms), Some(min_ms)) = (for_ms, min_press_ms)
        && ms.value < min_ms
    {
        let message = format!("\"for_ms\" ({}) is shorter than \"min_press_ms\" ({min_ms})", ms.value);
        findings.error(step.place_of("for_ms").unwrap_or(step.at), message, "make it as long at least");
    }
    StepDraft { outputs: Some(outputs), ms: for_ms.map(|ms| ms.value) }
}
