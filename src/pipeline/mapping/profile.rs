//! A profile after checking: numbers and codes only, no text to interpret.

use arrayvec::ArrayVec;

use crate::pipeline::control::{Code, OutputDevice};

/// The most buttons a profile can bind.
pub const BUTTONS_MAX: usize = 8;

/// The most keys that one press gives at once.
pub const KEYS_MAX: usize = 4;

/// The most controls that a profile drives on one device, and with the pointer.
pub const CONTROLS_MAX: usize = 32;

/// The fastest pointer that a profile can ask for, in counts per second.
pub const POINTER_SPEED_MAX: i32 = 5_000;

/// What a control does when it is active: one key, or one axis pushed to a position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Binding {
    /// The device it is on.
    pub device: OutputDevice,
    /// The key or axis.
    pub code: Code,
    /// 1 for keys, −1 or 1 for the hat.
    pub value: i32,
}

/// Controls that go down and up together, the first one first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Keys {
    all: [Option<Binding>; KEYS_MAX],
}

impl Keys {
    /// The first [`KEYS_MAX`] of these.
    pub fn new(bindings: impl IntoIterator<Item = Binding>) -> Self {
        let mut all = [None; KEYS_MAX];
        all.iter_mut().zip(bindings).for_each(|(place, binding)| *place = Some(binding));
        Self { all }
    }

    /// In their order.
    pub fn iter(&self) -> impl Iterator<Item = Binding> + use<> {
        self.all.into_iter().flatten()
    }
}

/// How keys follow what is pressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Down as long as it lasts.
    Plain,
    /// Each time it begins they go down and stay, or go up again.
    Toggle,
    /// Down in the first half of each period as long as it lasts.
    Turbo {
        /// From one press to the next.
        period_us: u64,
    },
}

/// What a kind of press does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effect {
    /// What goes down.
    pub keys: Keys,
    /// And how.
    pub mode: Mode,
}

/// A kind of press that is told by a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timed {
    /// What it does.
    pub effect: Effect,
    /// The time that tells it.
    pub us: u64,
}

/// How the directions divide the plate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DpadMode {
    /// Four sectors of 90°.
    FourWay,
    /// Four sectors; between them, on the diagonals, the last direction stays.
    FourWaySticky,
    /// Eight sectors; a diagonal holds two directions.
    EightWay,
}

/// Directions from the place of the contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dpad {
    /// How the directions divide the plate.
    pub mode: DpadMode,
    /// A direction starts at this distance from the centre or farther.
    pub centre_radius_mm: f32,
    /// It ends closer than `centre_radius_mm − radius_hysteresis_mm`.
    pub radius_hysteresis_mm: f32,
    /// Angle of each diagonal zone. The 8-way mode holds two directions there, the sticky 4-way mode keeps the
    /// last one; the plain 4-way mode has no such zones.
    pub diagonal_deg: f32,
    /// A direction changes only when the contact is this far past the sector's edge. 0 in the sticky 4-way
    /// mode, whose diagonal zones are its hysteresis.
    pub hysteresis_deg: f32,
    /// Turns the sectors counter-clockwise seen from above.
    pub rotation_deg: f32,
    /// A direction starts at this normal force or more.
    pub min_force_n: f32,
    /// It ends below this normal force.
    pub release_force_n: f32,
    /// Up.
    pub up: Keys,
    /// Down.
    pub down: Keys,
    /// Left.
    pub left: Keys,
    /// Right.
    pub right: Keys,
}

/// The pointer steered like a joystick: the place of the contact is a velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pointer {
    /// Up to this distance from the centre the pointer rests.
    pub centre_radius_mm: f32,
    /// From this distance on it has its full speed; more than `centre_radius_mm`.
    pub full_radius_mm: f32,
    /// The full speed, at most [`POINTER_SPEED_MAX`].
    pub speed_counts_per_s: f32,
    /// Between the two distances the speed grows with this power of the part of the way.
    pub curve: f32,
    /// It starts to move at this normal force or more.
    pub min_force_n: f32,
    /// It rests below this normal force.
    pub release_force_n: f32,
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

/// What a press does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Any press, as long as it lasts.
    Hold(Effect),
    /// By how long a press lasts, and how soon it comes after another one.
    ByTime {
        /// A short press, when it ends. Where there is a double press: when that can no longer come.
        tap: Effect,
        /// A press that begins less than this time after the end of a short one, as long as it lasts.
        double: Option<Timed>,
        /// A press from this duration on, until it ends; without it none is long.
        hold: Option<Timed>,
    },
}

/// A kind of press.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Any press.
    Out,
    /// A short one that has ended.
    Tap,
    /// One soon after a short one.
    Double,
    /// A long one.
    Hold,
}

impl Role {
    /// In the order of a button's effects.
    pub const ALL: [Self; 4] = [Self::Out, Self::Tap, Self::Double, Self::Hold];

    /// Its key in a profile.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Out => "out",
            Self::Tap => "tap",
            Self::Double => "double",
            Self::Hold => "hold",
        }
    }
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
    /// What a press does.
    pub action: Action,
}

/// One game's mapping.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Name for people.
    pub name: String,
    /// The device that the directions and those buttons that name no pointer's belong to.
    pub output: OutputDevice,
    /// Window of the mean filter, in samples.
    pub filter_samples: usize,
    /// An output, once down, stays down at least this long, so that a game that polls once a frame sees it.
    pub min_press_us: u64,
    /// Directions; `None` where the profile has none.
    pub dpad: Option<Dpad>,
    /// The pointer's movement; `None` where the profile moves none.
    pub pointer: Option<Pointer>,
    /// Buttons, in the file's order.
    pub buttons: ArrayVec<Button, BUTTONS_MAX>,
}

impl Profile {
    /// Whether the profile plays on `device`, so that it must be there.
    pub fn uses(&self, device: OutputDevice) -> bool {
        let moves = self.pointer.is_some() && device == OutputDevice::Pointer;
        moves || self.bindings().any(|binding| binding.device == device)
    }

    /// All bindings in the order of the output: left, right, up, down, then those of the buttons.
    pub fn bindings(&self) -> impl Iterator<Item = Binding> + '_ {
        let directions = self.dpad.iter().flat_map(|dpad| [dpad.left, dpad.right, dpad.up, dpad.down]);
        directions.flat_map(|keys| keys.iter()).chain(self.buttons.iter().flat_map(Button::bindings))
    }
}

impl Button {
    /// What its kinds of press do, in the order of [`Role::ALL`].
    pub fn effects(&self) -> [Option<Effect>; Role::ALL.len()] {
        match self.action {
            Action::Hold(effect) => [Some(effect), None, None, None],
            Action::ByTime { tap, double, hold } => {
                [None, Some(tap), double.map(|it| it.effect), hold.map(|it| it.effect)]
            }
        }
    }

    /// What it can press.
    pub fn bindings(&self) -> impl Iterator<Item = Binding> + use<> {
        self.effects().into_iter().flatten().flat_map(|effect| effect.keys.iter())
    }
}
