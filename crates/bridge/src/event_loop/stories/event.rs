//! What may happen in a story, and how a seed draws it.

use tactpad_core::quantity::Contact;
use tactpad_numeric::random::SplitMix64;

/// Something that happens to a bridge, its pad, its player or its machine. What it begins lasts until something else ends it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Event {
    /// The pad is plugged in. One with power of its own has gone on meanwhile.
    PlugIn { is_anew: bool },
    /// It is pulled out.
    PullOut,
    /// Its port can be opened, or not for this reason.
    Port(PortState),
    /// The pad begins anew, with this clock (µs) and these offsets (counts), after one of the texts of [`BOOT_TEXTS`].
    Restart { time_us: u64, is_flagged: bool, offset: i32, text: usize },
    /// It says who it is: one of [`PADS`].
    Identify(usize),
    /// It sends so many samples a second.
    Rate(u32),
    /// It stops sampling, or goes on.
    Stall(bool),
    /// A hub keeps what it sends, or hands on all of it.
    Keep(bool),
    /// So many frames are lost at once.
    Lose(u32),
    /// So many of the next frames are damaged.
    Damage(u32),
    /// Of thousand frames so many are lost, at random.
    LossPermille(u32),
    /// Of thousand frames so many are damaged, at random.
    DamagePermille(u32),
    /// Bytes that are no frame, drawn by this seed.
    Rubbish(u64),
    /// So many frames come again, from so many frames ago.
    Repeat { age: u32, frames: u32 },
    /// The pad's clock jumps to here, µs.
    ClockJump(u64),
    /// The pad's clock has so many bits.
    ClockBits(u32),
    /// Its sequence number has so many.
    SequenceBits(u32),
    /// In a millisecond the pad's clock goes on by so many microseconds.
    Pace(u32),
    /// A channel is off, and no other one.
    Off(usize, Off),
    /// One more channel is off.
    OffToo(usize, Off),
    /// All channels are as they should be.
    Cure,
    /// A finger touches, or moves to here.
    Touch(Contact),
    /// The finger is lifted.
    Lift,
    /// Somebody asks the bridge for something.
    Ask(Wish),
    /// Nobody takes the events of the bridge, or they are taken again.
    ReaderStall(bool),
    /// The page of the bridge reads what it is told, or does not.
    PageStall(bool),
    /// A screen begins to look at the bridge, or leaves.
    Screen(bool),
    /// The loop does not come to run for so many milliseconds.
    Freeze(u32),
    /// The machine sleeps for so many seconds: its clock stands still. The pad goes on, or loses its power.
    Sleep { s: u32, is_powered: bool },
    /// Whatever is wrong is put right, and the player wants to play.
    Mend,
}

/// Whether a port can be opened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum PortState {
    Free,
    Denied,
    Unusable,
}

/// In which way a channel is off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Off {
    /// It reads the end of its range.
    Saturated,
    /// It reads the same all the time.
    Stuck,
    /// It stands at so many millivolts, with noise of so many microvolts.
    Rail { mv: i32, noise_uv: i32 },
    /// It drifts by so many microvolts a second, and keeps what it has drifted.
    Drift { uv_per_s: i32 },
}

/// What somebody asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Wish {
    Pause,
    Resume,
    TogglePause,
    Tare,
    Panic,
    /// One of [`PROFILES`], read after so many milliseconds.
    Profile {
        number: usize,
        read_ms: u32,
    },
    NextProfile {
        read_ms: u32,
    },
    Reload {
        read_ms: u32,
    },
    /// One that cannot be read.
    Unreadable {
        read_ms: u32,
    },
    /// The file of the profile in play is edited, so that this one stands there.
    Edit(usize),
    /// It is edited so that it cannot be read.
    Break,
    /// One is played for a try.
    Preview(usize),
    Weigh {
        g: u32,
    },
    Status,
}

/// Names of profiles that a story plays: with each a finger to the right presses something at once.
pub(super) const PROFILES: [&str; 6] = ["contra", "tetris", "super-mario", "btanks", "supertux", "vitetris"];

/// One that cannot be read.
pub(super) const UNREADABLE: &str = "unreadable";

/// Serial numbers of pads.
pub(super) const PADS: [&str; 3] = ["PAD-1", "PAD-2", ""];

/// What boot loaders say.
pub(super) const BOOT_TEXTS: [&str; 4] = [
    "",
    "ESP-ROM:esp32s3-20210327\r\nrst:0x1 (POWERON),boot:0x8\r\n",
    "\r\n\r\nU-Boot> ",
    "garbage without an end \u{7f}\u{1} 0 0 0 0",
];

pub(in crate::event_loop) const AWAY: Contact =
    Contact { x_mm: 0.0, y_mm: 0.0, fx_n: 0.0, fy_n: 0.0, fz_n: 0.0 };

