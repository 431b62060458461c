//! A profile after checking: numbers and codes only, no text to interpret.

use arrayvec::ArrayVec;

use super::angle::wrapped;
use crate::pipeline::control::{Code, OutputDevice};
use crate::quantity::Contact;

/// The most buttons a profile can bind.
pub const BUTTONS_MAX: usize = 16;

/// The most zones that a profile can have.
pub const ZONES_MAX: usize = 16;

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
    /// The same along the arc at the contact's distance from the centre; the larger of the two counts, and half of the
    /// neighbouring zone at most. 0 in the sticky 4-way mode.
    pub hysteresis_mm: f32,
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

/// By how much farther than it is a contact counts to each side, for a hand that does not reach as far everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gain {
    /// To the right.
    pub right: f32,
    /// To the left.
    pub left: f32,
    /// Upwards.
    pub up: f32,
    /// Downwards.
    pub down: f32,
}

impl Gain {
    /// As it is.
    pub const ONE: Self = Self { right: 1.0, left: 1.0, up: 1.0, down: 1.0 };

    /// The place that counts as this one.
    pub fn undone(&self, [x_mm, y_mm]: [f32; 2]) -> (f32, f32) {
        let x_gain = if x_mm < 0.0 { self.left } else { self.right };
        let y_gain = if y_mm < 0.0 { self.down } else { self.up };
        (x_mm / x_gain, y_mm / y_gain)
    }

    /// The contact with its place stretched.
    pub fn applied(&self, contact: &Contact) -> Contact {
        let x_gain = if contact.x_mm < 0.0 { self.left } else { self.right };
        let y_gain = if contact.y_mm < 0.0 { self.down } else { self.up };
        Contact { x_mm: x_gain * contact.x_mm, y_mm: y_gain * contact.y_mm, ..*contact }
    }
}

/// A part of the plate: a sector, a ring, or a part of a ring.
#[derive(Clone, Debug, PartialEq)]
pub struct Zone {
    /// The name by which buttons ask for it.
    pub name: String,
    /// Its middle, counter-clockwise from right.
    pub middle_deg: f32,
    /// How far it reaches to both sides of that; 180 for a ring.
    pub half_width_deg: f32,
    /// It begins at this distance from the centre
    pub inner_radius_mm: f32,
    /// and ends before this one.
    pub outer_radius_mm: f32,
    /// While it is held it reaches so much farther to both sides,
    pub hysteresis_deg: f32,
    /// or so far along the arc, whichever is more; but no farther than half of the narrowest other zone.
    pub hysteresis_mm: f32,
    /// See [`Self::hysteresis_mm`].
    pub hysteresis_max_deg: f32,
    /// While it is held it reaches so far inwards and outwards.
    pub radius_hysteresis_mm: f32,
}

/// Where a button counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// In the zone of this number.
    Zone(usize),
    /// While the D-pad holds this direction.
    Direction(Direction),
}

/// A direction of the D-pad.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Up.
    Up,
    /// Down.
    Down,
    /// Left.
    Left,
    /// Right.
    Right,
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
