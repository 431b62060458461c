//! What happens to the pad and its line.

use super::*;
use tactpad_core::pipeline::link::SILENCE_MAX_US;

/// A pad whose samples come late is the same one if they go on from the last within this time, µs.
const BRIDGED_US: u64 = 100_000;

impl World {
    pub(super) fn happen_to_pad(&mut self, event: Event) -> Result<(), Broken> {
        let play = &mut self.play;
        match event {
            Event::PlugIn { is_anew } if !self.is_plugged => {
                self.is_plugged = true;
                self.judge.causes.note(play.now, Cause::Restarted);
                play.plug_in();
                self.is_joined = false;
                if is_anew {
                    (play.time_us, play.sequence, play.status) = (0, 0, Status::OK.with_restarted());
                }
            }
            Event::PullOut if self.is_plugged => {
                self.is_plugged = false;
                self.judge.causes.note(play.now, Cause::Unplugged);
                play.unplug();
                self.kept = self.kept.take().map(|_| Vec::new());
                if self.frozen_until.is_none() {
                    self.read()?;
                } else {
                    self.is_port_new = true;
                }
            }
            Event::Port(state) => {
                self.port = state;
                *play.plug.refusal.lock().unwrap() = match state {
                    PortState::Free => None,
                    PortState::Denied => Some(PadError::Denied("no".into())),
                    PortState::Unusable => Some(PadError::Unusable("no".into())),
                };
            }
            Event::Restart { time_us, is_flagged, offset, text } => {
                if !self.judge.causes.has_passed(play.now, Cause::Restarted) {
                    // Again and again its clock is set anew.
                    self.judge.causes.note(play.now, Cause::Clock);
                }
                self.judge.causes.note(play.now, Cause::Restarted);
                (play.sequence, play.offset) = (0, [offset; 9]);
                if self.unconfirmed_restart_frames == 0 {
                    self.before = self.read.back().copied().zip(self.judge.heard);
                }
                self.unconfirmed_restart_frames = RESTART_FRAMES;
                play.status = if is_flagged { Status::OK.with_restarted() } else { Status::OK };
                self.set_clock(time_us);
                self.send_if_plugged(BOOT_TEXTS[text].as_bytes())?;
            }
            Event::Identify(pad) => self.identify(pad)?,
            Event::Rate(rate_hz) => self.rate_hz = rate_hz,
            Event::Stall(true) => {
                if !std::mem::replace(&mut self.is_stalled, true) {
                    self.stalled_from = play.now;
                    self.delay_begins();
                }
            }
            Event::Stall(false) => {
                if std::mem::take(&mut self.is_stalled) {
                    // What was there when it fell silent nobody saw pass.
                    self.judge.delay_is_over(play.now, play.now.us_since(self.stalled_from));
                }
            }
            Event::Keep(true) => {
                if self.kept.is_none() {
                    self.delay_begins();
                    (self.kept, self.kept_from) = (Some(Vec::new()), self.play.now);
                }
            }
            Event::Keep(false) => self.hand_on()?,
            Event::Lose(frames) => play.sequence = play.sequence.wrapping_add(frames),
            Event::Damage(frames) => self.damage = frames,
            Event::LossPermille(permille) => self.loss_permille = permille,
            Event::DamagePermille(permille) => self.damage_permille = permille,
            Event::Rubbish(seed) => {
                let mut draw = Draw(SplitMix64::named(seed, "rubbish"));
                let bytes: Vec<u8> = (0..=draw.below(100)).map(|_| draw.below(256) as u8).collect();
                self.send_if_plugged(&bytes)?;
                // Up to the next delimiter all is one frame.
                self.is_joined = self.is_plugged && bytes.last() != Some(&0);
            }
            Event::Repeat { age, frames } => {
                // One that looks like the first of a run seems to have lost those up to the next.
                let is_dropped = self.is_dropped(age, frames);
                let cause = if is_dropped { Cause::RepeatedFrame } else { Cause::Loss };
                self.judge.causes.note(self.play.now, cause);
                self.repeat(age, frames)?;
                if is_dropped {
                    self.judge.excuse();
                    return Ok(());
                }
            }
            Event::ClockJump(time_us) => {
                self.doubt_clock();
                self.set_clock(time_us);
            }
            Event::ClockBits(bits) => {
                self.clock_bits = bits;
                self.set_clock(self.play.time_us);
            }
            Event::SequenceBits(bits) => self.sequence_bits = bits,
            Event::Pace(us_per_ms) => play.us_per_ms = u64::from(us_per_ms),
            Event::Off(channel, off) => {
                self.cure();
                return self.happen_to_pad(Event::OffToo(channel, off));
            }
            Event::OffToo(channel, off) => {
                self.was_off[channel] = true;
                let reads = play.sent.back().map_or(0, |sent| sent.counts[channel]);
                self.off[channel] = Some((off, reads));
                let is_dead = matches!(off, Off::Saturated | Off::Stuck);
                self.dead_since[channel] = is_dead.then_some(self.dead_since[channel].unwrap_or(play.now));
                self.wire();
            }
            Event::Cure => self.cure(),
            Event::Sleep { s, is_powered } => self.sleep(s, is_powered)?,
            _ => return Ok(()),
        }
        match event {
            // Over a silence the zero stays, and with it what lies there.
            Event::Stall(begins) | Event::Keep(begins) => {
                self.note_break();
                if !begins && !self.is_stalled && self.kept.is_none() {
                    self.wait_ends();
                }
            }
            _ => self.note_zero_requested(),
        }
        if matches!(event, Event::Lose(_)) {
            self.judge.causes.note(self.play.now, Cause::Loss);
        }
        Ok(())
    }