/// Presses with each profile.
pub(in crate::event_loop) const RIGHT: Contact = Contact { x_mm: 20.0, fz_n: 2.0, ..AWAY };

/// An event, so long after the one before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Step {
    pub(super) after_ms: u32,
    pub(super) event: Event,
}

/// A story has so many events, and up to half as many more.
pub(super) const EVENTS_MIN: usize = 50;

/// The story of this seed.
pub(super) fn story(seed: u64) -> Vec<Step> {
    let mut draw = Draw(SplitMix64::named(seed, "story"));
    let count = EVENTS_MIN + draw.below(EVENTS_MIN as u64 / 2) as usize;
    let mut steps = vec![
        Step { after_ms: 0, event: Event::Rate(draw.rate_hz()) },
        Step { after_ms: draw.wait_ms(), event: Event::PlugIn { is_anew: true } },
    ];
    while steps.len() < count {
        let event = draw.event();
        steps.push(Step { after_ms: draw.wait_ms(), event });
        let mut sequel = draw.sequel(event);
        while let Some(last) = sequel.last().copied() {
            steps.extend(sequel);
            sequel = draw.sequel(last.event);
        }
    }
    steps.push(Step { after_ms: draw.wait_ms(), event: Event::Mend });
    steps
}

/// Draws what happens.
pub(super) struct Draw(pub(super) SplitMix64);

impl Draw {
    /// Below `end`.
    pub(super) fn below(&mut self, end: u64) -> u64 {
        self.0.next_bits() % end.max(1)
    }

    fn between(&mut self, first: i64, last: i64) -> i64 {
        first + self.below((last - first + 1) as u64) as i64
    }

    fn either(&mut self) -> bool {
        self.below(2) == 1
    }

