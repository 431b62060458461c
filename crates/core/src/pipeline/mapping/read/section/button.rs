//! A profile's buttons: which force presses them, and what their kinds of press do.

use super::access;
use super::effects::{EffectContext, EffectDraft};
use super::layers::BASE;
use super::plate;
use super::stages::{self, Stages};
use crate::pipeline::control::OutputDevice;
use crate::pipeline::mapping::profile::words::FORCES;
use crate::pipeline::mapping::profile::{
    Action, Button, ButtonPlace, Dwell, Effect, Force, HoldOn, Role, TimedEffect, When, Zone,
};
use crate::pipeline::mapping::read::common::conflict::{Owner, Use};
use crate::pipeline::mapping::read::common::limits::{
    DOUBLE_PRESS_MS, FORCE_N, HAIR_N, LONG_PRESS_MS, RELEASE_SHARE,
};
use crate::pipeline::mapping::read::common::named;
use crate::toml_text::diag::Findings;
use crate::toml_text::section::{Bounds, Placed, Section};

pub(crate) const BUTTON_KEYS: [&str; 22] = [
    "force",
    "press_n",
    "release_n",
    "hair_n",
    "dwell_ms",
    "dwell_mm",
    "zone",
    "layer",
    "out",
    "tap",
    "double",
    "hold",
    "double_press_ms",
    "long_press_ms",
    "permissive_hold",
    "hold_on_other_key_press",
    "light",
    "hard",
    "hard_press_n",
    "hard_release_n",
    "skip",
    "skip_ms",
];

/// A button while it is read: what is unusable is `None` and reported.
pub(crate) struct ButtonDraft {
    force: Option<Force>,
    press_n: Option<f32>,
    release_n: Option<f32>,
    hair_n: Option<f32>,
    dwell: Option<Option<Dwell>>,
    place: Option<ButtonPlace>,
    when: Option<When>,
    action: Option<ActionDraft>,
}

/// Effects of its kinds of press, in the order of [`Role::ALL`], and the times that tell them.
struct ActionDraft {
    effects: [Option<EffectDraft>; Role::ALL.len()],
    double_press_ms: Option<u32>,
    long_press_ms: Option<u32>,
    hold_on: Option<HoldOn>,
    stages: Option<Stages>,
}

/// Context in which a button is read.
#[derive(Clone, Copy)]
pub(crate) struct ButtonContext<'p> {
    pub(crate) effects: EffectContext<'p>,
    pub(crate) zones: &'p [Zone],
    pub(crate) has_dpad: bool,
}

impl ButtonDraft {
    /// Reads a `[[button]]`.
    pub(crate) fn read(table: &Section<'_>, around: ButtonContext<'_>, findings: &mut Findings<'_>) -> Self {
        table.require("force", "write the force that presses it, as force = \"fz\"", findings);
        let force = table.word("force", &FORCES, findings).map(|word| word.value);
        table.require("press_n", "write the force in newtons that presses it, as press_n = 2.0", findings);
        let press = table.number("press_n", FORCE_N, findings);
        let share = press.map_or(FORCE_N.default, |force| force.value) * RELEASE_SHARE;
        let release = table.number("release_n", Bounds { low: 0.0, default: share, ..FORCE_N }, findings);
        table.require_less(("release_n", release), ("press_n", press), findings);
        let hair_n = table.place_of("hair_n").and_then(|_| table.number("hair_n", HAIR_N, findings));
        check_forces(table, [press, release, hair_n], findings);
        let name = table.text("zone", findings);
        let place = name.and_then(|name| plate::find(name, around.zones, around.has_dpad, findings));
        let action = ActionDraft::read(table, around.effects, press, findings);
        let newtons = |force: Option<Placed<f32>>| force.map(|force| force.value);
        Self {
            force,
            press_n: newtons(press),
            release_n: newtons(release),
            hair_n: newtons(hair_n),
            dwell: access::read_dwell(table, findings),
            place,
            when: read_when(table, around.effects.layers, findings),
            action,
        }
    }