    /// Whether frames that come again end a contact and nothing else: the pad plays, and they are known, or too few to be a run that it
    /// began.
    fn is_dropped(&self, age: u32, frames: u32) -> bool {
        let first = self.play.sequence.wrapping_sub(age);
        let is_within_run = |number: u32| {
            let mut sent = self.play.sent.iter().rev();
            sent.find(|sent| sent.sequence == number).is_some_and(|sent| !sent.status.restarted())
        };
        // What was sent before the port was opened nobody knows again.
        let are_known =
            age <= KNOWN as u32 && self.read.front().is_some_and(|oldest| oldest.sequence <= first);
        let are_few = are_known || frames.min(age) < 3;
        let are_within_run = (0..frames.min(age)).all(|back| is_within_run(first.wrapping_add(back)));
        self.judge.causes.have_passed(self.play.now) && are_few && are_within_run
    }

    fn send_if_plugged(&mut self, bytes: &[u8]) -> Result<(), Broken> {
        if self.is_plugged && !bytes.is_empty() { self.send(bytes, None) } else { Ok(()) }
    }

    pub(super) fn cure(&mut self) {
        self.is_zero_old |= self.off.iter().any(Option::is_some) && self.contact.fz_n > 0.0;
        let mut off = self.off.iter().zip(self.is_dead_at_zero).filter(|(off, _)| off.is_some()).peekable();
        let are_dead = off.peek().is_some() && off.all(|(_, is_dead)| is_dead);
        if are_dead && self.is_heard_by_now() {
            self.judge.channels_recover(self.play.now);
        }
        (self.off, self.dead_since) = ([None; 9], [None; 9]);
        self.wire();
    }

    /// Whether the bridge hears the pad, knows of what is off, and nobody has touched it for long.
    fn is_heard_by_now(&self) -> bool {
        let is_heard =
            self.is_plugged && !self.is_stalled && self.kept.is_none() && self.frozen_until.is_none();
        let is_known = self.play.bridge.driver.pipeline.phase() == Phase::Faulty;
        is_heard && is_known && self.judge.is_untouched(self.play.now)
    }

