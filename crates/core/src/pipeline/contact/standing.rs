//! Somebody who stands on the plate: forces relative to their weight, places from where they stand.
//!
//! Who stands still holds their weight up and nothing else, so a second of a force that does not change tells the weight, and its place
//! where they stand. From then on Fz' = Fz · (force of a standing person for a profile) / weight: a threshold is a share of the weight.

use super::balance::on_plate;
use crate::pipeline::interruption::Effect;
use crate::quantity::Contact;
use crate::time::StreamInstant;

/// Who stands still so long is weighed, µs.
const STILL_US: u64 = 1_000_000;

/// A force that stays within this share of itself stands still, and one that differs by more is another weight.
const STILL_SHARE: f32 = 0.1;

/// Less than this is nobody who stands there, N on the plate: a bag, a foot that is put on.
const WEIGHT_MIN_N: f32 = 2.0;

/// Who has taken all but this share of the weight off …
const AWAY_SHARE: f32 = 0.2;

/// … for so long has left, µs: the flight of a jump is shorter.
const LEFT_US: u64 = 1_000_000;

/// What is known of who stands on the plate.
#[derive(Clone, Debug)]
pub struct Standing {
    /// What the weight is for a profile, N; `None` on a pad that nobody stands on, where all forces are absolute.
    standing_n: Option<f32>,
    stance: Option<Stance>,
    window: Option<Window>,
    /// When somebody was on the plate last.
    there_at: StreamInstant,
}

/// A person's weight, N on the plate, and where they stand, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stance {
    weight_n: f32,
    place_mm: [f32; 2],
}

/// A stretch of time in which the force has stood still so far.
#[derive(Clone, Copy, Debug)]
struct Window {
    since: StreamInstant,
    low_n: f32,
    high_n: f32,
    /// Of x, y and Fz.
    sums: [f64; 3],
    samples: u32,
}

impl Standing {
    /// Of nobody yet; a standing person is `standing_n` for a profile, N.
    pub const fn new(standing_n: Option<f32>) -> Self {
        Self { standing_n, stance: None, window: None, there_at: StreamInstant::from_us(0) }
    }

    /// The contact as profiles see it, of what touches the plate at `at`; none before who stands there has stood still once.
    pub fn relative(&mut self, at: StreamInstant, contact: Option<Contact>) -> Option<Contact> {
        if self.standing_n.is_none() {
            return contact;
        }
        let away_n = self.stance.map_or(WEIGHT_MIN_N, |stance| AWAY_SHARE * stance.weight_n);
        if contact.is_some_and(|contact| contact.fz_n >= away_n) {
            self.there_at = at;
        } else if at.us_since(self.there_at) >= LEFT_US {
            self.stance = None;
        }
        match &contact {
            Some(contact) => self.weigh(at, contact),
            None => self.window = None,
        }
        contact.and_then(|contact| self.of_weight(&contact))
    }

    /// The contact as profiles see it, of one that the plate has now; none before somebody was weighed.
    pub fn of_weight(&self, contact: &Contact) -> Option<Contact> {
        let Some(share) = self.share() else { return self.standing_n.is_none().then_some(*contact) };
        let Stance { place_mm: [x_mm, y_mm], .. } = self.stance?;
        let place_mm = [contact.x_mm - x_mm, contact.y_mm - y_mm].map(f64::from);
        let [x_mm, y_mm] = on_plate(place_mm).map(|mm| mm as f32);
        let [fx_n, fy_n, fz_n] = [contact.fx_n, contact.fy_n, contact.fz_n].map(|n| n * share);
        Some(Contact { x_mm, y_mm, fx_n, fy_n, fz_n })
    }

    /// A profile's newtons per newton on the plate, if somebody was weighed.
    pub fn share(&self) -> Option<f32> {
        Some(self.standing_n? / self.stance?.weight_n)
    }

    /// Whether nobody was weighed yet on a pad that somebody is to stand on.
    pub const fn awaits_weight(&self) -> bool {
        self.standing_n.is_some() && self.stance.is_none()
    }

    /// Nobody stands there any more, or it is not known who. In doubt it is who stood there before.
    pub fn interrupt(&mut self, effect: Effect) {
        if effect != Effect::Keep {
            self.window = None;
        }
        if effect == Effect::Forget {
            self.stance = None;
        }
    }

    /// Takes the force into account; once it has stood still for long enough, that is the weight.
    fn weigh(&mut self, at: StreamInstant, contact: &Contact) {
        let Contact { x_mm, y_mm, fz_n, .. } = *contact;
        let fresh = Window { since: at, low_n: fz_n, high_n: fz_n, sums: [0.0; 3], samples: 0 };
        let mut window = self.window.unwrap_or(fresh);
        window.low_n = window.low_n.min(fz_n);
        window.high_n = window.high_n.max(fz_n);
        if window.high_n - window.low_n > STILL_SHARE * window.high_n {
            window = fresh;
        }
        window.sums.iter_mut().zip([x_mm, y_mm, fz_n]).for_each(|(sum, value)| *sum += f64::from(value));
        window.samples += 1;
        let is_over = at.us_since(window.since) >= STILL_US;
        if let Some(found) = window.stance().filter(|_| is_over) {
            // What stands still and is too light for a person says that whoever stood there has gone.
            let is_person = found.weight_n >= WEIGHT_MIN_N;
            self.stance = if self.is_news(&found) { Some(found) } else { self.stance }.filter(|_| is_person);
        }
        self.window = (!is_over).then_some(window);
    }