    /// Controls that the kinds of press of this button, the `number`th, drive.
    pub(crate) fn uses(&self, number: usize) -> impl Iterator<Item = Use> + use<> {
        let (place, when) = (self.place, self.when.unwrap_or(When::Always));
        let effects = self.action.as_ref().map(|action| action.effects);
        let all = effects.into_iter().flat_map(|effects| Role::ALL.into_iter().zip(effects));
        all.filter_map(move |(role, effect)| {
            let effect = effect?;
            let owner = Owner::Button { number, role: role.name() };
            Some(Use { owner, outputs: effect.outputs()?, toggles: effect.stays(), place, when })
        })
    }

    /// The button on `device`; `None` if a part of it is missing.
    pub(crate) fn settle(self, device: OutputDevice) -> Option<Button> {
        let action = self.action?.settle(device)?;
        let Self { hair_n, place, .. } = self;
        let (dwell, when) = (self.dwell?, self.when?);
        let (press_n, release_n) = (self.press_n?, self.release_n?);
        Some(Button { force: self.force?, press_n, release_n, hair_n, dwell, place, when, action })
    }
}

/// Less between a press and its release than this is the noise of a pad and the trembling of a finger: some 20 mN, several times.
const HYSTERESIS_MIN_N: f32 = 0.05;

/// What a hair trigger falls by has to stand out from a trembling finger, too.
const HAIR_MIN_N: f32 = 0.1;

/// Nobody plays with more; the pad is calibrated to 5 N.
const FINGER_MAX_N: f32 = 15.0;

/// Warns of forces with which a button presses by itself, or never.
fn check_forces(
    table: &Section<'_>,
    [press, release, hair]: [Option<Placed<f32>>; 3],
    findings: &mut Findings<'_>,
) {
    let place = |key: &str| table.place_of(key).unwrap_or(table.at);
    let Some(press) = press.map(|press| press.value) else { return };
    if press > FINGER_MAX_N {
        let message = format!("nobody presses {press} N with a finger: this button is never pressed");
        findings.warning(place("press_n"), message, "write 1 to 5");
    }
    if let Some(release) = release.map(|release| release.value)
        && release < press
        && press - release < HYSTERESIS_MIN_N
    {
        let message = format!(
            "between press_n = {press} and release_n = {release} a resting finger presses many times a second"
        );
        let help = format!("write release_n = {:.2}, or leave it out", RELEASE_SHARE * press);
        findings.warning(place("release_n"), message, help);
    }
    if let Some(hair) = hair.map(|hair| hair.value).filter(|hair| *hair < HAIR_MIN_N) {
        let message = format!("with hair_n = {hair} a resting finger presses many times a second");
        findings.warning(place("hair_n"), message, format!("write hair_n = {HAIR_MIN_N} or more"));
    }
}

/// When a button counts: in the layer that it names, while there is none, or always.
fn read_when(table: &Section<'_>, layers: &[&str], findings: &mut Findings<'_>) -> Option<When> {
    if table.place_of("layer").is_none() {
        return Some(When::Always);
    }
    let asked = table.text("layer", findings)?;
    let known: Vec<&str> = [BASE].into_iter().chain(layers.iter().copied()).collect();
    let number = named::find(asked, "layer", &known, findings)?;
    Some(number.checked_sub(1).map_or(When::Base, When::Layer))
}

impl ActionDraft {
    fn read(
        table: &Section<'_>,
        around: EffectContext<'_>,
        press: Option<Placed<f32>>,
        findings: &mut Findings<'_>,
    ) -> Option<Self> {
        let effects = Role::ALL.map(|role| EffectDraft::read(table, role, around, findings));
        let double = read_time(table, Role::Double, "double_press_ms", DOUBLE_PRESS_MS, findings);
        let long = read_time(table, Role::Hold, "long_press_ms", LONG_PRESS_MS, findings);
        let hold_on = read_hold_on(table, findings);
        let stages = stages::read(table, press, findings);
        check_roles(table, findings)?;
        check_times(table, [double, long], around.min_press_ms, findings);
        let ms = |time: Option<Placed<u32>>| time.map(|time| time.value);
        Some(Self { effects, double_press_ms: ms(double), long_press_ms: ms(long), hold_on, stages })
    }

