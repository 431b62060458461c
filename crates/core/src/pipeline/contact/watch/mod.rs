//! Whether what the channels read is one finger on the pad that the decoder knows.
//!
//! Nine channels tell five numbers, so four equations are left over. Their misfit warns of a second finger, a channel that
//! does not answer or reads what no finger makes it read, and a pad that is not the calibrated one. A warning warns. But what a
//! channel shows that cannot be believed is no contact, see [`Doubt`].
//!
//! What the channels leave over is averaged over 100 ms, whole periods of the mains. What is left of the noise of single
//! readings is measured while nothing touches the pad. The relative noise lasts for seconds, so a press has one draw of it,
//! and however long it is held the misfit of one finger stays one draw of chi-square with four degrees of freedom.

mod finding;
mod warning;

use super::inverse::{ContactFit, Inverse};
use crate::pipeline::health::Health;
use crate::pipeline::interruption::Effect;
use crate::pipeline::signal::lone::lone_channel;
use crate::quantity::{CHANNELS, Strain};
use crate::time::StreamInstant;
pub use finding::load_without_stray_n;
use finding::{ANSWERS, Finding, Mean, is_far_from_a_finger, judge, reads, weights};
pub use warning::Warning;

/// Block over which is averaged: five periods of 50 Hz mains, six of 60 Hz.
const BLOCK_US: u64 = 100_000;

/// As a finger comes, filter and skew make channels of different moments one reading; it takes about so long.
const SETTLING_US: u64 = 30_000;

/// The decoder's own noise counts as so many blocks before the first.
const SCATTER_KNOWN: f64 = 4.0;

/// The scatter at rest is that of about the last so many blocks.
const SCATTER_BLOCKS: f64 = 100.0;

/// The last so many touches are remembered; if most of them are not one finger, the pad is not the calibrated one.
const TOUCHES: u32 = 8;
const OTHER_TOUCHES: u32 = 6;

/// What is far from one finger all the time for so long is none: nobody plays so, and a fault does. It is the time after which a
/// faint touch is drift.
const FAR_US: u64 = 10_000_000;

/// Why a touch is no contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// A channel cannot be believed, and a finger may be there.
    Channel,
    /// It lasts too long for fingers: the zero is wrong.
    Zero,
}

/// Looks at samples, one by one.
#[derive(Clone, Debug)]
pub struct Watch {
    /// Variances of blocks of the untouched pad, µV², and their number.
    scatter_uv2: [f64; CHANNELS],
    scatter_blocks: f64,
    /// The last two blocks of the untouched pad; they count once the next is untouched, too.
    before: [Option<[f64; CHANNELS]>; 2],
    block: Block,
    touched: bool,
    /// Whether this touch was judged.
    judged: bool,
    /// The touches that were judged, newest in the lowest bit: which were not one finger.
    touches: u32,
    /// A channel that did not answer, until it does.
    silent: Option<usize>,
    /// A channel that read what no finger makes it read, until a touch is one finger.
    stray: Option<usize>,
    /// Whether this touch is no contact, as that channel is in it.
    is_doubted: bool,
    /// Since when this touch is far from one finger.
    far_since: Option<StreamInstant>,
}

/// The samples of one stretch of time.
#[derive(Clone, Copy, Debug, Default)]
struct Block {
    begins: StreamInstant,
    samples: u32,
    sum: Mean,
}

impl Block {
    fn from(begins: StreamInstant) -> Self {
        Self { begins, ..Self::default() }
    }

    fn add(&mut self, strain: &Strain, explained: &ContactFit) {
        let Mean { uv, left_uv, force_n } = Mean::of(strain, explained);
        self.samples += 1;
        self.sum.uv.iter_mut().zip(uv).for_each(|(sum, uv)| *sum += uv);
        self.sum.left_uv.iter_mut().zip(left_uv).for_each(|(sum, uv)| *sum += uv);
        self.sum.force_n += force_n;
    }

