//! The world of a story: a pad, its line, who plays and who looks on, and the machine, around the real loop in virtual time.

mod pad;
mod player;

use std::collections::VecDeque;

use firmware_proto::ENCODED_MAX;
use firmware_proto::frame::Message;
use firmware_proto::identity::{Identity, SerialNumber};
use firmware_proto::link::encode_message;
use firmware_proto::sample::{Sample, Status};
use tactpad_numeric::random::SplitMix64;

use super::super::virtual_time::{ASLEEP, Play, profile};
use super::super::*;
use super::cause::Cause;
use super::event::{
    AWAY, BOOT_TEXTS, Draw, Event, Off, PADS, PROFILES, PortState, RIGHT, Step, UNREADABLE, Wish,
};
use super::judge::{Broken, Judge, TAKEN_BACK_US, broken};
use super::page::Page;
use crate::transport::opener::PadError;
use tactpad_core::pad::weight::Weight;
use tactpad_core::pipeline::line_check::LineFinding;
use tactpad_core::quantity::Contact;

/// About each event so much is played at full rate, µs; what is longer and quiet is skipped.
const DENSE_US: u64 = 2_000_000;

/// So long a channel reads the same until the bridge knows that it reads nothing, and a zero is measured, µs.
const DEAD_US: u64 = 1_500_000;

/// A hub keeps so many bytes.
const KEPT_MAX: usize = 64 << 10;

/// The bridge knows so many of the newest samples again.
const KNOWN: usize = 64;

/// So many of the first samples of a pad that began anew may seem to go on from those before; one of them the text of its boot loader spoils.
const RESTART_FRAMES: u32 = 3;

/// The loop wakes so often in one moment at most.
const WAKES_MAX: u32 = 1_000;

/// What a story came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Played {
    /// All that went out, as one number, and the same with its times.
    pub(super) edges: u64,
    trace: u64,
    pub(super) skipped_us: u64,
}

/// A pad, a bridge and all around them.
pub(super) struct World {
    play: Play,
    judge: Judge,
    page: Option<Page>,
    screen: Option<Arc<Mutex<Snapshot>>>,
    chance: Draw,
    contact: Contact,
    rate_hz: u32,
    next_sample: HostInstant,
    clock_bits: u32,
    sequence_bits: u32,
    is_plugged: bool,
    is_stalled: bool,
    kept: Option<Vec<u8>>,
    /// Since when the hub keeps it, when the first of it came, and since when the pad has stalled.
    kept_from: HostInstant,
    kept_first: HostInstant,
    stalled_from: HostInstant,
    /// The newest samples that the bridge has read, or that wait for it.
    read: VecDeque<Sample>,
    /// The pad began anew, and so many more samples in a row may seem to go on from the one that was read before, at this time.
    unconfirmed_restart_frames: u32,
    before: Option<(Sample, HostInstant)>,
    damage: u32,
    /// The next frame goes on where other bytes ended, unless the link is lost before it comes.
    is_joined: bool,
    was_heard: bool,
    loss_permille: u32,
    damage_permille: u32,
    off: [Option<(Off, i32)>; 9],
    /// What drifts has drifted by so much, counts.
    drifted: [f64; 9],
    /// Since when channels read nothing, and which did so while the zero was measured.
    dead_since: [Option<HostInstant>; 9],
    is_dead_at_zero: [bool; 9],
    /// Channels that were off since the pad was sound and untouched for long enough.
    was_off: [bool; 9],
    /// A channel reads otherwise than when the zero was measured, and a finger has been there since.
    is_zero_old: bool,
    /// The zero was measured, or may have been, under the finger that is there.
    is_zero_under: bool,
    /// The finger held something down when the pad was not heard any more, and stays.
    is_staying: bool,
    port: PortState,
    frozen_until: Option<HostInstant>,
    /// The pad was pulled out meanwhile: the bridge still holds the port that has gone.
    is_port_new: bool,
    /// It has not come to run for so long.
    frozen_us: u64,
    /// The loop has something to answer.
    is_asked: bool,
    /// Profiles that are read by then.
    read_at: Vec<HostInstant>,
    is_paused: bool,
    /// A profile was asked for, so that what is read of the one before is out of date.
    is_profile_asked: bool,
    /// Profiles that could not be read, and what is to be told of those that the bridge knows of by now.
    broken_profiles: u32,
    untold: Vec<String>,
    /// Whether quiet stretches are skipped, and how much was, µs.
    skips: bool,
    skipped_us: u64,
}

