//! From a profile's text to a [`Profile`]: names, types, ranges, and how the numbers stand to each other.
//!
//! `mappings/README.md` documents every key for people. All findings are reported at once.

use arrayvec::ArrayVec;

use crate::pipeline::control::OutputDevice;
use crate::pipeline::mapping::profile::Program;
use crate::pipeline::mapping::profile::words::POINTER_MODES;
use crate::pipeline::mapping::profile::{
    Access, BUTTONS_MAX, Direction, Gain, Labels, Pointer, PointerMode, Profile, Stick, Trigger, Zone,
};
use crate::pipeline::mapping::read::common::conflict::{self, Use};
use crate::pipeline::mapping::read::common::labels;
use crate::pipeline::mapping::read::common::limits::{
    CURVE, FILTER_SAMPLES, FULL_RADIUS_MM, MIN_PRESS_MS, POINTER_CENTRE_MM, SPEED_COUNTS_PER_S,
};
use crate::pipeline::mapping::read::section::access::{self, ACCESS_KEYS};
use crate::pipeline::mapping::read::section::axes;
use crate::pipeline::mapping::read::section::button::{BUTTON_KEYS, ButtonContext, ButtonDraft};
use crate::pipeline::mapping::read::section::dpad::{DPAD_KEYS, DpadDraft, read_gate};
use crate::pipeline::mapping::read::section::effects::EffectContext;
use crate::pipeline::mapping::read::section::layers::LayerDraft;
use crate::pipeline::mapping::read::section::macros::MacroDraft;
use crate::pipeline::mapping::read::section::plate;
use crate::pipeline::mapping::read::section::programs::{self, PROGRAM_KEYS, PROGRAMS_MAX};
use crate::pipeline::mapping::read::section::reach::{self, Places};
use crate::toml_text;
use crate::toml_text::diag::{Diagnostic, Findings};
use crate::toml_text::section::{Bounds, Section};

/// Which of a profile's two sets of bindings to use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputChoice {
    /// The one that the profile's `output` names.
    AsWritten,
    /// The keyboard's, for outputs that only have keys.
    Keyboard,
}

const OUTPUTS: [(&str, OutputDevice); 2] =
    [("gamepad", OutputDevice::Gamepad), ("keyboard", OutputDevice::Keyboard)];

const ROOT_KEYS: [&str; 20] = [
    "schema",
    "name",
    "program",
    "output",
    "filter_samples",
    "filter_adapts",
    "min_press_ms",
    "left_handed",
    "centre_x_mm",
    "centre_y_mm",
    "access",
    "gain",
    "dpad",
    "pointer",
    "zone",
    "layer",
    "macro",
    "stick",
    "trigger",
    "button",
];
const POINTER_KEYS: [&str; 7] = [
    "mode",
    "centre_radius_mm",
    "full_radius_mm",
    "speed_counts_per_s",
    "curve",
    "min_force_n",
    "release_force_n",
];
/// Those that say how fast it moves.
const SPEED_KEYS: [&str; 3] = ["centre_radius_mm", "speed_counts_per_s", "curve"];

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
    let draft = ProfileDraft::read(&root, &mut findings);
    draft.check_conflicts(&mut findings);
    let places = Places {
        zones: draft.zone_places.clone(),
        layers: draft.layers.iter().map(|it| it.at).collect(),
        macros: draft.macros.iter().map(|it| it.at).collect(),
    };
    let profile = if findings.failed() { None } else { draft.settle(output) };
    if let Some(profile) = &profile {
        reach::check(profile, &places, &mut findings);
    }
    (profile, findings.finish())
}