    fn mean(&self) -> Mean {
        let count = f64::from(self.samples.max(1));
        let Mean { uv, left_uv, force_n } = self.sum;
        Mean {
            uv: uv.map(|sum| sum / count),
            left_uv: left_uv.map(|sum| sum / count),
            force_n: force_n / count,
        }
    }
}

impl Watch {
    /// Before the first sample. The decoder's noise is what is known of the channels.
    pub fn new(inverse: Option<&Inverse>) -> Self {
        let additive_uv = inverse.map_or([0.0; CHANNELS], |inverse| inverse.noise().additive_uv);
        Self {
            scatter_uv2: additive_uv.map(|uv| uv * uv),
            scatter_blocks: SCATTER_KNOWN,
            before: [None; 2],
            block: Block::default(),
            touched: false,
            judged: false,
            touches: 0,
            silent: None,
            stray: None,
            is_doubted: false,
            far_since: None,
        }
    }

    /// Warning to the player now. A second finger is that of the touch at hand, or of the last one that lasted long
    /// enough to be judged.
    pub const fn warning(&self) -> Option<Warning> {
        let other_fingers = (self.touches & ((1 << TOUCHES) - 1)).count_ones();
        match (self.stray, self.silent) {
            (Some(channel), _) => Some(Warning::StrayChannel { channel }),
            (None, Some(channel)) => Some(Warning::SilentChannel { channel }),
            (None, None) if other_fingers >= OTHER_TOUCHES => Some(Warning::OtherPad),
            (None, None) if self.touches & 1 == 1 => Some(Warning::SecondFinger),
            (None, None) => None,
        }
    }

    /// Whether the touch at hand is no contact.
    pub const fn is_doubted(&self) -> bool {
        self.is_doubted
    }

    /// In doubt, the block that was begun is not gone on with.
    pub fn interrupt(&mut self, effect: Effect, inverse: Option<&Inverse>) {
        match effect {
            Effect::Keep => {}
            Effect::Doubt => (self.block.samples, self.before) = (0, [None; 2]),
            Effect::Forget => *self = Self::new(inverse),
        }
    }

    /// Takes the sample at `at`: compensated channels, and what the decoder made of them. Whether what they show is no contact.
    pub fn see(
        &mut self,
        at: StreamInstant,
        strain: &Strain,
        explained: &ContactFit,
        touched: bool,
        inverse: &Inverse,
        health: &mut Health,
    ) -> Option<Doubt> {
        if touched != self.touched {
            self.turn(at, touched);
        }
        if self.block.samples == 0 {
            self.block = Block::from(self.block.begins.max(at));
        }
        if at >= self.block.begins {
            self.block.add(strain, explained);
        }
        if self.block.samples > 0 && at.us_since(self.block.begins) >= BLOCK_US {
            let mean = self.block.mean();
            self.block = Block::from(at);
            if touched {
                return self.judge(at, inverse, &mean, health);
            }
            self.learn(inverse, &mean.uv, health);
        }
        self.is_doubted.then_some(Doubt::Channel)
    }

    /// A finger comes or leaves.
    fn turn(&mut self, at: StreamInstant, touched: bool) {
        self.touched = touched;
        self.before = [None; 2];
        self.block = Block::from(at.plus_us(SETTLING_US));
        (self.judged, self.is_doubted, self.far_since) = (false, false, None);
    }

    /// The pad was untouched for another block. A finger that comes moves the channels before it is known as one, so the
    /// newest block does not count yet.
    fn learn(&mut self, inverse: &Inverse, uv: &[f64; CHANNELS], health: &mut Health) {
        if let [Some(first), Some(second)] = &self.before {
            self.scatter_blocks = (self.scatter_blocks + 1.0).min(SCATTER_BLOCKS);
            for (k, variance) in self.scatter_uv2.iter_mut().enumerate() {
                // v ← v + ((m₂ − m₁)² / 2 − v) / n: two blocks differ by twice the variance of one.
                let off = second[k] - first[k];
                *variance += (off * off / 2.0 - *variance) / self.scatter_blocks;
            }
            // The zero follows slowly, so a channel that drifts is ahead of it.
            let at_rest = weights(inverse, &Mean::default(), &self.scatter_uv2);
            if let Some(channel) =
                lone_channel(second).filter(|channel| reads(*channel, second, &at_rest) > ANSWERS)
            {
                self.name_stray(channel, health);
            }
        }
        self.before = [self.before[1], Some(*uv)];
    }

