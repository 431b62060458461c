//! A profile after checking: numbers and codes only, no text to interpret.
//!
//! `action` and `keys` are what a press does, `place`, `sector` and `axes` what the place of a contact means; `words` are the names of
//! these values in a profile's text, and [`sketch`] draws a profile with them.

mod action;
pub(crate) mod angle;
mod axes;
mod keys;
mod labels;
mod place;
mod program;
pub(crate) mod sector;
pub mod sketch;
mod word_places;
pub(crate) mod words;

use arrayvec::ArrayVec;

pub use self::action::{
    Action, Command, Effect, HoldOn, Layer, Macro, MacroStep, Mode, Output, PROFILE_NAME_MAX, Role, Roles,
    Skip, TimedEffect, When,
};
use self::angle::wrapped;
pub use self::axes::{SIDES, Side, Source, Stick, Trigger};
pub use self::keys::{Binding, KEYS_MAX, Keys};
pub use self::labels::{Labelled, Labels};
pub use self::place::{ButtonPlace, Direction, Dpad, DpadMode, Gain, Pointer, PointerMode, Zone};
pub use self::program::Program;
use crate::pipeline::control::{Code, OutputDevice};
use crate::pipeline::signal::filter::MeanFilter;

/// The most buttons a profile can bind.
pub const BUTTONS_MAX: usize = 16;

/// The most zones that a profile can have.
pub const ZONES_MAX: usize = 16;

/// The most layers that a profile can have.
pub const LAYERS_MAX: usize = 8;

/// The most macros that a profile can have.
pub const MACROS_MAX: usize = 16;

/// The most steps that a macro can have.
pub const STEPS_MAX: usize = 32;

/// The most controls that a profile drives on one device, and with the pointer.
pub const CONTROLS_MAX: usize = 33;

/// The fastest pointer that a profile can ask for, in counts per second.
pub const POINTER_SPEED_MAX: i32 = 5_000;

/// Help for hands that press what they do not mean.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Access {
    /// Slow Keys: a press counts once it has lasted this long.
    pub slow_us: u64,
    /// Bounce Keys: a press that begins less than this after the last one of its button ended does not count.
    pub bounce_us: u64,
    /// Calms the place of the contact.
    pub tremor: Option<Tremor>,
    /// A hand that rests on the pad is no touch.
    pub rest: Option<RestRejection>,
}

/// A low-pass of the contact's place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tremor {
    /// What trembles faster than this is calmed where the finger rests.
    pub cutoff_hz: f32,
    /// By so much the cutoff grows, in Hz, with each mm/s of the finger's speed.
    pub per_mm: f32,
}

impl Tremor {
    /// By how much a place comes later where the finger rests: 1/(2π f), the time constant of a low-pass of the first order.
    pub fn delay_s(&self) -> f32 {
        1.0 / (core::f32::consts::TAU * self.cutoff_hz)
    }
}

/// Thresholds that tell a touch from a resting hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestRejection {
    /// A touch is by so much above the load that rests, in newtons,
    pub n: f32,
    /// which follows slow changes in this time.
    pub us: u64,
}

/// A press that counts when the finger has rested.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dwell {
    /// For so long,
    pub us: u64,
    /// within this distance of where it came to rest.
    pub radius_mm: f32,
}

/// Which force presses a button. The sign says which direction counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Force {
    /// Pressing into the plate.
    Fz,
    /// Pushing right.
    FxPositive,
    /// Pushing left.
    FxNegative,
    /// Pushing up.
    FyPositive,
    /// Pushing down.
    FyNegative,
}

/// A button pressed by a force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Button {
    /// The force that presses it.
    pub force: Force,
    /// Pressed at this force or more.
    pub press_n: f32,
    /// Released below this force; less than `press_n`.
    pub release_n: f32,
    /// Released as soon as the force has fallen by so much, and pressed again when it has risen by as much.
    pub hair_n: Option<f32>,
    /// It counts when the finger has rested.
    pub dwell: Option<Dwell>,
    /// Where it counts; everywhere if that is not said.
    pub place: Option<ButtonPlace>,
    /// When it counts.
    pub when: When,
    /// Effect of a press.
    pub action: Action,
}

/// One game's mapping.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Name for people.
    pub name: String,
    /// The programs that it is for; none where it is chosen by name alone.
    pub programs: Vec<Program>,
    /// The device that the directions and those buttons that name no pointer's belong to.
    pub output: OutputDevice,
    /// Window of the mean filter, in samples.
    pub filter_samples: usize,
    /// Whether the mean begins anew where the load changes.
    pub filter_adapts: bool,
    /// An output, once down, stays down at least this long, so that a game that polls once a frame sees it.
    pub min_press_us: u64,
    /// Help for hands that press what they do not mean.
    pub access: Access,
    /// Where the hand has its centre: places are counted from there.
    pub centre_mm: [f32; 2],
    /// By how much farther places count.
    pub gain: Gain,
    /// Zones, in the file's order; where two overlap the first one counts.
    pub zones: Vec<Zone>,
    /// Layers, in the file's order.
    pub layers: Vec<Layer>,
    /// Macros, in the file's order.
    pub macros: Vec<Macro>,
    /// Directions; `None` where the profile has none.
    pub dpad: Option<Dpad>,
    /// The pointer's movement; `None` where the profile moves none.
    pub pointer: Option<Pointer>,
    /// Sticks of the gamepad; none where the keyboard is played.
    pub sticks: ArrayVec<Stick, SIDES>,
    /// Triggers of the gamepad; none where the keyboard is played.
    pub triggers: ArrayVec<Trigger, SIDES>,
    /// Buttons, in the file's order.
    pub buttons: ArrayVec<Button, BUTTONS_MAX>,
    /// What its parts do in the game, as a person named it.
    pub labels: Labels,
}