/// A profile while it is read: what is unusable is `None` and reported.
struct ProfileDraft {
    name: Option<String>,
    programs: Vec<Program>,
    output: Option<OutputDevice>,
    filter_samples: Option<usize>,
    filter_adapts: Option<bool>,
    min_press_ms: Option<u32>,
    left_handed: Option<bool>,
    access: Option<Access>,
    centre_mm: Option<[f32; 2]>,
    gain: Option<Gain>,
    zones: Vec<Zone>,
    /// Byte offsets of their headers.
    zone_places: Vec<usize>,
    layers: Vec<LayerDraft>,
    macros: Vec<MacroDraft>,
    dpad: Option<DpadDraft>,
    /// The inner `None` where a part of it is unusable.
    pointer: Option<Option<Pointer>>,
    sticks: Vec<Option<Stick>>,
    triggers: Vec<Option<Trigger>>,
    buttons: Vec<ButtonDraft>,
    labels: Labels,
}

impl ProfileDraft {
    fn read(root: &Section<'_>, findings: &mut Findings<'_>) -> Self {
        read_schema(root, findings);
        let output = root.word("output", &OUTPUTS, findings).map(|word| word.value);
        root.require("output", "write output = \"gamepad\" or output = \"keyboard\"", findings);
        let min_press_ms = root.whole("min_press_ms", MIN_PRESS_MS, findings).map(|ms| ms.value);
        let dpad = root.table("dpad", "[dpad]".to_owned(), &DPAD_KEYS, findings);
        let pointer = root.table("pointer", "[pointer]".to_owned(), &POINTER_KEYS, findings);
        let access = root.table("access", "[access]".to_owned(), &ACCESS_KEYS, findings);
        let gain = root.table("gain", "[gain]".to_owned(), &Direction::NAMES, findings);
        let has_dpad = root.place_of("dpad").is_some();
        let (zones, zone_places) = plate::read_zones(root, has_dpad, findings);
        let layers = LayerDraft::read_all(root, has_dpad, findings);
        let macros = MacroDraft::read_all(root, min_press_ms, findings);
        let layer_names: Vec<&str> = layers.iter().map(|it| it.name.as_str()).collect();
        let macro_names: Vec<&str> = macros.iter().map(|it| it.name.as_str()).collect();
        let effects = EffectContext { min_press_ms, layers: &layer_names, macros: &macro_names };
        let around = ButtonContext { effects, zones: &zones, has_dpad };
        // One more than there can be, so that the first one too many is known by its place.
        let buttons = root.tables("button", &BUTTON_KEYS, BUTTONS_MAX + 1, findings);
        check_counts(root, &buttons, findings);
        let programs = root.tables("program", &PROGRAM_KEYS, PROGRAMS_MAX + 1, findings);
        Self {
            name: read_name(root, findings),
            programs: programs::read(&programs, findings),
            output,
            filter_samples: root
                .whole("filter_samples", FILTER_SAMPLES, findings)
                .map(|count| count.value as usize),
            filter_adapts: read_flag(root, "filter_adapts", findings),
            min_press_ms,
            left_handed: read_flag(root, "left_handed", findings),
            access: access.map_or(Some(Access::default()), |access| access::read(&access, findings)),
            centre_mm: plate::read_centre(root, findings),
            gain: gain.map_or(Some(Gain::ONE), |gain| plate::read_gain(&gain, findings)),
            dpad: dpad.map(|dpad| DpadDraft::read(&dpad, findings)),
            pointer: pointer.map(|pointer| read_pointer(&pointer, findings)),
            sticks: axes::read_sticks(root, findings),
            triggers: axes::read_triggers(root, &zones, has_dpad, findings),
            buttons: buttons.iter().map(|button| ButtonDraft::read(button, around, findings)).collect(),
            labels: labels::read(root, findings),
            zones,
            zone_places,
            layers,
            macros,
        }
    }