impl World {
    /// A bridge without a pad. The seed draws which frames are lost.
    pub(super) fn new(seed: u64, is_watched: bool, skips: bool) -> Self {
        let (page, observers) = if is_watched { Page::attached() } else { (None, Vec::new()) };
        let play = Play::watched(observers);
        *play.messages.1.lock().unwrap() = Some(Vec::new());
        Self {
            play,
            judge: Judge::default(),
            page,
            screen: None,
            chance: Draw(SplitMix64::named(seed, "chance")),
            contact: AWAY,
            rate_hz: 1_000,
            next_sample: HostInstant::default(),
            clock_bits: 64,
            sequence_bits: 32,
            is_plugged: false,
            is_stalled: false,
            kept: None,
            kept_from: HostInstant::default(),
            kept_first: HostInstant::default(),
            stalled_from: HostInstant::default(),
            read: VecDeque::with_capacity(KNOWN),
            unconfirmed_restart_frames: 0,
            before: None,
            damage: 0,
            is_joined: false,
            was_heard: false,
            loss_permille: 0,
            damage_permille: 0,
            off: [None; 9],
            drifted: [0.0; 9],
            dead_since: [None; 9],
            is_dead_at_zero: [false; 9],
            was_off: [false; 9],
            is_zero_old: false,
            is_zero_under: false,
            is_staying: false,
            port: PortState::Free,
            frozen_until: None,
            is_port_new: false,
            frozen_us: 0,
            is_asked: false,
            read_at: Vec::new(),
            is_paused: false,
            is_profile_asked: false,
            broken_profiles: 0,
            untold: Vec::new(),
            skips,
            skipped_us: 0,
        }
    }

    /// What it has come to.
    pub(super) const fn played(&self) -> Played {
        Played { edges: self.judge.edges, trace: self.judge.trace, skipped_us: self.skipped_us }
    }

    /// Plays this step.
    pub(super) fn step(&mut self, step: &Step) -> Result<(), Broken> {
        self.pass(1_000 * u64::from(step.after_ms))?;
        self.happen(step.event)?;
        self.look()
    }

    /// Lets time pass.
    fn pass(&mut self, us: u64) -> Result<(), Broken> {
        let mut end = self.play.now.plus_us(us);
        while self.play.now < end {
            let left_us = end.us_since(self.play.now);
            if self.skips && left_us > DENSE_US && self.is_quiet() {
                self.skipped_us += left_us - DENSE_US;
                end = self.play.now.plus_us(DENSE_US);
            }
            self.advance(end)?;
        }
        Ok(())
    }

    /// Whether nothing goes on that time would change: the pad lies there, sound and untouched, and its number does not begin again.
    fn is_quiet(&self) -> bool {
        let pipeline = &self.play.bridge.driver.pipeline;
        self.is_plugged
            && self.sequence_bits == 32
            && self.judge.causes.are_away_for(self.play.now, DENSE_US)
            && self.read_at.is_empty()
            && pipeline.line_finding().is_none()
            && pipeline.warning().is_none()
    }

