//! What the player does, and how all is put right.

use super::*;

/// What presses with less may not be felt, N.
const FELT_N: f32 = 0.3;

impl World {
    pub(super) fn touch(&mut self, contact: Contact) {
        let presses_anew = self.contact == AWAY && contact == RIGHT;
        let was_touched = std::mem::replace(&mut self.contact, contact).fz_n > 0.0;
        let is_touched = contact.fz_n > 0.0;
        self.is_zero_old &= is_touched;
        self.is_staying = false;
        let begins_early = !was_touched && !self.judge.causes.have_passed(self.play.now);
        // One that is too weak to be felt becomes the zero.
        let is_felt = contact.fz_n > FELT_N;
        self.is_zero_under = is_touched && (self.is_zero_under || begins_early || !is_felt);
        self.judge.excuse();
        if presses_anew && self.frozen_until.is_none() {
            self.judge.press(self.play.now);
        }
    }

    pub(super) fn ask(&mut self, wish: Wish) -> Result<(), Broken> {
        let request = match wish {
            Wish::Pause => Request::Pause,
            Wish::Resume => Request::Resume,
            Wish::TogglePause => Request::TogglePause,
            Wish::Tare => Request::Retare,
            Wish::Panic => Request::ReleaseAll,
            Wish::Profile { number, .. } => Request::Profile(Some(PROFILES[number].into())),
            Wish::Unreadable { .. } => Request::Profile(Some(UNREADABLE.into())),
            Wish::NextProfile { .. } => Request::NextProfile,
            Wish::Reload { .. } => Request::Profile(None),
            Wish::Edit(number) => Request::UpdateProfile(Box::new(ProfileUpdate {
                read: profile(PROFILES[number]),
                reason: None,
                request_count: 0,
            })),
            Wish::Break => {
                let error = self.cannot_be_read();
                if !self.is_profile_asked {
                    self.untold.push(error.clone());
                }
                let read = Err(error);
                Request::UpdateProfile(Box::new(ProfileUpdate { read, reason: None, request_count: 0 }))
            }
            Wish::Preview(number) => Request::Preview(Box::new(profile(PROFILES[number]).unwrap())),
            Wish::Weigh { g } => Request::Weigh(Weight::of_g(g.into()).unwrap()),
            Wish::Status => Request::Status,
        };
        match wish {
            Wish::Pause => self.is_paused = true,
            Wish::Resume => self.is_paused = false,
            Wish::TogglePause => self.is_paused = !self.is_paused,
            Wish::Profile { read_ms, .. }
            | Wish::NextProfile { read_ms }
            | Wish::Reload { read_ms }
            | Wish::Unreadable { read_ms } => {
                self.read_at.push(self.play.now.plus_us(1_000 * u64::from(read_ms)));
                self.is_profile_asked = true;
            }
            _ => {}
        }
        if matches!(wish, Wish::Weigh { .. }) {
            // It may be over as soon as it has begun.
            self.judge.causes.note(self.play.now, Cause::Weighing);
        }
        match wish {
            Wish::Tare
            | Wish::Pause
            | Wish::Resume
            | Wish::TogglePause
            | Wish::Panic
            | Wish::Weigh { .. } => self.note_zero_requested(),
            _ => {}
        }
        self.play.bridge.requests.sender().unwrap().send(request).unwrap();
        self.is_asked = true;
        if self.frozen_until.is_some() { Ok(()) } else { self.read() }
    }

    /// Puts everything right. Then the pad plays, and the first press counts.
    pub(super) fn mend(&mut self) -> Result<(), Broken> {
        if let Some(until) = self.frozen_until {
            self.pass(until.us_since(self.play.now) + 1)?;
        }
        for event in [
            Event::Lift,
            Event::Cure,
            Event::Damage(0),
            Event::LossPermille(0),
            Event::DamagePermille(0),
            Event::Pace(1_000),
            Event::SequenceBits(32),
            Event::Stall(false),
            Event::Keep(false),
            Event::ReaderStall(false),
            Event::Port(PortState::Free),
            Event::PlugIn { is_anew: true },
            Event::Ask(Wish::Resume),
        ] {
            self.happen(event)?;
        }
        self.note_causes();
        self.settle()?;
        if self.play.bridge.driver.pipeline.contact().is_some() && self.were_several_off() {
            // Who sees a finger where none is has the zero measured.
            self.ask(Wish::Tare)?;
            self.settle()?;
        }
        self.touch(RIGHT);
        self.pass(150_000)?;
        self.touch(AWAY);
        self.pass(250_000)?;
        if self.play.bridge.driver.pipeline.held().next().is_some() {
            return broken("nothing stays down", self.judge.words(&self.play));
        }
        let shown = self.page.as_mut().map_or(Ok(()), |page| page.is_like(&self.play.bridge.driver.pipeline));
        shown.or_else(|what| broken("the same calls give the same events", what))
    }

    /// Waits until the pad has to play.
    fn settle(&mut self) -> Result<(), Broken> {
        // A weighing ends by itself after some time.
        let mut left_ms = 25_000;
        while !self.judge.causes.have_passed(self.play.now) {
            if left_ms == 0 {
                return broken("all comes to its end", self.judge.words(&self.play));
            }
            left_ms -= 10;
            self.pass(10_000)?;
        }
        if self.play.bridge.driver.pipeline.line_finding().is_some() {
            self.pass(TAKEN_BACK_US)?;
        }
        Ok(())
    }
}
