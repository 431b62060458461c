//! A profile after checking: numbers and codes only, no text to interpret.

use arrayvec::ArrayVec;

use super::angle::wrapped;
pub use super::keys::{Binding, KEYS_MAX, Keys};
pub use super::place::{Direction, Dpad, DpadMode, Gain, Place, Pointer, Zone};
use crate::pipeline::control::OutputDevice;

/// The most buttons a profile can bind.
pub const BUTTONS_MAX: usize = 16;

/// The most zones that a profile can have.
pub const ZONES_MAX: usize = 16;

/// The most controls that a profile drives on one device, and with the pointer.
pub const CONTROLS_MAX: usize = 32;

/// The fastest pointer that a profile can ask for, in counts per second.
pub const POINTER_SPEED_MAX: i32 = 5_000;

/// How keys follow what is pressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Down as long as it lasts.
    Plain,
    /// Each time it begins they go down and stay, or go up again.
    Toggle,
    /// Sticky Keys: the first press lets them stay down until another press has ended, a second one locks them, a third lets go.
    Sticky,
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

/// Help for hands that press what they do not mean.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Access {
    /// Slow Keys: a press counts once it has lasted this long.
    pub slow_us: u64,
    /// Bounce Keys: a press that begins less than this after the last one of its button ended does not count.
    pub bounce_us: u64,
    /// Calms the place of the contact.
    pub tremor: Option<Tremor>,
}

/// A low-pass of the contact's place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tremor {
    /// What trembles faster than this is calmed where the finger rests.
    pub cutoff_hz: f32,
    /// By so much the cutoff grows, in Hz, with each mm/s of the finger's speed.
    pub per_mm: f32,
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

/// What a press does.
#[derive(Clone, Copy, Debug, PartialEq)]
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
    /// By how hard a press is.
    ByForce {
        /// A light one.
        light: Effect,
        /// A hard one.
        hard: Effect,
        /// Hard at this force or more; more than the button's.
        hard_press_n: f32,
        /// No longer hard below this force; less than `hard_press_n`.
        hard_release_n: f32,
        /// What becomes of the light one on the way to a hard one.
        skip: Skip,
    },
}

/// What becomes of a light press on the way to a hard one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Skip {
    /// The light one begins at once, the hard one comes on top.
    No,
    /// A press that is hard within this time is hard alone; after a slower one hard may come on top.
    May {
        /// The time.
        us: u64,
    },
    /// A press that is hard within this time is hard alone; once light has begun hard never comes.
    Must {
        /// The time.
        us: u64,
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
    /// One that is not hard.
    Light,
    /// A hard one.
    Hard,
}

impl Role {
    /// In the order of a button's effects.
    pub const ALL: [Self; 6] = [Self::Out, Self::Tap, Self::Double, Self::Hold, Self::Light, Self::Hard];

    /// Its key in a profile.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Out => "out",
            Self::Tap => "tap",
            Self::Double => "double",
            Self::Hold => "hold",
            Self::Light => "light",
            Self::Hard => "hard",
        }
    }
}

/// The kinds of press that are on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Roles(u8);

impl Roles {
    /// None.
    pub const NONE: Self = Self(0);

    /// With one more.
    #[must_use]
    pub const fn with(self, role: Role) -> Self {
        Self(self.0 | 1 << role as u8)
    }

    /// Whether it is among them.
    pub const fn has(self, role: Role) -> bool {
        self.0 & 1 << role as u8 != 0
    }
}

impl From<Role> for Roles {
    fn from(role: Role) -> Self {
        Self::NONE.with(role)
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
    /// Released as soon as the force has fallen by so much, and pressed again when it has risen by as much.
    pub hair_n: Option<f32>,
    /// It counts when the finger has rested.
    pub dwell: Option<Dwell>,
    /// Where it counts; everywhere if that is not said.
    pub place: Option<Place>,
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
    /// Help for hands that press what they do not mean.
    pub access: Access,
    /// By how much farther places count.
    pub gain: Gain,
    /// Zones, in the file's order; where two overlap the first one counts.
    pub zones: Vec<Zone>,
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

impl Profile {
    /// The same layout for the other hand: zones, gains and sideways forces change sides, the D-pad turns the other way. What is to the
    /// right stays to the right.
    #[must_use]
    pub fn mirrored(mut self) -> Self {
        self.gain = Gain { right: self.gain.left, left: self.gain.right, ..self.gain };
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
    /// What its kinds of press do, in the order of [`Role::ALL`].
    pub fn effects(&self) -> [Option<Effect>; Role::ALL.len()] {
        match self.action {
            Action::Hold(effect) => [Some(effect), None, None, None, None, None],
            Action::ByTime { tap, double, hold } => {
                [None, Some(tap), double.map(|it| it.effect), hold.map(|it| it.effect), None, None]
            }
            Action::ByForce { light, hard, .. } => [None, None, None, None, Some(light), Some(hard)],
        }
    }

    /// What it can press.
    pub fn bindings(&self) -> impl Iterator<Item = Binding> + use<> {
        self.effects().into_iter().flatten().flat_map(|effect| effect.keys.iter())
    }
}