    /// Goes on to the next thing that happens by itself, at `end` at the latest.
    fn advance(&mut self, end: HostInstant) -> Result<(), Broken> {
        let samples = self.is_plugged && !self.is_stalled;
        let sample_at = samples.then(|| self.next_sample.max(self.play.now));
        // What lasts is noted once a second.
        let end = end.min(self.play.now.plus_us(1_000_000));
        let next = [Some(end), sample_at, self.frozen_until, self.read_at.iter().min().copied()];
        let next = next.into_iter().flatten().min().unwrap_or(end).max(self.play.now);
        self.wait_until(next)?;
        if self.frozen_until.is_some_and(|until| until <= next) {
            self.thaw()?;
        }
        self.hand_in_profiles()?;
        if sample_at == Some(next) {
            self.sample()?;
        }
        self.look()
    }

    fn wait_until(&mut self, end: HostInstant) -> Result<(), Broken> {
        self.note_causes();
        let before = self.play.now;
        if self.frozen_until.is_some() {
            self.play.now = end;
            self.frozen_us += end.us_since(before);
        } else {
            let (judge, mut taken, mut wakes) = (&mut self.judge, Ok(()), (before, 0));
            self.play.wait_until(end, |play| {
                wakes = if wakes.0 == play.now { (play.now, wakes.1 + 1) } else { (play.now, 0) };
                assert!(wakes.1 < WAKES_MAX, "the loop does not come to rest");
                if taken.is_ok() {
                    taken = judge.take(play);
                }
            });
            taken?;
        }
        self.pad_time_passes(end.us_since(before));
        Ok(())
    }

    /// The pad's clock goes on.
    fn pad_time_passes(&mut self, us: u64) {
        let shown_us = us * self.play.us_per_ms / 1_000;
        self.set_clock(self.play.time_us.wrapping_add(shown_us));
    }

    fn set_clock(&mut self, time_us: u64) {
        let shown_us = if self.clock_bits < 64 { time_us & ((1 << self.clock_bits) - 1) } else { time_us };
        if shown_us < self.play.time_us {
            self.doubt_clock();
            self.note_zero_requested();
        }
        self.play.time_us = shown_us;
    }

    /// A clock in doubt is looked at from here on, and what it does is found.
    fn doubt_clock(&mut self) {
        let (now, causes) = (self.play.now, &mut self.judge.causes);
        if [Cause::Clock, Cause::Delayed].into_iter().any(|cause| !causes.has_passed(now, cause)) {
            causes.note(now, Cause::Clock);
        }
    }

    /// The pad takes a sample.
    fn sample(&mut self) -> Result<(), Broken> {
        let period_us = 1_000_000 / u64::from(self.rate_hz);
        self.next_sample = self.play.now.plus_us(period_us);
        for (channel, off) in self.off.iter().enumerate() {
            if let Some((Off::Drift { uv_per_s }, _)) = off {
                let step = f64::from(*uv_per_s) * 100.0 / f64::from(self.rate_hz);
                let before = self.drifted[channel] as i32;
                self.drifted[channel] += step;
                self.play.offset[channel] += self.drifted[channel] as i32 - before;
            }
        }
        let is_wrap = self.count();
        let sample = self.play.sample(&self.contact);
        let mut frame = [0; ENCODED_MAX];
        let length = encode_message(&Message::Sample(sample), &mut frame);
        let is_hit = |draw: &mut Draw, permille: u32| permille > 0 && draw.below(1_000) < u64::from(permille);
        if is_hit(&mut self.chance, self.loss_permille) {
            return Ok(());
        }
        if self.damage > 0 || is_hit(&mut self.chance, self.damage_permille) {
            self.judge.causes.note(self.play.now, Cause::Loss);
            self.damage = self.damage.saturating_sub(1);
            let place = self.chance.below(length as u64 - 1) as usize;
            frame[place] ^= 1 + self.chance.below(255) as u8;
            return self.send(&frame[..length], None);
        }
        let is_wrap = is_wrap && !self.is_joined;
        if self.is_joined {
            self.judge.causes.note(self.play.now, Cause::Loss);
        }
        self.send(&frame[..length], Some(&sample))?;
        if is_wrap { self.is_wrap_found(&sample) } else { Ok(()) }
    }