    /// Lays the pad's wires as they are now.
    fn wire(&mut self) {
        let off = self.off;
        self.play.wiring = Box::new(move |number, counts| {
            for (count, off) in counts.iter_mut().zip(off) {
                *count = match off {
                    Some((Off::Saturated, _)) => (1 << 23) - 1,
                    Some((Off::Stuck, reads)) => reads,
                    Some((Off::Rail { mv, noise_uv }, _)) => {
                        let noise = (number.wrapping_mul(2_654_435_761) >> 16) as i32;
                        100_000 * mv + noise % (200 * noise_uv + 1) - 100 * noise_uv
                    }
                    Some((Off::Drift { .. }, _)) | None => *count,
                };
            }
        });
    }

    fn identify(&mut self, pad: usize) -> Result<(), Broken> {
        let identity = Identity {
            serial_number: SerialNumber::from_ascii(PADS[pad]).unwrap(),
            channels: 9,
            count_bits: 24,
            rate_hz: self.rate_hz as u16,
            picovolts_per_count: 10_000,
        };
        self.send_message(&Message::Identity(identity))
    }

    fn send_message(&mut self, message: &Message) -> Result<(), Broken> {
        let mut frame = [0; ENCODED_MAX];
        let length = encode_message(message, &mut frame);
        self.send_if_plugged(&frame[..length])
    }

    /// The hub hands on what it has kept.
    fn hand_on(&mut self) -> Result<(), Broken> {
        let Some(kept) = self.kept.take().filter(|kept| !kept.is_empty()) else { return Ok(()) };
        self.judge.delay_is_over(self.play.now, self.play.now.us_since(self.kept_from));
        self.judge.causes.note(self.play.now, Cause::Delayed);
        let paused_us = self.judge.heard.map_or(0, |heard| self.kept_first.us_since(heard));
        if paused_us > BRIDGED_US {
            // One that stalled as well shows neither what has passed nor that it goes on: it may have begun anew.
            self.note_zero_requested();
        }
        if self.frozen_until.is_some() {
            if self.is_open() {
                kept.chunks(64).all(|bytes| self.play.buffer(bytes));
            }
            return Ok(());
        }
        if self.is_open() {
            // A finger may have been there meanwhile.
            self.judge.hear(self.play.now, true);
        }
        self.play.send_to(&kept);
        self.read()
    }

    /// Frames come again: those that were sent, or where that is too long ago such as they may have been. Those of a silent pad that the
    /// bridge has not read are nothing but late.
    fn repeat(&mut self, age: u32, frames: u32) -> Result<(), Broken> {
        let now = self.play.now;
        let is_silent = self.judge.heard.is_none_or(|heard| now.us_since(heard) > SILENCE_MAX_US);
        for back in 0..frames.min(age) {
            let number = self.play.sequence.wrapping_sub(age).wrapping_add(back);
            let sent = self.play.sent.iter().rev().find(|sent| sent.sequence == number).copied();
            let older = self.play.sent.front().copied();
            let Some(sample) = sent.or(older) else { return Ok(()) };
            if is_silent && !self.read.contains(&sample) {
                self.judge.causes.note(now, Cause::Delayed);
                self.judge.hear(now, true);
            }
            self.send_message(&Message::Sample(sample))?;
        }
        Ok(())
    }

    /// The machine sleeps. Its clock does not go on; the pad's does, if it has power, and what it sends is lost.
    fn sleep(&mut self, s: u32, is_powered: bool) -> Result<(), Broken> {
        if is_powered {
            self.pad_time_passes(1_000_000 * u64::from(s));
            self.play.sequence = self.play.sequence.wrapping_add(s * self.rate_hz);
            self.judge.causes.note(self.play.now, Cause::Loss);
            return Ok(());
        }
        if self.is_plugged {
            self.happen_to_pad(Event::PullOut)?;
            self.happen_to_pad(Event::PlugIn { is_anew: true })?;
        }
        Ok(())
    }
}