impl Profile {
    /// The mean filter, before the first sample.
    pub fn filter(&self) -> MeanFilter {
        let new = if self.filter_adapts { MeanFilter::adaptive } else { MeanFilter::new };
        new(self.filter_samples)
    }

    /// By how much it delays a finger that comes quickly, in samples: half of its window, or where it adapts one at most. A slow one is delayed by
    /// up to half of the window in any case.
    pub fn filter_delay_samples(&self) -> f64 {
        let half = self.filter_samples.saturating_sub(1) as f64 / 2.0;
        if self.filter_adapts { half.min(1.0) } else { half }
    }

    /// Whether the profile plays on `device`, so that it must be there.
    pub fn uses(&self, device: OutputDevice) -> bool {
        let moved = self.pointer.map(|pointer| match pointer.mode {
            PointerMode::Relative => OutputDevice::Pointer,
            PointerMode::Absolute => OutputDevice::Tablet,
        });
        moved == Some(device) || self.bindings().any(|binding| binding.device == device)
    }

    /// All bindings in the order of the output: left, right, up, down, then those of the layers, the buttons, the macros and the
    /// axes.
    pub fn bindings(&self) -> impl Iterator<Item = Binding> + '_ {
        let directions = self.dpad.iter().flat_map(|dpad| [dpad.left, dpad.right, dpad.up, dpad.down]);
        let in_layers =
            self.layers.iter().flat_map(|layer| [layer.left, layer.right, layer.up, layer.down]).flatten();
        let in_macros = self.macros.iter().flat_map(|it| it.steps.iter().filter_map(|step| step.keys));
        let buttons = self.buttons.iter().flat_map(Button::bindings);
        let keys = |keys: Keys| keys.iter();
        let controls =
            directions.chain(in_layers).flat_map(keys).chain(buttons).chain(in_macros.flat_map(keys));
        controls.chain(self.axes().map(|code| Binding { device: OutputDevice::Gamepad, code, value: 1 }))
    }

    /// The axes of its sticks and triggers.
    fn axes(&self) -> impl Iterator<Item = Code> + '_ {
        let sticks = self.sticks.iter().flat_map(Stick::axes);
        sticks.chain(self.triggers.iter().map(Trigger::axis))
    }

    /// Commands that its presses can ask of the bridge.
    pub fn commands(&self) -> impl Iterator<Item = Command> + '_ {
        let effects = self.buttons.iter().flat_map(|button| button.effects().into_iter().flatten());
        effects.filter_map(|effect| match effect.output {
            Output::Bridge(command) => Some(command),
            Output::Keys(_) | Output::Layer(_) | Output::Macro(_) => None,
        })
    }

    /// Whether a press leads to another profile.
    pub fn leads_on(&self) -> bool {
        self.commands().any(|command| matches!(command, Command::NextProfile | Command::Profile(_)))
    }
}

impl Profile {
    /// The same layout for the other hand: its centre, zones, gains and sideways forces change sides, the D-pad turns the other way. What is to the
    /// right stays to the right.
    #[must_use]
    pub fn mirrored(mut self) -> Self {
        self.gain = Gain { right: self.gain.left, left: self.gain.right, ..self.gain };
        self.centre_mm = [-self.centre_mm[0], self.centre_mm[1]];
        for zone in &mut self.zones {
            zone.middle_deg = wrapped(180.0 - zone.middle_deg);
        }
        if let Some(dpad) = &mut self.dpad {
            dpad.rotation_deg = -dpad.rotation_deg;
        }
        for button in &mut self.buttons {
            button.force = button.force.mirrored();
        }
        self
    }
}

impl Force {
    const fn mirrored(self) -> Self {
        match self {
            Self::FxPositive => Self::FxNegative,
            Self::FxNegative => Self::FxPositive,
            other => other,
        }
    }
}

impl Button {
    /// Effects of its kinds of press, in the order of [`Role::ALL`].
    pub fn effects(&self) -> [Option<Effect>; Role::ALL.len()] {
        match self.action {
            Action::Hold(effect) => [Some(effect), None, None, None, None, None],
            Action::ByTime { tap, double, hold, .. } => {
                [None, Some(tap), double.map(|it| it.effect), hold.map(|it| it.effect), None, None]
            }
            Action::ByForce { light, hard, .. } => [None, None, None, None, Some(light), Some(hard)],
        }
    }

    /// Controls that it can press.
    pub fn bindings(&self) -> impl Iterator<Item = Binding> + use<> {
        self.effects().into_iter().flatten().flat_map(|effect| effect.output.bindings())
    }
}