    fn check_conflicts(&self, findings: &mut Findings<'_>) {
        let mut uses: Vec<Use> = self.dpad.iter().flat_map(DpadDraft::uses).collect();
        uses.extend(self.layers.iter().enumerate().flat_map(|(number, layer)| layer.uses(number)));
        uses.extend((1..).zip(&self.buttons).flat_map(|(number, button)| button.uses(number)));
        uses.extend((1..).zip(&self.macros).flat_map(|(number, it)| it.uses(number)));
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
        let macros = self.macros.into_iter().map(|it| it.settle(output)).collect::<Option<_>>()?;
        let profile = Profile {
            name: self.name?,
            programs: self.programs,
            output,
            filter_samples: self.filter_samples?,
            filter_adapts: self.filter_adapts?,
            min_press_us: u64::from(self.min_press_ms?) * 1_000,
            access: self.access?,
            centre_mm: self.centre_mm?,
            gain: self.gain?,
            zones: self.zones,
            layers: self.layers.into_iter().map(|layer| layer.settle(output)).collect(),
            macros,
            dpad,
            pointer,
            sticks: played(self.sticks, output)?,
            triggers: played(self.triggers, output)?,
            buttons,
            labels: self.labels,
        };
        Some(if self.left_handed? { profile.mirrored() } else { profile })
    }
}

/// Reports a profile that does nothing, and one button too many.
fn check_counts(root: &Section<'_>, buttons: &[Section<'_>], findings: &mut Findings<'_>) {
    if ["dpad", "pointer", "stick", "trigger", "button"].iter().all(|key| root.place_of(key).is_none()) {
        findings.warning(
            root.at,
            "the profile does nothing",
            "add a [dpad], [pointer], [[stick]], [[trigger]] or [[button]] table",
        );
    }
    if let Some(extra) = buttons.get(BUTTONS_MAX) {
        findings.error(extra.at, format!("a profile has at most {BUTTONS_MAX} buttons"), "remove this one");
    }
}

/// What is played of the gamepad's axes on `output`; `None` if one is missing.
fn played<T, const N: usize>(all: Vec<Option<T>>, output: OutputDevice) -> Option<ArrayVec<T, N>> {
    let all = all.into_iter().collect::<Option<Vec<T>>>()?;
    Some(all.into_iter().filter(|_| output == OutputDevice::Gamepad).take(N).collect())
}

/// A flag that is off where it is not written.
fn read_flag(root: &Section<'_>, key: &'static str, findings: &mut Findings<'_>) -> Option<bool> {
    root.place_of(key).map_or(Some(false), |_| root.flag(key, findings))
}

fn read_schema(root: &Section<'_>, findings: &mut Findings<'_>) {
    root.require("schema", "write schema = 1 as the first line", findings);
    root.whole("schema", Bounds { low: 1, high: 1, default: 1 }, findings);
}

fn read_name(root: &Section<'_>, findings: &mut Findings<'_>) -> Option<String> {
    root.require("name", "write name = \"…\", the game's name", findings);
    root.name("name", findings).map(str::to_owned)
}

fn read_pointer(table: &Section<'_>, findings: &mut Findings<'_>) -> Option<Pointer> {
    let mode = match table.place_of("mode") {
        Some(_) => table.word("mode", &POINTER_MODES, findings).map(|word| word.value),
        None => Some(PointerMode::Relative),
    };
    if mode == Some(PointerMode::Absolute) {
        for (key, at) in SPEED_KEYS.iter().filter_map(|key| Some((key, table.place_of(key)?))) {
            findings.warning(at, format!("\"{key}\" does nothing in mode \"absolute\""), "remove it");
        }
    }
    let centre = table.number("centre_radius_mm", POINTER_CENTRE_MM, findings);
    let full = table.number("full_radius_mm", FULL_RADIUS_MM, findings);
    table.require_less(("centre_radius_mm", centre), ("full_radius_mm", full), findings);
    let speed = table.number("speed_counts_per_s", SPEED_COUNTS_PER_S, findings);
    let curve = table.number("curve", CURVE, findings);
    let (min_force_n, release_force_n) = read_gate(table, findings);
    Some(Pointer {
        mode: mode?,
        centre_radius_mm: centre?.value,
        full_radius_mm: full?.value,
        speed_counts_per_s: speed?.value,
        curve: curve?.value,
        min_force_n: min_force_n?,
        release_force_n: release_force_n?,
    })
}