    /// A channel reads what no finger makes it read.
    pub fn name_stray(&mut self, channel: usize, health: &mut Health) {
        health.channels_stray += u64::from(self.stray != Some(channel));
        self.stray = Some(channel);
    }

    fn judge(
        &mut self,
        at: StreamInstant,
        inverse: &Inverse,
        mean: &Mean,
        health: &mut Health,
    ) -> Option<Doubt> {
        if !self.judged {
            (self.judged, self.touches) = (true, self.touches << 1);
        }
        let weights = weights(inverse, mean, &self.scatter_uv2);
        self.silent = self.silent.filter(|&channel| reads(channel, &mean.uv, &weights) < ANSWERS);
        let finding = judge(inverse, mean, &weights);
        self.is_doubted = match finding {
            Finding::Stray(_) => true,
            Finding::Unexplained => self.is_doubted,
            Finding::Fine | Finding::Silent(_) => false,
        };
        match finding {
            Finding::Fine => self.stray = None,
            Finding::Silent(channel) => {
                health.channels_silent += u64::from(self.silent != Some(channel));
                (self.silent, self.stray) = (Some(channel), None);
            }
            Finding::Stray(channel) => self.name_stray(channel, health),
            Finding::Unexplained => {
                // While a channel is known to be silent, or off in this touch, nothing is known of a second finger.
                if self.silent.is_none() && !self.is_doubted {
                    health.second_fingers += u64::from(self.touches & 1 == 0);
                    self.touches |= 1;
                }
            }
        }
        let is_far = match finding {
            Finding::Fine | Finding::Silent(_) => false,
            Finding::Stray(_) => true,
            Finding::Unexplained => is_far_from_a_finger(mean),
        };
        self.far_since = is_far.then(|| self.far_since.unwrap_or(at));
        if self.far_since.is_some_and(|since| at.us_since(since) >= FAR_US) {
            self.far_since = None;
            return Some(Doubt::Zero);
        }
        self.is_doubted.then_some(Doubt::Channel)
    }
}