    fn settle(self, device: OutputDevice) -> Option<Action> {
        let [out, tap, double, hold, light, hard] =
            self.effects.map(|effect| effect.and_then(|effect| effect.settle(device)));
        let timed = |effect: Option<Effect>, ms: Option<u32>| {
            effect.zip(ms).map(|(effect, ms)| TimedEffect { effect, us: u64::from(ms) * 1_000 })
        };
        let (double, hold) = (timed(double, self.double_press_ms), timed(hold, self.long_press_ms));
        let by_time = || Some(Action::ByTime { tap: tap?, double, hold, hold_on: self.hold_on? });
        let by_force = || {
            let Stages { press_n: hard_press_n, release_n: hard_release_n, skip } = self.stages?;
            Some(Action::ByForce { light: light?, hard: hard?, hard_press_n, hard_release_n, skip })
        };
        out.map(Action::Hold).or_else(by_time).or_else(by_force)
    }
}

/// The three ways to write what a button does, each with its kinds of press.
const WAYS: [&[Role]; 3] = [&[Role::Out], &[Role::Tap, Role::Double, Role::Hold], &[Role::Light, Role::Hard]];

/// Reports it if the kinds of press are not those of one way; `None` if they are of several.
fn check_roles(table: &Section<'_>, findings: &mut Findings<'_>) -> Option<()> {
    let first = |way: &[Role]| way.iter().find_map(|role| Some((*role, table.place_of(role.name())?)));
    let written: Vec<(Role, usize)> = WAYS.iter().filter_map(|way| first(way)).collect();
    match written.as_slice() {
        [] => table.require("out", OUT_HELP, findings),
        [(Role::Out, _)] => {}
        [(Role::Light | Role::Hard, _)] => {
            table.require("light", "a button with \"hard\" needs \"light\", too", findings);
            table.require("hard", "a button with \"light\" needs \"hard\", too", findings);
        }
        [_] => require_tap(table, findings),
        [(one, _), (other, at), ..] => {
            let message = format!("{} has both \"{}\" and \"{}\"", table.title, one.name(), other.name());
            findings.error(*at, message, WAYS_HELP);
            return None;
        }
    }
    Some(())
}

const WAYS_HELP: &str = "write \"out\"; or \"tap\", \"double\" and \"hold\"; or \"light\" and \"hard\"";
const OUT_HELP: &str =
    "write out = { gamepad = \"BTN_…\", keyboard = \"KEY_…\" }, or tap, double and hold instead of out";

/// The time that tells a kind of press; none where there is no such kind.
fn read_time(
    table: &Section<'_>,
    role: Role,
    key: &str,
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

/// What makes a press long before its time; `None` where that is unusable.
fn read_hold_on(table: &Section<'_>, findings: &mut Findings<'_>) -> Option<HoldOn> {
    let keys = [("permissive_hold", HoldOn::NestedPress), ("hold_on_other_key_press", HoldOn::OtherPress)];
    let mut written = keys.iter().filter_map(|(key, it)| Some((*key, *it, table.place_of(key)?)));
    let Some((key, hold_on, at)) = written.next() else { return Some(HoldOn::Time) };
    if let Some((other, _, at)) = written.next() {
        let message = format!("{} has both \"{key}\" and \"{other}\"", table.title);
        findings.error(at, message, "write one of them");
        return None;
    }
    if table.place_of(Role::Hold.name()).is_none() {
        let message = format!("\"{key}\" does nothing without \"hold\"");
        findings.error(at, message, "remove it, or write \"hold\"");
    }
    Some(if table.flag(key, findings)? { hold_on } else { HoldOn::Time })
}

/// A button that does something by time has at least a tap.
fn require_tap(table: &Section<'_>, findings: &mut Findings<'_>) {
    let help = match table.place_of(Role::Hold.name()) {
        Some(_) => "a button with \"hold\" needs \"tap\", too",
        None => "a button with \"double\" needs \"tap\", too",
    };
    table.require("tap", help, findings);
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