    /// The pad's sequence number as far as it has bits; whether it begins again.
    fn count(&mut self) -> bool {
        let number = self.play.sequence & (u32::MAX >> (32 - self.sequence_bits));
        let is_wrap = std::mem::replace(&mut self.play.sequence, number) != number;
        if is_wrap {
            self.judge.causes.note(self.play.now, Cause::Wraps);
            self.note_zero_requested();
        }
        is_wrap
    }

    /// After the largest number comes zero, both are read, and it is found before anything comes of it.
    fn is_wrap_found(&mut self, zero: &Sample) -> Result<(), Broken> {
        let [before @ .., largest, read] = self.read.make_contiguous() else { return Ok(()) };
        // A number that has fewer bits from now on falls to what seem to be old frames, until some of them go on from each other.
        let newest = &before[before.len().saturating_sub(RESTART_FRAMES as usize)..];
        let goes_on = newest.iter().chain([&*largest]).is_sorted_by_key(|sample| sample.sequence);
        let is_largest = goes_on && largest.sequence == u32::MAX >> (32 - self.sequence_bits);
        let is_sound = zero.sequence == 0 && zero.time_us > largest.time_us && !zero.status.restarted();
        // A first frame of another time may have begun a run in between; and by a clock that runs away no two frames go on from each other.
        let is_in_doubt = [Cause::Loss, Cause::Clock]
            .into_iter()
            .any(|cause| !self.judge.causes.has_passed(self.play.now, cause));
        if read != zero || !is_largest || !is_sound || is_in_doubt || self.frozen_until.is_some() {
            return Ok(());
        }
        match self.play.bridge.driver.pipeline.line_finding() {
            Some(LineFinding::SequenceWraps { largest: found }) if *found == largest.sequence => Ok(()),
            _ => broken("a number that begins again is found at once", self.judge.words(&self.play)),
        }
    }

    /// Bytes leave the pad. They may be a sound sample.
    fn send(&mut self, bytes: &[u8], sound: Option<&Sample>) -> Result<(), Broken> {
        let is_joined = std::mem::take(&mut self.is_joined);
        let sound = sound.filter(|_| !is_joined);
        if let Some(kept) = &mut self.kept {
            if kept.is_empty() {
                self.kept_first = self.play.now;
            }
            if kept.len() + bytes.len() <= KEPT_MAX {
                kept.extend_from_slice(bytes);
            }
            return Ok(());
        }
        // Nobody keeps what a port says that is not open.
        let is_frozen = self.frozen_until.is_some();
        let is_open = self.is_open() && (!is_frozen || self.play.buffer(bytes));
        if let Some(sample) = sound.filter(|_| is_open) {
            self.hear(sample);
        }
        if is_frozen {
            return Ok(());
        }
        self.play.send_to(bytes);
        self.read()
    }

    /// Whether the bridge has opened the port that the pad has now.
    fn is_open(&self) -> bool {
        self.play.bridge.connection.pad().is_some() && !self.is_port_new
    }

    /// The bridge reads this sound sample now, or as soon as it comes to run.
    fn hear(&mut self, sample: &Sample) {
        if sample.status.restarted() {
            self.unconfirmed_restart_frames = 0;
        }
        if self.unconfirmed_restart_frames > 0 {
            if self.seems_to_go_on(sample) {
                self.judge.causes.note(self.play.now, Cause::UnflaggedRestart);
            }
            let is_next = |last: &Sample| sample.time_us.wrapping_sub(last.time_us) <= 100_000;
            self.unconfirmed_restart_frames = if self.read.back().is_some_and(is_next) {
                self.unconfirmed_restart_frames - 1
            } else {
                RESTART_FRAMES
            };
        }
        if self.read.len() == KNOWN {
            self.read.pop_front();
        }
        self.read.push_back(*sample);
        if self.frozen_until.is_none() {
            self.judge.hear(self.play.now, self.contact.fz_n > 0.0);
        }
    }