/// Whether contacts that are read once, as the mean over many readings, are not one finger on the decoder's pad; `None`
/// for channels beyond anything that a pad can read.
pub fn warns(inverse: &Inverse, strain: &Strain) -> Option<bool> {
    let mut block = Block::from(StreamInstant::from_us(0));
    block.add(strain, &inverse.explain(strain)?);
    let mean = block.mean();
    let weights = weights(inverse, &mean, &[0.0; CHANNELS]);
    Some(judge(inverse, &mean, &weights) != Finding::Fine)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pad::field::PadField;
    use crate::pipeline::contact::uncertainty::Noise;
    use crate::quantity::Contact;

    const NOISE: Noise = Noise::of_channels([5.0; CHANNELS], [0.02; CHANNELS]);

    struct Seen {
        inverse: Inverse,
        watch: Watch,
        health: Health,
        at_us: u64,
        /// Reads nothing.
        dead: Option<usize>,
    }

    impl Seen {
        fn new() -> Self {
            let inverse = Inverse::new(PadField::nominal().signals, NOISE);
            let watch = Watch::new(Some(&inverse));
            Self { inverse, watch, health: Health::default(), at_us: 0, dead: None }
        }

        /// Fingers for a time in ms, and then none.
        fn touch(&mut self, fingers: &[[f32; 3]], ms: u64) -> Option<Warning> {
            let mut strain = Strain::default();
            for [x_mm, y_mm, fz_n] in fingers {
                let contact = Contact { x_mm: *x_mm, y_mm: *y_mm, fz_n: *fz_n, ..Contact::default() };
                let uv = self.inverse.field().strain_uv(&contact).uv;
                strain.uv.iter_mut().zip(uv).for_each(|(sum, uv)| *sum += uv);
            }
            self.dead.iter().for_each(|channel| strain.uv[*channel] = 0.0);
            self.run(&strain, true, ms);
            self.run(&Strain::default(), false, 300);
            self.watch.warning()
        }

        fn run(&mut self, strain: &Strain, touched: bool, ms: u64) {
            for _ in 0..ms {
                self.at_us += 1_000;
                let at = StreamInstant::from_us(self.at_us);
                let explained = self.inverse.explain(strain).unwrap();
                self.watch.see(at, strain, &explained, touched, &self.inverse, &mut self.health);
            }
        }
    }

    const TWO: [[f32; 3]; 2] = [[14.0, 0.0, 1.0], [-13.0, 4.0, 1.0]];
    const ONE: [[f32; 3]; 1] = [[12.0, -6.0, 2.0]];

    #[test]
    fn a_second_finger_is_told_once_and_forgotten_with_the_next_touch() {
        let mut seen = Seen::new();
        assert_eq!(seen.touch(&ONE, 300), None);
        assert_eq!(seen.touch(&TWO, 900), Some(Warning::SecondFinger));
        assert_eq!(seen.health.second_fingers, 1);
        assert_eq!(seen.touch(&ONE, 60), Some(Warning::SecondFinger), "too short to be judged");
        assert_eq!(seen.touch(&ONE, 300), None);
        assert_eq!(seen.health.channels_silent, 0);
    }

    #[test]
    fn a_dead_channel_is_named_until_it_answers() {
        let mut seen = Seen::new();
        seen.dead = Some(2);
        assert_eq!(seen.touch(&ONE, 300), Some(Warning::SilentChannel { channel: 2 }));
        assert_eq!(seen.touch(&ONE, 300), Some(Warning::SilentChannel { channel: 2 }));
        assert_eq!((seen.health.channels_silent, seen.health.second_fingers), (1, 0));
        seen.dead = None;
        assert_eq!(seen.touch(&ONE, 300), None);
    }

    #[test]
    fn two_fingers_that_pass_for_a_dead_channel_do_not_hide_the_next_ones() {
        let mut seen = Seen::new();
        seen.watch.silent = Some(2);
        assert_eq!(seen.touch(&TWO, 300), Some(Warning::SecondFinger));
    }

    #[test]
    fn a_pad_on_which_nothing_fits_is_another_pad() {
        let mut seen = Seen::new();
        let warnings: Vec<_> = (0..6).map(|_| seen.touch(&TWO, 200)).collect();
        assert_eq!(warnings[4..], [Some(Warning::SecondFinger), Some(Warning::OtherPad)]);
        assert_eq!(seen.health.second_fingers, 6);
    }

    #[test]
    fn a_noisier_pad_than_the_calibrated_one_is_known_at_rest() {
        let mut seen = Seen::new();
        for block in 0..200 {
            let uv = if block % 2 == 0 { 400.0 } else { -400.0 };
            seen.run(&Strain { uv: [uv; CHANNELS] }, false, 101);
        }
        assert_eq!(seen.touch(&TWO, 300), None, "a misfit of less than the noise says nothing");
    }

    #[test]
    fn an_interruption_begins_anew() {
        let mut seen = Seen::new();
        for _ in 0..20 {
            seen.run(&Strain { uv: [700.0, 0.0, 0.0, -300.0, 0.0, 900.0, 0.0, 500.0, 0.0] }, true, 90);
            seen.watch.interrupt(Effect::Doubt, None);
        }
        assert_eq!(seen.watch.warning(), None);
    }

    #[test]
    fn a_warning_is_a_sentence_and_names_its_channel() {
        let silent = Warning::SilentChannel { channel: 5 };
        assert_eq!(serde_json::to_string(&silent).unwrap(), r#"{"kind":"silent_channel","channel":"m1z"}"#);
        assert!(silent.to_string().contains("m1z"));
    }
}