    fn of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len() as u64) as usize]
    }

    /// Most events come in the midst of what others have begun.
    fn wait_ms(&mut self) -> u32 {
        let end =
            if self.below(40) == 0 { 30_000 } else { self.of(&[1, 20, 100, 100, 400, 400, 1_000, 3_000]) };
        self.below(end) as u32
    }

    /// Slow pads are sampled in less time: more stories.
    fn rate_hz(&mut self) -> u32 {
        self.of(&[100, 100, 100, 100, 100, 100, 100, 125, 125, 200, 250, 250, 500, 500, 1_000, 4_000])
    }

    fn time_us(&mut self) -> u64 {
        match self.below(5) {
            0 => 0,
            1 => u64::MAX - self.below(3_000_000),
            2 => u64::from(u32::MAX) - self.below(3_000_000),
            3 => self.below(60_000_000),
            _ => self.0.next_bits(),
        }
    }

    #[expect(clippy::disallowed_methods, reason = "what differs between platforms is rounded away")]
    fn contact(&mut self) -> Contact {
        let radius_mm = 28.0 * self.0.fraction().sqrt();
        let (sin, cos) = (std::f32::consts::PI * self.0.uniform()).sin_cos();
        let tenths = |value: f32| (10.0 * value).round() / 10.0;
        let fz_n = tenths(6.0 * self.0.fraction());
        // Where nothing presses, nothing shears.
        let shear_n = if self.either() { fz_n.min(1.5) } else { 0.0 };
        Contact {
            x_mm: tenths(radius_mm * cos),
            y_mm: tenths(radius_mm * sin),
            fx_n: tenths(shear_n * self.0.uniform()),
            fy_n: tenths(shear_n * self.0.uniform()),
            fz_n,
        }
    }

    fn off(&mut self) -> Off {
        match self.below(4) {
            0 => Off::Saturated,
            1 => Off::Stuck,
            2 => Off::Rail { mv: self.between(-20, 20) as i32, noise_uv: self.between(1, 2_000) as i32 },
            _ => Off::Drift { uv_per_s: self.between(-400, 400) as i32 },
        }
    }

    fn wish(&mut self) -> Wish {
        let read_ms = self.of(&[0, 0, 5, 300]);
        let number = self.below(PROFILES.len() as u64) as usize;
        match self.below(15) {
            0 => Wish::Pause,
            1 => Wish::Resume,
            2 => Wish::TogglePause,
            3 | 4 => Wish::Tare,
            5 => Wish::Panic,
            6 => Wish::Profile { number, read_ms },
            7 => Wish::NextProfile { read_ms },
            8 => Wish::Reload { read_ms },
            9 => Wish::Edit(number),
            10 => Wish::Break,
            11 => Wish::Preview(number),
            12 => Wish::Unreadable { read_ms },
            13 => Wish::Weigh { g: self.of(&[50, 200, 500]) },
            _ => Wish::Status,
        }
    }

    /// What often comes of an event, and would seldom follow it by chance.
    fn sequel(&mut self, event: Event) -> Vec<Step> {
        let (is_there, is_old) = (self.below(3) == 0, self.either());
        let restart = self.restart();
        let restless: [Event; 3] = std::array::from_fn(|_| self.restless());
        let mut later =
            |from_ms: i64, to_ms: i64, event| Step { after_ms: self.between(from_ms, to_ms) as u32, event };
        match event {
            _ if !is_there => Vec::new(),
            // After a pad began anew its first frames come again; and it begins anew at once.
            Event::Restart { .. } if is_old => vec![later(0, 300, Event::Repeat { age: 500, frames: 3 })],
            Event::Restart { .. } | Event::Repeat { .. } => vec![later(0, 600, restart)],
            // A channel without a wire is so while the zero is measured, and answers later.
            Event::Off(_, Off::Saturated | Off::Stuck) => {
                vec![later(1_000, 3_000, restart), later(300, 3_000, Event::Cure)]
            }
            // One whose wire is loose is so then, too.
            Event::Off(_, Off::Drift { .. } | Off::Rail { .. }) => vec![later(0, 500, restart)],
            // Who does not wait asks for the next thing before the last is done.
            Event::Ask(Wish::Weigh { .. } | Wish::Tare) => {
                restless.into_iter().map(|event| later(400, 950, event)).collect()
            }
            Event::Keep(true) => vec![later(0, 3_000, Event::Keep(false))],
            Event::Stall(true) => vec![later(0, 3_000, Event::Stall(false))],
            _ => Vec::new(),
        }
    }

    /// What keeps a pad from playing for a moment.
    fn restless(&mut self) -> Event {
        match self.below(4) {
            0 => Event::Identify(self.below(PADS.len() as u64) as usize),
            1 => Event::Ask(Wish::TogglePause),
            2 => Event::Ask(Wish::Tare),
            _ => Event::Ask(Wish::Weigh { g: self.of(&[50, 200, 500]) }),
        }
    }

    fn restart(&mut self) -> Event {
        Event::Restart {
            time_us: self.time_us(),
            is_flagged: self.either(),
            offset: self.between(-400_000, 400_000) as i32,
            text: self.below(BOOT_TEXTS.len() as u64) as usize,
        }
    }

    /// What the pad and its line do.
    fn pad(&mut self) -> Event {
        match self.below(21) {
            0 | 1 => Event::PlugIn { is_anew: self.either() },
            2 => Event::PullOut,
            3 => Event::Port(self.of(&[
                PortState::Free,
                PortState::Free,
                PortState::Denied,
                PortState::Unusable,
            ])),
            4 | 5 => self.restart(),
            6 => Event::Identify(self.below(PADS.len() as u64) as usize),
            7 => Event::Rate(self.rate_hz()),
            8 | 9 => Event::Stall(self.either()),
            10 => Event::Keep(self.either()),
            11 => Event::Lose(self.of(&[1, 2, 10, 70, 1_000])),
            12 => Event::Damage(self.of(&[1, 2, 10, 70])),
            13 => Event::LossPermille(self.of(&[0, 0, 5, 25, 300])),
            14 => Event::DamagePermille(self.of(&[0, 0, 5, 25, 300])),
            15 => Event::Rubbish(self.0.next_bits() % 1_000),
            16 => Event::Repeat {
                age: self.of(&[1, 2, 3, 64, 65, 66, 500, 2_000, u32::MAX / 2]),
                frames: self.below(4) as u32 + 1,
            },
            17 => Event::ClockJump(self.time_us()),
            18 => Event::ClockBits(self.of(&[64, 64, 32])),
            19 => Event::SequenceBits(self.of(&[32, 8, 12, 16])),
            _ => Event::Pace(self.of(&[1_000, 1_000, 990, 1_010, 1, 3_000, 20_000])),
        }
    }

    fn event(&mut self) -> Event {
        match self.below(100) {
            0..38 => self.pad(),
            38..42 => Event::Off(self.below(9) as usize, self.off()),
            42 => Event::OffToo(self.below(9) as usize, self.off()),
            43..46 => Event::Cure,
            46..54 => Event::Touch(RIGHT),
            54..62 => Event::Touch(self.contact()),
            62..74 => Event::Lift,
            74..86 => Event::Ask(self.wish()),
            86..88 => Event::ReaderStall(self.either()),
            88 => Event::PageStall(self.either()),
            89 => Event::Screen(self.either()),
            90..92 => Event::Freeze(self.of(&[5, 50, 90, 300, 3_000])),
            92 => Event::Sleep { s: self.of(&[1, 60, 3_600]), is_powered: self.either() },
            _ => Event::Mend,
        }
    }
}