    /// Whether this sample goes on by number and clock from the one that was read before the pad began anew, as far as one who waited for it can know.
    fn seems_to_go_on(&self, sample: &Sample) -> bool {
        let Some((last, heard)) = self.before else { return false };
        let read_at = self.frozen_until.unwrap_or(self.play.now);
        let passed_us = read_at.us_since(heard);
        let waited_us = read_at.us_since(self.play.now);
        let off_us = passed_us / 32 + 100_000;
        let in_time_us = passed_us.saturating_sub(off_us + waited_us)..=passed_us + off_us;
        let shown_us = sample.time_us.checked_sub(last.time_us);
        sample.sequence > last.sequence && shown_us.is_some_and(|shown_us| in_time_us.contains(&shown_us))
    }

    /// The bridge reads all that is there.
    fn read(&mut self) -> Result<(), Broken> {
        self.note_causes();
        loop {
            let woken = Woken { pad: self.play.is_hung_up_or_readable(), request: self.is_asked };
            self.is_asked = false;
            if !woken.pad && !woken.request {
                return Ok(());
            }
            self.play.turn(woken);
            self.judge.take(&self.play)?;
        }
    }

    /// The loop comes to run again. What waits for it may be of any time since it did not.
    fn thaw(&mut self) -> Result<(), Broken> {
        self.frozen_until = None;
        self.judge.thaw(self.play.now, self.frozen_us);
        self.frozen_us = 0;
        self.read()?;
        self.is_port_new = false;
        self.play.turn(ASLEEP);
        self.judge.take(&self.play)
    }

    /// Why the next profile cannot be read.
    pub(super) fn cannot_be_read(&mut self) -> String {
        self.broken_profiles += 1;
        format!("line {} is wrong", self.broken_profiles)
    }

    fn hand_in_profiles(&mut self) -> Result<(), Broken> {
        let now = self.play.now;
        let due = self.read_at.iter().filter(|at| **at <= now).count();
        if due == 0 {
            return Ok(());
        }
        self.read_at.retain(|at| *at > now);
        for _ in 0..due {
            let reading = {
                let mut all = self.play.messages.1.lock().unwrap();
                all.as_mut().filter(|all| !all.is_empty()).map(|all| all.remove(0))
            };
            let Some((request, reply)) = reading else { break };
            reply.hand_in(match request {
                ProfileRequest::Named(name) if name == UNREADABLE => {
                    let error = self.cannot_be_read();
                    self.untold.push(error.clone());
                    Err(error)
                }
                ProfileRequest::Named(name) => profile(&name),
                ProfileRequest::Same => profile(PROFILES[0]),
                ProfileRequest::Next => profile(PROFILES[self.chance.below(PROFILES.len() as u64) as usize]),
            });
            self.is_asked = true;
        }
        if self.frozen_until.is_some() { Ok(()) } else { self.read() }
    }

    /// Looks at the bridge, unless it does not come to run.
    fn look(&mut self) -> Result<(), Broken> {
        if let Some(page) = &mut self.page {
            page.take();
        }
        self.note_causes();
        let is_heard = self.play.bridge.driver.pipeline.is_heard();
        if std::mem::replace(&mut self.was_heard, is_heard) && !is_heard {
            self.is_joined = false;
        }
        if self.frozen_until.is_some() {
            return Ok(());
        }
        for error in self.untold.drain(..) {
            let messages = self.play.messages.0.lock().unwrap();
            if !messages.iter().any(|line| line.contains(&error)) {
                return broken("a profile that cannot be read is told", error);
            }
        }
        self.judge.look(&self.play)
    }

