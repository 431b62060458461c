//! What a press does: kinds of press, the keys, layers, macros and commands that they act on, and how these follow.

use arrayvec::ArrayString;

use super::keys::{Binding, Keys};

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

/// Effect of a kind of press.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effect {
    /// What it acts on.
    pub output: Output,
    /// How that follows the press.
    pub mode: Mode,
}

/// What a kind of press acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// These go down.
    Keys(Keys),
    /// The layer of this number is on.
    Layer(usize),
    /// The macro of this number begins.
    Macro(usize),
    /// The bridge is asked for something, once, where the press begins.
    Bridge(Command),
}

impl Output {
    /// The keys; none where it acts on something else.
    pub fn bindings(self) -> impl Iterator<Item = Binding> + use<> {
        let keys = if let Self::Keys(keys) = self { Some(keys) } else { None };
        keys.into_iter().flat_map(|keys| keys.iter())
    }
}

/// The most bytes of a profile's name that a press can ask for.
pub const PROFILE_NAME_MAX: usize = 64;

/// What a press can ask of the bridge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// To go over to the next profile.
    NextProfile,
    /// To go over to the profile of this name.
    Profile(ArrayString<PROFILE_NAME_MAX>),
    /// To pause, or to go on.
    TogglePause,
    /// To release everything.
    Panic,
    /// To measure the zero again.
    Tare,
}

/// A part of a profile that is on only at times.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// The name by which presses switch it on, and buttons count in it.
    pub name: String,
    /// What the D-pad's up is meanwhile; as ever where there is none.
    pub up: Option<Keys>,
    /// Down.
    pub down: Option<Keys>,
    /// Left.
    pub left: Option<Keys>,
    /// Right.
    pub right: Option<Keys>,
}

/// When a button counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// Always.
    Always,
    /// While no layer is on.
    Base,
    /// While the layer of this number is on.
    Layer(usize),
}

impl When {
    /// Whether that is so while this layer is on.
    pub fn is_met(self, layer: Option<usize>) -> bool {
        match self {
            Self::Always => true,
            Self::Base => layer.is_none(),
            Self::Layer(number) => layer == Some(number),
        }
    }
}

/// Keys that are pressed one after the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Macro {
    /// The name by which presses begin it.
    pub name: String,
    /// In their order.
    pub steps: Vec<MacroStep>,
}

/// One step of a macro.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MacroStep {
    /// What is down; nothing in a pause.
    pub keys: Option<Keys>,
    /// It ends so long after the macro began.
    pub until_us: u64,
}

/// A kind of press that is told by a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimedEffect {
    /// Effect of the press.
    pub effect: Effect,
    /// The time that tells it.
    pub us: u64,
}

/// Effect of a press.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// Any press, as long as it lasts.
    Hold(Effect),
    /// By how long a press lasts, and how soon it comes after another one.
    ByTime {
        /// A short press, when it ends. Where there is a double press: when that can no longer come.
        tap: Effect,
        /// A press that begins less than this time after the end of a short one, as long as it lasts.
        double: Option<TimedEffect>,
        /// A press from this duration on, until it ends; without it none is long.
        hold: Option<TimedEffect>,
        /// What makes it long sooner.
        hold_on: HoldOn,
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
        /// Fate of the light one on the way to a hard one.
        skip: Skip,
    },
}

/// What makes a press a long one before its time. A direction is a press here, too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HoldOn {
    /// Nothing.
    Time,
    /// Another press that begins meanwhile.
    OtherPress,
    /// Another press that begins and ends meanwhile. Until it is clear, other presses wait.
    NestedPress,
}

/// Fate of a light press on the way to a hard one.
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

    /// Its place among the settings of a profile.
    pub(crate) const fn place(self) -> &'static str {
        match self {
            Self::Out => "button.out",
            Self::Tap => "button.tap",
            Self::Double => "button.double",
            Self::Hold => "button.hold",
            Self::Light => "button.light",
            Self::Hard => "button.hard",
        }
    }

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