    /// Whether somebody else stands there than was thought. Who leans has the same weight, and stands where they stood.
    fn is_news(&self, found: &Stance) -> bool {
        let is_other = |known: Stance| {
            let apart_n = (found.weight_n - known.weight_n).abs();
            apart_n > STILL_SHARE * known.weight_n
        };
        self.stance.is_none_or(is_other)
    }
}

impl Window {
    /// Its means.
    fn stance(&self) -> Option<Stance> {
        let samples = f64::from(self.samples);
        let [x_mm, y_mm, weight_n] = self.sums.map(|sum| (sum / samples) as f32);
        (self.samples > 0).then_some(Stance { weight_n, place_mm: [x_mm, y_mm] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What profiles see at the end of each stretch of time, in ms, with a force in N at a place.
    fn seen(standing: &mut Standing, stretches: &[(u64, f32, [f32; 2])]) -> Vec<Option<Contact>> {
        let mut at = standing.there_at;
        let mut last = None;
        let mut all = Vec::new();
        for &(ms, fz_n, [x_mm, y_mm]) in stretches {
            for _ in 0..ms {
                at = at.plus_us(1_000);
                let contact = Contact { x_mm, y_mm, fz_n, ..Contact::default() };
                last = standing.relative(at, (fz_n > 0.1).then_some(contact));
            }
            all.push(last);
        }
        all
    }

    fn forces_n(seen: &[Option<Contact>]) -> Vec<Option<f32>> {
        seen.iter().map(|contact| contact.map(|contact| (contact.fz_n * 100.0).round() / 100.0)).collect()
    }

    #[test]
    fn who_stands_still_is_the_same_for_a_profile_whatever_they_weigh() {
        for weight_n in [4.0, 9.0, 25.0] {
            let mut standing = Standing::new(Some(2.0));
            let stamped_n = 1.5 * weight_n;
            let found = seen(
                &mut standing,
                &[
                    (900, weight_n, [3.0, -2.0]),
                    (200, weight_n, [3.0, -2.0]),
                    (100, stamped_n, [3.0, -2.0]),
                    (3_000, weight_n, [13.0, -2.0]),
                ],
            );
            assert_eq!(forces_n(&found), [None, Some(2.0), Some(3.0), Some(2.0)]);
            let leaning = found[3].unwrap();
            assert!((leaning.x_mm - 10.0).abs() < 1e-3 && leaning.y_mm.abs() < 1e-3, "{leaning:?}");
        }
    }

    #[test]
    fn a_jump_keeps_the_weight_and_who_leaves_takes_it_along() {
        let mut standing = Standing::new(Some(2.0));
        let flight =
            seen(&mut standing, &[(1_100, 10.0, [0.0; 2]), (700, 0.0, [0.0; 2]), (10, 12.0, [0.0; 2])]);
        assert_eq!(forces_n(&flight), [Some(2.0), None, Some(2.4)]);
        let other =
            seen(&mut standing, &[(1_100, 0.0, [0.0; 2]), (500, 20.0, [0.0; 2]), (600, 20.0, [0.0; 2])]);
        assert_eq!(forces_n(&other), [None, None, Some(2.0)]);
    }

    #[test]
    fn a_weight_that_turns_out_to_be_another_is_put_right_in_a_second() {
        let mut standing = Standing::new(Some(2.0));
        // One foot stood still first.
        let found =
            seen(&mut standing, &[(1_100, 5.0, [-9.0, 0.0]), (900, 10.0, [0.0; 2]), (1_100, 10.0, [0.0; 2])]);
        assert_eq!(forces_n(&found), [Some(2.0), Some(4.0), Some(2.0)]);
        assert!(found[2].unwrap().x_mm.abs() < 1e-3);
    }

    #[test]
    fn a_light_thing_is_nobody_and_a_pad_of_absolute_forces_is_left_alone() {
        assert_eq!(seen(&mut Standing::new(Some(2.0)), &[(3_000, 1.9, [0.0; 2])]), [None]);
        let absolute = seen(&mut Standing::new(None), &[(10, 1.9, [4.0, 5.0])]);
        assert_eq!(absolute, [Some(Contact { x_mm: 4.0, y_mm: 5.0, fz_n: 1.9, ..Contact::default() })]);
    }

    #[test]
    fn who_leaves_a_light_thing_behind_has_left() {
        let mut standing = Standing::new(Some(2.0));
        let found =
            seen(&mut standing, &[(1_100, 4.0, [0.0; 2]), (900, 1.5, [0.0; 2]), (200, 1.5, [0.0; 2])]);
        assert_eq!(forces_n(&found), [Some(2.0), Some(0.75), None]);
    }

    #[test]
    fn what_is_doubted_stays_and_what_is_forgotten_goes() {
        let mut standing = Standing::new(Some(2.0));
        seen(&mut standing, &[(1_100, 10.0, [0.0; 2])]);
        standing.interrupt(Effect::Doubt);
        assert_eq!(forces_n(&seen(&mut standing, &[(1, 10.0, [0.0; 2])])), [Some(2.0)]);
        standing.interrupt(Effect::Forget);
        assert_eq!(seen(&mut standing, &[(1, 10.0, [0.0; 2])]), [None]);
    }
}