    /// Notes what keeps the pad from playing at this moment.
    fn note_causes(&mut self) {
        let now = self.play.now;
        let is_open = self.play.bridge.connection.pad().is_some();
        let phase = self.play.bridge.driver.pipeline.phase();
        let is_silent = self.is_stalled || self.kept.is_some();
        let is_off = self.off.iter().any(Option::is_some) || self.is_zero_old;
        let is_untouched = self.judge.causes.has_passed(now, Cause::Touched);
        let is_ghost = self.play.bridge.driver.pipeline.contact().is_some();
        if !is_off && is_untouched && !is_ghost && self.judge.causes.have_passed(now) {
            self.was_off = [false; 9];
        }
        if phase == Phase::Taring {
            self.is_dead_at_zero =
                self.dead_since.map(|since| since.is_some_and(|since| now.us_since(since) > DEAD_US));
        }
        let is_several = is_off && self.were_several_off();
        let there = [
            (Cause::Unplugged, !self.is_plugged),
            (Cause::Denied, self.is_plugged && !is_open && self.port == PortState::Denied),
            (Cause::Unusable, self.is_plugged && !is_open && self.port == PortState::Unusable),
            (Cause::Silent, is_silent),
            (Cause::Paused, self.is_paused),
            (Cause::Touched, self.contact.fz_n > 0.0),
            (Cause::ZeroUnderLoad, self.is_zero_under),
            (Cause::Weighing, phase == Phase::Weighing),
            (Cause::Channel, is_off),
            (Cause::Channels, is_several),
            (Cause::Loss, self.damage > 0 || self.loss_permille > 0 || self.damage_permille > 0),
            (Cause::Clock, self.play.us_per_ms / 100 != 10 && self.play.us_per_ms != 990),
            (Cause::Frozen, self.frozen_until.is_some()),
        ];
        self.judge.causes.note_off(now, self.off.map(|off| off.is_some()), self.was_off);
        for (cause, _) in there.into_iter().filter(|(_, is_there)| *is_there) {
            self.judge.causes.note(now, cause);
            if cause != Cause::Touched {
                self.judge.excuse();
            }
        }
    }

    /// Whether several channels were off since the pad was sound. What they leave behind may look like a finger in everything.
    fn were_several_off(&self) -> bool {
        self.was_off.iter().filter(|was_off| **was_off).count() > 1
    }

    /// Something is over in a moment, and the zero may be measured anew.
    fn note_zero_requested(&mut self) {
        self.note_break();
        self.is_staying = false;
        self.is_zero_under |= self.contact.fz_n > 0.0;
    }

    /// The pad is not heard from here on.
    fn delay_begins(&mut self) {
        let is_held = self.play.bridge.driver.pipeline.held().next().is_some();
        self.is_staying = self.contact == RIGHT && is_held && self.judge.causes.have_passed(self.play.now);
    }

    /// It is heard again: a finger that has stayed counts again.
    fn wait_ends(&mut self) {
        if std::mem::take(&mut self.is_staying) {
            self.judge.press_again(self.play.now);
        }
    }

    /// Something is over in a moment.
    fn note_break(&mut self) {
        self.judge.causes.note(self.play.now, Cause::ZeroRequested);
        self.judge.excuse();
    }

    fn happen(&mut self, event: Event) -> Result<(), Broken> {
        match event {
            Event::Touch(contact) => self.touch(contact),
            Event::Lift => self.touch(AWAY),
            Event::Ask(wish) => return self.ask(wish),
            Event::ReaderStall(is_stalled) => self.play.written.0.lock().unwrap().is_stalled = is_stalled,
            Event::PageStall(is_stalled) => {
                if let Some(page) = &mut self.page {
                    page.is_stalled = is_stalled;
                }
            }
            Event::Screen(looks) => self.screen = looks.then(|| self.play.bridge.snapshot()),
            Event::Freeze(ms) => {
                let until = self.play.now.plus_us(1_000 * u64::from(ms));
                self.frozen_until = Some(self.frozen_until.unwrap_or_default().max(until));
            }
            Event::Mend => return self.mend(),
            event => return self.happen_to_pad(event),
        }
        Ok(())
    }
}
